//! Flights of the ideal vehicle on a link that a test spoils, in the time of both: each message lost, and each failure.

use std::time::Duration;

use anyhow::Result;
use mavlink::MavHeader;
use mavlink::dialects::common::{
    COMMAND_ACK_DATA, FENCE_STATUS_DATA, MavCmd, MavMessage, MavModeFlag, MavResult, MavState,
    MavType, PositionTargetTypemask as Ignored,
};

use crate::fly::failure::Failure;
use crate::fly::flight::{self, Control, Flight};
use crate::fly::frame::Ned;
use crate::fly::ideal::Ideal;
use crate::fly::label::LabelSource;
use crate::fly::link::Link;
use crate::fly::orders::{AUTOPILOT, Order};
use crate::fly::pilot::Pilot;
use crate::report::trace;

use spoiled::{
    Flown, LIMITS, SYSTEM, Spoil, as_it_is, circling, fly, fly_mission, fly_with, is_stop, mission,
    moves, of_run,
};

mod endings;
mod fronts;
mod habits;
mod on_the_way;
mod spoiled;

#[test]
fn an_ideal_vehicle_flies_what_run_flies_and_is_stopped_in_the_end() {
    let flown = fly(as_it_is, as_it_is);
    assert_eq!(flown.failure(), None);
    assert_eq!(flown.trace(), of_run());
    assert!(flown.sent.last().is_some_and(|(_, it)| is_stop(it)));
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

/// Its clock goes back by a quarter of an hour then.
#[test]
fn a_vehicle_may_be_started_anew_before_the_flight() {
    const EARLIER: u32 = 1_000_000;
    let second = Duration::from_secs(1);
    let flown = fly(as_it_is, |now, _, mut message| {
        if now > 9 * second {
            return vec![message];
        }
        match &mut message {
            _ if now > 2 * second => return vec![],
            // Without its labels it is not ready.
            MavMessage::NAMED_VALUE_FLOAT(_) => return vec![],
            MavMessage::LOCAL_POSITION_NED(it) => it.time_boot_ms += EARLIER,
            MavMessage::ATTITUDE(it) => it.time_boot_ms += EARLIER,
            _ => {}
        }
        vec![message]
    });
    assert_eq!(flown.trace(), of_run());
}

/// A late label belongs to an earlier place, so the vehicle's own time rules it out. Labels from the way are wrong
/// here, so the trace would show one that counts.
#[test]
fn a_label_from_before_does_not_count() {
    let (mut under_way, mut is_moving) = (Vec::new(), false);
    let flown = fly(as_it_is, |_, _, mut message| {
        match &mut message {
            MavMessage::LOCAL_POSITION_NED(it) => is_moving = (it.vx, it.vy) != (0.0, 0.0),
            MavMessage::NAMED_VALUE_FLOAT(it) => {
                if is_moving {
                    it.value = -it.value;
                }
                under_way.push(message);
                return if under_way.len() > 20 { vec![under_way.remove(0)] } else { vec![] };
            }
            _ => {}
        }
        vec![message]
    });
    assert_eq!(flown.trace(), of_run());
}

/// A vehicle that circles its target has not arrived. One that does not say that it rests has not stopped.
#[test]
fn a_vehicle_that_never_rests_does_not_arrive_and_is_told_to_stop_for_long() {
    let flown = fly(as_it_is, |now, _, message| vec![circling(now, message, 1.0)]);
    assert!(matches!(flown.failure(), Some(Failure::Late(..))), "{:?}", flown.failure());
    let stops = flown.sent.iter().filter(|(_, it)| is_stop(it));
    let times: Vec<_> = stops.map(|(at, _)| at.as_secs_f64()).collect();
    assert!(times[times.len() - 1] - times[0] > 4.5, "{times:?}");
}

/// A heartbeat has no time of its own: one from before the vehicle was armed is waited for.
#[test]
fn a_heartbeat_from_before_it_was_armed_is_no_failure() {
    let mut late = None;
    let flown = fly(as_it_is, |now, _, message| {
        let mut messages = vec![message];
        if let MavMessage::HEARTBEAT(it) = &mut messages[0]
            && now < Duration::from_secs(2)
        {
            it.base_mode = MavModeFlag::empty();
            late = Some(messages[0].clone());
        }
        // Heard once more when it was armed for half a second.
        if now > Duration::from_millis(2600) {
            messages.extend(late.take());
        }
        messages
    });
    assert_eq!(flown.trace(), of_run());
    assert_eq!(flown.failure(), None);
}

/// Into the flight, while the vehicle drives.
const THEN: Duration = Duration::from_secs(4);

/// For each failure: the text that names it, and what the vehicle sends from `THEN` on.
#[test]
fn each_failure_ends_with_stops_alone() {
    type Change = fn(MavMessage) -> Vec<MavMessage>;
    fn beat(
        message: MavMessage,
        change: impl FnOnce(&mut mavlink::dialects::common::HEARTBEAT_DATA),
    ) -> Vec<MavMessage> {
        let MavMessage::HEARTBEAT(mut it) = message else { return vec![message] };
        change(&mut it);
        vec![MavMessage::HEARTBEAT(it)]
    }
    let cases: [(&str, Change); 8] = [
        ("the mode is HOLD, no longer GUIDED: its failsafe or its operator", |it| {
            beat(it, |beat| beat.custom_mode = 4)
        }),
        ("the vehicle was disarmed", |it| beat(it, |beat| beat.base_mode = MavModeFlag::empty())),
        ("failsafe has acted: system status MAV_STATE_EMERGENCY", |it| {
            beat(it, |beat| beat.system_status = MavState::MAV_STATE_EMERGENCY)
        }),
        ("has left its geofence", |it| {
            let breach = FENCE_STATUS_DATA { breach_status: 1, ..FENCE_STATUS_DATA::default() };
            vec![it, MavMessage::FENCE_STATUS(breach)]
        }),
        ("no heartbeat for 5 s", |it| {
            if matches!(it, MavMessage::HEARTBEAT(_)) { vec![] } else { vec![it] }
        }),
        ("no position for 2 s", |it| {
            if matches!(it, MavMessage::LOCAL_POSITION_NED(_)) { vec![] } else { vec![it] }
        }),
        ("no label within 5 s", |it| {
            if matches!(it, MavMessage::NAMED_VALUE_FLOAT(_)) { vec![] } else { vec![it] }
        }),
        ("slid by 5.0 m that its speed does not explain", |it| match it {
            MavMessage::LOCAL_POSITION_NED(mut it) => {
                it.x += 5.0;
                vec![MavMessage::LOCAL_POSITION_NED(it)]
            }
            it => vec![it],
        }),
    ];
    for (expected, change) in cases {
        let flown = fly(
            as_it_is,
            |now, _, message| {
                if now < THEN { vec![message] } else { change(message) }
            },
        );
        let failure = flown.failure().expect("it failed").to_string();
        assert!(failure.contains(expected), "{expected}: {failure}");
        ends_at_rest(&flown);
    }
}

/// After the first stop only stops are sent. A vehicle that someone else drives is sent none.
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
    assert!(lasted >= Duration::from_millis(1800), "{failure}: {lasted:?}");
}

#[test]
fn a_signal_stops_the_vehicle_and_a_broken_link_ends_at_once() {
    use std::sync::atomic::{AtomicBool, Ordering};
    static ASKED: AtomicBool = AtomicBool::new(false);
    let back: Spoil = Box::new(|now, _, message| {
        ASKED.fetch_or(now >= THEN, Ordering::Relaxed);
        vec![message]
    });
    let asked = || ASKED.load(Ordering::Relaxed).then_some(2);
    let flown = fly_with(Box::new(as_it_is), back, None, asked);
    assert_eq!(flown.failure(), Some(&Failure::Interrupted(2)));
    ends_at_rest(&flown);
    let flown = fly_with(Box::new(as_it_is), Box::new(as_it_is), Some(THEN), || None);
    assert_eq!(flown.failure(), Some(&Failure::Broken("gone".to_owned())));
    ends_at_rest(&flown);
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
