//! What a chip plans with for a setup: the vehicle and the area, of all that a setup can ask for.
//!
//! A setup carries a vehicle's numbers, and the chip makes the vehicle from them. So it can decline by name what makes no vehicle;
//! a frame that it could not read would be asked for again and again.

use heapless::Vec;

use crate::geometry::area::Area;
use crate::geometry::polygon_area::KeepOut;
use crate::geometry::workspace::Workspace;
#[cfg(feature = "charts")]
use crate::geometry::{chart::Chart, charted::Charted};
#[cfg(feature = "charts")]
use crate::link::chart::{CELL_BYTES, ChartFault};
use crate::link::delivery::{Link, LinkError, Port};
use crate::link::message::{
    DeclinedError, MOST_CORNERS, MOST_KEEP_OUTS, MissionArea, Reply, Request, Setup,
};
#[cfg(feature = "charts")]
use crate::link::{frame::CHECK, message::CHARTED};
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

/// Kinds of area that a chip can plan in, of all that a setup can ask for. They are a rectangle ([`Area`]) and a polygon with
/// keep-outs ([`MissionArea`]). With the feature `charts` there is a chart in such a polygon (`Charts`).
pub trait FromOutlines {
    /// What a chip stores of an area beside the planner: the cells of a chart, if it takes charts.
    type Room;
    /// Room before a mission.
    const EMPTY: Self::Room;
    /// The area as planners have it.
    type Ground<'a>: Workspace;

    /// The area of a setup, whose outlines and cells can be asked for.
    ///
    /// # Errors
    /// [`NoTerms`].
    fn of<'a, P: Port>(
        setup: &Setup,
        link: &mut Link<P>,
        room: &'a mut Self::Room,
    ) -> Result<Self::Ground<'a>, NoTerms>;
}

/// Polygons with keep-outs, and in these also charts of up to so many words of cells: 512 are enough for 128 rows and
/// columns, 2,048 for 256. The chip has so many words on its stack.
#[cfg(feature = "charts")]
#[derive(Debug)]
pub enum Charts<const WORDS: usize> {}

impl FromOutlines for Area {
    type Room = ();
    const EMPTY: () = ();
    type Ground<'a> = Self;

    fn of<P: Port>(setup: &Setup, _: &mut Link<P>, (): &mut ()) -> Result<Self, NoTerms> {
        let is_plain = setup.keep_outs.is_none();
        if is_plain { Ok(setup.config.area) } else { Err(DeclinedError::Area.into()) }
    }
}

impl FromOutlines for MissionArea {
    type Room = ();
    const EMPTY: () = ();
    type Ground<'a> = Self;

    fn of<P: Port>(setup: &Setup, link: &mut Link<P>, (): &mut ()) -> Result<Self, NoTerms> {
        setup.keep_outs.map_or(Ok(setup.config.area.into()), |it| outlined(setup, it, link))
    }
}

#[cfg(feature = "charts")]
impl<const WORDS: usize> FromOutlines for Charts<WORDS> {
    type Room = [u32; WORDS];
    const EMPTY: [u32; WORDS] = [0; WORDS];
    type Ground<'a> = Charted<'a, MissionArea>;

    fn of<'a, P: Port>(
        setup: &Setup,
        link: &mut Link<P>,
        room: &'a mut [u32; WORDS],
    ) -> Result<Charted<'a, MissionArea>, NoTerms> {
        match setup.keep_outs {
            Some(it @ CHARTED..) => {
                let area = outlined(setup, it - CHARTED, link)?;
                Ok(Charted::new(area, Some(charted(setup.config.area, link, room)?)))
            }
            _ => Ok(Charted::new(MissionArea::of(setup, link, &mut ())?, None)),
        }
    }
}

/// A polygon with so many keep-outs.
fn outlined<P: Port>(setup: &Setup, count: u8, link: &mut Link<P>) -> Result<MissionArea, NoTerms> {
    if usize::from(count) > MOST_KEEP_OUTS {
        return Err(DeclinedError::Area.into());
    }
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
    let area = MissionArea::new(border.hull, &keep_outs).map_err(|_| DeclinedError::Area)?;
    let is_it = area.bounds() == setup.config.area && border.radius == 0;
    if is_it { Ok(area) } else { Err(DeclinedError::Area.into()) }
}

/// The chart on a rectangle, piece by piece. Each piece is asked for once.
#[cfg(feature = "charts")]
fn charted<'a, P: Port>(
    area: Area,
    link: &mut Link<P>,
    room: &'a mut [u32],
) -> Result<Chart<'a>, NoTerms> {
    let declined = |fault| NoTerms::from(DeclinedError::Chart(fault));
    let Reply::Chart(shape) = link.ask(Request::Chart)? else {
        return Err(declined(ChartFault::Shape));
    };
    let most = room.len() as u16;
    let cells = room.get_mut(..shape.words()).ok_or(declined(ChartFault::Room(most)))?;
    let mut sum = CHECK.digest();
    for (number, part) in (0..=u8::MAX).zip(cells.chunks_mut(CELL_BYTES / 4)) {
        match link.ask(Request::Cells(number))? {
            Reply::Cells(piece) => piece.write((number, part), &mut sum).map_err(declined)?,
            _ => return Err(declined(ChartFault::Missing(number))),
        }
    }
    if sum.finalize() != shape.sum {
        return Err(declined(ChartFault::Sum));
    }
    let chart = Chart::new(area.min(), shape.side, shape.size, cells).ok();
    chart.filter(|it| it.bounds() == area).ok_or(declined(ChartFault::Shape))
}

/// Dynamics that a chip has, of all that a setup can ask for.
pub trait KnownDynamics: Dynamics + TryFrom<VehicleShape, Error = ShapeError> {}

impl<D: Dynamics + TryFrom<VehicleShape, Error = ShapeError>> KnownDynamics for D {}
