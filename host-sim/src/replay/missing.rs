//! The text that stands in a file where nothing was measured.

/// Words for a missing value, in upper or lower case.
const WORDS: [&str; 20] = [
    "", "nan", "na", "n/a", "#n/a", "null", "none", "nil", "nodata", "no data", "missing", "nd",
    "n.d.", "bdl", "-", "--", "---", "?", "*", "***",
];

/// Numbers for a missing value that no position has. `fills` has those of measured values.
const NUMBERS: [f64; 2] = [-9999.0, -99999.0];

/// Whether a field says that there is no value.
pub(crate) fn is_missing(field: &str) -> bool {
    WORDS.iter().any(|word| field.eq_ignore_ascii_case(word))
        || field.starts_with("-9999") && field.parse().is_ok_and(is_missing_number)
}

/// Whether a number says that there is no value.
pub(crate) fn is_missing_number(value: f64) -> bool {
    value.is_nan() || NUMBERS.contains(&value)
}
