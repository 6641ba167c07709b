//! Three estimates of the line, and the size of the version space.
//!
//! | estimate | what it is | when to use it |
//! | --- | --- | --- |
//! | [`centre`] | the mean of the version space | by default: it uses all that is known |
//! | [`maximum_margin`] | the hard-margin separator (Section II-A) | to stay clear of both labels |
//! | [`bisector`] | the paper's printed estimate (Section IV-A) | to compare with the paper |
//!
//! All are in single precision, in axes about a sample ([`LocalLine`]), so a mission kilometres from the origin loses
//! no accuracy. The planning loop does not use them.

use crate::belief::cells::{CellView, Kept, Moments, Trapezoid, Trapezoids, measure, run_length};
use crate::belief::sample::{Label, Sample};
use crate::geometry::approximate::{METRE, UnitVector, cross};
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::local_line::{LocalAxes, LocalLine};

/// The three estimates; `None` where one does not exist.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimates {
    /// The paper's printed estimate.
    pub bisector: Option<LocalLine>,
    /// The mean of the version space.
    pub centre: Option<LocalLine>,
    /// The hard-margin separator.
    pub maximum_margin: Option<LocalLine>,
}

/// The measure of the version space, radian metres, to 10^-6 of it: d(angle) d(offset), the measure of
/// lines that no motion of the plane changes. Its logarithm to the base 2 falls by the bits that samples tell.
#[inline(never)] // called from many places
pub fn area(lines: CellView<'_>) -> f32 {
    lines.trapezoids().map_or(0.0, measure)
}

/// The share of the lines, by their measure, that label a site +1.
pub fn share_above(lines: CellView<'_>, site: Site) -> f32 {
    let (first, last) = match lines.kept(site, Label::Positive) {
        Kept::All => return 1.0,
        Kept::None => return 0.0,
        Kept::Between { first, last } => (first, last),
    };
    let edges = lines.edges.len();
    let kept = run_length(first, last, edges);
    let part = Trapezoids::of(kept + 1, |k| {
        if k == kept {
            return Some(Sample { site, label: Label::Positive });
        }
        lines.sample(if first + k < edges { first + k } else { first + k - edges })
    });
    (part.map_or(0.0, measure) / area(lines)).clamp(0.0, 1.0)
}

/// The centre: the mean of the lines left, as unit normals with their offsets, by the measure
/// d(angle) d(offset).
///
/// Closed form, and the same wherever the origin lies and however the axes turn. The version space is convex, so its
/// mean agrees with every sample. `None` if the version space is too thin for single precision; none that the lattice
/// can represent is.
pub fn centre(lines: CellView<'_>) -> Option<LocalLine> {
    Moments::of(lines)?.mean()
}

/// The hard-margin separator: midway between the closest points of the two labels' convex hulls.
///
/// These are chosen by exact integer conditions, and its direction is exact. Only samples that still matter
/// to the version space can support it. `O(m)` for `m` of them.
pub fn maximum_margin(lines: CellView<'_>) -> Option<LocalLine> {
    // As the direction turns, the interval of the offsets first widens and then narrows. So it is widest where a
    // trapezoid has stopped widening at its end: inside, across what joins its two samples, or at once, at its
    // beginning.
    let narrows = |along: Vector, it: &Trapezoid| along.dot(it.across()) >= 0;
    let widest = lines.trapezoids()?.into_iter().find(|it| narrows(it.to, it))?;
    let across = widest.across();
    let along = if narrows(widest.from, &widest) { widest.from } else { across.left().reversed() };
    let width = cross(along, across) * UnitVector::of(along).per_length;
    LocalLine::new(widest.below, along, 0.0, 0.5 * width * METRE)
}

/// The paper's printed estimate. Take the two shortest pairs of opposite labels that share no point, `p1(-) p2(+)` and
/// `p3(+) p4(-)`. The diagonals `p1 p3` and `p2 p4` cross in `pm`. The estimate is the bisector of the angle
/// `p1 pm p2`.
///
/// Its +1 side is the one to which the pairs point, from their negative points to their positive ones.
///
/// `None` when there are no two such pairs or their diagonals do not cross. When the pairs lie side
/// by side it is a poor estimate: prefer [`centre`]. `O(n^2)` for `n` samples.
pub fn bisector(samples: &[Sample]) -> Option<LocalLine> {
    let [first, second] = shortest_pairs(samples, None);
    let ([n1, p1], [n2, p2]) = (first?, second?);
    // The crossing is a way along the diagonal from `n1`, and some way along the other one from `p1`.
    let (d, e, side) = (p2 - n1, n2 - p1, p1 - n1);
    let (on_d, on_e, crossed) = (side.cross(e), side.cross(d), d.cross(e));
    if on_d == 0 || on_e == 0 || crossed == 0 {
        return None;
    }
    let towards = |v: Vector, way: i64| if (way < 0) == (crossed < 0) { v } else { v.reversed() };
    let (d, e) = (towards(d, on_d), towards(e, on_e));
    // The line that bisects the angle has the difference of the two unit vectors as its normal.
    let frame = LocalAxes::new(n1, d);
    let [cos, sin] = frame.seen(e, UnitVector::of(e));
    let normal = match () {
        // The same, without the difference of like numbers.
        () if cos > 0.0 => [sin.abs(), if sin < 0.0 { 1.0 + cos } else { -1.0 - cos }],
        () => [1.0 - cos, -sin],
    };
    let crossing = (cross(side, e) / cross(d, e)).abs() * METRE / frame.unit().per_length;
    let line = frame.line(normal, normal[0] * crossing)?;
    // Where the diagonals cross beyond the pairs, a sample of a pair may lie on the wrong side of it.
    let (along, slope) = (line.along(), line.slope());
    let rise = |v: Vector| cross(along, v) - slope * cross(v, along.left());
    if rise(side) + rise(p2 - n2) < 0.0 {
        return LocalLine::new(line.about(), along.reversed(), slope, -line.intercept());
    }
    Some(line)
}

/// The two shortest pairs of opposite labels that share no point, of some samples and one more: each with its negative
/// point first.
pub(crate) fn shortest_pairs(samples: &[Sample], more: Option<Sample>) -> [Option<[Site; 2]>; 2] {
    let first = shortest(samples, more, &[]);
    [first, first.and_then(|first| shortest(samples, more, &first))]
}

/// The closest two samples of opposite labels that are not among some: the negative one first.
#[inline(never)] // in two places, and not for speed
fn shortest(samples: &[Sample], more: Option<Sample>, but: &[Site]) -> Option<[Site; 2]> {
    let of = |label| samples.iter().chain(&more).filter(move |s| s.label == label);
    let mut shortest = None;
    let mut least = i64::MAX;
    for n in of(Label::Negative).filter(|n| !but.contains(&n.site)) {
        for p in of(Label::Positive) {
            let apart = p.site - n.site;
            let length = apart.dot(apart);
            // Few are shorter, so whether one is free is asked last.
            if length < least && !but.contains(&p.site) {
                (shortest, least) = (Some([n.site, p.site]), length);
            }
        }
    }
    shortest
}
