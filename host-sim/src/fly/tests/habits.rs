//! Habits of autopilots and links that the ideal vehicle does not have, as seen in `ArduPilot`'s own simulation.

use std::collections::VecDeque;
use std::ops::{Range, RangeInclusive};

use mavlink::dialects::common::MavMessage;

use super::*;

/// How a flight ends.
enum End {
    /// With the trace of `run`.
    AsRun,
    /// With motions that end so far from their targets, metres.
    Off(Range<f64>),
    /// With a failure that is told so.
    Fails(&'static str),
}

/// What becomes of messages to the vehicle and from it.
type Spoils = (Spoil<'static>, Spoil<'static>);

fn to_it(change: impl FnMut(Duration, usize, MavMessage) -> Vec<MavMessage> + 'static) -> Spoils {
    (Box::new(change), Box::new(as_it_is))
}

fn from_it(change: impl FnMut(Duration, usize, MavMessage) -> Vec<MavMessage> + 'static) -> Spoils {
    (Box::new(as_it_is), Box::new(change))
}

/// A setpoint whose place is moved by `by` metres towards the area's middle (10, 10).
fn nearer_the_middle(message: MavMessage, by: f32) -> MavMessage {
    let MavMessage::SET_POSITION_TARGET_LOCAL_NED(mut it) = message else { return message };
    if !it.type_mask.contains(Ignored::POSITION_TARGET_TYPEMASK_X_IGNORE) {
        let (north, east) = (10.0 - it.x, 10.0 - it.y);
        let part = by / north.hypot(east);
        (it.x, it.y) = (it.x + part * north, it.y + part * east);
    }
    MavMessage::SET_POSITION_TARGET_LOCAL_NED(it)
}

/// Loses the first setpoints.
fn loses(most: usize) -> Spoils {
    let mut lost = 0;
    to_it(move |_, _, message| {
        let is_lost = moves(&message) && lost < most;
        lost += usize::from(is_lost);
        if is_lost { vec![] } else { vec![message] }
    })
}

/// Its speed over ground is not exact, though its place is.
fn sways() -> Spoils {
    let mut number = 0_u8;
    from_it(move |_, _, mut message| {
        if let MavMessage::LOCAL_POSITION_NED(it) = &mut message {
            number = (number + 1) % 4;
            it.vx += if number < 2 { 0.3 } else { -0.3 };
        }
        vec![message]
    })
}

/// It is started anew before the flight: its clock goes back by a quarter of an hour.
fn starts_anew() -> Spoils {
    const EARLIER: u32 = 1_000_000;
    let second = Duration::from_secs(1);
    from_it(move |now, _, mut message| {
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
    })
}

/// Labels come two seconds late. Those from the way are wrong here, so the trace would show one that counts: the vehicle's
/// own time rules it out.
fn labels_late() -> Spoils {
    let (mut under_way, mut is_moving) = (Vec::new(), false);
    from_it(move |_, _, mut message| {
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
    })
}

/// A heartbeat from before it was armed is heard once more when it was armed for half a second. A heartbeat has no time of
/// its own.
fn heartbeat_late() -> Spoils {
    let mut late = None;
    from_it(move |now, _, message| {
        let mut messages = vec![message];
        if let MavMessage::HEARTBEAT(it) = &mut messages[0]
            && now < Duration::from_secs(2)
        {
            it.base_mode = MavModeFlag::empty();
            late = Some(messages[0].clone());
        }
        if now > Duration::from_millis(2600) {
            messages.extend(late.take());
        }
        messages
    })
}

/// Its targets are moved out of the area, by 0.2 m to the south.
fn southward(_: Duration, _: usize, mut message: MavMessage) -> Vec<MavMessage> {
    if let MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) = &mut message {
        it.x = it.x.min(-0.2);
    }
    vec![message]
}

/// Each habit, how a flight with it ends, and how many setpoints reach the vehicle in four steps. Each setpoint begins a
/// leg anew, and its S-curve with it: a vehicle that moves is left alone for ten seconds.
#[test]
fn each_habit_ends_as_it_should() {
    let near: fn() -> Spoil<'static> = || Box::new(|_, _, it| vec![nearer_the_middle(it, 0.7)]);
    let circles = |radius: f32| -> Spoil<'static> {
        Box::new(move |now, _, it| vec![circling(now, it, radius)])
    };
    let cases: [(&str, Spoils, End, RangeInclusive<usize>); 12] = [
        ("none", to_it(as_it_is), End::AsRun, 4..=4),
        // One that is lost is sent again, as the vehicle does not stir.
        ("three setpoints lost", loses(3), End::AsRun, 4..=4),
        ("started anew", starts_anew(), End::AsRun, 4..=4),
        ("late labels", labels_late(), End::AsRun, 4..=4),
        ("a late heartbeat", heartbeat_late(), End::AsRun, 4..=4),
        // In a current or in waves a vehicle holds its place, but is never at rest.
        ("sways", sways(), End::AsRun, 4..=4),
        ("wobbles", (Box::new(as_it_is), circles(0.01)), End::Off(0.0..0.02), 4..=8),
        // What steers like a car rests beside where it was sent. Sent there again, it would drive a circle each time.
        ("rests near", (near(), Box::new(as_it_is)), End::Off(0.69..0.71), 4..=4),
        ("stays near", (near(), circles(0.2)), End::Off(0.45..0.95), 4..=8),
        ("leaves the area", to_it(southward), End::Fails("stands where it may not be"), 1..=1),
        // However near its target is, what does not move at all has not arrived.
        ("is stuck", loses(usize::MAX), End::Fails("not there within 20 s"), 0..=0),
        // Nor has what circles its target. It is sent there again after ten seconds.
        ("circles", (Box::new(as_it_is), circles(1.0)), End::Fails("not there within 20 s"), 2..=2),
    ];
    for (name, (there, back), end, goes) in cases {
        let flown = fly_with(there, back, None, || None);
        let sent = flown.sent.iter().filter(|(_, it)| moves(it)).count();
        assert!(goes.contains(&sent), "{name}: {sent} setpoints");
        if let End::Fails(why) = end {
            assert!(told(&flown).contains(why), "{name}: {}", told(&flown));
            ends_at_rest(&flown);
            continue;
        }
        assert_eq!(flown.failure(), None, "{name}");
        let (Ok(flight), is_as_run) = (&flown.flight, flown.trace() == of_run()) else { continue };
        let legs = flight.recording.results.steps.iter().filter_map(|it| it.flown);
        let off: Vec<_> = legs.map(|it| it.off).collect();
        match end {
            End::Off(range) => {
                assert!(
                    off.len() == 4 && off.iter().all(|it| range.contains(it)),
                    "{name}: {off:?}"
                );
            }
            _ => assert!(is_as_run, "{name}"),
        }
    }
}

/// One that rests beyond the acceptance, 0.02 m, is waited for five seconds of its clock. It may yet come nearer.
#[test]
fn a_vehicle_that_rests_beyond_the_acceptance_is_given_time() {
    for (off, is_waited_for) in [(0.01, false), (0.03, true)] {
        let flown = fly(move |_, _, message| vec![nearer_the_middle(message, off)], as_it_is);
        let Ok(flight) = &flown.flight else { panic!("it flew") };
        let mut legs = flight.recording.results.steps.iter().filter_map(|step| step.flown);
        assert!(legs.all(|leg| (leg.ended - leg.began > 5.0) == is_waited_for), "{off}");
    }
}

/// The trace tells where a vehicle came to rest, with times, and what would cover it.
#[test]
fn the_trace_tells_how_near_a_vehicle_came() {
    let flown = fly(|_, _, message| vec![nearer_the_middle(message, 0.7)], as_it_is);
    assert_ne!(flown.trace(), of_run());
    let Ok(flight) = &flown.flight else { panic!("it flew") };
    for step in &flight.recording.steps {
        let off = Ned::from(step.pose.site).distance(step.motion.target.site.into());
        assert!((off - 0.7).abs() < 0.01, "{off}");
    }
    let steps = &flight.recording.results.steps;
    let legs: Vec<_> = steps.iter().filter_map(|step| step.flown).collect();
    assert!(legs.iter().all(|leg| leg.ended > leg.began + 5.0));
    assert!(legs.windows(2).all(|pair| pair[0].ended <= pair[1].began));
    let told = flight.recording.results.end.flown.expect("it flew");
    assert_eq!((told.motions, told.off_most <= told.tolerance), (4, true), "{told:?}");
    assert!(told.tolerance < 0.85, "{told:?}");
    let line = trace::step(&steps[0]);
    assert!(line.contains(",\"flown\":{\"began\":0.0,\"ended\":"), "{line}");
}

/// Velocities of zero do not stop Sub, which coasts on: a place does, the one where stopping began.
#[test]
fn a_submarine_is_stopped_by_a_place() {
    let mut at = (0.0, 0.0);
    let mut there = None;
    let flown = fly(as_it_is, |now, _, mut message| {
        match &mut message {
            MavMessage::HEARTBEAT(it) => {
                (it.mavtype, it.custom_mode) = (MavType::MAV_TYPE_SUBMARINE, 4);
                if now >= THEN {
                    it.system_status = MavState::MAV_STATE_CRITICAL;
                    there.get_or_insert(at);
                }
            }
            MavMessage::LOCAL_POSITION_NED(it) => at = (it.x, it.y),
            _ => {}
        }
        vec![message]
    });
    assert!(matches!(flown.failure(), Some(Failure::Failsafe(_))), "{:?}", flown.failure());
    let there = there.expect("it failed");
    let since = flown.sent.iter().position(|(_, it)| {
        matches!(it, MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) if (it.x, it.y) == there)
    });
    let stops: Vec<_> = flown.sent[since.expect("it is told where to stay")..]
        .iter()
        .filter(|(_, it)| !matches!(it, MavMessage::HEARTBEAT(_)))
        .collect();
    let is_hold = |it: &MavMessage| {
        matches!(it, MavMessage::SET_POSITION_TARGET_LOCAL_NED(it)
            if (it.x, it.y) == there && it.type_mask.bits() == 0x9F8)
    };
    assert!(stops.iter().all(|(_, it)| is_hold(it)), "{stops:?}");
    assert!(stops.len() >= 3, "{stops:?}");
    assert!(!flown.sent.iter().any(|(_, it)| is_stop(it)));
}

/// A rover that steers like a car cannot turn on the spot, and is told to be a `boat`.
#[test]
fn a_turn_that_does_not_turn_fails() {
    let second = Duration::from_secs(1);
    let labels = LabelSource::new("WET".parse().expect("a name"), None);
    let mut ideal = Ideal::new(&mission(), SYSTEM, labels.clone());
    let mut pilot = Pilot::new(SYSTEM, labels, LIMITS);
    let mut is_ordered = false;
    while pilot.failure().is_none() && ideal.now() < 60 * second {
        let now = ideal.now();
        if pilot.is_ready() && !is_ordered {
            let (fix, yaw) = pilot.whereabouts().expect("it is ready");
            pilot.order(now, Order { to: fix.at, yaw: yaw + 1.0, is_turn: true }, false);
            is_ordered = true;
        }
        for message in pilot.due(now) {
            // Its yaw is not heard.
            if !moves(&message) {
                ideal.send(&message);
            }
        }
        if let Ok(Some((header, message))) = ideal.receive(now + second / 50) {
            pilot.hear(ideal.now(), header, &message);
        }
        assert_eq!(pilot.take_arrival(), None);
    }
    let failure = pilot.failure().expect("it does not turn").to_string();
    assert!(failure.contains("it lacks 57 degrees of its turn: a vehicle that"), "{failure}");
}

/// Two copies of a setpoint, of which one is late: it leads the vehicle back, when it was on its way to the next place.
#[test]
fn a_vehicle_that_a_late_setpoint_led_astray_is_sent_its_own_again() {
    let (mut goes, mut late, mut places) = (Vec::new(), None, Vec::new());
    let flown = fly(
        |now, _, message| {
            if !moves(&message) {
                // The copy comes with the next heartbeat, while the vehicle drives.
                return late.take_if(|_| goes.len() == 2).into_iter().chain([message]).collect();
            }
            if goes.is_empty() {
                let mut copy = message.clone();
                if let MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) = &mut copy {
                    // A rover faces the way that it drove.
                    it.yaw += 1.0;
                }
                late = Some(copy);
            }
            goes.push(now);
            vec![message]
        },
        |now, _, message| {
            if let MavMessage::LOCAL_POSITION_NED(it) = &message {
                places.push((now, it.vx.hypot(it.vy)));
            }
            vec![message]
        },
    );
    assert_eq!(flown.failure(), None);
    assert_eq!(flown.trace(), of_run());
    assert_eq!(goes.len(), 5, "one a step, and one again: {goes:?}");
    // A second's positions show that it does not stir.
    let before = places.iter().rev().skip_while(|(at, _)| *at >= goes[2]);
    let rested = before.take_while(|(_, speed)| *speed == 0.0).count();
    assert!((9..=11).contains(&rested), "{rested} positions at rest");
}

/// A link of a computer that is busy or asleep for three seconds, once the vehicle drives: messages wait meanwhile.
struct Busy {
    ideal: Ideal,
    waiting: VecDeque<(MavHeader, MavMessage)>,
    is_over: bool,
}

impl Link for Busy {
    fn now(&self) -> Duration {
        self.ideal.now()
    }

    fn send(&mut self, message: &MavMessage) {
        self.ideal.send(message);
        let until = self.now() + Duration::from_secs(3);
        while moves(message) && !self.is_over && self.now() < until {
            self.waiting.extend(self.ideal.receive(until).expect("it is never broken"));
        }
        self.is_over |= moves(message);
    }

    fn receive(&mut self, until: Duration) -> Result<Option<(MavHeader, MavMessage)>> {
        self.waiting.pop_front().map_or_else(|| self.ideal.receive(until), |it| Ok(Some(it)))
    }
}

#[test]
fn a_computer_that_was_busy_hears_what_came_before_it_judges() {
    let labels = LabelSource::new("WET".parse().expect("a name"), None);
    let ideal = Ideal::new(&mission(), SYSTEM, labels.clone());
    let link = Busy { ideal, waiting: VecDeque::new(), is_over: false };
    let mut control = Control::new(link, Pilot::new(SYSTEM, labels, LIMITS), || None);
    let flight = flight::fly(mission(), &mut control).expect("it begins");
    assert!(flight.failure.is_none(), "{:?}", flight.failure);
    assert!(control.link().is_over);
}
