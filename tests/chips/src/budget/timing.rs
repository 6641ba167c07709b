//! Time: the instructions that the planner needs for the steps of missions.
//!
//! The count covers the functions of `station::seam`, from their first instruction to their return. It leaves out the
//! cost of reading a counter. The ticks that the program itself reports are the same plus a constant, and that is
//! checked here. So is that the mission's trace is the host's.

use std::cmp::Reverse;

use host_sim::hil::player::Played;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::results::{Ending, Results};
use host_sim::mission::trace;
use rayon::prelude::*;
use tests::{is_long, is_updating};

use super::book::{Book, Place};
use super::footprint::SEAM;
use super::workload::{FEW, Workload};
use crate::emulator::missions::trace_here;
use crate::emulator::{Call, Core, Emulator, RAM_END};
use crate::program::image::Image;

/// Instructions that two readings of the counter take, at most.
const COUNTER: u64 = 64;

/// Under a tolerance observing and waking may cost so many times what they cost without.
const MOST: u64 = 10;

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
    /// The deepest stack so far, bytes.
    pub stack: u32,
}

/// Flies missions in the emulator, each from a reset, to its end or for so many calls.
///
/// # Panics
/// When one does not fly as on the host, or the program's own count is not that of its calls.
pub fn fly(
    core: Core,
    elf: &[u8],
    numbers: &[u64],
    mission: impl Fn(u64) -> Mission + Sync,
    most: Option<usize>,
) -> Vec<Flight> {
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
        let mission = mission(*number);
        let played =
            emulator.fly(&mission).unwrap_or_else(|error| panic!("mission {number}: {error}"));
        let calls = emulator.calls();
        let of = |role: usize| -> Vec<Call> {
            calls.iter().filter(|it| roles[role].contains(&it.function)).copied().collect()
        };
        let (plans, observations, estimates) = (of(0), of(1), of(2));
        check(&played, &plans, &observations, most.is_none());
        let results = played.recording.results;
        if most.is_none() {
            let there = trace::lines(&results);
            assert_eq!(there, trace_here(&mission), "mission {number}: {core:?}, the host");
        }
        let stack = RAM_END - emulator.lowest_stack();
        Flight { number: *number, results, plans, observations, estimates, stack }
    };
    // An emulator's first mission is slow, as it has decoded nothing yet: few of them, used often.
    let share = numbers.len().div_ceil(2 * rayon::current_num_threads());
    numbers.par_iter().with_min_len(share.max(1)).map_init(start, fly).collect()
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
    pub fn plan_at_label(&self, labels: usize) -> Vec<Call> {
        let plan = self.step_of_label(labels).and_then(|step| self.plans.get(step + 1));
        plan.into_iter().copied().collect()
    }

    /// The observation of label number `labels`.
    pub fn observation_of_label(&self, labels: usize) -> Vec<Call> {
        let observation = self.step_of_label(labels).and_then(|step| self.observations.get(step));
        observation.into_iter().copied().collect()
    }

    /// All observations as one call.
    pub fn all_observations(&self) -> Vec<Call> {
        let sum = |of: fn(&Call) -> u64| self.observations.iter().map(of).sum();
        let (instructions, cycles) = (sum(|it| it.instructions), sum(|it| it.cycles));
        vec![Call { function: 0, instructions, cycles }]
    }

    fn step_of_label(&self, labels: usize) -> Option<usize> {
        let steps = self.results.steps.iter().enumerate();
        let mut sampled = steps.filter(|(_, it)| it.label.is_some()).map(|(number, _)| number);
        sampled.nth(labels - 1)
    }
}

/// Has the workloads of a program flown on a core, and enters what their calls took: the median of a few missions, and
/// the worst of these and the hardest that are known. The Cortex-M0 is slow here: unless figures are written, it flies
/// the hardest alone, along no fronts and with exact positions. Returns the deepest stack.
///
/// # Panics
/// When there is nothing to fly.
pub fn time(
    book: &mut Book,
    place: Place<'_>,
    mut fly: impl FnMut(&Workload, &[u64]) -> Vec<Flight>,
) -> u32 {
    let is_first = place[0] == Core::M4F.name();
    let is_slow = place[0] == Core::M0.name() && !is_updating() && !is_long();
    let searches = is_first && is_long();
    let is_flown = |it: &&Workload| {
        let is_dear = it.algorithm == Algorithm::Track || it.positions.len() > 1;
        (is_first || it.everywhere) && !(is_slow && is_dear)
    };
    let mut stack = 0;
    for workload in Workload::of(place[1]).iter().filter(is_flown) {
        let is_tolerant = workload.positions.len() > 1;
        let few = if is_tolerant { 2 * workload.positions.len() as u64 } else { FEW };
        let few: Vec<u64> = (0..few).filter(|_| is_tolerant || !is_slow).collect();
        let others = if searches { workload.candidates() } else { book.hardest(workload.name) };
        let others: Vec<u64> = others.into_iter().filter(|it| !few.contains(it)).collect();
        let flights = fly(workload, &[&*few, &others].concat());
        assert!(!flights.is_empty(), "{}: no mission is known", workload.name);
        stack = flights.iter().map(|it| it.stack).fold(stack, u32::max);
        for (figure, calls) in workload.figures {
            let sorted = |flights: &[Flight]| {
                let calls = flights.iter().flat_map(calls);
                let mut sorted: Vec<_> = calls.map(|it| it.instructions).collect();
                sorted.sort_unstable();
                sorted
            };
            let random = sorted(&flights[..few.len()]);
            if let Some(median) = random.get(random.len() / 2) {
                book.figure(place, &format!("{figure}_median"), *median);
            }
            let (all, name) = (sorted(&flights), format!("{figure}_worst"));
            book.figure(place, &name, *all.last().expect("it is called"));
            if is_first {
                let cycles = flights.iter().flat_map(calls).map(|it| it.cycles).max();
                book.cycles(place, &name, cycles.unwrap_or(0));
            }
            if searches {
                // Of equals the mission with the smallest number.
                let most = |it: &&Flight| calls(it).iter().map(|call| call.instructions).max();
                let hardest = flights.iter().max_by_key(|it| (most(it), Reverse(it.number)));
                book.harder(workload.name, hardest.map_or(0, |it| it.number));
            }
        }
        if is_tolerant {
            let without = Workload { positions: &[0.0], ..*workload };
            compare(book, place, &flights, &fly(&without, &few));
        }
    }
    stack
}

/// Compares what a tolerance costs with what the same missions cost without.
fn compare(book: &mut Book, place: Place<'_>, with: &[Flight], without: &[Flight]) {
    let observations = |it: &Flight| it.observations.clone();
    for (what, calls) in
        [("observe", observations as fn(&_) -> _), ("wake", Flight::all_observations)]
    {
        let [with, without] = [with, without].map(|flights| {
            flights.iter().flat_map(calls).map(|it| it.instructions).max().unwrap_or(0)
        });
        if with > MOST * without {
            book.fail(format!("{place:?}, {what}: {with} under a tolerance, {without} without"));
        }
    }
}
