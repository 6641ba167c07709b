//! The seam between a planner and the loop that runs it: `plan()`, then `observe()`; `estimates()` at any time.

pub mod cfc;
pub mod config;
pub mod scc;

use crate::belief::estimate::Estimates;
use crate::belief::sample::Reading;
use crate::belief::version_space::Refused;
use crate::motion::action::{Action, Control};
use crate::motion::dynamics::Pose;

/// Which one-step problem a motion answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Stage {
    /// Look for the opposite label.
    P1,
    /// Follow the boundary.
    P2,
    /// Explore directions in which no hypothesis has the boundary.
    P3,
    /// Explore directions in which some hypothesis has it.
    P4,
}

/// What was done as the problem itself had no feasible action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum Recovery {
    /// The same problem without its rule on directions.
    Undirected,
    /// A turn in place; no sample is taken.
    Reorient,
    /// A drive through certain ground; no sample is taken.
    Transit,
}

/// A motion to make.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
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
    /// Actions whose position was looked at to find it.
    pub examined: u32,
    /// Whether it is what a search of all actions would find; else the plan's looks were used up, and it
    /// is the best so far.
    pub proven: bool,
}

impl Motion {
    /// Whether a sample is to be taken at its end.
    pub fn samples(&self) -> bool {
        !matches!(self.recovery, Some(Recovery::Reorient | Recovery::Transit))
    }
}

/// Why a planner has no further motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "wire", derive(serde::Serialize, serde::Deserialize))]
pub enum StopReason {
    /// What is uncertain is thinner than the action grid can hit, or lies outside the area.
    Resolution,
    /// The sample buffer is full.
    SamplesFull,
    /// The agent stands outside the mission area.
    OutsideArea,
    /// There is uncertain ground, but no motion that leads towards it: the border is in the way, or the
    /// agent cannot turn.
    Cornered,
    /// A plan may look at so many rays, and none of these was a way on.
    Undecided,
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

/// A planner: asked for a motion, told what came of it, and in the end asked for the line.
pub trait Planner {
    /// The next motion from a pose.
    fn plan(&mut self, pose: Pose) -> Plan;

    /// Takes in where the motion ended and what was sensed there, if a sample was taken.
    ///
    /// # Errors
    /// [`Refused`] when the reading contradicts what is known or cannot be stored; the planner is
    /// then as it was.
    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused>;

    /// The line as far as it is known.
    fn estimates(&self) -> Estimates;
}

impl<T: Planner + ?Sized> Planner for &mut T {
    fn plan(&mut self, pose: Pose) -> Plan {
        T::plan(self, pose)
    }

    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused> {
        T::observe(self, pose, reading)
    }

    fn estimates(&self) -> Estimates {
        T::estimates(self)
    }
}
