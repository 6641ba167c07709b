//! Sleep and wake: what a planner must store so that its successor plans the same.
//!
//! The settings (area, dynamics, noise, goal) are part of the program. A [`Snapshot`] contains only what a mission adds
//! to them: the samples of the belief, the turns since the last label, and the way that is under way. For Algorithm 1
//! it also contains the phase, for Algorithm 2 the parity of readings on the way, for look-ahead the audit. With the feature `serde` a snapshot converts to bytes and back,
//! in any format that serde supports:
//!
//! ```text
//! awake:   let bytes = to_slice(&(agent.pose(), agent.planner.snapshot()), &mut backup)?;
//! asleep:  power may go; `backup` must not
//! woken:   let (pose, snapshot) = from_bytes(backup)?;
//!          let mut planner = Cfc::new(area, dynamics, space)?;      // as it was made at the start
//!          planner.restore(&snapshot)?;
//!          let agent = Agent::new(planner, vehicle, pose);
//! ```
//!
//! Store a checksum with bytes that may be spoilt. `restore` refuses bytes that contradict themselves, and those of a
//! mission with other settings, but cannot detect bytes that are merely wrong.

use crate::belief::observation_log::ReplayError;
use crate::geometry::mark::Mark;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, RayFan};
use crate::planner::Planner;

/// The version of snapshots. It is written first, and changes whenever the data that follow change.
///
/// | from | they hold |
/// | --- | --- |
/// | 2 | the tolerances that observations brought, and how a planner turned since the last label |
/// | 3 | the way that is under way |
/// | 4 | the audit of look-ahead |
/// | 5 | its odds |
/// | 6 | how many motions its way should take, and of Algorithm 2 whether the readings on the way are odd in number |
/// | 7 | of a grid of lines, where it last counted a label |
/// | 9 | which mission they are of, and of look-ahead what speaks against the model |
/// | 11 | of a planner that seeks a boundary, the labels of an area and the route through it |
/// | 12 | of a front that is watched, where it was all along the stretch |
pub const SNAPSHOT_VERSION: u16 = 13;

/// What a planner has to remember over a sleep: the log of its belief (`T`), and what else it plans by (`M`).
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Snapshot<T, M> {
    version: u16,
    mark: Mark,
    log: T,
    memory: M,
}

impl<T, M> Snapshot<T, M> {
    pub(crate) const fn new(mark: Mark, log: T, memory: M) -> Self {
        Self { version: SNAPSHOT_VERSION, mark, log, memory }
    }

    /// The log and the memory, if the snapshot is of this version and of a mission with this mark.
    pub(crate) fn open(&self, of: Mark) -> Result<(&T, &M), RestoreError> {
        let Self { version, mark, log, memory } = self;
        if *version != SNAPSHOT_VERSION {
            return Err(RestoreError::Version(*version));
        }
        (*mark == of).then_some((log, memory)).ok_or(RestoreError::Mission)
    }

    /// The log of what the belief took in.
    pub const fn log(&self) -> &T {
        &self.log
    }
}

/// Who plans.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    Cfc = 1,
    Scc,
    Lookahead,
    Track,
    Guard,
    Seek,
}

/// What tells a mission from others: its planner, its vehicle, the area in which it aims, and what its belief was told. Not
/// what may change under way, as a goal and prices.
pub(crate) fn mark<D: Dynamics, G: Workspace>(
    planner: Kind,
    (dynamics, area): (&D, &G),
    belief: Mark,
) -> Mark {
    let (grid, RayFan { left, right, spacing }) = (dynamics.grid(), dynamics.fan());
    let fastest = grid.speeds().saturating_sub(1);
    let vehicle = [left, right, spacing.0, fastest.into(), grid.reach_mm(fastest)];
    belief.and([planner as u32]).and(vehicle).within(area)
}

/// A planner that can sleep and wake.
pub trait Persist: Planner {
    /// What it has to remember.
    type Snapshot;

    /// What it has to remember to plan the same again.
    fn snapshot(&self) -> Self::Snapshot;

    /// Continues from the state of another planner of the same type and with the same settings. This planner's own
    /// samples are forgotten. It costs as much as the labels did when they came.
    ///
    /// # Errors
    /// [`RestoreError`]. Do not plan with the planner then. It may be restored again.
    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError>;
}

/// Why a planner does not go on from a snapshot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RestoreError {
    /// It is of this version, not of [`SNAPSHOT_VERSION`].
    Version(u16),
    /// It is of a mission with another planner, area, vehicle, noise, tolerance or front. Make the planner as that was
    /// made.
    Mission,
    /// The belief does not take in the log.
    Log(ReplayError),
}

impl core::fmt::Display for RestoreError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Version(version) => {
                write!(f, "a snapshot of version {version}, not {SNAPSHOT_VERSION}")
            }
            Self::Mission => f.write_str(
                "a snapshot of a mission with another planner, area, vehicle, noise, tolerance or front",
            ),
            Self::Log(why) => why.fmt(f),
        }
    }
}

impl core::error::Error for RestoreError {}

impl From<ReplayError> for RestoreError {
    fn from(why: ReplayError) -> Self {
        Self::Log(why)
    }
}
