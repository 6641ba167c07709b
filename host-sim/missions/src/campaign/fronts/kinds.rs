//! The kinds of fronts in the ensemble, and what a tracker is told of each.

use anyhow::{Error, Result};
use planner_core::Front;
use rand_chacha::ChaCha8Rng;

use crate::campaign::fronts::true_front::TrueFront;

/// A kind of front.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What tables call it.
    pub name: &'static str,
    /// Draws one.
    pub draw: fn(&mut ChaCha8Rng) -> TrueFront,
    /// What a tracker is told.
    pub told: Told,
}

/// What a tracker is told of a front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Told {
    /// The radius of the tightest bend, metres.
    pub radius: f64,
    /// Metres a step.
    pub speed: f64,
}

impl Told {
    /// Multiplies the radius and the speed.
    #[must_use]
    pub fn times(self, [radius, speed]: [f64; 2]) -> Self {
        Self { radius: self.radius * radius, speed: self.speed * speed }
    }

    /// The same as a setting.
    ///
    /// # Errors
    /// When there is no such setting.
    pub fn front(self) -> Result<Front> {
        Front::bending(self.radius).and_then(|it| it.moving(self.speed)).map_err(Error::msg)
    }
}

/// The kinds, in the order of tables.
pub const KINDS: [Kind; 10] = [
    Kind {
        name: "circle of 20 m",
        draw: |rng| TrueFront::circle(20.0, rng),
        told: Told { radius: 20.0, speed: 0.0 },
    },
    Kind {
        name: "circle of 100 m",
        draw: |rng| TrueFront::circle(100.0, rng),
        told: Told { radius: 100.0, speed: 0.0 },
    },
    Kind {
        name: "circle of 100 m, told 50",
        draw: |rng| TrueFront::circle(100.0, rng),
        told: Told { radius: 50.0, speed: 0.0 },
    },
    Kind {
        name: "sine of 4 m at 60 m, told 20",
        draw: |rng| TrueFront::sine(4.0, 60.0, rng),
        told: Told { radius: 20.0, speed: 0.0 },
    },
    Kind {
        name: "coast of 6 m at 25 m, told 40",
        draw: |rng| TrueFront::coast([6.0, 25.0], rng),
        told: Told { radius: 40.0, speed: 0.0 },
    },
    Kind {
        name: "circle of 100 m, moving 5 cm",
        draw: |rng| TrueFront::circle(100.0, rng).moving(0.05, rng),
        told: Told { radius: 100.0, speed: 0.05 },
    },
    Kind {
        name: "line, told 100",
        draw: TrueFront::line,
        told: Told { radius: 100.0, speed: 0.0 },
    },
    Kind {
        name: "line, moving 5 cm, told 100",
        draw: |rng| TrueFront::line(rng).moving(0.05, rng),
        told: Told { radius: 100.0, speed: 0.05 },
    },
    Kind {
        name: "sine of 2 m at 23 m, told 6",
        draw: |rng| TrueFront::sine(2.0, 23.0, rng),
        told: Told { radius: 6.0, speed: 0.0 },
    },
    Kind {
        name: "saw of 40 m, told 10",
        draw: |rng| TrueFront::corners(40.0, rng),
        told: Told { radius: 10.0, speed: 0.0 },
    },
];
