//! The vehicle of a dry run: an ideal rover in simulated time, which records what it is sent.
//!
//! It is at the mission's start, armed and in guided mode. It drives straight to where it is sent, at a metre a second.
//! It takes on the yaw that it is sent at once, and senses true labels.

use std::collections::VecDeque;
use std::time::Duration;

use anyhow::Result;
use mavlink::MavHeader;
use mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, GPS_GLOBAL_ORIGIN_DATA, HEARTBEAT_DATA,
    LOCAL_POSITION_NED_DATA, MavAutopilot, MavMessage, MavModeFlag, MavState, MavType,
    NAMED_VALUE_FLOAT_DATA, PositionTargetTypemask as Ignored, RC_CHANNELS_DATA,
};
use planner_core::{Label, Reading};

use crate::fly::frame::{Local, Ned};
use crate::fly::label::{LabelSource, Source, channels};
use crate::fly::link::Link;
use crate::fly::orders::AUTOPILOT;
use crate::fly::sent::Sent;
use crate::mission::definition::Mission;
use crate::world::World;

/// The time between two of its positions, attitudes and labels. Each tenth comes with a heartbeat.
const TICK: Duration = Duration::from_millis(100);

/// Metres that it drives in a tick.
const DRIVE: f64 = 0.1;

/// An ideal vehicle.
pub struct Ideal {
    system: u8,
    world: World,
    local: Local,
    /// On a map: the latitude and the longitude that its positions count from, those of the mission's start.
    origin: Option<[f64; 2]>,
    labels: LabelSource,
    now: Duration,
    ticks: u32,
    at: Ned,
    yaw: f32,
    /// Where it drives.
    to: Option<Ned>,
    /// Messages that it has sent and nobody has received.
    said: VecDeque<MavMessage>,
    sent: Vec<Sent>,
}

impl Ideal {
    /// A vehicle at the start of a mission.
    pub fn new(mission: &Mission, system: u8, labels: LabelSource) -> Self {
        let lake = mission.lake.as_deref();
        let start = mission.start;
        let origin = lake.and_then(|it| it.frame.on_globe(start.site.into()).ok());
        // As a message tells it.
        let origin = origin.map(|it| it.map(|degrees| (degrees * 1e7).round() * 1e-7));
        let local = Local::of(lake, origin);
        Self {
            system,
            world: mission.world.clone(),
            origin,
            labels,
            now: Duration::ZERO,
            ticks: 0,
            at: local.ned(start.site).unwrap_or(Ned { north: 0.0, east: 0.0 }),
            yaw: local.yaw(start),
            local,
            to: None,
            said: VecDeque::new(),
            sent: Vec::new(),
        }
    }

    /// What it was sent.
    pub fn sent(&self) -> &[Sent] {
        &self.sent
    }

    /// A tenth of a second passes.
    fn tick(&mut self) {
        self.ticks += 1;
        self.now = TICK * self.ticks;
        let before = self.at;
        if let Some(to) = self.to {
            let left = self.at.distance(to);
            let part = (DRIVE / left) as f32;
            self.at = if left <= DRIVE {
                to
            } else {
                Ned {
                    north: before.north + part * (to.north - before.north),
                    east: before.east + part * (to.east - before.east),
                }
            };
        }
        let time_boot_ms = self.now.as_millis() as u32;
        if self.ticks % 10 == 1 {
            self.said.push_back(MavMessage::HEARTBEAT(HEARTBEAT_DATA {
                custom_mode: 15,
                mavtype: MavType::MAV_TYPE_GROUND_ROVER,
                autopilot: MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA,
                base_mode: MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED,
                system_status: MavState::MAV_STATE_ACTIVE,
                ..HEARTBEAT_DATA::DEFAULT
            }));
        }
        let per_tick = |to: f32, from: f32| (to - from) / TICK.as_secs_f32();
        self.said.push_back(MavMessage::LOCAL_POSITION_NED(LOCAL_POSITION_NED_DATA {
            time_boot_ms,
            x: self.at.north,
            y: self.at.east,
            vx: per_tick(self.at.north, before.north),
            vy: per_tick(self.at.east, before.east),
            ..LOCAL_POSITION_NED_DATA::DEFAULT
        }));
        let attitude = ATTITUDE_DATA { time_boot_ms, yaw: self.yaw, ..ATTITUDE_DATA::DEFAULT };
        self.said.push_back(MavMessage::ATTITUDE(attitude));
        self.said.extend(self.label(time_boot_ms));
        self.said.extend(self.origin.map(|origin| {
            let [latitude, longitude] = origin.map(|it| (it * 1e7).round() as i32);
            let it =
                GPS_GLOBAL_ORIGIN_DATA { latitude, longitude, ..GPS_GLOBAL_ORIGIN_DATA::DEFAULT };
            MavMessage::GPS_GLOBAL_ORIGIN(it)
        }));
    }

    /// The message with the label at its place.
    fn label(&self, time_boot_ms: u32) -> Option<MavMessage> {
        let reading = self.world.reading(self.local.site(self.at)?);
        let is_positive = reading == Reading::Side(Label::Positive);
        let value = self.labels.threshold + if is_positive { 1.0 } else { -1.0 };
        Some(match &self.labels.source {
            Source::Named(name) => MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA {
                time_boot_ms,
                value: value as f32,
                name: name.as_str().into(),
            }),
            // All channels say the same.
            Source::Channel(_) => {
                let mut rc =
                    RC_CHANNELS_DATA { time_boot_ms, chancount: 18, ..RC_CHANNELS_DATA::DEFAULT };
                for channel in channels(&mut rc) {
                    *channel = value as u16;
                }
                MavMessage::RC_CHANNELS(rc)
            }
        })
    }
}

impl Link for Ideal {
    fn now(&self) -> Duration {
        self.now
    }

    fn send(&mut self, message: &MavMessage) {
        self.sent.push((self.now, message.clone()));
        match message {
            MavMessage::COMMAND_LONG(it) => {
                let ack = COMMAND_ACK_DATA { command: it.command, ..COMMAND_ACK_DATA::DEFAULT };
                self.said.push_back(MavMessage::COMMAND_ACK(ack));
            }
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) => {
                let goes = !it.type_mask.contains(Ignored::POSITION_TARGET_TYPEMASK_X_IGNORE);
                self.to = goes.then_some(Ned { north: it.x, east: it.y });
                if !it.type_mask.contains(Ignored::POSITION_TARGET_TYPEMASK_YAW_IGNORE) {
                    self.yaw = it.yaw;
                }
            }
            _ => {}
        }
    }

    fn receive(&mut self, until: Duration) -> Result<Option<(MavHeader, MavMessage)>> {
        if self.said.is_empty() {
            if TICK * (self.ticks + 1) > until {
                self.now = until;
                return Ok(None);
            }
            self.tick();
        }
        let header =
            MavHeader { system_id: self.system.into(), component_id: AUTOPILOT, sequence: 0 };
        Ok(self.said.pop_front().map(|message| (header, message)))
    }
}
