//! The goal of a mission, as scenario files ask for it and results promise it.
//!
//! The planner gets a goal that is a little stricter than the one in the file. The difference is larger than the
//! rounding of single precision. So when the planner's goal is met, the file's is met too.

use anyhow::Result;
use planner_core::{Accuracy, Angle, Goal, Workspace as _};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::read_out::{LEVEL, ReadOut};
use crate::mission::strict::{beyond, wrong};

/// A heading's units in a degree.
const UNITS_PER_DEGREE: f64 = 4_294_967_296.0 / 360.0;

/// How much stricter an angle is asked for, in units of a heading. Unit vectors are accurate to 2^-29.
const TURN_OFF: u32 = 4;

/// How much stricter a share of the area is asked for, in millionths.
const SHARE_OFF: u32 = 1;

/// The largest level; then the unit of levels and shares, which are stored in millionths.
const MOST_LEVEL: f64 = 0.9999;
const MILLION: f64 = 1e6;

/// `[stop]` of a scenario file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StopTable {
    /// Any two of the lines left differ by so many degrees at most, 0.00001 to below 90
    slope_arc_deg: Option<f64>,
    /// The ground on which some two of them disagree is this share of the area at most, 0.00001 to below 1
    misclassified: Option<f64>,
    /// With noise: the promise holds with this probability, 0.9999 at most [default: 0.9]
    level: Option<f64>,
    /// Whether an audit comes before the promise [default: true]
    audit: Option<bool>,
    /// Of `track`: whether the mission ends once the robot has gone along all of the front [default: true]
    closed: Option<bool>,
}

impl StopTable {
    /// Whether an audit comes before the promise.
    pub(crate) fn audits(&self) -> bool {
        self.audit.unwrap_or(true)
    }

    /// Whether a mission along a front ends once it has gone round it.
    ///
    /// # Errors
    /// Names a key that means nothing there.
    pub(crate) fn until_closed(&self) -> Result<bool> {
        let Self { slope_arc_deg, misclassified, level, audit, closed } = self;
        let keys = [
            ("slope_arc_deg", slope_arc_deg.is_some()),
            ("misclassified", misclassified.is_some()),
            ("level", level.is_some()),
            ("audit", audit.is_some()),
        ];
        let key = keys.iter().find(|(_, is_there)| *is_there);
        key.map_or(Ok(closed.unwrap_or(true)), |(name, _)| {
            wrong(&format!("stop.{name}"), "one with algorithm track", "closed alone")
        })
    }

    /// The goal that it asks for.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn goal(&self, algorithm: Algorithm, labels_err: bool) -> Result<Goal> {
        if algorithm != Algorithm::Lookahead {
            let found = format!("with algorithm {}", algorithm.name());
            return wrong("stop", found, "with algorithm lookahead");
        }
        if self.closed.is_some() {
            return wrong("stop.closed", "one without a front", "one with algorithm track");
        }
        let accuracy = match (self.slope_arc_deg, self.misclassified) {
            (Some(degrees), None) if (1e-5..90.0).contains(&degrees) => {
                let units = (degrees * UNITS_PER_DEGREE) as u32;
                Accuracy::SlopeArc(Angle(units - TURN_OFF))
            }
            (Some(degrees), None) => {
                return beyond("stop.slope_arc_deg", degrees);
            }
            (None, Some(share)) if (1e-5..1.0).contains(&share) => {
                // A share with six decimal places becomes exactly that many millionths.
                let millionths = (share * MILLION + 1e-6) as u32;
                Accuracy::Misclassified(millionths - SHARE_OFF)
            }
            (None, Some(share)) => {
                return beyond("stop.misclassified", share);
            }
            (Some(_), Some(_)) => {
                return wrong("stop", "both slope_arc_deg and misclassified", "one of them");
            }
            (None, None) => return wrong("stop", "neither", "slope_arc_deg or misclassified"),
        };
        let level = match self.level {
            Some(level) if !labels_err => {
                let expected = "none without noise, as what true labels leave is certain";
                return wrong("stop.level", level, expected);
            }
            None if !labels_err => 1.0,
            None => LEVEL,
            Some(level) if (1e-6..=MOST_LEVEL).contains(&level) => level,
            Some(level) => {
                return beyond("stop.level", level);
            }
        };
        Ok(Goal { accuracy, level: (level * MILLION).round() as u32 })
    }
}

/// What a mission was to find out, and whether it did.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct GoalRecord {
    /// Any two of the lines left make an angle of so many degrees at most.
    pub slope_arc_deg: Option<f64>,
    /// The ground on which some two of the lines left disagree is this share of the area at most.
    pub misclassified: Option<f64>,
    /// With this probability at least, where labels may be wrong.
    pub level: Option<f64>,
    /// Whether the goal is met in the end, and nothing speaks against it.
    pub is_met: bool,
    /// What the audit came to, if there was one.
    pub audit: Option<AuditRecord>,
}

/// The labels on ground of which the belief is sure, before a goal's promise, and their price.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct AuditRecord {
    /// Labels that the belief expected.
    pub agreed: usize,
    /// Other labels, where labels may be wrong.
    pub disagreed: Option<usize>,
    /// The step with the label that refuted the model.
    pub refuted: Option<usize>,
    /// Whether all labels together refuted it, by an alarm, and not the last one of the audit.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_by_alarm: bool,
    /// Motions.
    pub motions: usize,
    /// Metres driven.
    pub metres: f64,
}

impl GoalRecord {
    /// What a mission was to find out, beside what is known in the end.
    pub fn of(
        mission: &Mission,
        belief: &dyn ReadOut,
        audit: Option<AuditRecord>,
        is_alarmed: bool,
    ) -> Option<Self> {
        let goal = mission.goal?;
        let is_refuted = audit.is_some_and(|audit| audit.refuted.is_some()) || is_alarmed;
        let (slope_arc_deg, misclassified) = match goal.accuracy {
            Accuracy::SlopeArc(turn) => {
                let degrees = f64::from(turn.0 + TURN_OFF) / UNITS_PER_DEGREE;
                (Some((degrees * MILLION).round() / MILLION), None)
            }
            Accuracy::Misclassified(share) => (None, Some(f64::from(share + SHARE_OFF) / MILLION)),
        };
        let level = mission.is_noisy().then(|| f64::from(goal.level) / MILLION);
        let is_met = !is_refuted
            && belief
                .reaches(goal.in_bounds_of(&mission.config.area), mission.config.area.bounds());
        Some(Self { slope_arc_deg, misclassified, level, is_met, audit })
    }
}
