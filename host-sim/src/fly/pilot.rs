//! Decides what a vehicle is sent: takes messages and the time, and returns messages.
//!
//! ```text
//!   Preparing --all is there--> Ready --order--> Moving --at rest there--> Sensing --label--> There
//!       |                         ^                ^                          |                 |
//!       |                         |                +------driven off----------+                 |
//!       |                         +-------------------------taken-------------------------------+
//!       +--not in time--> Over <--at rest, or nobody tells-- Stopping <--a failure, or the end-- any
//!                          ^                                     |                                |
//!                          +--a second later-- Listening <-------+------someone else drives it----+
//! ```
//!
//! A failure is for good: after it only stops and heartbeats are sent, and not even those once someone else drives the
//! vehicle. The vehicle is still listened to, as an autopilot says why a moment after it has acted. Stops are repeated
//! until the vehicle says that it is at rest. They last long enough that no late setpoint arrives after the last of
//! them.

use std::time::Duration;

use mavlink::dialects::common::{GPS_GLOBAL_ORIGIN_DATA, MavMessage};
use mavlink::{MavHeader, MessageData as _};
use planner_core::Label;

use crate::fly::by_hand::{ByHand, ByHandNews};
use crate::fly::failure::Failure;
use crate::fly::frame::Ned;
use crate::fly::label::LabelSource;
use crate::fly::limits::{
    HEARTBEAT, LEAST_STOP, LISTEN, LOST, Limits, MOST_STOP, SETTLED_MS, SILENCE, STEADY,
};
use crate::fly::on_the_way::OnTheWay;
use crate::fly::orders::{AUTOPILOT, Envelope, Order, heartbeat};
use crate::fly::requests::Requests;
use crate::fly::slide::Slide;
use crate::fly::stage::{Arrival, Motion, Stage};
use crate::fly::vehicle::{self, Fix, News, Status, Vehicle};

mod arriving;
mod driving;
mod farewell;
mod waiting;

/// Flies a vehicle.
#[derive(Debug)]
pub struct Pilot {
    system: u8,
    labels: LabelSource,
    limits: Limits,
    vehicle: Vehicle,
    requests: Requests,
    stage: Stage,
    beat: Option<Duration>,
    slide: Slide,
    on_the_way: OnTheWay,
    /// An operator drives before the flight, and what came of it since this was asked last.
    by_hand: Option<ByHand>,
    news_by_hand: Vec<ByHandNews>,
    /// The depth that is kept: the one at the start.
    down: f32,
    failure: Option<Failure>,
    /// When it failed.
    ended: Option<Duration>,
    /// Whether the vehicle has said that it is at rest, when all was over.
    rests: bool,
}

impl Pilot {
    /// Waits for the vehicle with this system id.
    pub fn new(system: u8, labels: LabelSource, limits: Limits) -> Self {
        Self {
            system,
            requests: Requests::new(&labels.source),
            labels,
            limits,
            vehicle: Vehicle::default(),
            stage: Stage::Preparing { since: None, complete: None },
            beat: None,
            slide: Slide::default(),
            on_the_way: OnTheWay::new(1),
            by_hand: None,
            news_by_hand: Vec::new(),
            down: 0.0,
            failure: None,
            ended: None,
            rests: false,
        }
    }

    /// Before the flight it takes labels where the vehicle rests, as its operator drives it. Two in a row are at least so
    /// far apart, metres.
    #[must_use]
    pub fn by_hand(self, apart: f64) -> Self {
        Self { by_hand: Some(ByHand::new(apart, self.limits.tolerance)), ..self }
    }

    /// What came of the operator's driving since this was asked last.
    pub(crate) fn take_by_hand(&mut self) -> Vec<ByHandNews> {
        std::mem::take(&mut self.news_by_hand)
    }

    /// Whether all is there that a flight needs.
    pub const fn is_ready(&self) -> bool {
        matches!(self.stage, Stage::Ready)
    }

    /// Whether nothing more is to be sent.
    pub const fn is_over(&self) -> bool {
        matches!(self.stage, Stage::Over)
    }

    /// Why the flight failed, if it did.
    pub const fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    /// Whether the vehicle has said that it is at rest, when all was over.
    pub const fn is_at_rest(&self) -> bool {
        self.rests
    }

    /// Where the vehicle is and which way it faces, once that is known.
    pub fn whereabouts(&self) -> Option<(Fix, f32)> {
        let (fix, facing) = self.vehicle.fix.zip(self.vehicle.facing)?;
        Some((fix.1, facing.yaw))
    }

    /// Waits for where the vehicle's local frame lies on the globe too.
    pub(crate) fn wants_origin(&mut self) {
        self.requests.want(GPS_GLOBAL_ORIGIN_DATA::ID, GPS_GLOBAL_ORIGIN_DATA::NAME);
    }

    /// The latitude and longitude that its positions count from, once they are known.
    pub(crate) fn origin(&self) -> Option<[f64; 2]> {
        self.vehicle.origin.map(vehicle::degrees)
    }

    /// Has motions with so many labels, the one at the end included.
    pub(crate) fn reads(&mut self, readings: u32) {
        self.on_the_way = OnTheWay::new(readings);
    }

    /// The labels on the way of the motion, and where they were read, since this was asked last.
    pub(crate) fn take_passed(&mut self) -> Vec<(Ned, Label)> {
        self.on_the_way.take()
    }

    /// The end of the last motion. It is returned once.
    pub const fn take_arrival(&mut self) -> Option<Arrival> {
        let Stage::There(arrival) = self.stage else { return None };
        self.stage = Stage::Ready;
        Some(arrival)
    }

    /// Orders a motion. Does nothing unless the pilot is ready.
    pub fn order(&mut self, now: Duration, order: Order, wants_label: bool) {
        if let (Stage::Ready, Some((_, fix))) = (self.stage, self.vehicle.fix) {
            let motion = Motion { order, wants_label, from: fix.at, began: now, sent: None };
            self.on_the_way.begin(fix, order.to);
            self.stage = Stage::Moving { motion, rest: None };
        }
    }

    /// Ends the flight: the vehicle is stopped, if it was ever moved.
    pub fn end(&mut self, now: Duration, failure: Option<Failure>) {
        if matches!(self.stage, Stage::Stopping { .. } | Stage::Listening { .. } | Stage::Over) {
            return;
        }
        self.ended = failure.as_ref().map(|_| now);
        let was_never_ours = matches!(self.stage, Stage::Preparing { .. });
        let is_out_of_hands = failure.as_ref().is_some_and(Failure::is_out_of_our_hands);
        self.failure = failure;
        self.stage = if was_never_ours {
            Stage::Over
        } else if is_out_of_hands {
            Stage::Listening { until: now + LISTEN }
        } else {
            Stage::Stopping { began: now, hold: self.hold(now), sent: None, rests: None }
        };
    }

    /// Ends the flight at once, as nothing can be sent any more.
    pub fn give_up(&mut self, now: Duration, failure: Failure) {
        self.ended.get_or_insert(now);
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
            (Stage::Preparing { complete, .. }, news) => self.attend(now, complete, news),
            (Stage::Listening { .. } | Stage::Over, _) => {}
            (Stage::Stopping { .. }, News::Status(status))
                if status.fault().is_some_and(|it| it.is_out_of_our_hands()) =>
            {
                self.stage = Stage::Listening { until: now + LISTEN };
            }
            (_, News::Status(status)) => {
                if let Some(fault) = status.fault() {
                    self.end(now, Some(fault));
                }
            }
            (_, News::Moved(metres)) => self.end(now, Some(Failure::Slid(metres))),
            (_, News::Breach) => self.end(now, Some(Failure::Fence)),
            (Stage::Moving { .. }, News::HeldBack) => self.end(now, Some(Failure::HeldBack)),
            (Stage::Stopping { .. }, News::Restart) => {
                self.stage = Stage::Listening { until: now + LISTEN };
            }
            (_, News::Restart) => self.end(now, Some(Failure::Restarted)),
            (Stage::Stopping { .. }, News::Fix(fix)) => self.locate(now, fix),
            (_, News::Fix(fix)) => match self.slide.take(fix, self.limits.tolerance) {
                Some(metres) => self.end(now, Some(Failure::Slid(metres))),
                None => self.locate(now, fix),
            },
            (Stage::Moving { .. }, News::Label(told)) => self.on_the_way.hear(told),
            // A label that was sensed on the way may arrive late.
            (Stage::Sensing { motion, arrived, is_calm, since, told: None }, News::Label(told))
                if told.at_ms >= arrived.at_ms =>
            {
                let told = Some(told);
                self.stage = Stage::Sensing { motion, arrived, is_calm, since, told };
            }
            _ => {}
        }
    }

    /// The messages to send now. It must be called often, because it also notices what did not arrive in time.
    pub fn due(&mut self, now: Duration) -> Vec<MavMessage> {
        self.look(now);
        let mut due = Vec::new();
        if matches!(self.stage, Stage::Listening { .. } | Stage::Over) {
            return due;
        }
        if self.beat.is_none_or(|last| now >= last + HEARTBEAT) {
            self.beat = Some(now);
            due.push(heartbeat());
        }
        let envelope = Envelope { system: self.system, now };
        due.extend(self.drive(envelope));
        if matches!(self.stage, Stage::Preparing { .. }) && self.vehicle.status.is_some() {
            due.extend(self.requests.due(envelope));
        }
        due
    }

    /// Goes on to the next stage when its time has come, and notices what did not arrive in time.
    fn look(&mut self, now: Duration) {
        let limits = self.limits;
        match self.stage {
            Stage::Over => return,
            Stage::Listening { until } => {
                if now >= until {
                    self.stage = Stage::Over;
                }
                return;
            }
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
                        self.vehicle.warnings.clear();
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
                let off = self.off(&motion.order);
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

    /// The vehicle's status, if its last heartbeat is recent.
    fn status(&self, now: Duration) -> Option<Status> {
        self.vehicle.status.filter(|it| now < it.0 + SILENCE).map(|it| it.1)
    }

    /// The vehicle's position, if the last one is recent.
    fn fix(&self, now: Duration) -> Option<Fix> {
        self.vehicle.fix.filter(|it| now < it.0 + LOST).map(|it| it.1)
    }
}
