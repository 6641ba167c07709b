//! Thumb-2 as far as the flow of control and the stack pointer go.

/// Where an instruction leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    Next,
    /// Only there.
    Branch(u32),
    /// There, or on.
    Either(u32),
    Call(u32),
    /// To what a register holds, and back.
    CallRegister,
    /// To what a register holds.
    JumpRegister,
    Return,
    /// By the table that follows, with entries of this many bytes.
    Table(u32),
    Trap,
    /// Not known here.
    Unknown,
}

/// What an instruction does to the stack pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stack {
    Still,
    Grows(u32),
    Shrinks(u32),
    /// By a register's value, which is not known.
    Moves,
}

/// A part of a constant that an instruction makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Constant {
    /// The low half of a register; the other becomes zero.
    Low(u8, u16),
    /// The high half of a register.
    High(u8, u16),
    /// The word at an address.
    Literal(u32),
}

/// An instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Instruction {
    pub(super) size: u32,
    pub(super) flow: Flow,
    pub(super) stack: Stack,
    pub(super) constant: Option<Constant>,
    /// How many of the instructions that follow are conditional.
    pub(super) conditions: u32,
}

impl Instruction {
    fn plain(size: u32) -> Self {
        Self { size, flow: Flow::Next, stack: Stack::Still, constant: None, conditions: 0 }
    }

    /// The instruction at an address, of which the second halfword may belong to the next.
    pub(super) fn decode(pc: u32, first: u16, second: u16) -> Self {
        if is_wide(first) {
            wide(pc, u32::from(first), u32::from(second))
        } else {
            narrow(pc, u32::from(first))
        }
    }
}

/// Whether an instruction has a second halfword.
pub(super) fn is_wide(first: u16) -> bool {
    first >= 0xe800
}

const SP: u32 = 13;
const LR: u32 = 14;
const PC: u32 = 15;

/// The low `bits` of a value with their sign.
fn signed(value: u32, bits: u32) -> u32 {
    ((value << (32 - bits)).cast_signed() >> (32 - bits)).cast_unsigned()
}

fn narrow(pc: u32, code: u32) -> Instruction {
    let mut it = Instruction::plain(2);
    let ahead = |offset: u32| pc.wrapping_add(4).wrapping_add(offset);
    let registers = 4 * (code & 0x1ff).count_ones();
    let (high, source) = ((code >> 4 & 8) | (code & 7), code >> 3 & 0xf);
    match code {
        0x4400..=0x44ff if high == PC => it.flow = Flow::JumpRegister,
        0x4400..=0x44ff | 0x4600..=0x46ff if high == SP => it.stack = Stack::Moves,
        0x4600..=0x46ff if high == PC => it.flow = jump(source),
        0x4700..=0x477f => it.flow = jump(source),
        0x4780..=0x47ff => it.flow = Flow::CallRegister,
        0x4800..=0x4fff => {
            it.constant = Some(Constant::Literal((pc & !3) + 4 + 4 * (code & 0xff)));
        }
        0xb000..=0xb07f => it.stack = Stack::Shrinks(4 * (code & 0x7f)),
        0xb080..=0xb0ff => it.stack = Stack::Grows(4 * (code & 0x7f)),
        0xb400..=0xb5ff => it.stack = Stack::Grows(registers),
        0xbc00..=0xbdff => {
            it.stack = Stack::Shrinks(registers);
            if code & 0x100 != 0 {
                it.flow = Flow::Return;
            }
        }
        0xbf00..=0xbfff if code & 0xf != 0 => it.conditions = 4 - (code & 0xf).trailing_zeros(),
        0xde00..=0xdeff => it.flow = Flow::Trap,
        0xd000..=0xddff => it.flow = Flow::Either(ahead(signed(code & 0xff, 8) << 1)),
        0xe000..=0xe7ff => it.flow = Flow::Branch(ahead(signed(code & 0x7ff, 11) << 1)),
        // These are no miscellaneous instructions, nor are those between reversals.
        0xb600..=0xb65f | 0xb680..=0xb8ff | 0xba40..=0xbabf => it.flow = Flow::Unknown,
        _ if code & 0xf500 == 0xb100 => {
            it.flow = Flow::Either(ahead((code >> 3 & 0x40) | (code >> 2 & 0x3e)));
        }
        _ => {}
    }
    it
}

fn jump(register: u32) -> Flow {
    if register == LR { Flow::Return } else { Flow::JumpRegister }
}

fn wide(pc: u32, first: u32, second: u32) -> Instruction {
    match first >> 9 & 0xf {
        0b0100 => multiple(first, second),
        // Data processing by shifted registers; by registers, with multiplies and divides.
        0b0101 | 0b1101 => guarded(first, second),
        0b0110 | 0b0111 => coprocessor(first, second),
        0b1000..=0b1011 if second & 0x8000 != 0 => branch(pc, first, second),
        0b1000..=0b1011 => immediate(first, second),
        0b1100 => single(pc, first, second),
        _ => Instruction { flow: Flow::Unknown, ..Instruction::plain(4) },
    }
}

/// Instructions whose target register is where data processing has it.
fn guarded(first: u32, second: u32) -> Instruction {
    let multiplies = first & 0xff00 == 0xfb00;
    let stack = if !multiplies && second >> 8 & 0xf == SP { Stack::Moves } else { Stack::Still };
    Instruction { stack, ..Instruction::plain(4) }
}

/// The stack after a move by some bytes, up or down.
fn moved(up: bool, bytes: u32) -> Stack {
    if up { Stack::Shrinks(bytes) } else { Stack::Grows(bytes) }
}

/// Load and store of several and of two registers; branches by tables.
fn multiple(first: u32, second: u32) -> Instruction {
    let mut it = Instruction::plain(4);
    let (on_stack, up, back) = (first & 0xf == SP, first & 0x80 != 0, first & 0x20 != 0);
    if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 {
        it.flow = Flow::Table(1 + (second >> 4 & 1));
    } else if first & 0x40 != 0 {
        if on_stack && back {
            it.stack = moved(up, 4 * (second & 0xff));
        }
    } else {
        if on_stack && back {
            it.stack = moved(up, 4 * second.count_ones());
        }
        if first & 0x10 != 0 && second & 0x8000 != 0 {
            it.flow = if on_stack { Flow::Return } else { Flow::JumpRegister };
        }
    }
    it
}

/// The floating-point unit is all there is. Of its instructions only loads and stores of several
/// registers move the stack pointer.
fn coprocessor(first: u32, second: u32) -> Instruction {
    if !matches!(second >> 8 & 0xf, 10 | 11) {
        return Instruction { flow: Flow::Unknown, ..Instruction::plain(4) };
    }
    let transfers = first & 0x200 == 0;
    let on_stack =
        transfers && first & 0xf == SP && first & 0x20 != 0 && first & 0x100 != first << 1 & 0x100;
    let stack = if on_stack { moved(first & 0x80 != 0, 4 * (second & 0xff)) } else { Stack::Still };
    Instruction { stack, ..Instruction::plain(4) }
}

fn branch(pc: u32, first: u32, second: u32) -> Instruction {
    let mut it = Instruction::plain(4);
    let (sign, one, two) = (first >> 10 & 1, second >> 13 & 1, second >> 11 & 1);
    let low = second & 0x7ff;
    // The two bits below the sign are stored as whether they differ from it.
    let far = (sign << 24)
        | ((1 ^ one ^ sign) << 23)
        | ((1 ^ two ^ sign) << 22)
        | ((first & 0x3ff) << 12)
        | (low << 1);
    let near = (sign << 20) | (two << 19) | (one << 18) | ((first & 0x3f) << 12) | (low << 1);
    let ahead = |offset: u32| pc.wrapping_add(4).wrapping_add(offset);
    it.flow = match second & 0xd000 {
        0xd000 => Flow::Call(ahead(signed(far, 25))),
        0x9000 => Flow::Branch(ahead(signed(far, 25))),
        0x8000 if first >> 6 & 0xf < 14 => Flow::Either(ahead(signed(near, 21))),
        0x8000 if first & 0xfff0 == 0xf7f0 && second & 0xf000 == 0xa000 => Flow::Trap,
        // Special registers, hints and barriers
        0x8000 if matches!(first & 0xffe0, 0xf380 | 0xf3a0 | 0xf3e0) => Flow::Next,
        _ => Flow::Unknown,
    };
    it
}

fn immediate(first: u32, second: u32) -> Instruction {
    let mut it = Instruction::plain(4);
    let (from, to) = (first & 0xf, second >> 8 & 0xf);
    let twelve = (first << 1 & 0x800) | (second >> 4 & 0x700) | (second & 0xff);
    if first & 0x200 == 0 {
        // Add, subtract; the other operations do not make stack pointers.
        it.stack = match first >> 5 & 0xf {
            _ if to != SP => Stack::Still,
            0b1000 if from == SP => Stack::Shrinks(expanded(twelve)),
            0b1101 if from == SP => Stack::Grows(expanded(twelve)),
            _ => Stack::Moves,
        };
        return it;
    }
    let half = (from << 12 | twelve) as u16;
    match first >> 4 & 0x1f {
        0b00100 => it.constant = Some(Constant::Low(to as u8, half)),
        0b01100 => it.constant = Some(Constant::High(to as u8, half)),
        0b00000 if from == SP && to == SP => it.stack = Stack::Shrinks(twelve),
        0b01010 if from == SP && to == SP => it.stack = Stack::Grows(twelve),
        _ if to == SP => it.stack = Stack::Moves,
        _ => {}
    }
    it
}

/// The constant that twelve bits stand for.
fn expanded(twelve: u32) -> u32 {
    let byte = twelve & 0xff;
    match twelve >> 8 {
        0 => byte,
        1 => byte << 16 | byte,
        2 => byte << 24 | byte << 8,
        3 => byte << 24 | byte << 16 | byte << 8 | byte,
        _ => (0x80 | twelve & 0x7f).rotate_right(twelve >> 7),
    }
}

/// Load and store of one register.
fn single(pc: u32, first: u32, second: u32) -> Instruction {
    let mut it = Instruction::plain(4);
    let (base, target) = (first & 0xf, second >> 12);
    let word = first & 0x160 == 0x40;
    let loads = first & 0x10 != 0;
    let back = first & 0x80 == 0 && second & 0x900 == 0x900 && base != PC;
    if back && base == SP {
        it.stack = moved(second & 0x200 != 0, second & 0xff);
    }
    if loads && word && target == PC {
        it.flow = if back && base == SP { Flow::Return } else { Flow::JumpRegister };
    } else if loads && word && base == PC {
        let offset = second & 0xfff;
        let here = (pc & !3) + 4;
        let at = if first & 0x80 != 0 { here + offset } else { here.wrapping_sub(offset) };
        it.constant = Some(Constant::Literal(at));
    }
    if loads && word && target == SP {
        it.stack = Stack::Moves;
    }
    it
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stack_pointer() {
        for (name, code, stack) in [
            ("push {r4, r5, lr}", [0xb530, 0], Stack::Grows(12)),
            ("pop {r4, pc}", [0xbd10, 0], Stack::Shrinks(8)),
            ("sub sp, #16", [0xb084, 0], Stack::Grows(16)),
            ("add sp, #16", [0xb004, 0], Stack::Shrinks(16)),
            ("stmdb sp!, {r8, r9, r10, r11}", [0xe92d, 0x0f00], Stack::Grows(16)),
            ("ldmia sp!, {r8, r9}", [0xe8bd, 0x0300], Stack::Shrinks(8)),
            ("str lr, [sp, #-4]!", [0xf84d, 0xed04], Stack::Grows(4)),
            ("vpush {d8, d9}", [0xed2d, 0x8b04], Stack::Grows(16)),
            ("vpop {d8, d9}", [0xecbd, 0x8b04], Stack::Shrinks(16)),
            ("sub.w sp, sp, #4096", [0xf5ad, 0x5d80], Stack::Grows(4096)),
            ("subw sp, sp, #1580", [0xf2ad, 0x6d2c], Stack::Grows(1580)),
            ("add sp, r4", [0x44a5, 0], Stack::Moves),
            ("mov sp, r7", [0x46bd, 0], Stack::Moves),
            ("ldr r0, [sp, #4]", [0x9801, 0], Stack::Still),
            ("str r0, [r1, #-4]!", [0xf841, 0x0d04], Stack::Still),
        ] {
            assert_eq!(Instruction::decode(0x100, code[0], code[1]).stack, stack, "{name}");
        }
    }
}
