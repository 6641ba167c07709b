//! Where the line is likely to pass: nested bands of ground, from the hypotheses of the credible set.
//!
//! The directions of all lines of the set lie within less than half a turn. So a column across the middle direction
//! meets each line once. On a column the lines of a hypothesis fill an interval between two of its bounds. The places
//! of a column through which lines of a given probability pass are intervals too, found by a sum over sorted ends. A
//! band is the union of what lies between the intervals of neighbouring columns. Columns stand at every sample, where a
//! hypothesis's ends turn, and closely between.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape as _;
use nalgebra::{Point2, Vector2};
use planner_core::link::message::MissionArea;
use planner_core::parts::Bound;
use planner_core::{PosteriorView, Vector};
use serde::Serialize;

use crate::mission::definition::Table;
use crate::mission::read_out::LEVEL;
use crate::world::extent::span;
use crate::world::polygon::Polygon;
use crate::world::way::Way;

/// The thresholds of the bands: the least probability that lines pass a place of each. Ground below the first is blank.
pub const LEAST: [f64; 5] = [0.01, 0.2, 0.4, 0.6, 0.8];

/// The least share of the area for which a band is drawn.
const LEAST_SEEN: f64 = 1e-4;

/// Columns between those at the samples.
const COLUMNS: u32 = 240;

/// Ground where the line passes with at least some probability.
#[derive(Clone, Debug, Serialize)]
pub struct Band {
    /// The least probability of the hypotheses of the credible set that have lines through a place of it.
    pub from: f64,
    /// Polygons, each as its corners in metres, filled together by the even-odd rule.
    pub rings: Vec<Way>,
}

/// Coordinates along the middle direction of the set's lines and across it, metres.
struct Frame {
    along: Vector2<f64>,
    across: Vector2<f64>,
}

/// A line in a frame: where it is across at 0, and how much it rises.
#[derive(Clone, Copy)]
struct Rising {
    at: f64,
    slope: f64,
}

/// The lines that bound a hypothesis, and its probability.
struct Weighed {
    bounds: Vec<Rising>,
    probability: f64,
}

type Interval = [f64; 2];

/// The bands of a table's credible set in an area, each within the one before it.
pub(crate) fn of(table: &Table, area: &MissionArea) -> Vec<Band> {
    let posterior = PosteriorView::new(table);
    let set = posterior.credible(LEVEL);
    let frame = Frame::between(set.slope_arc.from(), set.slope_arc.to());
    let hypotheses: Vec<_> = posterior
        .members(&set)
        .map(|h| Weighed {
            bounds: table.lines(h).bounds().map(|bound| frame.rising(bound)).collect(),
            probability: posterior.probability(h),
        })
        .collect();
    let ground = Polygon::from(*area);
    let samples = table.samples().iter().map(|s| Point2::from(s.site));
    let columns = frame.columns(&ground, samples);
    let ends: Vec<_> = columns.iter().map(|&s| Ends::of(&hypotheses, s)).collect();
    let detail = ground.diameter() / 20_000.0;
    let band = |from| {
        let intervals: Vec<_> = ends.iter().map(|it| it.from(from)).collect();
        let both = columns.windows(2).zip(intervals.windows(2));
        let parts: Vec<_> =
            both.flat_map(|(s, it)| between([s[0], s[1]], &it[0], &it[1])).collect();
        let rings = parts.simplify_shape(FillRule::NonZero).into_iter().flatten();
        let in_area = |ring: Vec<[f64; 2]>| {
            let corners = straightened(ring, detail).into_iter().map(|it| frame.place(it));
            Some(Polygon(corners.collect()).within(&ground).0).filter(|corners| corners.len() > 2)
        };
        Band { from, rings: rings.filter_map(in_area).collect() }
    };
    let is_seen = |band: &Band| {
        let size: f64 = band.rings.iter().map(|ring| Polygon(ring.clone()).area()).sum();
        size > LEAST_SEEN * ground.area()
    };
    LEAST.map(band).into_iter().filter(is_seen).collect()
}

impl Frame {
    fn between(from: Vector, to: Vector) -> Self {
        let [from, to] = [from, to].map(|it| metres(it).normalize());
        let along = (from + to).normalize();
        Self { along, across: Vector2::new(-along.y, along.x) }
    }

    fn coordinates(&self, at: Point2<f64>) -> Point2<f64> {
        Point2::new(at.coords.dot(&self.along), at.coords.dot(&self.across))
    }

    fn place(&self, at: Point2<f64>) -> Point2<f64> {
        Point2::from(self.along * at.x + self.across * at.y)
    }

    fn rising(&self, bound: Bound) -> Rising {
        let (through, way) = (self.coordinates(bound.through.into()), metres(bound.along));
        let slope = way.dot(&self.across) / way.dot(&self.along);
        Rising { at: through.y - slope * through.x, slope }
    }

    /// Where columns stand, in order.
    fn columns(&self, area: &Polygon, samples: impl Iterator<Item = Point2<f64>>) -> Vec<f64> {
        let [from, to] = span(area.0.iter().map(|corner| self.coordinates(*corner).x));
        let even = |k| from + (to - from) * f64::from(k) / f64::from(COLUMNS);
        let samples = samples.map(|at| self.coordinates(at).x).filter(|s| from < *s && *s < to);
        let mut columns: Vec<_> = (0..=COLUMNS).map(even).chain(samples).collect();
        columns.sort_by(f64::total_cmp);
        columns.dedup();
        columns
    }
}

fn metres(it: Vector) -> Vector2<f64> {
    Vector2::new(it.x().into(), it.z().into())
}

/// Where hypotheses' lines begin and end on a column, in order, with the probability that comes or goes there.
struct Ends(Vec<(f64, f64)>);

impl Ends {
    fn of(hypotheses: &[Weighed], s: f64) -> Self {
        let mut ends = Vec::with_capacity(2 * hypotheses.len());
        for Weighed { bounds, probability } in hypotheses {
            let [from, to] = span(bounds.iter().map(|it| it.at + it.slope * s));
            ends.extend([(from, *probability), (to, -probability)]);
        }
        // Where one ends and another begins both count.
        ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
        Self(ends)
    }

    /// The intervals through which lines of at least this probability pass.
    fn from(&self, least: f64) -> Vec<Interval> {
        const ROUNDING: f64 = 1e-12;
        let (mut mass, mut begun, mut intervals) = (0.0, None, Vec::new());
        for &(at, change) in &self.0 {
            mass += change;
            let holds = mass >= least - ROUNDING;
            match begun {
                None if holds => begun = Some(at),
                Some(from) if !holds => {
                    intervals.push([from, at]);
                    begun = None;
                }
                _ => {}
            }
        }
        intervals
    }
}

/// The ground between two columns: a part for each interval of one and each of the other that it overlaps.
fn between([s, t]: [f64; 2], left: &[Interval], right: &[Interval]) -> Vec<Vec<[f64; 2]>> {
    let pairs = left.iter().flat_map(|a| right.iter().map(move |b| (a, b)));
    let meeting = pairs.filter(|(a, b)| a[0] <= b[1] && b[0] <= a[1]);
    meeting.map(|(a, b)| vec![[s, a[0]], [t, b[0]], [t, b[1]], [s, a[1]]]).collect()
}

/// A ring without the corners that are straight to some detail.
fn straightened(ring: Vec<[f64; 2]>, detail: f64) -> Vec<Point2<f64>> {
    let first = ring.first().copied();
    let closed: Vec<_> = ring.into_iter().chain(first).map(Point2::from).collect();
    let mut kept = simplified(&closed, detail);
    kept.pop();
    kept
}

/// A line of places without those that are nearer than this to the straight line between the ones that stay
/// (Douglas and Peucker's).
pub(crate) fn simplified(line: &[Point2<f64>], detail: f64) -> Vec<Point2<f64>> {
    let (Some(&from), Some(&to)) = (line.first(), line.last()) else { return Vec::new() };
    let way = to - from;
    let off = |at: &Point2<f64>| {
        if way.norm() > 0.0 {
            way.perp(&(at - from)).abs() / way.norm()
        } else {
            (at - from).norm()
        }
    };
    let furthest =
        (1..line.len().saturating_sub(1)).max_by(|a, b| off(&line[*a]).total_cmp(&off(&line[*b])));
    match furthest {
        Some(k) if off(&line[k]) > detail => {
            let mut kept = simplified(&line[..=k], detail);
            kept.pop();
            kept.extend(simplified(&line[k..], detail));
            kept
        }
        _ => vec![from, to],
    }
}

#[cfg(test)]
mod tests {
    use planner_core::{Certainty, Site};
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::mission::recording::Recording;
    use crate::mission::scenario::{self, Overrides};

    /// Whether a place is inside, by the even-odd rule.
    fn holds(band: &Band, at: Point2<f64>) -> bool {
        let crosses = |ring: &Vec<Point2<f64>>| {
            let next = ring.iter().cycle().skip(1);
            let crossed = |(p, q): &(&Point2<f64>, &Point2<f64>)| {
                (p.y > at.y) != (q.y > at.y)
                    && at.x < p.x + (at.y - p.y) / (q.y - p.y) * (q.x - p.x)
            };
            ring.iter().zip(next).filter(crossed).count()
        };
        band.rings.iter().map(crosses).sum::<usize>() % 2 == 1
    }

    #[test]
    fn bands_hold_the_mass_that_is_summed_place_by_place() {
        const AROUND: f64 = 0.15; // more than from one column to the next
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut told = [0, 0];
        for seed in 1..=12 {
            let steps = Some([1, 5, 10, 25][seed as usize % 4]);
            let overrides = Overrides { steps, seed: Some(seed), ..Overrides::default() };
            let mission = scenario::parse("", scenario::PAPER_NOISY, overrides).unwrap();
            let recording = Recording::of(&mission).unwrap();
            let table = recording.belief.hypotheses().unwrap();
            let bands = of(table, &mission.config.area);
            let posterior = PosteriorView::new(table);
            let set = posterior.credible(LEVEL);
            let mass = |at: Point2<f64>| -> f64 {
                let at = Site::try_from(at).unwrap();
                let pass = |h: &&_| table.lines(h).certainty(at) == Certainty::Uncertain;
                posterior.members(&set).filter(pass).map(|h| posterior.probability(h)).sum()
            };
            for _ in 0..400 {
                let at = Point2::new(rng.random_range(0.2..19.8), rng.random_range(0.2..19.8));
                let way = |k: u32| {
                    let (sin, cos) = libm::sincos(f64::from(k) * std::f64::consts::FRAC_PI_8);
                    at + Vector2::new(cos, sin) * AROUND
                };
                let masses: Vec<_> = (0..16).map(way).chain([at]).map(mass).collect();
                for (band, outer) in
                    bands.iter().zip([None].into_iter().chain(bands.iter().map(Some)))
                {
                    let inside = holds(band, at);
                    if masses.iter().all(|mass| *mass >= band.from) {
                        assert!(inside, "seed {seed}: {at} has {masses:?}, band {}", band.from);
                        told[0] += 1;
                    } else if masses.iter().all(|mass| *mass < band.from) {
                        assert!(!inside, "seed {seed}: {at} has {masses:?}, band {}", band.from);
                        told[1] += 1;
                    }
                    let nests = outer.is_none_or(|outer| !inside || holds(outer, at));
                    assert!(
                        nests,
                        "seed {seed}: {at} is not within all bands before {}",
                        band.from
                    );
                }
            }
        }
        assert!(told[0] > 2000 && told[1] > 8000, "{told:?} of 24000 told inside and outside");
    }
}
