//! Drives that fail on the way: the mission goes on from where the robot is.

use std::cell::Cell;
use std::convert::Infallible;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::world::World;
use planner_core::geometry::lattice::Vector;
use planner_core::robot::AgentError;
use planner_core::robot::VehicleError;
use planner_core::robot::{Drive, LabelSensor};
use planner_core::{
    Agent, Belief as _, Event, Line, Motion, Planner, Pose, Reading, Unicycle, Vehicle,
    Workspace as _,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// It got stuck.
#[derive(Debug)]
struct Stuck;

/// Every third drive or so ends on the way, or a metre beside it.
struct Failing<'a> {
    world: World,
    place: &'a Cell<Pose>,
    rng: ChaCha8Rng,
}

impl Drive for Failing<'_> {
    type Error = Stuck;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Stuck> {
        let (from, way) = (self.place.get(), motion.target.site - self.place.get().site);
        self.place.set(motion.target);
        if self.rng.random_range(0..3) > 0 {
            return Ok(motion.target);
        }
        let mut aside = || self.rng.random_range(-1 << 16..1 << 16);
        let by = [way.x() / 2 + aside(), way.z() / 2 + aside()];
        let by = Vector::new(by[0], by[1]).expect("short");
        self.place.set(Pose { site: from.site.step(by).expect("near"), ..motion.target });
        Err(Stuck)
    }
}

struct Sensor<'a>(World, &'a Cell<Pose>);

impl LabelSensor for Sensor<'_> {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        Ok(self.0.reading(self.1.get().site))
    }
}

/// Flies until a planner has its labels; how many drives failed, and how often it was outside then.
fn fly(number: u64, planner: impl Planner) -> (u32, u32) {
    let mission = standard_field::standard(8, number, Algorithm::Cfc, 20);
    let place = Cell::new(mission.start);
    let rng = ChaCha8Rng::seed_from_u64(number);
    let drive = Failing { world: mission.world.clone(), place: &place, rng };
    let sensor = Sensor(drive.world.clone(), &place);
    let mut agent = Agent::new(planner, Vehicle { drive, sensor }, mission.start);
    let (mut labels, mut failed, mut outside) = (0, 0, 0);
    while labels < 20 {
        match agent.step() {
            Ok(Event::Step(step)) => labels += u32::from(step.reading.is_some()),
            Ok(Event::Stopped(reason)) => panic!("field {number}: {reason:?}"),
            Err(AgentError::Body(VehicleError::Drive(Stuck))) => {
                failed += 1;
                outside += u32::from(!mission.config.area.contains(place.get().site));
                agent.relocate(place.get());
            }
            Err(error) => panic!("field {number}: {error:?}"),
        }
        assert!(failed < 200, "field {number}: no end");
    }
    let centre = agent.planner.belief().estimates().centre.expect("a line");
    let truth = mission.world.line().expect("a line");
    assert!(Line::from(centre).angle_to_deg(truth) < 15.0, "field {number}");
    (failed, outside)
}

#[test]
fn missions_go_on_from_where_a_drive_has_failed() {
    let (mut failed, mut outside) = (0, 0);
    for number in 0..150 {
        let mission = standard_field::standard(8, number, Algorithm::Cfc, 20);
        let (area, unicycle) = (mission.config.area, Unicycle::paper());
        let cfc = fly(number, mission.cfc(area, unicycle));
        let lookahead = fly(number, mission.lookahead(area, unicycle));
        failed += cfc.0 + lookahead.0;
        outside += cfc.1 + lookahead.1;
    }
    println!("{failed} drives failed, {outside} of them outside the area");
    assert!(failed > 2_000 && outside > 50);
}
