//! Fronts that bend and move: a robot finds one and goes along it.
//!
//! The missions are those of `campaign --fronts`. Each has 2 m motions with a label at the end of each, and begins with
//! four given points about its start. The map is the waist after each motion. It is compared with the front as it is then.

use host_sim::campaign::fronts::flight::{Fronts, STEPS, sea, tracker, vehicle};
use host_sim::campaign::fronts::following::{Course, REACH, follow};
use host_sim::campaign::fronts::kinds::{KINDS, Told};
use host_sim::campaign::fronts::summary::Row;
use host_sim::campaign::fronts::true_front::{TrueFront, site};
use host_sim::campaign::fronts::who::Who;
use nalgebra::{Point2, Vector2};
use planner_core::dynamics::Dynamics;
use planner_core::motion::car;
use planner_core::planner::scout::LOOKED_AT;
use planner_core::{
    AnyReliability, AnyVehicle, Area, Boat, Car, Front, Heading, Holonomic, Hull, KeepOut, Label,
    Noise, Persist as _, Plan, Planner as _, PolygonArea, Pose, Sample, Site, Track, Tracker,
    Unicycle, Workspace as _,
};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use tests::{cases, is_long};

/// The length of a mission, in motions and in steps.
const MOTIONS: u32 = STEPS as u32;

fn course(p: f64) -> Course {
    Course { motions: MOTIONS, steps: 1.0, p }
}

fn front(radius: f64) -> Front {
    Front::bending(radius).expect("a front")
}

fn unicycle() -> Unicycle {
    vehicle(REACH).expect("a vehicle")
}

fn open_sea() -> Area {
    sea().expect("an area")
}

fn noise(p: f64) -> Noise {
    Noise::new(p).expect("a probability")
}

/// The usual tracker, told of a still front.
fn told(
    front: &TrueFront,
    radius: f64,
    noise: impl Into<Noise<AnyReliability>>,
) -> Tracker<16, 16, 3> {
    tracker(front, Told { radius, speed: 0.0 }, noise).expect("a front")
}

/// The distance of the map from the front: median and 95 %, metres; metres driven a metre of front; the share lost.
type Bounds = [f64; 4];

/// The missions of a planner along all kinds of fronts, with its usual motions or shorter ones.
fn fly(who: Who, p: f64, reach: Option<f64>) -> Vec<Row> {
    let (missions, seed) = (cases(10, 300), 41);
    let fronts = Fronts { who, missions, seed, p: vec![p], told: [1.0; 2], reach };
    let rows = fronts.run().expect("settings of a tracker").rows;
    for row in &rows {
        println!("{who:?}, {missions} missions, seed {seed}: {row:.3?}");
    }
    rows
}

/// With the bounds of a long run; of a quick one they are loose.
fn check(p: f64, bounds: [Bounds; 6]) {
    let slack = if is_long() { 1.0 } else { 1.4 };
    let mut faults = Vec::new();
    for (it, [median, p95, driven, lost]) in fly(Who::Track, p, None).into_iter().zip(bounds) {
        let few = if is_long() { 0.0 } else { 0.1 };
        let within = |number: Option<f64>, most| number.is_some_and(|it| it <= most);
        let is_near = within(it.off_median, slack * median) && within(it.off_p95, slack * p95);
        let is_short = within(it.driven, 1.0 + slack * (driven - 1.0));
        let covers = it.covers.is_some_and(|it| it >= 0.93 - few);
        if !is_near || !is_short || it.lost > lost + few || !covers {
            faults.push(it);
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

#[test]
fn true_labels_map_a_front() {
    let bounds = [
        [0.045, 0.14, 1.02, 0.0],
        [0.01, 0.09, 1.02, 0.0],
        [0.065, 0.20, 1.04, 0.0],
        [0.14, 0.41, 1.09, 0.0],
        [0.07, 0.29, 1.04, 0.005],
        [0.04, 0.13, 1.02, 0.0],
    ];
    check(1.0, bounds);
}

#[test]
fn labels_that_are_sometimes_wrong_map_a_front() {
    let bounds = [
        [0.20, 0.78, 1.07, 0.0],
        [0.07, 0.46, 1.03, 0.0],
        [0.22, 0.97, 1.09, 0.0],
        [0.28, 1.2, 1.26, 0.005],
        [0.28, 1.3, 1.14, 0.01],
        [0.105, 0.53, 1.035, 0.0],
    ];
    check(0.9, bounds);
}

/// With as many labels and as many metres, the tracker's map is nearer to every kind of front than those of planners
/// without a belief: 95 % of its vertices. It also drives less for a metre of it.
#[test]
fn steering_without_a_belief_maps_a_front_less_well() {
    for p in [1.0, 0.9] {
        let track = fly(Who::Track, p, Some(1.0));
        for who in [Who::Zigzag, Who::BangBang] {
            for (track, other) in track.iter().zip(fly(who, p, Some(1.0))) {
                let is_nearer = track.off_p95 < other.off_p95;
                let is_shorter = track.driven < other.driven || track.front.starts_with("sine");
                let is_alike = (track.labels - other.labels).abs() < 4.0;
                assert!(is_nearer && is_shorter && is_alike, "{who:?}: {track:?} {other:?}");
                assert!(other.covers.is_none() && other.began_again == 0.0, "{who:?}: {other:?}");
                // True labels never mislead a zigzag that turns on where the front bends away.
                assert!(p < 1.0 || other.lost == 0.0, "{who:?}: {other:?}");
            }
        }
    }
}

/// A mission depends on its number and the seed alone.
#[test]
fn missions_along_fronts_depend_on_seed_and_number_alone() {
    let kind = &KINDS[4];
    let of = |seed, missions| {
        let told = [1.0; 2];
        let fronts = Fronts { who: Who::Track, missions, seed, p: vec![0.9], told, reach: None };
        (0..missions).map(|n| fronts.mission(kind, 0.9, n).expect("a mission")).collect::<Vec<_>>()
    };
    let whole = of(7, 3);
    assert_eq!(whole[..2], of(7, 2)[..]);
    assert_ne!(whole[0], whole[1]);
    assert_ne!(whole[0], of(8, 1)[0]);
}

/// Any vehicle goes along a front in a polygon with keep-outs: it stays inside, keeps out, and its plans are bounded
/// and the same each time, also after a sleep.
#[test]
fn any_vehicle_goes_along_a_front_and_keeps_out() {
    let car = |radius_mm| {
        let shape = car::Shape {
            radius_mm,
            shortest_mm: 500,
            turn_step_urad: 7_000,
            speeds: 21,
            speed_step_mm: 100,
        };
        AnyVehicle::Car(Car::new(shape).expect("a car"))
    };
    let boat = Unicycle::new(7_000, 0.5, 21, 100).and_then(Boat::new);
    let vehicles = [
        AnyVehicle::Unicycle(unicycle()),
        AnyVehicle::Boat(boat.expect("a boat")),
        car(3_000),
        car(5_000),
        car(8_000),
    ];
    for (number, vehicle) in (0..).zip(vehicles) {
        for p in [1.0, 0.9] {
            go_along(vehicle, p, number);
        }
    }
    let holonomic = Holonomic::new(720, 21, 100).expect("a vehicle");
    go_along(holonomic, 0.9, 5);
}

fn go_along<D: Dynamics + Clone>(dynamics: D, p: f64, number: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(42);
    rng.set_stream(number);
    let world = TrueFront::circle(40.0, &mut rng);
    // One keep-out on the front, one beside it.
    let across = -world.place.coords;
    let beside = Vector2::new(-world.place.y, world.place.x) * 1.15;
    let outs = [across, beside].map(|at| {
        let middle = Hull::metres(&[Point2::from(at)]).expect("a point");
        KeepOut::new(middle, 4.0).expect("a disc")
    });
    let corners = [[-60.0, -52.0], [52.0, -60.0], [60.0, 52.0], [-52.0, 60.0]];
    let hull = Hull::metres(&corners).expect("a polygon");
    let area = PolygonArea::<4, 2>::new(hull, &outs).expect("an area");
    let tracker = told(&world, 40.0, noise(p));
    let planner = Track::new(area, dynamics, tracker).expect("room");
    let mut fresh = planner.clone();
    let heading = Heading::from_radians(world.angle).expect("an angle");
    let start = Pose { site: site(world.beside(0.0, 2.0)), heading };
    let mut most = 0;
    let flown = follow(&world, planner, (course(p), start), &mut rng, |planner, from, to| {
        let plan = planner.plan(from);
        assert_eq!(plan, planner.plan(from), "{number}");
        fresh.restore(&planner.snapshot()).expect("its own snapshot");
        assert_eq!(plan, fresh.plan(from), "{number}");
        let Plan::Move(motion) = plan else { panic!("a motion") };
        most = most.max(motion.examined);
        assert!(area.contains(to.site) && area.lets_pass(&[from.site, to.site]), "{number}");
    });
    let followed = flown.followed;
    println!("vehicle {number}, p {p}: {followed:.0} m of 251 in {MOTIONS} motions, {most} looks");
    assert!(!flown.is_lost && most <= LOOKED_AT, "{number}, {p}");
    assert!(followed > 140.0, "vehicle {number}, p {p}: {followed}");
}

#[test]
fn a_closed_front_is_noticed() {
    let mut rng = ChaCha8Rng::seed_from_u64(43);
    for number in 0..cases(8, 60) {
        let world = TrueFront::circle(20.0, &mut rng);
        let planner = Track::new(open_sea(), unicycle(), told(&world, 20.0, noise(1.0)));
        let start = world.start(&mut rng);
        let flown =
            follow(&world, planner.expect("room"), (course(1.0), start), &mut rng, |_, _, _| ());
        let after = flown.closed_after.expect("a whole round");
        // The circle is 126 m long.
        assert!((110.0..160.0).contains(&after), "{number}: {after}");
    }
}

/// Where a front leaves the area, the robot goes back along it.
#[test]
fn at_the_border_it_turns_round() {
    let mut rng = ChaCha8Rng::seed_from_u64(45);
    for number in 0..cases(6, 60) {
        let p = [1.0, 0.9][number as usize % 2];
        let world = TrueFront::sine(2.0, 60.0, &mut rng);
        let area = Area::metres([-30.0, -20.0], [30.0, 20.0]).expect("an area");
        let tracker = told(&world, 30.0, noise(p));
        let planner = Track::new(area, unicycle(), tracker).expect("room");
        let start = world.start(&mut rng);
        let (mut least, mut most) = (0, 0);
        let flown = follow(&world, planner, (course(p), start), &mut rng, |_, _, to| {
            assert!(area.contains(to.site));
            (least, most) = (least.min(to.site.x()), most.max(to.site.x()));
        });
        let [least, most] = [least, most].map(|it| f64::from(it) / 65_536.0);
        assert!(!flown.is_lost && flown.driven > 150.0, "{number}: {} m", flown.driven);
        assert!(least < -24.0 && most > 24.0, "{number}: from {least} to {most}");
    }
}

/// A straight front is soon known so exactly that no label tells more. The robot goes on along it all the same, up to the
/// border and back.
#[test]
fn a_front_that_is_known_exactly_is_followed_on() {
    let area = Area::metres([-8.0, -30.0], [152.0, 30.0]).expect("an area");
    for (number, p) in (0..cases(6, 60)).zip([1.0, 0.9].into_iter().cycle()) {
        let mut rng = ChaCha8Rng::seed_from_u64(47);
        rng.set_stream(number);
        let world = TrueFront::sine(0.0, 60.0, &mut rng);
        let tracker = Tracker::new(area, Front::STRAIGHT, noise(p)).given(&world.given());
        let planner: Track<_, 16, 16, 3> = Track::new(area, unicycle(), tracker).expect("room");
        let start = world.start(&mut rng);
        let flown = follow(&world, planner, (course(p), start), &mut rng, |_, _, _| ());
        // Most motions are of 2 m.
        assert!(!flown.is_lost && flown.driven > 1.5 * f64::from(MOTIONS), "{number}: {flown:?}");
    }
}

/// Told that a coast is straight, the robot loses it again and again. It seeks it all over the area before it ends with
/// "all of one label", and finds it.
#[test]
fn a_front_that_was_known_is_sought_until_the_end() {
    for number in 0..cases(15, 100) {
        let mut rng = ChaCha8Rng::seed_from_u64(48);
        rng.set_stream(number);
        let world = TrueFront::coast([6.0, 25.0], &mut rng);
        let area = Area::metres([-80.0, -30.0], [80.0, 30.0]).expect("an area");
        let tracker = Tracker::new(area, Front::bending(1e6).expect("a front"), noise(0.9));
        let tracker = tracker.given(&world.given());
        let planner: Track<_, 16, 16, 3> = Track::new(area, unicycle(), tracker).expect("room");
        let (start, course) = (world.start(&mut rng), Course { motions: 300, ..course(0.9) });
        let mut motions = 0;
        follow(&world, planner, (course, start), &mut rng, |_, _, _| motions += 1);
        assert_eq!(motions, 300, "{number}");
    }
}

/// Readings on the way and positions that err: what is stated still holds.
#[test]
fn readings_on_the_way_help_and_positions_that_err_are_allowed_for() {
    for (readings, p, deviation) in [
        (1, 0.9, 0.0),
        (4, 0.9, 0.0),
        (10, 0.9, 0.0),
        (50, 0.9, 0.0),
        (10, 1.0, 0.0),
        (50, 1.0, 0.0),
        (1, 0.9, 0.3),
    ] {
        let (mut errors, mut covered, mut lost) = (Vec::new(), 0, 0);
        for number in 0..cases(8, 100) {
            let mut rng = ChaCha8Rng::seed_from_u64(46);
            rng.set_stream(number);
            let world = TrueFront::circle(60.0, &mut rng);
            let noise = noise(p).with_tolerance(3.0 * deviation).expect("a tolerance");
            let tracker = told(&world, 60.0, noise);
            let mut planner = Track::new(open_sea(), unicycle(), tracker).expect("room");
            let mut pose = world.start(&mut rng);
            let mut away = 0;
            for motion in 1..=100 {
                let Plan::Move(next) = planner.plan(pose) else { panic!("a motion") };
                let [from, to] = [pose, next.target].map(|it| Point2::<f64>::from(it.site));
                for k in 1..readings {
                    let at = from + (to - from) * (f64::from(k) / f64::from(readings));
                    let label = world.sensed(at, motion.into(), p, &mut rng);
                    let kept = planner.observe_on_the_way(site(at), label.into());
                    kept.expect("any label is taken in");
                }
                let mut error = || deviation * (1.5 * rng.random_range(-1.0..1.0_f64));
                let truth = to + Vector2::new(error(), error());
                pose = next.target;
                let label = world.sensed(truth, motion.into(), p, &mut rng);
                let reading = next.wants_label.then(|| label.into());
                planner.observe(pose, reading).expect("any label is taken in");
                if let Some(waist) = planner.found() {
                    let off = world.distance(Point2::from(waist.site), motion.into());
                    covered += usize::from(off <= waist.half_width(0.9));
                    errors.push(off);
                }
                away = if world.distance(to, motion.into()) > 3.0 * REACH { away + 1 } else { 0 };
            }
            lost += u32::from(away > 10);
        }
        errors.sort_by(f64::total_cmp);
        let (median, covers) = (errors[errors.len() / 2], covered as f64 / errors.len() as f64);
        let what = format!("{readings} readings, p {p}, {deviation} m");
        println!("{what}: {median:.3} m off, {covers:.3}, {lost} lost");
        assert!(lost == 0 && covers > 0.9, "{what}");
        let most = if readings > 1 { 0.13 } else { 0.35 };
        assert!(median < most, "{what}: {median}");
    }
}

/// From nothing, in an area of 250 reaches, beside a front: the middle of the area is no place to lay a grid about.
#[test]
fn a_front_beside_the_start_is_found_in_a_large_area() {
    let area = Area::metres([-200.0, -200.0], [300.0, 300.0]).expect("an area");
    for (p, most) in [(1.0, 30), (0.9, 70)] {
        let (mut steps, mut alarms) = (Vec::new(), 0);
        for number in 0..20 {
            let mut rng = ChaCha8Rng::seed_from_u64(61);
            rng.set_stream(number);
            let world = TrueFront::circle(120.0, &mut rng);
            let tracker = Tracker::<16, 16, 3>::new(area, front(100.0), noise(p));
            let mut planner = Track::new(area, unicycle(), tracker).expect("room");
            let mut pose = Pose { site: site(world.beside(0.0, 2.0)), heading: Heading(0) };
            let (mut found, mut is_alarmed) = (None, false);
            for step in 1..=120 {
                let Plan::Move(next) = planner.plan(pose) else { break };
                pose = next.target;
                let label = world.sensed(Point2::from(pose.site), 0.0, p, &mut rng);
                planner.observe(pose, next.wants_label.then(|| label.into())).expect("a label");
                is_alarmed |= planner.alarm().is_some();
                if planner.found().is_some() {
                    found = Some(step);
                    break;
                }
            }
            steps.push(found.unwrap_or(u32::MAX));
            alarms += u32::from(is_alarmed);
        }
        steps.sort_unstable();
        println!("p {p}: found after {steps:?}, {alarms} alarms");
        assert!(steps[10] < most, "{p}: {steps:?}");
    }
}

/// From nothing but a box that the front crosses.
#[test]
fn a_front_is_found_from_nothing() {
    let mut rng = ChaCha8Rng::seed_from_u64(44);
    let (mut lost, missions) = (0, cases(16, 200));
    for number in 0..missions {
        let p = [1.0, 0.9][number as usize % 2];
        let world = TrueFront::circle(40.0, &mut rng);
        let [x, z] = world.beside(3.0, 4.0).into();
        let around = Area::metres([x - 10.0, z - 10.0], [x + 10.0, z + 10.0]).expect("an area");
        let tracker = Tracker::<16, 16, 3>::new(around, front(30.0), noise(p));
        let field = Area::metres([-60.0, -60.0], [60.0, 60.0]).expect("an area");
        let planner = Track::new(field, unicycle(), tracker).expect("room");
        let start = world.start(&mut rng);
        let flown = follow(&world, planner, (course(p), start), &mut rng, |_, _, _| ());
        lost += u64::from(flown.is_lost || flown.followed < 60.0);
    }
    println!("{lost} of {missions} are not found, or lost");
    assert!(lost * 20 <= missions, "{lost} of {missions}");
}

/// A spill somewhere in an area, and a robot outside it: one point inside is all that is known.
#[test]
fn a_spill_is_found_by_a_point_inside() {
    let mut rng = ChaCha8Rng::seed_from_u64(47);
    let (mut lost, missions) = (0, cases(20, 200));
    for number in 0..missions {
        let p = [1.0, 0.9][number as usize % 2];
        let world = TrueFront::circle(40.0, &mut rng);
        let [x, z] = [0; 2].map(|_| rng.random_range(-155.0..-45.0));
        let area = Area::metres([x, z], [x + 200.0, z + 200.0]).expect("an area");
        let inside = Sample { site: Site::ORIGIN, label: Label::Positive };
        let tracker = Tracker::<16, 16, 3>::new(area, front(40.0), noise(p)).given(&[inside]);
        let planner = Track::new(area, unicycle(), tracker).expect("room");
        let mut place = || [x, z].map(|it| it + rng.random_range(1.0..199.0));
        let mut outside = place();
        while libm::hypot(outside[0], outside[1]) < 42.0 {
            outside = place();
        }
        let start = Pose::at(outside, Heading(0)).expect("a pose");
        let flown = follow(&world, planner, (course(p), start), &mut rng, |_, _, _| ());
        lost += u64::from(flown.is_lost || flown.followed < 60.0);
    }
    println!("{lost} of {missions} are not found, or lost");
    assert!(lost * 20 <= missions, "{lost} of {missions}");
}
