//! A bloom in a lake with an island: a robot finds its border, goes round it and maps it. Nothing is known of where it is,
//! and one label in twenty is wrong.
//!
//! `cargo run -p planner-core --example bloom`

use std::error::Error;

use planner_core::nalgebra::Point2;
use planner_core::{
    Front, Heading, KeepOut, Label, MapPlace, Noise, Plan, Planner as _, PolygonArea, Pose, Track,
    Unicycle,
};

fn main() -> Result<(), Box<dyn Error>> {
    let island = KeepOut::disc([50.0, 80.0], 10.0)?;
    let shore = [[0.0, 0.0], [200.0, 0.0], [200.0, 150.0], [0.0, 150.0]];
    let lake = PolygonArea::<4, 1>::metres(&shore, &[island])?;
    let vehicle = Unicycle::new(10_000, 1.57, 13, 250)?; // up to 3 m, in steps of 0.25 m
    let noise = Noise::new(0.95)?.with_tolerance(0.1)?;
    let mut planner = Track::new(lake, vehicle, Front::BENDING, noise)?.until_closed();
    let mut pose = Pose::at([20.0, 60.0], Heading::default())?;
    let (mut labels, mut map) = (0, Vec::<MapPlace>::new());
    while let Plan::Move(motion) = planner.plan(pose) {
        pose = motion.target; // drive there, and say where that was
        labels += 1;
        let off = Point2::<f64>::from(pose.site) - Point2::new(110.0, 80.0); // read your sensor instead
        let is_wrong = labels % 20 == 7;
        let label = if (off.norm() < 30.0) == is_wrong { Label::Negative } else { Label::Positive };
        planner.observe(pose, motion.wants_label.then_some(label.into()))?;
        map.extend(planner.belief().mapped()); // the places that came on the map with this label
    }
    println!("{} places; closed: {}", map.len(), planner.is_closed());
    let off =
        |it: &MapPlace| (Point2::<f64>::from(it.waist.site) - Point2::new(110.0, 80.0)).norm();
    let near = map.iter().filter(|it| (off(it) - 30.0).abs() < it.waist.half_width(0.9)).count();
    assert!(planner.is_closed() && map.len() > 50 && 5 * near > 4 * map.len(), "{near} are near");
    Ok(())
}
