//! The standard fields: the seeded ensemble on which planners are measured. A field is drawn in three steps.
//!
//! 1. A guide line through a point uniform in [6, 14]^2, with a uniform direction.
//! 2. The oracle's points in the paper's order `-, +, +, -`: two towards one end of the guide line, two towards the
//!    other. They lie 3 to 8 m along the line from that point, and 1.5 to 5 m off it on the sides of their labels. All
//!    are drawn again if one leaves the area. The initial heading is uniform, and the start is at `p1`.
//! 3. The true line, uniform from the version space of those four points by the measure d(angle) d(offset). It is drawn
//!    by rejection, over lines that meet the area's circumscribed disc.

use nalgebra::{Point2, Vector2};
use planner_core::link::message::Settings;
use planner_core::{
    Area, Crossing, Front, Heading, Label, Line, Policy, Pose, Prior, Reading, Sample, Seeking,
    Site, Tolerance, VersionSpace,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::Allowance;
use crate::mission::asking::Asking;
use crate::mission::bounds::Bounds;
use crate::mission::definition::Mission;
use crate::world::errors::Errors;
use crate::world::{World, reading};

/// Side of the standard area, metres.
pub const SIDE_M: f64 = 20.0;

/// The standard area.
///
/// # Panics
/// Never: its corners are on the lattice.
pub fn area() -> Area {
    let corner = |m: f64| Site::try_from(Point2::new(m, m)).expect("within the lattice");
    Area::new(corner(0.0), corner(SIDE_M)).expect("has an inside")
}

/// A place of the standard area where it comes to lie in one with other sides.
fn stretch(site: Site, sides: [f64; 2]) -> Site {
    let at = Point2::<f64>::from(site);
    let [x, z] = sides.map(|side| side / SIDE_M);
    Site::try_from(Point2::new(at.x * x, at.y * z)).expect("within an area on the lattice")
}

/// A unit vector by libm, the same on every machine.
fn unit(angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(cos, sin)
}

/// The standard field with this number in the ensemble of this seed. A field depends on nothing
/// else: not on the number of fields, the algorithm or the order in which they run.
///
/// # Panics
/// Never: what it draws is within metres of the area.
pub fn standard(seed: u64, number: u64, algorithm: Algorithm, steps: u32) -> Mission {
    stretched([SIDE_M; 2], seed, number, algorithm, steps)
}

/// The same field stretched to other sides, metres; the true line is drawn anew.
///
/// # Panics
/// When the sides are not those of an area on the lattice.
pub fn stretched(
    sides: [f64; 2],
    seed: u64,
    number: u64,
    algorithm: Algorithm,
    steps: u32,
) -> Mission {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    let turn = |rng: &mut ChaCha8Rng| rng.random_range(0.0..std::f64::consts::TAU);
    let standard = area();
    let area = Area::metres([0.0; 2], sides).expect("an area on the lattice");
    let (oracle, given) = loop {
        let middle = Point2::new(rng.random_range(6.0..14.0), rng.random_range(6.0..14.0));
        let along = unit(turn(&mut rng));
        let left = Vector2::new(-along.y, along.x);
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)];
        let drawn = corners.map(|(end, side)| {
            let (run, off) = (rng.random_range(3.0..8.0), rng.random_range(1.5..5.0));
            let site = Site::try_from(middle + along * (end * run) + left * (side * off));
            let label = if side > 0.0 { Label::Positive } else { Label::Negative };
            Sample { site: site.expect("metres from the area"), label }
        });
        let oracle = drawn.map(|sample| Sample { site: stretch(sample.site, sides), ..sample });
        if drawn.iter().all(|s| standard.contains(s.site))
            && let Ok(given) = VersionSpace::new(&oracle)
        {
            break (oracle, given);
        }
    };
    let heading = Heading::from_radians(turn(&mut rng)).expect("an angle");
    let truth = loop {
        let half = Vector2::from(sides) / 2.0;
        let radius = libm::hypot(half.x, half.y);
        let normal = unit(turn(&mut rng));
        let point = Point2::from(half) + normal * rng.random_range(-radius..radius);
        let agrees =
            |line: &Line| oracle.iter().all(|s| reading(line, s.site) == Reading::Side(s.label));
        if let Some(line) = Line::through(point, normal).filter(agrees) {
            break line;
        }
    };
    Mission {
        lake: None,
        algorithm,
        steps,
        readings: 1,
        seed: seed ^ number.rotate_left(32),
        config: Settings {
            area: area.into(),
            weight: algorithm.weight(),
            crossing: Crossing::default(),
            following: algorithm.following(),
            tolerance: Tolerance::NONE,
        },
        allowance: Allowance::NONE,
        vehicle: algorithm.grid().into(),
        start: Pose { site: oracle[0].site, heading },
        world: World::divided_by(truth),
        given: given.into(),
        read_before: Vec::new(),
        noise: None,
        p_told: None,
        errors: Errors::default(),
        sensor: Vec::new(),
        policy: Policy::default(),
        prior: Prior::default(),
        goal: None,
        audits: true,
        asking: Asking::USUAL,
        bounds: Bounds::NONE,
        front: Front::STRAIGHT,
        watch: None,
        seeking: Seeking::USUAL,
        until_closed: true,
        doubts: Vec::new(),
    }
}
