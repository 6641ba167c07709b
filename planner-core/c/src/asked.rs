//! What is asked of a planner, whether its labels are true or doubtful.

use planner_core::error::ObservationError;
use planner_core::{
    Belief as _, CellPosterior, FromLog, Lookahead, NoisyBelief, Persist, Planner as _,
    PredictiveBelief, Reliability, Site, SlopeWithin, Tolerance, Unicycle, VersionSpace,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::area::Ground;
use crate::snapshot::Snapshot;
use crate::types::{Line, Status};

/// A belief that can take in a label whose reliability differs from the mission's.
trait Believe: PredictiveBelief<Verdicts: Serialize + DeserializeOwned> {
    /// How reliable the labels of the mission are.
    fn usual(known: &Self::Belief) -> Reliability;

    /// Takes in a label of another reliability.
    fn take(
        &mut self,
        sample: planner_core::Sample,
        believed: Reliability,
    ) -> Result<(), ObservationError>;
}

/// Labels are always right.
impl<const N: usize> Believe for VersionSpace<N> {
    fn usual(_: &Self) -> Reliability {
        Reliability::CERTAIN
    }

    fn take(&mut self, _: planner_core::Sample, _: Reliability) -> Result<(), ObservationError> {
        Err(ObservationError::Reliability)
    }
}

impl<const N: usize, const H: usize> Believe for NoisyBelief<N, H> {
    fn usual(known: &CellPosterior<N, H>) -> Reliability {
        known.noise().reliability
    }

    fn take(
        &mut self,
        sample: planner_core::Sample,
        believed: Reliability,
    ) -> Result<(), ObservationError> {
        Self::take(self, sample, believed)
    }
}

/// What is asked of either planner.
pub(crate) trait Asked {
    fn observe(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
    ) -> Result<(), Status>;

    fn observe_within(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
        tolerance: Tolerance,
    ) -> Result<(), Status>;

    fn observe_believed(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
        believed: Reliability,
    ) -> Result<(), Status>;

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: planner_core::Reading,
    ) -> Result<(), Status>;

    fn centre(&self) -> Option<Line>;
    fn bits(&self) -> f64;
    fn chance(&self, site: Site) -> f64;
    fn save(&self) -> Option<Snapshot>;
    fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Status>;
}

impl<B> Asked for Lookahead<Unicycle, B, Ground, SlopeWithin>
where
    B: Believe + FromLog<ObservationLog: Serialize + DeserializeOwned>,
{
    fn observe(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
    ) -> Result<(), Status> {
        planner_core::Planner::observe(self, pose, reading).map_err(Status::from)
    }

    fn observe_within(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
        tolerance: Tolerance,
    ) -> Result<(), Status> {
        planner_core::Planner::observe_within(self, pose, reading, tolerance).map_err(Status::from)
    }

    fn observe_believed(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
        believed: Reliability,
    ) -> Result<(), Status> {
        if believed == B::usual(self.belief()) {
            return Asked::observe(self, pose, reading);
        }
        let Some(planner_core::Reading::Side(label)) = reading else {
            return Asked::observe(self, pose, reading);
        };
        let before = self.snapshot();
        let sample = planner_core::Sample { site: pose.site, label };
        self.belief_mut().take(sample, believed).map_err(|refused| {
            // `belief_mut` has reset the turns. The snapshot is this planner's own, so it is restored.
            let _ = Persist::restore(self, &before);
            refused.into()
        })
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: planner_core::Reading,
    ) -> Result<(), Status> {
        let kept = planner_core::Planner::observe_on_the_way(self, site, reading);
        kept.map(|_| ()).map_err(Status::from)
    }

    fn centre(&self) -> Option<Line> {
        self.estimate().map(Line::from)
    }

    fn bits(&self) -> f64 {
        self.belief().information()
    }

    fn chance(&self, site: Site) -> f64 {
        self.belief().chance(site)
    }

    fn save(&self) -> Option<Snapshot> {
        Snapshot::of(self)
    }

    fn restore(&mut self, snapshot: &Snapshot) -> Result<(), Status> {
        snapshot.wake(self)
    }
}
