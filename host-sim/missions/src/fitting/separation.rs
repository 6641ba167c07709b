//! The lines that separate a record by its labels, however many rows it has.
//!
//! They depend on the convex hulls of the two labels alone, so all is found in `O(n log n)` for `n` rows.

use planner_core::belief::cells;
use planner_core::belief::estimate;
use planner_core::error::GivenError;
use planner_core::geometry::arc::SlopeArc;
use planner_core::geometry::lattice::orient;
use planner_core::geometry::line::Bound;
use planner_core::{LocalLine, Sample};

use crate::fitting::facing::Facing;
use crate::fitting::halving::last_good;
use crate::fitting::hull::Row;

/// All lines that separate a record: a version space of any size.
#[derive(Debug)]
pub struct Separation {
    /// The samples that bound the lines, in cyclic order.
    support: Vec<Sample>,
}

impl Separation {
    /// The lines that separate some samples, whose rows [in order](crate::fitting::hull::in_order) are these.
    ///
    /// # Errors
    /// As `VersionSpace::new`, for any number of samples.
    pub fn of(samples: &[Sample], rows: &[Row]) -> Result<Self, GivenError> {
        let hulls = Facing::of(rows, samples.len());
        if hulls.are_of_one_label() {
            return Err(if hulls.are_flat() {
                GivenError::Collinear
            } else {
                GivenError::OneLabel
            });
        }
        let Some([right, left]) = hulls.ends() else {
            return Err(GivenError::NotSeparable(first_inseparable(samples, rows)));
        };
        if right.apart().cross(left.apart()) == 0 {
            return Err(GivenError::Collinear);
        }
        Ok(Self { support: in_sequence(samples, hulls.between(right, left)) })
    }

    /// The samples that bound the lines: the others follow from these.
    pub fn support(&self) -> impl ExactSizeIterator<Item = Sample> + Clone + '_ {
        self.support.iter().copied()
    }

    /// The lines through two samples that bound the others, in cyclic order.
    pub fn bounds(&self) -> impl Iterator<Item = Bound> + Clone + '_ {
        cells::bounds(self.support())
    }

    /// The directions of the lines.
    pub fn slope_arc(&self) -> SlopeArc {
        SlopeArc::spanning(self.bounds().map(|bound| bound.along)).unwrap_or_default()
    }

    /// The range of the lines' intercepts in metres; `None` when it is unbounded.
    pub fn intercepts(&self) -> Option<[f64; 2]> {
        cells::intercepts(self.bounds())
    }

    /// The mean of the lines.
    pub fn centre(&self) -> Option<LocalLine> {
        estimate::centre_of(&self.support)
    }

    /// The line in the middle of the widest strip between the labels.
    pub fn maximum_margin(&self) -> Option<LocalLine> {
        estimate::maximum_margin_of(&self.support)
    }
}

/// Whether a line separates some rows in order.
pub fn are_separable(rows: &[Row]) -> bool {
    first_are_separable(rows, usize::MAX)
}

/// The same of the rows of the first `count` samples.
fn first_are_separable(rows: &[Row], count: usize) -> bool {
    let hulls = Facing::of(rows, count);
    hulls.are_of_one_label() || hulls.ends().is_some()
}

/// The index of the first sample that no line separates from those before it, where there is one. The more
/// samples, the fewer lines: so it is found by halving.
fn first_inseparable(samples: &[Sample], rows: &[Row]) -> usize {
    last_good(samples.len(), |count| first_are_separable(rows, count))
}

/// Puts a cycle of rows into the order of `VersionSpace`, so that sums over it are the same to the last bit. That order
/// begins with a triangle, and each sample that cuts it becomes the last.
fn in_sequence(samples: &[Sample], mut cycle: Vec<Row>) -> Vec<Sample> {
    let site = |index: usize| samples[index].site;
    let b = (0..samples.len()).find(|b| site(*b) != site(0)).unwrap_or_default();
    let c = (b..samples.len()).find(|c| orient(site(0), site(b), site(*c)) != 0);
    let begins = |row: &Row| row.index == 0 || row.index == b || Some(row.index) == c;
    let cuts = cycle.iter().filter(|row| !begins(row)).map(|row| row.index);
    let first = match cuts.max() {
        Some(last) => cycle.iter().position(|row| row.index == last).map(|last| last + 1),
        None => cycle.iter().position(|row| row.index == 0),
    };
    cycle.rotate_left(first.unwrap_or_default());
    cycle.into_iter().map(|row| row.sample).collect()
}

#[cfg(test)]
mod tests {
    use planner_core::{Label, Site, VersionSpace};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::fitting::hull::in_order;
    use crate::fitting::shortest_pairs::bisector;

    /// A few samples on a coarse grid, far apart or near: many repeat each other and many are collinear. Most are
    /// labelled by a line, some of them wrongly.
    fn draw(rng: &mut ChaCha8Rng) -> Vec<Sample> {
        let width = rng.random_range(1..9_i32);
        let scale = [1, 65_536, (1 << 29) / 10][rng.random_range(0..3)];
        let (a, b, c) = (
            rng.random_range(-3..=3_i32),
            rng.random_range(-3..=3_i32),
            rng.random_range(-2 * width..=2 * width),
        );
        let wrong = [0.0, 0.0, 0.05, 0.5][rng.random_range(0..4)];
        let count = rng.random_range(0..20);
        let mut one = || {
            let (x, z) = (rng.random_range(-width..=width), rng.random_range(-width..=width));
            let site = Site::new(x * scale, z * scale).expect("on the lattice");
            let is_positive = (a * x + b * z >= c) != (rng.random_range(0.0..1.0) < wrong);
            Sample { site, label: if is_positive { Label::Positive } else { Label::Negative } }
        };
        (0..count).map(|_| one()).collect()
    }

    /// Samples on two arcs that face each other, one the other's mirror image or nearly: almost all of them bound
    /// the lines, and edges of one hull are parallel to edges of the other.
    fn draw_arcs(rng: &mut ChaCha8Rng) -> Vec<Sample> {
        let (half, bend) = (rng.random_range(2..17_i32), rng.random_range(1..5_i32));
        let (gap, shear) = (rng.random_range(1..9_i32), rng.random_range(-9..=9_i32));
        let (rows, spread) = (rng.random_range(6..=68), rng.random_range(0..2_i32));
        let mut one = || {
            let (x, up) = (rng.random_range(-half..=half), rng.random_range(0..2) == 0);
            let z = bend * x * x + gap + rng.random_range(0..=spread);
            let z = if up { z } else { -z } + shear * x;
            let site = Site::new(8 * x, z).expect("on the lattice");
            Sample { site, label: if up { Label::Positive } else { Label::Negative } }
        };
        (0..rows).map(|_| one()).collect()
    }

    #[test]
    fn a_record_has_the_version_space_that_the_planner_would_make_of_it() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let mut seen = [0; 4];
        for i in 0..60_000 {
            let samples = if i % 20 == 0 { draw_arcs(&mut rng) } else { draw(&mut rng) };
            let rows = in_order(&samples);
            let expected = VersionSpace::<68>::new(&samples);
            let found = Separation::of(&samples, &rows);
            let (space, found) = match (expected, found) {
                (Ok(space), Ok(found)) => (space, found),
                (expected, found) => {
                    let expected = expected.map(|_| ()).expect_err("one is none");
                    assert_eq!(found.map(|_| ()), Err(expected), "{samples:?}");
                    seen[match expected {
                        GivenError::Collinear => 0,
                        GivenError::OneLabel => 1,
                        _ => 2,
                    }] += 1;
                    continue;
                }
            };
            seen[3] += 1;
            let support: Vec<_> = space.support().collect();
            assert_eq!(found.support, support, "{samples:?}");
            assert!(found.bounds().eq(space.bounds()), "{samples:?}");
            assert_eq!(found.slope_arc(), space.slope_arc(), "{samples:?}");
            assert_eq!(found.intercepts(), space.intercepts(), "{samples:?}");
            let lines = [found.centre(), found.maximum_margin(), bisector(&rows)];
            let expected = [
                estimate::centre(space.lines()),
                estimate::maximum_margin(space.lines()),
                estimate::bisector(&samples),
            ];
            assert_eq!(lines, expected, "{samples:?}");
        }
        assert!(seen.iter().all(|count| *count > 1_500), "{seen:?}");
    }
}
