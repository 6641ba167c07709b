//! The one-step problems P1 to P4 (Section III) and their exact search.
//!
//! A problem maximises `|zeta' - zeta|^2 - varrho |u|^2` over the action set. Here `zeta` and `zeta'` are the positions
//! before and after the motion, `varrho` is the [`EffortWeight`] and `u` the control. The new position `zeta'` must lie
//! inside the area and outside both regions of certainty. A rule restricts the direction of travel. A vehicle that
//! cannot turn on the spot must also be able to stay inside afterwards. Among equal actions the smaller turn wins, then
//! the left one.
//!
//! The agent always moves: standing still would sample the same place again. The regions of certainty exclude that,
//! except in P3 and P4, whose regions are those of the start.
//!
//! The search returns the action that trying every action would return, but looks at few of them:
//!
//! - **By the objective.** A faster motion is better, and so is a smaller turn. So the search begins with the outermost
//!   circle of positions and the smallest turns on it. It ends where no circle can do better.
//! - **By the ground.** On a circle, certain ground ends where a line that bounds the uncertain ground crosses it. All
//!   rays before that crossing are skipped at once, not one by one.
//! - **By the rule.** Directions that the rule forbids are skipped in the same way
//!   ([`direction_rule`](crate::search::direction_rule)).

use crate::belief::cells::CellView;
use crate::geometry::area::Area;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, room_for_errors};
use crate::search::circles::Search;
use crate::search::direction_rule::{ArcRule, DirectionRule};
use crate::search::objective::{Choice, Effort, EffortWeight};
use crate::search::view::View;

/// A one-step problem at some stage of a mission.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, R, G = Area> {
    /// The lines that are left. The motion must not end on ground where they agree.
    pub lines: CellView<'a>,
    /// Where positions must stay.
    pub area: G,
    /// The weight of the control.
    pub weight: EffortWeight,
    /// Where travel may go.
    pub rule: R,
}

/// What a search found, and at what cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Solution {
    /// The best action; `None` when none is feasible.
    pub best: Option<Choice>,
    /// Actions whose position was looked at.
    pub examined: u32,
    /// Whether it is the best for certain: the search did not end for want of looks.
    pub proven: bool,
}

impl<'a, R: DirectionRule, G: Workspace> Problem<'a, R, G> {
    /// The same problem without its rule.
    pub fn undirected(&self) -> Problem<'a, ArcRule, G> {
        let rule = ArcRule::default();
        Problem { lines: self.lines, area: self.area, weight: self.weight, rule }
    }

    /// Solves the problem from a pose inside the area.
    ///
    /// Cost: on each circle of positions that may beat the best, one look for each piece of certain ground on either
    /// side. A look takes two multiplications and an arc cosine for each line that bounds the uncertain ground.
    pub fn solve<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Solution {
        self.solve_within(u32::MAX, dynamics, pose)
    }

    /// As [`solve`](Self::solve), with a limit on looks, each at a ray of a circle. When they are used up, the result
    /// is the best so far.
    pub fn solve_within<D: Dynamics>(&self, looks: u32, dynamics: &D, pose: Pose) -> Solution {
        let mut effort = Effort::of(looks);
        let best = self.find(&mut effort, dynamics, pose);
        Solution { best, examined: effort.examined, proven: effort.is_enough() }
    }

    /// The best action, for what effort is left.
    pub(crate) fn find<D: Dynamics>(
        &self,
        effort: &mut Effort,
        dynamics: &D,
        pose: Pose,
    ) -> Option<Choice> {
        let mut search = self.search(dynamics, pose, *effort);
        let search = search.open();
        let best = search.best_between([pose.heading; 2], &self.rule);
        *effort = search.effort;
        best.map(|(choice, _)| choice)
    }

    /// The search for it from a pose; nothing is seen before it is opened.
    #[expect(clippy::inline_always, reason = "its buffers are made where they stay")]
    #[inline(always)]
    pub(crate) fn search<'d, D: Dynamics>(
        &self,
        dynamics: &'d D,
        pose: Pose,
        effort: Effort,
    ) -> Search<'d, D, G>
    where
        'a: 'd,
    {
        let view = View::new(self.lines, self.area, pose.site, dynamics.grid());
        Search { dynamics, pose, weight: self.weight, view, effort, is_hemmed_in: false }
    }

    /// Solves the problem by trying every action: the slow twin of [`solve`](Self::solve).
    pub fn solve_exhaustively<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Solution {
        let (grid, room) = (dynamics.grid(), room_for_errors(&self.area));
        let mut solution = Solution { proven: true, ..Solution::default() };
        for ray in dynamics.rays(pose) {
            for speed in 0..grid.speeds() {
                solution.examined += 1;
                let objective = self.weight.objective(grid.reach_mm(speed), ray.turn_cost);
                let action = grid.action(ray.index, speed);
                let feasible = |target: &Pose| {
                    speed > 0
                        && self.area.contains(target.site)
                        && dynamics.keeps_inside(pose, *target, &self.area, room)
                        && self.rule.admits(ray.step)
                        && self.lines.can_cut(target.site)
                };
                if solution.best.is_none_or(|b| objective > b.objective)
                    && let Some(target) = dynamics.target(pose, action).filter(feasible)
                {
                    solution.best = Some(Choice { action, target, objective });
                }
            }
        }
        solution
    }
}
