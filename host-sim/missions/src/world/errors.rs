//! A robot that errs: its motions end elsewhere than they should, and its true position differs from the one it
//! reports.

use nalgebra::{Point2, Vector2};
use planner_core::{Heading, Motion, Pose, Reading, Site};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::world::World;
use crate::world::on_the_way::Way;
use crate::world::robot::{Glimpse, Robot};

/// Gaussian errors are cut off at this many standard deviations.
pub const CUT: f64 = 3.0;

/// How a robot errs: standard deviations, metres an axis and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Of where a drive ends.
    pub motion: f64,
    /// Of how far a motion turns.
    pub turn: f64,
    /// Of the position that is reported.
    pub position: f64,
    /// Of the heading that is reported.
    pub heading: f64,
}

/// A robot that errs, and reads the true label where it truly is.
pub struct Erring {
    world: World,
    errors: Errors,
    rng: ChaCha8Rng,
    truth: Pose,
}

impl Erring {
    /// A robot that reports `start` as its pose. Its true position differs by a random error, as with each pose it
    /// reports.
    pub fn new(world: World, errors: Errors, start: Pose, mut rng: ChaCha8Rng) -> Self {
        let truth = displaced(start, spread(&mut rng, errors.position), 0.0);
        Self { world, errors, rng, truth }
    }
}

impl Robot for Erring {
    fn true_pose(&self) -> Option<Pose> {
        Some(self.truth)
    }

    /// Turns and drives from the true pose. The turn and the length are those of the motion from the assumed pose, plus
    /// the robot's errors.
    fn travel(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        way: Way,
        pass: &mut dyn FnMut(Glimpse),
    ) -> Option<Reading> {
        self.world.advance();
        let Self { errors, truth, .. } = *self;
        let turn = Heading(motion.target.heading.0.wrapping_sub(pose.heading.0)).radians();
        let drive = metres(motion.target.site) - metres(pose.site);
        let off = Heading(truth.heading.0.wrapping_sub(pose.heading.0)).radians();
        let turned = gauss(&mut self.rng, errors.turn);
        let slipped = spread(&mut self.rng, errors.motion);
        let moves = drive != Vector2::zeros();
        let drive = rotated(drive, off + turned) + if moves { slipped } else { Vector2::zeros() };
        self.truth = displaced(truth, drive, turn + turned);
        for site in way.sites(truth, self.truth) {
            let there = Pose { site, ..self.truth };
            let reported = displaced(there, spread(&mut self.rng, errors.position), 0.0).site;
            pass(Glimpse { reported, site, reading: Some(self.world.reading(site)) });
        }
        let reported = spread(&mut self.rng, errors.position);
        *pose = displaced(self.truth, reported, gauss(&mut self.rng, errors.heading));
        motion.wants_label.then(|| self.world.reading(self.truth.site))
    }
}

fn metres(site: Site) -> Point2<f64> {
    Point2::from(site)
}

fn rotated(v: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(angle);
    Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

/// A pose after an offset and a turn. If the new place is off the lattice, the site stays the same.
fn displaced(pose: Pose, by: Vector2<f64>, turn: f64) -> Pose {
    let site = Site::try_from(metres(pose.site) + by).unwrap_or(pose.site);
    let turn = Heading::from_radians(turn).unwrap_or_default().since(Heading::default());
    Pose { site, heading: pose.heading.turned(turn) }
}

/// Two independent errors. As a vector they are no longer than [`CUT`] standard deviations.
fn spread(rng: &mut ChaCha8Rng, deviation: f64) -> Vector2<f64> {
    loop {
        // Box and Muller, by libm: the same on every machine.
        let radius = libm::sqrt(-2.0 * libm::log(1.0 - rng.random_range(0.0..1.0)));
        let (sin, cos) = libm::sincos(rng.random_range(0.0..std::f64::consts::TAU));
        if radius <= CUT {
            return Vector2::new(cos, sin) * (radius * deviation);
        }
    }
}

/// One error.
fn gauss(rng: &mut ChaCha8Rng, deviation: f64) -> f64 {
    spread(rng, deviation).x
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;

    #[test]
    fn errors_have_their_deviation_and_their_cut() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let drawn: Vec<_> = (0..100_000).map(|_| spread(&mut rng, 0.5)).collect();
        let mean = drawn.iter().sum::<Vector2<f64>>() / 1e5;
        let square = drawn.iter().map(|v| v.x * v.x).sum::<f64>() / 1e5;
        assert!(mean.norm() < 0.01, "{mean}");
        // The cut takes 1 % of the drawn, and a little of the deviation.
        assert!((square.sqrt() - 0.5).abs() < 0.02, "{}", square.sqrt());
        assert!(drawn.iter().all(|v| v.norm() <= 0.5 * CUT));
    }
}
