//! Dynamics: how an action moves the agent.
//!
//! The general one-step problem has any `phi` and any finite action set. What the search needs of
//! them is here: the actions grouped into [`Ray`]s, cheapest first. [`Unicycle`](crate::unicycle) is
//! the paper's dynamics, [`Holonomic`](crate::holonomic) another.

use crate::action::{Action, ActionGrid, Control};
use crate::direction::Heading;
use crate::lattice::{OffLattice, Site, Vector};

/// Where the agent is and where it faces: the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub struct Pose {
    /// Position.
    pub site: Site,
    /// Heading.
    pub heading: Heading,
}

/// The actions that share a direction of travel from a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ray {
    /// Which ray of the grid.
    pub index: u16,
    /// Heading of travel.
    pub heading: Heading,
    /// Displacement for one step of speed, in 2^-[`STEP_BITS`](Self::STEP_BITS) lattice units.
    pub step: Vector,
    /// The share of `|u|^2` that does not depend on the speed, 10^-6: a turn's square in mrad^2.
    pub effort: u32,
}

impl Ray {
    /// Fractional bits of [`step`](Self::step).
    pub const STEP_BITS: u32 = 8;

    /// Displacement at a speed of the grid, to the nearest lattice units.
    pub const fn displacement(&self, speed: u16) -> Vector {
        const HALF: i32 = 1 << (Ray::STEP_BITS - 1);
        let k = speed as i32;
        // The longest motion, 100 m, is below 2^31 of these units: see ActionGrid::LONGEST_MM.
        Vector {
            x: k.wrapping_mul(self.step.x).wrapping_add(HALF) >> Self::STEP_BITS,
            z: k.wrapping_mul(self.step.z).wrapping_add(HALF) >> Self::STEP_BITS,
        }
    }

    /// The pose after travelling this ray at a speed of the grid.
    ///
    /// # Errors
    /// [`OffLattice`] when that is beyond the lattice.
    pub fn arrive(&self, from: Site, speed: u16) -> Result<Pose, OffLattice> {
        let site = from.step(self.displacement(speed))?;
        Ok(Pose { site, heading: self.heading })
    }
}

/// The agent's known dynamics over its finite action set (Section II-A's `phi` and `U`).
///
/// An action's squared control is its squared reach plus its ray's effort,
/// `|u|^2 = |zeta' - zeta|^2 + effort`: for the unicycle `v^2 + w^2`, for an integrator `v^2`.
pub trait Dynamics {
    /// The action set.
    fn grid(&self) -> ActionGrid;

    /// The rays from a pose in the order in which ties are settled: effort never decreases, and of
    /// equals the preferred one comes first.
    fn rays(&self, pose: Pose) -> impl Iterator<Item = Ray>;

    /// The sharpest turn in place, to the left or right: its action and the pose after it. `None`
    /// when the action set does not depend on the heading.
    fn turn_in_place(&self, pose: Pose, left: bool) -> Option<(Action, Pose)>;

    /// What an action asks of the vehicle.
    fn control(&self, action: Action) -> Control;

    /// The pose after an action; `None` when there is no such action or it leads off the lattice.
    fn target(&self, pose: Pose, action: Action) -> Option<Pose> {
        let (index, speed) = self.grid().split(action);
        let ray = self.rays(pose).find(|ray| ray.index == index)?;
        ray.arrive(pose.site, speed).ok()
    }
}
