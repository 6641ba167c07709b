//! Extends, halfword packing and multiplies of Armv7E-M: those that compilers choose for our programs.

use armagnac::core::{Effect, Processor, RunError};
use armagnac::instructions::DecodeHelper;
use armagnac::registers::RegisterIndex;

use super::decoder::{Decoded, added};

/// Whether a code is one of the parallel additions and subtractions that lose flags: in armagnac 0.3 those that set GE
/// clear N, Z, C and V. Compilers choose none of them by themselves but the saturating ones, which set no
/// flags.
pub(super) fn loses_flags(code: u32) -> bool {
    code & 0xff80_f080 == 0xfa80_f000 && !matches!(code & 0xf0, 0x10 | 0x50)
}

pub(super) fn decode(code: u32) -> Option<Decoded> {
    let [rn, ra, rd, rm] = [16, 12, 8, 0].map(|lowest| code.reg4(lowest));
    let (row, column) = (code >> 20 & 7, code >> 4 & 0xf);
    // A register that is not there reads as zero.
    let or_zero =
        |processor: &Processor, r: RegisterIndex| if r.is_pc() { 0 } else { processor[r] };
    Some(match code >> 20 {
        0xfa0..=0xfa5 if code & 0xf0c0 == 0xf080 => added(move |p| {
            let m = p[rm].rotate_right(8 * (column & 3));
            p.set(rd, extend(row, or_zero(p, rn), m));
            Ok(Effect::None)
        }),
        // QADD8, QADD16, QSUB8, QSUB16, and the same of unsigned numbers
        0xfa8 | 0xfa9 | 0xfac | 0xfad if matches!(code & 0xf0f0, 0xf010 | 0xf050) => {
            added(move |p| {
                p.set(rd, saturating(row, column == 1, [p[rn], p[rm]]));
                Ok(Effect::None)
            })
        }
        // SMLABB, SMLABT, SMLATB, SMLATT; and SMULBB and so on without an addend
        0xfb1 if column < 4 => added(move |p| {
            let half =
                |word: u32, is_top: bool| i32::from((word >> (16 * u32::from(is_top))) as i16);
            let product = half(p[rn], column & 2 != 0) * half(p[rm], column & 1 != 0);
            p.set(rd, or_zero(p, ra).wrapping_add(product as u32));
            Ok(Effect::None)
        }),
        0xeac if code & 0x8010 == 0 => {
            let shift = code >> 10 & 0x1c | code >> 6 & 3;
            added(move |p| {
                p.set(rd, pack(column & 2 != 0, p[rn], p[rm], shift));
                Ok(Effect::None)
            })
        }
        // SMMLA, SMMUL; SMMLS: these drop the low word, rounded if the column is odd.
        0xfb5 | 0xfb6 if column < 2 => added(move |p| {
            let product = i64::from(p[rn] as i32) * i64::from(p[rm] as i32);
            let addend = i64::from(or_zero(p, ra)) << 32;
            let sum = addend.wrapping_add(if row == 5 { product } else { -product });
            p.set(rd, (sum.wrapping_add(i64::from(column) << 31) >> 32) as u32);
            Ok(Effect::None)
        }),
        // SMLAL, UMLAL, UMAAL. Armagnac's own SMLAL does not wrap.
        0xfbc | 0xfbe if column == 0 || (row, column) == (6, 6) => added(move |p| {
            let [n, m, low, high] = [rn, rm, ra, rd].map(|r| u64::from(p[r]));
            let signed = i64::from(p[rn] as i32) * i64::from(p[rm] as i32);
            let result = match (row, column) {
                (4, _) => (high << 32 | low).wrapping_add_signed(signed),
                (_, 0) => (high << 32 | low).wrapping_add(n * m),
                _ => n * m + low + high,
            };
            p.set(ra, result as u32);
            p.set(rd, (result >> 32) as u32);
            Ok(Effect::None)
        }),
        0xfb1..=0xfb6 | 0xfbc..=0xfbe => added(|_| Err(RunError::InstructionUnknown)),
        _ => return None,
    })
}

/// SXTAH, UXTAH, SXTAB16, UXTAB16, SXTAB, UXTAB, in the order of their codes.
fn extend(row: u32, n: u32, m: u32) -> u32 {
    let lanes = |low: u16, high: u16| {
        u32::from((n as u16).wrapping_add(low))
            | u32::from(((n >> 16) as u16).wrapping_add(high)) << 16
    };
    let signed = |byte: u32| i16::from(byte as i8) as u16;
    match row {
        0 => n.wrapping_add(m as i16 as u32),
        1 => n.wrapping_add(m & 0xffff),
        2 => lanes(signed(m), signed(m >> 16)),
        3 => lanes(m as u16 & 0xff, (m >> 16) as u16 & 0xff),
        4 => n.wrapping_add(m as i8 as u32),
        _ => n.wrapping_add(m & 0xff),
    }
}

/// The saturating sums and differences of bytes (an even row) or halfwords.
fn saturating(row: u32, is_signed: bool, [n, m]: [u32; 2]) -> u32 {
    let width = if row & 1 == 0 { 8 } else { 16 };
    let ones = (1_i32 << width) - 1;
    let (least, most) = if is_signed { (-(1 << (width - 1)), ones >> 1) } else { (0, ones) };
    (0..32 / width).fold(0, |result, lane| {
        let [a, b] = [n, m].map(|word| {
            let bits = (word >> (lane * width)) as i32 & ones;
            if bits > most { bits - ones - 1 } else { bits }
        });
        let value = if row & 4 == 0 { a + b } else { a - b };
        result | ((value.clamp(least, most) & ones) as u32) << (lane * width)
    })
}

/// PKHBT and PKHTB.
fn pack(top_of_n: bool, n: u32, m: u32, shift: u32) -> u32 {
    if top_of_n {
        // A shift of 0 stands for 32.
        let m = (m as i32 >> if shift == 0 { 31 } else { shift }) as u32;
        n & 0xffff_0000 | m & 0xffff
    } else {
        (m << shift) & 0xffff_0000 | n & 0xffff
    }
}
