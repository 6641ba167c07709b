//! What a program takes while it runs: cycles by the table, and each call of functions that are watched.

use super::FLASH;
use super::cycles::{Cost, REFILL, cost};

/// A call of a watched function, from its first instruction to its return, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Call {
    /// Where the function begins.
    pub function: u32,
    /// Instructions executed.
    pub instructions: u64,
    /// Cycles of a Cortex-M4, an estimate.
    pub cycles: u64,
}

/// A call that has not returned yet.
#[derive(Clone, Copy, Debug)]
struct Open {
    call: Call,
    returns: u32,
    stack: u32,
}

#[derive(Debug)]
pub(super) struct Profile {
    /// By halfwords of flash.
    costs: Vec<Cost>,
    watched: Vec<u32>,
    pub(super) cycles: u64,
    pipelined: bool,
    open: Option<Open>,
    pub(super) calls: Vec<Call>,
}

/// Where the core stands between two instructions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub(super) pc: u32,
    pub(super) sp: u32,
    pub(super) lr: u32,
    pub(super) instructions: u64,
}

impl Profile {
    /// For a program in flash, up to where it ends.
    pub(super) fn new(flash: &[u8]) -> Self {
        let halfwords: Vec<u16> =
            flash.chunks_exact(2).map(|it| u16::from_le_bytes([it[0], it[1]])).collect();
        let next = halfwords.iter().skip(1).chain([&0]);
        let costs = halfwords.iter().zip(next).map(|(first, second)| cost(*first, *second));
        Self {
            costs: costs.collect(),
            watched: Vec::new(),
            cycles: 0,
            pipelined: false,
            open: None,
            calls: Vec::new(),
        }
    }

    /// Watches a function from now on. Calls within a watched call are not recorded.
    pub(super) fn watch(&mut self, function: u32) {
        self.watched.push(function & !1);
    }

    /// Records an instruction: its address, and where the core is after it. Returns whether a watched call has returned
    /// with it.
    pub(super) fn executed(&mut self, pc: u32, to: Place) -> bool {
        let at = pc.wrapping_sub(FLASH) as usize / 2;
        let Cost { size, cycles, single } = self.costs[at];
        self.cycles += u64::from(cycles) - u64::from(single && self.pipelined);
        self.pipelined = single;
        if to.pc.wrapping_sub(pc) != u32::from(size) {
            self.cycles += u64::from(REFILL);
        }
        match self.open {
            Some(Open { call, returns, stack }) if (returns, stack) == (to.pc, to.sp) => {
                self.calls.push(Call {
                    instructions: to.instructions - call.instructions,
                    cycles: self.cycles - call.cycles,
                    ..call
                });
                self.open = None;
                return true;
            }
            None if self.watched.contains(&to.pc) => {
                let (instructions, cycles) = (to.instructions, self.cycles);
                let call = Call { function: to.pc, instructions, cycles };
                self.open = Some(Open { call, returns: to.lr & !1, stack: to.sp });
            }
            _ => {}
        }
        false
    }
}
