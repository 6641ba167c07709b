//! The search for the places where a label is expected to tell the most.
//!
//! A label tells most where it is as likely to be +1 as -1. These places form a curve. On each of some circles the
//! search evaluates a few rays of the fan: the share of the lines that have the ray's end on their +1 side. If two
//! neighbouring rays lie on different sides of one half, false position finds the ray between them that is nearest to
//! one half. Every evaluated place is a prospect.

use core::num::NonZeroU32;

use heapless::{Vec, VecView};

use crate::belief::cells::CellView;
use crate::belief::predictions::Prediction;
use crate::geometry::lattice::UNITS_PER_METRE;
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side, room_for_errors};
use crate::search::objective::EffortWeight;
use crate::search::places::{Probe, ray, rays};

/// Rays of a circle that are asked first are a twelfth of a turn apart, about.
const PROBES_PER_TURN: u32 = 12;

/// A share is as good as one half when it is this near to it.
const NEAR_HALF: f32 = 0.02;

/// False position goes at least this share of the way from either end.
const LEAST_STEP: f32 = 1.0 / 64.0;

/// Few prospects are at least so far apart, lattice units: 25 cm.
const APART: i64 = UNITS_PER_METRE as i64 / 4;

/// Of many, each lies at least so far from the others, as a share of the usual reach.
const PART: f32 = 0.125;

/// The speeds of the circles that are looked at, so many up to one speed.
#[derive(Clone, Copy)]
pub(crate) enum Circles {
    Even(u16),
    /// Closer together inside: their speeds grow as squares do.
    Squares(u16),
}

impl Circles {
    /// The speeds, the lowest first.
    fn speeds(self, fastest: u16) -> impl Iterator<Item = u16> {
        let (Self::Even(count) | Self::Squares(count)) = self;
        let fastest = u32::from(fastest);
        let count = NonZeroU32::new(u32::from(count).min(fastest)).unwrap_or(NonZeroU32::MIN);
        (1..=count.get()).map(move |k| {
            let (part, all) = match self {
                Self::Even(_) => (k, count),
                Self::Squares(_) => (k * k, count.saturating_mul(count)),
            };
            ((fastest * part + all.get() - 1) / all) as u16
        })
    }
}

/// A motion that may be made, and what the label at its end is worth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Prospect {
    pub(crate) action: Action,
    pub(crate) target: Pose,
    /// The share of the lines that have its end on their +1 side.
    pub(crate) share: f32,
    /// The expected information of the label there, as a share of the most that a label can carry, less the weighted
    /// cost.
    pub(crate) worth: f32,
}

/// A second label worth as much is as good as any, so the search for it ends.
pub(crate) const ENOUGH: f32 = 0.98;

/// What a look is for.
pub(crate) enum LookFor<'a> {
    /// The best prospects whose ends these lines disagree on.
    Prospects(Prospects<'a>, CellView<'a>),
    /// The worth of the best prospect. If lines are given, only prospects count on whose ends these lines disagree.
    Worth(&'a mut f32, Option<CellView<'a>>),
}

impl LookFor<'_> {
    /// Takes in a prospect; whether to go on.
    fn find(&mut self, new: Prospect) -> bool {
        match self {
            Self::Prospects(prospects, lines) => {
                prospects.add(new, *lines);
                true
            }
            Self::Worth(most, ground) => {
                let is_open = || ground.is_none_or(|lines| lines.may_tell(new.target.site));
                if new.worth > **most && is_open() {
                    **most = if new.worth < ENOUGH { new.worth } else { ENOUGH };
                }
                **most < ENOUGH
            }
        }
    }
}

/// The possible motions, where they may lead, their cost, and how many ends may still be evaluated.
pub struct Lookout<'a, D, G> {
    pub(crate) dynamics: &'a D,
    pub(crate) area: G,
    pub(crate) weight: EffortWeight,
    /// The fastest speed that is usually considered.
    pub(crate) usual: u16,
    /// The factor for lengths in the cost: it makes the usual reach count as the paper's 2 m.
    pub(crate) scale: f32,
    /// The least information that a label must be expected to carry.
    pub(crate) least: f32,
    pub(crate) evaluations: u32,
}

impl<D: Dynamics, G: Workspace> Lookout<'_, D, G> {
    /// What a motion costs: its squared control, weighed.
    pub(crate) fn cost(&self, reach_mm: u32, effort: u32) -> f32 {
        let reach = reach_mm as f32 * self.scale;
        let weight = self.weight.millionths as f32 * 1e-12;
        weight * (reach * reach + effort as f32)
    }

    /// Looks at so many circles, evenly spaced up to the one of a speed, the innermost first. It stops early when a
    /// prospect is good enough, or when no more ends may be evaluated.
    pub(crate) fn look<P: Prediction>(
        &mut self,
        prediction: &P,
        pose: Pose,
        (circles, fastest): (Circles, u16),
        sought: &mut LookFor<'_>,
    ) {
        for speed in circles.speeds(fastest) {
            if self.circle(prediction, pose, speed, sought).is_none() {
                return;
            }
        }
    }

    /// Evaluates the end of a ray. `None` if that is the last evaluation allowed, or if the end is off the lattice.
    fn ask<P: Prediction>(
        &mut self,
        prediction: &P,
        pose: Pose,
        (number, speed): (i64, u16),
        sought: &mut LookFor<'_>,
    ) -> Option<Probe> {
        self.evaluations = self.evaluations.checked_sub(prediction.asks())?;
        let ray = ray(self.dynamics, pose, number);
        let target = self.dynamics.arrive(pose, &ray, speed).ok()?;
        let share = prediction.share_above(target.site);
        if share > 0.0
            && share < 1.0
            && self.area.contains(target.site)
            && self.dynamics.keeps_inside(pose, target, &self.area, room_for_errors(&self.area))
        {
            let grid = self.dynamics.grid();
            let cost = self.cost(grid.reach_mm(speed), ray.turn_cost);
            let information = prediction.information(target.site, share);
            let worth = prediction.brings(target.site, share, information) - cost;
            let action = grid.action(ray.index, speed);
            if information >= self.least && !sought.find(Prospect { action, target, share, worth })
            {
                return None;
            }
        }
        Some(Probe { ray: number, off: share - 0.5 })
    }

    /// Looks at the circle of one speed.
    fn circle<P: Prediction>(
        &mut self,
        prediction: &P,
        pose: Pose,
        speed: u16,
        sought: &mut LookFor<'_>,
    ) -> Option<()> {
        let Some((first, count)) = rays(self.dynamics, speed) else { return Some(()) };
        let spacing = self.dynamics.fan().spacing.0;
        let turns = u64::from(spacing) * u64::from(count) * u64::from(PROBES_PER_TURN);
        let steps = ((turns + (1 << 31)) >> 32) as u32;
        let steps = NonZeroU32::new(steps).unwrap_or(NonZeroU32::MIN);
        let stride = count / steps;
        let mut before = self.ask(prediction, pose, (first, speed), sought)?;
        for step in 1..=steps.get() {
            let offset = if step == steps.get() { count } else { step * stride };
            let number = first + i64::from(offset);
            let after = self.ask(prediction, pose, (number, speed), sought)?;
            if (before.off < 0.0) != (after.off < 0.0) {
                self.close_in(prediction, pose, speed, [before, after], sought)?;
            }
            before = after;
        }
        Some(())
    }

    /// Comes as near to one half as the rays between two on different sides of it do.
    fn close_in<P: Prediction>(
        &mut self,
        prediction: &P,
        pose: Pose,
        speed: u16,
        [mut a, mut b]: [Probe; 2],
        sought: &mut LookFor<'_>,
    ) -> Option<()> {
        // How far from one half: the method of Illinois, which halves an end that stays.
        let (mut off_a, mut off_b) = (a.off, b.off);
        let mut stayed = None;
        while b.ray - a.ray > 1 {
            let part = (off_a / (off_a - off_b)).clamp(LEAST_STEP, 1.0 - LEAST_STEP);
            let middle = a.ray + i64::from((part * (b.ray - a.ray) as u32 as f32) as u32);
            let middle = middle.max(a.ray + 1).min(b.ray - 1);
            let probe = self.ask(prediction, pose, (middle, speed), sought)?;
            let off = probe.off;
            if off.abs() < NEAR_HALF {
                break;
            }
            let left = (off < 0.0) == (off_a < 0.0);
            if left {
                (a, off_a) = (probe, off);
                off_b *= if stayed == Some(Side::Left) { 0.5 } else { 1.0 };
                stayed = Some(Side::Left);
            } else {
                (b, off_b) = (probe, off);
                off_a *= if stayed == Some(Side::Right) { 0.5 } else { 1.0 };
                stayed = Some(Side::Right);
            }
        }
        Some(())
    }
}

/// Few prospects, that are looked at more closely.
pub(crate) type Few = Vec<Prospect, 4, u8>;

/// Many, near the pose too.
pub(crate) type Many = Vec<Prospect, 12, u8>;

/// The best prospects, some way apart, the best first.
pub(crate) struct Prospects<'a> {
    list: &'a mut VecView<Prospect, u8>,
    /// Lattice units.
    apart: i64,
}

/// The ends of motions whose labels tell the most: few of them.
pub(crate) fn few<P: Prediction, D: Dynamics, G: Workspace>(
    prediction: &P,
    ground: CellView<'_>,
    lookout: &mut Lookout<'_, D, G>,
    pose: Pose,
) -> Few {
    let mut list = Few::new();
    seek((prediction, ground), lookout, pose, (&mut list, APART), [6, 24].map(Circles::Even));
    list
}

/// The same, but many of them.
pub(crate) fn many<P: Prediction, D: Dynamics, G: Workspace>(
    prediction: &P,
    ground: CellView<'_>,
    lookout: &mut Lookout<'_, D, G>,
    pose: Pose,
) -> Many {
    let mut list = Many::new();
    let reach = f32::from(lookout.usual) * lookout.dynamics.grid().step_units();
    let apart = (PART * reach) as i64;
    seek((prediction, ground), lookout, pose, (&mut list, apart), [6, 24].map(Circles::Squares));
    list
}

fn seek<P: Prediction, D: Dynamics, G: Workspace>(
    (prediction, ground): (&P, CellView<'_>),
    lookout: &mut Lookout<'_, D, G>,
    pose: Pose,
    (list, apart): (&mut VecView<Prospect, u8>, i64),
    [usual, all]: [Circles; 2],
) {
    let fastest = lookout.dynamics.grid().speeds().saturating_sub(1);
    // If none of the usual ends is open, all are looked at.
    for circles in [(usual, lookout.usual), (all, fastest)] {
        if list.is_empty() {
            let prospects = Prospects { list: &mut *list, apart };
            let mut sought = LookFor::Prospects(prospects, ground);
            lookout.look(prediction, pose, circles, &mut sought);
        }
    }
}

impl Prospects<'_> {
    /// Takes in a prospect if it is among the best, and lines disagree on its end.
    fn add(&mut self, new: Prospect, lines: CellView<'_>) {
        let is_near = |old: &Prospect| {
            let apart = old.target.site - new.target.site;
            apart.dot(apart) < self.apart * self.apart
        };
        let rank = self.list.iter().take_while(|old| old.worth >= new.worth).count();
        let (better, _) = self.list.split_at_checked(rank).unwrap_or_default();
        if rank >= self.list.capacity()
            || better.iter().any(is_near)
            || !lines.may_tell(new.target.site)
        {
            return;
        }
        let mut number = 0;
        self.list.retain(|old| {
            number += 1;
            number <= rank || !is_near(old)
        });
        // Each worse one moves on by a place. What does not find room is the worst.
        let mut next = new;
        for place in self.list.get_mut(rank..).unwrap_or_default() {
            core::mem::swap(place, &mut next);
        }
        let _ = self.list.push(next);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::cells::Certainty;
    use crate::belief::sample::{Label, Sample};
    use crate::belief::true_labels::VersionSpace;
    use crate::draws::Draws;
    use crate::geometry::heading::Heading;
    use crate::geometry::lattice::Site;

    fn at(x: i32, z: i32) -> Site {
        Site::new(x, z).unwrap()
    }

    /// The prospects that are kept are uncertain, the best of all is first, and no two are near each other. If there is
    /// space enough the list is full.
    #[test]
    fn prospects_are_the_best_some_way_apart() {
        let metre = UNITS_PER_METRE;
        let given =
            [(0, 0, false), (0, 4, true), (9, 5, true), (10, 0, false)].map(|(x, z, above)| {
                let label = if above { Label::Positive } else { Label::Negative };
                Sample { site: at(x * metre, z * metre), label }
            });
        let space = VersionSpace::<4>::new(&given).unwrap();
        let mut draws = Draws::new(1);
        let mut random = |below: u32| draws.below(below) as i32;
        let mut full = 0;
        for case in 0..500 {
            let mut list = Few::new();
            let mut prospects = Prospects { list: &mut list, apart: APART };
            let mut offered = Vec::<Prospect, 24>::new();
            // Within 20 cm, so that all are near each other, up to 5 m.
            let breadth = metre as u32 * [1, 3, 10, 25][case % 4] / 5;
            for _ in 0..24 {
                let site = at(3 * metre + random(breadth), metre + random(breadth));
                let target = Pose { site, heading: Heading(0) };
                let worth = random(1_000) as f32 / 1_000.0;
                let new = Prospect { action: Action(0), target, share: 0.5, worth };
                prospects.add(new, space.lines());
                let _ = offered.push(new);
            }
            let kept = list.as_slice();
            let apart = |a: &Prospect, b: &Prospect| {
                let off = a.target.site - b.target.site;
                f64::from(off.x).hypot(f64::from(off.z)) / f64::from(metre)
            };
            for (k, one) in kept.iter().enumerate() {
                assert_eq!(space.lines().certainty(one.target.site), Certainty::Uncertain);
                for better in &kept[..k] {
                    assert!(better.worth >= one.worth, "case {case}");
                    assert!(apart(one, better) >= 0.25, "case {case}");
                }
            }
            let is_uncertain =
                |it: &&Prospect| space.certainty(it.target.site) == Certainty::Uncertain;
            let best = offered.iter().filter(is_uncertain).map(|it| it.worth).reduce(f32::max);
            assert_eq!(kept.first().map(|it| it.worth), best, "case {case}");
            full += usize::from(list.is_full() && case % 4 == 3);
        }
        assert!(full > 120, "{full} of 125");
    }
}
