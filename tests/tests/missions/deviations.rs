//! Boundaries that bend and move within what the planner allows for, read late by a robot whose positions err: no label is
//! ever refused, no audit fails, and the line of each time is among the lines left. That is a theorem
//! (`planner-core/src/belief/deviation.rs`), so each of these missions is a proof against it.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::CAPACITY;
use host_sim::mission::read_out::LEVEL;
use host_sim::world::World;
use host_sim::world::sine::Sine;
use nalgebra::{Point2, Vector2};
use planner_core::error::ObservationError;
use planner_core::planner::Stage;
use planner_core::{
    Belief as _, Deviation, Goal, Label, Line, Plan, Planner, PosteriorView, StopReason, Tolerance,
    Unicycle, VersionSpace,
};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::ensemble::{self, expect, noisy, percent};

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
    /// The angle between the centre and the line at the end, degrees.
    off: Option<f64>,
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

/// Flies until it ends.
fn fly(
    mut planner: impl Planner<Belief = VersionSpace<CAPACITY>>,
    mission: &Mission,
    boundary: &Boundary,
    rng: &mut ChaCha8Rng,
) -> Flown {
    let Deviation { position_m, lag_m, .. } = boundary.deviation;
    let (mut pose, mut motions) = (mission.start, 0);
    let (mut is_refuted, mut is_known) = (false, false);
    while motions < MOTIONS {
        // After 64 labels it is over: further ones would make room for themselves.
        let is_full = planner.belief().samples().len() == CAPACITY;
        let step = match planner.plan(pose) {
            Plan::Move(step) if is_full && step.stage != Some(Stage::Audit) => break,
            Plan::Move(step) => step,
            Plan::Stop(reason) => {
                is_known = reason == StopReason::Known;
                is_refuted = reason == StopReason::NoLine;
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
                is_refuted = true;
                break;
            }
            Err(ObservationError::Full(_)) => break,
            Err(other) => panic!("{other}"),
        }
    }
    let space = planner.belief();
    let times = (0..=motions).map(|motions| boundary.line(motions));
    let cut_off = times.filter(|line| !is_among(space, line)).count();
    let off = space.centre().map(|it| Line::from(it).angle_to_deg(&boundary.line(motions)));
    Flown { is_refuted, is_known, cut_off, off }
}

/// The mission in a standard field whose boundary deviates so, by a planner that is told `told`; `None` if the field's
/// given samples are too near to the line for that.
fn mission(
    number: u64,
    algorithm: Algorithm,
    deviation: Deviation,
    told: Deviation,
    degrees: f64,
) -> Option<Flown> {
    let mut mission = standard_field::standard(43, number, algorithm, 1);
    let mut rng = ensemble::rng(44, number);
    let boundary = Boundary::draw(*mission.world.line()?, deviation, &mut rng);
    let mut places = mission.given.samples().iter().map(|it| Point2::<f64>::from(it.site));
    let near = deviation.bend_m + deviation.drift_m;
    if places.any(|at| boundary.line.distance(at).abs() <= near) {
        return None;
    }
    mission.config.tolerance = told.tolerance().expect("a distance");
    mission.given.lines()?.clone().with_tolerance(mission.config.tolerance).ok()?;
    let (area, fan) = (mission.config.area, Unicycle::from(algorithm.grid()));
    Some(if algorithm == Algorithm::Cfc {
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
    let fields = cases(100, 6_000);
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        let fly = |share: f64| {
            ensemble::fly_some(fields, |number| {
                let rng = &mut ensemble::rng(45, number);
                let parts = [0.2, 0.2, 0.6, 0.6].map(|most| part(rng, most));
                let deviation = |share: f64| {
                    let [position_m, lag_m, bend_m, drift_m] = parts.map(|part| share * part);
                    Deviation { position_m, lag_m, bend_m, drift_m }
                };
                let degrees = rng.random_range(2.0..30.0);
                let told = deviation(share);
                let flown = mission(number, algorithm, deviation(1.0), told, degrees)?;
                Some((number, degrees, flown))
            })
        };
        let flown = fly(1.0);
        for (number, degrees, flown) in &flown {
            assert!(!flown.is_refuted && flown.cut_off == 0, "{algorithm:?}, {number}: {flown:?}");
            let is_near = flown.off.is_some_and(|angle| angle <= *degrees);
            assert!(!flown.is_known || is_near, "{algorithm:?}, {number}: {degrees}, {flown:?}");
        }
        assert!(flown.len() as u64 * 2 > fields, "{} fields", flown.len());
        // With half of it, some are: the claim is not empty.
        let cut = percent(&fly(0.5), |it| it.2.cut_off > 0);
        expect(format!("{algorithm:?}: cut off by half of the tolerance"), cut, 10.0..);
    }
}

/// Where labels may be wrong, a tolerance excludes nothing: how often the 90 % set has the slope of the line that the
/// boundary bends about, if at least the bend is told.
#[test]
fn a_bend_where_labels_may_be_wrong() {
    let bend = 0.25;
    for (height, told) in [(0.0, 0.0), (0.0, bend), (bend, bend), (bend, 3.0 * bend)] {
        let held = ensemble::fly_some(cases(24, 240), |number| {
            let mission = standard_field::standard(46, number, Algorithm::Lookahead, 30);
            let mut mission = noisy(mission, 0.9, 0.0);
            let base = *mission.world.line()?;
            let phase = ensemble::rng(47, number).random_range(0.0..6.3);
            let mut given = mission.given.samples().iter();
            if given.any(|it| base.distance(it.site.into()).abs() <= bend) {
                return None;
            }
            let sine = Sine { base, height, length: 20.0, phase };
            let area = mission.config.area.into();
            mission.world = World::divided_by_curve(Box::new(sine), &area);
            mission.config.tolerance = Tolerance::new(told).expect("a distance");
            let flown = mission.fly(|_, _| {}).expect("doubtful labels are never refused");
            let posterior = PosteriorView::new(flown.belief.hypotheses().expect("a table"));
            let mut arcs = posterior.credible(LEVEL).slope_arc.intervals_deg().into_iter();
            Some(arcs.any(|[from, to]| (from..=to).contains(&base.angle_deg())))
        });
        let what = format!("slopes of a sine of {height} m, told {told} m");
        expect(what, percent(&held, |it| *it), 80.0..);
    }
}
