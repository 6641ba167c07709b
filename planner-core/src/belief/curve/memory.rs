//! What a curve has to remember over a sleep: all that labels and motions have changed.

use heapless::Vec;

use crate::belief::curve::arc::Arc;
use crate::belief::curve::bank::Bank;
use crate::belief::curve::follower::{Curve, Passed};
use crate::belief::curve::gaussian::PLACES;
use crate::belief::evidence::Evidence;
use crate::belief::front::Learnt;
use crate::belief::observation_log::{FromLog, ReplayError};
use crate::belief::sample::Label;
use crate::geometry::mark::Mark;

/// What a curve knows, without what it was told: 3.4 kB.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CurveMemory {
    arc: Arc,
    is_flipped: bool,
    bank: Bank,
    /// The last one first.
    passed: Vec<Passed, PLACES, u8>,
    since: f32,
    learnt: Option<Learnt>,
    evidence: Evidence,
    run: (Option<Label>, u8),
    nowhere: [f32; 2],
    doubts: u8,
    is_begun: bool,
    is_fresh: bool,
}

impl CurveMemory {
    /// Whether a curve can have stored it.
    fn is_valid(&self) -> bool {
        let is_arc = |it: &Arc| it.bend.abs() < 1e6;
        let is_passed = |it: &Passed| is_arc(&it.arc) && (0.0..1e9).contains(&it.age);
        (!self.is_begun || self.bank.is_valid())
            && is_arc(&self.arc)
            && self.passed.iter().all(is_passed)
            && self.since.abs() < 1e3
            && self.nowhere.iter().all(|it| (0.0..=1.0).contains(it))
            && self.learnt.is_none_or(Learnt::is_valid)
    }
}

impl FromLog for Curve {
    type ObservationLog = CurveMemory;

    fn log(&self) -> CurveMemory {
        let Self { arc, is_flipped, ref bank, ref passed, since, .. } = *self;
        let Self { learnt, evidence, run, nowhere, doubts, is_begun, is_fresh, .. } = *self;
        let passed = passed.iter().copied().collect();
        let bank = bank.clone();
        CurveMemory {
            arc,
            is_flipped,
            bank,
            passed,
            since,
            learnt,
            evidence,
            run,
            nowhere,
            doubts,
            is_begun,
            is_fresh,
        }
    }

    fn mark(&self) -> Mark {
        self.noise.mark().and([self.reach, self.pace].map(f32::to_bits))
    }

    /// Goes on from there at once: nothing is replayed.
    fn replay(&mut self, log: &CurveMemory) -> Result<(), ReplayError> {
        if !log.is_valid() {
            return Err(ReplayError::Spoilt);
        }
        if log.learnt.is_some() != self.learnt.is_some() {
            return Err(ReplayError::Kind);
        }
        let log = log.clone();
        (self.arc, self.is_flipped, self.bank) = (log.arc, log.is_flipped, log.bank);
        self.passed.clear();
        for it in log.passed {
            let _ = self.passed.push_back(it); // there is room
        }
        (self.since, self.learnt, self.evidence) = (log.since, log.learnt, log.evidence);
        (self.run, self.nowhere, self.doubts) = (log.run, log.nowhere, log.doubts);
        (self.is_begun, self.is_fresh) = (log.is_begun, log.is_fresh);
        self.mapped.clear();
        Ok(())
    }
}
