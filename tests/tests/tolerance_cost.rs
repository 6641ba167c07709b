//! What a tolerance costs: to observe a label, and to take all labels in again when a planner wakes.

use host_sim::mission::algorithm::Algorithm;
use planner_core::motion::any_vehicle::AnyVehicle;
use planner_core::motion::unicycle::Unicycle;
use planner_core::planner::scc::Policy;
use tests::budget::timing::{self, Flight};
use tests::budget::workload::{DOUBT, Workload};
use tests::cases;
use tests::emulator::missions;

const SCRATCH: &str = env!("CARGO_TARGET_TMPDIR");

/// Observing and waking under a tolerance may cost so many times what they cost without.
const MOST: u64 = 10;

/// Labels of a mission: the table then has all its hypotheses.
const LABELS: u32 = 32;

/// The mean and the worst of the last observations, and the worst of all observations of a mission together: waking
/// takes in the same labels in the same order.
fn costs(flights: &[Flight]) -> [u64; 3] {
    let last = flights.iter().filter_map(|it| it.observations.last());
    let last: Vec<u64> = last.map(|it| it.instructions).collect();
    let waking = |it: &Flight| it.observations.iter().map(|it| it.instructions).sum::<u64>();
    let mean = last.iter().sum::<u64>() / last.len() as u64;
    let worst = last.into_iter().max().unwrap_or(0);
    [mean, worst, flights.iter().map(waking).max().unwrap_or(0)]
}

/// On both cores, for true labels and for doubtful ones, with positions that err little and much.
#[test]
fn observing_and_waking_cost_ten_times_as_much_at_most() {
    let mut failures = Vec::new();
    for (core, target) in missions::CORES {
        let Some(programs) = missions::build(SCRATCH, target) else { continue };
        let elf = programs("standard");
        for (name, algorithm, noise) in
            [("true labels", Algorithm::Cfc, None), ("doubtful labels", Algorithm::Scc, DOUBT)]
        {
            let of = |position| {
                let workload = Workload {
                    algorithm,
                    policy: Policy::Joint,
                    steps: LABELS,
                    random: 0,
                    searched: 0,
                    sought: 0,
                    calls: None,
                    vehicle: AnyVehicle::Unicycle(Unicycle::paper()),
                    noise,
                    position,
                };
                let numbers: Vec<u64> = (0..cases(2, 20)).map(|number| 2 * number).collect();
                costs(&timing::fly_on(core, &elf, &workload, &numbers))
            };
            let without = of(0.0);
            println!("{core:?}, {name}, no tolerance: last mean, last worst, waking {without:?}");
            for position in [0.01, 0.05, 0.3] {
                let with = of(position);
                println!("{core:?}, {name}, positions err by {position} m: {with:?}");
                for (what, (with, without)) in
                    ["mean", "worst", "waking"].iter().zip(with.into_iter().zip(without))
                {
                    if with > MOST * without {
                        failures.push(format!(
                            "{core:?}, {name}, {position} m, {what}: {with}, {without} without"
                        ));
                    }
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
