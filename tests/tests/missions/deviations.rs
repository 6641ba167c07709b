//! Boundaries that bend and move within what the planner allows for, read late by a robot whose positions err: no label is
//! ever refused, no audit fails, and the line of each time is among the lines left. That is a theorem
//! (`planner-core/src/belief/deviation.rs`), so each of these missions is a proof against it.

use std::f64::consts::TAU;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::CAPACITY;
use nalgebra::{Point2, Vector2};
use planner_core::error::ObservationError;
use planner_core::{
    Belief as _, Deviation, Goal, Label, Line, Plan, Planner, Stage, StopReason, Unicycle,
    VersionSpace,
};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::ensemble::{self, expect, percent};

/// Motions of a mission at most.
const MOTIONS: u32 = 600;

/// The middle of the standard area, and how far a place of the area is from it at most, metres.
const MIDDLE: Point2<f64> = Point2::new(10.0, 10.0);
const RADIUS: f64 = 14.15;

/// How far a boundary bends beside its line at a place so far along that, within its bend.
type Shape = Box<dyn Fn(f64, &mut ChaCha8Rng) -> f64>;

/// How much of its drift a boundary has moved after so many motions.
type Path = Box<dyn Fn(f64) -> f64>;

/// A boundary about a line that bends, moves and turns a little.
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
        let bend = deviation.bend_m;
        let shape: Shape = match rng.random_range(0..3) {
            // An arc of a circle.
            0 if bend > 0.0 => {
                let middle = rng.random_range(-10.0..10.0_f64);
                let reach = RADIUS + middle.abs();
                let radius = (reach * reach + 4.0 * bend * bend) / (4.0 * bend);
                Box::new(move |along, _| {
                    radius - (radius * radius - (along - middle).powi(2)).sqrt() - bend
                })
            }
            1 => {
                let (length, phase) = (rng.random_range(2.0..60.0), rng.random_range(0.0..TAU));
                Box::new(move |along, _| bend * (along * TAU / length + phase).sin())
            }
            // By chance, at each label anew.
            _ => Box::new(move |_, rng| bend * rng.random_range(-1.0..1.0)),
        };
        let all = rng.random_range(5.0..50.0);
        let path: Path = match rng.random_range(0..3) {
            0 => Box::new(move |motions| (motions / all).min(1.0)),
            1 => Box::new(move |motions| 0.5 - 0.5 * (motions * TAU / all).cos()),
            _ => Box::new(move |motions| f64::from(u8::from(motions >= all))),
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
        let share = (self.path)(motions.into());
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
        let along = self.along(at);
        let bent = (self.shape)(along, rng);
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
    let turn = rng.random_range(0.0..TAU);
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

#[test]
fn what_is_allowed_for_refutes_no_line_and_cuts_off_none() {
    let fields = cases(100, 6_000);
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        let fly = |share: f64| {
            ensemble::fly_some(fields, |number| {
                let rng = &mut ensemble::rng(45, number);
                // A third of the parts are none.
                let mut part = |most: f64| (most * rng.random_range(-0.5..1.0)).max(0.0);
                let parts = [0.2, 0.2, 0.6, 0.6].map(&mut part);
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
