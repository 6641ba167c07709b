//! The parts of every planner, read from a mission and its given samples before any memory is written.

use planner_core::{Label, Noise, Site, Unicycle, aimed_for};

use crate::area::Ground;
use crate::mission::Mission;
use crate::status::Status;
use crate::types::Sample;
use crate::verdict::Refusal;

/// Given samples at most.
pub(crate) const MOST_GIVEN: usize = 16;

/// Parts that agree with each other.
pub(crate) struct Parts {
    /// The part of the area that motions aim for.
    pub(crate) ground: Ground,
    pub(crate) unicycle: Unicycle,
    /// How often labels are right, and how far positions may be off.
    pub(crate) noise: Noise,
    samples: [planner_core::Sample; MOST_GIVEN],
    count: usize,
}

impl Parts {
    /// Reads a mission and its given samples.
    ///
    /// # Errors
    /// What of them is refused, and why.
    ///
    /// # Safety
    /// As for [`Mission::ground`].
    pub(crate) unsafe fn new(mission: &Mission<'_>, given: &[Sample]) -> Result<Self, Refusal> {
        let refusal = |status| Refusal::of(status, c"given");
        let mut samples =
            [planner_core::Sample { site: Site::ORIGIN, label: Label::Negative }; MOST_GIVEN];
        let places = samples.get_mut(..given.len()).ok_or(refusal(Status::Given))?;
        for (number, (place, sample)) in places.iter_mut().zip(given).enumerate() {
            *place = sample.read().map_err(|status| refusal(status).about(number))?;
        }
        // SAFETY: the caller promises it.
        let ground = unsafe { mission.ground() }?;
        let (noise, unicycle) = (mission.noise()?, mission.unicycle()?);
        let too_large = Refusal::of(Status::ToleranceTooLarge, c"tolerance");
        let ground = aimed_for(ground, &unicycle, noise.tolerance).map_err(|_| too_large)?;
        Ok(Self { ground, unicycle, noise, samples, count: given.len() })
    }

    /// The given samples.
    pub(crate) fn given(&self) -> &[planner_core::Sample] {
        self.samples.get(..self.count).unwrap_or_default()
    }
}
