//! How a front goes on from a robot: freely, beyond a keep-out, or out of the area.

use crate::belief::front::Waist;
use crate::geometry::approximate::METRE;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::Pose;

/// A keep-out on the front is passed if it is no longer than so many reaches.
const BEYOND: u16 = 10;

/// How the front goes on.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Onward {
    /// The robot may go on along it.
    Free,
    /// A keep-out lies on it, and here it is free again.
    Beyond(Site),
    /// It leaves the area.
    Over,
}

/// Which way the robot goes along the front.
pub(crate) struct Aim {
    pub(crate) waist: Waist,
    is_along: bool,
}

impl Aim {
    pub(crate) const fn new(waist: Waist, is_along: bool) -> Self {
        Self { waist, is_along }
    }

    /// The first place on the front in an area, from so many reaches ahead of a pose on.
    pub(crate) fn first_free<G: Workspace>(
        &self,
        (area, reach): (&G, f32),
        pose: Pose,
        from: u16,
    ) -> Option<Site> {
        let reach = reach * METRE;
        let reach = if self.is_along { reach } else { -reach };
        let beside = self.waist.ahead(pose.site);
        let place = |k: u16| self.waist.place_at(beside + f32::from(k) * reach);
        // Beyond the border it does not come back: an arc that bends so is a guess.
        let bounds = area.bounds();
        let mut within = (from..=BEYOND).map_while(place).take_while(|it| bounds.contains(*it));
        within.find(|site| area.contains(*site))
    }

    /// How the front goes on from a pose, for motions of up to a reach. A vehicle looks so many reaches ahead for keep-outs.
    pub(crate) fn onward<G: Workspace>(&self, with: (&G, f32), pose: Pose, look: u16) -> Onward {
        let free = |from: u16| self.first_free(with, pose, from);
        // The first place that is free from one on is another one than that from the next on, unless it lies beyond.
        let blocked = (1..=look).find(|k| free(*k) == free(k + 1));
        match blocked.map(|k| (k, free(k))) {
            Some((_, Some(site))) => Onward::Beyond(site),
            Some((1, None)) => Onward::Over,
            _ => Onward::Free,
        }
    }
}
