//! Time: the instructions that the planner needs for the steps of missions that a program flies in the emulator.
//!
//! The count covers the functions of `station::seam`, from their first instruction to their return. It leaves out the
//! cost of reading a counter. The ticks that the program itself reports are the same plus a constant, and a test checks
//! that.

use host_sim::hil::player::Played;
use host_sim::mission::results::{Ending, Results};
use planner_core::StopReason;
use rayon::prelude::*;
use std::cmp::Reverse;

use crate::budget::footprint::SEAM;
use crate::budget::workload::Workload;
use crate::emulator::missions;
use crate::emulator::{Call, Core, Emulator};
use crate::program::image::Image;

/// Instructions that two readings of the counter take, at most.
const COUNTER: u64 = 64;

/// A mission that was flown, with what every call took.
#[derive(Debug)]
pub struct Flight {
    /// The number of the mission in its workload.
    pub number: u64,
    /// The mission as it went.
    pub results: Results,
    /// A plan for each step, and one that found no motion if it ended so.
    pub plans: Vec<Call>,
    /// An observation for each step.
    pub observations: Vec<Call>,
    /// The estimates at the end.
    pub estimates: Vec<Call>,
    /// The lowest stack pointer of its emulator so far.
    pub lowest_stack: u32,
}

/// Flies missions of a workload on a Cortex-M4F, each from a reset, to its end or for the workload's calls.
///
/// # Panics
/// When one does not fly as on the host, or the program's own count is not that of its calls.
pub fn fly(elf: &[u8], workload: &Workload, missions: &[u64]) -> Vec<Flight> {
    fly_on(Core::M4F, elf, workload, missions)
}

/// As [`fly`], on any core.
///
/// # Panics
/// As [`fly`].
pub fn fly_on(core: Core, elf: &[u8], workload: &Workload, missions: &[u64]) -> Vec<Flight> {
    let most = workload.calls;
    let image = Image::read(elf);
    let seam = |role: &str| -> Vec<u32> {
        let named = image.functions().iter().filter(|it| it.name.strip_prefix(SEAM) == Some(role));
        named.map(|it| it.address).collect()
    };
    let roles = ["plan", "observe", "estimates"].map(seam);
    let start = || {
        let mut emulator = Emulator::load(elf, core);
        roles.iter().flatten().for_each(|function| emulator.watch(*function));
        emulator
    };
    let fly = |emulator: &mut Emulator, number: &u64| {
        emulator.restart();
        if let Some(calls) = most {
            emulator.halt_after(calls);
        }
        let mission = workload.mission(*number);
        let played = missions::fly(emulator, &mission).expect("it flies as on the host");
        let calls = emulator.calls();
        let of = |role: usize| -> Vec<Call> {
            calls.iter().filter(|it| roles[role].contains(&it.function)).copied().collect()
        };
        let (plans, observations, estimates) = (of(0), of(1), of(2));
        check(&played, &plans, &observations, most.is_none());
        let lowest_stack = emulator.lowest_stack();
        let (number, results) = (*number, played.recording.results);
        Flight { number, results, plans, observations, estimates, lowest_stack }
    };
    // An emulator's first mission is slow, as it has decoded nothing yet: few of them, used often.
    let share = missions.len().div_ceil(2 * rayon::current_num_threads());
    missions.par_iter().with_min_len(share.max(1)).map_init(start, fly).collect()
}

/// Checks that the program's own count is that of its calls, but for the readings of the counter. A mission that may
/// not be whole has not reported its last observation, nor a plan after it.
fn check(played: &Played, plans: &[Call], observations: &[Call], whole: bool) {
    let steps = played.took.len();
    let stopped = played.recording.results.end.reason != Ending::Steps.name();
    assert_eq!(observations.len(), steps);
    if whole {
        assert_eq!(plans.len(), steps + usize::from(stopped));
    } else {
        assert!((0..=1).contains(&(plans.len() - steps)), "one plan beyond the steps at most");
    }
    let told_of = if whole { steps } else { steps - 1 };
    let told_of_plans = played.took.iter().map(|it| it.plan).zip(plans);
    let told_of_observations = played.took.iter().map(|it| it.observe).zip(observations);
    for (told, counted) in told_of_plans.chain(told_of_observations.take(told_of)) {
        let more = u64::from(told).checked_sub(counted.instructions);
        assert!(more.is_some_and(|it| it < COUNTER), "told {told}, counted {counted:?}");
    }
}

impl Flight {
    /// The plan that was made after `labels` labels.
    pub fn plan_at_label(&self, labels: usize) -> Option<&Call> {
        self.plans.get(self.step_of_label(labels)? + 1)
    }

    /// The observation of label number `labels`.
    pub fn observation_of_label(&self, labels: usize) -> Option<&Call> {
        self.observations.get(self.step_of_label(labels)?)
    }

    fn step_of_label(&self, labels: usize) -> Option<usize> {
        let steps = self.results.steps.iter().enumerate();
        let mut sampled = steps.filter(|(_, it)| it.label.is_some()).map(|(number, _)| number);
        sampled.nth(labels - 1)
    }

    /// Steps whose problem had no feasible action.
    pub fn recoveries(&self) -> usize {
        self.results.steps.iter().filter(|it| it.recovery.is_some()).count()
    }

    /// Whether it ended as there was nothing left to hit.
    pub fn ended_by_resolution(&self) -> bool {
        self.results.end.reason == Ending::Stopped(StopReason::Resolution).name()
    }
}

/// What calls took: the median of some, the worst of all. Each call comes with its mission's number.
#[derive(Clone, Copy, Debug)]
pub struct Took {
    /// Instructions of those drawn at random, the upper of two medians; `None` if none was.
    pub median: Option<u64>,
    /// Instructions, and the mission.
    pub worst: (u64, u64),
    /// Cycles of a Cortex-M4, an estimate, and the mission.
    pub worst_cycles: (u64, u64),
}

impl Took {
    /// The figures of calls in missions drawn at random, and in others.
    pub fn of(random: &[(Call, u64)], others: &[(Call, u64)]) -> Self {
        let mut sorted: Vec<u64> = random.iter().map(|(it, _)| it.instructions).collect();
        sorted.sort_unstable();
        // Of equals the mission with the smallest number.
        let most = |figure: fn(&Call) -> u64| {
            let all = random.iter().chain(others).map(|(call, mission)| (figure(call), *mission));
            all.max_by_key(|(figure, mission)| (*figure, Reverse(*mission))).unwrap_or_default()
        };
        Self {
            median: sorted.get(sorted.len() / 2).copied(),
            worst: most(|it| it.instructions),
            worst_cycles: most(|it| it.cycles),
        }
    }
}
