//! What planners to compare with have in common: one planner, and how each of them chooses its motions.

use planner_core::dynamics::{Action, Dynamics};
use planner_core::error::ObservationError;
use planner_core::{Belief, Motion, Plan, Planner, Pose, Reading, Site, StopReason, Tolerance};

use crate::mission::read_out::ReadOut;
use crate::mission::terrain::Terrain;

/// What a planner to compare with has at hand.
pub struct Ground<D, B: ?Sized = dyn ReadOut, G = Terrain> {
    /// The action set.
    pub dynamics: D,
    /// Where positions stay.
    pub area: G,
    /// What has been learnt on the way.
    pub belief: Box<B>,
}

/// How a planner to compare with chooses its motions.
pub trait Strategy<D, B: ?Sized = dyn ReadOut, G = Terrain> {
    /// The next motion from a pose.
    ///
    /// # Errors
    /// Why there is none.
    fn choose(&mut self, ground: &Ground<D, B, G>, pose: Pose) -> Result<Motion, StopReason>;

    /// Takes note that the motion that was chosen last has ended, before the belief takes in its reading.
    fn arrive(&mut self, _: &Ground<D, B, G>, _: Pose, _: Option<Reading>) {}
}

/// A planner to compare with.
pub struct Baseline<S, D, B: ?Sized = dyn ReadOut, G = Terrain> {
    /// How it chooses.
    pub strategy: S,
    /// What it has at hand.
    pub ground: Ground<D, B, G>,
}

/// A motion that asks for a label and poses no problem.
pub fn motion(dynamics: &impl Dynamics, pose: Pose, action: Action, target: Pose) -> Motion {
    Motion {
        stage: None,
        recovery: None,
        action,
        control: dynamics.control(pose, action),
        target,
        wants_label: true,
        examined: 1,
        proven: true,
    }
}

impl<S: Strategy<D, B, G>, D, B: Belief + ?Sized, G> Planner for Baseline<S, D, B, G> {
    type Belief = B;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.ground.belief.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        self.strategy.choose(&self.ground, pose).map_or_else(Plan::Stop, Plan::Move)
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.strategy.arrive(&self.ground, pose, reading);
        let belief = &mut self.ground.belief;
        reading.map_or(Ok(()), |reading| belief.observe_within(pose.site, reading, tolerance))
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        self.ground.belief.observe_on_the_way(site, reading)
    }

    fn belief(&self) -> &B {
        &self.ground.belief
    }
}
