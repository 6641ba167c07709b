//! Under a tolerance, observing a label and waking cost at most ten times as much as without. This holds on a core with
//! floating point and on one without, for true labels and for doubtful ones.

use tests::budget::tolerance::{Costs, POSITIONS};
use tests::cases;
use tests::emulator::missions;

/// Under a tolerance they may cost so many times what they cost without.
const MOST: u64 = 10;

#[test]
fn observing_and_waking_cost_ten_times_as_much_at_most() {
    let mut failures = Vec::new();
    for (core, target) in missions::CORES {
        let Some(programs) = missions::build(target) else { continue };
        let elf = programs("standard");
        for doubtful in [false, true] {
            let of = |position| Costs::of(core, &elf, doubtful, position, cases(2, 20));
            let without = of(0.0);
            println!("{core:?}, doubtful {doubtful}, no tolerance: {without:?}");
            for position in POSITIONS {
                let with = of(position);
                println!("{core:?}, doubtful {doubtful}, {position} m: {with:?}");
                let is_cheap = with.observe_worst <= MOST * without.observe_worst
                    && with.wake_worst <= MOST * without.wake_worst;
                if !is_cheap {
                    failures
                        .push(format!("{core:?}, {doubtful}, {position} m: {with:?}, {without:?}"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
