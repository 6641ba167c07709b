//! A robot finds an algal bloom, goes round it, and prints its map. Your robot is a [`Drive`] and a [`LabelSensor`].
//!
//! `cargo run -p planner-core --example bloom`

use std::cell::Cell;
use std::convert::Infallible;
use std::error::Error;

use planner_core::nalgebra::Point2;
use planner_core::robot::{Drive, LabelSensor};
use planner_core::{
    Agent, Area, Event, Front, Heading, Label, Likely, MapPlace, Motion, Noise, Planner as _, Pose,
    Reading, Seeking, StopReason, Track, Unicycle, Vehicle,
};

/// Commands the motors. `at` stands for your localisation.
struct Boat<'a> {
    at: &'a Cell<Pose>,
}

impl Drive for Boat<'_> {
    type Error = Infallible; // yours: a stall, a lost position

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
        self.at.set(motion.target); // turn by motion.control.turn_rad, then drive motion.control.distance_m
        Ok(self.at.get()) // where it ended
    }
}

/// Tells bloom from clear water. One label in twenty is wrong.
struct Fluorometer<'a> {
    at: &'a Cell<Pose>,
    labels: u32,
}

impl LabelSensor for Fluorometer<'_> {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        self.labels += 1;
        let label =
            if off(self.at.get().site.into()) < 0.0 { Label::Positive } else { Label::Negative };
        Ok(if self.labels % 20 == 7 { -label } else { label }.into())
    }
}

/// How far outside the bloom a place is, metres. The bloom is a disc, which the planner does not know.
fn off(at: Point2<f64>) -> f64 {
    (at - Point2::new(120.0, 90.0)).norm() - 25.0
}

fn main() -> Result<(), Box<dyn Error>> {
    let start = Pose::at([10.0, 10.0], Heading::default())?;
    let at = Cell::new(start);
    let vehicle = Vehicle { drive: Boat { at: &at }, sensor: Fluorometer { at: &at, labels: 0 } };

    let area = Area::metres([0.0, 0.0], [200.0, 150.0])?;
    // Motions of up to 3 m, in steps of 0.1 m.
    let unicycle = Unicycle::new(10_000, 1.57, 31, 100)?;
    let planner = Track::new(area, unicycle, Front::BENDING, Noise::new(0.95)?)?
        .seeking(Seeking::patches(20.0)?.likely(Likely::Spill))?
        .until_closed();

    let mut agent = Agent::new(planner, vehicle, start);
    let mut map: Vec<MapPlace> = Vec::new();
    let ended = loop {
        match agent.step()? {
            Event::Step(_) => map.extend(agent.planner.belief().mapped()),
            Event::Stopped(reason) => break reason,
        }
    };
    let mut rest: Vec<_> = agent.planner.belief().places().collect(); // the newest first
    rest.reverse();
    map.extend(rest);

    for MapPlace { waist, .. } in &map {
        let Point2 { coords, .. } = Point2::<f64>::from(waist.site);
        println!("{:.2},{:.2} within {:.2} m", coords.x, coords.y, waist.half_width(0.9));
    }
    println!("{} places, {ended:?}, {} labels", map.len(), agent.body().sensor.labels);
    let holds = |it: &&MapPlace| off(it.waist.site.into()).abs() < it.waist.half_width(0.9);
    let held = map.iter().filter(holds).count();
    let is_mapped = ended == StopReason::Closed && 10 * held > 9 * map.len() && map.len() > 30;
    if is_mapped { Ok(()) } else { Err("the bloom is not mapped".into()) }
}
