//! The one-step problems P1 to P4 (Section III) and their exact search.
//!
//! Maximise `|zeta' - zeta|^2 - varrho |u|^2` over the action set, subject to `zeta'` inside the
//! area and outside both regions of certainty, and to a rule on the direction of travel. Ties go to
//! the smaller turn, then to the left. The agent moves: standing still would sample a place again,
//! which the regions of certainty exclude but for P3 and P4, whose regions are those of the start.
//!
//! The search returns the action that trying every action would return, and looks at few of them:
//!
//! - **By the objective.** Rays come cheapest first and on a ray faster is better, so once a speed
//!   is found only a higher one on a later ray can win.
//! - **By the arc.** A ray whose direction breaks the rule is skipped whole.
//! - **A ray's speeds together.** The ground that is certain to have one label is convex, so on a
//!   ray it is an interval of speeds: it is left by bisection, not speed by speed (`sight.rs`).

use crate::action::Action;
use crate::area::Area;
use crate::candidates::Candidates;
use crate::cell::Certainty;
use crate::direction::Arc;
use crate::dynamics::{Dynamics, Pose};
use crate::lattice::Vector;
use crate::sight::Sight;

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
    const fn objective(self, reach_mm: u32, effort: u32) -> i64 {
        let reach = reach_mm as i64 * reach_mm as i64;
        let (varrho, one) = (self.millionths as i64, Self::ONE as i64);
        (one - varrho) * reach - varrho * effort as i64
    }
}

/// A rule on the direction of travel, modulo pi.
pub trait DirectionRule {
    /// Whether travel in this direction is allowed.
    fn admits(&self, direction: Vector) -> bool;
}

/// Any direction will do.
#[derive(Clone, Copy, Debug)]
pub struct AnyDirection;

impl DirectionRule for AnyDirection {
    fn admits(&self, _: Vector) -> bool {
        true
    }
}

/// A rule by arcs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ArcRule {
    /// The direction must lie in this arc.
    pub inside: Option<Arc>,
    /// The direction must not lie in this arc.
    pub outside: Option<Arc>,
}

impl DirectionRule for ArcRule {
    fn admits(&self, direction: Vector) -> bool {
        self.inside.is_none_or(|arc| arc.contains(direction))
            && self.outside.is_none_or(|arc| !arc.contains(direction))
    }
}

/// A one-step problem at some stage of a mission.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, R, const E: usize> {
    /// The candidate lines: what they agree on is the ground to stay out of.
    pub ground: Candidates<'a, E>,
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

/// What a search found, and at what cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Search {
    /// The best action; `None` when none is feasible.
    pub best: Option<Candidate>,
    /// Actions whose position was looked at.
    pub examined: u32,
}

impl<'a, R: DirectionRule, const E: usize> Problem<'a, R, E> {
    /// The same problem with another rule.
    pub fn with_rule<S: DirectionRule>(&self, rule: S) -> Problem<'a, S, E> {
        Problem { ground: self.ground, area: self.area, varrho: self.varrho, rule }
    }

    /// Solves the problem from a pose inside the area.
    ///
    /// Cost: for each ray that the rule admits and the objective does not exclude, one or two looks
    /// at a position when the whole ray is certain, `log2(speeds)` more when it is not; a look is
    /// three multiplications for each vertex of the ground's cell. No trigonometry but one `sincos`.
    pub fn solve<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Search {
        let grid = dynamics.grid();
        let mut sight = Sight::new(self.ground, self.area, pose.site, grid.speeds());
        let mut best: Option<Candidate> = None;
        let mut slowest = 1;
        for ray in dynamics.rays(pose) {
            let objective = |speed| self.varrho.objective(grid.reach_mm(speed), ray.effort);
            while best.is_some_and(|b| objective(slowest) <= b.objective) && slowest < grid.speeds()
            {
                slowest += 1;
            }
            if slowest >= grid.speeds() {
                break;
            }
            if !self.rule.admits(ray.step) {
                continue;
            }
            if let Some(speed) = sight.fastest(&ray, slowest, grid.speeds() - 1)
                && let Ok(target) = ray.arrive(pose.site, speed)
            {
                let action = grid.action(ray.index, speed);
                best = Some(Candidate { action, target, objective: objective(speed) });
                slowest = speed;
            }
        }
        Search { best, examined: sight.examined() }
    }

    /// Solves the problem by trying every action: the slow twin of [`solve`](Self::solve).
    pub fn solve_exhaustively<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Search {
        let grid = dynamics.grid();
        let mut search = Search::default();
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
