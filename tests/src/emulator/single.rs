//! Single-precision arithmetic as the floating-point unit does it from reset: rounds to nearest,
//! keeps subnormals, propagates NaNs.
//!
//! The host's arithmetic is IEEE's, so results agree but for NaNs, whose signs and payloads IEEE
//! leaves open. The sticky exception flags are not kept.

/// What an invalid operation on numbers gives.
const DEFAULT_NAN: u32 = 0x7fc0_0000;
const QUIET: u32 = 0x0040_0000;

/// The result of an operation, where it is a NaN replaced by the one that the unit gives: the first
/// signaling operand, else the first quiet one, made quiet; else the default.
pub(super) fn settle(result: f32, operands: &[f32]) -> f32 {
    if !result.is_nan() {
        return result;
    }
    let mut nans = operands.iter().map(|it| it.to_bits()).filter(|&it| f32::from_bits(it).is_nan());
    let signaling = nans.clone().find(|it| it & QUIET == 0);
    let bits = signaling.or_else(|| nans.next()).unwrap_or(DEFAULT_NAN);
    f32::from_bits(bits | QUIET)
}

pub(super) fn add(a: f32, b: f32) -> f32 {
    settle(a + b, &[a, b])
}

pub(super) fn subtract(a: f32, b: f32) -> f32 {
    settle(a - b, &[a, b])
}

pub(super) fn multiply(a: f32, b: f32) -> f32 {
    settle(a * b, &[a, b])
}

pub(super) fn divide(a: f32, b: f32) -> f32 {
    settle(a / b, &[a, b])
}

pub(super) fn square_root(a: f32) -> f32 {
    settle(a.sqrt(), &[a])
}

/// `addend + a * b`, rounded once.
pub(super) fn fused(addend: f32, a: f32, b: f32) -> f32 {
    // Infinity times zero is invalid: a quiet addend does not hide that.
    let invalid = (a * b).is_nan() && !a.is_nan() && !b.is_nan();
    let quiet = addend.is_nan() && addend.to_bits() & QUIET != 0;
    if invalid && quiet {
        return f32::from_bits(DEFAULT_NAN);
    }
    settle(a.mul_add(b, addend), &[addend, a, b])
}

/// N, Z, C and V of a comparison, the highest bit first.
#[expect(clippy::float_cmp, reason = "it is a comparison that is made here")]
pub(super) fn compare(a: f32, b: f32) -> u32 {
    if a == b {
        0b0110
    } else if a < b {
        0b1000
    } else if a > b {
        0b0010
    } else {
        0b0011
    }
}

/// To an integer, saturated; NaN gives 0.
pub(super) fn to_integer(value: f32, signed: bool, toward_zero: bool) -> u32 {
    let value = if toward_zero { value } else { value.round_ties_even() };
    if signed { (value as i32).cast_unsigned() } else { value as u32 }
}

pub(super) fn from_integer(bits: u32, signed: bool) -> f32 {
    if signed { bits.cast_signed() as f32 } else { bits as f32 }
}

/// The constant that eight bits of an instruction stand for: sign, three bits of exponent, four of
/// fraction.
pub(super) fn immediate(bits: u32) -> f32 {
    let exponent = if bits & 0x40 == 0 { 0x4000_0000 } else { 0x3e00_0000 };
    f32::from_bits((bits & 0x80) << 24 | exponent | (bits & 0x3f) << 19)
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET_A: u32 = 0xffc0_0001;
    const QUIET_B: u32 = 0x7fc0_0002;
    const SIGNALING: u32 = 0x7f80_0003;

    #[test]
    fn a_comparison_sets_the_flags() {
        assert_eq!(compare(1.0, 2.0), 0b1000);
        assert_eq!(compare(2.0, 1.0), 0b0010);
        assert_eq!(compare(0.0, -0.0), 0b0110);
        assert_eq!(compare(f32::NAN, 1.0), 0b0011);
        assert_eq!(compare(f32::NEG_INFINITY, f32::INFINITY), 0b1000);
    }

    #[test]
    fn conversions_saturate_and_round() {
        let signed = |v| to_integer(v, true, true) as i32;
        assert_eq!([1.9, -1.9, 3e9, -3e9, f32::NAN].map(signed), [1, -1, i32::MAX, i32::MIN, 0]);
        assert_eq!([-1.0, 5e9].map(|v| to_integer(v, false, true)), [0, u32::MAX]);
        assert_eq!([0.5, 1.5, 2.5].map(|v| to_integer(v, true, false)), [0, 2, 2]);
        assert_eq!(from_integer(u32::MAX, true).to_bits(), (-1.0f32).to_bits());
        assert_eq!(from_integer(0x0100_0003, false).to_bits(), 16_777_220.0f32.to_bits());
    }

    #[test]
    fn nans_are_those_of_the_unit() {
        let [a, b, s] = [QUIET_A, QUIET_B, SIGNALING].map(f32::from_bits);
        assert_eq!(add(a, b).to_bits(), QUIET_A);
        assert_eq!(subtract(1.0, b).to_bits(), QUIET_B);
        assert_eq!(multiply(a, s).to_bits(), SIGNALING | QUIET);
        assert_eq!(divide(0.0, 0.0).to_bits(), DEFAULT_NAN);
        assert_eq!(square_root(-1.0).to_bits(), DEFAULT_NAN);
        assert_eq!(fused(a, f32::INFINITY, 0.0).to_bits(), DEFAULT_NAN);
        assert_eq!(fused(a, 1.0, b).to_bits(), QUIET_A);
    }

    #[test]
    fn fused_rounds_once_and_subnormals_are_kept() {
        let a = 1.0 + f32::EPSILON;
        assert!(add(-1.0 - 2.0 * f32::EPSILON, multiply(a, a)).to_bits() == 0);
        assert!(fused(-1.0 - 2.0 * f32::EPSILON, a, a) > 0.0);
        assert_eq!(divide(f32::MIN_POSITIVE, 2.0).to_bits(), 0x0040_0000);
    }

    #[test]
    fn immediates_expand() {
        let bits = [0x70, 0x00, 0xf0, 0x60, 0x7f].map(|it| immediate(it).to_bits());
        assert_eq!(bits, [1.0f32, 2.0, -1.0, 0.5, 1.9375].map(f32::to_bits));
    }
}
