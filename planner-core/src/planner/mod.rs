//! Planners: `plan()` returns the next motion, `observe()` takes in its result, and `belief()` is what is known so far.
//!
//! | module | planner |
//! | --- | --- |
//! | [`lookahead`] | goes where labels are expected to tell the most, whether they are true or sometimes wrong |
//! | [`seek`] | finds a straight boundary from nothing, for another planner to go on |
//! | [`track`] | finds a front that bends and moves, and goes along it |
//! | [`cfc`] | the paper's Algorithm 1, for labels that are true |
//! | [`scc`] | the paper's Algorithm 2, for labels that are sometimes wrong |
//!
//! [`scout`] is how both of these seek, and [`quest`] what they know of a boundary that is not found. [`sight`] is how far look-ahead looks for labels, and [`far`] sight looks all along the estimate. [`audit`] is what
//! look-ahead does before it promises a goal. A [`watched`] planner says when no line explains its
//! labels. [`options`] are what Algorithms 1 and 2 leave open. [`setup`] checks the parts that every planner is made of.
//! A [`snapshot`] is what a planner has to remember over a sleep.

mod aim;
mod along;
pub(crate) mod audit;
pub(crate) mod cfc;
pub(crate) mod decision;
pub(crate) mod far;
pub(crate) mod front_state;
mod hunt;
pub(crate) mod lap;
mod led;
pub(crate) mod lookahead;
pub(crate) mod one_label;
pub(crate) mod options;
mod outlook;
pub(crate) mod quest;
pub(crate) mod scc;
pub(crate) mod scout;
pub(crate) mod seek;
pub(crate) mod setup;
pub(crate) mod sight;
pub(crate) mod silence;
pub(crate) mod snapshot;
pub(crate) mod stretch;
pub(crate) mod track;
mod turns;
mod vote;
pub(crate) mod watched;

use crate::belief::estimate::Estimates;
use crate::belief::evidence::Alarm;
use crate::belief::sample::Reading;
use crate::belief::tolerance::Tolerance;
use crate::belief::{Belief, ObservationError};
use crate::geometry::lattice::Site;
use crate::geometry::line::Line;
use crate::motion::action::{Action, Control};
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::front_state::FrontState;
use crate::search::dead_end::DeadEnd;
use crate::search::objective::Effort;
use crate::search::recovery::{Found, Recovery};

/// Which one-step problem a motion answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Stage {
    /// Look for the opposite label.
    P1,
    /// Follow the boundary.
    P2,
    /// Explore directions in which no hypothesis has the boundary.
    P3,
    /// Explore directions in which some hypothesis has it.
    P4,
    /// No problem of the paper: visit ground that is certain, before a goal counts as met.
    Audit,
    /// Look for a [front](crate::Track) that is not found yet, or is lost.
    Seek,
    /// Go along a front.
    Follow,
    /// Go round a keep-out that lies on a front.
    Pass,
    /// Go back to a front, or into the area.
    Return,
}

/// A motion to make.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion {
    /// The one-step problem it answers, for planners that pose one.
    pub stage: Option<Stage>,
    /// The recovery it belongs to, if the problem had no feasible action.
    pub recovery: Option<Recovery>,
    /// The action's name in the grid.
    pub action: Action,
    /// What it asks of the vehicle.
    pub control: Control,
    /// Where it leads.
    pub target: Pose,
    /// Whether a label is to be read at its end.
    pub wants_label: bool,
    /// Actions whose position was looked at to find it.
    pub examined: u32,
    /// Whether a search of all actions would find the same. If not, the plan's looks were used up, and this is the best
    /// motion found so far.
    pub proven: bool,
}

impl Motion {
    /// The motion of an action that a search has found from a pose.
    pub(crate) fn of<D: Dynamics>(
        stage: Option<Stage>,
        pose: Pose,
        found: &Found,
        dynamics: &D,
        effort: Effort,
    ) -> Self {
        let &Found { recovery, action, target } = found;
        Self {
            stage,
            recovery,
            action,
            control: dynamics.control(pose, action),
            target,
            wants_label: !matches!(recovery, Some(Recovery::Reorient | Recovery::Transit)),
            examined: effort.examined,
            proven: effort.is_enough(),
        }
    }
}

/// Why a planner has no further motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum StopReason {
    /// What is uncertain is thinner than the action grid can hit, or lies outside the area. Finer turns and speeds may
    /// hit it.
    Resolution,
    /// The sample buffer is full.
    SamplesFull,
    /// The agent is outside the mission area, and no motion leads back.
    OutsideArea,
    /// There is uncertain ground, but no motion that leads towards it: the border or a keep-out is in the way, or the
    /// agent cannot turn. Elsewhere, or facing another way, it may go on.
    Cornered,
    /// The line is known as well as was asked for.
    Known,
    /// There is uncertain ground, but none of the ways that a plan tries leads there. Shorter motions or finer turns may
    /// find one.
    Undecided,
    /// What is uncertain is so thin that no label can tell more, as positions err by the [tolerance]. Only better positions
    /// help.
    ///
    /// [tolerance]: crate::belief::tolerance::Tolerance
    Tolerance,
    /// No straight, still line explains the labels: on ground that was certain the [audit] read the other label, or too
    /// often where labels may be wrong; or the labels of the whole mission amount to an alarm. The boundary bends or moves,
    /// or the sensor fails. A shorter stretch, or a tolerance that covers the bend, may help.
    ///
    /// [audit]: crate::watch::Audit
    NoLine,
    /// No label was in sight that is expected to carry the [least bits] asked for, for up to sixteen motions. Fewer bits let
    /// the mission go on.
    ///
    /// [least bits]: crate::planner::sight::AnySight::with_least_bits
    Worth,
    /// The robot has gone along all of a [front](crate::Track): it is back where it found it, or the front has led it
    /// out of the area at both ends.
    Closed,
    /// All of the area most likely has one label: no patch of the radius that was sought is left, and no boundary that
    /// crosses the area. See [`OneLabel`](crate::planner::one_label::OneLabel).
    OneLabel,
}

impl From<DeadEnd> for StopReason {
    fn from(dead_end: DeadEnd) -> Self {
        match dead_end {
            DeadEnd::Resolution => Self::Resolution,
            DeadEnd::Cornered => Self::Cornered,
            DeadEnd::Undecided => Self::Undecided,
            DeadEnd::Tolerance => Self::Tolerance,
            DeadEnd::Outside => Self::OutsideArea,
        }
    }
}

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Plan {
    /// Make this motion.
    Move(Motion),
    /// The mission is over.
    Stop(StopReason),
}

/// A planner: it returns motions, takes in their results, and reports at any time what it knows.
pub trait Planner {
    /// What is known of the line.
    type Belief: Belief + ?Sized;

    /// The next motion from a pose.
    fn plan(&mut self, pose: Pose) -> Plan;

    /// Takes in where the motion ended and what was sensed there, if a sample was taken. The position may be off by the
    /// tolerance that was configured.
    ///
    /// # Errors
    /// [`ObservationError`] when the reading contradicts what is known or cannot be stored; the planner is
    /// then as it was.
    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), ObservationError> {
        self.observe_within(pose, reading, self.belief().tolerance())
    }

    /// As [`observe`](Self::observe), for a position that may be off by `tolerance`. Use it with a localisation that
    /// reports its own error. The smaller the tolerance, the more the label tells.
    ///
    /// No position may be off by more than the tolerance that was configured. Motions stay that far from the border and
    /// from keep-outs, whatever the tolerance of single observations. Without a reading, `tolerance` has no effect.
    ///
    /// # Errors
    /// As `observe`, and [`ObservationError::Tolerance`] where it is more than was configured.
    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError>;

    /// Takes in what was read at a site on the way, before the motion that was planned last has ended. Returns whether
    /// the belief kept it: see [`Belief::observe_on_the_way`].
    ///
    /// Only the belief learns. The motion goes on, and its end is [observed](Self::observe) as without the reading. A
    /// reading that was kept counts as a label for the rule that a mission ends after long turns without one.
    ///
    /// A planner that leaves out this method takes in no such readings.
    ///
    /// # Errors
    /// [`ObservationError`] when the reading contradicts what is known; the planner is then as it was.
    fn observe_on_the_way(
        &mut self,
        _site: Site,
        _reading: Reading,
    ) -> Result<bool, ObservationError> {
        Ok(false)
    }

    /// What is known.
    fn belief(&self) -> &Self::Belief;

    /// What speaks against the model, if it is much. A [`Watched`](crate::watch::Watched) planner and those that begin from
    /// nothing count evidence: any other has `None`.
    fn alarm(&self) -> Option<Alarm> {
        None
    }

    /// Where the front is known best. Only a [follower](crate::Track) of fronts says so: any other has `None`.
    fn front(&self) -> Option<FrontState> {
        None
    }

    /// The line as far as it is known: all three estimates.
    fn estimates(&self) -> Estimates {
        self.belief().estimates()
    }

    /// The best estimate: the mean of the lines left, or of their distribution. `None` where there is none. A program
    /// that asks for this one alone does not carry the others.
    fn estimate(&self) -> Option<Line> {
        self.belief().centre().map(Line::from)
    }
}

impl<T: Planner + ?Sized> Planner for &mut T {
    type Belief = T::Belief;

    fn plan(&mut self, pose: Pose) -> Plan {
        T::plan(self, pose)
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        T::observe_within(self, pose, reading, tolerance)
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        T::observe_on_the_way(self, site, reading)
    }

    fn belief(&self) -> &T::Belief {
        T::belief(self)
    }

    fn alarm(&self) -> Option<Alarm> {
        T::alarm(self)
    }

    fn front(&self) -> Option<FrontState> {
        T::front(self)
    }
}
