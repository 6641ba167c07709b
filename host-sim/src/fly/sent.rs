//! What was sent, as a table for people.

use std::time::Duration;

use mavlink::Message as _;
use mavlink::dialects::common::{MavMessage, PositionTargetTypemask as Ignored};

use crate::report::table::{Column, Table};

/// A message, and when it was sent.
pub type Sent = (Duration, MavMessage);

/// The table of messages, each with the fields that it uses.
pub fn table(sent: &[Sent]) -> String {
    let columns =
        [Column::right("s", 8), Column::left("message", 29).apart(), Column::left("fields", 0)];
    let mut table = Table::new(columns);
    for (at, message) in sent {
        let at = format!("{:.2}", at.as_secs_f64());
        table.row([at, message.message_name().to_owned(), fields(message)]);
    }
    table.to_string()
}

fn fields(message: &MavMessage) -> String {
    match message {
        MavMessage::HEARTBEAT(it) => format!("{:?} {:?}", it.mavtype, it.system_status),
        MavMessage::COMMAND_LONG(it) => format!(
            "{:?} message {} interval {} us, confirmation {}",
            it.command, it.param1, it.param2, it.confirmation
        ),
        MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) => {
            let mut text = format!("{:?} mask 0x{:03X}", it.coordinate_frame, it.type_mask.bits());
            for (ignored, values) in [
                (
                    Ignored::POSITION_TARGET_TYPEMASK_X_IGNORE,
                    format!(" x {} y {} z {}", it.x, it.y, it.z),
                ),
                (
                    Ignored::POSITION_TARGET_TYPEMASK_VX_IGNORE,
                    format!(" vx {} vy {} vz {}", it.vx, it.vy, it.vz),
                ),
                (Ignored::POSITION_TARGET_TYPEMASK_YAW_IGNORE, format!(" yaw {}", it.yaw)),
                (
                    Ignored::POSITION_TARGET_TYPEMASK_YAW_RATE_IGNORE,
                    format!(" yaw_rate {}", it.yaw_rate),
                ),
            ] {
                if !it.type_mask.contains(ignored) {
                    text.push_str(&values);
                }
            }
            text
        }
        other => format!("{other:?}"),
    }
}
