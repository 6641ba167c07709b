//! A planner whose labels are watched: the [`Evidence`] of its mission against the model.

use crate::belief::evidence::{Alarm, Evidence};
use crate::belief::sample::Reading;
use crate::belief::tolerance::Tolerance;
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::lattice::Site;
use crate::motion::dynamics::Pose;
use crate::planner::front_state::FrontState;
use crate::planner::{Plan, Planner};

/// A planner, and the evidence of its labels against a straight, still line and a sensor as described.
///
/// It plans as the planner alone. It computes the chance of each label before it is taken in.
#[derive(Clone, Debug)]
pub struct Watched<P> {
    planner: P,
    evidence: Evidence,
}

impl<P: Planner> Watched<P> {
    /// A planner that has taken in no label yet.
    #[inline] // it is made where it stays, as it may be large
    pub const fn new(planner: P) -> Self {
        Self { planner, evidence: Evidence::NONE }
    }

    /// The planner.
    pub const fn planner(&self) -> &P {
        &self.planner
    }

    /// The evidence so far.
    pub const fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// What speaks against the model, if it is much.
    pub fn alarm(&self) -> Option<Alarm> {
        self.evidence.alarm()
    }
}

impl<P: Planner> Planner for Watched<P> {
    type Belief = P::Belief;

    fn plan(&mut self, pose: Pose) -> Plan {
        self.planner.plan(pose)
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        let label = if let Some(Reading::Side(label)) = reading { Some(label) } else { None };
        let chance = label.map_or(1.0, |label| self.belief().chance_of(pose.site, label));
        let taken = self.planner.observe_within(pose, reading, tolerance);
        let counts = matches!(taken, Ok(()) | Err(ObservationError::Contradiction(_)));
        if let Some(label) = label.filter(|_| counts) {
            self.evidence.observe(label, chance);
        }
        taken
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let label = if let Reading::Side(label) = reading { Some(label) } else { None };
        let chance = label.map_or(1.0, |label| self.belief().chance_of(site, label));
        let taken = self.planner.observe_on_the_way(site, reading);
        // What the belief leaves out counts for nothing here either: the chance of the next label near by does not know of
        // it. Of a true model no label is a contradiction, so what counts does not depend on what was read.
        let counts = matches!(taken, Ok(true) | Err(ObservationError::Contradiction(_)));
        if let Some(label) = label.filter(|_| counts) {
            self.evidence.observe(label, chance);
        }
        taken
    }

    fn belief(&self) -> &P::Belief {
        self.planner.belief()
    }

    fn alarm(&self) -> Option<Alarm> {
        self.evidence.alarm()
    }

    fn front(&self) -> Option<FrontState> {
        self.planner.front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::sample::{Label, Sample};
    use crate::belief::true_labels::VersionSpace;
    use crate::geometry::heading::Heading;
    use crate::planner::StopReason;

    /// A planner that says something of its own wherever the trait has an answer for all.
    struct Outspoken(VersionSpace<8>);

    impl Planner for Outspoken {
        type Belief = VersionSpace<8>;

        fn plan(&mut self, _: Pose) -> Plan {
            Plan::Stop(StopReason::Worth)
        }

        fn observe_within(
            &mut self,
            _: Pose,
            _: Option<Reading>,
            _: Tolerance,
        ) -> Result<(), ObservationError> {
            Err(ObservationError::Reliability)
        }

        fn observe_on_the_way(&mut self, _: Site, _: Reading) -> Result<bool, ObservationError> {
            Ok(true)
        }

        fn belief(&self) -> &VersionSpace<8> {
            &self.0
        }

        fn front(&self) -> Option<FrontState> {
            Some(FrontState { waist: None, is_closed: true })
        }
    }

    /// What a planner answers, whoever is asked in its name.
    fn answers(mut planner: impl Planner) {
        let pose = Pose { site: Site::ORIGIN, heading: Heading::default() };
        assert_eq!(planner.plan(pose), Plan::Stop(StopReason::Worth));
        assert_eq!(planner.observe(pose, None), Err(ObservationError::Reliability));
        assert_eq!(planner.observe_on_the_way(pose.site, Label::Positive.into()), Ok(true));
        assert!(planner.front().is_some_and(|it| it.is_closed));
    }

    #[test]
    fn it_hands_on_all_that_its_planner_says() {
        let given = [
            Sample::at([0.0, 0.0], Label::Negative).unwrap(),
            Sample::at([4.0, 0.0], Label::Negative).unwrap(),
            Sample::at([2.0, 5.0], Label::Positive).unwrap(),
        ];
        let outspoken = || Outspoken(VersionSpace::new(&given).unwrap());
        answers(&mut outspoken());
        answers(Watched::new(outspoken()));
        answers(&mut Watched::new(outspoken()));
    }
}
