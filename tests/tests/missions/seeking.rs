//! Missions that begin from nothing: a line is found, or all has one label, and the planner that was asked for goes on.
//!
//! A field is a standard field without its points. It counts as known once the estimate is within 1 degree of the true
//! line and misclassifies less than 1 % of the area. The random missions of `anything` seek with any vehicle.

use std::f64::consts::TAU;

use host_sim::campaign::patches::flight::Patches;
use host_sim::campaign::patches::kinds::KINDS;
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Given;
use host_sim::mission::read_out::ReadOut;
use host_sim::mission::results::Ending;
use host_sim::world::{World, reading};
use nalgebra::{Point2, Vector2};
use planner_core::{
    AnyVehicle, Area, Far, Front, Heading, Label, Likely, Line, Lines, Noise, OneLabel, Plan,
    Planner as _, Pose, Reading, Sample, Seek, Seeking, Site, StopReason, Track, Unicycle,
};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::ensemble::{self, expect, mean, median, noisy, percent};
use tests::vehicles::unicycle;

const SEED: u64 = 27;

const FIELD: [f64; 2] = [20.0, 20.0];
const LAKE: [f64; 2] = [800.0, 500.0];

/// A mission without points in a standard field that is stretched to these sides.
fn from_nothing(sides: [f64; 2], number: u64, algorithm: Algorithm, p: f64) -> Mission {
    let mut mission = standard_field::stretched(sides, SEED, number, algorithm, 1_000);
    mission.given = Given::open(Vec::new());
    if sides == LAKE {
        let lake = unicycle(1, 20_000);
        mission.vehicle = AnyVehicle::Unicycle(lake);
        let far = Far::across(&mission.config.area);
        mission.asking = Asking { price: Some(far.price()), ..Asking::USUAL };
    }
    if p < 1.0 { noisy(mission, p, 0.0) } else { mission }
}

/// What a mission came to.
struct Flown {
    /// Labels until the line was known, if it was.
    known: Option<f64>,
    /// Labels and metres until it was found, or until the end.
    sought: [f64; 2],
    is_found: bool,
    ending: Ending,
    one: Option<OneLabel>,
}

impl Flown {
    fn is_one_label(&self) -> bool {
        self.ending == Ending::Stopped(StopReason::OneLabel)
    }
}

/// Whether an estimate is near enough to the truth.
fn is_near(mission: &Mission, belief: &dyn ReadOut) -> bool {
    let (Some(line), Some(centre)) = (mission.world.line(), belief.centre()) else { return false };
    let centre = Line::from(centre);
    let misclassified = mission.world.misclassified(mission.config.area, &centre);
    centre.angle_to_deg(line) < 1.0 && misclassified.is_some_and(|it| it < 0.01)
}

/// Whether the mission's belief is that of the planner that goes on, or of a front that is found.
fn has_found(mission: &Mission, belief: &dyn ReadOut) -> bool {
    let within = mission.found_width();
    match belief.front() {
        Some(front) => within.is_some_and(|within| front.found(within).is_some()),
        None => belief.sought().is_none(),
    }
}

fn flown(mission: &Mission) -> Flown {
    let (mut taken, mut known, mut found) = ([0.0; 2], None, None);
    let mut labels = Vec::new();
    let (end, _) = mission.fly_in_sight(|step, _, belief| {
        if let Some(Reading::Side(label)) = step.reading {
            labels.push(Sample { site: step.pose.site, label });
        }
        if known.is_some() && found.is_some() {
            return;
        }
        taken[0] += f64::from(u8::from(step.reading.is_some()));
        taken[1] += f64::from(step.motion.control.distance_m);
        found = found.or_else(|| has_found(mission, belief).then_some(taken));
        known = known.or_else(|| is_near(mission, belief).then_some(taken[0]));
    });
    let one = mission.one_label(&labels);
    let (sought, is_found) = (found.unwrap_or(taken), found.is_some());
    Flown { known, sought, is_found, ending: end.ending, one }
}

/// Bounds on the labels until the line is known, and on the metres until it is found. A survey of square cells drives as
/// many metres until its first label of the other kind: 25 cells in a field, 40 in a lake.
#[test]
fn lines_and_fronts_are_found_from_nothing() {
    let not_asked = f64::INFINITY;
    for (sides, p, algorithm, labels, metres) in [
        (FIELD, 1.0, Algorithm::Lookahead, 20.0, 31.5),
        (FIELD, 0.9, Algorithm::Lookahead, 48.0, not_asked),
        (FIELD, 1.0, Algorithm::Cfc, 30.0, not_asked),
        (LAKE, 1.0, Algorithm::Lookahead, 23.0, 1_189.0),
        (LAKE, 0.9, Algorithm::Lookahead, 50.0, not_asked),
        (FIELD, 1.0, Algorithm::Track, not_asked, not_asked),
        (FIELD, 0.9, Algorithm::Track, not_asked, not_asked),
        (LAKE, 1.0, Algorithm::Track, not_asked, not_asked),
        (LAKE, 0.9, Algorithm::Track, not_asked, not_asked),
    ] {
        let is_front = algorithm == Algorithm::Track;
        let fields = cases(if is_front { 12 } else { 24 }, 1_000);
        let flown = ensemble::fly(fields, |number| {
            let mut mission = from_nothing(sides, number, algorithm, p);
            mission.steps = if is_front { 400 } else { 1_000 };
            flown(&mission)
        });
        let what = format!("{sides:?}, p = {p}, {algorithm:?}");
        expect(format!("{what}, not found"), percent(&flown, |it| !it.is_found), ..=1.0);
        let driven = mean(flown.iter().map(|it| it.sought[1]));
        expect(format!("{what}, metres"), driven, ..=metres);
        if !is_front {
            let known = flown.iter().filter_map(|it| it.known);
            let chance = if fields < 1_000 { 1.4 } else { 1.0 };
            expect(format!("{what}, not known"), percent(&flown, |it| it.known.is_none()), ..=1.0);
            expect(format!("{what}, labels"), median(known), ..=labels * chance);
        }
    }
}

/// What a label tells elsewhere settles it, with few labels.
#[test]
fn an_area_of_one_label_ends_as_that() {
    for (sides, p, algorithm, most) in [
        (FIELD, 1.0, Algorithm::Lookahead, 55.0),
        (FIELD, 0.9, Algorithm::Lookahead, 90.0),
        (FIELD, 0.7, Algorithm::Lookahead, 260.0),
        (FIELD, 1.0, Algorithm::Track, 60.0),
        (LAKE, 1.0, Algorithm::Lookahead, 60.0),
        (LAKE, 1.0, Algorithm::Track, 180.0),
    ] {
        let flown = ensemble::fly(cases(20, 1_000), |number| {
            let mut mission = from_nothing(sides, number, algorithm, p);
            let below = if number.is_multiple_of(2) { 1e5 } else { -1e5 };
            mission.world = World::divided_by(Line::from_slope(0.0, below).expect("a line"));
            flown(&mission)
        });
        let what = format!("{sides:?}, p = {p}, {algorithm:?}");
        expect(format!("{what}, one label"), percent(&flown, Flown::is_one_label), 98.5..);
        expect(format!("{what}, labels"), median(flown.iter().map(|it| it.sought[0])), ..=most);
        for (number, it) in flown.iter().enumerate().filter(|(_, it)| it.is_one_label()) {
            let label = if number % 2 == 0 { Label::Negative } else { Label::Positive };
            let one = it.one.expect("one label");
            assert_eq!(one.label, label, "{what}, {number}: {one:?}");
        }
    }
}

/// Patches and coasts from nothing, in a lake of 200 m x 150 m with motions of 3 m. A lawnmower with tracks of 40 m needs
/// some 300 m for a patch.
#[test]
fn patches_are_found_sooner_than_by_mowing() {
    let missions = cases(24, 400);
    for (name, p, metres) in [
        ("circle of 25 to 45 m", 1.0, 200.0),
        ("blob", 0.9, 220.0),
        ("circle, island of 20 %", 0.9, 300.0),
        ("circle, a boat", 0.9, 260.0),
        ("line", 0.9, 260.0),
    ] {
        let kind = KINDS.iter().find(|it| it.name == name).expect("a kind");
        let patches = Patches { mows: false, missions, seed: SEED, p: vec![p], told: 1.0 };
        let flown =
            ensemble::fly(missions, |number| patches.mission(kind, p, number).expect("a mission"));
        let what = format!("{name}, p = {p}");
        expect(format!("{what}, found"), percent(&flown, |it| it.is_found), 95.0..);
        expect(format!("{what}, falsely"), percent(&flown, |it| it.is_false), ..=2.0);
        assert!(!flown.iter().any(|it| it.is_empty), "{what}: said to be empty");
        expect(format!("{what}, metres"), mean(flown.iter().map(|it| it.metres)), ..=metres);
    }
}

/// An area without a boundary ends as that, and none is found.
#[test]
fn a_lake_without_a_patch_ends_as_that() {
    let kind = KINDS.iter().find(|it| it.name == "nothing").expect("a kind");
    for p in [1.0, 0.9] {
        let missions = cases(10, 200);
        let patches = Patches { mows: false, missions, seed: SEED, p: vec![p], told: 1.0 };
        let flown =
            ensemble::fly(missions, |number| patches.mission(kind, p, number).expect("a mission"));
        expect(format!("p = {p}, empty"), percent(&flown, |it| it.is_empty), 98.0..);
        expect(format!("p = {p}, false"), percent(&flown, |it| it.is_false), ..=1.0);
    }
}

/// A line that crosses the area somewhere, be it at a corner.
fn any_line(sides: [f64; 2], rng: &mut ChaCha8Rng) -> Line {
    let half = Vector2::from(sides) / 2.0;
    let corners = [[0.0, 0.0], [sides[0], 0.0], [0.0, sides[1]], sides];
    loop {
        let (sin, cos) = libm::sincos(rng.random_range(0.0..TAU));
        let off = half.norm() * rng.random_range(-1.0..1.0);
        let normal = Vector2::new(cos, sin);
        let line = Line::through(Point2::from(half + normal * off), normal).expect("a line");
        let above = corners.iter().filter(|it| line.distance(Point2::from(**it)) > 0.0).count();
        if (1..4).contains(&above) {
            return line;
        }
    }
}

/// Lines that cross the area anywhere: those that are missed cut off less than is stated.
#[test]
fn what_may_be_cut_off_is_stated() {
    let fields = cases(40, 1_000);
    let missed = ensemble::fly_some(fields, |number| {
        let mut mission = from_nothing(FIELD, number, Algorithm::Lookahead, 1.0);
        let line = any_line(FIELD, &mut ensemble::rng(SEED, number));
        mission.world = World::divided_by(line);
        let flown = flown(&mission);
        if !flown.is_one_label() {
            assert!(flown.is_found, "field {number}, seed {SEED}: {:?}", flown.ending);
            return None;
        }
        let one = flown.one.expect("one label");
        let is_other = |k: u32| {
            let place = [k / 100, k % 100].map(|it| 0.2 * (f64::from(it) + 0.5));
            reading(&line, Site::metres(place).expect("near")) != Reading::Side(one.label)
        };
        let cut = (0..10_000).filter(|k| is_other(*k)).count();
        assert!(cut < 100, "field {number}, seed {SEED}: {cut} of 10,000 places, {one:?}");
        Some(())
    });
    assert!(missed.len() as u64 <= 1 + fields / 100, "{} of {fields}", missed.len());
}

/// The first label of the other kind than points of one label ends it.
#[test]
fn points_of_one_label_are_taken_as_known() {
    let area = Area::metres([0.0, 0.0], FIELD).expect("an area");
    let at = |x: f64, z: f64, label| Sample { site: Site::metres([x, z]).expect("near"), label };
    let points = [at(1.0, 1.0, Label::Positive), at(19.0, 2.0, Label::Positive)];
    let lines = Lines::<16, 16>::new(area, Noise::NONE);
    let mut seek = Seek::new(area, Unicycle::default(), lines).expect("room").knowing(&points);
    assert!(seek.given().is_empty());
    let pose = Pose::at([10.0, 19.0], Heading::default()).expect("a pose");
    seek.observe(pose, Some(Label::Negative.into())).expect("a label");
    assert_eq!((seek.given().len(), seek.plan(pose)), (3, Plan::Stop(StopReason::Known)));
}

/// Labels that may be wrong: the labels that are lent are hardly ever.
#[test]
fn what_is_lent_is_true() {
    for p in [0.9, 0.7] {
        let is_false = ensemble::fly(cases(40, 1_000), |number| {
            let mission = from_nothing(FIELD, number, Algorithm::Lookahead, p);
            let (mut rng, line) = (ensemble::rng(SEED, number), mission.world.line());
            let mut read = |site| match reading(line.expect("a line"), site) {
                Reading::Side(label) if !rng.random_bool(p) => (-label).into(),
                reading => reading,
            };
            let mut seek = mission.seek(Unicycle::default());
            let mut pose = mission.start;
            while let Plan::Move(motion) = seek.plan(pose) {
                pose = motion.target;
                let reading = motion.wants_label.then(|| read(pose.site));
                seek.observe(pose, reading).expect("any label is taken in");
            }
            assert!(matches!(seek.given().len(), 0 | 4), "p {p}, field {number}, seed {SEED}");
            seek.given().iter().any(|it| !mission.world.agrees(it.site, it.label))
        });
        let wrong = is_false.iter().filter(|it| **it).count();
        assert!(wrong <= is_false.len().max(100) / 100, "p {p}, seed {SEED}: {wrong}");
    }
}

/// Three spills in a lake: each is mapped, and the search for more comes to an end. That there is none at all takes some
/// 1,140 and 1,240 steps.
#[test]
fn several_patches_are_mapped_one_after_the_other() {
    const SPILLS: [([f64; 2], f64); 3] =
        [([45.0, 45.0], 16.0), ([150.0, 40.0], 22.0), ([110.0, 115.0], 18.0)];
    for (p, least) in [(1.0, 2.9), (0.9, 2.7)] {
        let flown = ensemble::fly(cases(12, 100), |number| {
            let mut rng = ensemble::rng(61, number);
            let area = Area::metres([0.0, 0.0], [200.0, 150.0]).expect("an area");
            let seeking = Seeking::patches(12.0).and_then(|it| it.likely(Likely::Spill).several(5));
            let planner =
                Track::new(area, unicycle(1, 2_000), Front::BENDING, Noise::new(p).expect("p"));
            let planner = planner.and_then(|it| it.seeking(seeking.expect("few"))).expect("room");
            let mut planner = planner.until_closed();
            let start = [rng.random_range(2.0..198.0), rng.random_range(2.0..148.0)];
            let heading = Heading::from_radians(rng.random_range(0.0..TAU)).expect("an angle");
            let mut pose = Pose::at(start, heading).expect("a pose");
            let mut mapped = [0; SPILLS.len()];
            let off = |at: Point2<f64>, ([x, z], radius): ([f64; 2], f64)| {
                (at - Point2::new(x, z)).norm() - radius
            };
            for step in 0..3_000 {
                let motion = match planner.plan(pose) {
                    Plan::Move(motion) => motion,
                    Plan::Stop(reason) => return (mapped, Some(reason), step),
                };
                pose = motion.target;
                let at = Point2::from(pose.site);
                let is_in = SPILLS.iter().any(|it| off(at, *it) < 0.0) == rng.random_bool(p);
                let label = if is_in { Label::Positive } else { Label::Negative };
                planner.observe(pose, motion.wants_label.then_some(label.into())).expect("a label");
                for place in planner.belief().mapped() {
                    let at = Point2::from(place.waist.site);
                    let on = SPILLS.iter().position(|it| off(at, *it).abs() < 5.0);
                    if let Some(it) = on {
                        mapped[it] += 1;
                    }
                }
            }
            (mapped, None, 3_000)
        });
        // Places are a metre apart.
        let is_mapped = |count: i32, radius: f64| f64::from(count) > 0.8 * TAU * radius;
        let found = flown.iter().map(|(mapped, ..)| {
            let counts = mapped.iter().zip(SPILLS);
            counts.filter(|(count, (_, radius))| is_mapped(**count, *radius)).count() as f64
        });
        expect(format!("p = {p}, patches mapped"), mean(found), least..);
        let ends = percent(&flown, |it| it.1 == Some(StopReason::Closed));
        expect(format!("p = {p}, ended as closed"), ends, 90.0..);
        expect(format!("p = {p}, steps"), mean(flown.iter().map(|it| f64::from(it.2))), ..1_700.0);
    }
}
