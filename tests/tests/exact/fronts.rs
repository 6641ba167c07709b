//! The tracker against slow twins. Of a straight, still front the twin is a dense grid in double precision; of one
//! that bends and moves it is a cloud of curves, each followed by itself.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use planner_core::{
    AnyReliability, Area, Belief as _, Front, Label, Noise, Site, Tolerance, Tracker,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::{cases, is_long};

const SIDE: f64 = 20.0;

/// The reliability that a label is told to have at most.
const MOST: f64 = 0.98;

fn site(at: Point2<f64>) -> Site {
    Site::try_from(at).expect("on the lattice")
}

fn area() -> Area {
    Area::metres([0.0, 0.0], [SIDE, SIDE]).expect("an area")
}

fn label(is_above: bool) -> Label {
    if is_above { Label::Positive } else { Label::Negative }
}

/// How far to the left of a line through a place a point lies.
fn left(at: Point2<f64>, through: Point2<f64>, angle: f64) -> f64 {
    let off = at - through;
    off.y * angle.cos() - off.x * angle.sin()
}

/// A line by its direction, its normal, how far it passes the middle along that, and how probable it is.
struct Line {
    angle: f64,
    normal: [f64; 2],
    offset: f64,
    mass: f64,
}

impl Line {
    /// How far along the normal of the line through the middle a place lies.
    fn along(&self, at: Point2<f64>) -> f64 {
        let [x, z] = self.normal;
        x * (at.x - SIDE / 2.0) + z * (at.y - SIDE / 2.0)
    }

    fn is_below(&self, at: Point2<f64>) -> bool {
        self.along(at) > self.offset
    }
}

/// Lines of a grid.
struct Dense {
    lines: Vec<Line>,
    count: f64,
    nowhere: [f64; 2],
    /// What all comes to.
    whole: f64,
}

impl Dense {
    fn new() -> Self {
        let (turns, offsets, far) = (720, 600, SIDE / std::f64::consts::SQRT_2);
        let mut lines = Vec::new();
        for k in 0..turns {
            let angle = TAU * (f64::from(k) + 0.5) / f64::from(turns);
            let normal = [-angle.sin(), angle.cos()];
            let reach = SIDE / 2.0 * (normal[0].abs() + normal[1].abs());
            for m in 0..offsets {
                let offset = far * ((f64::from(m) + 0.5) / f64::from(offsets) * 2.0 - 1.0);
                if offset.abs() < reach {
                    lines.push(Line { angle, normal, offset, mass: 0.9 });
                }
            }
        }
        let count = lines.len() as f64;
        for line in &mut lines {
            line.mass /= count;
        }
        Self { lines, count, nowhere: [0.05; 2], whole: 1.0 }
    }

    fn share(&self, at: Point2<f64>) -> f64 {
        let lines = self.lines.iter().filter(|it| it.is_below(at));
        (self.nowhere[0] + lines.map(|it| it.mass).sum::<f64>()) / self.whole
    }

    fn take(&mut self, at: Point2<f64>, is_above: bool, p: f64) {
        let weight = |above: bool| if above == is_above { p } else { 1.0 - p };
        self.nowhere = [self.nowhere[0] * weight(true), self.nowhere[1] * weight(false)];
        // Half a million of these are next to nothing.
        let (least, mut sum) = (1e-12 * self.whole, 0.0);
        self.lines.retain_mut(|it| {
            it.mass *= weight(it.is_below(at));
            sum += it.mass;
            it.mass > least
        });
        self.whole = self.nowhere.iter().sum::<f64>() + sum;
    }

    /// How much is known beyond that there is a line, bits.
    fn bits(&self) -> f64 {
        let whole = self.whole - self.nowhere.iter().sum::<f64>();
        let share = self.lines.iter().map(|it| it.mass / whole);
        share.map(|it| it * (it * self.count).log2()).sum()
    }

    /// The mean and the deviation of how far the lines pass to the left of a place, against a direction.
    fn offsets(&self, at: Point2<f64>, along: f64) -> [f64; 2] {
        let near = self.lines.iter().filter(|it| (it.angle - along).cos() > 0.2);
        let sums = near.fold([0.0; 3], |[mass, first, second], it| {
            let off = (it.offset - it.along(at)) / (it.angle - along).cos();
            [mass + it.mass, first + it.mass * off, second + it.mass * off * off]
        });
        let mean = sums[1] / sums[0];
        [mean, (sums[2] / sums[0] - mean * mean).sqrt()]
    }
}

/// A straight front that is drawn at random: a place on it and its direction.
fn line(rng: &mut ChaCha8Rng) -> (Point2<f64>, f64) {
    let mut metres = || rng.random_range(4.0..SIDE - 4.0);
    (Point2::new(metres(), metres()), rng.random_range(0.0..TAU))
}

/// Of some places of the area the one where a label is the most open.
fn open_place<const K: usize, const M: usize, const L: usize>(
    tracker: &Tracker<K, M, L>,
    rng: &mut ChaCha8Rng,
) -> Point2<f64> {
    let places = (0..60).map(|_| [0, 1].map(|_| rng.random_range(0.0..SIDE)).into());
    let open = |at: &Point2<f64>| (tracker.share_above(site(*at)) - 0.5).abs();
    places.min_by(|a, b| open(a).total_cmp(&open(b))).expect("a place")
}

#[test]
fn a_straight_front_is_known_as_by_a_dense_grid() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (mut shares, mut widths, mut offsets) = (Vec::new(), Vec::new(), Vec::new());
    let mut bits: [Vec<[f64; 2]>; 3] = Default::default();
    for case in 0..cases(20, 100) {
        let p = [1.0, 0.9, 0.7][case as usize % 3];
        let (through, angle) = line(&mut rng);
        let mut twin = Dense::new();
        let noise = Noise::new(p).expect("a probability");
        let mut tracker = Tracker::<24, 24, 1>::new(area(), Front::STRAIGHT, noise);
        for _ in 0..[8, 14, 20, 24][case as usize % 4] {
            let at = open_place(&tracker, &mut rng);
            let is_above = (left(at, through, angle) > 0.0) == rng.random_bool(p);
            tracker.observe(site(at), label(is_above).into()).expect("a label");
            twin.take(at, is_above, p.min(MOST));
        }
        let told = [tracker.information(), twin.bits()];
        // Beyond that the grid is too coarse.
        assert!(told[0] < told[1] + 0.1 || told[1] > 12.0, "{p}: {told:?} bits");
        bits[case as usize % 3].extend([told]);
        for _ in 0..60 {
            let at = [0, 1].map(|_| rng.random_range(0.0..SIDE)).into();
            let (got, is) = (f64::from(tracker.share_above(site(at))), twin.share(at));
            shares.push((got - is).abs());
        }
        let waist = tracker.waist();
        // A belief that is not yet of one direction has no waist.
        if waist.turn_deviation < 0.3 {
            let [mean, width] = twin.offsets(waist.site.into(), waist.heading.radians());
            widths.push(f64::from(waist.deviation) / width);
            offsets.push(mean.abs() / width);
        }
    }
    // It keeps most of what can be known.
    for (told, least) in bits.into_iter().zip([0.65, 0.65, 0.5]) {
        let [got, most] = [0, 1].map(|k| told.iter().map(|it| it[k]).sum::<f64>());
        assert!(got > least * most, "{told:?} bits");
    }
    let [share, offset] = [&shares, &offsets].map(|it| Summary::of(it));
    assert!(share.mean < 0.02 && share.p95 < 0.08, "{share:?}");
    assert!(widths.len() >= 4 && offset.mean < 0.35 && offset.p95 < 1.1, "{offset:?}");
    // Tails that few lines have make some of them much larger or smaller.
    let alike = widths.iter().filter(|it| (0.7..2.0).contains(*it)).count();
    assert!(alike * 10 >= widths.len() * 8, "{widths:?}");
}

/// The mean of some numbers, and what 95 % of them are below.
#[derive(Debug)]
struct Summary {
    mean: f64,
    p95: f64,
}

impl Summary {
    fn of(numbers: &[f64]) -> Self {
        let mut sorted = numbers.to_vec();
        sorted.sort_by(f64::total_cmp);
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        Self { mean, p95: sorted[sorted.len() * 19 / 20] }
    }
}

/// The stated widths hold the truth as often as they say, or more often: of exact positions, of such that err, and of a
/// reliability that follows its prior.
#[test]
fn stated_widths_of_straight_fronts_hold_the_truth() {
    let known = |p: f64| Noise::<AnyReliability>::from(Noise::new(p).expect("a probability"));
    let erring = Noise { tolerance: Tolerance::new(0.9).expect("a length"), ..known(0.9) };
    let unknown = Noise::beta(8.0, 2.0).expect("a prior").into();
    for (name, p, noise, labels, least, most) in [
        ("true labels", Some(1.0), known(1.0), 20, 0.95, 0.1),
        ("true labels", Some(1.0), known(1.0), 40, 0.95, 0.02),
        ("p = 0.9", Some(0.9), known(0.9), 60, 0.93, 0.04),
        ("positions that err", Some(0.9), erring, 60, 0.9, 0.15),
        ("a reliability by its prior", None, unknown, 60, 0.86, 0.5),
    ] {
        let mut rng = ChaCha8Rng::seed_from_u64(32);
        let fields = cases(100, 3_000);
        let (mut holds, mut errors) = (0, Vec::new());
        for _ in 0..fields {
            let (through, angle) = line(&mut rng);
            let deviation = noise.tolerance.metres() / 3.0;
            let p = p.unwrap_or_else(|| beta_8_2(&mut rng));
            let mut tracker = Tracker::<16, 16, 1>::new(area(), Front::STRAIGHT, noise);
            for _ in 0..labels {
                let at = open_place(&tracker, &mut rng);
                let error = Vector2::from(gauss(&mut rng)) * deviation;
                let is_above = (left(at + error, through, angle) > 0.0) == rng.random_bool(p);
                tracker.observe(site(at), label(is_above).into()).expect("a label");
            }
            let waist = tracker.waist();
            let off = left(waist.site.into(), through, angle).abs();
            holds += u64::from(off <= waist.half_width(0.9));
            errors.push(off);
        }
        errors.sort_by(f64::total_cmp);
        let (share, median) = (holds as f64 / fields as f64, errors[errors.len() / 2]);
        println!("{name}, {labels} labels: {share:.3} hold, {median:.4} m off");
        let slack = if is_long() { 0.0 } else { 0.03 };
        let fits = share >= least - slack && median < most;
        assert!(fits, "{name}, {labels} labels, seed 32: {share}, {median}");
    }
}

/// A number that is drawn from Beta(8, 2): the second largest of nine.
fn beta_8_2(rng: &mut ChaCha8Rng) -> f64 {
    let mut drawn: Vec<f64> = (0..9).map(|_| rng.random_range(0.0..1.0)).collect();
    drawn.sort_by(f64::total_cmp);
    drawn[7]
}

/// A curve at the robot's foot: a place, a direction and a curvature.
#[derive(Clone, Copy)]
struct Curve {
    at: Point2<f64>,
    angle: f64,
    bend: f64,
}

impl Curve {
    /// How far to the left of it a place lies.
    fn left(self, at: Point2<f64>) -> f64 {
        let normal = Vector2::new(-self.angle.sin(), self.angle.cos());
        if self.bend == 0.0 {
            return (at - self.at).dot(&normal);
        }
        let radius = 1.0 / self.bend;
        let middle = self.at + normal * radius;
        radius - radius.signum() * (at - middle).norm()
    }

    /// The same curve, told from another place on it: the one so far on.
    fn on(self, ahead: f64) -> Self {
        let turned = self.angle + self.bend * ahead;
        let middle = self.angle + 0.5 * self.bend * ahead;
        let at = self.at + Vector2::new(middle.cos(), middle.sin()) * ahead;
        Self { at, angle: turned, ..self }
    }
}

/// Two numbers of the normal distribution.
fn gauss(rng: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = (-2.0 * (1.0 - rng.random_range(0.0..1.0_f64)).ln()).sqrt();
    let (sin, cos) = (TAU * rng.random_range(0.0..1.0)).sin_cos();
    [radius * cos, radius * sin]
}

/// A robot goes to and fro along a front that bends or moves. The cloud begins as the tracker does, and forgets in the
/// same way.
#[test]
fn a_front_that_bends_and_moves_is_known_as_by_a_cloud_of_curves() {
    let curves = cases(25_000, 60_000) as usize;
    let mut rng = ChaCha8Rng::seed_from_u64(33);
    let (mut shares, mut offsets, mut widths) = (Vec::new(), Vec::new(), Vec::new());
    for case in 0..cases(3, 24) {
        let (radius, speed) =
            [(30.0, 0.0), (60.0, 0.05), (20.0, 0.02), (100.0, 0.1)][case as usize % 4];
        let p = [1.0, 0.9][case as usize / 2 % 2];
        // As the tracker assumes: its outer layers bend a little more than was told, and curves stray on the way.
        let tightest = 1.035 / radius;
        let front = Front::bending(radius).and_then(|it| it.moving(speed)).expect("a front");
        let near = Area::metres([-6.0, -6.0], [6.0, 6.0]).expect("an area");
        let noise = Noise::new(p).expect("a probability");
        let mut tracker = Tracker::<24, 24, 3>::new(near, front, noise);
        let mut cloud: Vec<_> = (0..curves)
            .map(|_| {
                let angle = rng.random_range(0.0..TAU);
                let offset = rng.random_range(-8.5..8.5);
                let normal = Vector2::new(-angle.sin(), angle.cos());
                let bend = f64::from(rng.random_range(-1..=1)) * tightest;
                Curve { at: Point2::origin() + normal * offset, angle, bend }
            })
            .filter(|it| {
                let reach = 6.0 * (it.angle.cos().abs() + it.angle.sin().abs());
                it.left(Point2::origin()).abs() < reach
            })
            .collect();
        let truth = Curve { at: Point2::origin(), angle: 0.0, bend: 1.0 / radius };
        let mut from = Point2::origin();
        for step in 0..40 {
            let foot = truth.on(0.5 * f64::from(step));
            let normal = Vector2::new(-foot.angle.sin(), foot.angle.cos());
            let aside = [0.8, -0.3, 0.2, -1.0, 0.5, -0.6][step as usize % 6];
            let at = foot.at + normal * aside;
            let is_above = (truth.left(at) > 0.0) == rng.random_bool(p);
            let way = (at - from).norm().min(0.5 / tightest);
            from = at;
            tracker.moved(site(at), 1.0);
            tracker.observe(site(at), label(is_above).into()).expect("a label");
            let told = p.min(MOST);
            let mut weights = Vec::new();
            for curve in &mut cloud {
                let unit = Vector2::new(curve.angle.cos(), curve.angle.sin());
                *curve = curve.on((at - curve.at).dot(&unit).clamp(-radius / 2.0, radius / 2.0));
                let normal = Vector2::new(-curve.angle.sin(), curve.angle.cos());
                let strays = 0.1 * tightest * way;
                let ([by, turn], [strayed, bent]) = (gauss(&mut rng), gauss(&mut rng));
                curve.at += normal * (0.5 * (speed * by + strays * way * strayed));
                curve.angle += 0.5 * speed / 30.0 * turn + strays * bent;
                if rng.random_bool(0.09) {
                    curve.bend = if curve.bend == 0.0 {
                        [-1.0, 1.0][rng.random_range(0..2)] * tightest
                    } else {
                        0.0
                    };
                } else if curve.bend == 0.0 && rng.random_bool(0.09) {
                    curve.bend = [-1.0, 1.0][rng.random_range(0..2)] * tightest;
                }
                let agrees = (curve.left(at) > 0.0) == is_above;
                weights.push(if agrees { told } else { 1.0 - told });
            }
            cloud = drawn(&cloud, &weights, &mut rng, curves);
            // As soon as both are of one direction.
            if step % 5 == 4 && tracker.waist().turn_deviation < 0.25 {
                for _ in 0..12 {
                    let by = [0, 1].map(|_| rng.random_range(-2.5..2.5));
                    let place = at + Vector2::from(by);
                    let above = cloud.iter().filter(|it| it.left(place) > 0.0).count();
                    let is = above as f64 / cloud.len() as f64;
                    shares.push((f64::from(tracker.share_above(site(place))) - is).abs());
                }
                let waist = tracker.waist();
                let here = Point2::<f64>::from(waist.site);
                let left: Vec<_> = cloud.iter().map(|it| it.left(here)).collect();
                let mean = left.iter().sum::<f64>() / left.len() as f64;
                let square = left.iter().map(|it| (it - mean).powi(2)).sum::<f64>();
                let width = (square / left.len() as f64).sqrt();
                offsets.push(mean.abs() / width);
                widths.push(f64::from(waist.deviation) / width);
            }
        }
    }
    let [share, offset, width] = [&shares, &offsets, &widths].map(|it| Summary::of(it));
    assert!(shares.len() > 100 && share.mean < 0.02 && share.p95 < 0.1, "{share:?}");
    assert!(offset.mean < 0.2 && (0.9..1.3).contains(&width.mean), "{offset:?}, {width:?}");
}

/// Curves drawn by their weights, evenly.
fn drawn(cloud: &[Curve], weights: &[f64], rng: &mut ChaCha8Rng, count: usize) -> Vec<Curve> {
    let step = weights.iter().sum::<f64>() / count as f64;
    let (mut next, mut sum) = (rng.random_range(0.0..step), 0.0);
    let mut drawn = Vec::with_capacity(count);
    for (curve, weight) in cloud.iter().zip(weights) {
        sum += weight;
        while next < sum {
            drawn.push(*curve);
            next += step;
        }
    }
    drawn
}

/// A robot that hears no label knows the front no better as time passes: it stays at a place, or about one. A front that
/// moves becomes as unsure as it moves across itself: by half of its speed, or by all of it for a robot that stays.
#[test]
fn nothing_is_learnt_without_labels() {
    for number in 0..cases(12, 1_000) {
        let mut rng = ChaCha8Rng::seed_from_u64(37);
        rng.set_stream(number);
        let speed = if number % 3 == 0 { 0.0 } else { rng.random_range(0.005..0.1) };
        let front = Front::bending(rng.random_range(8.0..200.0)).and_then(|it| it.moving(speed));
        let noise = Noise::new(if number % 2 == 0 { 0.9 } else { 1.0 }).expect("a probability");
        let tracker = Tracker::<16, 16, 3>::new(area(), front.expect("a front"), noise);
        let stays = number / 3 % 2 == 0;
        let mut tracker = if stays { tracker.staying() } else { tracker };
        for k in 0..rng.random_range(40..100) {
            let at = Point2::new(0.3 * f64::from(k), rng.random_range(9.0..11.0));
            tracker.moved(site(at), 1.0);
            let above = label(at.y > 10.0);
            tracker.observe(site(at), above.into()).expect("a label");
        }
        let near = Point2::<f64>::from(tracker.waist().site);
        let (aside, wanders) = (rng.random_range(0.0..4.0), f64::from(u8::from(number % 4 < 2)));
        let (mut widest, mut narrowest) = (0.0_f64, 1.0_f64);
        for _ in 0..300 {
            let mut by = || wanders * rng.random_range(-1.0..1.0);
            let at = site(near + Vector2::new(by(), aside + by()));
            tracker.moved(at, 1.0);
            tracker.settle(at);
            let width = tracker.waist().half_width(0.9);
            widest = widest.max(width);
            narrowest = narrowest.min(width / widest);
        }
        assert!(narrowest > 0.95, "{number}, {speed} m: {narrowest} of {widest} m");
        let across = if stays { speed } else { 0.5 * speed };
        let moves = 1.645 * across * 300.0_f64.sqrt();
        assert!(widest > 0.85 * moves, "{number}, {speed} m: {widest} m, not {moves} m");
    }
}
