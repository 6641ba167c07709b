//! How missions went: what was planned, how often the recovery ladder was needed, and why they ended.

use planner_core::{Recovery, Step};
use serde::Serialize;

use crate::mission::results::recovery_name;

/// How a mission has gone so far. Every row of a campaign ends with it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Course {
    /// Why the mission ended: the same in all its rows.
    pub ended: String,
    /// Motions planned so far.
    pub plans: u64,
    /// Actions whose position they looked at.
    pub examined: u64,
    /// The most that one plan looked at.
    pub most_examined: u32,
    /// Steps that climbed to this rung of the recovery ladder.
    pub undirected: u64,
    /// The next rung.
    pub reorient: u64,
    /// The last.
    pub transit: u64,
}

impl Course {
    /// One more step.
    pub(crate) fn count(&mut self, step: &Step) {
        self.plans += 1;
        self.examined += u64::from(step.motion.examined);
        self.most_examined = self.most_examined.max(step.motion.examined);
        match step.motion.recovery {
            Some(Recovery::Undirected) => self.undirected += 1,
            Some(Recovery::Reorient) => self.reorient += 1,
            Some(Recovery::Transit) => self.transit += 1,
            None => {}
        }
    }

    /// How often it climbed to each rung of the recovery ladder.
    pub(crate) fn rungs(&self) -> [(&'static str, u64); 3] {
        [
            (recovery_name(Recovery::Undirected), self.undirected),
            (recovery_name(Recovery::Reorient), self.reorient),
            (recovery_name(Recovery::Transit), self.transit),
        ]
    }
}
