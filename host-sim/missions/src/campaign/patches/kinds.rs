//! The rows of the table: what is sought, where, and by which vehicle.

use std::f64::consts::{FRAC_PI_2, PI};

use anyhow::{Error, Result};
use nalgebra::Point2;
use planner_core::link::message::MissionArea;
use planner_core::{AnyVehicle, Boat, Car, CarShape, KeepOut, Likely, Unicycle};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::campaign::patches::truth::Truth;

/// The area and the motions of a row.
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    /// Metres.
    pub sides: [f64; 2],
    /// A keep-out in the middle covers this share.
    pub island: f64,
    /// The radius that is told, metres.
    pub patch: f64,
    /// Motions at most.
    pub steps: u32,
    /// What is told besides.
    pub likely: Likely,
    /// Which vehicle.
    pub vehicle: Vehicle,
}

/// The vehicles, with motions of up to 3 m.
#[derive(Clone, Copy, Debug)]
pub enum Vehicle {
    /// Turns on the spot.
    Unicycle,
    /// Turns by half a radian a motion.
    Boat,
    /// Turns on a circle of 4 m.
    Car,
}

/// The longest motion, metres.
pub const REACH: f64 = 3.0;

/// A lake of 200 m x 150 m.
pub const LAKE: Ground = Ground {
    sides: [200.0, 150.0],
    island: 0.0,
    patch: 20.0,
    steps: 400,
    likely: Likely::Either,
    vehicle: Vehicle::Unicycle,
};

const WIDE: Ground = Ground { sides: [800.0, 500.0], patch: 40.0, steps: 1_600, ..LAKE };

/// A kind of mission.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What tables call it.
    pub name: &'static str,
    /// Draws a boundary.
    pub draw: fn(&Ground, &mut ChaCha8Rng) -> Truth,
    /// Where.
    pub ground: Ground,
}

/// A place for a patch that lies inside the area, at least in most of it, and not in its island.
fn middle(ground: &Ground, radius: f64, rng: &mut ChaCha8Rng) -> Point2<f64> {
    let half = Point2::from(ground.sides.map(|it| it / 2.0));
    for _ in 0..100 {
        let place = ground.sides.map(|side| {
            let room = radius.min(side / 2.0);
            room + rng.random_range(0.0..=1.0) * (side - 2.0 * room)
        });
        if (Point2::from(place) - half).norm() > ground.island_radius() {
            return place.into();
        }
    }
    half
}

fn circle(ground: &Ground, rng: &mut ChaCha8Rng) -> Truth {
    let radius = ground.patch * rng.random_range(1.25..2.25);
    Truth::patch(middle(ground, radius, rng), (radius, 1.0, 0.0), rng)
}

fn share(ground: &Ground, rng: &mut ChaCha8Rng) -> Truth {
    let share = libm::exp(rng.random_range(libm::log(0.045)..libm::log(0.4)));
    let radius = libm::sqrt(share * ground.sides[0] * ground.sides[1] / PI);
    Truth::patch(middle(ground, radius, rng), (radius, 1.0, 0.04), rng)
}

fn ellipse(ground: &Ground, rng: &mut ChaCha8Rng) -> Truth {
    let (radius, long) = (ground.patch * rng.random_range(1.5..2.25), rng.random_range(1.2..2.2));
    Truth::patch(middle(ground, radius * libm::sqrt(long), rng), (radius, long, 0.0), rng)
}

fn blob(ground: &Ground, rng: &mut ChaCha8Rng) -> Truth {
    let radius = ground.patch * rng.random_range(1.4..2.25);
    Truth::patch(middle(ground, 1.2 * radius, rng), (radius, 1.2, 0.08), rng)
}

/// The kinds, in the order of tables.
pub const KINDS: [Kind; 12] = [
    Kind { name: "circle of 25 to 45 m", draw: circle, ground: LAKE },
    Kind { name: "ellipse", draw: ellipse, ground: LAKE },
    Kind { name: "blob", draw: blob, ground: LAKE },
    Kind { name: "4.5 to 40 % of the area", draw: share, ground: LAKE },
    Kind {
        name: "line",
        draw: |ground, rng| Truth::coast(ground.sides, [0.0, 1.0], rng),
        ground: LAKE,
    },
    Kind {
        name: "line, told a coast",
        draw: |ground, rng| Truth::coast(ground.sides, [0.0, 1.0], rng),
        ground: Ground { likely: Likely::Coast, ..LAKE },
    },
    Kind {
        name: "coast of 6 m",
        draw: |ground, rng| Truth::coast(ground.sides, [6.0, 120.0], rng),
        ground: LAKE,
    },
    Kind { name: "circle, island of 20 %", draw: circle, ground: Ground { island: 0.2, ..LAKE } },
    Kind {
        name: "circle, a boat",
        draw: circle,
        ground: Ground { vehicle: Vehicle::Boat, ..LAKE },
    },
    Kind { name: "circle, a car", draw: circle, ground: Ground { vehicle: Vehicle::Car, ..LAKE } },
    Kind { name: "circle, 800 m x 500 m", draw: circle, ground: WIDE },
    Kind { name: "nothing", draw: |_, _| Truth::Empty, ground: Ground { steps: 1_500, ..LAKE } },
];

impl Ground {
    fn island_radius(&self) -> f64 {
        libm::sqrt(self.island * self.sides[0] * self.sides[1] / PI)
    }

    /// The area of motions.
    ///
    /// # Errors
    /// Never: it is an area.
    pub fn area(&self) -> Result<MissionArea> {
        let [x, z] = self.sides;
        let corners = [[0.0, 0.0], [x, 0.0], [x, z], [0.0, z]].map(Point2::from);
        let island = KeepOut::disc([x / 2.0, z / 2.0], self.island_radius()).map_err(Error::msg)?;
        let keep_outs = [island];
        let keep_outs = if self.island > 0.0 { &keep_outs[..] } else { &[] };
        MissionArea::metres(&corners, keep_outs).map_err(Error::msg)
    }

    /// The vehicle.
    ///
    /// # Errors
    /// Never: it is one.
    pub fn vehicle(&self) -> Result<AnyVehicle> {
        let unicycle = |sharpest| {
            let speeds = libm::round(REACH * 10.0) as u16 + 1;
            Unicycle::new(1_000, sharpest, speeds, 100).map_err(Error::msg)
        };
        Ok(match self.vehicle {
            Vehicle::Unicycle => AnyVehicle::Unicycle(unicycle(FRAC_PI_2)?),
            Vehicle::Boat => AnyVehicle::Boat(Boat::new(unicycle(0.5)?).map_err(Error::msg)?),
            Vehicle::Car => {
                let (speeds, speed_step_mm) = (31, 100);
                let shape = CarShape {
                    radius_mm: 4_000,
                    shortest_mm: 500,
                    turn_step_urad: 10_000,
                    speeds,
                    speed_step_mm,
                };
                AnyVehicle::Car(Car::new(shape).map_err(Error::msg)?)
            }
        })
    }
}
