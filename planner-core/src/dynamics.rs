//! Dynamics: how an action moves the agent.
//!
//! The general one-step problem has any `phi` and any finite action set. What the search needs of
//! them is here: the actions grouped into [`Ray`]s, which lie as a [`Fan`]. [`Unicycle`](crate::unicycle) is
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

/// To which side of straight ahead a ray lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Side {
    /// Counter-clockwise. Straight ahead counts here.
    Left,
    /// Clockwise.
    Right,
}

/// How the rays from a pose lie: to each side they turn away in equal steps, the last of them maybe in
/// a smaller one, and their effort never decreases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fan {
    /// Rays to the left, from the 0th, straight ahead.
    pub left: u16,
    /// Rays to the right, from the 1st.
    pub right: u16,
    /// The step from one to the next, at most.
    pub spacing: Heading,
}

/// The agent's known dynamics over its finite action set (Section II-A's `phi` and `U`).
///
/// An action's squared control is its squared reach plus its ray's effort,
/// `|u|^2 = |zeta' - zeta|^2 + effort`: for the unicycle `v^2 + w^2`, for an integrator `v^2`.
pub trait Dynamics {
    /// The action set.
    fn grid(&self) -> ActionGrid;

    /// How the rays lie.
    fn fan(&self) -> Fan;

    /// The heading of the `n`-th ray to a side of the fan.
    fn heading(&self, pose: Pose, side: Side, n: u16) -> Heading;

    /// The `n`-th ray to a side of the fan.
    fn ray(&self, pose: Pose, side: Side, n: u16) -> Ray;

    /// The rays from a pose in the order in which ties are settled: by number, left before right.
    fn rays(&self, pose: Pose) -> impl Iterator<Item = Ray> {
        let Fan { left, right, .. } = self.fan();
        (0..left.max(right + 1)).flat_map(move |n| {
            let on_left = (n < left).then(|| self.ray(pose, Side::Left, n));
            let on_right = (1..=right).contains(&n).then(|| self.ray(pose, Side::Right, n));
            on_left.into_iter().chain(on_right)
        })
    }

    /// The ray whose heading is nearest to this one.
    fn towards(&self, pose: Pose, heading: Heading) -> Ray {
        let Fan { left, right, spacing } = self.fan();
        let turn = heading.0.wrapping_sub(self.heading(pose, Side::Left, 0).0);
        let nearest = |turn: u32| (turn.saturating_add(spacing.0 / 2) / spacing.0.max(1)) as u16;
        if turn < 1 << 31 || right == 0 {
            self.ray(pose, Side::Left, nearest(turn).min(left.saturating_sub(1)))
        } else {
            self.ray(pose, Side::Right, nearest(turn.wrapping_neg()).clamp(1, right))
        }
    }

    /// The sharpest turn in place, to the left or right: its action and the pose after it. `None`
    /// when the action set does not depend on the heading.
    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)>;

    /// What an action asks of the vehicle.
    fn control(&self, action: Action) -> Control;

    /// The ray to which an action belongs.
    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray>;

    /// The pose after an action; `None` when there is no such action or it leads off the lattice.
    fn target(&self, pose: Pose, action: Action) -> Option<Pose> {
        let (_, speed) = self.grid().split(action);
        self.ray_of(pose, action)?.arrive(pose.site, speed).ok()
    }
}
