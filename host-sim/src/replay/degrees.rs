//! Latitudes and longitudes with degree signs, minutes, seconds or hemispheres: 54\u{b0}12.06'N, 10 48 7.2 E.

/// Characters that end degrees, minutes or seconds. What is no UTF-8 is mostly a degree sign.
const MARKS: [char; 13] = [
    '\u{b0}',
    '\u{ba}',
    '\u{2da}',
    char::REPLACEMENT_CHARACTER,
    '\'',
    '\u{2032}',
    '\u{2019}',
    '"',
    '\u{2033}',
    '\u{201d}',
    ':',
    ' ',
    '\u{a0}',
];

/// The degrees in a field of an axis, `lat` or `lon`; `None` if it is a plain number, or none of that axis.
pub(crate) fn degrees(axis: &str, field: &str) -> Option<f64> {
    let hemispheres = if axis == "lat" { ['N', 'S'] } else { ['E', 'W'] };
    let field = field.trim();
    let has = |it: char| hemispheres.iter().any(|letter| letter.eq_ignore_ascii_case(&it));
    let (letter, rest) = match field.strip_suffix(has) {
        Some(rest) => (field.chars().next_back(), rest),
        None => (field.chars().next().filter(|it| has(*it)), field.trim_start_matches(has)),
    };
    let rest = rest.trim();
    if letter.is_none() && !rest.contains(MARKS) {
        return None;
    }
    let (is_minus, rest) = match rest.strip_prefix('-') {
        Some(_) if letter.is_some() => return None,
        Some(rest) => (true, rest),
        None => (letter.is_some_and(|it| it.eq_ignore_ascii_case(&hemispheres[1])), rest),
    };
    let parts: Vec<_> = rest.split(MARKS).filter(|part| !part.is_empty()).collect();
    let whole = parts.len().saturating_sub(1);
    let mut sum = 0.0;
    for (place, part) in parts.iter().enumerate() {
        let is_number = part.bytes().all(|it| it.is_ascii_digit())
            || place == whole && part.bytes().all(|it| it.is_ascii_digit() || b".,".contains(&it));
        let value = is_number.then(|| part.replacen(',', ".", 1).parse::<f64>().ok())??;
        if place > 0 && value >= 60.0 {
            return None;
        }
        sum += value / [1.0, 60.0, 3600.0].get(place)?;
    }
    (!parts.is_empty()).then_some(if is_minus { -sum } else { sum })
}

#[cfg(test)]
mod tests {
    use super::degrees;

    #[test]
    fn notations_of_one_place() {
        for text in [
            "54\u{b0}12.06'N",
            "54 12.06 n",
            "N54\u{b0}12,06\u{2032}",
            "54\u{b0} 12' 3.6\" N",
            "54:12:3.6",
            "54.201N",
            "N 54.201",
            "54\u{fffd}12\u{2019}3.6\u{201d}",
        ] {
            let found = degrees("lat", text).unwrap_or(f64::NAN);
            assert!((found - 54.201).abs() < 1e-9, "{text}: {found}");
            assert_eq!(degrees("lat", &text.replace(['N', 'n'], "S")).map(f64::abs), Some(found));
        }
        assert_eq!(degrees("lon", "10\u{b0}30'W"), Some(-10.5));
        assert_eq!(degrees("lon", "-10:30"), Some(-10.5));
        for text in [
            "54.2",
            "",
            "N",
            "54\u{b0}60'N",
            "54.5\u{b0}12'N",
            "-54N",
            "54E",
            "1 2 3 4",
            "5a N",
            "no",
        ] {
            assert_eq!(degrees("lat", text), None, "{text}");
        }
    }
}
