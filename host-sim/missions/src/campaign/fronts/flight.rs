//! The planners that follow fronts, and the missions of a campaign, flown on all cores.

use std::f64::consts::FRAC_PI_2;

use anyhow::{Error, Result};
use planner_core::dynamics::Dynamics;
use planner_core::{Area, Front, Noise, Planner as _, Track, Unicycle, Workspace};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::campaign::fronts::following::{Course, Flown, Follower, REACH, Vertex, follow};
use crate::campaign::fronts::kinds::{KINDS, Kind};
use crate::campaign::fronts::summary::{Row, Summary};
use crate::campaign::fronts::who::Who;
use crate::campaign::kinds::rows;
use crate::mission::baseline::Baseline;
use crate::mission::crossings::Crossings;
use crate::mission::steering::{BANG_BANG, Steered, ZIGZAG};

/// How long a mission is, in steps: 400 m.
pub const STEPS: f64 = 200.0;

/// Missions along each kind of front.
#[derive(Clone, Debug)]
pub struct Fronts {
    /// Who follows.
    pub who: Who,
    /// Missions a kind.
    pub missions: u64,
    /// Seed of the ensemble. A mission has its own stream.
    pub seed: u64,
    /// Labels are true with these probabilities.
    pub p: Vec<f64>,
    /// The speed that a planner is told is that of the front, times this.
    pub told_speed: f64,
    /// The longest motion, metres, if it is not the usual one.
    pub reach: Option<f64>,
}

impl Fronts {
    /// Flies the missions on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// When a tracker cannot be told so.
    pub fn run(&self) -> Result<Summary> {
        let fly = |kind: &Kind, p, number| self.mission(kind, p, number);
        let row = |kind: &Kind, p, flown: &[Flown]| Row::of(kind.name, p, flown);
        let of = (&KINDS[..], &self.p[..], self.missions);
        Ok(Summary {
            algorithm: self.who,
            missions: self.missions,
            seed: self.seed,
            reach: self.reach(),
            told_speed: self.who.is_told_speed().then_some(self.told_speed),
            rows: rows(of, self.who.title(), fly, row)?,
        })
    }

    /// The longest motion, metres.
    fn reach(&self) -> f64 {
        self.reach.unwrap_or(self.who.usual_reach())
    }

    /// The mission with this number.
    ///
    /// # Errors
    /// When a tracker cannot be told so.
    pub fn mission(&self, kind: &Kind, p: f64, number: u64) -> Result<Flown> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(number);
        let front = (kind.draw)(&mut rng);
        let pose = front.start(&mut rng);
        let reach = self.reach();
        let steps = reach / REACH;
        let course = Course { motions: libm::round(STEPS / steps) as u32, steps, p };
        let (sea, vehicle) = (sea()?, vehicle(reach)?);
        let steered = |steering| {
            Steered::planner((sea, vehicle), Crossings::given(&front.given()), steering, reach)
        };
        Ok(match self.who {
            Who::Track => {
                let told = Front::BENDING.moving(kind.speed * self.told_speed * steps);
                let noise = Noise::new(p).map_err(Error::msg)?;
                let planner = Track::new(sea, vehicle, told.map_err(Error::msg)?, noise);
                let planner = planner.map_err(Error::msg)?.knowing(&front.given());
                follow(&front, planner, (course, pose), &mut rng, |_, _, _| ())
            }
            Who::Zigzag => follow(&front, steered(ZIGZAG), (course, pose), &mut rng, |_, _, _| ()),
            Who::BangBang => {
                follow(&front, steered(BANG_BANG), (course, pose), &mut rng, |_, _, _| ())
            }
        })
    }
}

impl<D: Dynamics, G: Workspace> Follower for Baseline<Steered, D, Crossings, G> {
    fn vertices(&self) -> Vec<Vertex> {
        let vertex = |at| Vertex { at, half_width: None, age: 0.0 };
        self.belief().crossing.map(vertex).into_iter().collect()
    }

    fn is_closed(&self) -> bool {
        false
    }
}

/// A unicycle with motions of up to so many metres, in steps of 10 cm. It turns by up to a quarter turn.
///
/// # Errors
/// When there is no such vehicle.
pub fn vehicle(reach: f64) -> Result<Unicycle> {
    let speeds = libm::round(reach * 10.0) as u16 + 1;
    Unicycle::new(1_000, FRAC_PI_2, speeds, 100).map_err(Error::msg)
}

/// An area without a border that a mission could reach.
///
/// # Errors
/// Never: it is an area.
pub fn sea() -> Result<Area> {
    Area::metres([-2_000.0, -2_000.0], [2_000.0, 2_000.0]).map_err(Error::msg)
}
