//! How missions went: what was planned, how often the recovery ladder was needed, and why they ended.

use std::collections::BTreeMap;

use planner_core::Step;
use planner_core::search::recovery::Recovery;
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

/// How the missions of a campaign went.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// How many ended for which reason.
    pub(crate) ends: BTreeMap<String, u64>,
    /// How many steps climbed to which rung of the recovery ladder.
    pub(crate) recoveries: BTreeMap<&'static str, u64>,
    /// Motions planned.
    pub(crate) plans: u64,
    /// Actions whose position they looked at.
    pub(crate) examined: u64,
    /// The most that one plan looked at.
    pub(crate) most_examined: u32,
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
}

impl Tally {
    /// One more mission, by its course to the end.
    pub(crate) fn add(&mut self, course: &Course) {
        let Course { ended, plans, examined, most_examined, undirected, reorient, transit } =
            course;
        *self.ends.entry(ended.clone()).or_default() += 1;
        for (rung, times) in [
            (Recovery::Undirected, undirected),
            (Recovery::Reorient, reorient),
            (Recovery::Transit, transit),
        ] {
            if *times > 0 {
                *self.recoveries.entry(recovery_name(rung)).or_default() += times;
            }
        }
        self.plans += plans;
        self.examined += examined;
        self.most_examined = self.most_examined.max(*most_examined);
    }
}
