//! The tracker beside the table of hypotheses: what each knows of straight, still lines, from the same labels.
//!
//! The table is exact, and stores its samples: 128 at most. The tracker takes any number.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use planner_core::geometry::lattice::Vector;
use planner_core::{
    Area, Belief, CellPosterior, Front, Line, Noise, PosteriorView, Prior, Sample, Tracker,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

use crate::fronts::{label, left, site};

const SIDE: f64 = 20.0;

/// After so many labels both are asked; after the last the tracker alone.
const ASKED: [usize; 5] = [10, 30, 60, 120, 200];

/// So many labels are stored in the table, besides the given points.
const STORED: usize = 120;

/// What a belief knows: bits, the mean distance of its line from the true one, metres, and whether its 90 % hold.
type Known = (f64, f64, bool);

struct Truth {
    through: Point2<f64>,
    angle: f64,
}

impl Truth {
    fn sample(&self, at: Point2<f64>) -> Sample {
        Sample { site: site(at), label: label(left(at, self.through, self.angle) > 0.0) }
    }

    /// The mean distance of a line from five places of the true one.
    fn off(&self, line: Line) -> f64 {
        let along = Vector2::new(self.angle.cos(), self.angle.sin());
        let places = [-4.0, -2.0, 0.0, 2.0, 4.0].map(|by| self.through + along * by);
        places.map(|at| line.distance(at).abs()).iter().sum::<f64>() / 5.0
    }
}

/// The tracker and the table after each number of labels.
fn mission(number: u64, p: f64) -> Vec<[Option<Known>; 2]> {
    let mut rng = ChaCha8Rng::seed_from_u64(34);
    rng.set_stream(number);
    let inner = |rng: &mut ChaCha8Rng| rng.random_range(6.0..SIDE - 6.0);
    let through = Point2::new(inner(&mut rng), inner(&mut rng));
    let truth = Truth { through, angle: rng.random_range(0.0..TAU) };
    let place = |rng: &mut ChaCha8Rng| Point2::from([0, 1].map(|_| rng.random_range(0.0..SIDE)));
    let mut given: Vec<Sample> = Vec::new();
    while given.len() < 4 {
        let next = truth.sample(place(&mut rng));
        if given.iter().filter(|it| it.label == next.label).count() < 2 {
            given.push(next);
        }
    }
    let noise = Noise::new(p).expect("a probability");
    let area = Area::metres([0.0, 0.0], [SIDE, SIDE]).expect("an area");
    let mut tracker = Tracker::<24, 24, 1>::new(area, Front::STRAIGHT, noise).given(&given);
    let mut table = CellPosterior::<128, 2081>::new(&given, Prior::Area, noise).expect("a line");
    let mut known = Vec::new();
    for labels in 1..=200 {
        let places: Vec<_> = (0..40).map(|_| place(&mut rng)).collect();
        let open = |at: &Point2<f64>| (tracker.share_above(site(*at)) - 0.5).abs();
        let at = places.into_iter().min_by(|a, b| open(a).total_cmp(&open(b))).expect("a place");
        let Sample { site, label } = truth.sample(at);
        let label = if rng.random_bool(p) { label } else { -label };
        tracker.observe(site, label.into()).expect("any label");
        if labels <= STORED {
            table.observe(site, label.into()).expect("room");
        }
        if ASKED.contains(&labels) {
            let exact = (labels <= STORED).then(|| of_table(&table, &truth));
            known.push([Some(of_tracker(&tracker, &truth)), exact]);
        }
    }
    known
}

fn of_tracker(tracker: &Tracker<24, 24, 1>, truth: &Truth) -> Known {
    let waist = tracker.waist();
    let aside = left(waist.site.into(), truth.through, truth.angle).abs();
    let bits = tracker.information();
    // As long as it may have any direction, nothing is stated.
    let Some(line) = tracker.centre() else { return (bits, f64::INFINITY, true) };
    (bits, truth.off(line.into()), aside < waist.half_width(0.9))
}

fn of_table(table: &CellPosterior<128, 2081>, truth: &Truth) -> Known {
    let view = PosteriorView::new(table);
    let [x, z] = [truth.angle.cos(), truth.angle.sin()].map(|it| (it * 1e6) as i32);
    let holds = view.credible(0.9).slope_arc.contains(Vector::new(x, z).expect("a direction"));
    (view.information(), truth.off(view.mean().expect("a mean").into()), holds)
}

/// With noisy labels the tracker keeps most of the bits of the table, and is off by at most twice as much. The bits are
/// means over all lines. Its 90 % widths hold.
#[test]
fn the_tracker_keeps_most_of_what_the_table_knows() {
    for (p, least) in [(0.9, 0.65), (0.7, 0.5)] {
        let lines = cases(6, 200);
        let all: Vec<_> = (0..lines).into_par_iter().map(|it| mission(it, p)).collect();
        for (k, labels) in ASKED.into_iter().enumerate() {
            let row = |who: usize| {
                let known: Vec<Known> = all.iter().filter_map(|it| it[k][who]).collect();
                let share = 1.0 / known.len() as f64;
                let bits = known.iter().map(|it| it.0).sum::<f64>() * share;
                let holds = known.iter().filter(|it| it.2).count() as f64 * share;
                let mut off: Vec<_> = known.iter().map(|it| it.1).collect();
                off.sort_by(f64::total_cmp);
                let off = off.get(off.len() / 2).copied()?;
                Some((bits, off, holds))
            };
            let [tracker, table] = [row(0), row(1)];
            println!("p {p}, {labels} labels, {lines} lines: {tracker:.3?} beside {table:.3?}");
            let (bits, off, holds) = tracker.expect("a tracker");
            let [told, near] = table.map_or([0.0, 1.0], |it| [it.0, it.1]);
            assert!(bits > least * told, "{p}, {labels}: {bits}");
            let is_good = off < 2.0 * near && holds > 0.9;
            assert!(lines < 50 || is_good, "{p}, {labels}: {off}, {holds}");
        }
    }
}
