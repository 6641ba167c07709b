//! When a motion has come to its end: the vehicle rests where it was sent, or rests for long near that.
//!
//! `ArduPilot` ends a leg where it likes: within its own radius, or where a rover that steers like a car has passed its
//! target. The planner takes the place where the vehicle is, so any place is good that the vehicle has come to. One that
//! does not move at all is stuck. A turn that does not turn is none.

use std::time::Duration;

use planner_core::belief::sample::Label;

use crate::fly::frame::{ALIKE, apart};
use crate::fly::limits::{LEAST_WAY, NEAR, RESIGNED_MS, SETTLED_MS, SLOW, STIRS};
use crate::fly::pilot::Pilot;
use crate::fly::stage::{Arrival, Motion, Sent, Stage};
use crate::fly::vehicle::Fix;

/// Where a vehicle is, as to where it was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// It rests there.
    There,
    /// It rests near it.
    Near,
    /// It moves, or is elsewhere.
    Away,
}

impl Pilot {
    /// The vehicle says where it is.
    pub(super) fn locate(&mut self, now: Duration, fix: Fix) {
        match self.stage {
            Stage::Moving { motion, rests } => self.approach(now, motion, rests, fix),
            Stage::Sensing { motion, arrived, told, .. } => {
                let stays = self.standing(&motion, fix) == Standing::There
                    || !motion.order.is_turn
                        && fix.speed() <= SLOW
                        && fix.at.distance(arrived.at) <= self.limits.acceptance;
                if !stays {
                    self.stage = Stage::Moving { motion, rests: None };
                    return;
                }
                // It was there before the label, and is there after it.
                let told = told.filter(|told| fix.at_ms >= told.at_ms);
                if let Some((told, faces)) = told.zip(self.vehicle.facing) {
                    let label = Some(told.label);
                    self.stage = Stage::There(self.arrival(&motion, fix, faces.yaw, label));
                }
            }
            Stage::Stopping { began, hold, sent, rests } => {
                let rests = rests.or(sent.map(|_| fix.at_ms)).filter(|_| fix.speed() <= SLOW);
                self.stage = Stage::Stopping { began, hold, sent, rests };
            }
            _ => {}
        }
    }

    /// A motion goes on, or comes to its end; it rests since that.
    fn approach(&mut self, now: Duration, mut motion: Motion, rests: Option<u32>, fix: Fix) {
        self.note_stirring(now, &mut motion, fix);
        let since = rests.unwrap_or(fix.at_ms);
        let long_enough = match self.standing(&motion, fix) {
            Standing::There => SETTLED_MS,
            Standing::Near => RESIGNED_MS,
            Standing::Away => {
                self.stage = Stage::Moving { motion, rests: None };
                return;
            }
        };
        let faces = self.vehicle.facing.filter(|it| it.at_ms >= since);
        self.stage = Stage::Moving { motion, rests: Some(since) };
        let Some(faces) = faces.filter(|_| fix.at_ms - since >= long_enough) else { return };
        self.stage = if motion.wants_label {
            Stage::Sensing { motion, arrived: fix, since: now, told: None }
        } else {
            Stage::There(self.arrival(&motion, fix, faces.yaw, None))
        };
    }

    fn arrival(&self, motion: &Motion, fix: Fix, yaw: f32, label: Option<Label>) -> Arrival {
        let is_short = self.standing(motion, fix) != Standing::There;
        Arrival { fix, yaw, label, is_short }
    }

    pub(super) fn standing(&self, motion: &Motion, fix: Fix) -> Standing {
        let order = &motion.order;
        let off = fix.at.distance(order.to);
        let faces = |yaw: f32| !order.is_turn || apart(yaw, order.yaw) < ALIKE;
        if fix.speed() > SLOW || !self.vehicle.facing.is_some_and(|it| faces(it.yaw)) {
            return Standing::Away;
        }
        if off <= self.limits.acceptance {
            return Standing::There;
        }
        let way = LEAST_WAY.min(motion.from.distance(order.to) / 2.0);
        let has_come = fix.at.distance(motion.from) >= way;
        if !order.is_turn && has_come && off <= NEAR { Standing::Near } else { Standing::Away }
    }

    /// Notes when the vehicle stirs, wherever it is by then: a setpoint that came late may have led it away and back.
    fn note_stirring(&self, now: Duration, motion: &mut Motion, fix: Fix) {
        let Some((sent, facing)) = motion.sent.as_mut().zip(self.vehicle.facing) else { return };
        let stirs = fix.speed() > SLOW
            || fix.at.distance(sent.place) > STIRS
            || apart(facing.yaw, sent.yaw) > ALIKE;
        if stirs {
            *sent = Sent { at: sent.at, stirred: now, place: fix.at, yaw: facing.yaw };
        }
    }
}
