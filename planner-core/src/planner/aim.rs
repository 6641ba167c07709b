//! Which way a front goes on from a robot, and where a vehicle would have turned along it again.

use crate::belief::front::{Unit, Waist};
use crate::geometry::approximate::{METRE, sqrt};
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::Pose;
use crate::planner::scout::FOUND;

/// Where the front would not count as found, progress counts so much the other way: the robot rather goes back.
const BACK: f32 = 0.02;

/// A vehicle that goes along the front is to stay within this share of its half-width.
const LANE: f32 = 0.5;

/// A keep-out on the front is passed if it is no longer than so many reaches.
const BEYOND: u16 = 10;

/// Radians in a unit of an angle.
const RADIAN: f32 = core::f32::consts::PI / (1_u32 << 31) as f32;

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
    heading: Heading,
    along: Unit,
}

/// Where a vehicle faces along the front again, if it turns from a pose as tightly as it can; and its way there.
pub(crate) struct Turned {
    pub(crate) site: Site,
    pub(crate) way: f32,
}

impl Aim {
    pub(crate) fn new(waist: Waist, pose: Pose, is_along: bool) -> Self {
        let forwards = waist.heading_at(waist.ahead(pose.site));
        let heading = if is_along { forwards } else { forwards.turned(Angle::HALF_TURN) };
        Self { waist, is_along, heading, along: Unit::of(heading) }
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

    /// Where a vehicle that is at a pose will have turned, on a circle of this radius: for one that turns on the spot, where
    /// it is.
    pub(crate) fn turned(&self, pose: Pose, radius: f32) -> Turned {
        let off = pose.heading.since(self.heading);
        let Unit { x: cos, z: sin } = Unit::of(Heading(off.0));
        let (ahead, aside) = (radius * sin.abs(), radius * (1.0 - cos));
        let aside = if sin < 0.0 { -aside } else { aside };
        let Unit { x, z } = self.along;
        let by = Vector::new((ahead * x - aside * z) as i32, (ahead * z + aside * x) as i32);
        let site = by.and_then(|by| pose.site.step(by).ok()).unwrap_or(pose.site);
        Turned { site, way: radius * (off.0 as i32).unsigned_abs() as f32 * RADIAN }
    }

    /// The way on which a vehicle shifts back to the front from a place, where that lies too far aside: two arcs of a
    /// circle of this radius, lattice units. `half` is the front's half-width there, metres.
    pub(crate) fn shift(&self, site: Site, half: f32, radius: f32) -> f32 {
        let aside = self.waist.aside(site).abs() - LANE * half;
        // Two arcs that turn by an angle t go aside by 2 R (1 - cos t), and are 2 R t long.
        2.0 * sqrt(if aside > 0.0 { radius * aside * UNITS_PER_METRE as f32 } else { 0.0 })
    }

    /// The progress of a way that ends where the front has this half-width, lattice units. It counts less where the front
    /// is not known well, and not at all where it is hardly known. A robot with poor labels would otherwise run ahead of
    /// what it knows.
    pub(crate) fn progress(&self, way: Vector, half: f32, (span, full): (f32, f32)) -> f32 {
        let counts = match half * UNITS_PER_METRE as f32 / span {
            width if width <= full => 1.0,
            width if width <= FOUND => (FOUND / width - 1.0) / (FOUND / full - 1.0),
            _ => -BACK,
        };
        let progress = way.x as f32 * self.along.x + way.z as f32 * self.along.z;
        counts * progress
    }
}
