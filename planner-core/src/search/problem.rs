//! The one-step problems P1 to P4 (Section III) and their exact search.
//!
//! Maximise `|zeta' - zeta|^2 - varrho |u|^2` over the action set, subject to `zeta'` inside the
//! area and outside both regions of certainty, and to a rule on the direction of travel. Ties go to
//! the smaller turn, then to the left. The agent moves: standing still would sample a place again,
//! which the regions of certainty exclude but for P3 and P4, whose regions are those of the start.
//!
//! The search returns the action that trying every action would return, and looks at few of them:
//!
//! - **By the objective.** Faster is better and turning less is: so the outermost circle of positions
//!   comes first, on it the smallest turns, and the search ends where no circle can do better.
//! - **By the ground.** Ground that is certain ends on a circle where a bound of the candidates cuts it:
//!   what lies before is passed over at once, not ray by ray (`sight.rs`).
//! - **By the rule.** Directions that it bars are passed over in the same way (`rule.rs`).

use crate::belief::candidates::{Candidates, Certainty};
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::motion::action::{Action, ActionGrid};
use crate::motion::dynamics::{Dynamics, Pose};
use crate::search::direction_rule::{ArcRule, DirectionRule};
use crate::search::view::Sight;

/// Rays that a plan of Algorithm 1, or of Algorithm 2 by the joint reading, looks at at most. With the
/// paper's grid 520 are the most that a plan of 3,000 standard missions of 60 steps needed.
pub const LOOKS: u32 = 8_192;

/// The weight of the control in the objective, in [0, 1), to six decimal places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "wire", serde(try_from = "u32", into = "u32"))]
pub struct Varrho {
    pub(crate) millionths: u32,
}

impl Varrho {
    pub(crate) const ONE: u32 = 1_000_000;

    /// The paper's 0.1.
    pub const PAPER: Self = Self { millionths: 100_000 };

    /// The nearest weight; `None` outside [0, 1). From 1 on, the objective would reward standing
    /// still.
    pub fn new(value: f64) -> Option<Self> {
        if !(0.0..1.0).contains(&value) {
            return None;
        }
        let millionths = libm::round(value * f64::from(Self::ONE)) as u32;
        (millionths < Self::ONE).then_some(Self { millionths })
    }

    /// The weight as a number.
    pub fn value(self) -> f64 {
        f64::from(self.millionths) / f64::from(Self::ONE)
    }

    /// The objective, in 10^-12 m^2: an integer, so that ties are ties.
    pub(crate) const fn objective(self, reach_mm: u32, effort: u32) -> i64 {
        let reach = reach_mm as i64 * reach_mm as i64;
        let (varrho, one) = (self.millionths as i64, Self::ONE as i64);
        (one - varrho) * reach - varrho * effort as i64
    }
}

/// A one-step problem at some stage of a mission.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, R> {
    /// The candidate lines: what they agree on is the ground to stay out of.
    pub ground: Candidates<'a>,
    /// Where positions must stay.
    pub area: Area,
    /// The weight of the control.
    pub varrho: Varrho,
    /// Where travel may go.
    pub rule: R,
}

/// A feasible action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Candidate {
    /// The action.
    pub action: Action,
    /// The pose after it.
    pub target: Pose,
    /// The objective, in 10^-12 m^2.
    pub objective: i64,
}

/// What searches may still cost, and have cost.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Rays that may still be looked at.
    pub(crate) looks: u32,
    /// Actions whose position was looked at so far.
    pub(crate) examined: u32,
}

impl Effort {
    pub(crate) const fn of(looks: u32) -> Self {
        Self { looks, examined: 0 }
    }

    /// Whether no search has ended for want of looks.
    pub(crate) const fn is_enough(self) -> bool {
        self.looks > 0
    }
}

/// What a search found, and at what cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Search {
    /// The best action; `None` when none is feasible.
    pub best: Option<Candidate>,
    /// Actions whose position was looked at.
    pub examined: u32,
    /// Whether it is the best for certain: the search did not end for want of looks.
    pub proven: bool,
}

impl<'a, R: DirectionRule> Problem<'a, R> {
    /// The same problem without its rule.
    pub fn undirected(&self) -> Problem<'a, ArcRule> {
        let rule = ArcRule::default();
        Problem { ground: self.ground, area: self.area, varrho: self.varrho, rule }
    }

    /// Solves the problem from a pose inside the area.
    ///
    /// Cost: for each circle of positions that may beat the best, to either side as many looks as
    /// certain ground has pieces there; a look is two multiplications and an arc cosine for each vertex of the
    /// ground's cell.
    pub fn solve<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Search {
        self.solve_within(u32::MAX, dynamics, pose)
    }

    /// As [`solve`](Self::solve), with so many looks: each is a ray of a circle. When they are used up
    /// it is the best so far.
    pub fn solve_within<D: Dynamics>(&self, looks: u32, dynamics: &D, pose: Pose) -> Search {
        let mut effort = Effort::of(looks);
        let best = self.find(&mut effort, dynamics, pose);
        Search { best, examined: effort.examined, proven: effort.is_enough() }
    }

    /// The best action, for what effort is left.
    pub(crate) fn find<D: Dynamics>(
        &self,
        effort: &mut Effort,
        dynamics: &D,
        pose: Pose,
    ) -> Option<Candidate> {
        let mut sight = self.sight(pose.site, dynamics.grid(), *effort);
        let sight = sight.open();
        let best = sight.search(dynamics, [pose.heading; 2], self.varrho, &self.rule);
        *effort = sight.effort;
        best.map(|(candidate, _)| candidate)
    }

    /// What is to be seen of it from a position.
    pub(crate) fn sight(&self, site: Site, grid: ActionGrid, effort: Effort) -> Sight<'a> {
        Sight::new(self.ground, self.area, site, grid, effort)
    }

    /// Solves the problem by trying every action: the slow twin of [`solve`](Self::solve).
    pub fn solve_exhaustively<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Search {
        let grid = dynamics.grid();
        let mut search = Search { proven: true, ..Search::default() };
        for ray in dynamics.rays(pose) {
            for speed in 0..grid.speeds() {
                search.examined += 1;
                let objective = self.varrho.objective(grid.reach_mm(speed), ray.effort);
                let feasible = |target: &Pose| {
                    speed > 0
                        && self.area.contains(target.site)
                        && self.rule.admits(ray.step)
                        && self.ground.certainty(target.site) == Certainty::Uncertain
                };
                if search.best.is_none_or(|b| objective > b.objective)
                    && let Some(target) = ray.arrive(pose.site, speed).ok().filter(feasible)
                {
                    let action = grid.action(ray.index, speed);
                    search.best = Some(Candidate { action, target, objective });
                }
            }
        }
        search
    }
}
