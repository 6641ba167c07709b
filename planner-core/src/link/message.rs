//! The messages between a chip that plans and a vehicle that moves.
//!
//! The chip asks, the vehicle answers: every [`Request`] has one [`Reply`].
//!
//! ```text
//! chip                                        vehicle (or `host-sim hil` in its place)
//!  | -- Hello { protocol } ------------------->  |  repeated until someone answers
//!  | <------------------------- Setup { .. } --  |  the mission
//!  | -- Outline(number) ---------------------->  |
//!  | <----------------------- Outline { .. } --  |  as often as the area has any, if it is no rectangle
//!  | -- Chart ------------------------------->  |  if the area has a chart
//!  | <------------------------- Chart { .. } --  |
//!  | -- Cells(number) ------------------------>  |
//!  | <------------------------- Cells { .. } --  |  as often as the chart has pieces
//!  | -- Ready(Accepted), or Declined --------->  |
//!  | <-------------------------------- Noted --  |
//!  | -- Move { motion, what came of the last } ->  |
//!  | <----------- OnTheWay { site, reading } --  |  at each label on the way
//!  | -- Onward { last } ---------------------->  |
//!  | <------------- Arrived { pose, reading } --  |  as often as the mission takes
//!  | -- Front(FrontState) ------------------->  |  after each motion, of a planner that follows fronts
//!  | <-------------------------------- Noted --  |
//!  | -- End { reason, estimates } ------------>  |
//!  | <-------------------------------- Noted --  |
//! ```
//!
//! A mission that was cut off needs no message of its own. Planners are deterministic, so it is flown again from its
//! beginning. The vehicle answers the motions that it has already made from memory, without moving. `docs/protocol.md`
//! describes the protocol.
//!
//! A message goes as a [`Frame`](crate::link::frame::Frame). [`delivery`](crate::link::delivery) handles loss,
//! repetition and lateness.

use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::belief::ObservationError;
use crate::belief::estimate::Estimates;
use crate::belief::sample::Reading;
use crate::belief::true_labels::GivenError;
use crate::geometry::hull::{Hull, HullError};
use crate::geometry::lattice::Site;
use crate::geometry::polygon_area::{KeepOut, PolygonArea};
use crate::link::frame::Message;
use crate::motion::any_vehicle::ShapeError;
use crate::motion::dynamics::Pose;
use crate::planner::front_state::FrontState;
use crate::planner::{Motion, StopReason};

#[cfg(feature = "charts")]
pub use crate::link::chart::{CELL_BYTES, ChartFault, ChartPiece, ChartShape};
pub use crate::link::setup::{Algorithm, Capacity, LabelSource, MOST_GIVEN, Settings, Setup};

/// The version of this protocol. The layout of [`Request::Hello`] and of its frame is that of every
/// version from 2 on.
pub const PROTOCOL: u16 = 12;

/// Corners that an area can have, and each keep-out in it.
pub const MOST_CORNERS: usize = 8;

/// Keep-outs that a mission can have.
pub const MOST_KEEP_OUTS: usize = 8;

/// If the area of a mission has a [chart](crate::Chart), [`Setup::keep_outs`] is so much more than the number of keep-outs.
/// A chip without charts declines that many, and needs no code for charts.
pub const CHARTED: u8 = 128;

/// Where the motions of a mission may go.
pub type MissionArea = PolygonArea<MOST_CORNERS, MOST_KEEP_OUTS>;

/// The border of an area, or a keep-out, by its coordinates. A chip that has room for polygons checks whether they form
/// a convex one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Outline {
    /// The corners.
    pub corners: Vec<Site, MOST_CORNERS, u8>,
    /// How far it reaches beyond them, lattice units.
    pub radius: u32,
}

impl From<&KeepOut<MOST_CORNERS>> for Outline {
    fn from(KeepOut { hull, radius }: &KeepOut<MOST_CORNERS>) -> Self {
        Self { corners: hull.corners().iter().copied().collect(), radius: *radius }
    }
}

impl TryFrom<Outline> for KeepOut<MOST_CORNERS> {
    type Error = HullError;

    fn try_from(Outline { corners, radius }: Outline) -> Result<Self, HullError> {
        Ok(Self { hull: Hull::new(&corners)?, radius })
    }
}

/// What the chip asks of the vehicle.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Request {
    /// For a mission.
    Hello {
        /// [`PROTOCOL`] as the chip has it.
        protocol: u16,
    },
    /// For an outline, before it begins: 0 is the area's border, then come the keep-outs. A setup with all of them would
    /// need frames of 1,152 bytes.
    Outline(u8),
    /// To begin: the setup is accepted.
    Ready(Accepted),
    /// For another setup: this one is not accepted.
    Declined(DeclinedError),
    /// To make a motion and say what came of it.
    Move(Move),
    /// To take note that the mission is over.
    End(MissionEnd),
    /// To go on with the motion, after [`Reply::OnTheWay`]: the next answer is of the same kind, or the motion's end.
    Onward {
        /// What was read there, as far as the chip knows. `None` if nothing was.
        last: Option<Reading>,
    },
    /// To take note of what is known of the front after a motion. Only a planner that follows fronts asks this.
    Front(FrontState),
    // These are the last, as a chip without charts does not have them.
    /// For the shape of the area's chart, before it begins.
    #[cfg(feature = "charts")]
    Chart,
    /// For a piece of the area's chart, before it begins: piece 0 has the first words of the cells.
    #[cfg(feature = "charts")]
    Cells(u8),
}

/// What the vehicle answers.
#[allow(clippy::large_enum_variant, reason = "there is one at a time, and no heap")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reply {
    /// To [`Request::Hello`]: the mission.
    Setup(Setup),
    /// To [`Request::Outline`].
    Outline(Outline),
    /// To [`Request::Move`]: where the motion ended and what was sensed there.
    Arrived {
        /// Where it ended.
        pose: Pose,
        /// The reading. `None` when no sample was taken, or when the chip has the sensor and must read it. If there is
        /// a reading, the chip uses it and does not read its own sensor. That happens when a mission that was cut off
        /// is flown again from its beginning: the vehicle then repeats the earlier reading from memory.
        reading: Option<Reading>,
    },
    /// To [`Request::Move`]: the vehicle could not make the motion.
    Failed,
    /// To all else.
    Noted,
    /// To any: the request has arrived, and the vehicle is still working on it. A motion may take longer than the link
    /// waits.
    Busy,
    /// To any: it belongs to no session that runs here, or is older than the last.
    Stale,
    /// To [`Request::Move`] and [`Request::Onward`]: a label is read on the way of the motion, which goes on. A
    /// list of all labels of a motion may not fit a frame.
    OnTheWay {
        /// Where the vehicle is, or was when it read the label.
        site: Site,
        /// The reading. `None` when the chip has the sensor and must read it. If there is a reading, the chip uses it, as
        /// with [`Reply::Arrived`].
        reading: Option<Reading>,
    },
    // These are the last, as a chip without charts does not have them.
    /// To [`Request::Chart`].
    #[cfg(feature = "charts")]
    Chart(ChartShape),
    /// To [`Request::Cells`].
    #[cfg(feature = "charts")]
    Cells(ChartPiece),
}

/// What the chip accepts, and what its figures mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Accepted {
    /// What there is: at least what was asked for.
    pub capacity: Capacity,
    /// The clock.
    pub clock: ClockRate,
}

/// What a [`Took`]'s ticks are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ClockRate {
    /// Ticks in a second.
    pub per_second: u32,
    /// Under emulation ticks count instructions, not time.
    pub emulated: bool,
}

/// Why a setup is not accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum DeclinedError {
    /// The chip speaks this version of the protocol.
    Protocol(u16),
    /// The chip does not have this algorithm.
    Algorithm,
    /// The chip has this much, which is too little.
    Capacity(Capacity),
    /// The given samples make no belief, or leave no room for a label.
    Given(GivenError),
    /// The chip has no sensor of its own.
    Labels,
    /// The chip cannot plan for this vehicle.
    Vehicle(ShapeError),
    /// The chip cannot plan in this area. A chip may support rectangles only.
    Area,
    /// The tolerance leaves nothing of the area.
    Tolerance,
    /// The chip cannot check this goal.
    Goal,
    /// The chip looks for labels within one motion, so they have no price.
    Price,
    /// The area's chart has not arrived.
    #[cfg(feature = "charts")]
    Chart(ChartFault),
}

impl core::fmt::Display for DeclinedError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Protocol(version) => write!(f, "the chip speaks protocol {version}"),
            Self::Algorithm => f.write_str("the chip does not have this algorithm"),
            Self::Capacity(Capacity { samples, hypotheses }) => {
                write!(f, "the chip holds {samples} samples and {hypotheses} hypotheses")
            }
            Self::Given(why) => why.fmt(f),
            Self::Tolerance => f.write_str("the tolerance leaves nothing of the area"),
            Self::Labels => f.write_str("the chip has no label sensor"),
            Self::Vehicle(why) => why.fmt(f),
            #[cfg(feature = "charts")]
            Self::Chart(why) => why.fmt(f),
            Self::Area => f.write_str("the chip cannot plan in this area"),
            Self::Goal => f.write_str("the chip cannot check this goal"),
            Self::Price => {
                f.write_str("the chip looks for labels within one motion, and for one a motion")
            }
        }
    }
}

impl core::error::Error for DeclinedError {}

/// A motion to make, with what came of the one before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Move {
    /// The motion.
    pub motion: Motion,
    /// The reading that the planner last took in, if it took one in at the end of the last motion.
    pub last: Option<Reading>,
    /// Ticks it took.
    pub took: Took,
}

/// Ticks of the chip's clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Took {
    /// To take in the last reading.
    pub observe: u32,
    /// To plan.
    pub plan: u32,
    /// To estimate the line; 0 before the end.
    pub estimate: u32,
}

/// How a mission ended.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MissionEnd {
    /// Why.
    pub reason: EndReason,
    /// As in [`Move`].
    pub last: Option<Reading>,
    /// Ticks of the last observation, of the last plan, and of the estimates.
    pub took: Took,
    /// What is known of the line.
    pub estimates: Estimates,
}

/// Why a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum EndReason {
    /// All steps were taken.
    Steps,
    /// The planner had no further motion.
    Stopped(StopReason),
    /// The planner did not take a sample.
    Refused(ObservationError),
    /// The chip's sensor failed.
    Sensor,
    /// The vehicle could not make a motion.
    Vehicle,
    /// All labels were read that there may be.
    Labels,
}

impl Message for Request {
    const WAY: u8 = b'?';
}

impl Message for Reply {
    const WAY: u8 = b'!';
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::front::Waist;
    use crate::belief::noise::Noise;
    use crate::belief::reliability::Reliability;
    use crate::belief::sample::{Label, Sample};
    use crate::belief::tolerance::Tolerance;
    use crate::belief::weight::Prior;
    use crate::geometry::area::Area;
    use crate::geometry::heading::Heading;
    use crate::geometry::lattice::{LIMIT, Site, Vector};
    use crate::geometry::local_line::LocalLine;
    use crate::link::frame::{Decoder, Envelope, FRAME, Frame};
    use crate::motion::action::{Action, Control};
    use crate::motion::any_vehicle::VehicleShape;
    use crate::motion::car::CarShape;
    use crate::planner::Stage;
    use crate::planner::options::{Crossing, Following};
    use crate::planner::scc::Policy;
    use crate::search::objective::EffortWeight;
    use crate::search::recovery::Recovery;

    /// What a decoder makes of a frame and of what came before it.
    fn received<M: Message>(frame: &Frame) -> Option<Envelope<M>> {
        let mut decoder = Decoder::default();
        let noise = [7; 2 * FRAME];
        let mut heard = noise.iter().chain(frame.bytes()).filter_map(|b| decoder.feed::<M>(*b));
        let first = heard.next();
        assert!(heard.next().is_none());
        first
    }

    fn far(x: i32, z: i32) -> Site {
        Site::new(x * (LIMIT - 1), z * (LIMIT - 1)).unwrap()
    }

    /// An octagon as large as the lattice.
    fn widest_outline() -> Outline {
        const FAR: i32 = LIMIT - 1;
        const NEAR: i32 = FAR / 2 + 1;
        let corners = [
            (FAR, NEAR),
            (NEAR, FAR),
            (-NEAR, FAR),
            (-FAR, NEAR),
            (-FAR, -NEAR),
            (-NEAR, -FAR),
            (NEAR, -FAR),
            (FAR, -NEAR),
        ];
        let hull = Hull::new(&corners.map(|(x, z)| Site::new(x, z).unwrap())).unwrap();
        Outline::from(&KeepOut { hull, radius: u32::MAX })
    }

    fn longest_setup() -> Setup {
        let sample = Sample { site: far(-1, -1), label: Label::Positive };
        let reliability = Reliability::new(5e-324).unwrap();
        Setup {
            protocol: u16::MAX,
            algorithm: Algorithm::Scc {
                noise: Noise { reliability, trusted_radius: u32::MAX, tolerance: Tolerance::NONE },
                policy: Policy::MixtureOfOwn,
                prior: Prior::Sequences,
            },
            config: Settings {
                area: Area::new(far(-1, -1), far(1, 1)).unwrap(),
                weight: EffortWeight::new(0.999_999).unwrap(),
                crossing: Crossing::AcrossBisector,
                following: Following::AlongBisector,
                tolerance: Tolerance::NONE,
            },
            keep_outs: Some(u8::MAX),
            vehicle: VehicleShape::Car(CarShape {
                radius_mm: u32::MAX,
                shortest_mm: u32::MAX,
                turn_step_urad: u32::MAX,
                speeds: u16::MAX,
                speed_step_mm: u32::MAX,
            }),
            capacity: Capacity { samples: u16::MAX, hypotheses: u16::MAX },
            steps: u16::MAX,
            most_labels: Some(24),
            start: Pose { site: far(-1, -1), heading: Heading(u32::MAX) },
            labels: LabelSource::Chip,
            given: Vec::from_array([sample; MOST_GIVEN]),
        }
    }

    #[test]
    fn the_longest_messages_fit_a_frame_and_arrive_as_they_were_sent() {
        let reading = Some(Label::Positive.into());
        let on_the_way = Reply::OnTheWay { site: far(-1, -1), reading };
        for reply in [Reply::Setup(longest_setup()), Reply::Outline(widest_outline()), on_the_way] {
            let frame = Frame::of(&Envelope::new(u32::MAX, u32::MAX, reply.clone()));
            let arrived = received::<Reply>(&frame).unwrap();
            assert_eq!((arrived.number, arrived.message), (u32::MAX, reply));
        }

        let pose = Pose { site: far(-1, -1), heading: Heading(u32::MAX) };
        let motion = Motion {
            stage: Some(Stage::P4),
            recovery: Some(Recovery::Transit),
            action: Action(u32::MAX),
            control: Control { distance_m: -1.0, turn_rad: f32::MIN_POSITIVE },
            target: pose,
            wants_label: false,
            examined: u32::MAX,
            proven: false,
        };
        let took = Took { observe: u32::MAX, plan: u32::MAX, estimate: u32::MAX };
        let last = Some(Label::Positive.into());
        let along = Vector::new(1 - (1 << 30), 1 - (1 << 30)).unwrap();
        let line = LocalLine::new(far(-1, -1), along, -1.0 / 3.0, f32::MAX);
        assert!(line.is_some());
        let estimates = Estimates { bisector: line, centre: line, maximum_margin: line };
        let waist = Waist {
            site: far(-1, -1),
            heading: Heading(u32::MAX),
            curvature: -1.0 / 3.0,
            deviation: f32::MAX,
            turn_deviation: f32::MIN_POSITIVE,
        };
        let sample = Sample { site: far(-1, -1), label: Label::Positive };
        let reason = EndReason::Refused(ObservationError::Contradiction(sample));
        for request in [
            Request::Move(Move { motion, last, took }),
            Request::End(MissionEnd { reason, last, took, estimates }),
            Request::Onward { last },
            Request::Front(FrontState { waist: Some(waist), is_closed: true }),
        ] {
            let frame = Frame::of(&Envelope::new(u32::MAX, u32::MAX, request.clone()));
            let arrived = received::<Request>(&frame).unwrap();
            // Debug output tells every bit of a float apart but for NaN's.
            let debug = |it: &Request| heapless::format!(2048; "{it:?}").unwrap();
            assert_eq!(debug(&arrived.message), debug(&request));
            assert!(received::<Reply>(&frame).is_none(), "an echo is no answer");
        }
    }
}
