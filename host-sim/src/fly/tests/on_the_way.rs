//! Labels on the way of a flight: where they are taken, and what the planner makes of them.

use mavlink::dialects::common::MavMessage;
use nalgebra::Point2;

use super::*;
use crate::mission::definition::Mission;
use crate::mission::results::StepResult;

/// The mission with so many labels a motion.
fn reading(readings: u32) -> Mission {
    Mission { readings, ..mission() }
}

fn flown(
    mission: Mission,
    back: impl FnMut(Duration, usize, MavMessage) -> Vec<MavMessage>,
) -> Flown {
    fly_mission(mission, (Box::new(as_it_is), Box::new(back)), None, || None)
}

fn steps(flown: &Flown) -> &[StepResult] {
    let Ok(flight) = &flown.flight else { panic!("{:?}", flown.failure()) };
    &flight.recording.results.steps
}

/// Labels of the way of each step: how far along the straight way, in parts of which a motion has as many as labels.
fn parts(flown: &Flown, readings: u32) -> Vec<Vec<f64>> {
    let mut from = Point2::<f64>::from(mission().start.site);
    let each = |step: &StepResult| {
        let to = Point2::new(step.pose.x, step.pose.z);
        let way = (to - from) / (to - from).norm_squared() * f64::from(readings);
        let part = |(site, _)| (Point2::<f64>::from(site) - from).dot(&way);
        let parts = step.passed().map(part).collect();
        from = to;
        parts
    };
    steps(flown).iter().map(each).collect()
}

/// The planner knows the line no worse, each label is the true one, and there is one in each part but the first.
#[test]
fn labels_are_taken_at_the_vehicle_s_places_on_the_way() {
    let (one, mission) = (flown(reading(1), as_it_is), reading(5));
    assert!(steps(&one).iter().all(|step| step.passed().count() == 0));
    assert_eq!(one.trace(), of_run());
    let world = mission.world.clone();
    let flown = flown(mission, as_it_is);
    assert_eq!(flown.failure(), None);
    for (site, reading) in steps(&flown).iter().flat_map(StepResult::passed) {
        assert_eq!(reading, world.reading(site), "{site:?}");
    }
    let parts = parts(&flown, 5);
    assert_eq!(parts.len(), 4);
    for parts in parts {
        let whole: Vec<_> = parts.iter().map(|it| (it + 1e-3).floor()).collect();
        assert_eq!(whole, [1.0, 2.0, 3.0, 4.0], "{parts:?}");
    }
    let bits = |flown: &Flown| steps(flown).last().expect("a step").bits;
    assert!(bits(&flown) > bits(&one), "{} and {}", bits(&flown), bits(&one));
    assert!(flown.trace().contains("\"readings\":5"));
}

/// A metre a second and ten positions a second: no more than nine labels on a metre's way, and none of them twice.
#[test]
fn a_way_has_no_more_labels_than_positions() {
    let flown = flown(reading(50), as_it_is);
    let mut before = Point2::<f64>::from(mission().start.site);
    for (step, parts) in steps(&flown).iter().zip(parts(&flown, 50)) {
        let end = Point2::new(step.pose.x, step.pose.z);
        let metres = (end - before).norm();
        before = end;
        assert!(parts.len() as f64 <= metres / 0.1 + 1e-6, "{metres} m: {parts:?}");
        assert!(parts.len() > 5, "{metres} m: {parts:?}");
        assert!(parts.is_sorted_by(|a, b| a + 1.0 < b + 0.5), "{parts:?}");
    }
}

/// Lost positions leave labels out. Lost labels, and doubled ones, change no other. None is put elsewhere.
#[test]
fn what_is_lost_late_or_doubled_misleads_nobody() {
    let mission = reading(8);
    let world = mission.world.clone();
    let whole: usize = parts(&flown(mission.clone(), as_it_is), 8).iter().map(Vec::len).sum();
    let mut late = Vec::new();
    let mut spoil = |kind: usize, number: usize, message: MavMessage| match (kind, &message) {
        (0, MavMessage::LOCAL_POSITION_NED(_)) if number % 8 < 5 => vec![],
        (1, MavMessage::NAMED_VALUE_FLOAT(_)) if number.is_multiple_of(3) => vec![],
        (2, MavMessage::NAMED_VALUE_FLOAT(_)) => vec![message.clone(), message],
        (3, MavMessage::NAMED_VALUE_FLOAT(_)) => {
            // Half a second late.
            late.push(message);
            if late.len() > 5 { vec![late.remove(0)] } else { vec![] }
        }
        _ => vec![message],
    };
    let counts = [0, 1, 2, 3].map(|kind| {
        let flown = flown(mission.clone(), |_, number, message| spoil(kind, number, message));
        assert_eq!(flown.failure(), None, "{kind}");
        let all: Vec<_> = steps(&flown).iter().flat_map(StepResult::passed).collect();
        for (site, reading) in &all {
            assert_eq!(*reading, world.reading(*site), "{kind}: {site:?}");
        }
        all.len()
    });
    assert!(counts[0] < whole && counts[0] > 0, "{counts:?} of {whole}");
    assert!(counts[1] > whole / 2, "{counts:?} of {whole}");
    assert_eq!(counts[2], whole, "{counts:?}");
    assert!(counts[3] > whole / 2, "{counts:?} of {whole}");
}
