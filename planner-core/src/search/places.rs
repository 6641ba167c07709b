//! The ends of motions at which a front is as likely to lie on one side as on the other.
//!
//! On each of some circles the search looks at a few rays of the fan. Where the share of the curves above crosses one
//! half between two of them, false position comes near to it. Each end that the vehicle may go to is handed on with
//! its share. Where less is learnt an end may still be worth more. So the search may look beside the best one at last.

use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, Ray, Side, room_for_errors};
use crate::search::motions::Leg;

/// Gaps between the rays of a circle that are looked at first.
const GAPS: u32 = 12;

/// Rays of a circle that are looked at between two of these.
const CLOSER: u32 = 5;

/// A share is as good as one half when it is this near to it.
const NEAR_HALF: f32 = 0.03;

/// The search looks so far to either side of the best end first, as an angle between rays: 12 degrees.
const BESIDE: u32 = 0x0888_8889;

/// A ray, numbered from the right to the left with 0 straight ahead, and the share above its end, less one half.
#[derive(Clone, Copy)]
pub(crate) struct Probe {
    pub(crate) ray: i64,
    pub(crate) off: f32,
}

/// The first ray of a speed, and how many others it has. `None` if it has none to the left.
pub(crate) fn rays<D: Dynamics>(dynamics: &D, speed: u16) -> Option<(i64, u32)> {
    let fan = dynamics.fan();
    let [left, right] = dynamics.rays_at(speed).unwrap_or([fan.left, fan.right]);
    Some((-i64::from(right), left.checked_sub(1)?.saturating_add(right)))
}

/// The ray of a number.
pub(crate) fn ray<D: Dynamics>(dynamics: &D, pose: Pose, number: i64) -> Ray {
    let side = if number < 0 { Side::Right } else { Side::Left };
    dynamics.ray(pose, side, number.unsigned_abs() as u32)
}

/// What looks at ends: the vehicle, the area, the share above a place, and what each end is handed to. It says whether the
/// end is the best so far.
pub(crate) struct EndSearch<'a, D, G, S, F> {
    pub(crate) dynamics: &'a D,
    pub(crate) area: &'a G,
    pub(crate) pose: Pose,
    pub(crate) share: S,
    pub(crate) find: F,
    /// The ray and the speed of the best end.
    pub(crate) best: Option<(i64, u16)>,
    /// The ends looked at, and how many may be.
    pub(crate) examined: u32,
    pub(crate) most: u32,
}

impl<D: Dynamics, G: Workspace, S: Fn(Pose) -> f32, F: FnMut(Leg, f32) -> bool>
    EndSearch<'_, D, G, S, F>
{
    /// Looks at the ends of one speed. `None` if that ends early: no more may be looked at, or one lies off the
    /// lattice.
    pub(crate) fn circle(&mut self, speed: u16) -> Option<()> {
        let (first, count) = rays(self.dynamics, speed)?;
        let gaps = if count < GAPS { count } else { GAPS };
        let mut before = self.ask(first, speed)?;
        for gap in 1..=gaps {
            let offset = u64::from(count) * u64::from(gap) / u64::from(gaps);
            let after = self.ask(first + offset as i64, speed)?;
            if (before.off < 0.0) != (after.off < 0.0) {
                self.close_in(speed, [before, after])?;
            }
            before = after;
        }
        Some(())
    }

    /// Looks on either side of the best end so many times, each half as far away. `None` if that ends early.
    pub(crate) fn beside_best(&mut self, times: u32) -> Option<()> {
        let mut by = i64::from(BESIDE.checked_div(self.dynamics.fan().spacing.0)?);
        for _ in 0..times {
            let (ray, speed) = self.best.filter(|_| by > 0)?;
            let (first, count) = rays(self.dynamics, speed)?;
            self.ask((ray - by).max(first), speed)?;
            self.ask((ray + by).min(first + i64::from(count)), speed)?;
            by /= 2;
        }
        Some(())
    }

    fn ask(&mut self, number: i64, speed: u16) -> Option<Probe> {
        if self.examined >= self.most {
            return None;
        }
        let ray = ray(self.dynamics, self.pose, number);
        let target = self.dynamics.arrive(self.pose, &ray, speed).ok()?;
        let share = (self.share)(target);
        self.examined += 1;
        let room = room_for_errors(self.area);
        if self.area.contains(target.site)
            && self.dynamics.keeps_inside(self.pose, target, self.area, room)
        {
            let leg = (self.dynamics.grid().action(ray.index, speed), target);
            if (self.find)(leg, share) {
                self.best = Some((number, speed));
            }
        }
        Some(Probe { ray: number, off: share - 0.5 })
    }

    fn close_in(&mut self, speed: u16, [mut a, mut b]: [Probe; 2]) -> Option<()> {
        let (mut off_a, mut off_b) = (a.off, b.off);
        for _ in 0..CLOSER {
            if b.ray - a.ray < 2 {
                break;
            }
            let part = (off_a / (off_a - off_b)).clamp(0.02, 0.98);
            let ahead = (part * (b.ray - a.ray) as u32 as f32) as u32;
            let middle = (a.ray + i64::from(ahead)).max(a.ray + 1).min(b.ray - 1);
            let probe = self.ask(middle, speed)?;
            if probe.off.abs() < NEAR_HALF {
                break;
            }
            // The method of Illinois: an end that stays counts half.
            if (probe.off < 0.0) == (a.off < 0.0) {
                (a, off_a, off_b) = (probe, probe.off, 0.5 * off_b);
            } else {
                (b, off_b, off_a) = (probe, probe.off, 0.5 * off_a);
            }
        }
        Some(())
    }
}
