//! Boundaries that bend and move within what the planner allows for, read late by a robot whose positions err: no label is
//! ever refused, no audit fails, and the line of each time is among the lines left. That is a theorem
//! (`planner-core/src/belief/deviation.rs`), so each of these missions is a proof against it.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::CAPACITY;
use host_sim::mission::read_out::LEVEL;
use host_sim::world::World;
use host_sim::world::noise::{Extent, NoiseModel};
use host_sim::world::polygon::misclassified;
use host_sim::world::sine::Sine;
use nalgebra::{Point2, Vector2};
use planner_core::error::ObservationError;
use planner_core::planner::Stage;
use planner_core::{
    Belief as _, Deviation, Goal, Label, Line, Plan, Planner, Pose, PosteriorView, Sample,
    StopReason, Tolerance, Unicycle, VersionSpace,
};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

/// Motions of a mission at most.
const MOTIONS: u32 = 600;

/// The middle of the standard area, and how far a place of the area is from it at most, metres.
const MIDDLE: Point2<f64> = Point2::new(10.0, 10.0);
const RADIUS: f64 = 14.15;

/// How a boundary bends, all within its bend.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// As an arc of a circle, about so many metres along the line.
    Arc(f64),
    /// As a sine of this length and phase.
    Sine(f64, f64),
    /// By chance, at each label anew.
    Rough,
}

/// How much of its drift a boundary has moved.
#[derive(Clone, Copy, Debug)]
enum Path {
    /// Steadily, all of it after so many motions.
    Steady(f64),
    /// To and fro, once in so many motions.
    ToAndFro(f64),
    /// At once after so many motions.
    Jump(f64),
}

/// A boundary about a line that bends, moves and turns a little.
#[derive(Clone, Copy, Debug)]
struct Boundary {
    line: Line,
    deviation: Deviation,
    shape: Shape,
    path: Path,
    /// The share of the drift that moves it along its normal. The rest turns it about the middle.
    moves: f64,
}

impl Boundary {
    fn draw(line: Line, deviation: Deviation, rng: &mut ChaCha8Rng) -> Self {
        let shape = match rng.random_range(0..3) {
            0 => Shape::Arc(rng.random_range(-10.0..10.0)),
            1 => Shape::Sine(rng.random_range(2.0..60.0), rng.random_range(0.0..6.3)),
            _ => Shape::Rough,
        };
        let motions = rng.random_range(5.0..50.0);
        let path = match rng.random_range(0..3) {
            0 => Path::Steady(motions),
            1 => Path::ToAndFro(motions),
            _ => Path::Jump(motions),
        };
        let moves = [1.0, 0.0, rng.random_range(0.0..1.0)][rng.random_range(0..3)];
        Self { line, deviation, shape, path, moves }
    }

    /// A place's distance along the line from the place nearest to the middle.
    fn along(&self, at: Point2<f64>) -> f64 {
        let [a, b, _] = self.line.coefficients();
        (at - MIDDLE).dot(&Vector2::new(b, -a))
    }

    /// How far its straight line has moved there after so many motions.
    fn moved(&self, along: f64, motions: u32) -> f64 {
        let motions = f64::from(motions);
        let share = match self.path {
            Path::Steady(all) => (motions / all).min(1.0),
            Path::ToAndFro(all) => 0.5 - 0.5 * (motions * std::f64::consts::TAU / all).cos(),
            Path::Jump(at) => f64::from(u8::from(motions >= at)),
        };
        self.deviation.drift_m * share * (self.moves + (1.0 - self.moves) * along / RADIUS)
    }

    /// Its straight line after so many motions.
    fn line(&self, motions: u32) -> Line {
        let [a, b, _] = self.line.coefficients();
        let foot = MIDDLE - Vector2::new(a, b) * self.line.distance(MIDDLE);
        let (normal, way) = (Vector2::new(a, b), Vector2::new(b, -a));
        let lean = self.moved(1.0, motions) - self.moved(0.0, motions);
        let through = foot + normal * self.moved(0.0, motions);
        Line::through(through, normal - way * lean).expect("a normal")
    }

    /// The label of a place after so many motions.
    fn label(&self, at: Point2<f64>, motions: u32, rng: &mut ChaCha8Rng) -> Label {
        let (along, bend) = (self.along(at), self.deviation.bend_m);
        let bent = match self.shape {
            Shape::Arc(middle) => {
                let reach = RADIUS + middle.abs();
                let rise = |along: f64| {
                    let radius = (reach * reach + 4.0 * bend * bend) / (4.0 * bend);
                    radius - (radius * radius - along * along).sqrt()
                };
                if bend > 0.0 { rise(along - middle) - bend } else { 0.0 }
            }
            Shape::Sine(length, phase) => {
                bend * (along * std::f64::consts::TAU / length + phase).sin()
            }
            Shape::Rough => bend * rng.random_range(-1.0..1.0),
        };
        let is_above = self.line.distance(at) > self.moved(along, motions) + bent;
        if is_above { Label::Positive } else { Label::Negative }
    }
}

/// How a mission ended, beside what is true then.
#[derive(Debug)]
struct Flown {
    is_refuted: bool,
    is_known: bool,
    /// The lines of the start, of each motion and of the end that are not among the lines left.
    cut_off: usize,
    /// The slopes left, degrees.
    arc: f64,
    /// The angle between the centre and the line at the end, degrees, and the share of the area between them.
    off: Option<[f64; 2]>,
}

fn unit(rng: &mut ChaCha8Rng) -> Vector2<f64> {
    let turn = rng.random_range(0.0..std::f64::consts::TAU);
    Vector2::new(turn.cos(), turn.sin())
}

/// Whether a line agrees with all samples as they were inserted.
fn is_among(space: &VersionSpace<CAPACITY>, line: &Line) -> bool {
    let agrees =
        |at: Point2<f64>, label: Label| f64::from(label.sign()) * line.distance(at) > -1e-6;
    space.samples().iter().all(|it| agrees(it.site.into(), it.label))
}

/// Flies until it ends. `degrees`: the goal of slopes.
fn fly(
    planner: impl Planner<Belief = VersionSpace<CAPACITY>>,
    mission: &Mission,
    boundary: &Boundary,
    rng: &mut ChaCha8Rng,
) -> Flown {
    let mut planner = planner;
    let Deviation { position_m, lag_m, .. } = boundary.deviation;
    let (mut pose, mut motions): (Pose, u32) = (mission.start, 0);
    let mut flown = Flown { is_refuted: false, is_known: false, cut_off: 0, arc: 0.0, off: None };
    while motions < MOTIONS {
        // After 64 labels it is over: further ones would make room for themselves.
        let is_full = planner.belief().samples().len() == CAPACITY;
        let step = match planner.plan(pose) {
            Plan::Move(step) if is_full && step.stage != Some(Stage::Audit) => break,
            Plan::Move(step) => step,
            Plan::Stop(reason) => {
                flown.is_known = reason == StopReason::Known;
                flown.is_refuted = reason == StopReason::NoLine;
                break;
            }
        };
        let [from, to] = [pose.site, step.target.site].map(Point2::<f64>::from);
        (pose, motions) = (step.target, motions + 1);
        // The label is that of a place that the robot passed before, and its position is off.
        let length = (to - from).norm();
        let late =
            if length > 0.0 { (to - from) / length * lag_m.min(length) } else { Vector2::zeros() };
        let off = unit(rng) * (position_m * rng.random_range(0.0..1.0_f64).sqrt());
        let reading =
            step.wants_label.then(|| boundary.label(to - late + off, motions, rng).into());
        match planner.observe(pose, reading) {
            Ok(()) => {}
            Err(ObservationError::Contradiction(_)) => {
                flown.is_refuted = true;
                break;
            }
            Err(ObservationError::Full(_)) => break,
            Err(other) => panic!("{other}"),
        }
    }
    let space = planner.belief();
    let times = (0..=motions).map(|motions| boundary.line(motions));
    flown.cut_off = times.filter(|line| !is_among(space, line)).count();
    flown.arc = space.slope_arc().width_deg();
    let end = boundary.line(motions);
    flown.off = space.centre().map(Line::from).map(|centre| {
        [centre.angle_to_deg(&end), misclassified(mission.config.area, &end, &centre)]
    });
    flown
}

/// Who plans.
const PLANNERS: [&str; 2] = ["Algorithm 1", "look-ahead with a goal"];

/// The mission in a standard field whose boundary deviates so, by a planner that is told `told`; `None` if the field's
/// given samples are too near to the line for that.
fn mission(
    number: u64,
    planner: &str,
    draw: &dyn Fn(Line, &mut ChaCha8Rng) -> Boundary,
    told: Deviation,
    degrees: f64,
) -> Option<Flown> {
    let algorithm = if planner == PLANNERS[0] { Algorithm::Cfc } else { Algorithm::Lookahead };
    let mut mission = standard_field::standard(43, number, algorithm, 1);
    let mut rng = ChaCha8Rng::seed_from_u64(44);
    rng.set_stream(number);
    let boundary = draw(*mission.world.line()?, &mut rng);
    let Deviation { bend_m, drift_m, .. } = boundary.deviation;
    let places = || mission.given.samples().iter().map(|it| Point2::<f64>::from(it.site));
    if places().any(|at| boundary.line.distance(at).abs() <= bend_m + drift_m) {
        return None;
    }
    mission.config.tolerance = told.tolerance().expect("a distance");
    mission.given.lines()?.clone().with_tolerance(mission.config.tolerance).ok()?;
    let (area, fan) = (mission.config.area, Unicycle::from(algorithm.grid()));
    Some(if planner == PLANNERS[0] {
        fly(mission.cfc(area, fan), &mission, &boundary, &mut rng)
    } else {
        let goal = Goal::slope_within_degrees(degrees).expect("an angle");
        fly(mission.lookahead(area, fan).until(goal), &mission, &boundary, &mut rng)
    })
}

/// A part of a deviation: none, or up to so many metres.
fn part(rng: &mut ChaCha8Rng, most: f64) -> f64 {
    if rng.random_range(0..3) == 0 { 0.0 } else { rng.random_range(0.0..most) }
}

#[test]
fn what_is_allowed_for_refutes_no_line_and_cuts_off_none() {
    let fly = |planner: &str, told: &(dyn Fn(Deviation) -> Deviation + Sync)| {
        let fly = |number: u64| {
            let mut rng = ChaCha8Rng::seed_from_u64(45);
            rng.set_stream(number);
            let deviation = Deviation {
                position_m: part(&mut rng, 0.2),
                lag_m: part(&mut rng, 0.2),
                bend_m: part(&mut rng, 0.6),
                drift_m: part(&mut rng, 0.6),
            };
            let degrees = rng.random_range(2.0..30.0);
            let draw = |line, rng: &mut ChaCha8Rng| Boundary::draw(line, deviation, rng);
            let flown = mission(number, planner, &draw, told(deviation), degrees)?;
            Some((number, degrees, flown))
        };
        (0..cases(150, 6_000)).into_par_iter().filter_map(fly).collect::<Vec<_>>()
    };
    for planner in PLANNERS {
        let flown = fly(planner, &|it| it);
        for (number, degrees, flown) in &flown {
            assert!(!flown.is_refuted && flown.cut_off == 0, "{planner}, {number}: {flown:?}");
            let is_near = flown.off.is_some_and(|[angle, _]| angle <= *degrees);
            assert!(!flown.is_known || is_near, "{planner}, {number}: {degrees} deg, {flown:?}");
        }
        let known = flown.iter().filter(|it| it.2.is_known).count();
        assert!(flown.len() as u64 * 2 > cases(150, 6_000), "{} fields", flown.len());
        // With half of it, some are: the claim is not empty.
        let half = |it: Deviation| Deviation {
            position_m: it.position_m / 2.0,
            lag_m: it.lag_m / 2.0,
            bend_m: it.bend_m / 2.0,
            drift_m: it.drift_m / 2.0,
        };
        let halves = fly(planner, &half);
        let [refuted, cut] = [
            halves.iter().filter(|it| it.2.is_refuted).count(),
            halves.iter().filter(|it| it.2.cut_off > 0).count(),
        ];
        println!(
            "{planner}: none of {} refuted, {known} known; with half of the tolerance {refuted} refuted, {cut} with a \
             line cut off",
            flown.len()
        );
        assert!(cut * 10 > halves.len());
    }
}

/// The examples of docs/which-tolerance.md.
#[test]
fn examples_of_tolerances() {
    type Draw = fn(Line, &mut ChaCha8Rng) -> Boundary;
    let arc: Draw = |line, _| Boundary {
        line,
        deviation: Deviation { bend_m: 0.25, ..Deviation::NONE },
        shape: Shape::Arc(0.0),
        path: Path::Steady(1.0),
        moves: 1.0,
    };
    let sine: Draw = |line, rng| Boundary {
        shape: Shape::Sine(20.0, rng.random_range(0.0..6.3)),
        ..Boundary::draw(line, Deviation { bend_m: 0.25, ..Deviation::NONE }, rng)
    };
    let drift: Draw = |line, rng| Boundary {
        path: Path::Steady(20.0),
        moves: 1.0,
        ..Boundary::draw(line, Deviation { drift_m: 0.5, ..Deviation::NONE }, rng)
    };
    let both: Draw = |line, rng| Boundary {
        shape: Shape::Sine(20.0, rng.random_range(0.0..6.3)),
        path: Path::Steady(20.0),
        moves: 1.0,
        ..Boundary::draw(line, Deviation { bend_m: 0.25, drift_m: 0.5, ..Deviation::NONE }, rng)
    };
    let straight: Draw = |line, rng| Boundary::draw(line, Deviation::NONE, rng);
    println!(
        "refuted, line cut off, known, %; median and 90th percentile of slope error, deg, and of misclassified, %; \
 median arc left, deg"
    );
    for (name, draw, needs, goal) in [
        ("straight", straight, 0.0, 0.5),
        ("an arc, bend 0.25 m", arc, 0.25, 6.0),
        ("a sine, bend 0.25 m", sine, 0.25, 6.0),
        ("a drift of 0.5 m", drift, 0.5, 10.0),
        ("bend 0.25 m, drift 0.5 m", both, 0.75, 15.0),
    ] {
        let shares: &[f64] = if needs > 0.0 { &[0.0, 0.5, 1.0, 2.0] } else { &[0.0] };
        for share in shares {
            let told = Deviation { bend_m: share * needs, ..Deviation::NONE };
            let fly = |number| mission(number, PLANNERS[1], &draw, told, goal);
            let flown: Vec<_> = (0..cases(60, 600)).into_par_iter().filter_map(fly).collect();
            report(name, told.bend_m, &flown);
            let is_right = |it: &Flown| !it.is_refuted && it.cut_off == 0;
            assert!(*share < 1.0 || flown.iter().all(is_right), "{name}");
        }
    }
    for tolerance in [0.0, 0.05, 0.1, 0.25, 0.5, 1.0] {
        let told = Deviation { position_m: tolerance, ..Deviation::NONE };
        let fly = |number| mission(number, PLANNERS[1], &straight, told, 0.01);
        let flown: Vec<_> = (0..cases(60, 600)).into_par_iter().filter_map(fly).collect();
        report("straight, no goal in reach", tolerance, &flown);
    }
}

fn report(name: &str, tolerance: f64, flown: &[Flown]) {
    let percent = |of: &dyn Fn(&Flown) -> bool| {
        100.0 * flown.iter().filter(|it| of(it)).count() as f64 / flown.len() as f64
    };
    let quantiles = |which: usize, scale: f64| {
        let mut all: Vec<_> = flown.iter().filter_map(|it| it.off).map(|it| it[which]).collect();
        all.sort_by(f64::total_cmp);
        [5, 9].map(|tenths| scale * all[all.len() * tenths / 10])
    };
    let mut arcs: Vec<_> = flown.iter().map(|it| it.arc).collect();
    arcs.sort_by(f64::total_cmp);
    let arc = arcs[arcs.len() / 2];
    let ([angle, angle_90], [area, area_90]) = (quantiles(0, 1.0), quantiles(1, 100.0));
    println!(
        "{name:<28} {tolerance:>5.3} m: {:>5.1} {:>5.1} {:>5.1}   {angle:>5.2} {angle_90:>5.2}   {area:>5.2} {area_90:>5.2}   {arc:>5.2} \
         ({} fields)",
        percent(&|it| it.is_refuted),
        percent(&|it| it.cut_off > 0),
        percent(&|it| it.is_known),
        flown.len(),
    );
}

/// Where labels may be wrong, a tolerance excludes nothing: how often the 90 % set has the line that the boundary bends
/// about, and its slope, by the tolerance that is told.
#[test]
fn a_bend_where_labels_may_be_wrong() {
    let bend = 0.25;
    for (name, height) in [("straight", 0.0), ("a sine, bend 0.25 m", bend)] {
        for share in [0.0, 1.0, 3.0] {
            let held = |number| {
                let mut mission = standard_field::standard(46, number, Algorithm::Lookahead, 30);
                let line = *mission.world.line()?;
                let mut rng = ChaCha8Rng::seed_from_u64(47);
                rng.set_stream(number);
                let phase = rng.random_range(0.0..6.3);
                let sine = Sine { base: line, height, length: 20.0, phase };
                let near = |it: &Sample| line.distance(it.site.into()).abs() <= bend;
                if mission.given.samples().iter().any(near) {
                    return None;
                }
                let area = mission.config.area.into();
                mission.world = World::divided_by_curve(Box::new(sine), &area);
                mission.noise = Some(NoiseModel { p: 0.9, extent: Extent::OutsideBalls(0.0) });
                mission.config.tolerance = Tolerance::new(share * bend).expect("a distance");
                let flown = mission.fly(|_, _| {}).expect("doubtful labels are never refused");
                let table = flown.belief.hypotheses().expect("labels may be wrong");
                let posterior = PosteriorView::new(table);
                let credible = posterior.credible(LEVEL);
                let agrees =
                    |s: Sample| f64::from(s.label.sign()) * line.distance(s.site.into()) > 0.0;
                let holds =
                    posterior.members(&credible).any(|it| table.lines(it).support().all(agrees));
                let centre = Line::from(flown.belief.centre()?);
                let mut arcs = credible.slope_arc.intervals_deg().into_iter();
                let has_slope = arcs.any(|[from, to]| (from..=to).contains(&line.angle_deg()));
                Some((holds, centre.angle_to_deg(&line), credible.probability, has_slope))
            };
            let all: Vec<_> = (0..cases(24, 240)).into_par_iter().filter_map(held).collect();
            let count = all.iter().filter(|it| it.0).count();
            let mut angles: Vec<_> = all.iter().map(|it| it.1).collect();
            angles.sort_by(f64::total_cmp);
            let percent = 100.0 * count as f64 / all.len() as f64;
            let slopes = 100.0 * all.iter().filter(|it| it.3).count() as f64 / all.len() as f64;
            let stated = 100.0 * all.iter().map(|it| it.2).sum::<f64>() / all.len() as f64;
            println!(
                "{name}, told {:.3} m: the 90 % set has the line in {percent:.0} %, its slope in {slopes:.0} % \
                 ({stated:.0} % stated); slope error {:.2} deg, of {} fields",
                share * bend,
                angles[angles.len() / 2],
                all.len()
            );
            // A bend that nobody was told of is not covered; what is told is, with room.
            let is_enough = height == 0.0 || share >= 1.0;
            assert!(!is_enough || slopes >= 80.0, "{name}, {share}: {slopes} %");
        }
    }
}
