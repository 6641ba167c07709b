//! How far look-ahead looks for labels: one motion ([`Near`]), or all of the area ([`Far`]). And which of them it reads.

use crate::belief::goal::{Criterion, Goal};
use crate::belief::predictions::{OnTheWay, PredictiveBelief};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::decision::Decision;
use crate::planner::far::{FAR_LOOKS, Far, Journey};
use crate::search::lookout::Lookout;

/// How far look-ahead looks for labels: [`Near`] or [`Far`]. A program that is told at run time has [`AnySight`].
pub trait Sight: Copy {
    /// What is remembered since the last label.
    #[doc(hidden)]
    type Journey: Copy + core::fmt::Debug + Default + PartialEq;

    /// The sight that a mission asks for. `None` if this is another.
    #[doc(hidden)]
    fn of(asked: AnySight) -> Option<Self>;

    /// Bits that a label must be expected to carry, beside those of an audit; 0 if all may be read.
    #[doc(hidden)]
    fn least(self) -> f32 {
        0.0
    }

    /// Looks that it takes of a plan, beside those at ends of one motion.
    #[doc(hidden)]
    fn looks(self) -> u32;

    /// What to do next until a goal is met; `None` if no label is in sight.
    #[doc(hidden)]
    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace, C: Criterion>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        until: (Option<Goal<C>>, &mut Self::Journey),
    ) -> Option<Decision>;

    /// Records that the motion was made, and whether a label was read.
    #[doc(hidden)]
    fn observe(journey: &mut Self::Journey, has_label: bool);

    /// Forgets the way to a place, as another may be worth more by now.
    #[doc(hidden)]
    fn forget(journey: &mut Self::Journey);
}

/// As far as one motion leads, two labels deep.
#[derive(Clone, Copy, Debug)]
pub struct Near;

impl Sight for Near {
    type Journey = ();

    fn of(asked: AnySight) -> Option<Self> {
        (asked == AnySight::from(None)).then_some(Self)
    }

    fn looks(self) -> u32 {
        0
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace, C: Criterion>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        _: (Option<Goal<C>>, &mut ()),
    ) -> Option<Decision> {
        Decision::of((&belief.predictor(pose.site), belief.ground()), lookout, pose)
    }

    fn observe((): &mut (), _: bool) {}

    fn forget((): &mut ()) {}
}

impl Sight for Far {
    type Journey = Journey;

    fn of(asked: AnySight) -> Option<Self> {
        asked.far.filter(|far| asked == AnySight::from(Some(*far)))
    }

    fn looks(self) -> u32 {
        FAR_LOOKS
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace, C: Criterion>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        until: (Option<Goal<C>>, &mut Journey),
    ) -> Option<Decision> {
        Self::decide(self, (belief, &belief.predictor(pose.site)), lookout, pose, until)
    }

    fn observe(journey: &mut Journey, has_label: bool) {
        journey.observe(has_label);
    }

    fn forget(journey: &mut Journey) {
        journey.forget();
    }
}

/// The sight of a program that is told at run time: near or far, how many bits a label must be expected to carry, and how
/// many labels are read a motion.
///
/// Where no label in sight carries so many, the planner drives on without reading one, for sixteen motions at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AnySight {
    far: Option<Far>,
    /// Thousandths of a bit.
    least: u16,
    /// A motion.
    readings: u8,
}

/// All labels may be read: near sight where there is no price, else far sight.
impl From<Option<Far>> for AnySight {
    fn from(far: Option<Far>) -> Self {
        Self { far, least: 0, readings: 1 }
    }
}

impl AnySight {
    /// The same for a robot that reads so many labels a motion, evenly spread over its length, the last at its end. The
    /// planner chooses motions by what all of them tell together.
    #[must_use]
    pub const fn with_readings(self, readings: u8) -> Self {
        Self { readings, ..self }
    }

    /// The same, but it reads a label only where it is expected to carry so many bits, to the nearest thousandth. An
    /// audit's labels are read all the same.
    ///
    /// # Errors
    /// [`ValueError`] unless it is from 0 to 1. A label that is true with probability `p` carries `1 - H(p)` at most.
    pub fn with_least_bits(self, bits: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError = ValueError("a label can carry 0 to 1 bits");
        let least = libm::round(bits * 1e3) as u16;
        (0.0..=1.0).contains(&bits).then_some(Self { least, ..self }).ok_or(RANGE)
    }
}

impl Sight for AnySight {
    type Journey = Journey;

    fn of(asked: Self) -> Option<Self> {
        Some(asked)
    }

    fn least(self) -> f32 {
        1e-3 * f32::from(self.least)
    }

    fn looks(self) -> u32 {
        self.far.map_or(0, Sight::looks)
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace, C: Criterion>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        until: (Option<Goal<C>>, &mut Journey),
    ) -> Option<Decision> {
        let predictor = OnTheWay::new(belief.predictor(pose.site), pose.site, self.readings);
        match self.far {
            None => Decision::of((&predictor, belief.ground()), lookout, pose),
            Some(far) => far.decide((belief, &predictor), lookout, pose, until),
        }
    }

    fn observe(journey: &mut Journey, has_label: bool) {
        journey.observe(has_label);
    }

    fn forget(journey: &mut Journey) {
        journey.forget();
    }
}
