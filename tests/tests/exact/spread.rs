//! How far lines are expected to lie apart after a label, against a fine grid of lines in double precision.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::Lines;
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::{Point2, Vector2};
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::parts::{Spread as _, Stretch};
use planner_core::{Belief as _, Label, Line, PredictiveBelief, Reading, Sample, Site, Vector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::known::spaces;

/// Directions and offsets of the grid.
const GRID: usize = 240;

/// A stretch of 20 m about the point of the estimate that is nearest to the middle of the field.
struct About {
    middle: Point2<f64>,
    along: Vector2<f64>,
}

impl About {
    fn of(line: &Line) -> Self {
        let [a, b, _] = line.coefficients();
        let normal = Vector2::new(a, b).normalize();
        let field = Point2::new(10.0, 10.0);
        let middle = field - normal * line.distance(field);
        Self { middle, along: Vector2::new(normal.y, -normal.x) }
    }

    fn stretch(&self) -> Stretch {
        let [x, z] = [self.along.x, self.along.y].map(|it| (it * f64::from(1 << 24)) as i32);
        Stretch {
            middle: Site::try_from(self.middle).expect("in the field"),
            along: Vector::new(x, z).expect("short"),
            length: (20 * UNITS_PER_METRE) as f32,
        }
    }

    /// The turn of a line against the estimate, and how far to its left it passes the middle.
    fn seen(&self, line: &Line) -> [f64; 2] {
        let [a, b, _] = line.coefficients();
        let normal = Vector2::new(a, b).normalize();
        let left = Vector2::new(-self.along.y, self.along.x);
        let turn = (-normal.dot(&self.along)).atan2(normal.dot(&left));
        [turn, -line.distance(self.middle)]
    }

    /// The line of a turn and an offset.
    fn line(&self, turn: f64, offset: f64) -> Line {
        let left = Vector2::new(-self.along.y, self.along.x);
        let normal = left * turn.cos() - self.along * turn.sin();
        Line::through(self.middle + normal * offset, normal).expect("a line")
    }
}

fn is_above(line: &Line, site: Site) -> bool {
    line.distance(Point2::from(site)) > 0.0
}

/// Lines of a grid with their weights: those between the given samples, by the labels since, true with probability `p`.
fn weighed(about: &About, given: &Lines, labels: &[Sample], p: f64) -> Vec<(Line, [f64; 2], f64)> {
    let seen: Vec<_> = given.bounds().map(|bound| about.seen(&Line::from(bound))).collect();
    let range = |axis: usize| {
        let low = seen.iter().map(|it| it[axis]).fold(f64::INFINITY, f64::min);
        let high = seen.iter().map(|it| it[axis]).fold(f64::NEG_INFINITY, f64::max);
        move |k: usize| low + (high - low) * (k as f64 + 0.5) / GRID as f64
    };
    let (turns, offsets) = (range(0), range(1));
    let agrees =
        |line: &Line, it: &Sample| is_above(line, it.site) == (it.label == Label::Positive);
    let mut all = Vec::new();
    for (k, l) in (0..GRID).flat_map(|k| (0..GRID).map(move |l| (k, l))) {
        let at = [turns(k), offsets(l)];
        let line = about.line(at[0], at[1]);
        if given.samples().iter().all(|it| agrees(&line, it)) {
            let weights = labels.iter().map(|it| if agrees(&line, it) { p } else { 1.0 - p });
            let weight = weights.product();
            all.push((line, at, weight));
        }
    }
    all
}

/// The covariance over a stretch of 20 m: of the offset, of offset and lever times turn, of lever times turn.
fn covariance(lines: &(impl Iterator<Item = ([f64; 2], f64)> + Clone)) -> [f64; 3] {
    let mass: f64 = lines.clone().map(|(_, weight)| weight).sum();
    let sides =
        lines.clone().map(|([turn, offset], weight)| ([offset, LEVER * turn], weight / mass));
    let mean = |axis: usize| sides.clone().map(|(at, weight)| weight * at[axis]).sum::<f64>();
    let means = [0, 1].map(mean);
    [[0, 0], [0, 1], [1, 1]].map(|[a, b]| {
        sides.clone().map(|(at, weight)| weight * (at[a] - means[a]) * (at[b] - means[b])).sum()
    })
}

/// Of 20 m.
const LEVER: f64 = 20.0 * 0.288_675_134_594_812_9;

/// What a label leaves of it on average, as shares of the variance before.
fn expected(lines: &[(Line, [f64; 2], f64)], site: Site, p: f64) -> [f64; 3] {
    let whole = lines.iter().map(|(_, at, weight)| (*at, *weight));
    let mass: f64 = whole.clone().map(|(_, weight)| weight).sum();
    let [offset, _, turn] = covariance(&whole);
    let mut left = [0.0; 3];
    for label in [true, false] {
        let after = lines.iter().map(|(line, at, weight)| {
            let is_so = is_above(line, site) == label;
            (*at, weight * if is_so { p } else { 1.0 - p })
        });
        let chance = after.clone().map(|(_, weight)| weight).sum::<f64>() / mass;
        if chance > 1e-9 {
            let parts = left.iter_mut().zip(covariance(&after));
            parts.for_each(|(left, part)| *left += chance * part / (offset + turn));
        }
    }
    left
}

/// Places about the estimate at which at least a twentieth of the lines disagree with the others.
fn places(about: &About, lines: &[(Line, [f64; 2], f64)], rng: &mut ChaCha8Rng) -> Vec<Site> {
    let mass: f64 = lines.iter().map(|it| it.2).sum();
    let drawn = (0..400).filter_map(|_| {
        let (line, ..) = &lines[rng.random_range(0..lines.len())];
        let ahead = rng.random_range(-10.0..10.0);
        let [turn, offset] = about.seen(line);
        let left = Vector2::new(-about.along.y, about.along.x);
        let site = about.middle + about.along * ahead + left * (offset + ahead * turn.tan());
        Site::try_from(site).ok()
    });
    let splits = |site: &Site| {
        let above: f64 = lines.iter().filter(|it| is_above(&it.0, *site)).map(|it| it.2).sum();
        (0.05..0.95).contains(&(above / mass))
    };
    drawn.filter(splits).take(8).collect()
}

/// The worst and the mean difference from the grid.
fn compare<B: PredictiveBelief>(
    belief: &B,
    about: &About,
    lines: &[(Line, [f64; 2], f64)],
    p: f64,
    rng: &mut ChaCha8Rng,
) -> Vec<f64> {
    let spread = belief.spread(&about.stretch());
    let whole = spread.covariance();
    let whole = f64::from(whole.offset + whole.turn);
    let off = |site| {
        let left = spread.after(site);
        let got = [left.offset, left.both, left.turn].map(|it| f64::from(it) / whole);
        got.into_iter().zip(expected(lines, site, p)).map(|(got, expected)| got - expected)
    };
    places(about, lines, rng).into_iter().flat_map(off).collect()
}

#[test]
fn true_labels_leave_the_covariance_that_is_expected() {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(21));
    let mut off = Vec::new();
    for steps in [2, 5, 9, 14] {
        for (_, space, _) in spaces(steps).take(cases(3, 60) as usize) {
            let about = About::of(&Line::from(space.centre().expect("an estimate")));
            let lines = weighed(&about, &space, &[], 1.0);
            off.extend(compare(&space, &about, &lines, 1.0, &mut rng));
        }
    }
    check(&off, 0.01, 0.06);
}

#[test]
fn doubtful_labels_leave_the_covariance_that_is_expected() {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(22));
    let mut off = Vec::new();
    for number in 0..cases(8, 120) {
        let p = [0.7, 0.9][number as usize % 2];
        let mut mission = standard_field::standard(23, number, Algorithm::Lookahead, 1);
        mission.noise = Some(NoiseModel { p, extent: Extent::OutsideBalls(0.0) });
        let (mut belief, mut labels) = (mission.noisy_belief(), Vec::new());
        for _ in 0..rng.random_range(0..12) {
            let place = [0, 1].map(|_| rng.random_range(2.0..18.0));
            let site = Site::try_from(Point2::from(place)).expect("in the field");
            let Reading::Side(truth) = mission.world.reading(site) else { continue };
            let label = if rng.random_bool(p) { truth } else { -truth };
            belief
                .observe_within(site, Reading::Side(label), mission.config.tolerance)
                .expect("room");
            labels.push(Sample { site, label });
        }
        belief.prepare();
        let about = About::of(&Line::from(belief.belief().centre().expect("an estimate")));
        let lines = weighed(&about, &mission.lines(), &labels, p);
        off.extend(compare(&belief, &about, &lines, p, &mut rng));
    }
    check(&off, 0.03, 0.15);
}

/// Whether differences are small, on average and at worst.
fn check(off: &[f64], mean: f64, worst: f64) {
    let sizes: Vec<_> = off.iter().map(|it| it.abs()).collect();
    let average = sizes.iter().sum::<f64>() / sizes.len() as f64;
    let most = sizes.iter().fold(0.0, |most: f64, it| most.max(*it));
    assert!(sizes.len() > 30 && average < mean && most < worst, "{average}, {most}");
}
