//! What is known of the vehicle from its messages. They may come late, twice or not at all. Of those with the vehicle's
//! time only newer ones count.

use std::time::Duration;

use mavlink::dialects::common::{FenceMitigate, MavMessage, MavModeFlag, MavSeverity, MavState};

use crate::fly::autopilot::Craft;
use crate::fly::failure::Failure;
use crate::fly::frame::{Ned, apart_on_globe};
use crate::fly::label::{LabelSource, Told};

/// A clock that goes back by more than this was started anew, milliseconds. No message is as late.
pub(crate) const RESTART_MS: u32 = 10_000;

/// Warnings that are kept.
const MOST_WARNINGS: usize = 8;

/// Where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fix {
    /// By the vehicle's clock, milliseconds.
    pub at_ms: u32,
    /// The place.
    pub at: Ned,
    /// Depth below the origin, metres.
    pub down: f32,
    /// Metres a second over ground, to the north and to the east.
    pub velocity: [f64; 2],
}

impl Fix {
    /// Metres a second over ground.
    pub fn speed(&self) -> f64 {
        libm::hypot(self.velocity[0], self.velocity[1])
    }
}

/// Which way it faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// By the vehicle's clock, milliseconds.
    pub at_ms: u32,
    /// Radians.
    pub yaw: f32,
}

/// What its heartbeat said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status {
    /// What it is.
    pub craft: Craft,
    /// The number of its mode.
    pub mode: u32,
    /// Whether its motors may run.
    pub is_armed: bool,
    /// How it is.
    pub state: MavState,
}

impl Status {
    /// Whether its autopilot is still starting.
    const fn is_starting(&self) -> bool {
        matches!(self.state, MavState::MAV_STATE_BOOT | MavState::MAV_STATE_UNINIT)
            || self.craft.is_initialising(self.mode)
    }

    /// Why it cannot be flown as it is, the gravest first.
    pub fn fault(&self) -> Option<Failure> {
        if self.is_starting() {
            return Some(Failure::Restarted);
        }
        if self.mode != self.craft.guided() {
            return Some(Failure::TakenOver(self.craft.mode(self.mode)));
        }
        if !self.is_armed {
            return Some(Failure::Disarmed);
        }
        match self.state {
            MavState::MAV_STATE_CRITICAL
            | MavState::MAV_STATE_EMERGENCY
            | MavState::MAV_STATE_POWEROFF
            | MavState::MAV_STATE_FLIGHT_TERMINATION => {
                Some(Failure::Failsafe(format!("system status {:?}", self.state)))
            }
            _ => None,
        }
    }
}

/// What is new.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum News {
    /// How it is.
    Status(Status),
    /// Where it is.
    Fix(Fix),
    /// A label.
    Label(Told),
    /// It left its geofence.
    Breach,
    /// Its geofence holds it back.
    HeldBack,
    /// Its clock went back.
    Restart,
    /// Its positions count from elsewhere, so many metres away.
    Moved(f64),
}

/// A vehicle as it is known. Times are ours.
#[derive(Clone, Debug, Default)]
pub struct Vehicle {
    /// The last heartbeat, and when it came.
    pub status: Option<(Duration, Status)>,
    /// The last position, and when it came.
    pub fix: Option<(Duration, Fix)>,
    /// The latitude and longitude that positions count from, units of 1e-7 degrees.
    pub origin: Option<[i32; 2]>,
    /// The last attitude.
    pub facing: Option<Facing>,
    /// The last label.
    pub label: Option<Told>,
    /// Whether it is outside of its geofence.
    pub is_outside: bool,
    /// The last warnings that it gave, and when.
    pub warnings: Vec<(Duration, String)>,
}

impl Vehicle {
    /// Takes in a message of its autopilot; what is new.
    ///
    /// # Errors
    /// When it is no vehicle that is known here.
    pub fn hear(
        &mut self,
        now: Duration,
        message: &MavMessage,
        labels: &LabelSource,
    ) -> Result<Option<News>, Failure> {
        if let Some(told) = labels.read(message) {
            self.label = Some(told);
            return Ok(Some(News::Label(told)));
        }
        match message {
            MavMessage::HEARTBEAT(it) => {
                let status = Status {
                    craft: Craft::of(it)?,
                    mode: it.custom_mode,
                    is_armed: it.base_mode.contains(MavModeFlag::MAV_MODE_FLAG_SAFETY_ARMED),
                    state: it.system_status,
                };
                self.status = Some((now, status));
                return Ok(Some(News::Status(status)));
            }
            MavMessage::LOCAL_POSITION_NED(it) => {
                let is_number = [it.x, it.y, it.z, it.vx, it.vy].iter().all(|it| it.is_finite());
                let is_newer = self.fix.is_none_or(|(_, last)| it.time_boot_ms > last.at_ms);
                if self.fix.is_some_and(|(_, last)| it.time_boot_ms + RESTART_MS < last.at_ms) {
                    return Ok(Some(News::Restart));
                }
                if is_number && is_newer {
                    let velocity = [it.vx, it.vy].map(f64::from);
                    let at = Ned { north: it.x, east: it.y };
                    let fix = Fix { at_ms: it.time_boot_ms, at, down: it.z, velocity };
                    self.fix = Some((now, fix));
                    return Ok(Some(News::Fix(fix)));
                }
            }
            MavMessage::GPS_GLOBAL_ORIGIN(it) => {
                let origin = [it.latitude, it.longitude];
                if let Some(before) = self.origin.replace(origin).filter(|it| *it != origin) {
                    let [north, east] = apart_on_globe(degrees(before), degrees(origin));
                    return Ok(Some(News::Moved(libm::hypot(north, east))));
                }
            }
            MavMessage::ATTITUDE(it) => {
                let is_newer = self.facing.is_none_or(|last| it.time_boot_ms > last.at_ms);
                if it.yaw.is_finite() && is_newer {
                    self.facing = Some(Facing { at_ms: it.time_boot_ms, yaw: it.yaw });
                }
            }
            MavMessage::FENCE_STATUS(it) => {
                self.is_outside = it.breach_status != 0;
                let is_held_back = it.breach_mitigation == FenceMitigate::FENCE_MITIGATE_VEL_LIMIT;
                return Ok(match (self.is_outside, is_held_back) {
                    (true, _) => Some(News::Breach),
                    (false, true) => Some(News::HeldBack),
                    (false, false) => None,
                });
            }
            MavMessage::STATUSTEXT(it)
                if it.severity as u8 <= MavSeverity::MAV_SEVERITY_WARNING as u8 =>
            {
                let text = it.text.to_str().unwrap_or_default().trim().to_owned();
                // Some say the same again and again.
                self.warnings.retain(|(_, other)| *other != text);
                self.warnings.push((now, text));
                if self.warnings.len() > MOST_WARNINGS {
                    self.warnings.remove(0);
                }
            }
            _ => {}
        }
        Ok(None)
    }
}

/// Latitude and longitude of units of 1e-7 degrees.
pub(crate) fn degrees(place: [i32; 2]) -> [f64; 2] {
    place.map(|it| f64::from(it) * 1e-7)
}
