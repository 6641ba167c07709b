//! Instructions that armagnac 0.3 has but leaves undefined in cases that programs reach: shifts by 32 and more, and
//! divisions by zero, and flags that are set from a register.

use armagnac::core::{Effect, ItState, Processor};
use armagnac::instructions::DecodeHelper;
use armagnac::registers::RegisterIndex;

use super::decoder::{Decoded, added};

/// A shift: the result and the carry of a value, an amount and the carry so far.
type Shift = fn(u32, u32, bool) -> (u32, bool);

/// Instructions of one halfword.
pub(super) fn decode_narrow(code: u32, state: ItState) -> Option<Decoded> {
    let [rd, rm] = [0, 3].map(|lowest| code.reg3(lowest));
    let set_flags = !state.in_it_block();
    Some(match code >> 6 {
        0b01_0000_0100 => by_register(arithmetic_right, [rd, rd, rm], set_flags),
        0b01_0000_0111 => by_register(rotate_right, [rd, rd, rm], set_flags),
        // ASR by an immediate 0, which stands for 32
        0b00_0100_0000 => by_32(rd, rm, set_flags),
        _ => return None,
    })
}

/// Instructions of one word.
pub(super) fn decode_wide(code: u32) -> Option<Decoded> {
    let [rn, rd, rm] = [16, 8, 0].map(|lowest| code.reg4(lowest));
    let fields = code & 0xf0f0;
    let set_flags = code >> 20 & 1 == 1;
    Some(match code >> 20 {
        0xfa4 | 0xfa5 if fields == 0xf000 => by_register(arithmetic_right, [rd, rn, rm], set_flags),
        0xfa6 | 0xfa7 if fields == 0xf000 => by_register(rotate_right, [rd, rn, rm], set_flags),
        0xea4 | 0xea5 if rn.is_pc() && code & 0x70f0 == 0x0020 => by_32(rd, rm, set_flags),
        0xfb9 if fields == 0xf0f0 => added(move |p| {
            let [n, m] = [rn, rm].map(|r| p[r].cast_signed());
            p.set(rd, if m == 0 { 0 } else { n.wrapping_div(m).cast_unsigned() });
            Ok(Effect::None)
        }),
        0xfbb if fields == 0xf0f0 => added(move |p| {
            p.set(rd, p[rn].checked_div(p[rm]).unwrap_or(0));
            Ok(Effect::None)
        }),
        // MSR of the flags: compilers keep them in a register over a call.
        0xf38 if code & 0xffff == 0x8800 => added(move |p| {
            p.registers.psr.set_apsr(p[rn]);
            Ok(Effect::None)
        }),
        _ => return None,
    })
}

fn by_register(shift: Shift, [rd, rn, rm]: [RegisterIndex; 3], set_flags: bool) -> Decoded {
    added(move |p| {
        let amount = p[rm] & 0xff;
        Ok(set_shifted(p, shift, rd, p[rn], amount, set_flags))
    })
}

fn by_32(rd: RegisterIndex, rm: RegisterIndex, set_flags: bool) -> Decoded {
    added(move |p| Ok(set_shifted(p, arithmetic_right, rd, p[rm], 32, set_flags)))
}

fn set_shifted(
    p: &mut Processor,
    shift: Shift,
    rd: RegisterIndex,
    value: u32,
    amount: u32,
    set_flags: bool,
) -> Effect {
    let (result, carry) = shift(value, amount, p.registers.psr.c());
    p.set(rd, result);
    if set_flags {
        p.registers.psr.set_nz(result).set_c(carry);
    }
    Effect::None
}

fn arithmetic_right(value: u32, amount: u32, carry: bool) -> (u32, bool) {
    // Sign bits fill from the left without end.
    let wide = i64::from(value.cast_signed());
    let carry = if amount == 0 { carry } else { wide >> (amount - 1).min(63) & 1 == 1 };
    ((wide >> amount.min(63)) as u32, carry)
}

fn rotate_right(value: u32, amount: u32, carry: bool) -> (u32, bool) {
    let result = value.rotate_right(amount % 32);
    (result, if amount == 0 { carry } else { result >> 31 == 1 })
}
