//! Random areas with keep-outs.

use std::f64::consts::TAU;

use host_sim::mission::definition::Mission;
use nalgebra::Point2;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::link::message::{MOST_CORNERS, MissionArea};
use planner_core::{Hull, KeepOut, Site, Workspace as _};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Some corners on a circle, in order round it, no two the same.
///
/// # Panics
/// When the circle leaves the lattice.
pub fn on_circle(rng: &mut ChaCha8Rng, middle: [f64; 2], radius: f64, count: usize) -> Vec<Site> {
    loop {
        let mut turns: Vec<f64> = (0..count).map(|_| rng.random_range(0.0..TAU)).collect();
        turns.sort_by(f64::total_cmp);
        let at = |turn: &f64| {
            let (sin, cos) = turn.sin_cos();
            let corner = Point2::new(middle[0] + radius * cos, middle[1] + radius * sin);
            Site::try_from(corner).expect("near")
        };
        let corners: Vec<Site> = turns.iter().map(at).collect();
        if Hull::<8>::new(&corners).is_ok() {
            return corners;
        }
    }
}

/// A random polygon about a standard field's given samples, with up to four keep-outs that none of these lies in.
///
/// # Panics
/// Never.
pub fn around(mission: &Mission, rng: &mut ChaCha8Rng) -> MissionArea {
    let places: Vec<Site> = mission.given.samples().iter().map(|sample| sample.site).collect();
    let border = loop {
        let (size, count) = (rng.random_range(10.0..14.0), rng.random_range(3..=MOST_CORNERS));
        let hull = Hull::new(&on_circle(rng, [10.0, 10.0], size, count)).expect("convex");
        let area = MissionArea::new(hull, &[]).expect("an area");
        if places.iter().all(|place| area.encloses(*place)) {
            break hull;
        }
    };
    let mut keep_outs: Vec<KeepOut<MOST_CORNERS>> = Vec::new();
    for _ in 0..rng.random_range(1..=4) {
        let middle = [rng.random_range(1.0..19.0), rng.random_range(1.0..19.0)];
        let size = rng.random_range(0.2..2.5);
        let (hull, radius) = if rng.random() {
            let at = Site::try_from(Point2::from(middle)).expect("near");
            (Hull::new(&[at]), (size * f64::from(UNITS_PER_METRE)) as u32)
        } else {
            let count = rng.random_range(2..=6);
            (Hull::new(&on_circle(rng, middle, size, count)), 0)
        };
        let keep_out = KeepOut { hull: hull.expect("convex"), radius };
        let area = MissionArea::new(border, &[keep_out]).expect("an area");
        if places.iter().all(|place| area.contains(*place)) {
            keep_outs.push(keep_out);
        }
    }
    MissionArea::new(border, &keep_outs).expect("an area")
}
