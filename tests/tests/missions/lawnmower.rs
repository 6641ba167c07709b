//! The lawnmower's survey beside a twin that knows where labels were read, and nothing else.
//!
//! The twin looks for a survey of so many tracks that has its labels there. It counts motions by the lengths of legs.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::definition::Mission;
use host_sim::mission::results::Ending;
use host_sim::mission::scenario::{self, Overrides};
use nalgebra::{Point2, distance};
use planner_core::{AnyVehicle, Unicycle, Workspace as _};
use rand::RngExt as _;
use tests::{cases, ensemble};

/// The seed of what is drawn here.
const SEED: u64 = 26;

/// A mission in a rectangle whose tracks have room for all labels.
#[derive(Debug)]
struct Drawn {
    mission: Mission,
    sides: [f64; 2],
    reach: f64,
    labels: u32,
}

fn drawn(number: u64) -> Drawn {
    let mut rng = ensemble::rng(SEED, number);
    let speeds = rng.random_range(11..=61);
    let reach = f64::from(speeds - 1) / 10.0;
    let sides = [0; 2].map(|_| (reach * rng.random_range(20.0..60.0)).round());
    let (steps, labels) = (rng.random_range(30..400), rng.random_range(2..=20));
    let mut mission = standard_field::stretched(sides, SEED, number, Algorithm::Lawnmower, steps);
    mission.asking = Asking { labels: Some(labels), ..Asking::USUAL };
    let turn_step = if number.is_multiple_of(2) { 1 } else { 10_000 };
    let unicycle = Unicycle::new(turn_step, std::f64::consts::FRAC_PI_2, speeds, 100);
    mission.vehicle = AnyVehicle::Unicycle(unicycle.expect("a vehicle"));
    Drawn { mission, sides, reach, labels }
}

/// Where labels were read, and why the mission ended. No motion leaves the area.
fn flown(mission: &Mission) -> (Vec<Point2<f64>>, Ending) {
    let (area, mut read, mut asked) = (mission.config.area, Vec::new(), 0);
    let flown = mission.fly(|step, _| {
        assert!(area.contains(step.pose.site), "{:?}", step.motion);
        asked += u32::from(step.motion.wants_label);
        read.extend(step.reading.map(|_| Point2::from(step.pose.site)));
    });
    let ending = flown.expect("labels are true").ending;
    assert!(mission.asking.labels.is_none_or(|most| asked <= most), "{asked} labels");
    (read, ending)
}

/// The places of a survey with so many tracks, along x or z, from the corner with this number.
fn survey(drawn: &Drawn, (tracks, axis): (u32, usize), corner: u32) -> Vec<Point2<f64>> {
    let (long, short) = (drawn.sides[axis], drawn.sides[1 - axis]);
    let mut places = Vec::new();
    for track in 0..tracks {
        let count = drawn.labels / tracks + u32::from(track < drawn.labels % tracks);
        let apart = long / f64::from(count);
        let mut on_track: Vec<_> = (0..count).map(|k| apart * (0.5 + f64::from(k))).collect();
        if (track + corner) % 2 == 1 {
            on_track.reverse();
        }
        let across = short * (0.5 + f64::from(track)) / f64::from(tracks);
        let across = if corner < 2 { across } else { short - across };
        for along in on_track {
            places.push(if axis == 0 {
                Point2::new(along, across)
            } else {
                Point2::new(across, along)
            });
        }
    }
    places
}

/// All surveys, by tracks and axis, whose first labels are at these places, as nearly as motions end.
fn found(drawn: &Drawn, read: &[Point2<f64>]) -> Vec<(u32, usize)> {
    let near = 0.15 + 0.006 * drawn.reach;
    let is_there = |of: &(u32, usize)| {
        (0..4).any(|corner| {
            let places = survey(drawn, *of, corner);
            read.iter().zip(&places).all(|(read, place)| distance(read, place) < near)
        })
    };
    (1..=drawn.labels).flat_map(|tracks| [(tracks, 0), (tracks, 1)]).filter(is_there).collect()
}

/// How far a label's cell is from a square.
fn skew(drawn: &Drawn, (tracks, axis): (u32, usize)) -> f64 {
    let along = drawn.sides[axis] * f64::from(tracks) / f64::from(drawn.labels);
    let across = drawn.sides[1 - axis] / f64::from(tracks);
    (along / across).ln().abs()
}

/// Motions that a survey takes at most: so many on each leg with a turn, and two turns at the start.
fn motions_at_most(drawn: &Drawn, of: (u32, usize)) -> u32 {
    let start = Point2::from(drawn.mission.start.site);
    let surveys = (0..4).map(|corner| survey(drawn, of, corner));
    let nearest = surveys.min_by(|a, b| {
        let [a, b] = [a, b].map(|it| distance(&start, &it[0]));
        a.total_cmp(&b)
    });
    let places = nearest.expect("four corners");
    let from = [start].into_iter().chain(places.clone());
    let legs = from.zip(&places).map(|(a, b)| (distance(&a, b) / drawn.reach).ceil() as u32 + 1);
    legs.sum::<u32>() + 2
}

#[test]
fn its_labels_lie_in_cells_as_square_as_the_motions_allow() {
    let (mut several, mut held_back) = (0, 0);
    for number in 0..cases(60, 2_000) {
        let drawn = drawn(number);
        let whole = format!("seed {SEED}, field {number}: {drawn:?}");
        let (read, ending) = flown(&drawn.mission);
        let is_whole = read.len() == drawn.labels as usize;
        assert!(is_whole || ending == Ending::Steps, "{ending:?}, {whole}");
        let found = found(&drawn, &read);
        // A survey of one track may be too long for the mission, and no other is.
        let flown = found.iter().find(|(tracks, _)| is_whole || *tracks == 1);
        let &flown = flown.unwrap_or_else(|| panic!("{found:?}: {read:?}, {whole}"));
        let all = (1..=drawn.labels).flat_map(|tracks| [(tracks, 0), (tracks, 1)]);
        let squarer = all.filter(|of| skew(&drawn, *of) < skew(&drawn, flown) - 1e-9);
        for of in squarer.clone() {
            // Surveys with more tracks than square cells take are not driven.
            let [x, z] = drawn.sides;
            let ratio = if of.1 == 0 { z / x } else { x / z };
            let most = (f64::from(drawn.labels) * ratio).sqrt().round().max(1.0);
            let fits = motions_at_most(&drawn, of) <= drawn.mission.steps;
            assert!(!fits || f64::from(of.0) > most, "{flown:?} and not {of:?}, {whole}");
        }
        held_back += u32::from(squarer.count() > 1);
        several += u32::from(flown.0 > 1);
    }
    assert!(several > 20 && held_back > 5, "{several}, {held_back}");
}

/// Without a limit on labels each motion has one. Where the survey is over, the robot drives it back.
#[test]
fn without_a_limit_it_reads_a_label_after_each_motion() {
    for number in 0..cases(20, 400) {
        let mission = standard_field::standard(SEED, number, Algorithm::Lawnmower, 300);
        let (read, ending) = flown(&mission);
        assert_eq!((read.len(), ending), (300, Ending::Steps), "seed {SEED}, field {number}");
        let spread = |of: fn(&Point2<f64>) -> f64| {
            let all = read.iter().map(of);
            all.clone().fold(0.0, f64::max) - all.fold(f64::INFINITY, f64::min)
        };
        let all_over = spread(|it| it.x) > 15.0 && spread(|it| it.y) > 15.0;
        assert!(all_over, "seed {SEED}, field {number}");
    }
}

/// Its tracks go straight across, so it refuses what is in their way.
#[test]
fn it_refuses_areas_that_are_not_plain_rectangles() {
    let scenario = include_str!("../../../host-sim/scenarios/begin-line.toml");
    let asked = Overrides { algorithm: Some(Algorithm::Lawnmower), ..Overrides::default() };
    assert!(scenario::parse("m.toml", scenario, asked).is_ok());
    let area = "area = { x = [0.0, 20.0], z = [0.0, 20.0] }";
    for (found, by) in [
        (format!("{area}\nkeep_out = [{{ x = 5.0, z = 6.0, radius = 1.0 }}]"), "keep_out: found"),
        ("area = { polygon = [[0, 0], [20, 0], [20, 18], [0, 20]] }".to_owned(), "area: found"),
    ] {
        let scenario = scenario.replace(area, &found);
        let error = scenario::parse("m.toml", &scenario, asked).expect_err("it cannot").to_string();
        let none = "expected none with algorithm lawnmower";
        assert!(error.contains(&format!(": {by}")) && error.contains(none), "{error}");
    }
}
