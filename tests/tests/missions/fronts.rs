//! Fronts that bend and move: a robot finds one and goes along it.
//!
//! The missions are those of `campaign --fronts`. Each has 2 m motions with a label at the end of each, and begins with
//! four given points about its start. The map is compared with the front as it is then.

use std::fmt::Debug;

use host_sim::campaign::fronts::flight::{Fronts, STEPS, sea, vehicle};
use host_sim::campaign::fronts::following::{Course, Flown, REACH, follow};
use host_sim::campaign::fronts::kinds::KINDS;
use host_sim::campaign::fronts::summary::Row;
use host_sim::campaign::fronts::true_front::{TrueFront, site};
use host_sim::campaign::fronts::who::Who;
use nalgebra::{Point2, Vector2};
use planner_core::dynamics::Dynamics;
use planner_core::watch::Evidence;
use planner_core::{
    AnyVehicle, Area, Belief as _, Front, Heading, Holonomic, Hull, KeepOut, Label, MapPlace,
    Noise, Plan, Planner as _, PolygonArea, Pose, Sample, Site, Track, Unicycle, Workspace,
};
use rand::RngExt as _;
use tests::ensemble::{self, expect, median, percent};
use tests::vehicles::{boat, car};
use tests::{cases, is_long};

/// The length of a mission, in motions and in steps.
const MOTIONS: u32 = STEPS as u32;

fn unicycle() -> Unicycle {
    vehicle(REACH).expect("a vehicle")
}

fn noise(p: f64) -> Noise {
    Noise::new(p).expect("a probability")
}

/// A planner of a still front.
fn planner<D: Dynamics, G: Workspace>((area, dynamics): (G, D), noise: Noise) -> Track<D, G> {
    Track::new(area, dynamics, Front::BENDING, noise).expect("room")
}

/// The distance of the map from the front: median and 95 %, metres; metres driven a metre of front; the share lost.
type Bounds = [f64; 4];

/// The missions of a planner along all kinds of fronts, with its usual motions or shorter ones.
fn fly(who: Who, p: f64, reach: Option<f64>) -> Vec<Row> {
    // Short motions are compared by fewer missions.
    let missions = cases(if reach.is_some() { 3 } else { 6 }, 300);
    let fronts = Fronts { who, missions, seed: 41, p: vec![p], told_speed: 1.0, reach };
    fronts.run().expect("settings of a tracker").rows
}

/// With the bounds of a long run; of a quick one they are loose.
fn check(who: Who, p: f64, bounds: &[Bounds]) {
    let slack = if is_long() { 1.0 } else { 1.4 };
    let mut faults = Vec::new();
    for (it, [median, p95, driven, lost]) in fly(who, p, None).into_iter().zip(bounds) {
        let few = if is_long() { 0.0 } else { 0.1 };
        let within = |number: Option<f64>, most| number.is_some_and(|it| it <= most);
        let is_near = within(it.off_median, slack * median) && within(it.off_p95, slack * p95);
        let is_short = within(it.driven, 1.0 + slack * (driven - 1.0));
        let covers = it.covers.is_some_and(|it| it >= 0.88 - few);
        if !is_near || !is_short || it.lost > lost + few || !covers {
            faults.push(it);
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

/// Told nothing of how a front bends, over all kinds but the saw: its corners come too suddenly.
#[test]
fn a_front_is_mapped_by_one_who_is_told_nothing() {
    let of_circles = [0.004, 0.10, 1.03, 0.0];
    let certain = [
        of_circles,
        of_circles,
        [0.10, 0.30, 1.08, 0.0],
        [0.065, 0.22, 1.05, 0.0],
        [0.025, 0.18, 1.04, 0.0],
        of_circles,
        [0.025, 0.20, 1.04, 0.0],
        [0.10, 0.40, 1.33, 0.0],
    ];
    check(Who::Track, 1.0, &certain);
    let of_circles = [0.05, 0.42, 1.06, 0.0];
    let doubtful = [
        of_circles,
        of_circles,
        [0.26, 1.2, 1.26, 0.01],
        [0.25, 1.2, 1.17, 0.01],
        [0.12, 0.60, 1.07, 0.0],
        of_circles,
        [0.12, 0.60, 1.07, 0.0],
        [0.28, 1.7, 1.60, 0.01],
    ];
    check(Who::Track, 0.9, &doubtful);
}

/// With as many labels and as many metres, the tracker's map is nearer to every kind of front than those of planners
/// without a belief: 95 % of its vertices. It also drives less for a metre of it. All but the saw: with true labels a
/// zigzag turns its corners better.
#[test]
fn steering_without_a_belief_maps_a_front_less_well() {
    for p in [1.0, 0.9] {
        let track = fly(Who::Track, p, Some(1.0));
        for who in [Who::Zigzag, Who::BangBang] {
            for (track, other) in track.iter().take(8).zip(fly(who, p, Some(1.0))) {
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

/// Any vehicle goes along a front in a polygon with keep-outs, one of them on the front.
#[test]
fn any_vehicle_goes_along_a_front_and_keeps_out() {
    for vehicle in [
        AnyVehicle::Unicycle(unicycle()),
        AnyVehicle::Boat(boat(7_000, 0.5, 2_000)),
        AnyVehicle::Car(car(7_000, 3_000, 2_000)),
        AnyVehicle::Car(car(7_000, 5_000, 2_000)),
        AnyVehicle::Car(car(7_000, 8_000, 2_000)),
    ] {
        go_along(&vehicle, 1.0);
        go_along(&vehicle, 0.9);
    }
    go_along(&Holonomic::new(720, 21, 100).expect("a vehicle"), 0.9);
}

fn go_along<D: Dynamics + Clone + Debug + Sync>(dynamics: &D, p: f64) {
    let flown = ensemble::fly(cases(24, 100), |number| along(dynamics.clone(), p, number));
    let what = format!("{dynamics:?}, p = {p}");
    // A car of 8 m among keep-outs loses the front now and then.
    expect(format!("{what}, lost"), percent(&flown, |it| it.is_lost), ..=12.5);
    expect(format!("{what}, followed"), median(flown.iter().map(|it| it.followed)), 200.0..);
}

fn along<D: Dynamics>(dynamics: D, p: f64, number: u64) -> Flown {
    let mut rng = ensemble::rng(42, number);
    let world = TrueFront::circle(40.0, &mut rng);
    let across = -world.place.coords;
    let beside = Vector2::new(-world.place.y, world.place.x) * 1.15;
    let outs = [across, beside].map(|at| KeepOut::disc([at.x, at.y], 4.0).expect("a disc"));
    let corners = [[-60.0, -52.0], [52.0, -60.0], [60.0, 52.0], [-52.0, 60.0]];
    let hull = Hull::metres(&corners).expect("a polygon");
    let area = PolygonArea::<4, 2>::new(hull, &outs).expect("an area");
    let heading = Heading::from_radians(world.angle).expect("an angle");
    let start = Pose { site: site(world.beside(0.0, 2.0)), heading };
    let planner = planner((area, dynamics), noise(p)).knowing(&world.given());
    let course = Course { motions: MOTIONS, steps: 1.0, p };
    follow(&world, planner, (course, start), &mut rng, |_, from, to| {
        assert!(area.contains(to.site) && area.lets_pass(&[from.site, to.site]));
    })
}

/// Cars go all round a bend of five radii of their turning circles and more, and all that they map lies in the area.
#[test]
fn cars_go_round_wide_bends() {
    let area = Area::metres([-28.0; 2], [28.0; 2]).expect("an area");
    for (radius_mm, p, off) in
        [(1_000, 1.0, 0.15), (1_000, 0.9, 0.5), (4_000, 1.0, 0.4), (4_000, 0.9, 0.8)]
    {
        let flown = ensemble::fly(cases(10, 100), |number| {
            let mut rng = ensemble::rng(48, number);
            let world = TrueFront::circle(20.0, &mut rng);
            let planner = planner((area, car(7_000, radius_mm, 2_000)), noise(p));
            let planner = planner.knowing(&world.given()).until_closed();
            let (start, mut found) = (world.start(&mut rng), Vec::new());
            let course = Course { motions: 300, steps: 1.0, p };
            let flown = follow(&world, planner, (course, start), &mut rng, |planner, _, _| {
                for MapPlace { waist, .. } in planner.belief().mapped() {
                    assert!(area.contains(waist.site), "{number}: {waist:?}");
                    let off = world.distance(Point2::from(waist.site), 0.0);
                    found.push((off, off <= waist.half_width(0.9)));
                }
            });
            (flown.closed_after, found)
        });
        let what = format!("a circle of {radius_mm} mm, p {p}");
        let (closed, found): (Vec<_>, Vec<_>) = flown.into_iter().unzip();
        let found = found.concat();
        expect(format!("{what}, closed"), percent(&closed, Option::is_some), 80.0..);
        expect(format!("{what}, covered"), percent(&found, |it| it.1), 85.0..);
        expect(format!("{what}, off"), median(found.iter().map(|it| it.0)), ..off);
    }
}

/// A follower that reads where either label is as likely has to go elsewhere to notice these.
#[test]
fn a_sensor_that_fails_while_a_front_is_followed_raises_an_alarm() {
    for (p, fault, least) in
        [(1.0, 0.5, 80.0), (0.9, 0.5, 25.0), (1.0, 1.0, 95.0), (0.9, 1.0, 40.0)]
    {
        let noticed = ensemble::fly(cases(20, 100), |number| {
            let mut rng = ensemble::rng(49, number);
            let world = TrueFront::circle(40.0, &mut rng);
            let mut planner = planner((sea().expect("an area"), unicycle()), noise(p));
            planner = planner.knowing(&world.given());
            let (mut pose, mut evidence) = (world.start(&mut rng), Evidence::NONE);
            (1..=260).find(|motion| {
                let Plan::Move(next) = planner.plan(pose) else { return false };
                pose = next.target;
                let label = world.sensed(Point2::from(pose.site), 0.0, p, &mut rng);
                let label = if *motion > 60 && rng.random_bool(fault) { -label } else { label };
                if next.wants_label {
                    evidence.observe(label, planner.belief().chance_of(pose.site, label));
                }
                planner.observe(pose, next.wants_label.then(|| label.into())).expect("a label");
                evidence.alarm().is_some_and(|it| it.is_grave())
            })
        });
        let what = format!("p = {p}, of labels {fault} false");
        let before = percent(&noticed, |it| it.is_some_and(|at| at <= 60));
        expect(format!("{what}, alarms before"), before, ..=5.0);
        expect(format!("{what}, noticed"), percent(&noticed, Option::is_some), least..);
    }
}

/// Where a front leaves the area, the robot drives to where it began and goes the other way, up to the border there. It
/// maps no place twice, and ends. A straight front is soon known so exactly that no label tells more, and is followed on
/// all the same.
#[test]
fn it_ends_at_two_borders() {
    ensemble::fly(cases(6, 60), |number| {
        let p = [1.0, 0.9][number as usize % 2];
        for (height, side) in [(2.0, 30.0), (0.0, 80.0)] {
            let mut rng = ensemble::rng(45, number);
            let world = TrueFront::sine(height, 60.0, &mut rng);
            let area = Area::metres([-side, -20.0], [side, 20.0]).expect("an area");
            let planner = planner((area, unicycle()), noise(p)).knowing(&world.given());
            let course = Course { motions: 300, steps: 1.0, p };
            let (start, mut motions) = (world.start(&mut rng), 0);
            let mut map = Vec::new();
            follow(&world, planner.until_closed(), (course, start), &mut rng, |planner, _, _| {
                motions += 1;
                map.extend(
                    planner.belief().mapped().iter().map(|it| Point2::<f64>::from(it.waist.site).x),
                );
            });
            let what = format!("{number}, {height}");
            let [least, most] = [f64::min, f64::max].map(|it| map.iter().copied().reduce(it));
            let ends = [least, most].map(Option::unwrap_or_default);
            assert!(ends[0] < 4.0 - side && ends[1] > side - 4.0, "{what}: {ends:?}");
            expect(format!("{what}, motions"), f64::from(motions), ..3.0 * side);
            expect(format!("{what}, places a metre"), map.len() as f64 / (2.0 * side), 0.7..1.25);
        }
    });
}

/// Readings on the way and positions that err: what is stated still holds. Round a circle, labels that are read close
/// together are off by the same little all the way, and raise no alarm.
#[test]
fn readings_on_the_way_help_and_positions_that_err_are_allowed_for() {
    for (readings, p, deviation) in [
        (1, 0.9, 0.0),
        (4, 0.9, 0.0),
        (10, 0.9, 0.0),
        (50, 0.9, 0.0),
        (5, 1.0, 0.0),
        (20, 1.0, 0.0),
        (50, 1.0, 0.0),
        (1, 0.9, 0.3),
    ] {
        let flown = ensemble::fly(cases(8, 100), |number| {
            let mut rng = ensemble::rng(46, number);
            let world = TrueFront::circle([20.0, 60.0][number as usize % 2], &mut rng);
            let noise = noise(p).with_tolerance(3.0 * deviation).expect("a tolerance");
            let mut planner = planner((sea().expect("an area"), unicycle()), noise);
            planner = planner.knowing(&world.given());
            let (mut pose, mut away, mut found) = (world.start(&mut rng), 0, Vec::new());
            let mut is_alarmed = false;
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
                is_alarmed |= planner.alarm().is_some_and(|it| it.is_grave());
                for MapPlace { waist, .. } in planner.belief().mapped() {
                    let off = world.distance(Point2::from(waist.site), motion.into());
                    found.push((off, off <= waist.half_width(0.9)));
                }
                away = if world.distance(to, motion.into()) > 3.0 * REACH { away + 1 } else { 0 };
            }
            assert!(away <= 10, "{number} is lost");
            (found, is_alarmed)
        });
        let what = format!("{readings} readings, p {p}, {deviation} m");
        expect(format!("{what}, alarms"), percent(&flown, |it| it.1), ..=2.0);
        let found: Vec<_> = flown.into_iter().flat_map(|it| it.0).collect();
        expect(format!("{what}, covered"), percent(&found, |it| it.1), 90.0..);
        let most = if readings > 1 { 0.13 } else { 0.35 };
        expect(format!("{what}, off"), median(found.iter().map(|it| it.0)), ..most);
    }
}

/// From nothing, beside the front; and a spill somewhere in an area, of which one point inside is known to
/// a robot outside. One in twenty may be missed, or lost.
#[test]
fn a_front_is_found_from_nothing_and_by_a_point_inside() {
    for by_a_point in [false, true] {
        let lost = ensemble::fly(cases(20, 200), |number| {
            let mut rng = ensemble::rng(44, number);
            let p = [1.0, 0.9][number as usize % 2];
            let world = TrueFront::circle(40.0, &mut rng);
            let mut known = Vec::new();
            let (area, start) = if by_a_point {
                let [x, z] = [0; 2].map(|_| rng.random_range(-155.0..-45.0));
                let area = Area::metres([x, z], [x + 200.0, z + 200.0]).expect("an area");
                let inside = Sample { site: Site::ORIGIN, label: Label::Positive };
                let mut place = || [x, z].map(|it| it + rng.random_range(1.0..199.0));
                let mut outside = place();
                while libm::hypot(outside[0], outside[1]) < 42.0 {
                    outside = place();
                }
                let start = Pose::at(outside, Heading(0)).expect("a pose");
                known = vec![inside];
                (area, start)
            } else {
                (Area::metres([-60.0; 2], [60.0; 2]).expect("an area"), world.start(&mut rng))
            };
            let planner = planner((area, unicycle()), noise(p)).knowing(&known);
            let course = Course { motions: MOTIONS, steps: 1.0, p };
            let flown = follow(&world, planner, (course, start), &mut rng, |_, _, _| ());
            flown.is_lost || flown.followed < 60.0
        });
        expect(format!("lost, by a point {by_a_point}"), percent(&lost, |it| *it), ..=5.0);
    }
}

/// A mission depends on its number and the seed alone.
#[test]
fn missions_along_fronts_depend_on_seed_and_number_alone() {
    let of = |seed, missions, number| {
        let (who, p, told_speed) = (Who::Track, vec![0.9], 1.0);
        let fronts = Fronts { who, missions, seed, p, told_speed, reach: None };
        fronts.mission(&KINDS[3], 0.9, number).expect("a mission")
    };
    assert_eq!(of(7, 3, 1), of(7, 2, 1));
    assert!(of(7, 3, 0) != of(7, 3, 1) && of(7, 1, 0) != of(8, 1, 0));
}
