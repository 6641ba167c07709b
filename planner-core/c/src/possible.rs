//! A mission as the C program gives it, checked before any memory is written.

use planner_core::error::GivenError;
use planner_core::{
    CellPosterior, Goal, Noise, Prior, Site, SlopeWithin, Tolerance, Unicycle, VersionSpace,
    aimed_for,
};

use crate::area::Ground;
use crate::types::{Mission, Sample, Status};
use crate::verdict::Refusal;

/// Given samples at most.
pub(crate) const MOST_GIVEN: usize = 16;

/// A mission that is possible, and its given samples.
pub(crate) struct Possible {
    pub(crate) area: Ground,
    pub(crate) tolerance: Tolerance,
    pub(crate) unicycle: Unicycle,
    pub(crate) goal: Option<Goal<SlopeWithin>>,
    pub(crate) noise: Option<Noise>,
    samples: [planner_core::Sample; MOST_GIVEN],
    count: usize,
}

impl Possible {
    /// Reads a mission and its given samples.
    ///
    /// # Errors
    /// What of them is refused, and why.
    pub(crate) fn new(mission: &Mission<'_>, given: &[Sample]) -> Result<Self, Refusal> {
        let refusal = |status| Refusal::of(status, c"given");
        let label = planner_core::Label::Negative;
        let mut samples = [planner_core::Sample { site: Site::ORIGIN, label }; MOST_GIVEN];
        let places = samples.get_mut(..given.len()).ok_or(refusal(Status::Given))?;
        for (number, (place, sample)) in places.iter_mut().zip(given).enumerate() {
            *place = sample.read().map_err(|status| refusal(status).about(number))?;
        }
        let (area, tolerance) = (mission.ground()?, mission.tolerance()?);
        let (unicycle, noise) = (mission.unicycle()?, mission.noise()?);
        let goal = mission.goal()?;
        let count = given.len();
        let possible = Self { area, tolerance, unicycle, goal, noise, samples, count };
        // With room for these samples alone.
        let is_found = if let Some(noise) = noise {
            CellPosterior::<MOST_GIVEN, 1>::new(possible.given(), Prior::Area, noise).map(drop)
        } else {
            VersionSpace::<MOST_GIVEN>::new(possible.given())
                .and_then(|it| it.with_tolerance(tolerance))
                .map(drop)
        };
        is_found.map_err(|why| match why {
            GivenError::NotSeparable(number) => refusal(Status::Given).about(number),
            _ => refusal(Status::Given),
        })?;
        let too_large = Refusal::of(Status::ToleranceTooLarge, c"tolerance");
        aimed_for(area, &unicycle, tolerance).map_err(|_| too_large)?;
        Ok(possible)
    }

    /// The given samples.
    pub(crate) fn given(&self) -> &[planner_core::Sample] {
        self.samples.get(..self.count).unwrap_or_default()
    }
}
