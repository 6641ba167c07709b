//! The missions of a campaign, flown on all cores, and what they come to.

use std::f64::consts::TAU;

use anyhow::{Error, Result};
use nalgebra::Point2;
use planner_core::{
    Front, Heading, Label, Noise, Plan, Planner as _, Pose, Seeking, Site, StopReason, Track,
};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use crate::campaign::kinds::rows;
use crate::campaign::patches::kinds::{KINDS, Kind};
use crate::campaign::spread::{rank, sorted};

/// A front that is said to be further away than so many widths is found falsely.
const FALSE: f64 = 2.0;

/// Missions that seek each kind of boundary.
#[derive(Clone, Debug)]
pub struct Patches {
    /// Whether they mow: tracks of a patch's width, and the same closing in.
    pub mows: bool,
    /// Missions a row.
    pub missions: u64,
    /// Seed of the ensemble. A mission has its own stream.
    pub seed: u64,
    /// Labels are true with these probabilities.
    pub p: Vec<f64>,
    /// The radius that is told is multiplied by this.
    pub told: f64,
}

/// How a mission went.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flown {
    /// Metres driven until the boundary was found, or to the end.
    pub metres: f64,
    /// Whether it was found where it is.
    pub is_found: bool,
    /// Whether one was found where none is.
    pub is_false: bool,
    /// Steps from the first true crossing until it was found.
    pub closing: Option<u32>,
    /// Whether the planner said that all has one label.
    pub is_empty: bool,
    /// Whether it ended for another reason than steps.
    pub stopped: Option<StopReason>,
}

/// What the missions of a row come to. Metres are the median, 90 % and the most, of all missions: those that did not find
/// count as infinite.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The kind.
    pub kind: &'static str,
    /// Labels are true with this probability.
    pub p: f64,
    /// The share that found the boundary.
    pub found: f64,
    /// Metres until then: the median, 90 %, and all.
    pub metres: [Option<f64>; 3],
    /// Steps from the first true crossing until then, the median.
    pub closing: Option<u32>,
    /// The share that found one where none is.
    pub false_finds: f64,
    /// The share that said that all has one label.
    pub empty: f64,
    /// The share that stopped for another reason.
    pub stuck: f64,
}

impl Patches {
    /// Flies the missions on all cores, with a progress bar on a terminal.
    ///
    /// # Errors
    /// When a planner cannot be told so.
    pub fn run(&self) -> Result<Vec<Row>> {
        let fly = |kind: &Kind, p, number| self.mission(kind, p, number);
        let row = |kind: &Kind, p, flown: &[Flown]| Row::of(kind.name, p, flown);
        rows((&KINDS, &self.p, self.missions), "", fly, row)
    }

    /// The mission with this number.
    ///
    /// # Errors
    /// When a planner cannot be told so.
    pub fn mission(&self, kind: &Kind, p: f64, number: u64) -> Result<Flown> {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        rng.set_stream(number);
        let ground = kind.ground;
        let (truth, area) = ((kind.draw)(&ground, &mut rng), ground.area()?);
        let mut pose = start(&area, ground.sides, &mut rng)?;
        let noise = Noise::new(p).map_err(Error::msg)?;
        let patch = self.told * ground.patch;
        let seeking = Seeking::patches(patch).map_err(Error::msg)?.likely(ground.likely);
        let planner =
            Track::new(area, ground.vehicle()?, Front::BENDING, noise).map_err(Error::msg)?;
        let planner = planner.seeking(seeking).map_err(Error::msg)?;
        let mut planner = if self.mows {
            planner.surveying(&survey(ground.sides, patch, pose)?)
        } else {
            planner
        };
        let width = f64::from(planner.width());
        let (mut flown, mut crossed) = (Flown::default(), None);
        let is_above = |site: Site| truth.depth(site.into()) > 0.0;
        let first = is_above(pose.site);
        for step in 1..=ground.steps {
            let motion = match planner.plan(pose) {
                Plan::Move(motion) => motion,
                Plan::Stop(why) => {
                    flown.is_empty = why == StopReason::OneLabel;
                    flown.stopped = Some(why);
                    break;
                }
            };
            let way = Point2::<f64>::from(motion.target.site) - Point2::from(pose.site);
            flown.metres += way.norm();
            pose = motion.target;
            let is_true = rng.random_bool(p);
            let is_plus = is_above(pose.site) == is_true;
            let label = if is_plus { Label::Positive } else { Label::Negative };
            let reading = motion.wants_label.then(|| label.into());
            planner.observe(pose, reading).map_err(Error::msg)?;
            if is_above(pose.site) != first && crossed.is_none() {
                crossed = Some(step);
            }
            if let Some(waist) = planner.found() {
                let off = truth.depth(waist.site.into()).abs();
                flown.is_found = off < FALSE * width;
                flown.is_false = !flown.is_found;
                flown.closing = crossed.filter(|_| flown.is_found).map(|it| step - it);
                break;
            }
        }
        Ok(flown)
    }
}

/// A start anywhere in the area, facing anywhere.
fn start(
    area: &impl planner_core::Workspace,
    sides: [f64; 2],
    rng: &mut ChaCha8Rng,
) -> Result<Pose> {
    loop {
        let [x, z] = sides.map(|side| rng.random_range(10.0..side - 10.0));
        let heading = Heading::from_radians(rng.random_range(0.0..TAU)).map_err(Error::msg)?;
        let pose = Pose::at([x, z], heading).map_err(Error::msg)?;
        if area.contains_disc(pose.site, 8 << 16) {
            return Ok(pose);
        }
    }
}

/// The corners of a survey in tracks a patch's width apart, from the corner nearest to a pose.
fn survey([x, z]: [f64; 2], patch: f64, pose: Pose) -> Result<Vec<Site>> {
    let lanes = libm::ceil(z / (2.0 * patch)).max(1.0);
    let at = Point2::<f64>::from(pose.site);
    let (back, down) = (at.x > x / 2.0, at.y > z / 2.0);
    let mut corners = Vec::new();
    for lane in 0..lanes as u32 {
        let across = z * (f64::from(lane) + 0.5) / lanes;
        for k in [0, 1] {
            let is_far = (lane + k) % 2 == 1;
            let along = if is_far { x - patch } else { patch };
            let along = if back { x - along } else { along };
            let across = if down { z - across } else { across };
            corners.push(Site::metres([along, across]).map_err(Error::msg)?);
        }
    }
    Ok(corners)
}

impl Row {
    /// Of these missions.
    pub fn of(kind: &'static str, p: f64, flown: &[Flown]) -> Self {
        let share = |is: fn(&Flown) -> bool| {
            flown.iter().filter(|it| is(it)).count() as f64 / flown.len() as f64
        };
        let metres = sorted(flown.iter().filter(|it| it.is_found).map(|it| it.metres));
        let at = |percent| metres.get(rank(percent, flown.len())).copied();
        let mut closing: Vec<_> = flown.iter().filter_map(|it| it.closing).collect();
        closing.sort_unstable();
        let is_stuck = |it: &Flown| it.stopped.is_some_and(|it| it != StopReason::OneLabel);
        Self {
            kind,
            p,
            found: share(|it| it.is_found),
            metres: [50, 90, 100].map(at),
            closing: closing.get(closing.len() / 2).copied(),
            false_finds: share(|it| it.is_false),
            empty: share(|it| it.is_empty),
            stuck: share(is_stuck),
        }
    }
}
