//! What was sent, as a table for people.

use std::time::Duration;

use mavlink::Message as _;
use mavlink::dialects::common::{MavMessage, PositionTargetTypemask as Ignored};

use crate::report::table::{Column, Table};

/// A message, and when it was sent.
pub type Sent = (Duration, MavMessage);

/// The table of messages, each with the fields that it uses. Repeated ones share a row, with the time of the first.
pub fn table(sent: &[Sent]) -> String {
    let columns = [
        Column::right("s", 8),
        Column::right("times", 5),
        Column::left("message", 29).apart(),
        Column::left("fields", 0),
    ];
    let mut rows: Vec<(Duration, usize, &'static str, String)> = Vec::new();
    for (at, message) in sent {
        let (name, fields) = (message.message_name(), fields(message));
        // Heartbeats come all the time, between others. Other equal messages follow each other.
        let is_same = |row: &&mut (Duration, usize, &str, String)| row.2 == name && row.3 == fields;
        let heartbeat = matches!(message, MavMessage::HEARTBEAT(_));
        let last = rows.len().saturating_sub(1);
        let same = if heartbeat {
            rows.iter_mut().find(is_same)
        } else {
            rows[last..].iter_mut().find(is_same)
        };
        match same {
            Some(row) => row.1 += 1,
            None => rows.push((*at, 1, name, fields)),
        }
    }
    let mut table = Table::new(columns);
    for (at, times, name, fields) in rows {
        table.row([format!("{:.2}", at.as_secs_f64()), times.to_string(), name.to_owned(), fields]);
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
