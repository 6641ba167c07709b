//! Sleep and wake: what has to outlive a planner for the next one to plan the same.
//!
//! Settings (area, dynamics, noise, goal) are the program's and stay there. A [`Snapshot`] is what a mission adds to them,
//! and no more: what its belief was told, how it turned since the last label, and the way that is under way. For Algorithm 1
//! it is also where that stands. With the feature `serde` it goes to bytes and back, in any format that serde has:
//!
//! ```text
//! awake:   let bytes = to_slice(&(agent.pose(), agent.planner.snapshot()), &mut backup)?;
//! asleep:  power may go; `backup` must not
//! woken:   let (pose, snapshot) = from_bytes(backup)?;
//!          let mut planner = Cfc::new(config, dynamics, space)?;    // as it was made at the start
//!          planner.restore(&snapshot)?;
//!          let agent = Agent::new(planner, vehicle, pose);
//! ```
//!
//! Keep a check sum beside bytes that may be spoilt: those that contradict themselves are refused, those that
//! are merely untrue can not be told.

use crate::belief::told::NotReplayed;
use crate::planner::Planner;

/// The version of snapshots: it is what is written first, and changes when what follows does. From 2 on they hold the
/// tolerances that observations brought, and how a planner turned since the last label; from 3 on the way that is under way.
pub const VERSION: u16 = 3;

/// What a planner has to remember over a sleep: what its belief was told (`T`), and what else it plans by (`M`).
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Snapshot<T, M> {
    version: u16,
    told: T,
    memory: M,
}

impl<T, M> Snapshot<T, M> {
    pub(crate) const fn new(told: T, memory: M) -> Self {
        Self { version: VERSION, told, memory }
    }

    /// What it holds, if it is of this version.
    pub(crate) fn open(&self) -> Result<(&T, &M), NotRestored> {
        let Self { version, told, memory } = self;
        let is_known = *version == VERSION;
        is_known.then_some((told, memory)).ok_or(NotRestored::Version(*version))
    }

    /// What the belief was told.
    pub const fn told(&self) -> &T {
        &self.told
    }
}

/// A planner that can sleep and wake.
pub trait Persist: Planner {
    /// What it has to remember.
    type Snapshot;

    /// What it has to remember to plan the same again.
    fn snapshot(&self) -> Self::Snapshot;

    /// Goes on from where another was, of the same type and with the same settings. What it was told itself is
    /// forgotten. It costs what the labels cost when they came.
    ///
    /// # Errors
    /// [`NotRestored`]. The planner is then not to be flown with, but may be restored again.
    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), NotRestored>;
}

/// Why a planner does not go on from a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NotRestored {
    /// It is of this version, not of [`VERSION`].
    Version(u16),
    /// What was told is not taken in again.
    Told(NotReplayed),
}

impl core::fmt::Display for NotRestored {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Version(version) => write!(f, "a snapshot of version {version}, not {VERSION}"),
            Self::Told(why) => why.fmt(f),
        }
    }
}

impl core::error::Error for NotRestored {}

impl From<NotReplayed> for NotRestored {
    fn from(why: NotReplayed) -> Self {
        Self::Told(why)
    }
}
