//! Lakes and reservoirs as maps have them (Natural Earth, scaled to a kilometre): concave, with islands. Motions stay in the
//! water, by the harness's own geometry, and missions go on to an end that is true.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use host_sim::mission::definition::Mission;
use host_sim::mission::scenario::{self, Overrides};
use nalgebra::Point2;
use planner_core::Site;
use planner_core::lattice::UNITS_PER_METRE;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::anything::flight::{Finding, fly};
use tests::{cases, seed};

const LAKES: [&str; 10] = [
    "atlin",
    "bieler",
    "catemaco",
    "harrison",
    "kyyvesi",
    "lac-la-croix",
    "loups-marins",
    "manych-gudilo",
    "ootsa",
    "stony",
];

const VEHICLES: [&str; 3] = [
    r#"{ kind = "unicycle", reach = 10.0, step = 0.5 }"#,
    r#"{ kind = "boat", reach = 10.0, step = 0.5, sharpest = 0.5 }"#,
    r#"{ kind = "car", reach = 10.0, step = 0.5, radius = 4.0 }"#,
];

/// Who plans, and what there is to find.
const TASKS: [(&str, &str); 4] =
    [("lookahead", "line"), ("lookahead", "noise"), ("track", "circle"), ("track", "noise")];

/// A scenario in a lake: a line or a spill somewhere in it, and a start on the water.
fn scenario(number: u64) -> String {
    let lake = LAKES[(number % 10) as usize];
    let vehicle = VEHICLES[((number / 10 + number) % 3) as usize];
    let (algorithm, what) = TASKS[(number / 10 % 4) as usize];
    let mut rng = ChaCha8Rng::seed_from_u64(seed(52) + number);
    let mut text = format!(
        "algorithm = \"{algorithm}\"\nsteps = 200\nseed = {number}\narea = {{ geojson = \"{lake}.geojson\" }}\n\
         vehicle = {vehicle}\noracle = []\n"
    );
    if what == "noise" {
        text += "noise = { p = 0.9, trusted_radius = 0.0 }\n";
        text = text.replace("steps = 200", "steps = 60");
    }
    // Every second robot does not know quite where it is.
    if number % 2 == 1 {
        text += "errors = { position = 0.3 }\n";
    }
    let (sin, cos) = rng.random_range(0.0..std::f64::consts::TAU).sin_cos();
    let [x, z] = [0, 1].map(|_| rng.random_range(-150.0..150.0));
    let _ = match algorithm {
        "track" => writeln!(text, "truth = {{ circle = [{x}, {z}, 80.0] }}"),
        _ => writeln!(text, "truth = {{ line = [{sin}, {cos}, {}] }}", -sin * x - cos * z),
    };
    text
}

/// The mission of a scenario, from a start on the water that is drawn.
fn mission(number: u64) -> Mission {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenarios/lakes");
    let text = scenario(number);
    // The start is put in place of one that is anywhere on the water.
    let parse = |start: &str| {
        scenario::parse_in("lake", &format!("{text}{start}"), &folder, Overrides::default())
    };
    let mut rng = ChaCha8Rng::seed_from_u64(seed(53) + number);
    for _ in 0..1_000 {
        let [lat, lon] =
            [60.2 + rng.random_range(-0.0045..0.0045), 24.9 + rng.random_range(-0.009..0.009)];
        if let Ok(mission) = parse(&format!("start = {{ lat = {lat}, lon = {lon} }}\n")) {
            return mission;
        }
    }
    panic!(
        "no start on the water: {:?}",
        parse("start = { lat = 60.2, lon = 24.9 }\n").map(|_| ())
    );
}

#[test]
fn no_motion_leaves_the_water() {
    let mut ends = BTreeMap::new();
    for number in 0..cases(40, 4_000) {
        let mission = mission(number);
        let flight = fly(&mission, mission.vehicle, u64::MAX);
        let told = format!("{:?}", flight.ending);
        *ends.entry((TASKS[(number / 10 % 4) as usize], told)).or_insert(0) += 1;
        let broken = flight.findings.iter().filter(|it| it.0 != Finding::TooLong);
        assert_eq!(broken.count(), 0, "{number}: {flight:?}\n{}", scenario(number));
    }
    println!("{ends:#?}");
}

/// The cells cover most of the water. The narrowest, a reservoir of long arms, loses a quarter.
#[test]
fn little_of_the_water_is_lost() {
    for (number, name) in (0..).zip(LAKES) {
        let mission = mission(number);
        let lake = mission.lake.expect("a lake");
        assert!(lake.lost[0] < 0.25 && lake.lost[1] < 0.05, "{}", lake.words());
        let side = f64::from(lake.chart.side()) / f64::from(UNITS_PER_METRE);
        let [columns, rows] = lake.chart.size();
        let mut open = 0;
        for cell in (0..columns).flat_map(|x| (0..rows).map(move |z| [x, z])) {
            open += u32::from(lake.chart.is_open(cell));
        }
        let water = f64::from(open) * side * side / lake.ground;
        assert!((water - (1.0 - lake.lost[0] - lake.lost[1])).abs() < 1e-6, "{name}");
        println!("{}", lake.words());
    }
}

/// Positions come back from the lattice to within a centimetre, across the date line too.
#[test]
fn a_map_is_brought_there_and_back() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenarios/lakes");
    let text = std::fs::read_to_string(folder.join("stony.geojson")).expect("a lake");
    let scratch = tempfile::tempdir().expect("a folder");
    for (lat, lon) in [(60.2, 24.9), (-45.0, 180.0), (0.0, -180.0), (78.0, 179.999)] {
        // The lake is moved in degrees.
        let mut map: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let polygons = map["features"][0]["geometry"]["coordinates"].as_array_mut().expect("some");
        for at in polygons
            .iter_mut()
            .flat_map(|it| it.as_array_mut().expect("rings"))
            .flat_map(|it| it.as_array_mut().expect("corners"))
        {
            let [x, z] = [0, 1].map(|k| at[k].as_f64().expect("a number"));
            let east = x - 24.9 + lon;
            let east = if east > 180.0 { east - 360.0 } else { east };
            *at = serde_json::json!([east, z - 60.2 + lat]);
        }
        std::fs::write(scratch.path().join("lake.geojson"), map.to_string()).expect("written");
        let text = "area = { geojson = \"lake.geojson\" }\noracle = []\ntruth = { slope = 0.0, intercept = 0.0 }\n";
        let at = |start: String| {
            scenario::parse_in(
                "lake",
                &(text.to_owned() + &start),
                scratch.path(),
                Overrides::default(),
            )
        };
        let (mut near, mut tried) = (0, 0);
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        while near < 20 && tried < 10_000 {
            tried += 1;
            let [north, east] =
                [lat + rng.random_range(-0.004..0.004), lon + rng.random_range(-0.008..0.008)];
            let Ok(mission) = at(format!("start = {{ lat = {north}, lon = {east} }}\n")) else {
                continue;
            };
            let lake = mission.lake.expect("a lake");
            let [back_lon, back_lat] =
                lake.frame.degrees(Point2::from(mission.start.site)).expect("degrees");
            let turn = (back_lon - east + 540.0).rem_euclid(360.0) - 180.0;
            let off = [(back_lat - north) * 111_320.0, turn * 111_320.0 * lat.to_radians().cos()];
            assert!(off[0].hypot(off[1]) < 0.01, "{north}, {east}: {back_lat}, {back_lon}");
            // Degrees have nine digits behind the point.
            let back: Site = lake.frame.site([back_lat, back_lon]).expect("near");
            let [p, q] = [back, mission.start.site].map(Point2::<f64>::from);
            assert!((p - q).norm() < 2e-4, "{back:?}");
            near += 1;
        }
        assert_eq!(near, 20, "{lat}, {lon}");
    }
}
