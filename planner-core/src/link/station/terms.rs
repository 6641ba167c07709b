//! What a chip plans with for a setup: the vehicle and the area, of all that a setup can ask for.
//!
//! A setup carries a vehicle's numbers, and the chip makes the vehicle from them. So it can decline by name what makes no vehicle;
//! a frame that it could not read would be asked for again and again.

use heapless::Vec;

use crate::geometry::area::Area;
use crate::geometry::polygon_area::KeepOut;
use crate::geometry::workspace::Workspace;
use crate::link::delivery::{Link, LinkError, Port};
use crate::link::message::{
    DeclinedError, MOST_CORNERS, MOST_KEEP_OUTS, MissionArea, Reply, Request, Setup,
};
use crate::motion::any_vehicle::{ShapeError, VehicleShape};
use crate::motion::dynamics::Dynamics;
use crate::planner::options::Options;

/// What to plan with, and where.
#[derive(Clone, Copy, Debug)]
pub struct PlannerSetup<D, G> {
    /// How the vehicle moves.
    pub dynamics: D,
    /// The part of the area that motions aim for: all but the margin of the tolerance.
    pub area: G,
    /// What Algorithms 1 and 2 leave open. Its weight is look-ahead's price.
    pub options: Options,
}

/// Why there is no [`PlannerSetup`] for a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoTerms {
    /// The setup is not accepted.
    Declined(DeclinedError),
    /// There was no reply.
    Lost(LinkError),
}

impl From<LinkError> for NoTerms {
    fn from(lost: LinkError) -> Self {
        Self::Lost(lost)
    }
}

impl From<DeclinedError> for NoTerms {
    fn from(declined: DeclinedError) -> Self {
        Self::Declined(declined)
    }
}

/// Areas that a chip can plan in, of all that a setup can ask for.
pub trait FromOutlines: Workspace {
    /// The area of a setup, whose outlines can be asked for.
    ///
    /// # Errors
    /// [`NoTerms`].
    fn of<P: Port>(setup: &Setup, link: &mut Link<P>) -> Result<Self, NoTerms>;
}

impl FromOutlines for Area {
    fn of<P: Port>(setup: &Setup, _: &mut Link<P>) -> Result<Self, NoTerms> {
        let is_plain = setup.keep_outs.is_none();
        if is_plain { Ok(setup.config.area) } else { Err(DeclinedError::Area.into()) }
    }
}

impl FromOutlines for MissionArea {
    fn of<P: Port>(setup: &Setup, link: &mut Link<P>) -> Result<Self, NoTerms> {
        let Some(count) = setup.keep_outs else { return Ok(setup.config.area.into()) };
        let mut ask = |number| match link.ask(Request::Outline(number))? {
            Reply::Outline(outline) => {
                KeepOut::try_from(outline).map_err(|_| DeclinedError::Area.into())
            }
            _ => Err(NoTerms::from(DeclinedError::Area)),
        };
        let border = ask(0)?;
        let mut keep_outs: Vec<KeepOut<MOST_CORNERS>, MOST_KEEP_OUTS, u8> = Vec::new();
        for number in 1..=count {
            keep_outs.push(ask(number)?).map_err(|_| DeclinedError::Area)?;
        }
        let area = Self::new(border.hull, &keep_outs).map_err(|_| DeclinedError::Area)?;
        let is_it = area.bounds() == setup.config.area && border.radius == 0;
        if is_it { Ok(area) } else { Err(DeclinedError::Area.into()) }
    }
}

/// Dynamics that a chip has, of all that a setup can ask for.
pub trait KnownDynamics: Dynamics + TryFrom<VehicleShape, Error = ShapeError> {}

impl<D: Dynamics + TryFrom<VehicleShape, Error = ShapeError>> KnownDynamics for D {}
