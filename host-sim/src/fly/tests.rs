//! Flights of the ideal vehicle on a link that a test spoils, in the time of both: each message lost, and each failure.

use std::time::Duration;

use anyhow::Result;
use mavlink::MavHeader;
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, FENCE_STATUS_DATA, MavCmd, MavMessage, MavModeFlag, MavResult, MavState,
    MavType, PositionTargetTypemask as Ignored,
};

use crate::fly::control::Control;
use crate::fly::failure::Failure;
use crate::fly::flight::{self, Flight};
use crate::fly::frame::{self, Ned};
use crate::fly::ideal::Ideal;
use crate::fly::label::LabelSource;
use crate::fly::link::Link;
use crate::fly::orders::{AUTOPILOT, Order};
use crate::fly::pilot::Pilot;
use crate::mission::trace;

use spoiled::{
    Flown, LIMITS, SYSTEM, Spoil, as_it_is, circling, fly, fly_mission, fly_with, is_stop, mission,
    moves, of_run,
};

mod by_hand;
mod endings;
mod fronts;
mod habits;
mod live;
mod maps;
mod on_the_way;
mod pymavlink;
mod spoiled;

#[test]
fn an_ideal_vehicle_flies_what_run_flies_and_is_stopped_in_the_end() {
    let flown = fly(as_it_is, as_it_is);
    assert_eq!(flown.failure(), None);
    assert_eq!(flown.trace(), of_run());
    assert!(flown.sent.last().is_some_and(|(_, it)| is_stop(it)));
    // Failsafes of the vehicle wait for a heartbeat a second.
    let beats = flown.sent.iter().filter(|(_, it)| matches!(it, MavMessage::HEARTBEAT(_)));
    let beats: Vec<_> = beats.map(|it| it.0).collect();
    let most = Duration::from_millis(1100);
    assert!(beats.windows(2).all(|pair| pair[1].saturating_sub(pair[0]) <= most), "{beats:?}");
    for (_, message) in &flown.sent {
        match message {
            MavMessage::HEARTBEAT(it) => assert_eq!(it.mavtype, MavType::MAV_TYPE_GCS),
            MavMessage::COMMAND_LONG(it) => {
                assert_eq!(it.command, MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL);
                assert_eq!((it.target_system, it.target_component), (SYSTEM, AUTOPILOT));
            }
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) => {
                assert_eq!((it.target_system, it.target_component), (SYSTEM, AUTOPILOT));
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn each_message_may_be_lost_or_doubled_either_way() {
    let expected = of_run();
    let [there, back] = fly(as_it_is, as_it_is).gone;
    for copies in [0, 2] {
        for lost in 0..there {
            let spoil = |_, number, message| vec![message; if number == lost { copies } else { 1 }];
            assert_eq!(fly(spoil, as_it_is).trace(), expected, "to it, number {lost}, {copies}");
        }
        // Every seventh is enough to hit messages of each kind.
        for lost in (0..back).step_by(7) {
            let spoil = |_, number, message| vec![message; if number == lost { copies } else { 1 }];
            assert_eq!(fly(as_it_is, spoil).trace(), expected, "from it, number {lost}, {copies}");
        }
    }
}

/// Into the flight, while the vehicle drives.
const THEN: Duration = Duration::from_secs(4);

/// The failure and what became of the vehicle.
fn told(flown: &Flown) -> String {
    let Ok(Flight { failure: Some((failure, farewell)), .. }) = &flown.flight else {
        panic!("it failed");
    };
    format!("{failure}; {farewell}")
}

/// After the first stop only stops are sent: for two seconds of the link, or for five to a vehicle that does not say that it is
/// at rest. A vehicle that someone else drives is sent none.
fn ends_at_rest(flown: &Flown) {
    let failure = flown.failure().expect("it failed");
    let (trace, first) = (flown.trace(), flown.sent.iter().position(|it| is_stop(&it.1)));
    assert!(trace.contains("\"reason\":\"broken off\""), "{failure}: {trace}");
    if failure.is_out_of_our_hands() {
        assert_eq!(first, None, "{failure}");
        // Its heartbeat shows that within a second.
        let late =
            flown.sent.iter().filter(|(at, it)| moves(it) && *at > THEN + Duration::from_secs(1));
        assert_eq!(late.count(), 0, "{failure}");
        return;
    }
    let stops = &flown.sent[first.unwrap_or_else(|| panic!("{failure}: no stop"))..];
    assert!(stops.iter().all(|(_, it)| !moves(it)), "{failure}");
    let lasted = stops[stops.len() - 1].0.saturating_sub(stops[0].0);
    let least = match told(flown) {
        // Someone else drives it by then.
        it if it.contains("its mode is now") => 0,
        it if it.contains("does not say") => 4500,
        _ => 1800,
    };
    assert!(lasted >= Duration::from_millis(least), "{failure}: {lasted:?}");
}

/// A vehicle that is not ready is waited for, and is sent nothing that moves.
#[test]
fn nothing_moves_before_the_vehicle_is_ready() {
    type Change = fn(&mut mavlink::dialects::common::HEARTBEAT_DATA);
    let cases: [(&str, Change); 5] = [
        ("expected mode GUIDED, it is in MANUAL", |it| it.custom_mode = 0),
        ("expected its operator to arm it", |it| it.base_mode = MavModeFlag::empty()),
        ("expected a vehicle that is well", |it| it.system_status = MavState::MAV_STATE_CRITICAL),
        ("found MAV_TYPE_QUADROTOR, expected ArduPilot", |it| {
            it.mavtype = MavType::MAV_TYPE_QUADROTOR;
        }),
        ("found MAV_AUTOPILOT_PX4, expected ArduPilot", |it| {
            it.autopilot = mavlink::dialects::common::MavAutopilot::MAV_AUTOPILOT_PX4;
        }),
    ];
    let quiet = |flown: &Flown, expected: &str| {
        let Err(failure) = &flown.flight else { panic!("{expected}: it flew") };
        assert!(failure.to_string().contains(expected), "{expected}: {failure}");
        let setpoints = flown.sent.iter().filter(|(_, it)| moves(it) || is_stop(it));
        assert_eq!(setpoints.count(), 0, "{expected}");
    };
    for (expected, change) in cases {
        let flown = fly(as_it_is, |_, _, mut message| {
            if let MavMessage::HEARTBEAT(it) = &mut message {
                change(it);
            }
            vec![message]
        });
        quiet(&flown, expected);
    }
    let declined = fly(as_it_is, |_, _, message| {
        let command = MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL;
        let ack = COMMAND_ACK_DATA {
            command,
            result: MavResult::MAV_RESULT_UNSUPPORTED,
            ..COMMAND_ACK_DATA::default()
        };
        vec![if matches!(message, MavMessage::COMMAND_ACK(_)) {
            MavMessage::COMMAND_ACK(ack)
        } else {
            message
        }]
    });
    quiet(&declined, "does not send LOCAL_POSITION_NED: MAV_RESULT_UNSUPPORTED");
    let unlabelled = fly(as_it_is, |_, _, message| {
        if matches!(message, MavMessage::NAMED_VALUE_FLOAT(_)) { vec![] } else { vec![message] }
    });
    quiet(&unlabelled, "expected the named value WET");
    let elsewhere = fly(as_it_is, |_, _, mut message| {
        if let MavMessage::LOCAL_POSITION_NED(it) = &mut message {
            it.x -= 30.0;
        }
        vec![message]
    });
    quiet(&elsewhere, "stands where it may not be: its position: found (2, -29)");
}
