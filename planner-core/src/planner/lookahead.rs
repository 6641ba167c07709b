//! Look-ahead: the motion whose label, and the one after it, are expected to tell the most for their cost.
//!
//! A label tells most where it is as likely to be +1 as -1. Among the ends of all motions such places lie
//! along a curve, and an agent that walks along it, and does not walk where the next step has none in
//! reach, learns nearly as much as one that jumps anywhere. So a plan
//!
//! 1. looks for the motions whose end is worth the most: what its label is expected to tell, as a share of
//!    what a label can tell, less `varrho |u|^2`;
//! 2. looks one step further from the best of them, after either label, and makes the motion for which the
//!    two steps together are worth the most;
//! 3. where no end is worth much, it considers turns in place as well;
//! 4. where there is none it climbs the recovery ladder, as Algorithm 1 does.
//!
//! It is an anytime search: a plan asks so many ends at most ([`EVALUATIONS`]), in an order that does not
//! depend on how many, and keeps the best so far, so that more are never worse by its own measure.
//! What it learns from is a [`Foresight`]: the version space where labels are true, a
//! [`Forecast`](crate::belief::forecast::Forecast) where they may be wrong.

use crate::belief::Belief as _;
use crate::belief::Refused;
use crate::belief::goal::Goal;
use crate::belief::outlook::{Foresight, Outlook, Prediction};
use crate::belief::sample::{Label, Reading};
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::planner::config::Config;
use crate::planner::{Motion, Plan, Planner, StopReason};
use crate::search::direction_rule::ArcRule;
use crate::search::lookout::{ENOUGH, Lookout, Prospect, Prospects, Sought};
use crate::search::objective::{Effort, Varrho};
use crate::search::problem::Problem;
use crate::search::recovery::{DeadEnd, Found, solve_or_recover};

/// The weight of the control that serves it best: in shares of a label for a unit of `|u|^2`.
pub const VARRHO: Varrho = Varrho { millionths: 2_000 };

/// Ends of motions that a plan asks, at most. Of 1,000 standard fields none needs more.
pub const EVALUATIONS: u32 = 512;

/// Circles on which the first step may end, and the second.
const FIRST_CIRCLES: u16 = 6;
const SECOND_CIRCLES: u16 = 3;

/// Where no label is worth as much, turns in place are considered.
const POOR: f32 = 0.9;

/// Rays that the recovery ladder looks at, at most.
const LADDER_LOOKS: u32 = 128;

/// Looks two labels ahead, with `D`'s dynamics and what `B` knows and expects.
///
/// Of its [`Config`] it takes the area and `varrho`, for which [`VARRHO`] is a good choice.
#[derive(Clone, Debug)]
pub struct Lookahead<D, B> {
    config: Config,
    dynamics: D,
    foresight: B,
    evaluations: u32,
    goal: Option<Goal>,
}

/// What to do, and what the two labels after it are worth.
struct Decision {
    action: Action,
    target: Pose,
    worth: f32,
    wants_label: bool,
}

impl<D: Dynamics, B: Foresight> Lookahead<D, B> {
    /// A planner with what is known so far.
    pub const fn new(config: Config, dynamics: D, foresight: B) -> Self {
        Self { config, dynamics, foresight, evaluations: EVALUATIONS, goal: None }
    }

    /// The same, with so many ends of motions to ask for a plan at most instead of [`EVALUATIONS`].
    #[must_use]
    pub fn within(self, evaluations: u32) -> Self {
        Self { evaluations, ..self }
    }

    /// The same, to stop when the line is known so well.
    #[must_use]
    pub fn until(self, goal: Option<Goal>) -> Self {
        Self { goal, ..self }
    }

    /// What is known and expected: to begin again with, or to take in a label of a reliability of its own.
    pub const fn foresight(&mut self) -> &mut B {
        &mut self.foresight
    }

    /// The motion that is worth the most; `None` if no label is in reach.
    fn decide(&self, lookout: &mut Lookout<'_, D>, pose: Pose) -> Option<Decision> {
        let outlook = self.foresight.outlook(pose.site);
        let mut prospects = Prospects::new();
        let all = self.dynamics.grid().speeds();
        for circles in [FIRST_CIRCLES, all] {
            if prospects.as_slice().is_empty() {
                let mut sought = Sought::Prospects(&mut prospects, self.foresight.ground());
                lookout.look(&outlook, pose, circles, &mut sought);
            }
        }
        let mut best = None;
        let is_better =
            |worth: f32, best: &Option<Decision>| best.as_ref().is_none_or(|it| worth > it.worth);
        for &Prospect { action, target, share, worth } in prospects.as_slice() {
            let above = outlook.chance(target.site, share);
            // What it is worth at most, and, when both labels have been looked at, what it is worth.
            let mut total = worth + ENOUGH;
            for (label, chance) in [(Label::Positive, above), (Label::Negative, 1.0 - above)] {
                if is_better(total, &best) {
                    let after = outlook.after(target.site, label);
                    let next = second(lookout, &after, target);
                    total -= chance * (ENOUGH - next);
                }
            }
            if is_better(total, &best) {
                best = Some(Decision { action, target, worth: total, wants_label: true });
            }
        }
        let most = prospects.as_slice().first().map_or(0.0, |first| first.worth);
        if most < POOR {
            for side in [Side::Left, Side::Right] {
                let Some((action, target)) = self.dynamics.turn_in_place(pose, side) else {
                    continue;
                };
                let effort = self.dynamics.ray_of(pose, action).map_or(0, |ray| ray.effort);
                let next = second(lookout, &outlook, target);
                let total = next - lookout.cost(0, effort);
                if next > 0.0 && is_better(total, &best) {
                    best = Some(Decision { action, target, worth: total, wants_label: false });
                }
            }
        }
        best
    }

    /// What the ladder finds where no label is in reach.
    fn recover(&self, pose: Pose) -> (Result<Found, DeadEnd>, Effort) {
        let Config { area, varrho, .. } = self.config;
        let rule = ArcRule::default();
        let problem = Problem { lines: self.foresight.ground(), area, varrho, rule };
        let mut search = problem.search(&self.dynamics, pose, Effort::of(LADDER_LOOKS));
        let search = search.open();
        let found = solve_or_recover(&problem, search, None);
        (found, search.effort)
    }
}

/// What the best label after one more motion is worth; nothing if there is none.
fn second<D: Dynamics, P: Prediction>(
    lookout: &mut Lookout<'_, D>,
    prediction: &P,
    pose: Pose,
) -> f32 {
    let mut most = 0.0;
    lookout.look(prediction, pose, SECOND_CIRCLES, &mut Sought::Worth(&mut most));
    most
}

impl<D: Dynamics, B: Foresight> Planner for Lookahead<D, B> {
    type Belief = B::Belief;

    fn plan(&mut self, pose: Pose) -> Plan {
        let Config { area, varrho, .. } = self.config;
        if self.goal.is_some_and(|goal| self.belief().meets(goal, area)) {
            return Plan::Stop(StopReason::Known);
        }
        if self.belief().is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        if !area.contains(pose.site) {
            return Plan::Stop(StopReason::OutsideArea);
        }
        self.foresight.prepare();
        let (dynamics, evaluations) = (&self.dynamics, self.evaluations);
        let mut lookout = Lookout { dynamics, area, varrho, evaluations };
        if let Some(decision) = self.decide(&mut lookout, pose) {
            let Decision { action, target, wants_label, .. } = decision;
            let looks = lookout.evaluations;
            let effort = Effort { looks, examined: evaluations - looks };
            let found = Found { recovery: None, action, target };
            return Plan::Move(Motion {
                wants_label,
                ..Motion::of(None, &found, dynamics, effort)
            });
        }
        match self.recover(pose) {
            (Ok(found), effort) => Plan::Move(Motion::of(None, &found, dynamics, effort)),
            (Err(dead_end), _) => Plan::Stop(dead_end.into()),
        }
    }

    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused> {
        reading.map_or(Ok(()), |reading| self.foresight.observe(pose.site, reading))
    }

    fn belief(&self) -> &B::Belief {
        self.foresight.belief()
    }
}
