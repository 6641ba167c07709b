//! Instructions that armagnac 0.3 has but leaves undefined in cases that programs reach: shifts by 32 and more,
//! divisions by zero, loads to the program counter, special registers.

use armagnac::core::{Effect, ItState, Processor, RunError};
use armagnac::instructions::DecodeHelper;
use armagnac::registers::RegisterIndex;

use super::decoder::{Decoded, added};

/// The special register that masks interrupts. 0 to 3 are the flags, alone or with other registers.
const PRIMASK: u32 = 16;

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
    let (fields, special) = (code & 0xf0f0, code & 0xff);
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
        // LDR to the program counter, with an offset of twelve bits or an indexed one of eight
        0xf8d if code & 0xf000 == 0xf000 && !rn.is_pc() => {
            added(move |p| jump(p, p[rn].wrapping_add(code & 0xfff)))
        }
        0xf85 if code & 0xf800 == 0xf800 && !rn.is_pc() => {
            let (index, up, write_back) = code.puw();
            added(move |p| {
                let (base, offset) = (p[rn], code & 0xff);
                let moved = if up { base.wrapping_add(offset) } else { base.wrapping_sub(offset) };
                if write_back {
                    p.set(rn, moved);
                }
                jump(p, if index { moved } else { base })
            })
        }
        // MSR
        0xf38 if code & 0xff00 == 0x8800 && special == PRIMASK => added(move |p| {
            let mask = p[rn] & 1 == 1;
            p.registers.primask.set_pm(mask);
            Ok(Effect::None)
        }),
        0xf38 if code & 0xff00 == 0x8800 && special < 4 => added(move |p| {
            let flags = p[rn] >> 27;
            p.registers.psr.set_flags(flags as u8);
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

fn jump(processor: &mut Processor, address: u32) -> Result<Effect, RunError> {
    let target = processor.read_u32_aligned(address)?;
    processor.load_write_pc(target)?;
    Ok(Effect::Branch)
}

#[cfg(test)]
mod tests {
    use armagnac::core::Config;

    use super::*;

    #[test]
    fn shifts_know_every_amount() {
        let high = 0x8000_0001;
        assert_eq!(arithmetic_right(high, 0, true), (high, true));
        assert_eq!(arithmetic_right(high, 1, false), (0xc000_0000, true));
        assert_eq!(arithmetic_right(high, 32, false), (u32::MAX, true));
        assert_eq!(arithmetic_right(!high, 255, true), (0, false));
        assert_eq!(rotate_right(high, 0, false), (high, false));
        assert_eq!(rotate_right(high, 1, false), (0xc000_0000, true));
        assert_eq!(rotate_right(high, 64, false), (high, true));
    }

    #[test]
    fn division_by_zero_gives_zero() {
        let mut processor = Processor::new(Config::v7em());
        // sdiv r2, r0, r1; udiv r2, r0, r1
        for (code, n, m, expected) in [
            (0xfb90_f2f1, 7, 0, 0),
            (0xfb90_f2f1, 0x8000_0000, u32::MAX, 0x8000_0000),
            (0xfb90_f2f1, u32::MAX - 6, 2, u32::MAX - 2),
            (0xfbb0_f2f1, 7, 0, 0),
            (0xfbb0_f2f1, u32::MAX, 2, 0x7fff_ffff),
        ] {
            (processor.registers.r0, processor.registers.r1) = (n, m);
            decode_wide(code).unwrap().execute(&mut processor).unwrap();
            assert_eq!(processor.registers.r2, expected);
        }
    }

    #[test]
    fn a_load_to_the_program_counter_jumps() {
        let mut processor = Processor::new(Config::v7em());
        processor.map_ram(0x2000_0000, 16).unwrap();
        processor.write_u32_aligned(0x2000_0004, 0x0800_0101).unwrap();
        processor.set_sp(0x2000_0004);
        // ldr pc, [sp], #4
        decode_wide(0xf85d_fb04).unwrap().execute(&mut processor).unwrap();
        assert_eq!([processor.pc(), processor.sp()], [0x0800_0100, 0x2000_0008]);
    }
}
