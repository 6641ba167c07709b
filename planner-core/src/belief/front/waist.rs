//! Where a front is known best.

use crate::belief::front::lay::{Unit, angle, limited, metres};
use crate::belief::front::moments::Moments;
use crate::belief::front::tracker::{ABSENT, Tracker};
use crate::geometry::approximate::sqrt;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};

/// The place where a front is known best, and how well it is known there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Waist {
    /// On the mean front.
    pub site: Site,
    /// The direction of the front there. Its +1 side is to the left.
    pub heading: Heading,
    /// The curvature, 1/m. It is positive where the front bends to the left.
    pub curvature: f32,
    /// The standard deviation of the front across its direction, metres.
    pub deviation: f32,
    /// The standard deviation of the direction, radians.
    pub turn_deviation: f32,
}

impl Waist {
    /// The front lies within this of the site with a probability, metres, as for a Gaussian. 0 below 0, and the most
    /// that single precision has for 1.
    pub fn half_width(&self, probability: f64) -> f64 {
        f64::from(self.deviation) * deviations(probability)
    }

    /// The half-width that holds the front with a probability of 0.9, metres.
    pub(crate) fn ninety(&self) -> f32 {
        NINETY * self.deviation
    }

    /// How far along the front a site lies, metres.
    pub(crate) fn ahead(&self, site: Site) -> f32 {
        let [ahead, _] = Unit::of(self.heading).seen(metres(site - self.site));
        ahead
    }

    /// How far to the left of the mean front a site lies, metres.
    pub(crate) fn aside(&self, site: Site) -> f32 {
        let [ahead, left] = Unit::of(self.heading).seen(metres(site - self.site));
        left - 0.5 * self.curvature * ahead * ahead
    }

    /// The direction of the front so many metres ahead, by its curvature.
    pub(crate) fn heading_at(&self, ahead: f32) -> Heading {
        self.heading.turned(angle((self.curvature * ahead).clamp(-MOST_TURN, MOST_TURN)))
    }

    /// The place on the front so many metres ahead, by its curvature. `None` off the lattice.
    pub(crate) fn place_at(&self, ahead: f32) -> Option<Site> {
        // A chord has the direction of the middle of its arc.
        let Unit { x, z } = Unit::of(self.heading_at(0.5 * ahead));
        let [x, z] = [x, z].map(|it| (it * ahead * UNITS_PER_METRE as f32) as i32);
        self.site.step(Vector::new(x, z)?).ok()
    }
}

/// A front is found where its direction has a deviation below this, radians.
const DIRECTED: f32 = 0.5;

impl<const K: usize, const M: usize, const L: usize> Tracker<K, M, L> {
    /// Where the front is known best. Of no meaning before it is found.
    pub fn waist(&self) -> Waist {
        let moments = Moments::of(&self.grid);
        let lay = self.grid.lay;
        let heading = moments.heading(&self.grid);
        let [turns, offsets] = moments.variance;
        let slope = moments.covariance / turns;
        let most = if lay.bend > 0.0 { 0.5 / lay.bend } else { 2_048.0 };
        let ahead = limited(-slope * lay.step / lay.turn, most);
        let left = lay.low + lay.step * (moments.mean[1] + 0.5 * M as f32);
        let left = left + lay.bulge(moments.bend, ahead);
        let along = Unit::of(heading);
        let units = UNITS_PER_METRE as f32;
        let x = (along.x * ahead - along.z * left) * units;
        let z = (along.z * ahead + along.x * left) * units;
        let by = Vector::new(x as i32, z as i32).unwrap_or_default();
        let variance = offsets - slope * moments.covariance;
        Waist {
            site: lay.pivot.step(by).unwrap_or(lay.pivot),
            heading: heading.turned(angle((moments.bend * ahead).clamp(-1.0, 1.0))),
            curvature: moments.bend,
            deviation: lay.step * sqrt(variance),
            turn_deviation: lay.turn * sqrt(turns),
        }
    }

    /// Where the front is known best, if it is found. There it lies within so many metres with 90 %, and its direction
    /// has a deviation below half a radian. With 95 % there is a front.
    pub fn found(&self, within: f32) -> Option<Waist> {
        if self.is_open() || self.share_nowhere() > ABSENT {
            return None;
        }
        let waist = self.waist();
        let is_near = waist.ninety() <= within;
        (is_near && waist.turn_deviation < DIRECTED).then_some(waist)
    }
}

/// Of a Gaussian 90 % lie within so many deviations.
pub(crate) const NINETY: f32 = 1.645;

/// A front is not followed round further than this by its curvature alone, radians.
const MOST_TURN: f32 = 1.5;

/// Within so many deviations of its mean a Gaussian has a probability, to 2 10^-3: by Winitzki's inverse of the error
/// function.
fn deviations(probability: f64) -> f64 {
    const A: f64 = 0.147;
    let rest = 1.0 - probability * probability;
    let log = libm::log(if rest > 1e-15 { rest } else { 1e-15 });
    let half = 2.0 / (core::f64::consts::PI * A) + 0.5 * log;
    let square = 2.0 * (libm::sqrt(half * half - log / A) - half);
    if probability > 0.0 { libm::sqrt(square) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_ahead_lies_on_the_arc() {
        let waist = Waist {
            site: Site::metres([20.0, 0.0]).unwrap(),
            heading: Heading(1 << 30),
            curvature: 0.05,
            deviation: 0.0,
            turn_deviation: 0.0,
        };
        for ahead in [-20.0, -5.0, 1.0, 8.0, 15.0_f32] {
            let site = waist.place_at(ahead).unwrap();
            let [x, z] = [site.x(), site.z()].map(|it| f64::from(it) / 65_536.0);
            let off = libm::hypot(x, z) - 20.0;
            assert!(off.abs() < 0.05 * f64::from(ahead.abs()), "{ahead}: {off}");
        }
    }

    #[test]
    fn widths_are_those_of_a_gaussian() {
        for (probability, exact) in [
            (-1.0, 0.0),
            (0.0, 0.0),
            (0.5, 0.674_490),
            (0.682_689, 1.0),
            (0.9, 1.644_854),
            (0.95, 1.959_964),
            (0.99, 2.575_829),
            (0.999, 3.290_527),
        ] {
            let got = deviations(probability);
            assert!((got - exact).abs() < 4e-3 * exact + 1e-9, "{probability}: {got}");
        }
        assert!(deviations(1.0).is_finite() && deviations(f64::NAN) == 0.0);
    }
}
