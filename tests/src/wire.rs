//! A wire between chip and vehicle in virtual time, which loses, cuts, spoils, doubles and delays frames.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use host_sim::hil::faults::{Faults, Spoiler};
use planner_core::link::frame::Frame;

/// How long the chip waits for an answer before it asks again.
pub const WAIT: Duration = Duration::from_millis(100);

/// Which way a frame goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// From the vehicle.
    ToChip,
    /// From the chip.
    ToVehicle,
}

/// A wire in virtual time, which spoils frames.
#[derive(Debug)]
pub struct Wire {
    /// The time.
    pub now: Duration,
    /// When the chip's wait is over.
    until: Duration,
    under_way: BTreeMap<(Duration, u64), (Way, Vec<u8>)>,
    launched: u64,
    /// After this many frames it is cut for good, in one way or both.
    pub cut: Option<(u64, Option<Way>)>,
    spoilers: [Spoiler; 2],
    arrived: VecDeque<u8>,
}

impl Wire {
    /// A wire with faults in the order that a seed gives.
    pub fn new(faults: Faults, seed: u64) -> Self {
        Self {
            now: Duration::ZERO,
            until: Duration::ZERO,
            under_way: BTreeMap::new(),
            launched: 0,
            cut: None,
            spoilers: [0, 1].map(|way| Spoiler::new(faults, seed, way)),
            arrived: VecDeque::new(),
        }
    }

    /// The chip sends a frame and begins to wait.
    pub fn ask(&mut self, frame: &[u8]) {
        self.until = self.now + WAIT;
        self.launch(Way::ToVehicle, frame);
    }

    fn launch(&mut self, way: Way, frame: &[u8]) {
        for (late, bytes) in self.spoilers[usize::from(way == Way::ToChip)].spoil(frame) {
            self.launched += 1;
            let is_cut = |(after, only): (u64, Option<Way>)| {
                self.launched > after && only.is_none_or(|only| only == way)
            };
            if !self.cut.is_some_and(is_cut) {
                self.under_way.insert((self.now + late, self.launched), (way, bytes));
            }
        }
    }

    /// The next byte that the chip hears of a vehicle; `None` once the wait is over.
    pub fn answer(&mut self, mut vehicle: impl FnMut(u8) -> Option<Frame>) -> Option<u8> {
        loop {
            if let Some(byte) = self.arrived.pop_front() {
                return Some(byte);
            }
            let until = self.until;
            let Some(due) = self.under_way.first_entry().filter(|it| it.key().0 < until) else {
                self.now = until;
                return None;
            };
            let ((at, _), (way, bytes)) = due.remove_entry();
            self.now = self.now.max(at);
            match way {
                Way::ToChip => self.arrived.extend(bytes),
                Way::ToVehicle => {
                    for frame in bytes.into_iter().filter_map(&mut vehicle) {
                        self.launch(Way::ToChip, frame.bytes());
                    }
                }
            }
        }
    }

    /// Drops what has arrived at the chip: its power failed.
    pub fn forget(&mut self) {
        self.arrived.clear();
    }
}

/// The faults of a bad link: it loses, cuts, spoils, doubles and delays frames.
///
/// # Panics
/// Never.
pub fn bad() -> Faults {
    "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms".parse().expect("faults")
}
