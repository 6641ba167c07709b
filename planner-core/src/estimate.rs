//! Three estimates of the line, and how much of the version space is left.
//!
//! | estimate | what it is | when to use it |
//! | --- | --- | --- |
//! | [`centre`] | the mean of the version space | by default: it uses all that is known |
//! | [`maximum_margin`] | the hard-margin separator (Section II-A), exact | to stay clear of both labels |
//! | [`bisector`] | the paper's printed estimate (Section IV-A) | to compare with the paper |
//!
//! All work in double precision about a sample, so a mission kilometres from the origin loses
//! nothing. They cost some microseconds on a PC and are no part of the planning loop.

use nalgebra::{Matrix2, Point2, Vector2};

use crate::candidates::Candidates;
use crate::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::line::Line;
use crate::sample::{Label, Sample};
use crate::version_space::VersionSpace;

/// The three estimates; `None` where one does not exist.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimates {
    /// The paper's printed estimate.
    pub bisector: Option<Line>,
    /// The mean of the version space.
    pub centre: Option<Line>,
    /// The hard-margin separator.
    pub maximum_margin: Option<Line>,
}

impl Estimates {
    /// All three.
    pub fn of<const N: usize>(space: &VersionSpace<N>) -> Self {
        Self {
            bisector: bisector(space.samples()),
            centre: centre(space.candidates()),
            maximum_margin: maximum_margin(space.candidates()),
        }
    }
}

fn metres(v: Vector) -> Vector2<f64> {
    let scale = 1.0 / f64::from(UNITS_PER_METRE);
    Vector2::new(f64::from(v.x) * scale, f64::from(v.z) * scale)
}

/// Integrals over a version space by the measure d(angle) d(offset), which no motion of the plane
/// changes.
#[derive(Clone, Copy)]
pub(crate) struct Moments {
    /// The measure, radian metres; its sign is that of the way round.
    pub(crate) area: f64,
    /// The integral of the lines' unit normals.
    normal: Vector2<f64>,
    /// The integral of the lines' offsets from `about`.
    offset: f64,
    about: Point2<f64>,
}

impl Moments {
    /// A line with unit normal `n` and offset `r` has `n . q = r` and is +1 where `n . q > r`.
    /// At a given angle the offsets of a cell end at `n . p` for two of its samples `p`, so an
    /// integral over it is one round its edges. With `u` the direction of the line, `n` a quarter
    /// turn to the left of it and `M` the integral of `n n^T` from one end of an edge to the other,
    /// an edge adds `p . (u' - u)` to the area, `M p` to the normal and `p^T M p / 2` to the offset.
    pub(crate) fn of(candidates: Candidates<'_>) -> Self {
        let Candidates { samples, .. } = candidates;
        let about = samples.first().map(|s| s.site);
        let mut moments = Self {
            area: 0.0,
            normal: Vector2::zeros(),
            offset: 0.0,
            about: about.map_or(Point2::origin(), Point2::from),
        };
        for (edge, [start, end]) in candidates.sides() {
            let (Some(sample), Some(about)) = (samples.get(edge.index()), about) else {
                continue;
            };
            let p = metres(sample.site - about);
            let (u, v) = (metres(start.along).normalize(), metres(end.along).normalize());
            let turn = libm::atan2(u.perp(&v), u.dot(&v));
            // The integrals of sin^2, cos^2 and -sin cos over the turn.
            let (sin2, cross) = ((v.x * v.y - u.x * u.y) / 2.0, (v.x * v.x - u.x * u.x) / 2.0);
            let m = Matrix2::new(turn / 2.0 - sin2, cross, cross, turn / 2.0 + sin2);
            moments.area += p.dot(&(v - u));
            moments.normal += m * p;
            moments.offset += p.dot(&(m * p)) / 2.0;
        }
        moments
    }

    /// The integrals with each line counted this often.
    pub(crate) fn scaled(self, by: f64) -> Self {
        let Self { area, normal, offset, about } = self;
        Self { area: area * by, normal: normal * by, offset: offset * by, about }
    }

    /// The integrals over both sets of lines, whose cells share their samples.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            area: self.area + other.area,
            normal: self.normal + other.normal,
            offset: self.offset + other.offset,
            about: self.about,
        }
    }

    /// The mean line.
    pub(crate) fn mean(self) -> Option<Line> {
        let normal = self.normal / self.area;
        let norm = normal.norm();
        Line::through(self.about + normal * (self.offset / self.area / (norm * norm)), normal)
    }
}

/// The measure of the version space, radian metres: d(angle) d(offset), the measure of lines that
/// no motion of the plane changes. Its logarithm to the base 2 falls by the bits that samples tell.
pub fn area(candidates: Candidates<'_>) -> f64 {
    Moments::of(candidates).area.abs()
}

/// The centre: the mean of the candidate lines, as unit normals with their offsets, by the measure
/// d(angle) d(offset).
///
/// Closed form, and the same wherever the origin lies and however the axes turn. The version space
/// is convex, so its mean agrees with every sample. `None` if the version space is too thin for
/// double precision.
pub fn centre(candidates: Candidates<'_>) -> Option<Line> {
    Moments::of(candidates).mean()
}

/// The hard-margin separator: midway between the closest points of the two labels' convex hulls.
///
/// The pair is chosen by exact integer conditions, so the line is the exact one, rounded once. Only
/// samples that still matter to the version space can support it. `O(m^3)` for `m` of them.
pub fn maximum_margin(candidates: Candidates<'_>) -> Option<Line> {
    let of = |label: Label| candidates.support().filter(move |s| s.label == label).map(|s| s.site);
    let (above, below) = (|| of(Label::Positive), || of(Label::Negative));
    // Two samples support it when every other lies beyond them, as seen along their difference.
    let pairs = || above().flat_map(move |p| below().map(move |q| (p, q)));
    if let Some((p, q)) = pairs().find(|&(p, q)| {
        let w = p - q;
        above().all(|r| (r - p).dot(w) >= 0) && below().all(|r| (r - q).dot(w) <= 0)
    }) {
        return midway(p, q, p - q);
    }
    // Else two of one label and one of the other: the side of one hull that faces a corner of the
    // other, `w` pointing from the side to the corner.
    let faces = |side: Site, w: Vector, label: Label| of(label).all(|r| (r - side).dot(w) <= 0);
    [Label::Positive, Label::Negative].into_iter().find_map(|label| {
        of(label).find_map(|a| {
            of(label).filter(|&b| b != a).find_map(|b| {
                let w = (b - a).left();
                of(-label).find_map(|corner| {
                    let nearest = of(-label).all(|r| (r - corner).dot(w) >= 0);
                    let beside = (corner - a).dot(b - a) >= 0 && (corner - b).dot(a - b) >= 0;
                    let up = if label == Label::Positive { w.reversed() } else { w };
                    (nearest && beside && (corner - a).dot(w) > 0 && faces(a, w, label))
                        .then(|| midway(a, corner, up))?
                })
            })
        })
    })
}

/// The line halfway between two sites with a given normal.
fn midway(p: Site, q: Site, normal: Vector) -> Option<Line> {
    Line::through(nalgebra::center(&Point2::from(p), &Point2::from(q)), metres(normal))
}

/// The paper's printed estimate: of all pairs of opposite labels the two shortest that share no
/// point, `p1(-) p2(+)` and `p3(+) p4(-)`; through the crossing `pm` of the diagonals `p1 p3` and
/// `p2 p4`, the bisector of the angle `p1 pm p2`.
///
/// `None` when there are no two such pairs or their diagonals do not cross. When the pairs lie side
/// by side it is a poor estimate: prefer [`centre`]. `O(n^2)` for `n` samples.
pub fn bisector(samples: &[Sample]) -> Option<Line> {
    let length = |&(n, p): &(Sample, Sample)| (p.site - n.site).dot(p.site - n.site);
    let shortest = |apart: Option<(Sample, Sample)>| {
        let free =
            move |s: &&Sample| apart.is_none_or(|(n, p)| s.site != n.site && s.site != p.site);
        let of = move |label| samples.iter().filter(free).filter(move |s| s.label == label);
        of(Label::Negative)
            .flat_map(|&n| of(Label::Positive).map(move |&p| (n, p)))
            .min_by_key(length)
    };
    let first = shortest(None)?;
    let ((n1, p1), (n2, p2)) = (first, shortest(Some(first))?);
    let (d, e) = (metres(p2.site - n1.site), metres(n2.site - p1.site));
    let along = metres(p1.site - n1.site).perp(&e) / d.perp(&e);
    let crossing = d * along; // seen from the negative end of the first pair
    let to_negative = -crossing;
    let to_positive = metres(p1.site - n1.site) - crossing;
    // The line that bisects the angle has the difference of the two unit vectors as its normal.
    let normal = to_positive.try_normalize(0.0)? - to_negative.try_normalize(0.0)?;
    Line::through(Point2::from(n1.site) + crossing, normal)
}
