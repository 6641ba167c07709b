//! What the given samples leave open, and why some of them make no version space.

use crate::belief::sample::{Label, Sample};
use crate::belief::tolerance::Tolerance;
use crate::geometry::arc::SlopeArc;
use crate::geometry::lattice::Vector;

/// Why samples do not make a version space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum GivenError {
    /// All samples lie on one line (or there are fewer than three): any line may pass.
    Collinear,
    /// All samples have the same label: the boundary may be anywhere beyond them.
    OneLabel,
    /// No line separates the samples up to and including the one at this index, which is the first
    /// such index.
    NotSeparable(usize),
    /// There are more samples than the buffer holds.
    TooMany,
    /// The samples leave lines of so many directions that further ones, whose positions err, would tell
    /// nothing.
    TooVague,
    /// The tolerance is negative, above 1,024 m, or no number.
    Tolerance,
    /// Positions err, and nobody knows the reliability of labels. A table weighs one of the two.
    Reliability,
}

impl core::fmt::Display for GivenError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Collinear => f.write_str("the samples are collinear"),
            Self::OneLabel => f.write_str("the samples share one label"),
            Self::NotSeparable(i) => write!(f, "no line separates the samples 0 to {i}"),
            Self::TooMany => f.write_str("there are more samples than the buffer holds"),
            Self::Tolerance => f.write_str("a tolerance is from 0 to 1024 m"),
            Self::Reliability => f.write_str(
                "where positions err, the reliability of labels is a number and no prior",
            ),
            Self::TooVague => f.write_str("positions err too much for what the samples leave open"),
        }
    }
}

impl core::error::Error for GivenError {}

/// An arc that contains the directions of all lines left by samples whose positions may be off. `None` if it is too
/// wide to shift samples by.
///
/// Let `w` run from a sample of label -1 to one of label +1, and let their tolerances sum up to `s`. The unit normal `n` of
/// a line that agrees with both has `n . w >= -s`. So normals are excluded within `acos(s / |w|)` of `-w`.
pub(super) fn directions_left(samples: &[(Sample, Tolerance)]) -> Option<SlopeArc> {
    use core::f64::consts::{FRAC_PI_2, PI, TAU};
    let of = |label| samples.iter().filter(move |(sample, _)| sample.label == label);
    let excluded = || {
        let pairs = of(Label::Negative).flat_map(|a| of(Label::Positive).map(move |b| (a, b)));
        pairs.filter_map(|((a, one), (b, other))| {
            let w = a.site - b.site;
            let length = libm::hypot(f64::from(w.x), f64::from(w.z));
            // Two units more than the sum, and a little less of an angle, for rounding.
            let sum = f64::from(one.units()) + f64::from(other.units()) + 2.0;
            let middle = libm::atan2(f64::from(w.z), f64::from(w.x));
            (sum < length).then(|| (middle, libm::acos(sum / length) - 1e-6))
        })
    };
    // The first of them, and all that overlap with it or with one that does. To leave out any is safe.
    let (middle, half) = excluded().next()?;
    let (mut from, mut to) = (middle - half, middle + half);
    for _ in 0..samples.len() {
        let before = (from, to);
        for (middle, half) in excluded() {
            let about = 0.5 * (from + to);
            let off = middle - about;
            let middle = about + (off - TAU * libm::round(off / TAU));
            if middle - half <= to && middle + half >= from {
                (from, to) = (from.min(middle - half), to.max(middle + half));
            }
        }
        if (from, to) == before {
            break;
        }
    }
    // Normals from `to` on to `from`: directions are a quarter turn behind.
    let is_narrow = PI + 0.07 < to - from && to - from < TAU;
    let unit = |angle: f64| {
        let (sin, cos) = libm::sincos(angle - FRAC_PI_2);
        Vector { x: (cos * f64::from(1 << 28)) as i32, z: (sin * f64::from(1 << 28)) as i32 }
    };
    is_narrow.then(|| SlopeArc::new(unit(to), unit(from)))
}

/// The index of the first of these collinear samples up to which no line separates them. That sample lies between two
/// of the other label, or at the site of one. Or one of the other label lies between it and another sample.
pub(super) fn first_inseparable_collinear(samples: &[Sample]) -> Option<usize> {
    let lies_between = |b: &Sample, [a, c]: [&Sample; 2]| {
        a.label == c.label && a.label != b.label && (a.site - b.site).dot(c.site - b.site) <= 0
    };
    (1..=samples.len()).find_map(|n| {
        let (last, earlier) = samples.get(..n)?.split_last()?;
        let pairs = || earlier.iter().flat_map(|a| earlier.iter().map(move |b| (a, b)));
        let is_inseparable = |(a, b)| {
            lies_between(last, [a, b]) || lies_between(a, [last, b]) || lies_between(a, [last; 2])
        };
        pairs().any(is_inseparable).then_some(n - 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_separates_two_labels_at_one_place() {
        let sample = |x, label| Sample::at([x, x], label).unwrap();
        let apart = [sample(0.0, Label::Positive), sample(1.0, Label::Negative)];
        let both = [apart[0], apart[1], sample(1.0, Label::Positive)];
        assert_eq!(first_inseparable_collinear(&apart), None);
        assert_eq!(first_inseparable_collinear(&both), Some(2));
    }

    #[test]
    fn tolerances_of_both_samples_of_a_pair_count() {
        use Label::{Negative, Positive};
        let given = [
            (0.0, 0.0, Negative),
            (0.0, 9.0, Positive),
            (9.0, 9.0, Positive),
            (9.0, 0.0, Negative),
        ]
        .map(|(x, z, label)| Sample::at([x, z], label).unwrap());
        let left = |negative: f64, positive: f64| {
            let tolerance = |label| if label == Negative { negative } else { positive };
            let within = given.map(|it| (it, Tolerance::new(tolerance(it.label)).unwrap()));
            directions_left(&within).unwrap()
        };
        assert_eq!(left(0.5, 0.0), left(0.25, 0.25));
        assert_eq!(left(0.0, 0.5), left(0.25, 0.25));
    }
}
