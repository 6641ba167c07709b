//! Missions of which a part is drawn at random: vehicles that cannot turn on the spot, coarse grids, and searches from
//! nothing.

use std::f64::consts::{FRAC_PI_2, PI};

use host_sim::campaign::standard_field::{SIDE_M, standard, stretched};
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Given;
use host_sim::world::World;
use planner_core::{AnyVehicle, Holonomic, Line, Unicycle, Workspace as _};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::draw::{MOTIONS, draw};
use crate::ensemble::{self, noisy};
use crate::vehicles::{boat, car};

/// A mission of a car or boat on a standard field or on a lake, by every algorithm. In every second group of 48 the
/// vehicle has a fine fan.
pub fn draw_vehicle(seed: u64, number: u64) -> Mission {
    let turn = |groups: usize, size: usize| number as usize / size % groups;
    let (sides, reach_mm) =
        [([SIDE_M; 2], 2_000), ([800.0, 500.0], 20_000), ([800.0, 500.0], 80_000)][turn(3, 4)];
    let (algorithm, is_noisy) = [
        (Algorithm::Cfc, false),
        (Algorithm::Lookahead, false),
        (Algorithm::Scc, true),
        (Algorithm::Lookahead, true),
    ][turn(4, 12)];
    let urad = [10_000, 1][turn(2, 48)];
    let steps = if is_noisy { 40 } else { MOTIONS };
    let mut mission = stretched(sides, seed, number, algorithm, steps);
    mission.vehicle = match turn(4, 1) {
        3 => AnyVehicle::Boat(boat(urad, 20_f64.to_radians(), reach_mm)),
        kind => AnyVehicle::Car(car(urad, [1_000, 3_000, 5_000][kind], reach_mm)),
    };
    if is_noisy { noisy(mission, 0.8, 0.5) } else { mission }
}

/// A mission of Algorithm 1 on a standard field and on any grid that the constructors take: coarse and fine, slow and
/// quick to turn, centimetres to metres. Some vehicles are holonomic.
pub fn draw_coarse(seed: u64, number: u64) -> (Mission, Option<Holonomic>) {
    let mut rng = ensemble::rng(seed, number);
    let mut mission = standard(seed, number, Algorithm::Cfc, 10 * MOTIONS);
    mission.start.heading.0 = rng.random();
    loop {
        let speeds = [2, 3, 5, 11, 21][rng.random_range(0..5)];
        let step_mm = [20, 100, 200, 1_000, 3_000][rng.random_range(0..5)];
        if rng.random_range(0..4) == 0 {
            if let Ok(it) = Holonomic::new(rng.random_range(1..40), speeds, step_mm) {
                return (mission, Some(it));
            }
        } else if let Some(it) = coarse(&mut rng, speeds, step_mm) {
            mission.vehicle = AnyVehicle::Unicycle(it);
            return (mission, None);
        }
    }
}

fn coarse(rng: &mut ChaCha8Rng, speeds: u16, step_mm: u32) -> Option<Unicycle> {
    let sharpest = match rng.random_range(0..4) {
        0 => rng.random_range(0.05..0.4),
        1 => FRAC_PI_2,
        2 => PI,
        _ => rng.random_range(0.05..PI),
    };
    let turn_step = rng.random_range(1..=(1000.0 * sharpest) as u32).max(10);
    Unicycle::new(1_000 * turn_step, sharpest, speeds, step_mm).ok()
}

/// A random mission that begins without points, or with some of one label. Sometimes the area has one label.
///
/// # Panics
/// Never: its line is in range.
pub fn draw_nothing(seed: u64, number: u64) -> Mission {
    let mission = draw(seed, number);
    let mut rng = ensemble::rng(seed, number);
    let world = if rng.random_range(0..5) == 0 {
        World::divided_by(Line::from_slope(0.0, -1e5).expect("a line"))
    } else {
        mission.world.clone()
    };
    let given = mission.given.samples().iter().filter(|it| world.agrees(it.site, it.label));
    let one = given.clone().next().map(|it| it.label);
    let given = given.filter(|it| Some(it.label) == one && mission.config.area.contains(it.site));
    let given = Given::open(given.take(rng.random_range(0..3)).copied().collect());
    let asking = Asking { price: mission.asking.price, ..Asking::USUAL };
    let steps = 10 * MOTIONS;
    let algorithm = Algorithm::Lookahead;
    Mission { algorithm, steps, world, given, goal: None, asking, ..mission }
}
