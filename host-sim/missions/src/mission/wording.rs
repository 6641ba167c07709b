//! Messages about keys of a scenario file and about flags: what was found, and what to write.

use std::fmt::Display;
use std::ops::Range;

use anyhow::{Error, anyhow};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::output::kind;

/// What to write for a key, or for the flag of the same name. A name without a point is that of every key that ends
/// with it.
const EXPECTED: [(&str, &str); 84] = [
    ("--area", "two sides in metres, as 20,40"),
    ("--from", "a whole number, 0 to 1000000000"),
    ("--p-prior", "the a and b of a Beta prior, as 8,2"),
    ("acceptance", "metres above 0"),
    ("algorithm", "the name of a planner in quotation marks, as \"lookahead\""),
    ("area", "a table, { x, z }, { polygon } or { geojson = \"lake.geojson\" }"),
    ("area.x", "two numbers, [smallest, largest], metres"),
    ("area.z", "two numbers, [smallest, largest], metres"),
    ("audit", "true or false"),
    ("band", "a distance in metres, 0 or more"),
    ("baud", "bits per second, a whole number above 0"),
    ("bend", "a distance in metres, 0 to 1024"),
    ("bounds.intercept", "two places in metres, -8191 to 8191, the second larger"),
    ("bounds.slope", "two directions in degrees, -360 to 360, the second larger by less than 180"),
    ("closed", "true or false"),
    ("delayed", "a whole number of labels, 1 or more"),
    ("drift", "a distance in metres, 0 to 1024"),
    ("dropouts", "a probability in [0, 1]"),
    ("errors.heading", RADIANS_OFF),
    ("errors.motion", METRES_OFF),
    ("errors.position", METRES_OFF),
    ("errors.turn", RADIANS_OFF),
    ("fields", "a whole number, 1 to 1000000"),
    ("from", "the number of a label, 1 or more"),
    ("front", "a table, { watch = 20.0 }"),
    ("front.radius", "metres, 0.1 to 1000000, or inf for a straight line"),
    ("front.speed", "metres a step, 0 to 1000"),
    ("garbage", "true, or no such key"),
    ("heading", "an angle in radians"),
    ("horizon", "a whole number, 1 to 12"),
    ("hypotheses", "a whole number, 2 to 65535"),
    ("intercept", "metres"),
    ("inverted", "true, or no such key"),
    ("keep_out[]", "a table, { x, z, radius } or { polygon }"),
    ("keep_out[].radius", "a radius in metres, above 0 and up to 4096"),
    ("label", "-1 or 1"),
    ("labels", "a whole number, 1 to 10000"),
    ("lag", "a distance in metres, 0 to 1024"),
    ("level", "a probability above 0, 0.9999 at most"),
    ("misclassified", "a share of the area, at least 0.00001 and below 1"),
    ("motion_error", METRES_OFF),
    ("noise", "a table, { p = 0.9 }"),
    ("noise.p", "a probability above 0.5, 1 at most, or the [a, b] of a Beta prior"),
    ("off", "true, or no such key"),
    ("oracle", "points, as [{ x = 2.0, z = 1.0, label = -1 }], or [] if none is given"),
    ("oracle[]", "a table, { x = 2.0, z = 1.0, label = -1 }"),
    ("p", "a probability above 0.5, 1 at most; below it, swap the labels"),
    ("patch", "a radius in metres"),
    ("polygon", "corners in metres, [[x, z], [x, z], ...]"),
    ("polygon[]", "a corner in metres, [x, z]"),
    ("position_error", METRES_OFF),
    ("radius", "metres, 0.001 or more and below 2048"),
    ("raster", "the name of a file in quotation marks"),
    ("reach", "metres, 0.001 or more and below 3000"),
    ("readings", "a whole number, 1 to 50, the last at the motion's end"),
    ("samples", "a whole number, 3 to 65535"),
    ("seed", "a whole number, 0 or more"),
    ("sharpest", "radians, 0.001 to 3.1416"),
    ("shortest", "metres, 0.001 or more, up to the longest motion"),
    ("slope", "a number, metres along z for each along x"),
    ("slope_arc_deg", "degrees, at least 0.00001 and below 90"),
    ("slow", "a distance in metres, 0 to 1024"),
    ("speed_step", "metres, 0.001 or more and below 100, a whole part of the longest motion"),
    ("start", "a table, { x = 2.0, z = 1.0, heading = 0.0 }"),
    ("steps", "a whole number, 1 to 10000"),
    ("stuck", "-1 or 1"),
    ("system", "a whole number, 1 to 255"),
    ("to", "the number of a label, 1 or more"),
    ("tolerance", "a distance in metres, 0 to 1024"),
    ("true_p", "a probability in [0, 1]"),
    ("trusted_radius", "a radius in metres, at least 0 and below 8192"),
    ("truth", "a table, { slope = 0.4, intercept = 3.5 }"),
    ("truth.drift", "two numbers, [metres, degrees] of a line, else metres along x and z"),
    ("turn_step", "radians, 0.000001 to 3.1416, a multiple of 0.000001"),
    ("varrho", "a weight in [0, 1), to six decimal places"),
    ("vehicle", "a table, { kind = \"boat\" }"),
    ("vehicle.kind", "\"unicycle\", \"boat\" or \"car\""),
    ("vehicle.step", "metres, 0.001 or more and below 100, a whole part of the longest motion"),
    ("watch", "metres of front"),
    ("worth", "bits, 0 to 1"),
    ("x", "metres"),
    ("x[]", "metres"),
    ("z", "metres"),
    ("z[]", "metres"),
];

const METRES_OFF: &str = "a standard deviation in metres, 0 to 100";
const RADIANS_OFF: &str = "a standard deviation in radians, 0 to 1";

/// What to write for a key, `oracle[0].label`, or for a flag, `--speed-step`.
pub fn expected(name: &str) -> Option<&'static str> {
    let key = name.trim_start_matches("--").replace('-', "_");
    let key = key.replace(|it: char| it.is_ascii_digit(), "");
    let of = |key: &str| EXPECTED.iter().find(|(name, _)| *name == key).map(|it| it.1);
    of(name).or_else(|| of(&key)).or_else(|| of(key.rsplit('.').next()?))
}

/// What serde expects, in people's words.
fn plainly(expected: &str) -> String {
    match expected {
        "f64" | "f32" => "a number".into(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or more".into(),
        "i8" | "i16" | "i32" | "i64" => "a whole number".into(),
        "a boolean" => "true or false".into(),
        "a string" | "string or table" => "a word in quotation marks".into(),
        "a sequence" => "an array, [...]".into(),
        "a table" => "a table, { KEY = VALUE, ... }".into(),
        other => match other.strip_prefix("an array of length ") {
            Some(length) => format!("an array of {length} numbers"),
            None => other.replace('`', ""),
        },
    }
}

/// A degree that stands where radians are expected: what it would be in them.
pub(crate) fn in_radians(degrees: f64) -> String {
    let tidy = (degrees.to_radians() * 1e4).round() / 1e4;
    format!("{degrees} deg are {tidy} rad")
}

/// Each key of a file, as `oracle[0].label`, and where it and its value are.
fn keys(text: &str) -> Vec<(String, Range<usize>)> {
    fn walk(path: &str, value: &Spanned<DeValue>, found: &mut Vec<(String, Range<usize>)>) {
        match value.get_ref() {
            DeValue::Table(table) => of_table(path, table, found),
            DeValue::Array(array) => {
                for (k, value) in array.iter().enumerate() {
                    let path = format!("{path}[{k}]");
                    found.push((path.clone(), value.span()));
                    walk(&path, value, found);
                }
            }
            _ => {}
        }
    }
    fn of_table(path: &str, table: &DeTable, found: &mut Vec<(String, Range<usize>)>) {
        let dot = if path.is_empty() { "" } else { "." };
        for (key, value) in table {
            let path = format!("{path}{dot}{}", key.get_ref());
            let (key, value_span) = (key.span(), value.span());
            found
                .push((path.clone(), key.start.min(value_span.start)..key.end.max(value_span.end)));
            walk(&path, value, found);
        }
    }
    let mut found = Vec::new();
    if let Ok(table) = DeTable::parse(text) {
        of_table("", table.get_ref(), &mut found);
    }
    found
}

fn line(text: &str, at: usize) -> usize {
    1 + text[..at].matches('\n').count()
}

/// The refusal of a key, with the line on which the file called `name` has it, or what it is part of.
pub(crate) fn at_its_line(name: &str, text: &str, refusal: impl Display) -> Error {
    let refusal = refusal.to_string();
    let keys = keys(text);
    let mut key = refusal.split(": ").next().unwrap_or_default();
    let span = loop {
        if let Some((_, span)) = keys.iter().find(|(it, _)| it == key) {
            break Some(span);
        }
        let Some(end) = key.rfind(['.', '[']) else { break None };
        key = &key[..end];
    };
    let at = span.map_or(String::new(), |span| format!(":{}", line(text, span.start)));
    anyhow!("{name}{at}: {refusal}")
}

/// Whether a text is TOML at all.
///
/// # Errors
/// Names the line that is not, and what is expected.
pub(crate) fn check_toml(name: &str, text: &str) -> Result<(), Error> {
    DeTable::parse(text).map(drop).map_err(|error| {
        let at = error.span().map_or(0, |it| it.start);
        syntax(name, text, line(text, at), error.message())
    })
}

/// What is wrong with a table that is no scenario: its key, what was found and what was expected.
pub(crate) fn of_toml(text: &str, error: &toml::de::Error) -> String {
    let (span, said) = (error.span().unwrap_or(0..0), error.message());
    let keys = keys(text);
    let within = keys.iter().filter(|(_, it)| it.start <= span.start && span.end <= it.end);
    let key = within.min_by_key(|(_, it)| it.len()).map_or("", |(key, _)| key.as_str());
    if let Some(missing) = said.strip_prefix("missing field ") {
        let missing = missing.replace('`', "");
        let is_inner = text[span].starts_with(['{', '[']);
        let key = if is_inner { format!("{key}.{missing}") } else { missing };
        return format!("{key}: found none, expected {}", expected(&key).unwrap_or("one"));
    }
    let names = || said.split_once("expected ").map_or("none", |(_, names)| names).replace('`', "");
    if said.starts_with("unknown field") {
        return format!("{key}: found an unknown key, expected {}", names());
    }
    let found = text[span].split_whitespace().collect::<Vec<_>>().join(" ");
    if said.starts_with("unknown variant") {
        return format!("{key}: found {found}, expected {}", names());
    }
    let by_type = said.split_once("expected ").or(said.split_once("wanted "));
    let by_type = by_type.map_or_else(|| said.to_owned(), |(_, expected)| plainly(expected));
    format!("{key}: found {found}, expected {}", expected(key).map_or(by_type, Into::into))
}

/// A line that is no TOML.
fn syntax(name: &str, text: &str, number: usize, said: &str) -> Error {
    let kind = kind::of(text.as_bytes());
    if kind != kind::TOML {
        return anyhow!("{name}: found {kind}, expected {SCENARIO}");
    }
    let found = text.lines().nth(number - 1).unwrap_or_default().trim();
    let begins_with_digit = |it: &str| it.starts_with(|it: char| it.is_ascii_digit());
    let is_number = |it: &str| !it.is_empty() && it.bytes().all(|it| it.is_ascii_digit());
    let has_decimal_comma = found.split('=').skip(1).any(|value| {
        let value = value.trim_start().trim_start_matches('-');
        value
            .split_once(',')
            .is_some_and(|(whole, rest)| is_number(whole) && begins_with_digit(rest))
    });
    let expected = match said {
        _ if has_decimal_comma => "a decimal point, as 3.5".to_owned(),
        "duplicate key" => "each key once".to_owned(),
        _ => {
            format!("KEY = VALUE, numbers as 0.5 without a unit, words in quotation marks ({said})")
        }
    };
    anyhow!("{name}:{number}: found {found}, expected {expected}")
}

/// What is expected in place of a file of another kind.
pub(crate) const SCENARIO: &str =
    "a scenario in TOML, as `host-sim init` writes; samples are for `host-sim replay`";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_order_and_finds_keys_and_flags() {
        assert!(EXPECTED.is_sorted_by(|a, b| a.0 < b.0));
        assert_eq!(expected("oracle[12].label"), Some("-1 or 1"));
        assert_eq!(expected("--speed-step"), expected("vehicle.step"));
        assert_eq!(expected("--drift"), expected("allow.drift"));
        assert_ne!(expected("truth.drift"), expected("allow.drift"));
        assert_eq!(expected("area.x[1]"), Some("metres"));
        assert_eq!(expected("truth.circle[2]"), None);
    }
}
