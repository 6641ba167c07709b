//! The missions whose steps are timed.
//!
//! In a long run, standard fields drawn at random give the median. For the worst case, many more such fields are flown
//! on the host, and four kinds of mission are chosen from them:
//!
//! - those whose plans look at the most actions;
//! - those that most often find no action and recover;
//! - those that end because no action is left;
//! - those with the most hypotheses.
//!
//! Every other of these starts in a corner of the area, facing out of it. Missions of fronts are of the kinds of
//! [`fronts`]. Any other run flies the hardest missions that
//! are known.

use std::cmp::Reverse;
use std::f64::consts::FRAC_PI_4;

use host_sim::campaign::standard_field::{self, SIDE_M};
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::results::Ending;
use host_sim::world::errors::CUT;
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::Point2;
use planner_core::{AnyVehicle, Heading, Policy, Pose, Site, Tolerance};
use rayon::prelude::*;

use crate::fronts;

const SEED: u64 = 9;

/// What is flown.
#[derive(Clone, Copy, Debug)]
pub struct Workload {
    /// Who plans.
    pub algorithm: Algorithm,
    /// How hypotheses choose together.
    pub policy: Policy,
    /// Steps at most.
    pub steps: u32,
    /// Fields drawn at random.
    pub random: u64,
    /// Fields that are searched for a worse case.
    pub searched: u64,
    /// How many of these are taken, for each of the four kinds.
    pub sought: usize,
    /// Calls of the planner after which a mission is broken off, if it is: estimates take long.
    pub calls: Option<usize>,
    /// What moves.
    pub vehicle: AnyVehicle,
    /// How labels are flipped, if they are.
    pub noise: Option<NoiseModel>,
    /// Standard deviation of a reported position, metres; the planner is told a tolerance of three.
    pub position: f64,
    /// Metres of front that are watched, if it is not gone along.
    pub watch: Option<f64>,
}

/// Seven labels in ten are true, and all near the oracle's points.
pub const DOUBT: Option<NoiseModel> =
    Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });

impl Workload {
    /// The numbers of the missions that are drawn at random, and of those sought.
    pub fn missions(&self) -> (Vec<u64>, Vec<u64>) {
        let random = (0..self.random).collect();
        let others: Vec<u64> = (self.random..self.random + self.searched).collect();
        let mut flown: Vec<(u64, Rank)> = others
            .into_par_iter()
            .map(|number| (number, Rank::of(&self.mission(number))))
            .collect();
        let mut sought = Vec::new();
        let ranks: [fn(&Rank) -> u32; 4] = [
            |it| it.last,
            |it| it.recoveries,
            |it| it.stopped * (1 + it.recoveries),
            |it| it.hypotheses,
        ];
        for rank in ranks {
            flown.sort_by_key(|(number, it)| (Reverse(rank(it)), *number));
            let best = flown.iter().filter(|(_, it)| rank(it) > 0).take(self.sought);
            sought.extend(best.map(|(number, _)| *number));
        }
        sought.sort_unstable();
        sought.dedup();
        (random, sought)
    }

    /// The mission with a number.
    ///
    /// # Panics
    /// When positions err by more than a tolerance can be.
    pub fn mission(&self, number: u64) -> Mission {
        if !self.algorithm.seeks_line() {
            let following = fronts::following(SEED, number, self.steps);
            return Mission { watch: self.watch, ..following };
        }
        let mut mission = standard_field::standard(SEED, number, self.algorithm, self.steps);
        (mission.policy, mission.vehicle) = (self.policy, self.vehicle);
        mission.noise = self.noise;
        mission.errors.position = self.position;
        mission.config.tolerance = Tolerance::new(CUT * self.position).expect("a distance");
        if number >= self.random && number % 2 == 1 {
            mission.start = facing_out(number / 2 % 4);
        }
        mission
    }
}

/// A corner of the standard area, facing away from its middle.
fn facing_out(corner: u64) -> Pose {
    let (right, top) = (corner & 1, corner >> 1);
    let at = Point2::new(right as f64, top as f64) * SIDE_M;
    let heading = FRAC_PI_4 * [5.0, 7.0, 3.0, 1.0][corner as usize];
    Pose {
        site: Site::try_from(at).expect("within the lattice"),
        heading: Heading::from_radians(heading).expect("an angle"),
    }
}

/// What makes a mission hard.
#[derive(Clone, Copy, Debug, Default)]
struct Rank {
    /// The most that a plan looked at. For a vote it is the last plan, when hypotheses are the most.
    last: u32,
    recoveries: u32,
    stopped: u32,
    /// Hypotheses of Algorithm 2 in the end.
    hypotheses: u32,
}

impl Rank {
    fn of(mission: &Mission) -> Self {
        let mut rank = Self::default();
        let flown = mission.fly(|step, _| {
            let examined = step.motion.examined;
            rank.last = if mission.algorithm == Algorithm::Scc {
                examined
            } else {
                rank.last.max(examined)
            };
            rank.recoveries += u32::from(step.motion.recovery.is_some());
        });
        let Ok(flown) = flown else { return rank };
        rank.stopped = u32::from(flown.ending != Ending::Steps);
        let table = flown.belief.hypotheses().filter(|_| mission.algorithm == Algorithm::Scc);
        rank.hypotheses = table.map_or(0, |table| table.iter().len() as u32);
        rank
    }
}
