//! What is decided while a vehicle is flown: messages and the time in, messages out.
//!
//! ```text
//!   Preparing --all is there--> Ready --order--> Moving --at rest there--> Sensing --label--> There
//!       |                         ^                ^                          |                 |
//!       |                         |                +------driven off----------+                 |
//!       |                         +-------------------------taken-------------------------------+
//!       +--not in time--> Over <--at rest, or nobody tells-- Stopping <--a failure, or the end-- any
//! ```
//!
//! A failure is for good: after it nothing is sent but stops and heartbeats, and not even those once someone else drives
//! the vehicle. Stops are repeated until the vehicle says that it is at rest, and for long enough that a setpoint
//! which is late cannot come after the last of them.

use std::time::Duration;

use mavlink::MavHeader;
use mavlink::dialects::common::MavMessage;

use crate::fly::failure::Failure;
use crate::fly::frame::{ALIKE, apart};
use crate::fly::label::LabelSource;
use crate::fly::limits::{
    HEARTBEAT, LEAST_STOP, LOST, Limits, MOST_STOP, SETPOINT, SETTLED_MS, SILENCE, SLOW, STEADY,
    STOP,
};
use crate::fly::orders::{AUTOPILOT, Envelope, Order, heartbeat};
use crate::fly::requests::Requests;
use crate::fly::stage::{Arrival, Motion, Stage};
use crate::fly::vehicle::{Fix, News, Status, Vehicle};

/// Who flies a vehicle.
#[derive(Debug)]
pub struct Pilot {
    system: u8,
    labels: LabelSource,
    limits: Limits,
    vehicle: Vehicle,
    requests: Requests,
    stage: Stage,
    beat: Option<Duration>,
    /// The depth that is kept: the one at the start.
    down: f32,
    failure: Option<Failure>,
    /// Whether the vehicle has said that it is at rest, when all was over.
    rests: bool,
}

impl Pilot {
    /// Waits for the vehicle with this system id.
    pub fn new(system: u8, labels: LabelSource, limits: Limits) -> Self {
        let requests = Requests::new(&labels.source);
        let stage = Stage::Preparing { since: None, complete: None };
        let vehicle = Vehicle::default();
        let (beat, failure) = (None, None);
        let (down, rests) = (0.0, false);
        Self { system, labels, limits, vehicle, requests, stage, beat, down, failure, rests }
    }

    /// Whether all is there that a flight needs.
    pub const fn is_ready(&self) -> bool {
        matches!(self.stage, Stage::Ready)
    }

    /// Whether nothing more is to be sent.
    pub const fn is_over(&self) -> bool {
        matches!(self.stage, Stage::Over)
    }

    /// Why it came to nothing, if it has.
    pub const fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    /// What became of the vehicle in the end, for people.
    pub const fn farewell(&self) -> &'static str {
        match &self.failure {
            Some(failure) if failure.is_out_of_our_hands() => "nothing more was sent to it",
            _ if self.rests => "it was told to stop, and says that it is at rest",
            _ => "it was told to stop, and does not say that it is at rest",
        }
    }

    /// Whether the vehicle has said that it is at rest, when all was over.
    pub const fn is_at_rest(&self) -> bool {
        self.rests
    }

    /// The vehicle's last warning.
    pub fn warning(&self) -> Option<&str> {
        self.vehicle.warning.as_deref()
    }

    /// Where the vehicle is and which way it faces, once that is known.
    pub fn whereabouts(&self) -> Option<(Fix, f32)> {
        let (fix, facing) = self.vehicle.fix.zip(self.vehicle.facing)?;
        Some((fix.1, facing.yaw))
    }

    /// What a motion came to, once.
    pub const fn take_arrival(&mut self) -> Option<Arrival> {
        let Stage::There(arrival) = self.stage else { return None };
        self.stage = Stage::Ready;
        Some(arrival)
    }

    /// Sends the vehicle somewhere; nowhere unless it is ready.
    pub const fn order(&mut self, now: Duration, order: Order, wants_label: bool) {
        if let Stage::Ready = self.stage {
            let motion = Motion { order, wants_label, began: now, sent: None };
            self.stage = Stage::Moving { motion, rests: None };
        }
    }

    /// Ends the flight: the vehicle is stopped, if it was ever moved.
    pub fn end(&mut self, now: Duration, failure: Option<Failure>) {
        if matches!(self.stage, Stage::Stopping { .. } | Stage::Over) {
            return;
        }
        let was_never_ours = matches!(self.stage, Stage::Preparing { .. });
        let is_out_of_hands = failure.as_ref().is_some_and(Failure::is_out_of_our_hands);
        self.failure = failure;
        self.stage = if was_never_ours || is_out_of_hands {
            Stage::Over
        } else {
            Stage::Stopping { began: now, sent: None, rests: None }
        };
    }

    /// Ends the flight at once, as nothing can be sent any more.
    pub fn give_up(&mut self, failure: Failure) {
        self.failure.get_or_insert(failure);
        self.stage = Stage::Over;
    }

    /// Takes in a message.
    pub fn hear(&mut self, now: Duration, header: MavHeader, message: &MavMessage) {
        if (header.system_id, header.component_id) != (self.system.into(), AUTOPILOT) {
            return;
        }
        if let MavMessage::COMMAND_ACK(ack) = message
            && let Err(failure) = self.requests.answer(now, ack)
        {
            return self.end(now, Some(failure));
        }
        match self.vehicle.hear(now, message, &self.labels) {
            Ok(None) => {}
            Ok(Some(news)) => self.heed(now, news),
            Err(failure) => self.end(now, Some(failure)),
        }
    }

    fn heed(&mut self, now: Duration, news: News) {
        match (self.stage, news) {
            // What is wrong before the flight is what it waits for.
            (Stage::Preparing { .. } | Stage::Over, _) => {}
            (Stage::Stopping { .. }, News::Status(status))
                if status.fault().is_some_and(|it| it.is_out_of_our_hands()) =>
            {
                self.stage = Stage::Over;
            }
            (_, News::Status(status)) => {
                if let Some(fault) = status.fault() {
                    self.end(now, Some(fault));
                }
            }
            (_, News::Breach) => self.end(now, Some(Failure::Fence)),
            (_, News::Fix(fix)) => self.locate(now, fix),
            // What was sensed on the way may come late.
            (Stage::Sensing { motion, arrived_ms, since, told: None }, News::Label(told))
                if told.at_ms >= arrived_ms =>
            {
                self.stage = Stage::Sensing { motion, arrived_ms, since, told: Some(told) };
            }
            _ => {}
        }
    }

    /// The vehicle says where it is.
    fn locate(&mut self, now: Duration, fix: Fix) {
        match self.stage {
            Stage::Moving { motion, rests } => {
                if !self.is_there(&motion.order, fix) {
                    self.stage = Stage::Moving { motion, rests: None };
                    return;
                }
                let since = rests.unwrap_or(fix.at_ms);
                let faces = self.vehicle.facing.filter(|it| it.at_ms >= since);
                self.stage = Stage::Moving { motion, rests: Some(since) };
                let Some(faces) = faces.filter(|_| fix.at_ms - since >= SETTLED_MS) else { return };
                self.stage = if motion.wants_label {
                    let arrived_ms = fix.at_ms;
                    Stage::Sensing { motion, arrived_ms, since: now, told: None }
                } else {
                    Stage::There(Arrival { fix, yaw: faces.yaw, label: None })
                };
            }
            Stage::Sensing { motion, told, .. } => {
                if !self.is_there(&motion.order, fix) {
                    self.stage = Stage::Moving { motion, rests: None };
                    return;
                }
                // It was there before the label, and is there after it.
                let told = told.filter(|told| fix.at_ms >= told.at_ms);
                if let Some((told, faces)) = told.zip(self.vehicle.facing) {
                    let label = Some(told.label);
                    self.stage = Stage::There(Arrival { fix, yaw: faces.yaw, label });
                }
            }
            Stage::Stopping { began, sent, rests } => {
                let rests = rests.or(sent.map(|_| fix.at_ms)).filter(|_| fix.speed <= SLOW);
                self.stage = Stage::Stopping { began, sent, rests };
            }
            _ => {}
        }
    }

    /// Whether the vehicle rests where it was sent.
    fn is_there(&self, order: &Order, fix: Fix) -> bool {
        let faces = |yaw: f32| !order.is_turn || apart(yaw, order.yaw) < ALIKE;
        fix.at.distance(order.to) <= self.limits.acceptance
            && fix.speed <= SLOW
            && self.vehicle.facing.is_some_and(|it| faces(it.yaw))
    }

    /// What is to be sent now. Who calls this calls it often: it looks for what did not come in time, too.
    pub fn due(&mut self, now: Duration) -> Vec<MavMessage> {
        self.look(now);
        let mut due = Vec::new();
        if self.is_over() {
            return due;
        }
        if self.beat.is_none_or(|last| now >= last + HEARTBEAT) {
            self.beat = Some(now);
            due.push(heartbeat());
        }
        let envelope = Envelope { system: self.system, now };
        let is_due = |sent: Option<Duration>, every| sent.is_none_or(|last| now >= last + every);
        match &mut self.stage {
            Stage::Preparing { .. } if self.vehicle.status.is_some() => {
                due.extend(self.requests.due(envelope));
            }
            Stage::Moving { motion, .. } if is_due(motion.sent, SETPOINT) => {
                if let Some((_, status)) = self.vehicle.status {
                    motion.sent = Some(now);
                    due.push(envelope.setpoint(&motion.order, status.craft, self.down));
                }
            }
            Stage::Stopping { sent, .. } if is_due(*sent, STOP) => {
                *sent = Some(now);
                due.push(envelope.stop());
            }
            _ => {}
        }
        due
    }

    /// Looks for what is there now, and for what did not come in time.
    fn look(&mut self, now: Duration) {
        let limits = self.limits;
        match self.stage {
            Stage::Over => return,
            Stage::Preparing { since, complete } => {
                let since = since.unwrap_or(now);
                if self.fix(now).is_none() {
                    // It may have been started anew, and its clock with it.
                    (self.vehicle.fix, self.vehicle.facing) = (None, None);
                }
                if self.status(now).is_some() && self.unheard(now).is_some() {
                    self.requests.renew(now);
                }
                let missing = self.missing(now);
                let complete = complete.or(Some(now)).filter(|_| missing.is_none());
                self.stage = Stage::Preparing { since: Some(since), complete };
                match missing {
                    None if complete.is_some_and(|it| now < it + STEADY) => {}
                    None => {
                        self.stage = Stage::Ready;
                        self.vehicle.warning = None;
                        self.down = self.vehicle.fix.map_or(0.0, |it| it.1.down);
                    }
                    Some(missing) if now >= since + limits.ready => {
                        self.end(now, Some(Failure::NotReady(limits.ready, missing)));
                    }
                    Some(_) => {}
                }
                return;
            }
            Stage::Stopping { began, rests, .. } => {
                let at_rest = rests.zip(self.vehicle.fix);
                let rests = at_rest.is_some_and(|(since, fix)| fix.1.at_ms - since >= SETTLED_MS);
                let stopped = now.saturating_sub(began);
                if stopped >= MOST_STOP || rests && stopped >= LEAST_STOP {
                    (self.stage, self.rests) = (Stage::Over, rests);
                }
                return;
            }
            Stage::Moving { motion, .. } if now >= motion.began + limits.motion => {
                let off = self.vehicle.fix.map_or(0.0, |it| it.1.at.distance(motion.order.to));
                let off = format!("it is {off:.2} m from where it was sent");
                self.end(now, Some(Failure::Late(limits.motion, off)));
                return;
            }
            Stage::Sensing { since, .. } if now >= since + limits.label => {
                let source = self.labels.source.to_string();
                self.end(now, Some(Failure::NoLabel(limits.label, source)));
                return;
            }
            _ => {}
        }
        if self.status(now).is_none() {
            self.end(now, Some(Failure::Silent(SILENCE)));
        } else if self.fix(now).is_none() {
            self.end(now, Some(Failure::Lost(LOST)));
        }
    }

    /// How the vehicle is, if it has said so of late.
    fn status(&self, now: Duration) -> Option<Status> {
        self.vehicle.status.filter(|it| now < it.0 + SILENCE).map(|it| it.1)
    }

    /// Where it is, if it has said so of late.
    fn fix(&self, now: Duration) -> Option<Fix> {
        self.vehicle.fix.filter(|it| now < it.0 + LOST).map(|it| it.1)
    }

    /// What it does not say that it is to say.
    fn unheard(&self, now: Duration) -> Option<String> {
        if self.fix(now).is_none() {
            Some("its local position (LOCAL_POSITION_NED)".to_owned())
        } else if self.vehicle.facing.is_none() {
            Some("its attitude (ATTITUDE)".to_owned())
        } else if self.vehicle.label.is_none() {
            Some(self.labels.source.to_string())
        } else {
            None
        }
    }

    /// What is missing before the flight can begin, for people.
    pub fn missing(&self, now: Duration) -> Option<String> {
        let Some(status) = self.status(now) else {
            return Some(format!("a heartbeat of system {}", self.system));
        };
        if let Some(message) = self.requests.missing() {
            return Some(format!("its word that it sends {message}"));
        }
        if let Some(unheard) = self.unheard(now) {
            return Some(unheard);
        }
        match status.fault() {
            Some(Failure::TakenOver(mode)) => Some(format!("mode GUIDED, it is in {mode}")),
            Some(Failure::Disarmed) => Some("its operator to arm it".to_owned()),
            Some(other) => Some(format!("a vehicle that is well: {other}")),
            None if self.vehicle.is_outside => Some("a vehicle inside its geofence".to_owned()),
            None => None,
        }
    }
}
