//! The message at the end of a flight: what the vehicle said a moment after, who drives it then, and its last mode.

use mavlink::dialects::common::{
    FenceMitigate, HEARTBEAT_DATA, MavMessage, MavSeverity, STATUSTEXT_DATA,
};

use super::*;

fn text(text: &str) -> MavMessage {
    let severity = MavSeverity::MAV_SEVERITY_CRITICAL;
    MavMessage::STATUSTEXT(STATUSTEXT_DATA {
        severity,
        text: text.into(),
        ..STATUSTEXT_DATA::default()
    })
}

/// A flight whose vehicle changes its heartbeats from then on, and says something after the first of them.
fn changed(says: &str, change: impl Fn(&mut HEARTBEAT_DATA, Duration)) -> Flown {
    let mut is_told = None;
    fly(as_it_is, |now, _, mut message| {
        if let MavMessage::HEARTBEAT(it) = &mut message
            && now >= THEN
        {
            change(it, now);
            is_told.get_or_insert(false);
        } else if is_told == Some(false) {
            is_told = Some(true);
            return vec![message, text(says)];
        }
        vec![message]
    })
}

/// The failure and what became of the vehicle.
fn told(flown: &Flown) -> String {
    let Ok(Flight { failure: Some((failure, farewell)), .. }) = &flown.flight else {
        panic!("it failed");
    };
    format!("{failure}; {farewell}")
}

/// Mode and status come in one heartbeat, and why a moment later.
#[test]
fn a_failsafe_is_told_by_what_the_vehicle_says_after_it() {
    let flown = changed("EKF failsafe", |it, _| {
        (it.custom_mode, it.system_status) = (4, MavState::MAV_STATE_CRITICAL);
    });
    assert_eq!(
        told(&flown),
        "the mode is HOLD, no longer GUIDED: its failsafe or its operator; nothing more was sent to it; it \
         said \"EKF failsafe\""
    );
    // It is listened to for a second, and sent nothing: no heartbeat either.
    let last = flown.sent.last().expect("it flew").0;
    assert!(last < THEN + Duration::from_millis(1200), "{last:?}");
}

#[test]
fn a_disarmed_vehicle_says_why() {
    let flown = changed("Disarmed by landing", |it, _| it.base_mode = MavModeFlag::empty());
    assert_eq!(
        told(&flown),
        "the vehicle was disarmed; it was told to stop, and says that it is at rest; it said \"Disarmed by \
         landing\""
    );
}

#[test]
fn an_autopilot_that_was_started_anew_is_told_as_that() {
    let expected = "the autopilot was started anew; nothing more was sent to it";
    let initialising = changed("ArduRover", |it, _| it.custom_mode = 16);
    assert!(told(&initialising).starts_with(expected), "{}", told(&initialising));
    // Its clock says so before its heartbeat does.
    let flown = fly(as_it_is, |now, _, mut message| {
        if let MavMessage::LOCAL_POSITION_NED(it) = &mut message {
            it.time_boot_ms += if now < THEN { 60_000 } else { 0 };
        }
        if let MavMessage::ATTITUDE(it) = &mut message {
            it.time_boot_ms += if now < THEN { 60_000 } else { 0 };
        }
        if let MavMessage::NAMED_VALUE_FLOAT(it) = &mut message {
            it.time_boot_ms += 60_000;
        }
        vec![message]
    });
    assert_eq!(told(&flown), expected);
}

/// A vehicle that avoids its fence stops short of it, and would be late for its target.
#[test]
fn a_fence_that_holds_a_vehicle_back_ends_the_flight_at_once() {
    let mut since = None;
    let flown = fly(as_it_is, |now, _, message| {
        if now < THEN {
            return vec![message];
        }
        since.get_or_insert(now);
        let breach_mitigation = FenceMitigate::FENCE_MITIGATE_VEL_LIMIT;
        let held = FENCE_STATUS_DATA { breach_mitigation, ..FENCE_STATUS_DATA::default() };
        vec![message, MavMessage::FENCE_STATUS(held)]
    });
    assert_eq!(flown.failure(), Some(&Failure::HeldBack));
    let first = flown.sent.iter().find(|it| is_stop(&it.1)).expect("it is stopped").0;
    assert!(first < since.expect("it failed") + Duration::from_millis(500), "{first:?}");
}

/// A breach may have the vehicle drive home: its last mode says so.
#[test]
fn the_mode_in_which_a_vehicle_is_left_is_told() {
    let rtl = THEN + Duration::from_millis(500);
    let flown = fly(as_it_is, |now, _, mut message| {
        if let MavMessage::HEARTBEAT(it) = &mut message
            && now >= rtl
        {
            it.custom_mode = 11;
        }
        let breach = FENCE_STATUS_DATA { breach_status: 1, ..FENCE_STATUS_DATA::default() };
        if now >= THEN && now < THEN + Duration::from_millis(300) {
            return vec![message, MavMessage::FENCE_STATUS(breach)];
        }
        vec![message]
    });
    assert_eq!(
        told(&flown),
        "the vehicle has left its geofence; it was told to stop, and does not say that it is at rest; its \
         mode is now RTL"
    );
}
