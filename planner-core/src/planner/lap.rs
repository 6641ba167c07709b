//! The way along a front: whether the robot is back where it began, and how often the front led out of the area.
//!
//! It goes along the front as it faced at the start. So two robots that start back to back part.

use crate::belief::front::Waist;
use crate::geometry::heading::Heading;
use crate::geometry::hull::Extent;
use crate::motion::dynamics::Pose;

/// A front is closed when it has turned by this, three quarters of a turn, and is back; in units of 2^-32 turns.
const TURNED: i64 = 3 << 30;

/// Back is within so many reaches of where the front was found, and beside it as far as the front may lie off there.
const BACK: f32 = 1.0;

/// The way along a front since it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Lap {
    /// Where the robot faced at the start: that way it goes along the front.
    faced: Option<Heading>,
    /// Where it was found, and the direction it had last.
    begun: Option<(Waist, Heading)>,
    /// Steps since.
    steps: u32,
    /// How far it has turned since, to the left.
    turned: i64,
    is_closed: bool,
    /// How often it led out of the area.
    borders: u8,
    /// Whether the robot drives back to where it was found.
    is_back: bool,
    /// Whether later labels have told better where that is.
    is_settled: bool,
    /// Where it was found so far.
    extent: Extent,
}

impl Lap {
    /// No front is found.
    pub(crate) const NONE: Self = Self {
        faced: None,
        begun: None,
        steps: 0,
        turned: 0,
        is_closed: false,
        borders: 0,
        is_back: false,
        is_settled: false,
        extent: Extent::NONE,
    };

    /// Whether a mission can have turned so far.
    pub(crate) const fn is_possible(&self) -> bool {
        self.turned.unsigned_abs() < 1 << 62
    }

    /// Takes in where the robot faces. Whether this was the first time: what comes after does not count.
    pub(crate) fn face(&mut self, heading: Heading) -> bool {
        let is_first = self.faced.is_none();
        self.faced.get_or_insert(heading);
        is_first
    }

    /// Where the robot faced at the start, if that was before this pose.
    pub(crate) fn faced(&self, pose: Pose) -> Heading {
        self.faced.unwrap_or(pose.heading)
    }

    /// Where the robot drives back to, if it does.
    pub(crate) fn back(&self) -> Option<Waist> {
        self.begun.map(|it| it.0).filter(|_| self.is_back)
    }

    /// It goes on from there, or from where it is.
    pub(crate) const fn arrive(&mut self) {
        self.is_back = false;
    }

    /// Steps since the front was found.
    pub(crate) const fn age(&self) -> f32 {
        self.steps as f32
    }

    /// The front leaves the area. The first time the robot drives back to where it was found, if that is still near.
    pub(crate) const fn turn(&mut self, is_near: bool) {
        self.is_back = is_near && self.borders == 0;
        self.borders = self.borders.saturating_add(1);
    }

    /// Where the front was found.
    pub(crate) const fn extent(&self) -> Extent {
        self.extent
    }

    /// Along the next front it goes as it faced at the start, too.
    pub(crate) const fn begin_again(&mut self) {
        *self = Self { faced: self.faced, ..Self::NONE };
    }

    /// Whether the robot has been all around.
    pub(crate) const fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Whether the robot has gone along all of the front: it is closed, or led out of the area twice.
    pub(crate) const fn is_over(&self) -> bool {
        self.is_closed || self.borders >= 2
    }

    /// Takes in where the front is beside the robot, if it is found. It may have moved by so many metres since it was
    /// found first; a reach has so many.
    pub(crate) fn observe(&mut self, found: Option<Waist>, (reach, moved): (f32, f32)) {
        self.steps = self.steps.saturating_add(1);
        let Some(waist) = found else { return };
        self.extent = self.extent.with(waist.site);
        let Some((begun, last)) = &mut self.begun else {
            (self.begun, self.steps) = (Some((waist, waist.heading)), 0);
            return;
        };
        self.turned += i64::from(waist.heading.since(*last).0 as i32);
        *last = waist.heading;
        let [ahead, aside] = [begun.ahead(waist.site), begun.aside(waist.site)].map(f32::abs);
        let off = BACK * reach + begun.ninety() + waist.ninety() + moved;
        self.is_closed |= ahead < BACK * reach && aside < off && self.turned.abs() >= TURNED;
    }

    /// Takes in the first place of the map, as it is known once labels change it no more.
    pub(crate) fn settle(&mut self, first: Waist) {
        if let Some((begun, _)) = &mut self.begun
            && !core::mem::replace(&mut self.is_settled, true)
        {
            *begun = first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::lattice::Site;

    fn waist(x: f64, z: f64, angle: f64) -> Waist {
        Waist {
            site: Site::metres([x, z]).unwrap(),
            heading: Heading::from_radians(angle).unwrap(),
            curvature: 0.0,
            deviation: 0.1,
            turn_deviation: 0.01,
        }
    }

    /// A reach, and how far the front has moved.
    const STILL: (f32, f32) = (2.0, 0.0);

    /// Against the front's direction, and lost for a while.
    #[test]
    fn a_circle_closes_when_the_robot_is_back() {
        let mut lap = Lap::NONE;
        let closed = (0..=72_u32).find(|step| {
            let angle = -f64::from(*step) * core::f64::consts::PI / 36.0;
            let (sin, cos) = libm::sincos(angle);
            let it = waist(20.0 * sin, -20.0 * cos, angle);
            lap.observe((*step != 30).then_some(it), STILL);
            lap.is_closed()
        });
        assert_eq!((closed, lap.is_over()), (Some(71), true));
    }

    /// Before it finds the front it may turn any way.
    #[test]
    fn it_goes_the_way_that_it_faced_at_the_start() {
        let mut lap = Lap::NONE;
        for faced in [0.3, 1.0, 4.0] {
            lap.face(Heading::from_radians(faced).unwrap());
        }
        let pose = Pose { site: Site::ORIGIN, heading: Heading(0) };
        assert_eq!(lap.faced(pose), Heading::from_radians(0.3).unwrap());
        assert_eq!(Lap::NONE.faced(pose), pose.heading);
    }

    #[test]
    fn it_drives_back_from_the_first_border_and_is_over_at_the_second() {
        let mut lap = Lap::NONE;
        lap.observe(Some(waist(1.0, 2.0, 0.0)), STILL);
        lap.turn(true);
        assert!(lap.back() == Some(waist(1.0, 2.0, 0.0)) && !lap.is_over());
        lap.arrive();
        lap.turn(true);
        assert!(lap.back().is_none() && lap.is_over());
        // One that moves has left that place.
        let mut moved = Lap { borders: 0, ..lap };
        moved.turn(false);
        assert!(moved.back().is_none());
    }

    /// The front goes out, turns round and comes back beside itself.
    #[test]
    fn a_bay_does_not_close() {
        let mut lap = Lap::NONE;
        let out = (0..10).map(|k| waist(2.0 * f64::from(k), 0.0, 0.0));
        let back =
            (0..12).map(|k| waist(20.0 - 2.0 * f64::from(k), 1.5, core::f64::consts::PI - 0.01));
        for it in out.chain([waist(20.0, 0.7, 1.5)]).chain(back) {
            lap.observe(Some(it), STILL);
            assert!(!lap.is_closed());
        }
    }
}
