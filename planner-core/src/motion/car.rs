//! A car: arcs of at most some curvature, forward only.

use core::num::{NonZeroU32, NonZeroU64};

use crate::geometry::angle::CoarseAngle;
use crate::geometry::approximate::acos;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{LatticeError, UNITS_PER_METRE, Vector};
use crate::motion::action::{Action, ActionGrid, Control, GridError};
use crate::motion::dynamics::{Dynamics, Pose, Ray, RayFan, Side, TurningCircle};
use crate::motion::pivots::HALF;
use crate::motion::unicycle::{STEP_PER_URAD, UNITS_PER_URAD, square_mrad2};

/// A vehicle that drives along circular arcs, forward only, and does not turn on the spot: a car, a ship, an
/// aeroplane.
///
/// A motion is named by its *chord*, the straight line from its beginning to its end: a ray is a chord at an angle
/// `phi` to the heading, a speed is the chord's length `c`. The arc that has both turns the vehicle by `2 phi` in
/// all, with the curvature `2 sin(phi) / c`. So a turning circle of radius `R` allows the chords of length
/// `c >= 2 R sin |phi|`: a shorter motion has fewer rays of the same fan. No chord lies further from the heading than
/// [`SHARPEST`](Self::SHARPEST), an arc of a quarter turn, and none is shorter than the shortest motion.
///
/// Its effort is the square of its whole turn, `(2 phi)^2`; the square of its reach is the chord's, not the arc's.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Car {
    grid: ActionGrid,
    shape: CarShape,
    /// The slowest speed that moves.
    slowest: u16,
    /// Rays to one side of the one ahead.
    turns: u32,
    /// The step of chords as a binary angle with 32 fractional bits.
    step: u64,
    /// The circle that it can go round: its speed and its ray. Then come, in lattice units, its radius and the radius
    /// of the polygon of tangents about it. The last is how far rounding may move it in one round.
    circle_speed: u16,
    circle_turn: u32,
    circle_radius: i32,
    tangents_radius: i32,
    margin: i32,
}

/// What a [`Car`] can do.
///
/// ```
/// use planner_core::{Car, CarShape};
///
/// // A garden tractor: a turning circle of 2 m, motions of 0.5 m to 5 m in steps of 0.25 m, chords 10 mrad apart.
/// let car = Car::new(CarShape {
///     radius_mm: 2_000,
///     shortest_mm: 500,
///     turn_step_urad: 10_000,
///     speeds: 21,
///     speed_step_mm: 250,
/// })?;
/// # Ok::<(), planner_core::error::GridError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename = "Circle"))]
pub struct CarShape {
    /// Radius of the turning circle, millimetres.
    pub radius_mm: u32,
    /// The shortest motion, millimetres.
    pub shortest_mm: u32,
    /// The angle from one chord to the next, microradians.
    pub turn_step_urad: u32,
    /// Number of speeds. It includes the speed 0, although a car never stands still.
    pub speeds: u16,
    /// From one speed to the next, millimetres per unit time.
    pub speed_step_mm: u32,
}

/// One, in the fixed point of the sines here: 29 fractional bits.
const ONE: i32 = 1 << 29;

/// Upper bound on the errors of the arc sine and of the sines together, units of a heading.
const GUARD: u32 = 16;

impl Car {
    /// The greatest angle between heading and chord: an eighth of a turn, whose arc is a quarter turn.
    pub const SHARPEST: Angle = Angle(1 << 29);

    /// Turning circles are smaller than this, millimetres.
    pub const WIDEST_MM: u32 = 2_048_000;

    /// A vehicle goes round its circle by motions that turn by twice this angle, or by the shortest motions. Few are
    /// needed, and the polygon of their tangents is not much wider than the circle.
    pub const CIRCLING: Angle = Angle::of_radians(0.26);

    /// A car of this shape.
    ///
    /// # Errors
    /// [`GridError`].
    pub fn new(shape: CarShape) -> Result<Self, GridError> {
        let CarShape { radius_mm, shortest_mm, turn_step_urad, speeds, speed_step_mm } = shape;
        let grid = ActionGrid::new(1, speeds, speed_step_mm)?;
        if turn_step_urad == 0 || turn_step_urad > 785_398 {
            return Err(GridError::Turn);
        }
        // A grid has a step: nothing divides by zero.
        let step_mm = NonZeroU32::new(speed_step_mm).ok_or(GridError::Circle)?;
        let slowest = (shortest_mm / step_mm + u32::from(shortest_mm % step_mm > 0)).max(1);
        if radius_mm == 0 || radius_mm >= Self::WIDEST_MM || slowest >= u32::from(speeds) {
            return Err(GridError::Circle);
        }
        let step = u64::from(turn_step_urad) * STEP_PER_URAD;
        let mut car = Self {
            grid,
            shape,
            slowest: slowest as u16,
            turns: u32::MAX,
            step,
            circle_speed: 0,
            circle_turn: 0,
            circle_radius: 0,
            tangents_radius: 0,
            margin: 0,
        };
        car.turns = car.turns_at(speeds - 1);
        car.grid = ActionGrid::new(2 * car.turns + 1, speeds, speed_step_mm)?;
        car.find_circle(step_mm)
    }

    /// What it can do.
    pub const fn shape(&self) -> CarShape {
        self.shape
    }

    fn find_circle(mut self, step_mm: NonZeroU32) -> Result<Self, GridError> {
        let CarShape { radius_mm, speeds, .. } = self.shape;
        let (sin, _) = sin_cos(Self::CIRCLING);
        let chord_mm = (2 * u64::from(radius_mm) * sin as u64) >> 29;
        let speed = (chord_mm / NonZeroU64::from(step_mm)) as u32;
        let speed = speed.max(u32::from(self.slowest)).min(u32::from(speeds) - 1) as u16;
        (self.circle_speed, self.circle_turn) = (speed, self.turns_at(speed));
        let turn = self.turn(self.circle_turn);
        let (sin, cos) = sin_cos(turn);
        // With 4 fractional bits.
        let chord = (i64::from(speed) * i64::from(self.grid.step_length())) >> (Ray::STEP_BITS - 4);
        let per = |a: i64, b: i32| (a * i64::from(ONE)).checked_div(i64::from(b));
        // No turn, no circle: nothing divides by it.
        let radius = per(chord, sin).ok_or(GridError::Circle)? >> (4 + 1);
        let tangents = per(radius, cos).ok_or(GridError::Circle)? + 2;
        let rounds = i64::from(u32::MAX / turn.0.max(1) / 2) + 2;
        let margin = rounds * (2 + (i64::from(speed) >> Ray::STEP_BITS));
        if tangents + margin >= MOST {
            return Err(GridError::Circle);
        }
        (self.circle_radius, self.tangents_radius) = (radius as i32, tangents as i32);
        self.margin = margin as i32;
        Ok(self)
    }

    /// The `n`-th chord's angle to the heading.
    const fn turn(&self, n: u32) -> Angle {
        Angle(((n as u64 * self.step + HALF) >> 32) as u32)
    }

    /// Rays to one side of the one ahead, at a speed.
    fn turns_at(&self, speed: u16) -> u32 {
        let limit = u64::from(self.limit(speed).0) + 1;
        // `rest / step` by short divisions, as each plan asks for it thousands of times: they come near it from below.
        let above = NonZeroU32::MIN.saturating_add((self.step >> 32) as u32);
        let (mut rest, mut turns) = ((limit << 32) - HALF - 1, 0_u32);
        while 0 < self.step && self.step <= rest && turns < self.turns {
            let more = ((rest >> 32) as u32 / above).max(1);
            turns = turns.saturating_add(more);
            rest = rest.saturating_sub(u64::from(more) * self.step);
        }
        turns.min(self.turns)
    }

    /// The greatest angle of a chord of this length: the arc sine of `c / 2R`, less its error.
    fn limit(&self, speed: u16) -> Angle {
        let sine = (u64::from(self.grid.reach_mm(speed)) * ONE as u64)
            .checked_div(2 * u64::from(self.shape.radius_mm))
            .unwrap_or(0);
        let (sharpest, _) = sin_cos(Self::SHARPEST);
        if sine >= sharpest as u64 {
            return Self::SHARPEST;
        }
        // A guess that is off by 10^-4 rad, and one step of Newton's.
        let sine = sine as i32;
        let guess = CoarseAngle::QUARTER_TURN - acos(sine as f32 / ONE as f32);
        let guess = guess.turn();
        let (sin, cos) = sin_cos(Angle(guess));
        let off = (i64::from(sine - sin) * i64::from(ONE)).checked_div(cos.into()).unwrap_or(0);
        let off = (off * UNITS_PER_RADIAN) >> 29;
        Angle((i64::from(guess) + off - i64::from(GUARD)).max(0) as u32)
    }
}

/// Sine and cosine, in parts of [`ONE`].
const fn sin_cos(angle: Angle) -> (i32, i32) {
    let Vector { x, z } = angle.unit().scaled(ONE);
    (z, x)
}

/// The tangent of an eighth of a turn at most, in parts of [`ONE`], to one of them.
fn tangent(angle: Angle) -> i32 {
    let (sin, cos) = sin_cos(angle);
    // A guess that is off by 10^-7, and what is left of the division: a long one would take three times as long.
    let guess = (sin as f32 / cos as f32 * ONE as f32) as i32;
    let left = (i64::from(sin) * i64::from(ONE) - i64::from(guess) * i64::from(cos)) >> 8;
    guess.saturating_add((left as i32).checked_div(cos >> 8).unwrap_or(0))
}

/// The arc's length over its chord's: an angle's over its sine, by its square; to 10^-6 up to an eighth of a turn.
fn per_sine(square: f32) -> f32 {
    let rest = 2.1e-4 + square * 2.2e-5;
    1.0 + square * (1.0 / 6.0 + square * (7.0 / 360.0 + square * (31.0 / 15_120.0 + square * rest)))
}

/// A turning circle, and what it needs beside it, is smaller than this, lattice units.
const MOST: i64 = 4_096 * UNITS_PER_METRE as i64;

/// Units of a heading in a radian.
const UNITS_PER_RADIAN: i64 = (UNITS_PER_URAD * 1e6 + 0.5) as i64;

impl Dynamics for Car {
    fn grid(&self) -> ActionGrid {
        self.grid
    }

    fn fan(&self) -> RayFan {
        let spacing = Angle((self.step >> 32) as u32 + 1);
        RayFan { left: self.turns + 1, right: self.turns, spacing }
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        let turn = self.turn(n);
        pose.heading.turned(if side == Side::Left { turn } else { turn.mirrored() })
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        let n = n.min(self.turns);
        let heading = self.heading(pose, side, n);
        let index = if side == Side::Left { self.turns + n } else { self.turns - n };
        let turn_cost = square_mrad2(2 * n * self.shape.turn_step_urad);
        Ray { index, heading, step: heading.unit().scaled(self.grid.step_length()), turn_cost }
    }

    fn rays_at(&self, speed: u16) -> Option<[u32; 2]> {
        Some(if speed < self.slowest {
            [0, 0]
        } else {
            let turns = self.turns_at(speed);
            [turns + 1, turns]
        })
    }

    fn arrive(&self, pose: Pose, ray: &Ray, speed: u16) -> Result<Pose, LatticeError> {
        let site = pose.site.step(ray.displacement(speed))?;
        // The arc turns as far beyond its chord as the chord does from the heading.
        let turn = ray.heading.since(pose.heading);
        Ok(Pose { site, heading: ray.heading.turned(turn) })
    }

    fn tangent_intersection(&self, from: Pose, to: Pose) -> Option<Vector> {
        let turn = to.heading.since(from.heading).0 as i32;
        if turn == 0 {
            return None;
        }
        let chord = to.site - from.site;
        // An eighth of a turn at most, so the tangent is 1 at most.
        let tangent = i64::from(tangent(Angle((turn / 2) as u32)).clamp(-ONE, ONE));
        // Half the chord, and from there to the side that it turns away from.
        let half = |along: i32, aside: i32| {
            ((i64::from(along) * i64::from(ONE) + tangent * i64::from(aside)) >> 30) as i32
        };
        Some(Vector { x: half(chord.x, chord.z), z: half(chord.z, -chord.x) })
    }

    fn turning_circles(&self, pose: Pose) -> Option<[TurningCircle; 2]> {
        let left = pose.heading.unit().left().scaled(self.circle_radius);
        let (radius, margin) = (self.tangents_radius, self.margin);
        let circle = |ray, centre| TurningCircle {
            action: self.grid.action(ray, self.circle_speed),
            centre,
            radius,
            margin,
        };
        let [on_left, on_right] = [self.turns + self.circle_turn, self.turns - self.circle_turn];
        Some([circle(on_left, left), circle(on_right, left.reversed())])
    }

    fn turn_in_place(&self, _: Pose, _: Side) -> Option<(Action, Pose)> {
        None
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (index, speed) = self.grid.split(action);
        let side = if index >= self.turns { Side::Left } else { Side::Right };
        let n = index.abs_diff(self.turns);
        let exists = speed >= self.slowest && n <= self.turns_at(speed);
        exists.then(|| self.ray(pose, side, n))
    }

    /// The arc's length, and the whole turn along it.
    fn control(&self, _: Pose, action: Action) -> Control {
        let (ray, speed) = self.grid.split(action);
        let n = ray.abs_diff(self.turns).min(self.turns);
        let phi = (n * self.shape.turn_step_urad) as f32 / 1e6;
        let longer = per_sine(phi * phi);
        let turn_rad = if ray < self.turns { -2.0 * phi } else { 2.0 * phi };
        Control { distance_m: longer * self.grid.reach_m(speed), turn_rad }
    }
}

#[cfg(test)]
mod tests {
    use super::{ONE, tangent};
    use crate::geometry::heading::Angle;

    #[test]
    fn the_tangent_is_that_of_libm() {
        for n in 0..=1_000_u32 {
            let angle = Angle((n << 19) + 37 * n);
            for (angle, sign) in [(angle, 1.0), (angle.mirrored(), -1.0)] {
                let exact = sign * libm::tan(angle.radians().abs()) * f64::from(ONE);
                assert!((f64::from(tangent(angle)) - exact).abs() < 8.0, "{angle:?}");
            }
        }
    }
}
