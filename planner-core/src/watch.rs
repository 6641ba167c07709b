//! What speaks against a straight, still line: the evidence of labels, and the audit before a goal's promise.
//!
//! Wrap a planner in [`Watched`], and look at `alarm` of each [`Step`](crate::Step). It changes no plan:
//!
//! ```
//! # use core::cell::Cell;
//! # use core::convert::Infallible;
//! # use planner_core::robot::{DriveFn, SensorFn};
//! use planner_core::watch::Watched;
//! # use planner_core::{
//! #     Agent, Area, Cfc, Event, Label, Motion, Pose, Sample, Unicycle, Vehicle, VersionSpace,
//! # };
//! # let start = Pose::at([2.0, 1.0], Default::default())?;
//! # let drive = DriveFn(|motion: &Motion| Ok::<_, Infallible>(motion.target));
//! # // A sensor that reads +1 wherever it is.
//! # let sensor = SensorFn(|| Ok::<_, Infallible>(Label::Positive));
//! # let given = [
//! #     Sample::at([2.0, 1.0], Label::Negative)?,
//! #     Sample::at([2.0, 8.0], Label::Positive)?,
//! #     Sample::at([18.0, 16.0], Label::Positive)?,
//! #     Sample::at([18.0, 5.0], Label::Negative)?,
//! # ];
//! # let area = Area::metres([0.0, 0.0], [20.0, 20.0])?;
//! # let planner = Cfc::new(area, Unicycle::default(), VersionSpace::<32>::new(&given)?)?;
//! # let mut alarms = Vec::new();
//! let mut agent = Agent::new(Watched::new(planner), Vehicle { drive, sensor }, start);
//! while let Event::Step(step) = agent.step()? {
//!     if let Some(alarm) = step.alarm {
//!         println!("{alarm}: evidence {}", alarm.evidence); // from 20 on a warning, from 100 on an alarm
//! #         alarms.push(alarm.evidence);
//! #         if alarm.is_grave() { break; }
//!     }
//! }
//! # assert!(alarms.last() >= Some(&100.0), "{alarms:?}");
//! # assert!(agent.alarm().is_some());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Each is told once: where one label brings both, it is an alarm. The mission goes on: stop it, or ask a person.
//! [`Agent::alarm`](crate::Agent::alarm) says at any time what speaks against the line, also when a label was refused.
//!
//! A goal of [`Lookahead`](crate::Lookahead) has an [`Audit`] by itself. Its motions have [`Stage::Audit`](crate::Stage::Audit).
//! Labels against all lines that are likely enough end the mission with
//! [`StopReason::NoLine`](crate::StopReason::NoLine). Where labels are true, one is enough.

pub use crate::belief::evidence::{Alarm, Evidence, Suspect};
pub use crate::planner::audit::Audit;
pub use crate::planner::watched::Watched;
