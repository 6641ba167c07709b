//! Missions in an area from a map: the vehicle counts from a place of its own, whose latitude and longitude it says.

use std::path::Path;

use super::spoiled::{fly_by, wet};
use super::*;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides};

fn in_a_lake(algorithm: &str, truth: &str) -> Mission {
    let text = format!(
        "tolerance = 0.02\nalgorithm = \"{algorithm}\"\nsteps = 25\noracle = []\n\
         area = {{ geojson = \"kyyvesi.geojson\" }}\nstart = {{ lat = 60.1990, lon = 24.9020, heading = 1.0 }}\n\
         vehicle = {{ kind = \"boat\", reach = 10.0, step = 1.0, sharpest = 0.5 }}\ntruth = {truth}\n"
    );
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/lakes");
    scenario::parse_in("lake", &text, &folder, Overrides::default()).expect("a scenario")
}

fn a_line() -> Mission {
    in_a_lake("lookahead", "{ slope = 0.3, intercept = -40.0 }")
}

fn flown(mission: Mission, back: Spoil<'_>) -> Flown {
    fly_mission(mission, (Box::new(as_it_is), back), None, || None)
}

/// The trace is that of `run`, though the vehicle counts from another place than the map.
#[test]
fn a_lake_is_flown_as_by_run() {
    for mission in [a_line, || in_a_lake("track", "{ circle = [20.0, -60.0, 60.0] }")] {
        let expected = Recording::of(&mission()).expect("labels are true").results;
        let flight = flown(mission(), Box::new(as_it_is));
        assert_eq!(flight.failure(), None);
        assert_eq!(flight.trace(), trace::lines(&expected));
        // It counts from where it begins, far from the middle of the lake.
        let first = flight.sent.iter().find_map(|(_, it)| match it {
            MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) => Some(it.x.hypot(it.y)),
            _ => None,
        });
        assert!(first.is_some_and(|it| it < 11.0) && expected.steps.len() > 20, "{first:?}");
    }
}

/// A vehicle that does not say where it counts from, or says that later otherwise, is not flown.
#[test]
fn the_place_that_it_counts_from_is_needed_and_stays() {
    let silent = flown(
        a_line(),
        Box::new(|_, _, message| {
            if matches!(message, MavMessage::GPS_GLOBAL_ORIGIN(_)) { vec![] } else { vec![message] }
        }),
    );
    let failure = silent.failure().expect("it does not fly").to_string();
    assert!(failure.contains("where its local positions count from"), "{failure}");
    let moved = flown(
        a_line(),
        Box::new(|now, _, mut message| {
            if let MavMessage::GPS_GLOBAL_ORIGIN(it) = &mut message
                && now > 2 * THEN
            {
                it.latitude += 1_000;
            }
            vec![message]
        }),
    );
    assert_eq!(
        moved.failure().expect("it fails").to_string()[..33],
        *"its position slid by 11.1 m that "
    );
    ends_at_rest(&moved);
}

/// A label by hand lies where the vehicle truly is, whatever place it counts from.
#[test]
fn a_label_by_hand_has_its_place_on_the_map() {
    let in_manual = |now, _, mut message| {
        if let MavMessage::HEARTBEAT(it) = &mut message
            && now < 2 * THEN
        {
            it.custom_mode = 0;
        }
        vec![message]
    };
    let flown = fly_by(a_line(), (Box::new(as_it_is), Box::new(in_manual)), None, |link| {
        Control::new(link, Pilot::new(SYSTEM, wet(), LIMITS).by_hand(1.0), || None)
    });
    assert_eq!(flown.failure(), None);
    let Ok(flight) = &flown.flight else { unreachable!() };
    let start = &flight.recording.results.start;
    let [read] = start.samples[..] else { panic!("{:?}", start.samples) };
    let off = (read.x - start.pose.x).hypot(read.z - start.pose.z);
    assert!(
        off < 0.01 && read.label == a_line().world.reading(a_line().start.site).sign(),
        "{read:?}"
    );
}
