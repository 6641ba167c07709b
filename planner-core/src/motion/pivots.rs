//! Vehicles that turn on the spot, then drive straight on.

use crate::geometry::heading::{Angle, Heading};
use crate::motion::action::{Action, ActionGrid, Control};
use crate::motion::dynamics::{Dynamics, Pose, Ray, RayFan, Side};

/// A vehicle that turns on the spot, equally far to either side, then drives straight on. It implements [`Dynamics`] by
/// this trait alone.
///
/// The grid has a ray for each turn to the right, one straight ahead, and one for each turn to the left: an odd number.
/// They are counted from the sharpest turn to the right to the sharpest to the left.
pub trait Pivots {
    /// The action set.
    fn grid(&self) -> ActionGrid;

    /// The `n`-th turn to a side. The 0th is none, each is larger than the one before, and the last is half a turn at
    /// most.
    fn turn(&self, n: u32) -> Angle;

    /// The angle from one turn to the next, at most. By default all are as far apart as the first two.
    fn spacing(&self) -> Angle {
        self.turn(1)
    }

    /// The square of the `n`-th turn, mrad^2: what it adds to `|u|^2`. It never decreases.
    fn turn_cost(&self, n: u32) -> u32 {
        square_mrad2_of(self.turn(n))
    }

    /// The `n`-th turn in the vehicle's [`Control`], radians.
    fn turn_rad(&self, n: u32) -> f32 {
        self.turn(n).0 as f32 * RADIANS_PER_UNIT
    }
}

/// The square of an angle of half a turn at most, mrad^2, to the nearest or nearly.
pub(super) const fn square_mrad2_of(angle: Angle) -> u32 {
    // With 16 fractional bits.
    let mrad = (angle.0 as u64 * MRAD_PER_UNIT) >> 32;
    ((mrad * mrad + HALF) >> 32) as u32
}

/// A unit of an angle in milliradians, with 48 fractional bits.
const MRAD_PER_UNIT: u64 = (core::f64::consts::TAU * 1e3 * 65_536.0 + 0.5) as u64;

/// A unit of an angle in radians.
pub(super) const RADIANS_PER_UNIT: f32 = (core::f64::consts::TAU / 4_294_967_296.0) as f32;

/// One half with 32 fractional bits.
pub(super) const HALF: u64 = 1 << 31;

/// Turns to one side.
const fn turns(grid: ActionGrid) -> u32 {
    grid.rays() / 2
}

impl<P: Pivots> Dynamics for P {
    fn grid(&self) -> ActionGrid {
        Pivots::grid(self)
    }

    fn fan(&self) -> RayFan {
        let right = turns(Pivots::grid(self));
        RayFan { left: right + 1, right, spacing: self.spacing() }
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        let turn = self.turn(n);
        pose.heading.turned(if side == Side::Left { turn } else { turn.mirrored() })
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        let grid = Pivots::grid(self);
        let turns = turns(grid);
        let n = n.min(turns);
        let (heading, turn_cost) = (self.heading(pose, side, n), self.turn_cost(n));
        let index = if side == Side::Left { turns + n } else { turns - n };
        Ray { index, heading, step: heading.unit().scaled(grid.step_length()), turn_cost }
    }

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        let grid = Pivots::grid(self);
        let ray = self.ray(pose, side, turns(grid));
        Some((grid.action(ray.index, 0), Pose { heading: ray.heading, ..pose }))
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let grid = Pivots::grid(self);
        let ((index, _), turns) = (grid.split(action), turns(grid));
        let side = if index >= turns { Side::Left } else { Side::Right };
        (index < grid.rays()).then(|| self.ray(pose, side, index.abs_diff(turns)))
    }

    fn control(&self, _: Pose, action: Action) -> Control {
        let grid = Pivots::grid(self);
        let ((ray, speed), turns) = (grid.split(action), turns(grid));
        let turn = self.turn_rad(ray.abs_diff(turns).min(turns));
        let turn_rad = if ray < turns { -turn } else { turn };
        Control { distance_m: grid.reach_m(speed), turn_rad }
    }
}
