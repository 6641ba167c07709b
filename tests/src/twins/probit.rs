//! The distribution over lines by labels whose positions err, on a grid: the twin of a table's weights.
//!
//! It knows the likelihood alone: of a line at a signed distance `s` a label +1 is read with probability
//! `p Phi(s / sigma) + (1 - p) Phi(-s / sigma)`.

use std::f64::consts::{SQRT_2, TAU};

/// A place in metres and what was read there, 1 or -1.
pub type Told = ([f64; 2], f64);

/// Lines by the angle of their normals and their offsets about a point, each with its weight.
pub struct Probit {
    about: [f64; 2],
    lines: Vec<([f64; 3], f64)>,
}

/// The normal distribution's integral.
fn phi(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

impl Probit {
    /// The lines within `radius` metres of a point that agree with given samples, by the labels that were read since.
    pub fn new(
        about: [f64; 2],
        radius: f64,
        given: &[Told],
        told: &[Told],
        p: f64,
        sigma: f64,
    ) -> Self {
        let (angles, offsets) = (1_440, 400);
        let mut lines = Vec::new();
        for angle in (0..angles).map(|k| TAU * f64::from(k) / f64::from(angles)) {
            let (sin, cos) = angle.sin_cos();
            for k in 0..offsets {
                let line =
                    [cos, sin, radius * ((2.0 * f64::from(k) + 1.0) / f64::from(offsets) - 1.0)];
                if given.iter().any(|&(place, label)| label * distance(about, line, place) < 0.0) {
                    continue;
                }
                let chance = |&(place, label): &Told| {
                    let s = label * distance(about, line, place) / sigma;
                    p * phi(s) + (1.0 - p) * phi(-s)
                };
                lines.push((line, told.iter().map(chance).product()));
            }
        }
        Self { about, lines }
    }

    /// The share of the lines that have a place on their +1 side.
    pub fn share_above(&self, place: [f64; 2]) -> f64 {
        let above = |(line, _): &&([f64; 3], f64)| distance(self.about, *line, place) > 0.0;
        let above: f64 = self.lines.iter().filter(above).map(|(_, weight)| weight).sum();
        above / self.lines.iter().map(|(_, weight)| weight).sum::<f64>()
    }
}

/// How far a place is on the +1 side.
fn distance(about: [f64; 2], [x, z, offset]: [f64; 3], place: [f64; 2]) -> f64 {
    x * (place[0] - about[0]) + z * (place[1] - about[1]) + offset
}
