//! Where a front is known best.

use crate::belief::front::plane::{Unit, angle, metres};
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

/// Where a front crosses a line that is square to a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// How far to the left of the place, on average, metres.
    pub left: f32,
    /// The standard deviation, metres.
    pub deviation: f32,
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

    /// The standard deviation of the front beside a site, metres: that of its direction counts by the distance.
    pub(crate) fn deviation_beside(&self, site: Site) -> f32 {
        let [x, z] = metres(site - self.site);
        let square = (x * x + z * z) * self.turn_deviation * self.turn_deviation;
        sqrt(self.deviation * self.deviation + square)
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
