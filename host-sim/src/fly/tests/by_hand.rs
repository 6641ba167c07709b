//! Labels before the flight, while an operator drives from place to place.

use nalgebra::Point2;
use planner_core::Site;

use super::spoiled::{fly_by, wet};
use super::*;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::results::SampleRecord;
use crate::mission::scenario::{self, Overrides};
use crate::world::World;

/// How fast the operator drives, metres a second.
const SPEED: f32 = 2.0;

/// When the operator begins to drive.
const BEGINS: f32 = 8.0;

/// The places where the operator rests, in metres, from the mission's start and back; and how long, in seconds.
#[derive(Clone)]
struct Drive {
    places: Vec<[f32; 2]>,
    rests: f32,
}

impl Drive {
    /// Where the vehicle is, how fast it moves, and whether the operator has driven to the end.
    fn at(&self, now: Duration) -> ([f32; 2], [f32; 2], bool) {
        let mut left = now.as_secs_f32() - BEGINS;
        let mut from = self.places[0];
        for &to in &self.places[1..] {
            if left < 0.0 {
                return (from, [0.0; 2], false);
            }
            let way = [to[0] - from[0], to[1] - from[1]];
            let metres = way[0].hypot(way[1]);
            if left < metres / SPEED {
                let along = |k: usize| from[k] + way[k] / metres * SPEED * left;
                let velocity = way.map(|it| it / metres * SPEED);
                return ([0, 1].map(along), velocity, false);
            }
            left -= metres / SPEED + self.rests;
            from = to;
        }
        (from, [0.0; 2], left >= 0.0)
    }

    /// Makes the ideal vehicle one that the operator drives in MANUAL until all places were seen.
    fn spoil(&self, now: Duration, message: &mut MavMessage, world: &World) {
        let (at, velocity, is_over) = self.at(now);
        if is_over {
            return;
        }
        match message {
            MavMessage::HEARTBEAT(it) => it.custom_mode = 0,
            MavMessage::LOCAL_POSITION_NED(it) => {
                ([it.y, it.x], [it.vy, it.vx]) = (at, velocity);
            }
            MavMessage::NAMED_VALUE_FLOAT(it) => {
                it.value = f32::from(world.reading(site(at)).sign());
            }
            _ => {}
        }
    }
}

fn site(at: [f32; 2]) -> Site {
    Site::try_from(Point2::from(at.map(f64::from))).expect("on the lattice")
}

fn mission(more: &str) -> Mission {
    let text = format!(
        "tolerance = 0.02\nsteps = 12\nvehicle = {{ kind = \"unicycle\", reach = 5.0, step = 1.0 }}\n\
         area = {{ x = [-40.0, 40.0], z = [-40.0, 40.0] }}\nstart = {{ x = 10.0, z = -20.0 }}\n\
         truth = {{ slope = 0.3, intercept = 5.0 }}\n{more}"
    );
    scenario::parse("m", &text, Overrides::default()).expect("a scenario")
}

/// A drive through these places, from the start and back to it.
fn through(places: &[[f32; 2]]) -> Drive {
    let start = [10.0, -20.0];
    Drive { places: [&[start], places, &[start]].concat(), rests: 3.0 }
}

fn flown(
    mission: &Mission,
    drive: &Drive,
    mut spoil: impl FnMut(Duration, &mut MavMessage) + 'static,
) -> Flown {
    let (world, drive) = (mission.world.clone(), drive.clone());
    let back = move |now, _, mut message| {
        drive.spoil(now, &mut message, &world);
        spoil(now, &mut message);
        vec![message]
    };
    fly_by(mission.clone(), (Box::new(as_it_is), Box::new(back)), None, |link| {
        Control::new(link, Pilot::new(SYSTEM, wet(), LIMITS).by_hand(1.0), || None)
    })
}

fn samples(flown: &Flown) -> Vec<(f32, f32, i8)> {
    let Ok(flight) = &flown.flight else { panic!("{:?}", flown.failure()) };
    let plain = |it: &SampleRecord| (it.x as f32, it.z as f32, it.label);
    flight.recording.results.start.samples.iter().map(plain).collect()
}

const PLACES: [[f32; 2]; 4] = [[10.0, 0.0], [10.0, 25.0], [-20.0, 25.0], [-20.0, -10.0]];

/// What the truth says at the start, at each place, and not again at the start.
const READ: [(f32, f32, i8); 6] = [
    (10.0, -20.0, -1),
    (10.0, 0.0, -1),
    (10.0, 25.0, 1),
    (-20.0, 25.0, 1),
    (-20.0, -10.0, -1),
    (10.0, -20.0, -1),
];

/// One a place. The mission goes on with them as one that was told of them, whatever its labels, its boundary and its
/// oracle are.
#[test]
fn labels_by_hand_are_a_missions_first() {
    let oracle = "oracle = [{ x = -30, z = -30, label = -1 }, { x = 30, z = -30, label = -1 }, { x = 0, z = 30, label = 1 }]\n";
    let doubtful = "noise = { p = 0.9, true_p = 1.0 }\n";
    for more in [
        "algorithm = \"lookahead\"\noracle = []\n".to_owned(),
        format!("algorithm = \"lookahead\"\n{oracle}"),
        format!("algorithm = \"lookahead\"\noracle = []\n{doubtful}"),
        format!("algorithm = \"lookahead\"\n{doubtful}{oracle}"),
        "algorithm = \"track\"\noracle = []\n".to_owned(),
        format!("algorithm = \"cfc\"\n{oracle}"),
    ] {
        let mission = mission(&more);
        let flown = flown(&mission, &through(&PLACES), |_, _| ());
        assert_eq!(flown.failure(), None, "{more}");
        assert_eq!(samples(&flown), READ, "{more}");
        let Ok(flight) = &flown.flight else { unreachable!() };
        let told =
            mission.having_read(&flight.recording.mission.read_before).expect("labels are true");
        let expected = Recording::of(&told).expect("labels are true").results;
        assert_eq!(flown.trace(), trace::lines(&expected), "{more}");
        assert!(expected.steps.len() > 3, "{more}");
    }
}

/// A vehicle that never rests has one from where it stood before, and no more. A label from before it came to rest is none.
#[test]
fn a_label_wants_a_rest() {
    let mission = mission("algorithm = \"lookahead\"\noracle = []\n");
    let drive = Drive { rests: 0.0, ..through(&PLACES[..1]) };
    let restless = flown(&mission, &drive, |_, _| ());
    assert_eq!((restless.failure(), samples(&restless)), (None, READ[..1].to_vec()));
    let drive = through(&PLACES[..1]);
    let late = flown(&mission, &drive.clone(), move |now, message| {
        if let MavMessage::NAMED_VALUE_FLOAT(it) = message
            && now.as_secs_f32() > BEGINS
            && !drive.at(now).2
        {
            it.time_boot_ms = it.time_boot_ms.saturating_sub(6_000);
        }
    });
    assert_eq!((late.failure(), samples(&late)), (None, READ[..1].to_vec()));
}

/// A label that contradicts what is known is left out, and so is one outside of the area.
#[test]
fn what_cannot_be_used_is_left_out() {
    let oracle = "algorithm = \"lookahead\"\noracle = [{ x = -30, z = -30, label = -1 }, { x = 30, z = -30, label = -1 }, { x = 0, z = 30, label = 1 }]\n";
    let mission = mission(oracle);
    let drive = through(&[[0.0, -25.0], [0.0, 45.0], [0.0, 20.0]]);
    let flown = flown(&mission, &drive, |now, message| {
        if let MavMessage::NAMED_VALUE_FLOAT(it) = message
            && (14.0..18.0).contains(&now.as_secs_f32())
        {
            it.value = 1.0;
        }
    });
    assert_eq!(flown.failure(), None);
    assert_eq!(samples(&flown), [(10.0, -20.0, -1), (0.0, 20.0, 1), (10.0, -20.0, -1)]);
}

/// When positions jump, or count from elsewhere, labels from before lie where they were not read: they are dropped.
#[test]
fn labels_from_before_a_jump_are_dropped() {
    let mission = mission("algorithm = \"lookahead\"\noracle = []\n");
    // At the third place; what comes after it is as far off.
    let jumps = |now: Duration, message: &mut MavMessage| {
        if let MavMessage::LOCAL_POSITION_NED(it) = message
            && now.as_secs_f32() < 38.0
        {
            it.x += 3.0;
        }
    };
    let flown = flown(&mission, &through(&PLACES), jumps);
    assert_eq!(flown.failure(), None);
    let left = samples(&flown);
    assert!(!left.is_empty() && left.len() < READ.len(), "{left:?}");
    assert_eq!(left, READ[READ.len() - left.len()..]);
}
