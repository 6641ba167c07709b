//! Habits of autopilots that the ideal vehicle does not have, as seen in `ArduPilot`'s own simulation.

use std::collections::VecDeque;

use mavlink::dialects::common::MavMessage;

use super::*;

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

/// A rover that steers like a car rests beside where it was sent.
#[test]
fn a_vehicle_that_rests_near_its_target_has_arrived_where_it_is() {
    let flown = fly(|_, _, message| vec![nearer_the_middle(message, 0.7)], as_it_is);
    assert_eq!(flown.failure(), None);
    assert_ne!(flown.trace(), of_run());
    // It is not sent there again: what steers like a car would drive a circle, each time.
    assert_eq!(flown.sent.iter().filter(|(_, it)| moves(it)).count(), 4, "one a step");
    let Ok(flight) = &flown.flight else { panic!("it flew") };
    for step in &flight.recording.steps {
        let off = Ned::from(step.pose.site).distance(step.motion.target.site.into());
        assert!((off - 0.7).abs() < 0.01, "{off}");
    }
    // Which the trace tells, with times, and what would cover it.
    let steps = &flight.recording.results.steps;
    let legs: Vec<_> = steps.iter().filter_map(|step| step.flown).collect();
    assert_eq!(legs.len(), 4);
    assert!(legs.iter().all(|leg| leg.ended > leg.began + 5.0 && (leg.off - 0.7).abs() < 0.01));
    assert!(legs.windows(2).all(|pair| pair[0].ended <= pair[1].began));
    let told = flight.recording.results.end.flown.expect("it flew");
    assert_eq!((told.motions, told.off_most <= told.tolerance), (4, true), "{told:?}");
    assert!(told.tolerance < 0.85, "{told:?}");
    let line = trace::step(&steps[0]);
    assert!(line.contains(",\"flown\":{\"began\":0.0,\"ended\":"), "{line}");
}

#[test]
fn one_that_rests_outside_of_the_area_has_not_arrived() {
    let flown = fly(
        |_, _, mut message| {
            if let MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) = &mut message {
                it.x = it.x.min(-0.2);
            }
            vec![message]
        },
        as_it_is,
    );
    assert!(matches!(flown.failure(), Some(Failure::Misplaced(_))), "{:?}", flown.failure());
}

/// Nor has one that does not move at all, however near its target is.
#[test]
fn a_vehicle_that_is_stuck_does_not_arrive() {
    let flown = fly(|_, _, message| if moves(&message) { vec![] } else { vec![message] }, as_it_is);
    assert!(matches!(flown.failure(), Some(Failure::Late(..))), "{:?}", flown.failure());
}

/// Each setpoint begins a leg anew, and its S-curve with it: a vehicle that moves is left alone for ten seconds.
#[test]
fn a_setpoint_is_sent_again_only_to_a_vehicle_that_does_not_stir() {
    let flown = fly(as_it_is, as_it_is);
    let goes = flown.sent.iter().filter(|(_, it)| moves(it)).count();
    assert_eq!(goes, 4, "one a step");
    // One that is lost is sent again a second later.
    let mut lost = 0;
    let losing = fly(
        |_, _, message| {
            lost += usize::from(moves(&message));
            if moves(&message) && lost <= 3 { vec![] } else { vec![message] }
        },
        as_it_is,
    );
    assert_eq!(losing.trace(), of_run());
    // One that never rests is sent again after ten.
    let restless = fly(as_it_is, |now, _, message| vec![circling(now, message, 1.0)]);
    let goes: Vec<_> = restless.sent.iter().filter(|(_, it)| moves(it)).map(|it| it.0).collect();
    assert_eq!(goes.len(), 2, "{goes:?}");
    assert!(goes[1].saturating_sub(goes[0]) >= Duration::from_secs(10), "{goes:?}");
}

/// In a current or in waves a vehicle holds its place, but is never at rest.
#[test]
fn a_vehicle_that_stays_within_the_acceptance_has_arrived_though_it_wobbles() {
    // Its place is exact, and its speed over ground is not.
    let mut number = 0_u8;
    let flown = fly(as_it_is, |_, _, mut message| {
        if let MavMessage::LOCAL_POSITION_NED(it) = &mut message {
            number = (number + 1) % 4;
            it.vx += if number < 2 { 0.3 } else { -0.3 };
        }
        vec![message]
    });
    assert_eq!(flown.failure(), None);
    assert_eq!(flown.trace(), of_run());
    // Or it wobbles within the acceptance, 0.02 m.
    let flown = fly(as_it_is, |now, _, message| vec![circling(now, message, 0.01)]);
    assert_eq!(flown.failure(), None);
    let Ok(flight) = &flown.flight else { panic!("it flew") };
    let legs: Vec<_> = flight.recording.results.steps.iter().filter_map(|it| it.flown).collect();
    assert_eq!(legs.len(), 4);
    assert!(legs.iter().all(|leg| leg.off <= 0.02), "{legs:?}");
}

#[test]
fn so_has_one_that_stays_near_its_target() {
    let flown = fly(
        |_, _, message| vec![nearer_the_middle(message, 0.7)],
        |now, _, message| vec![circling(now, message, 0.2)],
    );
    assert_eq!(flown.failure(), None);
    let Ok(flight) = &flown.flight else { panic!("it flew") };
    let legs: Vec<_> = flight.recording.results.steps.iter().filter_map(|it| it.flown).collect();
    assert_eq!(legs.len(), 4);
    assert!(legs.iter().all(|leg| (0.45..0.95).contains(&leg.off)), "{legs:?}");
    // Its setpoint begins a leg anew, so that it is sent each ten seconds at most.
    assert!(flown.sent.iter().filter(|(_, it)| moves(it)).count() <= 8);
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

/// A glitch of the receiver, or another origin: 6 m at once, or 3.3 m in two seconds.
#[test]
fn positions_that_move_without_the_vehicle_end_the_flight() {
    for (metres, seconds) in [(6.0, 0.0), (3.3, 2.0)] {
        let flown = fly(as_it_is, |now, _, mut message| {
            if let MavMessage::LOCAL_POSITION_NED(it) = &mut message
                && now >= THEN
            {
                let part = (now.saturating_sub(THEN).as_secs_f32() / seconds).min(1.0);
                it.x += metres * part;
            }
            vec![message]
        });
        assert!(matches!(flown.failure(), Some(Failure::Slid(_))), "{:?}", flown.failure());
    }
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
    let moved = places.iter().rfind(|(at, speed)| *at < goes[2] && *speed > 0.0);
    let rested = goes[2].saturating_sub(moved.expect("it was led astray").0);
    assert!((1.0..1.3).contains(&rested.as_secs_f64()), "{rested:?}");
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
