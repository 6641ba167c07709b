//! What every planner is made of: an area, a vehicle and a belief, which must agree with each other.

use crate::belief::Belief;
use crate::belief::noise::Noise;
use crate::belief::sample::Sample;
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::GivenError;
use crate::belief::weight::Prior;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, RoomError};
use crate::planner::Planner;

/// Area, vehicle and belief contradict each other: no planner is made of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SetupError {
    /// The belief's tolerance leaves no place for motions to end: none is as far as this from the border.
    Tolerance(Tolerance),
    /// The vehicle's turning circle has no room in the area, less that tolerance.
    Room(RoomError),
    /// The belief is full: there is no room for a first label.
    Full,
    /// No line agrees with the given samples, or they do not bound the lines.
    Given(GivenError),
    /// A patch of the radius that was told does not suit the area.
    Patch {
        /// The least radius for an area of this size, metres: a smaller patch could be missed.
        least: f32,
        /// The radius that is too large for it, metres.
        most: f32,
    },
}

impl core::fmt::Display for SetupError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Tolerance(tolerance) => write!(
                f,
                "a tolerance of {} m leaves nothing of the area: no place is as far from the border",
                tolerance.metres()
            ),
            Self::Room(none) => none.fmt(f),
            Self::Full => {
                f.write_str("the given samples fill the belief: there is no room for a label")
            }
            Self::Given(why) => why.fmt(f),
            Self::Patch { least, most } => write!(
                f,
                "the radius of a patch in this area is from {least:.1} to below {most:.1} m: seek smaller ones in parts of it"
            ),
        }
    }
}

impl core::error::Error for SetupError {}

impl From<GivenError> for SetupError {
    fn from(why: GivenError) -> Self {
        Self::Given(why)
    }
}

/// The part of an area that motions aim for: all but a margin of the tolerance, or of the area's
/// [clearance](Workspace::with_clearance) if that is more. The vehicle can move there.
///
/// # Errors
/// [`SetupError::Tolerance`], [`SetupError::Room`].
pub fn aimed_for<D: Dynamics, G: Workspace>(
    area: G,
    dynamics: &D,
    tolerance: Tolerance,
) -> Result<G, SetupError> {
    let margin = tolerance.units().max(area.bounds().margin());
    let part = area.whole().inset(margin).ok_or(SetupError::Tolerance(tolerance))?;
    dynamics.fits(part.bounds()).map_err(SetupError::Room)?;
    Ok(part)
}

/// The same for what a belief knows of the tolerance, if it has room for a label.
pub(crate) fn aimed_for_by<D: Dynamics, G: Workspace>(
    area: G,
    dynamics: &D,
    belief: &(impl Belief + ?Sized),
) -> Result<G, SetupError> {
    if belief.is_full() {
        return Err(SetupError::Full);
    }
    aimed_for(area, dynamics, belief.tolerance())
}

/// A planner that is too large to be made elsewhere and moved. It begins a mission in the memory where it is.
pub trait Restart: Planner {
    /// The samples and the hypotheses that it has room for.
    const ROOM: [usize; 2];

    /// Begins again with what other given samples leave: see [`CellPosterior::restart`](crate::CellPosterior::restart).
    ///
    /// # Errors
    /// [`SetupError`], with the planner as it was.
    fn restart(&mut self, given: &[Sample], prior: Prior, noise: Noise) -> Result<(), SetupError>;
}
