//! The missions whose steps are timed.
//!
//! A few standard fields drawn at random give the median, and the hardest missions that are known the worst case. A
//! long run searches for these. It flies many such fields, and chooses four kinds of mission among thousands more that
//! it flies on the host:
//!
//! - those whose plans look at the most actions;
//! - those that most often find no action and recover;
//! - those that end because no action is left;
//! - those with the most hypotheses.
//!
//! Every other of these thousands starts in a corner of the area, facing out of it. Missions of fronts are of the kinds
//! of [`fronts`].

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_4;

use host_sim::campaign::standard_field::{self, SIDE_M};
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::names::FanName;
use host_sim::mission::results::Ending;
use host_sim::world::errors::CUT;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::nalgebra::Point2;
use planner_core::{Heading, Policy, Pose, Site, Tolerance};
use rayon::prelude::*;
use tests::fronts;

use super::timing::Flight;
use crate::emulator::Call;

const SEED: u64 = 9;

/// Fields drawn at random that any run flies.
pub const FEW: u64 = 4;

/// What is flown.
#[derive(Clone, Copy, Debug)]
pub struct Workload {
    /// Its name among the hardest missions.
    pub name: &'static str,
    /// What is timed.
    pub figures: Figures,
    /// Whether it is flown on other cores than the Cortex-M4F.
    pub everywhere: bool,
    /// Who plans.
    pub algorithm: Algorithm,
    /// How hypotheses choose together.
    pub policy: Policy,
    /// Steps at most.
    pub steps: u32,
    /// Fields drawn at random that a search flies.
    pub random: u64,
    /// Fields beyond these among which it chooses.
    pub searched: u64,
    /// How many it chooses of each of the four kinds.
    pub sought: usize,
    /// Calls of the planner after which a mission is broken off, if it is: estimates take long.
    pub calls: Option<usize>,
    /// The unicycle's actions.
    pub grid: FanName,
    /// How labels are flipped, if they are.
    pub noise: Option<NoiseModel>,
    /// Standard deviations of reported positions, metres, by turns; the planner is told a tolerance of three.
    pub positions: &'static [f64],
    /// Metres of front that are watched, if it is not gone along.
    pub watch: Option<f64>,
}

/// Names of figures, and the calls of a flight that each is about.
pub type Figures = &'static [(&'static str, fn(&Flight) -> Vec<Call>)];

/// Seven labels in ten are true, and all near the oracle's points.
pub const DOUBT: Option<NoiseModel> =
    Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });

/// Algorithm 1 of the program `small`.
const SMALL: Workload = Workload {
    name: "small",
    figures: &[
        ("plan", |it| it.plans.clone()),
        ("observe", |it| it.observations.clone()),
        ("estimate", |it| it.estimates.clone()),
    ],
    everywhere: true,
    algorithm: Algorithm::Cfc,
    policy: Policy::MixtureOfOwn,
    steps: 12,
    random: 1_000,
    searched: 4_000,
    sought: 4,
    calls: None,
    grid: FanName::Paper,
    noise: None,
    positions: &[0.0],
    watch: None,
};

const SMALL_LOOKAHEAD: Workload = Workload {
    name: "small, look-ahead, paper's fan",
    figures: &[("lookahead_plan", |it| it.plans.clone())],
    everywhere: false,
    algorithm: Algorithm::Lookahead,
    random: 40,
    searched: 2_000,
    sought: 3,
    ..SMALL
};

const SMALL_FINE: Workload = Workload {
    name: "small, look-ahead, fine fan",
    figures: &[("lookahead_fine_plan", |it| it.plans.clone())],
    everywhere: true,
    grid: FanName::Fine,
    ..SMALL_LOOKAHEAD
};

const STANDARD: Workload = Workload {
    name: "standard, Algorithm 1",
    figures: &[
        ("cfc_plan", |it| it.plans.clone()),
        ("cfc_observe", |it| it.observations.clone()),
        ("cfc_estimate", |it| it.estimates.clone()),
    ],
    steps: 32,
    random: 60,
    searched: 1_000,
    sought: 2,
    ..SMALL
};

const STANDARD_LOOKAHEAD: Workload = Workload {
    name: "standard, look-ahead, paper's fan",
    steps: 32,
    random: 10,
    searched: 1_000,
    ..SMALL_LOOKAHEAD
};

const STANDARD_FINE: Workload = Workload {
    name: "standard, look-ahead, fine fan",
    figures: SMALL_FINE.figures,
    everywhere: true,
    grid: FanName::Fine,
    ..STANDARD_LOOKAHEAD
};

/// Up to the plan after ten plans and observations.
const JOINT: Workload = Workload {
    name: "standard, joint, 10 labels",
    figures: &[("joint_plan_at_10", |it| it.plan_at_label(10))],
    everywhere: false,
    algorithm: Algorithm::Scc,
    policy: Policy::Joint,
    steps: 11,
    random: 1_000,
    searched: 400,
    sought: 4,
    calls: Some(21),
    noise: DOUBT,
    ..SMALL
};

const SCC: Workload = Workload {
    name: "standard, 32 labels",
    figures: &[("scc_observe_at_32", |it| it.observation_of_label(32))],
    steps: 32,
    random: 100,
    searched: 1_000,
    calls: Some(64),
    ..JOINT
};

/// What a tolerance costs: to observe a label, and to take all labels in again when a planner wakes. That is the sum of
/// the observations, at most.
const TOLERANT: Workload = Workload {
    name: "standard, tolerance",
    figures: &[
        ("cfc_tolerance_observe", |it| it.observations.clone()),
        ("cfc_tolerance_wake", Flight::all_observations),
    ],
    policy: Policy::Joint,
    steps: 32,
    random: 6,
    searched: 0,
    positions: &[0.01, 0.05, 0.3],
    ..SMALL
};

const TRACK: Workload = Workload {
    name: "track",
    algorithm: Algorithm::Track,
    steps: 80,
    random: 40,
    searched: 0,
    ..SMALL
};

const LARGE: Workload = Workload {
    name: "large, Algorithm 1",
    everywhere: false,
    steps: 64,
    random: 20,
    searched: 200,
    sought: 1,
    ..STANDARD
};

impl Workload {
    /// Those of a program.
    pub fn of(program: &str) -> &'static [Self] {
        match program {
            "small" => &[SMALL, SMALL_LOOKAHEAD, SMALL_FINE],
            "standard" => &[
                STANDARD,
                STANDARD_LOOKAHEAD,
                STANDARD_FINE,
                Self {
                    name: "standard, look-ahead, noise",
                    figures: &[("noisy_plan", |it| it.plans.clone())],
                    noise: DOUBT,
                    ..STANDARD_FINE
                },
                JOINT,
                Self {
                    name: "standard, mixture, 10 labels",
                    figures: &[("mixture_plan_at_10", |it| it.plan_at_label(10))],
                    policy: Policy::MixtureOfOwn,
                    ..JOINT
                },
                SCC,
                Self {
                    name: "standard, estimates",
                    figures: &[("scc_estimate_at_32", |it| it.estimates.clone())],
                    // Seven million instructions each.
                    random: 60,
                    searched: 0,
                    calls: None,
                    ..SCC
                },
                TOLERANT,
                Self {
                    name: "standard, doubtful, tolerance",
                    figures: &[
                        ("scc_tolerance_observe", |it| it.observations.clone()),
                        ("scc_tolerance_wake", Flight::all_observations),
                    ],
                    algorithm: Algorithm::Scc,
                    noise: DOUBT,
                    ..TOLERANT
                },
            ],
            "track" => &[TRACK],
            "watch" => &[Self { name: "watch", everywhere: false, watch: Some(20.0), ..TRACK }],
            "large" => &[
                LARGE,
                // For the stack: what all 2,081 hypotheses take of it does not grow with the labels.
                Self {
                    name: "large, Algorithm 2",
                    figures: &[],
                    algorithm: Algorithm::Scc,
                    steps: 4,
                    random: 4,
                    searched: 0,
                    noise: DOUBT,
                    ..LARGE
                },
            ],
            // What the others do is measured in these.
            _ => &[],
        }
    }

    /// The numbers of the missions that a search flies.
    pub fn candidates(&self) -> Vec<u64> {
        let searched = self.random..self.random + self.searched;
        let mut ranked: Vec<(u64, [u32; 4])> =
            searched.into_par_iter().map(|number| (number, rank(&self.mission(number)))).collect();
        let mut sought = BTreeSet::new();
        for kind in 0..4 {
            ranked.sort_by_key(|(number, ranks)| (Reverse(ranks[kind]), *number));
            let best = ranked.iter().filter(|it| it.1[kind] > 0).take(self.sought);
            sought.extend(best.map(|it| it.0));
        }
        (0..self.random).chain(sought).collect()
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
        (mission.policy, mission.vehicle) = (self.policy, self.grid.into());
        mission.noise = self.noise;
        let position = self.positions[number as usize % self.positions.len()];
        mission.errors.position = position;
        mission.config.tolerance = Tolerance::new(CUT * position).expect("a distance");
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

/// What makes a mission hard: the most that a plan looked at (of a vote it is the last plan, when hypotheses are the
/// most), recoveries, these if it stopped early, and hypotheses of Algorithm 2 in the end.
fn rank(mission: &Mission) -> [u32; 4] {
    let (mut looked, mut recoveries) = (0, 0);
    let votes = mission.algorithm == Algorithm::Scc;
    let flown = mission.fly(|step, _| {
        let examined = step.motion.examined;
        looked = if votes { examined } else { looked.max(examined) };
        recoveries += u32::from(step.motion.recovery.is_some());
    });
    let Ok(flown) = flown else { return [looked, recoveries, 0, 0] };
    let stopped = if flown.ending == Ending::Steps { 0 } else { 1 + recoveries };
    let table = flown.belief.hypotheses().filter(|_| votes);
    [looked, recoveries, stopped, table.map_or(0, |table| table.iter().len() as u32)]
}
