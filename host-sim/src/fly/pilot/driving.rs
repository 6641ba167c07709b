//! Sends setpoints and stops. A setpoint is repeated only where that does no harm.
//!
//! With each setpoint `ArduPilot` begins the leg and its S-curve anew: Sub crawls if it is sent one a second. So a
//! setpoint is soon repeated only to a vehicle that does not stir, which may not have heard it.

use std::time::Duration;

use mavlink::dialects::common::MavMessage;

use crate::fly::autopilot::Craft;
use crate::fly::limits::{AGAIN, HOLD, SETPOINT, SLOW, STOP};
use crate::fly::orders::{Envelope, Order};
use crate::fly::pilot::Pilot;
use crate::fly::pilot::arriving::Standing;
use crate::fly::stage::{Hold, Motion, Sent, Stage};

impl Pilot {
    /// The setpoint or the stop that is due.
    pub(super) fn drive(&mut self, envelope: Envelope) -> Option<MavMessage> {
        let now = envelope.now;
        let craft = self.vehicle.status?.1.craft;
        match self.stage {
            Stage::Moving { mut motion, rest } if self.is_due(now, &motion) => {
                let (fix, yaw) = self.whereabouts()?;
                motion.sent = Some(Sent { at: now, stirred: now, place: fix.at, yaw });
                self.stage = Stage::Moving { motion, rest };
                Some(envelope.setpoint(&motion.order, craft, self.down))
            }
            Stage::Stopping { began, hold, sent, rests } => {
                // The first is sent twice at once: one may be lost.
                let is_early = sent.is_some_and(|it| it < began + STOP);
                let every = if hold.is_some() && !is_early { HOLD } else { STOP };
                if sent.is_some_and(|last| now < last + every) {
                    return None;
                }
                self.stage = Stage::Stopping { began, hold, sent: Some(now), rests };
                Some(hold.map_or_else(
                    || envelope.stop(),
                    |Hold { at: to, yaw }| {
                        envelope.setpoint(&Order { to, yaw, is_turn: false }, craft, self.down)
                    },
                ))
            }
            _ => None,
        }
    }

    /// Whether a setpoint is to be sent, for the first time or again.
    fn is_due(&self, now: Duration, motion: &Motion) -> bool {
        let Some((sent, (heard, fix))) = motion.sent.zip(self.vehicle.fix) else { return true };
        match self.standing(motion, fix) {
            Standing::There => false,
            // A rover that steers like a car and has passed its target would drive a circle to it.
            Standing::Near if fix.speed() <= SLOW => false,
            // A position from a second later shows that it has not stirred since.
            _ => now >= sent.at + AGAIN || heard >= sent.stirred + SETPOINT,
        }
    }

    /// The place at which a vehicle is to stop, if it needs one: velocities of zero do not stop Sub.
    pub(super) fn hold(&self, now: Duration) -> Option<Hold> {
        let (_, status) = self.vehicle.status?;
        let (fix, (_, yaw)) = self.fix(now).zip(self.whereabouts())?;
        (status.craft == Craft::Submarine).then_some(Hold { at: fix.at, yaw })
    }
}
