//! Extends, halfword packing and multiplies of Armv7E-M.

use armagnac::core::{Effect, Processor, RunError};
use armagnac::instructions::DecodeHelper;
use armagnac::registers::RegisterIndex;

use super::decoder::{Decoded, added};

/// Whether a code is one of the parallel additions and subtractions that lose flags: in armagnac 0.3 those that set GE
/// clear N, Z, C and V. Compilers choose none of them by themselves but the unsigned saturating ones, which set no
/// flags.
pub(super) fn loses_flags(code: u32) -> bool {
    code & 0xff80_f080 == 0xfa80_f000 && code & 0xf0 != 0x50
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
        // UQADD8, UQADD16, UQSUB8, UQSUB16
        0xfa8 | 0xfa9 | 0xfac | 0xfad if code & 0xf0f0 == 0xf050 => added(move |p| {
            p.set(rd, saturating(row, p[rn], p[rm]));
            Ok(Effect::None)
        }),
        0xeac if code & 0x8010 == 0 => {
            let shift = code >> 10 & 0x1c | code >> 6 & 3;
            added(move |p| {
                p.set(rd, pack(column & 2 != 0, p[rn], p[rm], shift));
                Ok(Effect::None)
            })
        }
        0xfb1..=0xfb6 => added(move |p| {
            let [n, m] = [p[rn], p[rm]];
            let (result, saturated) =
                multiply(row, column, n, m, or_zero(p, ra)).ok_or(RunError::InstructionUnknown)?;
            p.set(rd, result);
            if saturated {
                p.registers.psr.set_q(true);
            }
            Ok(Effect::None)
        }),
        0xfbc..=0xfbe => added(move |p| {
            let [low, high] = [p[ra], p[rd]];
            let result = multiply_long(row, column, p[rn], p[rm], low, high);
            let result = result.ok_or(RunError::InstructionUnknown)?;
            p.set(ra, result as u32);
            p.set(rd, (result >> 32) as u32);
            Ok(Effect::None)
        }),
        _ => return None,
    })
}

fn halves(word: u32) -> [i64; 2] {
    [i64::from(word as i16), i64::from((word >> 16) as i16)]
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

/// The unsigned saturating sums and differences of bytes (an even row) or halfwords.
fn saturating(row: u32, n: u32, m: u32) -> u32 {
    let width = if row & 1 == 0 { 8 } else { 16 };
    let most = (1_u32 << width) - 1;
    (0..32 / width).fold(0, |result, lane| {
        let [a, b] = [n, m].map(|word| word >> (lane * width) & most);
        let value = if row & 4 == 0 { (a + b).min(most) } else { a.saturating_sub(b) };
        result | value << (lane * width)
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

/// The multiplies with a result of 32 bits, `a` the addend, and whether they set Q.
fn multiply(row: u32, column: u32, n: u32, m: u32, a: u32) -> Option<(u32, bool)> {
    let addend = i64::from(a as i32);
    let [wide_n, wide_m] = [n, m].map(|word| i64::from(word as i32));
    let ([n0, n1], [m0, m1]) =
        (halves(n), halves(if column & 1 == 0 { m } else { m.rotate_left(16) }));
    let sum = match (row, column) {
        // SMLAxy, SMULxy
        (1, 0..=3) => halves(n)[column as usize >> 1] * m0 + addend,
        // SMLAD, SMUAD
        (2, 0..=1) => n0 * m0 + n1 * m1 + addend,
        // SMLAWy, SMULWy
        (3, 0..=1) => ((wide_n * m0) >> 16) + addend,
        // SMLSD, SMUSD
        (4, 0..=1) => n0 * m0 - n1 * m1 + addend,
        // SMMLA, SMMUL; SMMLS: these drop the low word, rounded if the column is odd, and leave Q.
        (5 | 6, 0..=1) => {
            let product = if row == 5 { wide_n * wide_m } else { -(wide_n * wide_m) };
            let rounding = i64::from(column) << 31;
            let sum = (addend << 32).wrapping_add(product).wrapping_add(rounding);
            return Some(((sum >> 32) as u32, false));
        }
        _ => return None,
    };
    Some((sum as u32, i32::try_from(sum).is_err()))
}

/// The multiplies that accumulate in 64 bits. Armagnac's own SMLAL does not wrap.
fn multiply_long(row: u32, column: u32, n: u32, m: u32, low: u32, high: u32) -> Option<u64> {
    let sum = u64::from(high) << 32 | u64::from(low);
    let ([n0, n1], [m0, m1]) =
        (halves(n), halves(if column & 1 == 0 { m } else { m.rotate_left(16) }));
    let product = match (row, column) {
        // SMLAL
        (4, 0) => i64::from(n as i32) * i64::from(m as i32),
        // SMLALxy
        (4, 8..=11) => halves(n)[column as usize >> 1 & 1] * m0,
        // SMLALD, SMLSLD
        (4, 12..=13) => n0 * m0 + n1 * m1,
        (5, 12..=13) => n0 * m0 - n1 * m1,
        // UMLAL
        (6, 0) => (u64::from(n) * u64::from(m)).cast_signed(),
        // UMAAL
        (6, 6) => return Some(u64::from(n) * u64::from(m) + u64::from(low) + u64::from(high)),
        _ => return None,
    };
    Some(sum.wrapping_add_signed(product))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extends_add_to_a_register_by_lanes() {
        assert_eq!(extend(0, 1, 0x1234_ffff), 0);
        assert_eq!(extend(1, 1, 0x1234_ffff), 0x0001_0000);
        assert_eq!(extend(2, 0x0001_0001, 0x00ff_0080), 0x0000_ff81);
        assert_eq!(extend(3, 0x0001_ffff, 0x12ff_3401), 0x0100_0000);
        assert_eq!(extend(4, 1, 0x80), 0xffff_ff81);
        assert_eq!(extend(5, 1, 0x180), 0x81);
    }

    #[test]
    fn packing_shifts_the_second_operand() {
        assert_eq!(pack(false, 0x1111_2222, 0x3333_4444, 4), 0x3334_2222);
        assert_eq!(pack(true, 0x1111_2222, 0x3333_4444, 16), 0x1111_3333);
        assert_eq!(pack(true, 0x1111_2222, 0x8333_4444, 0), 0x1111_ffff);
    }

    #[test]
    fn multiplies_take_halves_and_set_q() {
        let (n, m) = (0x0002_fffd, 0x0005_0007);
        let product = |column| multiply(1, column, n, m, 0).unwrap().0 as i32;
        assert_eq!([0, 1, 2, 3].map(product), [-21, -15, 14, 10]);
        assert_eq!(multiply(1, 0, 1, 1, i32::MAX as u32), Some((0x8000_0000, true)));
        assert_eq!(multiply(2, 1, n, m, 1), Some((0, false)));
        assert_eq!(multiply(2, 0, 0x8000_8000, 0x8000_8000, 0), Some((0x8000_0000, true)));
        assert_eq!(multiply(3, 1, 0x0003_0000, m, 0), Some((15, false)));
        assert_eq!(multiply(4, 0, n, m, 0), Some((-31i32 as u32, false)));
        assert_eq!(multiply(5, 0, 0x8000_0000, 2, 3), Some((2, false)));
        assert_eq!(multiply(5, 1, 0x4000_0000, 2, 3), Some((4, false)));
        assert_eq!(multiply(6, 0, 1, 1, 0), Some((u32::MAX, false)));
        assert_eq!(multiply(7, 0, 1, 1, 0), None);
    }

    #[test]
    fn long_multiplies_wrap_and_carry() {
        let max = u32::MAX;
        assert_eq!(multiply_long(6, 6, max, max, max, max), Some(u64::MAX));
        assert_eq!(multiply_long(4, 0, max, 1, 0, 0), Some(u64::MAX));
        assert_eq!(multiply_long(4, 0, 1, 1, max, 0x7fff_ffff), Some(1 << 63));
        assert_eq!(multiply_long(6, 0, max, max, 1, 0), Some(0xffff_fffe_0000_0002));
        assert_eq!(multiply_long(4, 9, 3, 0x0005_0007, 1, 0), Some(16));
        assert_eq!(multiply_long(4, 10, 0x0003_0001, 0x0005_0007, 1, 0), Some(22));
        assert_eq!(multiply_long(5, 13, 0x0002_0003, 0x0005_0007, 0, 0), Some(1));
    }

    #[test]
    fn lanes_saturate_by_themselves() {
        assert_eq!(saturating(1, 0xfff0_0003, 0x0020_0004), 0xffff_0007);
        assert_eq!(saturating(5, 0x0010_0003, 0x0020_0002), 0x0000_0001);
        assert_eq!(saturating(0, 0xf0_01_80_7f, 0x20_02_80_01), 0xff_03_ff_80);
        assert_eq!(saturating(4, 0x10_05_00_80, 0x20_02_01_01), 0x00_03_00_7f);
    }
}
