//! The kinds of fronts in the ensemble.

use rand_chacha::ChaCha8Rng;

use crate::campaign::fronts::true_front::TrueFront;

/// A kind of front.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What tables call it.
    pub name: &'static str,
    /// Draws one.
    pub draw: fn(&mut ChaCha8Rng) -> TrueFront,
    /// How far it moves in a step, metres: all that a planner is told of it.
    pub speed: f64,
}

/// The kinds, in the order of tables.
pub const KINDS: [Kind; 10] = [
    Kind { name: "circle of 20 m", draw: |rng| TrueFront::circle(20.0, rng), speed: 0.0 },
    Kind { name: "circle of 100 m", draw: |rng| TrueFront::circle(100.0, rng), speed: 0.0 },
    Kind { name: "sine of 4 m at 60 m", draw: |rng| TrueFront::sine(4.0, 60.0, rng), speed: 0.0 },
    Kind {
        name: "coast of 6 m at 25 m",
        draw: |rng| TrueFront::coast([6.0, 25.0], rng),
        speed: 0.0,
    },
    Kind {
        name: "circle of 100 m, moving 5 cm",
        draw: |rng| TrueFront::circle(100.0, rng).moving(0.05, rng),
        speed: 0.05,
    },
    Kind { name: "line", draw: TrueFront::line, speed: 0.0 },
    Kind {
        name: "line, moving 5 cm",
        draw: |rng| TrueFront::line(rng).moving(0.05, rng),
        speed: 0.05,
    },
    Kind { name: "sine of 2 m at 23 m", draw: |rng| TrueFront::sine(2.0, 23.0, rng), speed: 0.0 },
    Kind { name: "saw of 40 m", draw: |rng| TrueFront::corners(40.0, rng), speed: 0.0 },
    Kind { name: "jagged shore", draw: TrueFront::jagged, speed: 0.0 },
];
