//! The lines that agree with a record, however many rows it has. Its positions may each be off by a tolerance.
//!
//! They depend on the convex hulls of the two labels alone, so all is found in `O(n log n)` for `n` rows. A line agrees with a label if the label is true at some place within the tolerance of the position. So of all lines
//! with a unit normal `n`, those `n . q = r` remain for which
//!
//! ```text
//! max over -1 of n . q  -  tolerance  <=  r  <=  min over +1 of n . q  +  tolerance
//! ```
//!
//! The two samples that attain these bounds stay the same over a stretch of directions. They form a corner of the
//! polygon of differences (`Facing`), and the stretch lies between the normals of the corner's edges. A planner takes
//! samples one by one, and its result depends on their order. This one does not, and it cuts off no more lines than it
//! must.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point2, Vector2};
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::{Sample, Vector};

use crate::fitting::facing::{Facing, Pair};
use crate::fitting::halving::last_good;
use crate::fitting::hull::Row;
use crate::fitting::line_set::{ByNormal, intercepts, slope_arcs};

/// Directions of the normal between which the same two samples bound the lines, radians.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: f64,
    to: f64,
    pair: Pair,
}

/// All lines that agree with a record: a version space of any size.
#[derive(Debug)]
pub struct Separation {
    /// The tolerance and the rounding of positions, metres; 0 where positions are true.
    tolerance: f64,
    stretches: Vec<Stretch>,
}

/// Why there is no such set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSeparation {
    /// All samples have the same label.
    OneLabel,
    /// All samples lie on one line.
    Collinear,
    /// No line agrees with the samples up to and including the one at this index, the first such.
    Contradiction(usize),
    /// Lines of every direction agree.
    AnyDirection,
}

/// The largest angle between two directions at which read-outs are computed, radians.
const STEP: f64 = 0.02;

fn unit(angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(cos, sin)
}

fn metres(v: Vector) -> Vector2<f64> {
    Vector2::new(f64::from(v.x()), f64::from(v.z())) / f64::from(UNITS_PER_METRE)
}

impl Stretch {
    /// The distances of the lines with a normal, the least and the most.
    fn distances(&self, angle: f64, tolerance: f64) -> [f64; 2] {
        let along = |sample: Sample| unit(angle).dot(&Point2::<f64>::from(sample.site).coords);
        [along(self.pair.negative()) - tolerance, along(self.pair.positive()) + tolerance]
    }

    /// Both lines that bound those with a normal.
    fn bounds(&self, angle: f64, tolerance: f64) -> [ByNormal; 2] {
        self.distances(angle, tolerance).map(|distance| (unit(angle), distance))
    }

    /// Directions from its beginning to its end, at most [`STEP`] apart.
    fn places(&self) -> impl Iterator<Item = f64> + use<> {
        let Self { from, to, .. } = *self;
        let parts = ((to - from) / STEP).ceil().max(1.0);
        (0..=parts as u32).map(move |k| from + (to - from) * f64::from(k) / parts)
    }
}

impl Separation {
    /// The lines that agree with some samples, whose rows [in order](crate::fitting::hull::in_order) are these.
    ///
    /// # Errors
    /// [`NoSeparation`].
    pub fn of(samples: &[Sample], rows: &[Row], tolerance: f64) -> Result<Self, NoSeparation> {
        let tolerance = with_rounding(tolerance);
        let all = Facing::of(rows, samples.len());
        if all.are_of_one_label() {
            return Err(NoSeparation::OneLabel);
        }
        let stretches = stretches(&all, tolerance);
        if !are_apart(&all, tolerance) {
            // The more samples, the fewer lines.
            let agree = |count: usize| are_apart(&Facing::of(rows, count), tolerance);
            return Err(NoSeparation::Contradiction(last_good(samples.len(), agree)));
        }
        if tolerance == 0.0 && all.ends().is_some_and(|[a, b]| a.apart().cross(b.apart()) == 0) {
            return Err(NoSeparation::Collinear);
        }
        let covered: f64 = stretches.iter().map(|it| it.to - it.from).sum();
        if covered > TAU - 1e-9 {
            return Err(NoSeparation::AnyDirection);
        }
        Ok(Self { tolerance, stretches })
    }

    /// The samples that bound the lines.
    pub fn support(&self) -> Vec<Sample> {
        let mut support: Vec<Sample> = Vec::new();
        // Narrower ones are there by rounding.
        for stretch in self.stretches.iter().filter(|it| it.to - it.from > 1e-12) {
            for sample in [stretch.pair.positive(), stretch.pair.negative()] {
                if !support.contains(&sample) {
                    support.push(sample);
                }
            }
        }
        support
    }

    /// The directions of the lines, as intervals of degrees.
    pub fn slope_arcs(&self) -> Vec<[f64; 2]> {
        slope_arcs(self.stretches.iter().map(|it| [it.from - PI / 2.0, it.to - PI / 2.0]))
    }

    /// The range of the lines' intercepts, metres; `None` when it is unbounded.
    pub fn intercepts(&self) -> Option<[f64; 2]> {
        let bounds = self.stretches.iter().flat_map(|it| {
            // The directions in which a line that touches the disc about a sample has its least and greatest intercept.
            let rims = [it.pair.positive(), it.pair.negative()].into_iter().flat_map(|sample| {
                let x = Point2::<f64>::from(sample.site).x / self.tolerance;
                let angle = if x.abs() < 1.0 { libm::asin(x) } else { 0.0 };
                [angle, -angle, PI - angle, PI + angle, TAU - angle]
            });
            let turned = [-TAU, 0.0, TAU];
            let rims: Vec<f64> =
                rims.flat_map(|rim| turned.map(|turn| PI / 2.0 + rim + turn)).collect();
            let inside = rims.into_iter().filter(|rim| (it.from..it.to).contains(rim));
            [it.from, it.to].into_iter().chain(inside).flat_map(|at| it.bounds(at, self.tolerance))
        });
        intercepts(&self.slope_arcs(), bounds)
    }

    /// Lines that bound the set.
    pub fn bounds(&self) -> Vec<ByNormal> {
        let of = |it: &Stretch| {
            let (it, tolerance) = (*it, self.tolerance);
            it.places().flat_map(move |at| it.bounds(at, tolerance))
        };
        self.stretches.iter().flat_map(of).collect()
    }

    /// The mean of the lines, as unit normals with their distances, by the measure of lines.
    pub fn centre(&self) -> ByNormal {
        // Gauss's rule of three points.
        const RULE: [(f64, f64); 3] =
            [(-0.774_596_669_241_483_4, 5.0), (0.0, 8.0), (0.774_596_669_241_483_4, 5.0)];
        let (mut normal, mut distance) = (Vector2::zeros(), 0.0);
        for stretch in &self.stretches {
            let places: Vec<_> = stretch.places().collect();
            for pair in places.windows(2) {
                let half = 0.5 * (pair[1] - pair[0]);
                for (place, weight) in RULE {
                    let angle = pair[0].midpoint(pair[1]) + half * place;
                    let [low, high] = stretch.distances(angle, self.tolerance);
                    let measure = weight * half * (high - low);
                    normal += unit(angle) * measure;
                    distance += low.midpoint(high) * measure;
                }
            }
        }
        let length = normal.norm();
        (normal / length, distance / length)
    }

    /// The line that stays furthest from being wrong: in the middle where the range of distances is widest.
    pub fn maximum_margin(&self) -> Option<ByNormal> {
        let width = |stretch: &Stretch, at: f64| {
            let [low, high] = stretch.distances(at, self.tolerance);
            high - low
        };
        let best = |stretch: &Stretch| {
            let apart = metres(stretch.pair.apart());
            let towards = libm::atan2(apart.y, apart.x);
            let inside = [-TAU, 0.0, TAU].map(|turn| towards + turn);
            let inside = inside.into_iter().filter(|at| (stretch.from..stretch.to).contains(at));
            let places = [stretch.from, stretch.to].into_iter().chain(inside);
            places.map(|at| (width(stretch, at), at)).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let all = self.stretches.iter().filter_map(|it| Some((best(it)?, it)));
        let ((_, at), stretch) = all.max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
        let [low, high] = stretch.distances(at, self.tolerance);
        Some((unit(at), low.midpoint(high)))
    }
}

/// A tolerance and the rounding of positions to the lattice, metres.
fn with_rounding(tolerance: f64) -> f64 {
    if tolerance > 0.0 { tolerance + 1.0 / f64::from(UNITS_PER_METRE) } else { 0.0 }
}

/// Whether a line agrees with some rows in order within a tolerance.
pub fn are_separable(rows: &[Row], tolerance: f64) -> bool {
    are_apart(&Facing::of(rows, usize::MAX), with_rounding(tolerance))
}

/// Whether a line separates two hulls. `tolerance` includes the rounding. Without one it is decided exactly.
fn are_apart(hulls: &Facing, tolerance: f64) -> bool {
    hulls.are_of_one_label()
        || if tolerance > 0.0 {
            !stretches(hulls, tolerance).is_empty()
        } else {
            hulls.ends().is_some()
        }
}

/// The directions in which lines are left.
fn stretches(facing: &Facing, tolerance: f64) -> Vec<Stretch> {
    let mut corners: Vec<Pair> = facing.differences().to_vec();
    corners.dedup_by_key(|pair| (pair.apart().x(), pair.apart().z()));
    while corners.len() > 1
        && corners.last().map(|it| it.apart()) == corners.first().map(|it| it.apart())
    {
        corners.pop();
    }
    let count = corners.len();
    // Exact, or what is straight would turn all the way round.
    let edge = |k: usize| {
        let [from, to] = [corners[k % count], corners[(k + 1) % count]].map(Pair::apart);
        [i128::from(to.x()) - i128::from(from.x()), i128::from(to.z()) - i128::from(from.z())]
    };
    let mut all = Vec::new();
    for (k, &pair) in corners.iter().enumerate() {
        // The normals for which this corner comes first: between those of its edges.
        let [from, to] = if count == 1 {
            [0.0, TAU]
        } else {
            let (before, after) = (edge(k + count - 1), edge(k));
            let [cross, dot] = [
                before[0] * after[1] - before[1] * after[0],
                before[0] * after[0] + before[1] * after[1],
            ];
            let turn = libm::atan2(cross as f64, dot as f64);
            let from = libm::atan2(before[1] as f64, before[0] as f64) + PI / 2.0;
            [from, from + turn]
        };
        let apart = metres(pair.apart());
        let length = apart.norm();
        let half =
            if length <= 2.0 * tolerance { PI } else { libm::acos(-2.0 * tolerance / length) };
        let middle = libm::atan2(apart.y, apart.x);
        for turn in [-TAU, 0.0, TAU] {
            let (from, to) = (from.max(middle - half + turn), to.min(middle + half + turn));
            if from < to {
                all.push(Stretch { from, to, pair });
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use planner_core::error::GivenError;
    use planner_core::{Belief as _, Label, Line, Site, VersionSpace};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::fitting::hull::in_order;
    use crate::fitting::line_set::line;

    /// A few samples on a coarse grid, far apart or near: many repeat each other and many are collinear. Most are
    /// labelled by a line, some of them wrongly.
    fn draw(rng: &mut ChaCha8Rng) -> Vec<Sample> {
        let width = rng.random_range(1..9_i32);
        let scale = [1, 65_536, (1 << 29) / 10][rng.random_range(0..3)];
        let [a, b] = [0; 2].map(|_| rng.random_range(-3..=3_i32));
        let c = rng.random_range(-2 * width..=2 * width);
        let wrong = [0.0, 0.0, 0.05, 0.5][rng.random_range(0..4)];
        let count = rng.random_range(0..20);
        let one = |_| {
            let [x, z] = [0; 2].map(|_| rng.random_range(-width..=width));
            let site = Site::new(x * scale, z * scale).expect("on the lattice");
            let is_positive = (a * x + b * z >= c) != rng.random_bool(wrong);
            Sample { site, label: if is_positive { Label::Positive } else { Label::Negative } }
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn a_record_has_the_version_space_that_the_planner_would_make_of_it() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut seen = [0; 4];
        for _ in 0..20_000 {
            let samples = draw(&mut rng);
            let rows = in_order(&samples);
            let found = Separation::of(&samples, &rows, 0.0);
            let (kind, both) = match (VersionSpace::<68>::new(&samples), found) {
                (Ok(space), Ok(found)) => (0, Some((space, found))),
                (Err(GivenError::NotSeparable(p)), Err(NoSeparation::Contradiction(q)))
                    if p == q =>
                {
                    (1, None)
                }
                (Err(GivenError::Collinear), Err(NoSeparation::Collinear)) => (2, None),
                (Err(_), Err(NoSeparation::OneLabel)) => (3, None),
                (expected, found) => panic!("{expected:?}, {found:?}: {samples:?}"),
            };
            seen[kind] += 1;
            let Some((space, found)) = both else { continue };
            let mut support: Vec<_> = space.support().collect();
            let mut own = found.support();
            for of in [&mut support, &mut own] {
                of.sort_unstable_by_key(|it| (it.site.x(), it.site.z(), it.label.sign()));
            }
            assert_eq!(own, support, "{samples:?}");
            let size = samples.iter().map(|it| Point2::<f64>::from(it.site).coords.norm());
            let size = size.fold(0.0, f64::max);
            // The planner has single precision.
            let are_near = |p: f64, q: f64| (p - q).abs() < 1e-5 * (1.0 + size);
            for (own, expected) in [
                (line(found.centre()), space.centre()),
                (found.maximum_margin().and_then(line), space.estimates().maximum_margin),
            ] {
                let both = own.zip(expected.map(Line::from)).expect("a line");
                let [p, q] = [both.0, both.1].map(|it| it.coefficients());
                assert!((0..3).all(|k| are_near(p[k], q[k])), "{both:?}: {samples:?}");
            }
            let arcs = found.slope_arcs().into_iter().flatten();
            let theirs = space.slope_arc().intervals_deg().to_vec().into_iter().flatten();
            assert!(arcs.zip(theirs).all(|(p, q)| (p - q).abs() < 1e-4), "{samples:?}");
        }
        assert!(seen.iter().all(|count| *count > 100), "{seen:?}");
    }
}
