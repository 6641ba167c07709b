//! The end of a motion: the vehicle rests at its target, or rests for longer near it.
//!
//! `ArduPilot` ends a leg within its own radius, or where a rover that steers like a car has passed its target. The
//! planner goes on from where the vehicle is, so a place near the target is good enough. A vehicle that does not move
//! at all has not arrived: it is stuck. Nor has a turn been made that leaves the heading as it was.
//!
//! In a current or in waves a vehicle holds its place and never rests. It has arrived when it has stayed for long,
//! either within the acceptance of its target or about a place near the target.

use std::time::Duration;

use planner_core::Label;

use crate::fly::frame::{ALIKE, apart};
use crate::fly::limits::{LEAST_WAY, NEAR, RESIGNED_MS, SETTLED_MS, SLOW, STIRS, WOBBLES};
use crate::fly::pilot::Pilot;
use crate::fly::stage::{Arrival, Motion, Rest, Sent, Stage};
use crate::fly::vehicle::Fix;

/// Where a vehicle is relative to its target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// It is there.
    There,
    /// It is near it.
    Near,
    /// It is elsewhere.
    Away,
}

impl Pilot {
    /// Takes in a position.
    pub(super) fn locate(&mut self, now: Duration, fix: Fix) {
        match self.stage {
            Stage::Moving { motion, rest } => {
                self.on_the_way.locate(fix);
                self.approach(now, motion, rest, fix);
            }
            Stage::Sensing { motion, arrived, is_calm, told, .. } => {
                let acceptance = self.limits.acceptance;
                let within = if is_calm { acceptance } else { acceptance.max(WOBBLES) };
                let is_there = self.standing(&motion, fix) == Standing::There
                    || !motion.order.is_turn && fix.at.distance(arrived.at) <= within;
                if !is_there || is_calm && fix.speed() > SLOW {
                    self.stage = Stage::Moving { motion, rest: None };
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

    /// A motion goes on, or comes to its end: the vehicle has come to rest, or has stayed for long.
    fn approach(&mut self, now: Duration, mut motion: Motion, rest: Option<Rest>, fix: Fix) {
        self.note_stirring(now, &mut motion, fix);
        let standing = self.standing(&motion, fix);
        if standing == Standing::Away {
            self.stage = Stage::Moving { motion, rest: None };
            return;
        }
        let most = if standing == Standing::Near { WOBBLES } else { f64::INFINITY };
        let rest = Rest::by(rest, fix, most);
        self.stage = Stage::Moving { motion, rest: Some(rest) };
        let settles = if standing == Standing::There { SETTLED_MS } else { RESIGNED_MS };
        let is_calm = rest.is_calm(fix, settles);
        let ends = is_calm || rest.is_long(fix);
        let until = rest.slow.unwrap_or(rest.since);
        let Some(faces) = self.vehicle.facing.filter(|it| ends && it.at_ms >= until) else {
            return;
        };
        self.stage = if motion.wants_label {
            Stage::Sensing { motion, arrived: fix, is_calm, since: now, told: None }
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
        if !self.vehicle.facing.is_some_and(|it| faces(it.yaw)) {
            return Standing::Away;
        }
        if off <= self.limits.acceptance {
            return Standing::There;
        }
        let way = LEAST_WAY.min(motion.from.distance(order.to) / 2.0);
        let has_come = fix.at.distance(motion.from) >= way;
        if !order.is_turn && has_come && off <= NEAR { Standing::Near } else { Standing::Away }
    }

    /// Notes when the vehicle stirs, also at its target: a late setpoint may have led it away and back.
    fn note_stirring(&self, now: Duration, motion: &mut Motion, fix: Fix) {
        let Some((sent, facing)) = motion.sent.as_mut().zip(self.vehicle.facing) else { return };
        if fix.at.distance(sent.place) > STIRS || apart(facing.yaw, sent.yaw) > ALIKE {
            *sent = Sent { at: sent.at, stirred: now, place: fix.at, yaw: facing.yaw };
        }
    }
}
