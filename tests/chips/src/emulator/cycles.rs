//! What a Cortex-M4 would take, by the table of its technical reference manual (ARM DDI 0439B, 3.3.1,
//! and 7.2.3 for floating point). An estimate, for:
//!
//! - memory without wait states, and no one else at the bus;
//! - a pipeline refill, the table's `P` of 1 to 3, of 3;
//! - loads and stores of one register: 2 cycles, and 1 right after another such, as they pipeline;
//! - divisions of integers: the longest, 12 (the table has 2 to 12);
//! - no stall where a floating-point result is used at once, nor for an address just made;
//! - instructions that a condition passes over take as long as if they were done.
//!
//! So it is at the long end of the table. At the short end, refills of 1 and divisions of 2, plans take 8 to
//! 11 % less and observations 5 to 6 %.

/// A pipeline refill.
pub(super) const REFILL: u32 = 3;

/// What an instruction takes if it does not branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cost {
    /// Bytes of the instruction.
    pub(super) size: u8,
    pub(super) cycles: u8,
    /// Accesses memory once, so that it pipelines with its like.
    pub(super) single: bool,
}

/// The cost of an instruction; of a branch that is taken, without the refill.
pub(super) fn cost(first: u16, second: u16) -> Cost {
    let (first, second) = (u32::from(first), u32::from(second));
    let size = if first < 0xe800 { 2 } else { 4 };
    let single = matches!(first, 0x4800..=0x9fff | 0xf800..=0xf9ff);
    Cost { size, cycles: cycles(first, second) as u8, single }
}

fn cycles(first: u32, second: u32) -> u32 {
    match first {
        0x4800..=0x9fff | 0xf800..=0xf9ff => 2,
        0xb400..=0xb5ff | 0xbc00..=0xbdff => 1 + (first & 0x1ff).count_ones(),
        0xc000..=0xcfff => 1 + (first & 0xff).count_ones(),
        // Tables read their entry; other loads and stores are of two registers, or exclusive.
        0xe800..=0xe9ff if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 => 2,
        0xe800..=0xe9ff if first & 0x40 != 0 && first & 0x120 == 0 => 2,
        0xe800..=0xe9ff if first & 0x40 != 0 => 3,
        0xe800..=0xe9ff => 1 + second.count_ones(),
        0xec00..=0xefff if second & 0xe00 == 0xa00 => float(first, second),
        0xfb90..=0xfb9f | 0xfbb0..=0xfbbf => 12,
        _ => 1,
    }
}

/// The cycles of an instruction of the floating-point unit.
fn float(first: u32, second: u32) -> u32 {
    let words = second & 0xff;
    match first {
        // Two core registers at once.
        0xec40..=0xec5f => 2,
        // One register, or a pair; or several.
        0xec00..=0xedff if first & 0x120 == 0x100 => {
            if second & 0x100 == 0 {
                2
            } else {
                3
            }
        }
        0xec00..=0xedff => 1 + words,
        0xee00..=0xeeff if second & 0x10 == 0 => match first & 0xb0 {
            // Division; multiplication with addition, in one and in two roundings; square root.
            0x80 => 14,
            0x00 | 0x10 | 0x90 | 0xa0 => 3,
            0xb0 if first & 0xf == 1 && second & 0xc0 == 0xc0 => 14,
            _ => 1,
        },
        _ => 1,
    }
}
