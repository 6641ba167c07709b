//! Lakes and reservoirs as maps have them (Natural Earth, scaled to a kilometre): concave, with islands. Motions stay in the
//! water, by the harness's own geometry, and missions go on to an end that is true.

use std::collections::BTreeMap;

use host_sim::mission::scenario::{self, Overrides};
use nalgebra::Point2;
use planner_core::Site;
use planner_core::lattice::UNITS_PER_METRE;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::anything::flight::{Finding, fly};
use tests::cases;
use tests::lakes::{LAKES, folder, mission, scenario, task};

/// Cells along the longer side of a lake.
const CELLS: u16 = 256;

#[test]
fn no_motion_leaves_the_water() {
    let mut ends = BTreeMap::new();
    for number in 0..cases(40, 4_000) {
        let mission = mission(number, CELLS);
        let flight = fly(&mission, mission.vehicle, u64::MAX);
        let told = format!("{:?}", flight.ending);
        *ends.entry((task(number), told)).or_insert(0) += 1;
        let broken = flight.findings.iter().filter(|it| it.0 != Finding::TooLong);
        assert_eq!(broken.count(), 0, "{number}: {flight:?}\n{}", scenario(number, CELLS));
    }
    println!("{ends:#?}");
}

/// The cells cover most of the water. The narrowest, a reservoir of long arms, loses a quarter.
#[test]
fn little_of_the_water_is_lost() {
    for (number, name) in (0..).zip(LAKES) {
        let mission = mission(number, CELLS);
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
    let text = std::fs::read_to_string(folder().join("stony.geojson")).expect("a lake");
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
