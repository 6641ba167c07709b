//! How far look-ahead looks for labels: one motion ([`Near`]), or all of the area ([`Far`]).

use crate::belief::predictions::PredictiveBelief;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::decision::Decision;
use crate::planner::far::{Far, Journey, LOOKS};
use crate::search::lookout::Lookout;

/// How far look-ahead looks for labels: [`Near`] or [`Far`]. A program that is told at run time has `Option<Far>`.
pub trait Sight: Copy {
    /// What is remembered since the last label.
    #[doc(hidden)]
    type Journey: Copy + core::fmt::Debug + Default + PartialEq;

    /// The sight of a mission whose labels have such a price, or none. `None` if this is another.
    #[doc(hidden)]
    fn of(far: Option<Far>) -> Option<Self>;

    /// Looks that it takes of a plan, beside those at ends of one motion.
    #[doc(hidden)]
    fn looks(self) -> u32;

    /// What to do next; `None` if no label is in sight.
    #[doc(hidden)]
    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Self::Journey,
    ) -> Option<Decision>;

    /// Records that the motion was made, and whether a label was read.
    #[doc(hidden)]
    fn observe(journey: &mut Self::Journey, has_label: bool);
}

/// As far as one motion leads, two labels deep.
#[derive(Clone, Copy, Debug)]
pub struct Near;

impl Sight for Near {
    type Journey = ();

    fn of(far: Option<Far>) -> Option<Self> {
        far.is_none().then_some(Self)
    }

    fn looks(self) -> u32 {
        0
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        (): &mut (),
    ) -> Option<Decision> {
        Decision::of(belief, lookout, pose)
    }

    fn observe((): &mut (), _: bool) {}
}

impl Sight for Far {
    type Journey = Journey;

    fn of(far: Option<Far>) -> Option<Self> {
        far
    }

    fn looks(self) -> u32 {
        LOOKS
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Journey,
    ) -> Option<Decision> {
        Self::decide(self, belief, lookout, pose, journey)
    }

    fn observe(journey: &mut Journey, has_label: bool) {
        journey.observe(has_label);
    }
}

impl Sight for Option<Far> {
    type Journey = Journey;

    fn of(far: Option<Far>) -> Option<Self> {
        Some(far)
    }

    fn looks(self) -> u32 {
        self.map_or(0, Sight::looks)
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Journey,
    ) -> Option<Decision> {
        match self {
            None => Near.decide(belief, lookout, pose, &mut ()),
            Some(far) => far.decide(belief, lookout, pose, journey),
        }
    }

    fn observe(journey: &mut Journey, has_label: bool) {
        journey.observe(has_label);
    }
}
