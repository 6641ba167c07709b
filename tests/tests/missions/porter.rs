//! A robot of a porter's own, by the public interface: its drives fail, and its positions err.

use std::cell::Cell;
use std::convert::Infallible;
use std::f64::consts::TAU;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::world::World;
use nalgebra::{Point2, Vector2};
use planner_core::robot::{AgentError, Body, DriveFn, SensorFn, VehicleError};
use planner_core::{
    Agent, Belief as _, Event, Goal, KeepOut, Line, Lookahead, Motion, Noise, NoisyBelief, Planner,
    PolygonArea, Pose, Reading, Site, StopReason, Unicycle, Vector, Vehicle, Workspace as _,
    sequences_of,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::ensemble;

/// It got stuck.
#[derive(Debug)]
struct Stuck;

/// Flies until a planner has its labels; how many drives failed, and how often it was outside then. Every third drive or
/// so ends on the way, or a metre beside it.
fn fly_failing(number: u64, planner: impl Planner) -> [u32; 2] {
    let mission = standard_field::standard(8, number, Algorithm::Cfc, 20);
    let place = Cell::new(mission.start);
    let mut rng = ChaCha8Rng::seed_from_u64(number);
    let drive = |motion: &Motion| {
        let (from, way) = (place.get(), motion.target.site - place.get().site);
        place.set(motion.target);
        if rng.random_range(0..3) > 0 {
            return Ok(motion.target);
        }
        let mut aside = || rng.random_range(-1 << 16..1 << 16);
        let by = [way.x() / 2 + aside(), way.z() / 2 + aside()];
        let by = Vector::new(by[0], by[1]).expect("short");
        place.set(Pose { site: from.site.step(by).expect("near"), ..motion.target });
        Err(Stuck)
    };
    let sense = || Ok::<_, Infallible>(mission.world.reading(place.get().site));
    let vehicle = Vehicle { drive: DriveFn(drive), sensor: SensorFn(sense) };
    let mut agent = Agent::new(planner, vehicle, mission.start);
    let (mut labels, mut failed, mut outside) = (0, 0, 0);
    while labels < 20 {
        match agent.step() {
            Ok(Event::Step(step)) => labels += u32::from(step.reading.is_some()),
            Err(AgentError::Body(VehicleError::Drive(Stuck))) => {
                failed += 1;
                outside += u32::from(!mission.config.area.contains(place.get().site));
                agent.relocate(place.get());
            }
            other => panic!("field {number}: {other:?}"),
        }
        assert!(failed < 200, "field {number}: no end");
    }
    let centre = agent.planner.belief().estimates().centre.expect("a line");
    let truth = mission.world.line().expect("a line");
    assert!(Line::from(centre).angle_to_deg(truth) < 15.0, "field {number}");
    [failed, outside]
}

#[test]
fn missions_go_on_from_where_a_drive_has_failed() {
    let mut sum = [0, 0];
    for number in 0..150 {
        let mission = standard_field::standard(8, number, Algorithm::Cfc, 20);
        let (area, unicycle) = (mission.config.area, Unicycle::paper());
        let by_cfc = fly_failing(number, mission.cfc(area, unicycle));
        let by_lookahead = fly_failing(number, mission.lookahead(area, unicycle));
        sum = [0, 1].map(|k| sum[k] + by_cfc[k] + by_lookahead[k]);
    }
    let [failed, outside] = sum;
    assert!(failed > 2_000 && outside > 50, "{failed}, {outside} of them outside");
}

/// The most that the rover's position is off, metres.
const MOST_OFF: f64 = 0.25;

/// A rover that believes to be within [`MOST_OFF`] of where it truly is. It drives straight between true places.
struct Rover {
    world: World,
    lawn: PolygonArea<4, 3>,
    truth: Point2<f64>,
    rng: ChaCha8Rng,
}

impl Body for Rover {
    type Error = Infallible;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Infallible> {
        let target = Point2::<f64>::from(motion.target.site);
        let (sin, cos) = libm::sincos(self.rng.random_range(0.0..TAU));
        let off = self.rng.random_range(0.0..MOST_OFF - 1e-3);
        let from = std::mem::replace(&mut self.truth, target + Vector2::new(cos, sin) * off);
        for part in 0..=100 {
            let place = from + (self.truth - from) * (f64::from(part) / 100.0);
            let place = Site::try_from(place).expect("near");
            assert!(self.lawn.contains(place), "it touches a tree or the border at {place:?}");
        }
        *pose = motion.target;
        let reading = self.world.reading(Site::try_from(self.truth).expect("near"));
        let is_wrong = self.rng.random_bool(0.03);
        Ok(motion.wants_label.then(|| match reading {
            Reading::Side(label) if is_wrong => Reading::Side(-label),
            reading => reading,
        }))
    }
}

/// In a lawn with trees, whose clearance is the largest error of a position, every mission ends by itself, and the rover
/// touches nothing.
#[test]
fn a_rover_that_errs_within_the_clearance_touches_nothing() {
    let ended = ensemble::fly_some(cases(40, 400), |number| {
        let mut rng = ensemble::rng(9, number);
        let mission = standard_field::standard(9, number, Algorithm::Lookahead, 200);
        let corner = KeepOut::polygon(&[[14.0, 14.0], [20.0, 14.0], [20.0, 20.0], [14.0, 20.0]]);
        let mut tree = || [0; 2].map(|_| rng.random_range(2.0..18.0));
        let trees = [KeepOut::disc(tree(), 0.3), KeepOut::disc(tree(), 0.5)];
        let outs = [corner, trees[0], trees[1]].map(|it| it.expect("a keep-out"));
        let square = [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]];
        let lawn = PolygonArea::<4, 3>::metres(&square, &outs).expect("an area");
        let area = lawn.with_clearance(MOST_OFF).expect("a narrow margin");
        let given = mission.given.samples();
        if !given.iter().all(|it| area.contains(it.site)) {
            return None;
        }
        let noise = Noise::new(0.97).and_then(|it| it.with_tolerance(0.3)).expect("a tolerance");
        let truth = mission.start.site.into();
        let rover = Rover { world: mission.world.clone(), lawn, truth, rng };
        let belief = NoisyBelief::<40, { sequences_of(36) }>::new(given, noise);
        let planner = Lookahead::new(area, Unicycle::paper(), belief.expect("four places"));
        let goal = Goal::slope_within_degrees(2.0).expect("an angle");
        let mut agent = Agent::new(planner.expect("room").until(goal), rover, mission.start);
        let reason = (0..200).find_map(|_| match agent.step().expect("labels may be wrong") {
            Event::Stopped(reason) => Some(reason),
            Event::Step(_) => None,
        });
        Some(matches!(
            reason,
            Some(StopReason::Known | StopReason::SamplesFull | StopReason::NoLine)
        ))
    });
    assert!(ended.len() as u64 * 4 > cases(40, 400) && ended.iter().all(|it| *it));
}
