//! A lap round a closed front: which way the robot goes along it, and whether it is back where it began.
//!
//! It goes along the front as it faced at the start. So two robots that start back to back part.

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
    /// Where the robot faced at the start: that way it goes along the front.
    faced: Option<Heading>,
    /// Where it was found, whether the robot goes along its direction, and the direction it had last.
    begun: Option<(Site, bool, Heading)>,
    /// How far it has turned since, to the left.
    turned: i64,
    is_closed: bool,
}

impl Lap {
    /// No front is found.
    pub(crate) const NONE: Self = Self { faced: None, begun: None, turned: 0, is_closed: false };

    /// Whether a mission can have turned so far.
    pub(crate) const fn is_possible(&self) -> bool {
        self.turned.unsigned_abs() < 1 << 62
    }

    /// Takes in where the robot faces; what comes after the first time does not count.
    pub(crate) fn face(&mut self, heading: Heading) {
        self.faced.get_or_insert(heading);
    }

    /// Whether the robot goes along the front's direction; `None` before it is found.
    pub(crate) fn sense(&self) -> Option<bool> {
        self.begun.map(|(_, sense, _)| sense)
    }

    /// The same as soon as it is found.
    pub(crate) fn sense_along(&self, waist: Waist, pose: Pose) -> bool {
        let faced = self.faced.unwrap_or(pose.heading);
        self.sense().unwrap_or_else(|| faced.agrees(waist.heading))
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
        let Some(waist @ Waist { site, heading, .. }) = found else { return };
        let Some((start, sense, last)) = self.begun else {
            self.begun = Some((site, self.sense_along(waist, pose), heading));
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

    fn waist(x: f64, z: f64, angle: f64) -> Waist {
        Waist {
            site: Site::metres([x, z]).unwrap(),
            heading: Heading::from_radians(angle).unwrap(),
            curvature: 0.0,
            deviation: 0.1,
            turn_deviation: 0.01,
        }
    }

    const REACH: f32 = 2.0 * 65_536.0;

    /// Against the front's direction, and lost for a while.
    #[test]
    fn a_circle_closes_when_the_robot_is_back() {
        let mut lap = Lap::NONE;
        assert_eq!(lap.sense(), None);
        let closed = (0..=72_u32).find(|step| {
            let angle = -f64::from(*step) * core::f64::consts::PI / 36.0;
            let (sin, cos) = libm::sincos(angle);
            let it = waist(20.0 * sin, -20.0 * cos, angle);
            let pose = Pose { site: it.site, heading: Heading(1 << 31) };
            lap.observe((*step != 30).then_some(it), pose, REACH);
            lap.is_closed()
        });
        assert_eq!((closed, lap.sense()), (Some(71), Some(false)));
        lap.turn();
        assert_eq!((lap.is_closed(), lap.sense()), (true, Some(true)));
    }

    /// Before it finds the front it may turn any way.
    #[test]
    fn it_goes_the_way_that_it_faced_at_the_start() {
        for (angle, sense) in [(0.3, true), (3.3, false)] {
            let mut lap = Lap::NONE;
            for faced in [angle, 1.0, 4.0] {
                lap.face(Heading::from_radians(faced).unwrap());
            }
            let it = waist(0.0, 0.0, 0.0);
            lap.observe(Some(it), Pose { site: it.site, heading: it.heading }, REACH);
            assert_eq!(lap.sense(), Some(sense), "{angle}");
        }
    }

    /// The front goes out, turns round and comes back beside itself.
    #[test]
    fn a_bay_does_not_close() {
        let mut lap = Lap::NONE;
        let out = (0..10).map(|k| waist(2.0 * f64::from(k), 0.0, 0.0));
        let back =
            (0..12).map(|k| waist(20.0 - 2.0 * f64::from(k), 1.5, core::f64::consts::PI - 0.01));
        for it in out.chain([waist(20.0, 0.7, 1.5)]).chain(back) {
            lap.observe(Some(it), Pose { site: it.site, heading: it.heading }, REACH);
            assert!(!lap.is_closed());
        }
        assert_eq!(lap.sense(), Some(true));
    }
}
