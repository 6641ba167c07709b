//! A lap round a closed front: which way the robot goes along it, and whether it is back where it began.

use crate::belief::front::Waist;
use crate::geometry::approximate::distance;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;
use crate::motion::dynamics::Pose;

/// A front is closed when it has turned by this, three quarters of a turn, and is back; in units of 2^-32 turns.
const TURNED: i64 = 3 << 30;

/// Back is within so many reaches of where the front was found.
const BACK: f32 = 1.0;

/// The way along a front since it was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lap {
    /// Where it was found, whether the robot goes along its direction, and the direction it had last.
    begun: Option<(Site, bool, Heading)>,
    /// How far it has turned since, to the left.
    turned: i64,
    is_closed: bool,
}

impl Lap {
    /// No front is found.
    pub(crate) const NONE: Self = Self { begun: None, turned: 0, is_closed: false };

    /// Whether the robot goes along the front's direction; `None` before it is found.
    pub(crate) fn sense(&self) -> Option<bool> {
        self.begun.map(|(_, sense, _)| sense)
    }

    /// The robot goes on in the other direction.
    pub(crate) fn turn(&mut self) {
        self.begun = self.begun.map(|(site, sense, heading)| (site, !sense, heading));
    }

    /// Whether the robot has been all around.
    pub(crate) const fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Takes in where the front is known best, if it is found.
    pub(crate) fn observe(&mut self, found: Option<Waist>, pose: Pose, reach: f32) {
        let Some(Waist { site, heading, .. }) = found else { return };
        let Some((start, sense, last)) = self.begun else {
            self.begun = Some((site, pose.heading.agrees(heading), heading));
            return;
        };
        self.turned += i64::from(heading.since(last).0 as i32);
        self.begun = Some((start, sense, heading));
        let is_back = distance(site - start) < BACK * reach;
        self.is_closed |= is_back && self.turned.abs() >= TURNED;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waists on a circle, and on an eight that comes back without a full turn.
    #[test]
    fn a_circle_closes_and_an_eight_does_not() {
        let waist = |x: f64, z: f64, angle: f64| Waist {
            site: Site::metres([x, z]).unwrap(),
            heading: Heading::from_radians(angle).unwrap(),
            curvature: 0.0,
            deviation: 0.1,
            turn_deviation: 0.01,
        };
        let reach = 2.0 * 65_536.0;
        for is_circle in [true, false] {
            let mut lap = Lap::NONE;
            for step in 0..=72_u32 {
                let angle = f64::from(step) * core::f64::consts::PI / 36.0;
                let (sin, cos) = libm::sincos(angle);
                let it = if is_circle {
                    waist(20.0 * sin, -20.0 * cos, angle)
                } else {
                    waist(
                        20.0 * sin,
                        10.0 * libm::sin(2.0 * angle),
                        libm::atan2(libm::cos(2.0 * angle), cos),
                    )
                };
                assert!(!lap.is_closed(), "{step}");
                lap.observe(Some(it), Pose { site: it.site, heading: Heading(1 << 31) }, reach);
                if step == 68 {
                    lap.observe(None, Pose { site: it.site, heading: it.heading }, reach);
                }
                if lap.is_closed() {
                    assert!(is_circle && step > 70, "{step}");
                    break;
                }
            }
            assert_eq!(lap.is_closed(), is_circle);
            assert_eq!(lap.sense(), Some(false));
        }
    }
}
