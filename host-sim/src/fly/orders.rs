//! What a vehicle is sent. No message arms it or changes its mode.
//!
//! Setpoints are `SET_POSITION_TARGET_LOCAL_NED` in `MAV_FRAME_LOCAL_NED`. `ArduPilot`'s pages on guided mode describe
//! them (<https://ardupilot.org/dev/docs/mavlink-rover-commands.html>). Its sources show what is accepted
//! (`Rover/GCS_MAVLink_Rover.cpp`, `ArduSub/GCS_MAVLink_Sub.cpp`). Rovers, boats and submarines need three forms:
//!
//! - *Go*: position and yaw. Rover ignores the yaw beside a position. Sub faces the yaw, and takes the depth.
//! - *Turn*: yaw alone. Rover then stays and faces this way, which only a vehicle that steers by its two sides can do.
//!   Sub needs a position too, so it is sent to where it is.
//! - *Stop*: velocity and yaw rate, both zero. Velocity alone is not enough: Rover derives a heading from it, and that
//!   of no velocity is north. Neither accepts `MAV_CMD_DO_PAUSE_CONTINUE`, so a stop is a setpoint too. Three seconds
//!   after the last one the vehicle drops the velocity, and holds or loiters.

use std::time::Duration;

use mavlink::dialects::common::{
    COMMAND_LONG_DATA, HEARTBEAT_DATA, MavAutopilot, MavCmd, MavFrame, MavMessage, MavModeFlag,
    MavState, MavType, PositionTargetTypemask as Ignored, SET_POSITION_TARGET_LOCAL_NED_DATA,
};

use crate::fly::autopilot::Craft;
use crate::fly::frame::Ned;

/// The component of a vehicle that is its autopilot.
pub const AUTOPILOT: u8 = 1;

/// Our system id: that of a ground station (`ArduPilot`'s default `MAV_GCS_SYSID`). So the vehicle's failsafe acts if
/// we fall silent.
pub const OWN_SYSTEM: u32 = 255;

/// Our component: `MAV_COMP_ID_MISSIONPLANNER`, as ground stations have it.
pub const OWN_COMPONENT: u8 = 190;

const NO_POSITION: Ignored = Ignored::POSITION_TARGET_TYPEMASK_X_IGNORE
    .union(Ignored::POSITION_TARGET_TYPEMASK_Y_IGNORE)
    .union(Ignored::POSITION_TARGET_TYPEMASK_Z_IGNORE);
const NO_VELOCITY: Ignored = Ignored::POSITION_TARGET_TYPEMASK_VX_IGNORE
    .union(Ignored::POSITION_TARGET_TYPEMASK_VY_IGNORE)
    .union(Ignored::POSITION_TARGET_TYPEMASK_VZ_IGNORE);
const NO_ACCELERATION: Ignored = Ignored::POSITION_TARGET_TYPEMASK_AX_IGNORE
    .union(Ignored::POSITION_TARGET_TYPEMASK_AY_IGNORE)
    .union(Ignored::POSITION_TARGET_TYPEMASK_AZ_IGNORE);
const NO_YAW: Ignored = Ignored::POSITION_TARGET_TYPEMASK_YAW_IGNORE;
const NO_YAW_RATE: Ignored = Ignored::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE;

/// Position and yaw: 0x9F8.
const GO: Ignored = NO_VELOCITY.union(NO_ACCELERATION).union(NO_YAW_RATE);
/// Yaw: 0x9FF.
const TURN: Ignored = GO.union(NO_POSITION);
/// Velocity and yaw rate: 0x5C7.
const STOP: Ignored = NO_POSITION.union(NO_ACCELERATION).union(NO_YAW);

/// Where a motion is to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// The place.
    pub to: Ned,
    /// The yaw there.
    pub yaw: f32,
    /// Whether it is a turn on the spot.
    pub is_turn: bool,
}

/// The receiver of messages, and the time of sending.
#[derive(Clone, Copy, Debug)]
pub struct Envelope {
    /// The vehicle's system id.
    pub system: u8,
    /// The time since we began.
    pub now: Duration,
}

impl Envelope {
    /// The setpoint of an order, for a vehicle at a depth.
    pub fn setpoint(self, order: &Order, craft: Craft, down: f32) -> MavMessage {
        let turns_alone = order.is_turn && craft != Craft::Submarine;
        let Order { to: Ned { north, east }, yaw, .. } = *order;
        self.target(&SET_POSITION_TARGET_LOCAL_NED_DATA {
            x: if turns_alone { 0.0 } else { north },
            y: if turns_alone { 0.0 } else { east },
            z: if turns_alone { 0.0 } else { down },
            yaw,
            type_mask: if turns_alone { TURN } else { GO },
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
        })
    }

    /// The setpoint that stops a vehicle.
    pub fn stop(self) -> MavMessage {
        let type_mask = STOP;
        self.target(&SET_POSITION_TARGET_LOCAL_NED_DATA {
            type_mask,
            ..SET_POSITION_TARGET_LOCAL_NED_DATA::DEFAULT
        })
    }

    fn target(self, what: &SET_POSITION_TARGET_LOCAL_NED_DATA) -> MavMessage {
        MavMessage::SET_POSITION_TARGET_LOCAL_NED(SET_POSITION_TARGET_LOCAL_NED_DATA {
            time_boot_ms: self.now.as_millis() as u32,
            target_system: self.system,
            target_component: AUTOPILOT,
            coordinate_frame: MavFrame::MAV_FRAME_LOCAL_NED,
            ..what.clone()
        })
    }

    /// Asks for a message at an interval, for the `repeats`th time.
    pub fn interval(self, message: u32, interval: Duration, repeats: u8) -> MavMessage {
        MavMessage::COMMAND_LONG(COMMAND_LONG_DATA {
            command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
            target_system: self.system,
            target_component: AUTOPILOT,
            confirmation: repeats,
            param1: message as f32,
            param2: interval.as_micros() as f32,
            ..COMMAND_LONG_DATA::DEFAULT
        })
    }
}

/// Our heartbeat. It goes out once a second, so that the vehicle's own failsafe acts when it stops.
pub fn heartbeat() -> MavMessage {
    MavMessage::HEARTBEAT(HEARTBEAT_DATA {
        mavtype: MavType::MAV_TYPE_GCS,
        autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID,
        base_mode: MavModeFlag::empty(),
        system_status: MavState::MAV_STATE_ACTIVE,
        ..HEARTBEAT_DATA::DEFAULT
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of `ArduPilot`'s pages, but that a velocity comes with its third component.
    #[test]
    fn masks_are_those_of_ardupilot() {
        assert_eq!((GO.bits(), TURN.bits()), (0b1001_1111_1000, 0b1001_1111_1111));
        assert_eq!(STOP.bits(), 0b0101_1100_0111);
    }
}
