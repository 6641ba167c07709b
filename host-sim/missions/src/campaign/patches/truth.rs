//! Boundaries of missions that seek one.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

/// Waves of a blob's outline.
const WAVES: u32 = 4;

/// A boundary. The label is +1 on its inside.
#[derive(Clone, Copy, Debug)]
pub enum Truth {
    /// There is none.
    Empty,
    /// A patch whose outline is at the distance `radius (1 + sum a cos(k angle + b))`, stretched along an axis.
    Patch {
        /// Metres.
        middle: Point2<f64>,
        /// Metres.
        radius: f64,
        /// How many times as long as broad it is, and its direction.
        stretched: [f64; 2],
        /// The waves of its outline, from the second on: `a` and `b`.
        waves: [[f64; 2]; WAVES as usize],
    },
    /// A line through a place with a normal, and its waves: height, length and phase.
    Coast {
        /// On the line.
        place: Point2<f64>,
        /// A unit vector.
        normal: Vector2<f64>,
        /// Height and length in metres, and phase.
        wave: [f64; 3],
    },
}

impl Truth {
    /// A patch of about this radius and elongation, with waves of this height, as a share.
    pub fn patch(
        middle: Point2<f64>,
        (radius, long, height): (f64, f64, f64),
        rng: &mut ChaCha8Rng,
    ) -> Self {
        let stretched = [long, rng.random_range(0.0..TAU)];
        let waves = [(); WAVES as usize]
            .map(|()| [height * rng.random_range(-1.0..1.0), rng.random_range(0.0..TAU)]);
        Self::Patch { middle, radius, stretched, waves }
    }

    /// A line that crosses a rectangle somewhere in its middle part, with waves of this height and length.
    pub fn coast(sides: [f64; 2], [height, length]: [f64; 2], rng: &mut ChaCha8Rng) -> Self {
        let place = sides.map(|side| side * rng.random_range(0.15..0.85));
        let (sin, cos) = libm::sincos(rng.random_range(0.0..TAU));
        let phase = rng.random_range(0.0..TAU);
        Self::Coast {
            place: place.into(),
            normal: Vector2::new(cos, sin),
            wave: [height, length, phase],
        }
    }

    /// How far inside a place lies, metres; negative outside. Of a patch along the ray from its middle.
    pub fn depth(&self, at: Point2<f64>) -> f64 {
        match *self {
            Self::Empty => f64::NEG_INFINITY,
            Self::Patch { middle, radius, stretched: [long, turn], waves } => {
                let (sin, cos) = libm::sincos(turn);
                let off = at - middle;
                let narrow = libm::sqrt(long);
                let x = (off.x * cos + off.y * sin) / narrow;
                let z = (off.y * cos - off.x * sin) * narrow;
                let (angle, far) = (libm::atan2(z, x), libm::hypot(x, z));
                let wave = |(k, [a, b]): (u32, &[f64; 2])| a * libm::cos(f64::from(k) * angle + b);
                let outline = radius * (1.0 + (2..).zip(&waves).map(wave).sum::<f64>());
                (outline - far) * if far > 0.0 { off.norm() / far } else { 1.0 }
            }
            Self::Coast { place, normal, wave: [height, length, phase] } => {
                let off = at - place;
                let along = off.x * -normal.y + off.y * normal.x;
                off.dot(&normal) - height * libm::sin(TAU * along / length + phase)
            }
        }
    }
}
