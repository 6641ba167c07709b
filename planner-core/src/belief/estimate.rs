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

use crate::belief::consistent_lines::{ConsistentLines, Kept, bounds, run_length};
use crate::belief::sample::{Label, Sample};
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::line::{Bound, Line};

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

const METRE: f64 = 1.0 / UNITS_PER_METRE as f64;

fn float(v: Vector) -> Vector2<f64> {
    Vector2::new(f64::from(v.x), f64::from(v.z))
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
    /// The integrals over a cell, from its edges alone.
    ///
    /// A line with unit normal `n` and offset `r` is `n . q = r`, and +1 where `n . q > r`. Of all lines of
    /// the cell with the same normal the offsets fill an interval, whose ends are `n . p` for two of its
    /// samples `p`. So an integral over offsets is a difference of its values at these ends, and the
    /// integral over the cell a sum over its edges, round it.
    ///
    /// An edge belongs to a sample `p` and runs from the vertex before it, of direction `u`, to the one
    /// after it, of direction `u'`; `n` is a quarter turn to the left of the direction. With `M` the
    /// integral of `n n^T` from the one to the other, the edge adds
    ///
    /// - to the area the integral of `n . p`, which is `p . (u' - u)`;
    /// - to the normal that of `n (n . p)`, which is `M p`;
    /// - to the offset that of `(n . p)^2 / 2`, which is `p^T M p / 2`.
    pub(crate) fn of(lines: ConsistentLines<'_>) -> Self {
        let about = lines.samples.first().map(|first| first.site);
        Self::round(about, lines.support().zip(lines.bounds()))
    }

    /// The integral round some edges, each with the vertex after it.
    fn round(about: Option<Site>, edges: impl Iterator<Item = (Sample, Bound)> + Clone) -> Self {
        let mut moments =
            Self { area: 0.0, normal: Vector2::zeros(), offset: 0.0, about: Point2::origin() };
        let direction = |bound: Bound| float(bound.along).normalize();
        let (Some(about), Some((_, last))) = (about, edges.clone().last()) else {
            return moments;
        };
        moments.about = about.into();
        let mut u = direction(last);
        for (sample, bound) in edges {
            let p = float(sample.site - about) * METRE;
            let v = direction(bound);
            let turn = libm::atan2(u.perp(&v), u.dot(&v));
            // The integrals of sin^2, cos^2 and -sin cos over the turn.
            let (sin2, cross) = ((v.x * v.y - u.x * u.y) / 2.0, (v.x * v.x - u.x * u.x) / 2.0);
            let m = Matrix2::new(turn / 2.0 - sin2, cross, cross, turn / 2.0 + sin2);
            let normal = m * p;
            moments.area += p.dot(&(v - u));
            moments.normal += normal;
            moments.offset += p.dot(&normal) / 2.0;
            u = v;
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

    /// The mean line; `None` if it is none in double precision.
    pub(crate) fn mean(self) -> Option<Line> {
        let normal = self.normal / self.area;
        let foot = normal * (self.offset / self.area / normal.norm_squared());
        Line::through(self.about + foot, normal)
    }
}

/// The measure of the version space, radian metres: d(angle) d(offset), the measure of lines that
/// no motion of the plane changes. Its logarithm to the base 2 falls by the bits that samples tell.
pub fn area(lines: ConsistentLines<'_>) -> f64 {
    Moments::of(lines).area.abs()
}

/// The share of the lines, by their measure, that label a site +1.
pub fn share_above(lines: ConsistentLines<'_>, site: Site) -> f64 {
    let (first, last) = match lines.kept(site, Label::Positive) {
        Kept::All => return 1.0,
        Kept::None => return 0.0,
        Kept::Between { first, last } => (first, last),
    };
    let kept = run_length(first, last, lines.edges.len());
    let above = core::iter::once(Sample { site, label: Label::Positive });
    let support = lines.support().cycle().skip(first).take(kept).chain(above);
    let part = Moments::round(Some(site), support.clone().zip(bounds(support)));
    (part.area.abs() / area(lines)).clamp(0.0, 1.0)
}

/// The centre: the mean of the lines left, as unit normals with their offsets, by the measure
/// d(angle) d(offset).
///
/// Closed form, and the same wherever the origin lies and however the axes turn. The version space
/// is convex, so its mean agrees with every sample. `None` if the version space is too thin for
/// double precision.
pub fn centre(lines: ConsistentLines<'_>) -> Option<Line> {
    Moments::of(lines).mean()
}

/// [`centre`] of a cyclic list of samples, of any length. The sums are taken about a site, which had best
/// be near.
pub fn centre_of(about: Site, support: impl Iterator<Item = Sample> + Clone) -> Option<Line> {
    Moments::round(Some(about), support.clone().zip(bounds(support))).mean()
}

/// The hard-margin separator: midway between the closest points of the two labels' convex hulls.
///
/// The pair is chosen by exact integer conditions, so the line is the exact one, rounded once. Only
/// samples that still matter to the version space can support it. `O(m^4)` for `m` of them, few as they
/// are.
pub fn maximum_margin(lines: ConsistentLines<'_>) -> Option<Line> {
    maximum_margin_of(lines.support())
}

/// [`maximum_margin`] of a list of samples.
pub fn maximum_margin_of(support: impl Iterator<Item = Sample> + Clone) -> Option<Line> {
    let all = support.clone();
    let of = |label: Label| all.clone().filter(move |s| s.label == label);
    for a in support {
        for q in of(-a.label) {
            // The two are closest, or else a point between `a` and another of its label, and `q`.
            let apart = a.site - q.site;
            if let Some(line) = midway(all.clone(), a, q, apart) {
                return Some(line);
            }
            for b in of(a.label) {
                let side = b.site - a.site;
                let beside = side.dot(apart) <= 0 && side.dot(b.site - q.site) >= 0;
                let normal = side.left();
                let normal = if normal.dot(apart) > 0 { normal } else { normal.reversed() };
                if beside && let Some(line) = midway(all.clone(), a, q, normal) {
                    return Some(line);
                }
            }
        }
    }
    None
}

/// The line halfway between two samples with a normal that points from `q` to `p`, if all others lie
/// beyond the two.
fn midway(
    support: impl Iterator<Item = Sample>,
    p: Sample,
    q: Sample,
    normal: Vector,
) -> Option<Line> {
    if normal.dot(p.site - q.site) <= 0 {
        return None;
    }
    for s in support {
        let beyond = if s.label == p.label { s.site - p.site } else { q.site - s.site };
        if beyond.dot(normal) < 0 {
            return None;
        }
    }
    let normal = if p.label == Label::Positive { normal } else { normal.reversed() };
    let (p, q) = (p.site, q.site);
    let twice = normal.dot(Vector { x: p.x() + q.x(), z: p.z() + q.z() });
    let (a, b) = (f64::from(normal.x), f64::from(normal.z));
    Some(Line { a, b, c: twice as f64 * (-0.5 * METRE) })
}

/// The paper's printed estimate: of all pairs of opposite labels the two shortest that share no
/// point, `p1(-) p2(+)` and `p3(+) p4(-)`; through the crossing `pm` of the diagonals `p1 p3` and
/// `p2 p4`, the bisector of the angle `p1 pm p2`.
///
/// `None` when there are no two such pairs or their diagonals do not cross. When the pairs lie side
/// by side it is a poor estimate: prefer [`centre`]. `O(n^2)` for `n` samples.
pub fn bisector(samples: &[Sample]) -> Option<Line> {
    let first = shortest(samples, &[])?;
    let [n1, p1] = first;
    let [n2, p2] = shortest(samples, &first)?;
    let (d, e) = (p2 - n1, n2 - p1);
    let along = (p1 - n1).cross(e) as f64 / d.cross(e) as f64;
    // As seen from the negative end of the first pair.
    let crossing = float(d) * along;
    let to_positive = float(p1 - n1) - crossing;
    // The line that bisects the angle has the difference of the two unit vectors as its normal.
    let normal = to_positive.try_normalize(0.0)? + crossing.try_normalize(0.0)?;
    Line::through(Point2::from(n1) + crossing * METRE, normal)
}

/// The closest two samples of opposite labels that are not among some: the negative one first.
fn shortest(samples: &[Sample], but: &[Site]) -> Option<[Site; 2]> {
    let mut shortest = None;
    let mut least = i64::MAX;
    for n in samples.iter().filter(|s| s.label == Label::Negative && !but.contains(&s.site)) {
        for p in samples.iter().filter(|s| s.label == Label::Positive && !but.contains(&s.site)) {
            let apart = p.site - n.site;
            let length = apart.dot(apart);
            if length < least {
                (shortest, least) = (Some([n.site, p.site]), length);
            }
        }
    }
    shortest
}
