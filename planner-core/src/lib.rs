#![no_std]
#![forbid(unsafe_code)]
#![deny(dead_code, unnameable_types)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing))]

//! A planner that finds and maps a boundary, straight or bending, from few yes-or-no readings.
//!
//! A robot moves in a plane that an unknown boundary divides: the edge of a spill, a front in the sea, a
//! shoreline, the border of a field. At each stop it senses on which side it is: a label, +1 or -1. A position with
//! its label is a sample. For a boundary that bends or moves there is [`Track`]. This page is about a straight line. A few samples are given at the start: at least three, not on one line, of both labels. The
//! planner returns the next motion, so that few samples and little effort identify the line.
//!
//! ```
//! # use core::cell::Cell;
//! # use core::convert::Infallible;
//! # use planner_core::nalgebra::Point2;
//! # use planner_core::robot::{DriveFn, SensorFn};
//! # use planner_core::{
//! #     Agent, Area, Event, Goal, Heading, Label, Lookahead, Motion, Pose, Sample, Unicycle, Vehicle,
//! #     VersionSpace,
//! # };
//! # // A world in which z = 0.41 x + 3.5 divides the plane, and a vehicle that goes where it is told.
//! # let start = Pose::at([2.0, 1.0], Heading::default())?;
//! # let at = Cell::new(start);
//! # let drive = DriveFn(|motion: &Motion| {
//! #     at.set(motion.target);
//! #     Ok::<_, Infallible>(motion.target)
//! # });
//! # let sensor = SensorFn(|| {
//! #     let place = Point2::<f64>::from(at.get().site);
//! #     let is_above = place.y > 0.41 * place.x + 3.5;
//! #     Ok::<_, Infallible>(if is_above { Label::Positive } else { Label::Negative })
//! # });
//! let area = Area::metres([0.0, 0.0], [20.0, 20.0])?;
//! let given = [
//!     Sample::at([2.0, 1.0], Label::Negative)?,
//!     Sample::at([2.0, 8.0], Label::Positive)?,
//!     Sample::at([18.0, 16.0], Label::Positive)?,
//!     Sample::at([18.0, 5.0], Label::Negative)?,
//! ];
//! let belief = VersionSpace::<32>::new(&given)?.with_tolerance(0.01)?; // positions err by 1 cm at most
//! let goal = Goal::slope_within_degrees(0.5)?;
//! let planner = Lookahead::new(area, Unicycle::default(), belief)?.until(goal);
//! let mut agent = Agent::new(planner, Vehicle { drive, sensor }, start); // your motors, your sensor
//! while let Event::Step(step) = agent.step()? {
//!     println!("{:?}", step.reading);
//! }
//! println!("{}", agent.estimate().ok_or("no estimate")?); // about z = 0.41 x + 3.5
//! # let line = agent.estimate().ok_or("no estimate")?;
//! # assert!((line.slope().ok_or("vertical")? - 0.41).abs() < 0.01);
//! # assert!((line.intercept().ok_or("vertical")? - 3.5).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `drive` and `sensor` are your implementations of [`Drive`](robot::Drive) and [`LabelSensor`](robot::LabelSensor),
//! and `start` is the robot's pose. `VersionSpace::<32>` has room for 32 samples, the given ones included. The
//! program ends when the slopes of any two lines that agree with all labels differ by half a degree at most.
//!
//! # What to use
//!
//! | you want | use |
//! | --- | --- |
//! | a planner | [`Lookahead`]. [`Cfc`] and [`Scc`] are the paper's Algorithms 1 and 2 |
//! | labels that are true | [`VersionSpace`], with a tolerance if positions err |
//! | labels that are sometimes wrong | [`NoisyBelief`], made with a [`Noise`]: how often labels are right |
//! | a boundary that bends or moves, to find it and go along it | [`Track`] |
//! | a boundary that bends or moves a little | a tolerance from a [`Deviation`] |
//! | to begin with a slope or an intercept instead of points | [`bounds`] |
//! | to begin with nothing, or with points of one label | [`Seek`], and then one of these |
//! | to stop when the line is known well enough | [`Goal`] |
//! | a large area, few labels | [`Far`] sight: [`Lookahead::seeing`] |
//! | no label that hardly tells | [`AnySight::with_least_bits`]: [`Lookahead::seeing`] |
//! | a field that is no rectangle, places to keep out of | [`PolygonArea`] and [`KeepOut`] |
//! | a lake of any shape | [`Charted`] and [`Chart`] |
//! | a vehicle | [`Unicycle`], [`Boat`], [`Car`], [`Holonomic`], or [`dynamics`] of your own |
//! | your drive and sensor | [`robot`]: `Drive` and `LabelSensor`; [`robot::asynchronous`] has the same for `async` |
//! | two motors by embedded-hal | [`TwoWheels`](robot::TwoWheels) |
//! | to switch the chip off between motions | [`Persist`], with the feature `serde` |
//! | planner and vehicle on two machines | `link`, with the feature `link` |
//! | the estimates of any set of lines | [`estimate`] |
//! | to see what went wrong | [`error`] |
//!
//! [`plan`](Planner::plan) returns the next motion, [`observe`](Planner::observe) takes in its result, and
//! [`belief`](Planner::belief) returns what the planner knows. An [`Agent`] calls the first two for you. The feature
//! `defmt` derives `Format` for the public types.
//!
//! # The idea
//!
//! The set of all lines that agree with the samples so far is the **version space**. In the space of homogeneous
//! lines `(A, B, C)` each sample is a half-space, so the version space is a convex cone. Seen as a polygon, its edges
//! belong to the samples that still matter, and its vertices are lines through two of them. A cyclic list of sample
//! indices describes it completely.
//!
//! Positions are on an integer [`lattice`] of 15 micrometres. One predicate decides every question about that list,
//! exactly, in 64-bit integers. Its sign is the side of the line through `a` and `b` on which a place `q` lies:
//!
//! ```text
//! orient(a, b, q) = (b.x - a.x)(q.z - a.z) - (b.z - a.z)(q.x - a.x)
//! ```
//!
//! The best next place is where a label carries the most information: where half of the remaining lines give +1.
//! Look-ahead finds such places among the ends of the robot's motions, two labels deep. It learns nearly a bit a
//! step. The two algorithms of the paper (see below) follow the boundary by rules of direction.
//!
//! # What follows
//!
//! - **Certainty is exact.** A position to which all remaining lines give the same label lies in a *region of
//!   certainty*. A sample there brings no information, or reveals a fault. Rounding never misjudges a cut, even for a
//!   vertical boundary or kilometres from the origin.
//! - **Motions come from an integer-indexed grid.** The paper's one-step problems are solved exactly, by looking at a
//!   few of the grid's actions.
//! - **Noisy labels in fixed memory.** The true labels are then unknown, but one line must produce them all. Few label
//!   sequences can come from one line: at most 529 for 32 labels. The lines of one sequence form a *cell*, a version
//!   space of its own. A table of weighted cells is the whole posterior.
//! - **The same on every machine.** Integers decide. Floating point only proposes directions and reads results out,
//!   with IEEE arithmetic and libm. So a mission has the same trace (record of its steps) on a PC and on a chip.
//! - **Fixed memory.** No allocation, no `unsafe`, no recursion; capacities are const generics. A planner for 32
//!   samples takes some 650 bytes of RAM.
//!
//! # The paper
//!
//! The problem is that of Raghavan and Johansson, *Motion Planning for Identification of Linear Classifiers*. Section,
//! equation and algorithm numbers in these pages are that paper's.
//!
//! # Limits
//!
//! - A [`VersionSpace`] believes every label. A sample that contradicts a region of certainty is an
//!   [`ObservationError`](error::ObservationError), and the planner stays as it was.
//! - Positions lie within 8,192 m of the origin, one motion is shorter than 3,000 m, and a buffer holds
//!   3 to 128 samples.
//! - The boundary is one straight, still line, but for [`Track`]. Wrap the planner in [`Watched`](watch::Watched): then
//!   [`Step::alarm`] says when the labels speak against it.
//! - [`Cfc`] and [`Scc`] look one step ahead, [`Lookahead`] two.

mod belief;
#[cfg(test)]
mod draws;
pub mod dynamics;
pub mod error;
mod geometry;
pub mod lattice;
#[cfg(feature = "link")]
pub mod link;
mod motion;
pub mod parts;
mod planner;
pub mod robot;
mod search;
pub mod watch;

pub use nalgebra;

pub use crate::belief::Belief;
pub use crate::belief::cells::{CellView, Certainty};
pub use crate::belief::curve::{Curve, CurveMemory, MapPlace};
pub use crate::belief::deviation::Deviation;
pub use crate::belief::doubtful_labels::CellPosterior;
pub use crate::belief::doubtful_labels::{PosteriorView, ReliabilityEstimate};
pub use crate::belief::estimate::Estimates;
pub use crate::belief::field::{Left, Likely, Seeking};
pub use crate::belief::front::{Beside, Front, FrontStretch, Waist};
pub use crate::belief::goal::{
    Accuracy, Criterion, Goal, NoGoal, ShareWithin, SlopeWithin, Unaudited,
};
pub use crate::belief::lines::{Lines, LinesMemory};
pub use crate::belief::noise::Noise;
pub use crate::belief::observation_log::{FromLog, ObservationLog};
pub use crate::belief::predictions::PredictiveBelief;
pub use crate::belief::predictions::{NoisyBelief, sequences_of};
pub use crate::belief::reliability::Reliability;
pub use crate::belief::sample::{Label, Reading, Sample};
pub use crate::belief::tolerance::Tolerance;
pub use crate::belief::true_labels::VersionSpace;
pub use crate::belief::trust::{AnyReliability, Trust};
pub use crate::belief::unknown_reliability::UnknownReliability;
pub use crate::belief::weight::Prior;
pub use crate::belief::{bounds, estimate};
pub use crate::geometry::arc::SlopeArc;
pub use crate::geometry::area::Area;
pub use crate::geometry::chart::Chart;
pub use crate::geometry::charted::Charted;
pub use crate::geometry::heading::{Angle, Heading};
pub use crate::geometry::hull::Hull;
pub use crate::geometry::lattice::{Site, Vector};
pub use crate::geometry::line::Line;
pub use crate::geometry::local_line::LocalLine;
pub use crate::geometry::polygon_area::{KeepOut, PolygonArea};
pub use crate::geometry::workspace::{HalfPlane, Obstacle, Workspace};
pub use crate::motion::any_vehicle::{AnyVehicle, VehicleShape};
pub use crate::motion::boat::Boat;
pub use crate::motion::car::{Car, CarShape};
pub use crate::motion::dynamics::Pose;
pub use crate::motion::holonomic::Holonomic;
pub use crate::motion::unicycle::{Unicycle, UnicycleShape};
pub use crate::planner::cfc::Cfc;
pub use crate::planner::far::Far;
pub use crate::planner::front_state::FrontState;
pub use crate::planner::lookahead::{DrivingPrice, Lookahead};
pub use crate::planner::one_label::OneLabel;
pub use crate::planner::options::{Crossing, Following, Options};
pub use crate::planner::scc::{Policy, Scc};
pub use crate::planner::seek::Seek;
pub use crate::planner::setup::{Restart, aimed_for};
pub use crate::planner::sight::{AnySight, Near, Sight};
pub use crate::planner::snapshot::{Persist, SNAPSHOT_VERSION, Snapshot};
pub use crate::planner::track::{Guard, Track};
pub use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
pub use crate::robot::{Agent, Event, PinSensor, Step, ThresholdSensor, Vehicle};
pub use crate::search::objective::EffortWeight;
pub use crate::search::recovery::Recovery;
