//! The one-step problems P1 and P2 (Section III-A) and their exact search.
//!
//! Maximise `|zeta' - zeta|^2 - varrho |u|^2` over the action set, subject to `zeta'` inside the
//! area and outside both regions of certainty, and to a rule on the direction of travel. Ties go to
//! the smaller turn, then to the left.
//!
//! The search returns the action that trying every action would return, and looks at few of them:
//!
//! - **By the objective.** Rays come cheapest first and on a ray faster is better, so once a speed
//!   is found only a higher one on a later ray can win.
//! - **By the arc.** A ray whose direction breaks the rule is skipped whole.
//! - **A ray's speeds together.** The ground that is certain to have one label is convex, so on a
//!   ray it is an interval of speeds: it is left by bisection, not speed by speed.
//!
//! The last step needs care, as positions are rounded to the lattice and so not quite on the ray. A
//! `Sightline` carries a proven bound on that rounding. Ground is skipped only where it is certain
//! whatever the rounding; what is left is settled by the exact predicate.

use heapless::Vec;

use crate::action::Action;
use crate::cell::Certainty;
use crate::direction::Arc;
use crate::dynamics::{Dynamics, Pose, Ray};
use crate::lattice::{Site, Vector};
use crate::sample::Label;
use crate::version_space::VersionSpace;

/// The weight of the control in the objective, in [0, 1), to six decimal places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Varrho {
    millionths: u32,
}

impl Varrho {
    const ONE: u32 = 1_000_000;

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

/// The rectangle in which all positions stay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Area {
    min: Site,
    max: Site,
}

impl Area {
    /// The rectangle with these corners; `None` unless it has an inside.
    pub fn new(min: Site, max: Site) -> Option<Self> {
        (min.x() < max.x() && min.z() < max.z()).then_some(Self { min, max })
    }

    /// The corner of smallest coordinates.
    pub const fn min(&self) -> Site {
        self.min
    }

    /// The corner of largest coordinates.
    pub const fn max(&self) -> Site {
        self.max
    }

    /// Whether a position lies inside or on the border.
    pub fn contains(&self, q: Site) -> bool {
        (self.min.x()..=self.max.x()).contains(&q.x())
            && (self.min.z()..=self.max.z()).contains(&q.z())
    }
}

/// A rule on the direction of travel, modulo pi.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DirectionRule {
    /// The direction must lie in this arc.
    pub inside: Option<Arc>,
    /// The direction must not lie in this arc.
    pub outside: Option<Arc>,
}

impl DirectionRule {
    /// Any direction will do.
    pub const ANY: Self = Self { inside: None, outside: None };

    fn admits(&self, direction: Vector) -> bool {
        self.inside.is_none_or(|arc| arc.contains(direction))
            && self.outside.is_none_or(|arc| !arc.contains(direction))
    }
}

/// A one-step problem at some stage of a mission.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a, const N: usize> {
    /// What is known of the line.
    pub space: &'a VersionSpace<N>,
    /// Where positions must stay.
    pub area: Area,
    /// The weight of the control.
    pub varrho: Varrho,
    /// Where travel may go.
    pub rule: DirectionRule,
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

impl<const N: usize> Problem<'_, N> {
    /// Solves the problem from a pose inside the area.
    ///
    /// Cost: for each ray that the rule admits and the objective does not exclude, one or two looks
    /// at a position when the whole ray is certain, `log2(speeds)` more when it is not; a look is
    /// three multiplications for each vertex of the version space. No trigonometry but one `sincosf`.
    pub fn solve<D: Dynamics>(&self, dynamics: &D, pose: Pose) -> Search {
        let grid = dynamics.grid();
        let mut sight = Sight::new(self, pose.site, grid.speeds());
        let mut best: Option<Candidate> = None;
        // Standing still yields a sample only where the label is not known.
        let mut slowest = u16::from(self.space.certainty(pose.site) != Certainty::Uncertain);
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
                slowest = speed + 1;
            }
        }
        Search { best, examined: sight.examined }
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
                    self.area.contains(target.site)
                        && self.rule.admits(ray.step)
                        && self.space.certainty(target.site) == Certainty::Uncertain
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

/// A bound of the version space, seen from where the agent stands.
struct Sightline {
    along: Vector,
    /// The bound's value at the agent's position.
    here: i64,
    /// How far rounding can put a value off the ray's linear prediction.
    slack: i64,
}

impl Sightline {
    /// The bound's value at a speed on a ray, within `slack`.
    ///
    /// The position is `here + k step / 2^8 + e` with components of `e` of at most 1/2, so its
    /// value is `value + k cross(along, step) / 2^8 + cross(along, e)`. Shifting the product loses
    /// less than 1, `k` times; `cross(along, e)` is at most `(|along.x| + |along.z|) / 2`.
    const fn at(&self, step: Vector, speed: u16) -> i64 {
        self.here + speed as i64 * (self.along.cross(step) >> Ray::STEP_BITS)
    }
}

/// All that a search sees from one position.
struct Sight<'a, const N: usize> {
    problem: &'a Problem<'a, N>,
    from: Site,
    lines: Vec<Sightline, N, u8>,
    examined: u32,
}

impl<'a, const N: usize> Sight<'a, N> {
    fn new(problem: &'a Problem<'a, N>, from: Site, speeds: u16) -> Self {
        let mut lines = Vec::new();
        for bound in problem.space.bounds() {
            let along = bound.along;
            let size = i64::from(along.x.unsigned_abs()) + i64::from(along.z.unsigned_abs());
            let slack = size / 2 + 1 + i64::from(speeds);
            // As many vertices as edges, and these fit: nothing is refused.
            let _ = lines.push(Sightline { along, here: bound.at(from), slack });
        }
        Self { problem, from, lines, examined: 0 }
    }

    /// The highest speed from `slowest` to `fastest` at which the ray ends inside the area on
    /// uncertain ground.
    fn fastest(&mut self, ray: &Ray, slowest: u16, fastest: u16) -> Option<u16> {
        let mut high = self.farthest_inside(ray, fastest)?;
        while high >= slowest {
            let Some(label) = self.surely(ray, high) else {
                if self.is_uncertain(ray, high) {
                    return Some(high);
                }
                high = high.checked_sub(1)?;
                continue;
            };
            // Ground that surely has one label is an interval of speeds: if it holds the slowest
            // too, it holds all between.
            if self.surely(ray, slowest) == Some(label) {
                return None;
            }
            let mut low = slowest;
            while high - low > 1 {
                let middle = low.midpoint(high);
                if self.surely(ray, middle) == Some(label) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            high = low;
        }
        None
    }

    /// The highest speed, up to `fastest`, that does not leave the area: a ray leaves it once.
    fn farthest_inside(&self, ray: &Ray, fastest: u16) -> Option<u16> {
        let inside =
            |speed| self.position(ray, speed).is_some_and(|q| self.problem.area.contains(q));
        if inside(fastest) {
            return Some(fastest);
        }
        let (mut low, mut high) = (0, fastest);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if inside(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        inside(low).then_some(low)
    }

    fn position(&self, ray: &Ray, speed: u16) -> Option<Site> {
        self.from.step(ray.displacement(speed)).ok()
    }

    /// The label that the ray's ground at a speed has however positions are rounded.
    fn surely(&mut self, ray: &Ray, speed: u16) -> Option<Label> {
        self.examined += 1;
        let (mut below, mut above) = (true, true);
        for line in &self.lines {
            let value = line.at(ray.step, speed);
            below &= value <= -line.slack;
            above &= value >= line.slack;
            if !below && !above {
                return None;
            }
        }
        Some(if above { Label::Positive } else { Label::Negative })
    }

    fn is_uncertain(&self, ray: &Ray, speed: u16) -> bool {
        self.position(ray, speed)
            .is_some_and(|q| self.problem.space.certainty(q) == Certainty::Uncertain)
    }
}
