//! What ends a flight: the reason that is told, what became of the vehicle, and how soon it is stopped.

use mavlink::dialects::common::{
    FenceMitigate, HEARTBEAT_DATA, MavMessage, MavSeverity, NAMED_VALUE_FLOAT_DATA, STATUSTEXT_DATA,
};

use super::*;

/// What the vehicle sends from [`THEN`] on.
fn then(
    mut change: impl FnMut(Duration, MavMessage) -> Vec<MavMessage> + 'static,
) -> Spoil<'static> {
    Box::new(move |now, _, message| if now < THEN { vec![message] } else { change(now, message) })
}

/// Heartbeats that are changed from then on, and a text after the first of them.
fn beats(says: &'static str, change: fn(&mut HEARTBEAT_DATA)) -> Spoil<'static> {
    let (mut is_changed, mut is_told) = (false, says.is_empty());
    then(move |_, mut message| {
        if let MavMessage::HEARTBEAT(it) = &mut message {
            change(it);
            is_changed = true;
        } else if is_changed && !is_told {
            is_told = true;
            let severity = MavSeverity::MAV_SEVERITY_CRITICAL;
            let text =
                STATUSTEXT_DATA { severity, text: says.into(), ..STATUSTEXT_DATA::default() };
            return vec![message, MavMessage::STATUSTEXT(text)];
        }
        vec![message]
    })
}

/// The vehicle no longer sends a message.
fn without(is_it: fn(&MavMessage) -> bool) -> Spoil<'static> {
    then(move |_, message| if is_it(&message) { vec![] } else { vec![message] })
}

/// A state of the geofence, told with each message.
fn fence(breach_status: u8, breach_mitigation: FenceMitigate) -> MavMessage {
    let fence =
        FENCE_STATUS_DATA { breach_status, breach_mitigation, ..FENCE_STATUS_DATA::default() };
    MavMessage::FENCE_STATUS(fence)
}

/// Positions that move to the north by so many metres in so many seconds, without the vehicle.
fn slides(metres: f32, seconds: f32) -> Spoil<'static> {
    then(move |now, mut message| {
        if let MavMessage::LOCAL_POSITION_NED(it) = &mut message {
            it.x += metres * (now.saturating_sub(THEN).as_secs_f32() / seconds).min(1.0);
        }
        vec![message]
    })
}

/// The clock of the vehicle goes back by a minute.
fn goes_back(now: Duration, _: usize, mut message: MavMessage) -> Vec<MavMessage> {
    let earlier = if now < THEN { 60_000 } else { 0 };
    match &mut message {
        MavMessage::LOCAL_POSITION_NED(it) => it.time_boot_ms += earlier,
        MavMessage::ATTITUDE(it) => it.time_boot_ms += earlier,
        MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA { time_boot_ms, .. }) => {
            *time_boot_ms += 60_000;
        }
        _ => {}
    }
    vec![message]
}

/// It leaves its geofence for a moment, and its fence has it drive home.
fn drives_home() -> Spoil<'static> {
    then(|now, mut message| {
        let since = now.saturating_sub(THEN);
        match &mut message {
            MavMessage::HEARTBEAT(it) if since >= Duration::from_millis(500) => it.custom_mode = 11,
            _ if since < Duration::from_millis(300) => {
                return vec![message, fence(1, FenceMitigate::default())];
            }
            _ => {}
        }
        vec![message]
    })
}

/// What the vehicle sends; what is told; and the seconds of the link after which it is stopped, or after which it is sent
/// nothing more.
#[test]
fn each_failure_is_told_and_ends_with_stops_alone() {
    const RESTS: &str = "it was told to stop, and says that it is at rest";
    const UNKNOWN: &str = "it was told to stop, and does not say that it is at rest";
    const NOTHING: &str = "nothing more was sent to it";
    let cases = [
        (
            beats("", |it| it.custom_mode = 4),
            format!("the mode is HOLD, no longer GUIDED: its failsafe or its operator; {NOTHING}"),
            0.0..1.2,
        ),
        (
            // Mode and status come in one heartbeat, and why a moment later.
            beats("EKF failsafe", |it| {
                (it.custom_mode, it.system_status) = (4, MavState::MAV_STATE_CRITICAL);
            }),
            format!(
                "the mode is HOLD, no longer GUIDED: its failsafe or its operator; {NOTHING}; it said \"EKF failsafe\""
            ),
            0.0..1.2,
        ),
        (
            beats("Disarmed by landing", |it| it.base_mode = MavModeFlag::empty()),
            format!("the vehicle was disarmed; {RESTS}; it said \"Disarmed by landing\""),
            0.0..1.2,
        ),
        (
            beats("", |it| it.system_status = MavState::MAV_STATE_EMERGENCY),
            format!("the vehicle's failsafe has acted: system status MAV_STATE_EMERGENCY; {RESTS}"),
            0.0..1.2,
        ),
        (
            beats("ArduRover", |it| it.custom_mode = 16),
            format!(
                "the autopilot was started anew; {NOTHING}; its mode is now INITIALISING; it said \"ArduRover\""
            ),
            0.0..1.2,
        ),
        (
            // Its clock says so before its heartbeat does.
            Box::new(goes_back),
            format!("the autopilot was started anew; {NOTHING}"),
            0.0..0.2,
        ),
        (
            then(|_, it| vec![it, fence(1, FenceMitigate::default())]),
            format!("the vehicle has left its geofence; {RESTS}"),
            0.0..0.2,
        ),
        (
            // A vehicle that avoids its fence stops short of it, and would be late for its target.
            then(|_, it| vec![it, fence(0, FenceMitigate::FENCE_MITIGATE_VEL_LIMIT)]),
            format!("{}; {RESTS}", Failure::HeldBack),
            0.0..0.2,
        ),
        (
            // Its last mode is told.
            drives_home(),
            format!("the vehicle has left its geofence; {UNKNOWN}; its mode is now RTL"),
            0.0..0.2,
        ),
        (
            without(|it| matches!(it, MavMessage::HEARTBEAT(_))),
            format!("no heartbeat for 5 s; {RESTS}"),
            4.0..4.3,
        ),
        (
            without(|it| matches!(it, MavMessage::LOCAL_POSITION_NED(_))),
            format!("no position for 2 s; {UNKNOWN}"),
            1.8..2.1,
        ),
        (
            without(|it| matches!(it, MavMessage::NAMED_VALUE_FLOAT(_))),
            format!("no label within 5 s (--label-time): the named value WET; {RESTS}"),
            5.0..9.0,
        ),
        (slides(6.0, 0.0), format!("{}; {RESTS}", Failure::Slid(6.0)), 0.0..0.2),
        // It is found after the first metre of 3.3.
        (slides(3.3, 2.0), format!("{}; {RESTS}", Failure::Slid(0.5)), 0.0..1.0),
    ];
    for (back, expected, after) in cases {
        let flown = fly_with(Box::new(as_it_is), back, None, || None);
        assert_eq!(told(&flown), expected);
        ends_at_rest(&flown);
        let is_left = flown.failure().is_some_and(Failure::is_out_of_our_hands);
        let stop = flown.sent.iter().find(|it| is_stop(&it.1)).or(flown.sent.last());
        let since = stop.expect("it was sent something").0.as_secs_f64() - THEN.as_secs_f64();
        assert!(is_left && since < after.end || after.contains(&since), "{expected}: {since} s");
    }
}

#[test]
fn a_signal_stops_the_vehicle_and_a_broken_link_ends_at_once() {
    use std::sync::atomic::{AtomicBool, Ordering};
    static ASKED: AtomicBool = AtomicBool::new(false);
    let back: Spoil<'_> = Box::new(|now, _, message| {
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
