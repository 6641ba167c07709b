#![no_std]
#![forbid(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic, clippy::indexing_slicing))]

//! A planner that finds a straight boundary from few samples.
//!
//! A robot moves in a plane that an unknown straight line divides: the edge of a spill, a front in
//! the sea, a shoreline, the border of a field. At each stop it senses on which side it is. Four
//! labelled points are known at the start. Where should it go next, so that few samples and little
//! effort identify the line? This is the problem of Raghavan and Johansson, *Motion Planning for
//! Identification of Linear Classifiers*; section, equation and algorithm numbers in these pages
//! are that paper's.
//!
//! # The idea
//!
//! All lines that agree with the samples so far are the **version space**. In the space of homogeneous lines
//! `(A, B, C)` each sample is a half-space, so the version space is a convex cone. Seen as a polygon, its edges belong
//! to the samples that still matter, and its vertices are lines through two of them. A cyclic list of sample indices
//! describes it completely ([`belief::cell`]).
//!
//! On an integer lattice of 15 micrometres ([`geometry::lattice`]) one predicate decides every question about that
//! list. It is exact in 64-bit integers:
//!
//! ```text
//! orient(a, b, q) = (b.x - a.x)(q.z - a.z) - (b.z - a.z)(q.x - a.x)
//! ```
//!
//! The best next place is where a label would tell the most: where half of the lines left say +1. Look-ahead
//! ([`planner::lookahead`]) finds such places among the ends of the robot's motions, two labels deep. It learns nearly
//! a bit a step. The paper's two algorithms follow the boundary by rules of direction.
//!
//! # What follows
//!
//! - **Certainty is exact.** A position that all lines left label alike lies in a *region of certainty*. A sample there
//!   would tell nothing, or reveal a fault. There is no tolerance and no misjudged cut, even for a vertical boundary or
//!   kilometres from the origin ([`belief::version_space`]).
//! - **Motions come from an integer-indexed grid** ([`motion::action`], [`motion::dynamics`]), and the one-step
//!   problems are solved exactly by looking at a few of its actions ([`search::problem`]).
//! - **Noisy labels in fixed memory.** The sequences of true labels that some line realises are cells too, at most 529
//!   for 32 labels. A table of weighted cells is the whole posterior ([`belief::hypotheses`], [`belief::posterior`]).
//! - **The same on every machine.** Integers decide. Floating point only proposes directions and reads results out,
//!   with IEEE arithmetic and libm. So a mission has the same trace on a PC and on a chip.
//! - **Fixed memory.** No allocation, no `unsafe`, no recursion; capacities are const generics. A
//!   planner for 32 samples is some 500 bytes ([`planner::cfc::Cfc`]).
//!
//! # Modules, from the bottom up
//!
//! Each module uses only those above it in this table.
//!
//! | module | holds |
//! | --- | --- |
//! | [`geometry`] | points, directions and lines, in integers |
//! | [`belief`] | what is known of the line; behind the trait [`Belief`] |
//! | [`motion`] | how the robot moves; behind the trait [`Dynamics`] |
//! | [`search`] | the best action for what is known |
//! | [`planner`] | look-ahead ([`Lookahead`]), for labels that are true or sometimes wrong, and the paper's Algorithm 1 ([`Cfc`]) and Algorithm 2 ([`Scc`]); behind the trait [`Planner`] |
//! | [`robot`] | what you implement, [`Drive`] and [`LabelSensor`], and the loop that joins it to a planner, [`Agent`] |
//! | `link` | with the feature `wire`: a mission whose planner and vehicle are apart |
//!
//! [`plan`](Planner::plan) returns the next motion, [`observe`](Planner::observe) takes in its result, and
//! [`belief`](Planner::belief) is what the planner knows. The feature `defmt` derives `Format` for the public types.
//!
//! ```
//! use core::cell::Cell;
//! use core::convert::Infallible;
//! use planner_core::nalgebra::Point2;
//! use planner_core::belief::tolerance::Tolerance;
//! use planner_core::{
//!     Agent, Area, Belief, Cfc, Config, Crossing, Drive, Event, Heading, Label, LabelSensor, Line,
//!     Motion, Planner, Pose, Reading, Sample, Site, Unicycle, Varrho, Vehicle, VersionSpace, cfc,
//! };
//!
//! // A world in which z = 0.41 x + 3.5 divides the plane, and a vehicle that goes where it is told.
//! struct World(Cell<Pose>);
//! impl Drive for &World {
//!     type Error = Infallible;
//!     fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
//!         self.0.set(motion.target);
//!         Ok(motion.target)
//!     }
//! }
//! impl LabelSensor for &World {
//!     type Error = Infallible;
//!     fn read(&mut self) -> Result<Reading, Infallible> {
//!         let at = Point2::<f64>::from(self.0.get().site);
//!         let above = at.y > 0.41 * at.x + 3.5;
//!         Ok(if above { Label::Positive } else { Label::Negative }.into())
//!     }
//! }
//!
//! let at = |x, z| Site::try_from(Point2::<f32>::new(x, z));
//! let oracle = [
//!     Sample { site: at(2.0, 1.0)?, label: Label::Negative },
//!     Sample { site: at(2.0, 8.0)?, label: Label::Positive },
//!     Sample { site: at(18.0, 16.0)?, label: Label::Positive },
//!     Sample { site: at(18.0, 5.0)?, label: Label::Negative },
//! ];
//! let config = Config {
//!     area: Area::new(at(0.0, 0.0)?, at(20.0, 20.0)?).ok_or("no area")?,
//!     varrho: Varrho::PAPER,
//!     crossing: Crossing::default(),
//!     following: cfc::FOLLOWING,
//!     tolerance: Tolerance::NONE, // positions are where they are reported to be
//! };
//! let start = Pose { site: oracle[0].site, heading: Heading(0) };
//! let world = World(Cell::new(start));
//! // Room for 32 samples, these four included.
//! let planner = Cfc::new(config, Unicycle::paper(), VersionSpace::<32>::new(&oracle)?)?;
//! let vehicle = Vehicle { drive: &world, sensor: &world };
//! let mut agent = Agent::new(planner, vehicle, start);
//! for _ in 0..10 {
//!     if let Event::Stopped(_) = agent.step()? {
//!         break;
//!     }
//! }
//! let centre = agent.planner.belief().estimates().centre.ok_or("no estimate")?;
//! let line = Line::from(centre);
//! assert!((line.slope().ok_or("vertical")? - 0.41).abs() < 0.01);
//! assert!((line.intercept().ok_or("vertical")? - 3.5).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//!
//! - Algorithm 1 takes labels to be true. A sample that contradicts a region of certainty is a typed
//!   error ([`belief::Refused`]) and leaves the planner as it was.
//! - Positions lie within 8,192 m of the origin, one motion is shorter than 3,000 m, and a buffer holds
//!   3 to 128 samples.
//! - The boundary is one straight line. P1 and P2 look one step ahead, look-ahead two.

pub mod belief;
pub mod geometry;
#[cfg(feature = "wire")]
pub mod link;
pub mod motion;
pub mod planner;
pub mod robot;
pub mod search;

pub use nalgebra;

pub use crate::belief::forecast::Forecast;
pub use crate::belief::goal::Goal;
pub use crate::belief::hypotheses::Hypotheses;
pub use crate::belief::noise::{Noise, Reliability};
pub use crate::belief::posterior::Posterior;
pub use crate::belief::sample::{Label, Reading, Sample};
pub use crate::belief::version_space::VersionSpace;
pub use crate::belief::weight::Prior;
pub use crate::belief::{Belief, Refused};
pub use crate::geometry::area::Area;
pub use crate::geometry::heading::Heading;
pub use crate::geometry::hull::Hull;
pub use crate::geometry::lattice::Site;
pub use crate::geometry::line::Line;
pub use crate::geometry::local_line::LocalLine;
pub use crate::geometry::region::Region;
pub use crate::geometry::terrain::{RoundedHull, Terrain};
pub use crate::motion::any_vehicle::AnyVehicle;
pub use crate::motion::dynamics::{Dynamics, Pose};
pub use crate::motion::holonomic::Holonomic;
pub use crate::motion::unicycle::Unicycle;
pub use crate::planner::cfc::{self, Cfc};
pub use crate::planner::config::{Config, Crossing, Following};
pub use crate::planner::lookahead::{self, Lookahead};
pub use crate::planner::scc::{self, Policy, Scc};
pub use crate::planner::snapshot::{NotRestored, Persist, Snapshot};
pub use crate::planner::{Motion, Plan, Planner, StopReason};
pub use crate::robot::agent::{Agent, Event, Step};
pub use crate::robot::body::{Body, Vehicle};
pub use crate::robot::hal::{Drive, LabelSensor, PinSensor};
pub use crate::robot::threshold::ThresholdSensor;
pub use crate::search::objective::Varrho;
