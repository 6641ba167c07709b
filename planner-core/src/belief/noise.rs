//! How far labels can be believed, and where.

use crate::belief::sample::Sample;
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::{AnyReliability, Trust};
use crate::belief::unknown_reliability::UnknownReliability;
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;
use crate::geometry::value::ValueError;

use crate::belief::reliability::Reliability;

/// What is known of the noise. `R` is a [`Reliability`] where the probability of a true label is known, otherwise an
/// [`UnknownReliability`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Noise<R = Reliability> {
    /// How far a label can be believed.
    pub reliability: R,
    /// Within this distance of a given sample's site labels are certain, lattice units; see
    /// [`Noise::radius`].
    pub trusted_radius: u32,
    /// How far a position may be from where it is reported; three standard deviations.
    pub tolerance: Tolerance,
}

impl Noise {
    /// Labels are always true.
    pub const NONE: Self =
        Self { reliability: Reliability::CERTAIN, trusted_radius: 0, tolerance: Tolerance::NONE };

    /// Labels that are true with probability `p` wherever they are read. Of a sensor that mostly reads the other label,
    /// swap the labels.
    ///
    /// # Errors
    /// [`ValueError`] unless it is above 0.5, and 1 at most.
    pub fn new(p: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError =
            ValueError("labels are true with a probability above 0.5; below it, swap the labels");
        if p <= 0.5 {
            return Err(RANGE);
        }
        Ok(Self { reliability: Reliability::new(p)?, ..Self::NONE })
    }

    /// A trusted radius in metres as lattice units; `None` when it is negative, not finite, or 8,192 m or more.
    pub fn radius(metres: f64) -> Option<u32> {
        u32::try_from(Site::metres([metres, 0.0]).ok()?.x()).ok()
    }

    /// The same for positions that err by a tolerance at most, metres or a [`Tolerance`].
    ///
    /// # Errors
    /// [`ValueError`] unless it is at least 0 and at most 1,024 m.
    pub fn with_tolerance(
        self,
        tolerance: impl TryInto<Tolerance, Error: Into<ValueError>>,
    ) -> Result<Self, ValueError> {
        Ok(Self { tolerance: tolerance.try_into().map_err(Into::into)?, ..self })
    }
}

impl Noise<UnknownReliability> {
    /// Labels that are true with a probability that nobody knows, wherever they are read. It is the same for all labels,
    /// and has the prior Beta(a, b); see [`UnknownReliability::beta`].
    ///
    /// # Errors
    /// As there.
    pub fn beta(a: f64, b: f64) -> Result<Self, ValueError> {
        let reliability = UnknownReliability::beta(a, b)?;
        Ok(Self { reliability, trusted_radius: 0, tolerance: Tolerance::NONE })
    }
}

impl<R: Trust> Noise<R> {
    /// What tells it from others.
    pub(crate) fn mark(&self) -> Mark {
        let Self { reliability, trusted_radius, tolerance } = *self;
        let is_unknown = reliability.unknown().is_some();
        let words = [trusted_radius, tolerance.units(), is_unknown.into()];
        Mark::NONE.and(words).and(reliability.nominal().words())
    }

    /// The reliability of a label at a site. It is certain in a trusted ball (the paper's `B_r(p_j)`), whose radius is
    /// reduced by the tolerance. Elsewhere it is [`Trust::nominal`].
    pub fn at(&self, site: Site, given: &[Sample]) -> Reliability {
        let radius = u64::from(self.trusted_radius.saturating_sub(self.tolerance.units()));
        let near = |s: &Sample| {
            let apart = site - s.site;
            apart.dot(apart).unsigned_abs() <= radius * radius
        };
        if radius > 0 && given.iter().any(near) {
            Reliability::CERTAIN
        } else {
            self.reliability.nominal()
        }
    }
}

impl From<Noise> for Noise<AnyReliability> {
    fn from(Noise { reliability, trusted_radius, tolerance }: Noise) -> Self {
        Self { reliability: reliability.into(), trusted_radius, tolerance }
    }
}

impl From<Noise<UnknownReliability>> for Noise<AnyReliability> {
    fn from(Noise { reliability, trusted_radius, tolerance }: Noise<UnknownReliability>) -> Self {
        Self { reliability: reliability.into(), trusted_radius, tolerance }
    }
}
