//! What a tolerance costs: to observe a label, and to take all labels in again when a planner wakes.

use host_sim::mission::algorithm::Algorithm;
use planner_core::{AnyVehicle, Policy, Unicycle};

use crate::budget::timing::{self, Flight};
use crate::budget::workload::{DOUBT, Workload};
use crate::emulator::Core;

/// Deviations of positions, metres: little and much.
pub const POSITIONS: [f64; 3] = [0.01, 0.05, 0.3];

/// Labels of a mission: the table then has all its hypotheses.
const LABELS: u32 = 32;

/// What observing and waking cost, instructions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Costs {
    /// The mean of the last observations.
    pub last: u64,
    /// The most that an observation takes.
    pub observe_worst: u64,
    /// The most that waking takes after a whole mission. It takes in the labels of the mission in their order, so it is
    /// the sum of its observations, at most.
    pub wake_worst: u64,
}

impl Costs {
    /// The costs in some missions that the program `standard` flies, with labels that are true or doubtful and
    /// positions with a deviation.
    ///
    /// # Panics
    /// As [`timing::fly_on`].
    pub fn of(core: Core, elf: &[u8], doubtful: bool, position: f64, missions: u64) -> Self {
        let workload = Workload {
            algorithm: if doubtful { Algorithm::Scc } else { Algorithm::Cfc },
            policy: Policy::Joint,
            steps: LABELS,
            random: 0,
            searched: 0,
            sought: 0,
            calls: None,
            vehicle: AnyVehicle::Unicycle(Unicycle::paper()),
            noise: if doubtful { DOUBT } else { None },
            position,
            watch: None,
        };
        let numbers: Vec<u64> = (0..missions).map(|number| 2 * number).collect();
        let flights = timing::fly_on(core, elf, &workload, &numbers);
        let each = |it: &Flight| -> Vec<u64> {
            it.observations.iter().map(|call| call.instructions).collect()
        };
        let last: Vec<u64> = flights.iter().filter_map(|it| each(it).last().copied()).collect();
        Self {
            last: last.iter().sum::<u64>() / (last.len() as u64).max(1),
            observe_worst: flights.iter().flat_map(each).max().unwrap_or(0),
            wake_worst: flights.iter().map(|it| each(it).iter().sum()).max().unwrap_or(0),
        }
    }

    /// The most of each with positions that err.
    ///
    /// # Panics
    /// As [`of`](Self::of).
    pub fn worst_under_tolerance(core: Core, elf: &[u8], doubtful: bool, missions: u64) -> Self {
        POSITIONS.iter().fold(Self::default(), |most, &position| {
            let it = Self::of(core, elf, doubtful, position, missions);
            Self {
                last: most.last.max(it.last),
                observe_worst: most.observe_worst.max(it.observe_worst),
                wake_worst: most.wake_worst.max(it.wake_worst),
            }
        })
    }
}
