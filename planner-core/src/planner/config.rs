//! What a mission fixes beforehand: where it may go, what motion costs, and which directions are allowed.

use crate::belief::sample::Sample;
use crate::belief::tolerance::Tolerance;
use crate::geometry::arc::SlopeArc;
use crate::geometry::area::Area;
use crate::geometry::lattice::Vector;
use crate::geometry::region::Region;
use crate::motion::dynamics::{Dynamics, NoRoom};
use crate::search::direction_rule::ArcRule;
use crate::search::objective::Varrho;

/// How P1 looks for the opposite label (Section III-A).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Crossing {
    /// In any direction in which the boundary cannot run: P1 as printed.
    #[default]
    Unrestricted,
    /// Of these, only along the direction from the first oracle point to the second.
    AlongOracle,
    /// Of these, only at right angles to the bisector of the slope arc.
    AcrossBisector,
}

/// How P2 follows the boundary.
///
/// It has no default, as the algorithms need different ones. With [`cfc::FOLLOWING`](crate::planner::cfc::FOLLOWING)
/// Algorithm 1 learns the most. The same value costs Algorithm 2 a tenth of a bit in thirty labels, see
/// [`scc::FOLLOWING`](crate::planner::scc::FOLLOWING).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Following {
    /// In any direction in which the boundary can run: P2 as printed. It takes the smallest turn
    /// into the slope arc, so it skims ground that is all but certain and learns next to nothing.
    Unrestricted,
    /// Of these, only along the bisector of the slope arc, as Section III-A proposes for P1.
    AlongBisector,
}

/// What a mission fixes beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config<G = Area> {
    /// Where positions must stay.
    pub area: G,
    /// The weight of the control in the objective.
    pub varrho: Varrho,
    /// How P1 looks for the opposite label.
    pub crossing: Crossing,
    /// How P2 follows the boundary.
    pub following: Following,
    /// The largest distance of a position from where it is reported. Motions stay this far from the area's border. Give
    /// the same tolerance to the [version space](crate::belief::version_space::VersionSpace::within). An observation
    /// may bring a smaller one of its own, see [`Planner::observe_within`](crate::planner::Planner::observe_within).
    pub tolerance: Tolerance,
}

/// A mission's settings contradict each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ConfigError {
    /// The tolerance leaves no place for motions to end: none is as far as this from the border.
    Tolerance(Tolerance),
    /// The vehicle's turning circle has no room there.
    Room(NoRoom),
}

impl core::fmt::Display for ConfigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Tolerance(tolerance) => write!(
                f,
                "a tolerance of {} m leaves nothing of the area: no place is as far from the border",
                tolerance.metres()
            ),
            Self::Room(none) => none.fmt(f),
        }
    }
}

impl core::error::Error for ConfigError {}

impl<G: Region> Config<G> {
    /// Whether a vehicle can move where motions may end.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn admits<D: Dynamics>(self, dynamics: &D) -> Result<(), ConfigError> {
        self.inset_for(dynamics).map(drop)
    }

    /// The same for the area that motions aim for, if a vehicle can move there: all but a margin of the tolerance.
    pub(crate) fn inset_for<D: Dynamics>(self, dynamics: &D) -> Result<Self, ConfigError> {
        let area = self.area.inset(self.tolerance.units());
        let area = area.ok_or(ConfigError::Tolerance(self.tolerance))?;
        dynamics.fits(area.bounds()).map_err(ConfigError::Room)?;
        Ok(Self { area, ..self })
    }

    /// The directions in which P1, or P3, looks for the opposite label when the boundary's slopes lie
    /// in an arc; `oracle` is the direction from the first oracle point to the second.
    pub(crate) fn crossing_rule(&self, slopes: SlopeArc, oracle: Option<Vector>) -> ArcRule {
        let inside = match self.crossing {
            Crossing::Unrestricted => None,
            Crossing::AlongOracle => oracle.map(SlopeArc::tracking),
            Crossing::AcrossBisector => Some(SlopeArc::tracking(slopes.bisector().left())),
        };
        ArcRule { inside, outside: Some(slopes) }
    }

    /// The directions in which P2, or P4, follows a boundary whose slopes lie in an arc.
    pub(crate) fn following_rule(&self, slopes: SlopeArc) -> ArcRule {
        let inside = match self.following {
            Following::Unrestricted => slopes,
            Following::AlongBisector => slopes.middle(),
        };
        ArcRule { inside: Some(inside), outside: None }
    }
}

/// The direction from the first of these samples to the second.
pub(crate) fn first_to_second(samples: &[Sample]) -> Option<Vector> {
    match samples {
        [p1, p2, ..] => Some(p2.site - p1.site),
        _ => None,
    }
}
