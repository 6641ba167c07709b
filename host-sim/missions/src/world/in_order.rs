//! Floating-point numbers as integers of the same order, that of [`f64::total_cmp`].

/// A number as an integer.
pub(crate) fn in_order(value: f64) -> i64 {
    flipped(value.to_bits() as i64)
}

/// Negative numbers have the sign bit, and grow with the others the wrong way.
fn flipped(bits: i64) -> i64 {
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}
