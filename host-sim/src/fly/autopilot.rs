//! Which autopilots are known, and which of their modes takes setpoints.
//!
//! `ArduPilot` alone: its rovers and boats (mode 15) and submarines (mode 4) drive to a local position in guided mode.
//! PX4 takes setpoints in offboard mode, which wants a stream of them before and has rules of its own: it is refused.

use mavlink::dialects::common::{HEARTBEAT_DATA, MavAutopilot, MavType};

use crate::fly::failure::Failure;

/// What kind of vehicle it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Craft {
    /// `ArduPilot` Rover.
    Rover,
    /// `ArduPilot` Rover, of a boat.
    Boat,
    /// `ArduPilot` Sub.
    Submarine,
}

/// Modes of Rover by their numbers (`Rover/mode.h`).
const ROVER: [(u32, &str); 14] = [
    (0, "MANUAL"),
    (1, "ACRO"),
    (3, "STEERING"),
    (4, "HOLD"),
    (5, "LOITER"),
    (6, "FOLLOW"),
    (7, "SIMPLE"),
    (8, "DOCK"),
    (9, "CIRCLE"),
    (10, "AUTO"),
    (11, "RTL"),
    (12, "SMART_RTL"),
    (15, "GUIDED"),
    (16, "INITIALISING"),
];

/// Modes of Sub by their numbers (`ArduSub/mode.h`).
const SUB: [(u32, &str); 12] = [
    (0, "STABILIZE"),
    (1, "ACRO"),
    (2, "ALT_HOLD"),
    (3, "AUTO"),
    (4, "GUIDED"),
    (7, "CIRCLE"),
    (9, "SURFACE"),
    (16, "POSHOLD"),
    (19, "MANUAL"),
    (20, "MOTOR_DETECT"),
    (21, "SURFTRAK"),
    (22, "RTL"),
];

impl Craft {
    /// The kind of vehicle that sends this heartbeat.
    ///
    /// # Errors
    /// Names another autopilot, or another kind of vehicle.
    pub fn of(heartbeat: &HEARTBEAT_DATA) -> Result<Self, Failure> {
        let found = match heartbeat.autopilot {
            MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA => match heartbeat.mavtype {
                MavType::MAV_TYPE_GROUND_ROVER => return Ok(Self::Rover),
                MavType::MAV_TYPE_SURFACE_BOAT => return Ok(Self::Boat),
                MavType::MAV_TYPE_SUBMARINE => return Ok(Self::Submarine),
                other => format!("{other:?}"),
            },
            other => format!("{other:?}"),
        };
        Err(Failure::NotOurs(found))
    }

    /// The number of its guided mode.
    pub const fn guided(self) -> u32 {
        match self {
            Self::Rover | Self::Boat => 15,
            Self::Submarine => 4,
        }
    }

    /// Whether this mode says that its autopilot is still starting.
    pub const fn is_initialising(self, mode: u32) -> bool {
        !matches!(self, Self::Submarine) && mode == 16
    }

    /// What it calls a mode.
    pub fn mode(self, number: u32) -> String {
        let modes: &[(u32, &str)] = if self == Self::Submarine { &SUB } else { &ROVER };
        let known = modes.iter().find(|(it, _)| *it == number);
        known.map_or_else(|| format!("mode {number}"), |(_, name)| (*name).to_owned())
    }
}
