//! What speaks against a straight, still line: the evidence of labels, and the audit before a goal's promise.
//!
//! Wrap a planner in [`Watched`], and ask for an [`Alarm`] after each step. It changes no plan:
//!
//! ```
//! use planner_core::watch::Watched;
//! use planner_core::{Area, Cfc, Label, Plan, Planner, Pose, Sample, Unicycle, VersionSpace};
//!
//! let given = [([2.0, 1.0], -1), ([2.0, 8.0], 1), ([18.0, 16.0], 1), ([18.0, 5.0], -1)];
//! let mut samples = Vec::new();
//! for (place, label) in given {
//!     let label = if label > 0 { Label::Positive } else { Label::Negative };
//!     samples.push(Sample::at(place, label)?);
//! }
//! let area = Area::metres([0.0, 0.0], [20.0, 20.0])?;
//! let planner = Cfc::new(area, Unicycle::default(), VersionSpace::<32>::new(&samples)?)?;
//! let mut planner = Watched::new(planner);
//! let mut pose = Pose::at([2.0, 1.0], Default::default())?;
//! while let Plan::Move(motion) = planner.plan(pose) {
//!     pose = motion.target;
//!     // A sensor that reads +1 wherever it is.
//!     if planner.observe(pose, motion.wants_label.then_some(Label::Positive.into())).is_err() {
//!         break;
//!     }
//!     if let Some(alarm) = planner.alarm() {
//!         println!("{alarm}");
//!         break;
//!     }
//! }
//! assert!(planner.alarm().is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A goal of [`Lookahead`](crate::Lookahead) has an [`Audit`] by itself. Its motions have [`Stage::Audit`](crate::Stage::Audit).
//! Labels against all lines that are likely enough end the mission with
//! [`StopReason::NoLine`](crate::StopReason::NoLine). Where labels are true, one is enough.

pub use crate::belief::evidence::{Alarm, Evidence, Suspect};
pub use crate::planner::audit::Audit;
pub use crate::planner::watched::Watched;
