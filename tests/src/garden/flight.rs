//! Flies a planner through a garden by its public interface, and records what a porter would look at.

use planner_core::robot::AgentError;
use planner_core::{
    Agent, CellPosterior, DrivingPrice, Event, Goal, Line, Lookahead, Motion, Noise, NoisyBelief,
    Planner, Pose, Prior, Reliability, Scc, SlopeWithin, StopReason, Tolerance, Workspace as _,
};

use super::lawn::Garden;
use super::rover::Rover;
use crate::anything::plain::{Point, metres};

/// Samples that a planner holds: 60 labels beside the four given ones.
const SAMPLES: usize = 64;

/// All hypotheses of 60 labels.
const HYPOTHESES: usize = 1_831;

/// Motions of a mission at most.
const MOTIONS: u32 = 200;

/// Labels after which estimates are compared.
pub const COMPARED: u32 = 30;

/// Who finds the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finder {
    /// Look-ahead with a noisy belief.
    Lookahead,
    /// Algorithm 2.
    Scc,
    /// Bisected chords between the given places.
    Chords,
    /// The lawn's edge, bisected where it changes its label.
    Edge,
}

/// How a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Ended {
    /// The goal is met.
    Known,
    /// The audit says that no line explains its labels.
    NoLine,
    /// All labels are taken that there is room for.
    Full,
    /// The planner found no way on, and said so.
    NoWay,
    /// It lies outside and finds no way back.
    Outside,
    /// The labels of a method by hand are taken.
    Labels,
    /// It did not end by itself.
    NotItself,
    /// The planner refused a label.
    Refused,
}

/// What became of a mission.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub ended: Ended,
    /// What the planner said in the end, and where; or the last motion that undid another.
    pub last_word: String,
    /// Labels taken.
    pub labels: u32,
    /// Motions made.
    pub motions: u32,
    /// Metres driven for the labels that are compared.
    pub driven: f64,
    /// The angle between the estimate and the true line after [`COMPARED`] labels or at the end, degrees. A quarter
    /// turn where there is no estimate.
    pub slope_error: f64,
    /// The same at the mission's end.
    pub last_error: f64,
    /// The most motions in a row without a label.
    pub fruitless: u32,
    /// Motions without a label that undid the one before.
    pub undone: u32,
    /// The least distance from tree, corner and border, and where.
    pub nearest: (f64, Point),
    /// The largest error of a position.
    pub most_off: f64,
    /// The standard deviation of positions at which labels were read, an axis.
    pub deviation: f64,
}

impl Outcome {
    pub(super) const NONE: Self = Self {
        ended: Ended::NotItself,
        last_word: String::new(),
        labels: 0,
        motions: 0,
        driven: 0.0,
        slope_error: 90.0,
        last_error: 90.0,
        fruitless: 0,
        undone: 0,
        nearest: (f64::INFINITY, [0.0; 2]),
        most_off: 0.0,
        deviation: 0.0,
    };

    /// Whether the rover touched what it must not.
    pub fn is_bump(&self) -> bool {
        self.nearest.0 < 0.0
    }

    pub(super) fn compare(&mut self, rover: &Rover<'_>, estimate: Option<Line>, truth: &Line) {
        self.driven = rover.driven;
        self.slope_error = estimate.map_or(90.0, |line| line.angle_to_deg(truth));
    }

    pub(super) fn close(mut self, rover: &Rover<'_>) -> Self {
        (self.nearest, self.most_off) = (rover.nearest, rover.most_off);
        self.deviation = rover.deviation();
        self
    }
}

/// A planner's mission.
///
/// # Panics
/// When a planner refuses its settings.
pub fn fly(garden: &Garden, finder: Finder) -> Outcome {
    let noise = Noise {
        reliability: Reliability::new(garden.setting.p).expect("a probability"),
        trusted_radius: 0,
        tolerance: Tolerance::new(garden.setting.blur).expect("a tolerance"),
    };
    let area = garden.lawn.with_clearance(garden.setting.largest_error()).expect("a narrow margin");
    if finder == Finder::Scc {
        let table = CellPosterior::<SAMPLES, HYPOTHESES>::new(&garden.given, Prior::Area, noise);
        let dynamics = garden.setting.dynamics(10_000);
        let planner = Scc::new(area, dynamics, table.expect("four places"));
        return with(garden, planner.expect("settings that agree"));
    }
    let belief = NoisyBelief::<SAMPLES, HYPOTHESES>::new(&garden.given, noise);
    let planner = Lookahead::new(area, garden.setting.dynamics(1), belief.expect("four places"));
    let price = DrivingPrice::new(garden.setting.varrho).expect("a price");
    with(garden, planner.expect("settings that agree").pricing(price).until(goal()))
}

/// One degree in nine of ten cases.
fn goal() -> Goal<SlopeWithin> {
    Goal::slope_within_degrees(1.0).expect("acute")
}

fn with<P: Planner>(garden: &Garden, planner: P) -> Outcome {
    let mut agent = Agent::new(planner, Rover::new(garden), garden.start);
    let mut outcome = Outcome::NONE;
    let (mut fruitless, mut before) = (0, None::<(Pose, Motion)>);
    while outcome.motions < MOTIONS {
        let from = agent.pose();
        let step = match agent.step() {
            Ok(Event::Step(step)) => step,
            Ok(Event::Stopped(reason)) => {
                outcome.ended = ended(reason);
                outcome.last_word = format!("{reason:?} at {from:?}");
                break;
            }
            Err(AgentError::Observation(refused)) => {
                outcome.ended = Ended::Refused;
                outcome.last_word = format!("{refused} at {from:?}");
                break;
            }
        };
        outcome.motions += 1;
        fruitless += 1;
        if let Some((start, last)) = before
            && !last.wants_label
            && !step.motion.wants_label
            && is_same(start, step.motion.target)
        {
            outcome.undone += 1;
            outcome.last_word =
                format!("undone: {:?} to {:?}", step.motion.recovery, step.motion.target);
        }
        before = Some((from, step.motion));
        outcome.fruitless = outcome.fruitless.max(fruitless);
        if step.reading.is_some() {
            (fruitless, outcome.labels) = (0, outcome.labels + 1);
            if outcome.labels <= COMPARED {
                let centre = agent.planner.estimates().centre.map(Line::from);
                outcome.compare(agent.body(), centre, &garden.line);
            }
        }
    }
    let centre = agent.planner.estimates().centre.map(Line::from);
    outcome.last_error = centre.map_or(90.0, |line| line.angle_to_deg(&garden.line));
    outcome.close(agent.body())
}

const fn ended(reason: StopReason) -> Ended {
    match reason {
        StopReason::Known => Ended::Known,
        StopReason::NoLine => Ended::NoLine,
        StopReason::SamplesFull => Ended::Full,
        StopReason::OutsideArea => Ended::Outside,
        _ => Ended::NoWay,
    }
}

/// Whether two poses are the same, to 2 cm and a tenth of a degree.
fn is_same(a: Pose, b: Pose) -> bool {
    let [p, q] = [a.site, b.site].map(metres);
    let turned = (a.heading.0.wrapping_sub(b.heading.0) as i32).unsigned_abs();
    (p[0] - q[0]).hypot(p[1] - q[1]) < 0.02 && turned < 1 << 20
}
