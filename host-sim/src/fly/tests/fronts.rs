//! Missions along a front: a vehicle over `MAVLink` maps it as `run` does.

use super::*;
use crate::mission::definition::Mission;
use crate::mission::map::State;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides};

const COAST: &str = include_str!("../../../scenarios/coast.toml");

/// Labels are true, as the ideal vehicle flips none.
fn along_a_coast(steps: u32) -> Mission {
    let text = format!("tolerance = 0.02\n{}", COAST.replace("noise = { p = 0.9 }\n", ""));
    let overrides = Overrides { steps: Some(steps), ..Overrides::default() };
    scenario::parse("coast", &text, overrides).expect("a scenario")
}

/// The trace is that of `run`, map and all, and the vehicle is stopped in the end.
#[test]
fn a_coast_is_mapped_as_by_run() {
    let expected = Recording::of(&along_a_coast(40)).expect("labels are true").results;
    let spoil: (Spoil<'_>, Spoil<'_>) = (Box::new(as_it_is), Box::new(as_it_is));
    let flown = fly_mission(along_a_coast(40), spoil, None, || None);
    assert_eq!(flown.failure(), None);
    assert_eq!(flown.trace(), trace::lines(&expected));
    let map = expected.end.front.expect("a map");
    assert!(map.state == State::Followed && map.vertices > 30, "{map:?}");
    let last = flown.sent.iter().rfind(|(_, it)| !matches!(it, MavMessage::HEARTBEAT(_)));
    assert!(last.is_some_and(|(_, it)| is_stop(it)), "{last:?}");
}

/// A link that breaks ends the flight; what was mapped until then is told.
#[test]
fn a_map_outlives_a_link_that_breaks() {
    let spoil: (Spoil<'_>, Spoil<'_>) = (Box::new(as_it_is), Box::new(as_it_is));
    let flown = fly_mission(along_a_coast(40), spoil, Some(Duration::from_mins(1)), || None);
    assert!(flown.failure().is_some());
    let results = &flown.flight.as_ref().expect("it flew").recording.results;
    let map = results.end.front.as_ref().expect("a map");
    assert_eq!(results.end.reason, "broken off");
    assert!(map.vertices > 5 && results.steps.len() < 40, "{map:?}");
}
