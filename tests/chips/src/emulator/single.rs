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
