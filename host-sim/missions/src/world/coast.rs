//! A coast drawn at random: a smooth curve over x whose height is a Gaussian process.

use std::f64::consts::TAU;

use nalgebra::Point2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::world::way::Way;

/// Sines that a coast is the sum of.
const SINES: u32 = 60;

/// Points of the coast in its length scale.
const FINE: f64 = 40.0;

/// The points of a coast from `-half` to `half` in x, for a [`Polyline`](crate::world::polyline::Polyline). Its
/// heights have the standard deviation `height` and the correlation `exp(-d^2 / (2 length^2))` at a distance `d`;
/// metres. They are a sum of sines with random phases and with the wave numbers of that correlation. Most of its bends
/// have a radius above `length^2 / (3 height)`.
pub fn coast(rng: &mut ChaCha8Rng, [height, length]: [f64; 2], half: f64) -> Way {
    let sines: Vec<_> = (0..SINES)
        .map(|_| {
            let radius = libm::sqrt(-2.0 * libm::log(1.0 - rng.random_range(0.0..1.0)));
            let wave = radius * libm::cos(rng.random_range(0.0..TAU)) / length;
            [wave, rng.random_range(0.0..TAU)]
        })
        .collect();
    let each = height * libm::sqrt(2.0 / f64::from(SINES));
    let z =
        |x: f64| each * sines.iter().map(|[wave, phase]| libm::sin(wave * x + phase)).sum::<f64>();
    let points = (half / length * FINE).ceil() as i32;
    let x = |n: i32| half * f64::from(n) / f64::from(points);
    (-points..=points).map(|n| Point2::new(x(n), z(x(n)))).collect()
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;

    #[test]
    fn heights_have_their_deviation_and_bends_their_radius() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let (mut squares, mut tight, mut count) = (0.0, 0, 0);
        for _ in 0..40 {
            let way = coast(&mut rng, [6.0, 25.0], 300.0);
            for piece in way.windows(3) {
                let step = piece[1].x - piece[0].x;
                let slope = (piece[2].y - piece[0].y) / (2.0 * step);
                let second = (piece[0].y - 2.0 * piece[1].y + piece[2].y) / (step * step);
                let bend = second.abs() / (1.0 + slope * slope).powf(1.5);
                squares += piece[1].y * piece[1].y;
                tight += i32::from(bend > 18.0 / 625.0);
                count += 1;
            }
        }
        let deviation = (squares / f64::from(count)).sqrt();
        assert!((deviation - 6.0).abs() < 0.5, "{deviation}");
        assert!(f64::from(tight) < 0.1 * f64::from(count), "{tight} of {count}");
    }
}
