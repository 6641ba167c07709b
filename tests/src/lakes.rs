//! Missions in lakes and reservoirs as maps have them (Natural Earth, scaled to a kilometre): concave, with islands.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Given;
use host_sim::mission::scenario::{self, Overrides};
use nalgebra::Point2;
use planner_core::{Chart, Label, Sample, VersionSpace, Workspace as _};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::seed;

/// The lakes.
pub const LAKES: [&str; 10] = [
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
pub const TASKS: [(&str, &str); 4] =
    [("lookahead", "line"), ("lookahead", "noise"), ("track", "circle"), ("track", "noise")];

/// Who plans in a mission, and what there is to find.
pub fn task(number: u64) -> (&'static str, &'static str) {
    TASKS[(number / 10 % 4) as usize]
}

/// The folder with the lakes.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenarios/lakes")
}

/// What lies in the lake of a mission: a line by its coefficients, and a point on it or the middle of a spill.
fn drawn(number: u64) -> ([f64; 3], [f64; 2]) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed(52) + number);
    let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
    let [x, z] = [0, 1].map(|_| rng.random_range(-150.0..150.0));
    ([sin, cos, -sin * x - cos * z], [x, z])
}

/// A scenario in a lake: a line or a spill somewhere in it, on so many cells. The start is not in it.
pub fn scenario(number: u64, cells: u16) -> String {
    let lake = LAKES[(number % 10) as usize];
    let vehicle = VEHICLES[((number / 10 + number) % 3) as usize];
    let (algorithm, what) = task(number);
    let mut text = format!(
        "algorithm = \"{algorithm}\"\nsteps = 200\nseed = {number}\narea = {{ geojson = \"{lake}.geojson\", cells = {cells} }}\n\
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
    let ([a, b, c], [x, z]) = drawn(number);
    let _ = match algorithm {
        "track" => writeln!(text, "truth = {{ circle = [{x}, {z}, 80.0] }}"),
        _ => writeln!(text, "truth = {{ line = [{a}, {b}, {c}] }}"),
    };
    text
}

/// The mission of a scenario, from a start on the water that is drawn.
///
/// # Panics
/// When there is no water.
pub fn mission(number: u64, cells: u16) -> Mission {
    let text = scenario(number, cells);
    // The start is put in place of one that is anywhere on the water.
    let parse = |start: &str| {
        scenario::parse_in("lake", &format!("{text}{start}"), &folder(), Overrides::default())
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

/// The same as a chip is able to fly it. Planners of a line are given four samples on the water, as a chip does not seek
/// them. Look-ahead has room for 32 labels. Of missions with true labels every second is flown by Algorithm 1.
///
/// # Panics
/// As [`mission`].
pub fn for_a_chip(number: u64, cells: u16, steps: u32) -> Mission {
    let mut mission = mission(number, cells);
    mission.steps = steps.min(mission.steps);
    let (algorithm, what) = task(number);
    if algorithm != "lookahead" {
        return mission;
    }
    mission.steps = mission.steps.min(32);
    if what == "line" && number / 36 % 2 == 1 {
        mission.algorithm = Algorithm::Cfc;
    }
    let ([a, b, c], _) = drawn(number);
    let terrain = mission.terrain();
    let [min, max] = [terrain.bounds().min(), terrain.bounds().max()].map(Point2::<f64>::from);
    let mut rng = ChaCha8Rng::seed_from_u64(seed(54) + number);
    for _ in 0..1_000 {
        let mut samples = Vec::new();
        while samples.len() < 4 {
            let [x, z] = [min.x..max.x, min.y..max.y].map(|it| rng.random_range(it));
            let side = a * x + b * z + c;
            let site = Point2::new(x, z).try_into().expect("in the area");
            // Not so near that an error of the position brings it to the other side.
            if side.abs() > 5.0 && terrain.contains(site) {
                let label = if side > 0.0 { Label::Positive } else { Label::Negative };
                samples.push(Sample { site, label });
            }
        }
        let lines = VersionSpace::new(&samples);
        let told = mission.config.tolerance;
        let is_usable = lines.as_ref().is_ok_and(|it| it.clone().with_tolerance(told).is_ok());
        if let Some(lines) = lines.ok().filter(|_| is_usable) {
            mission.given = Given::from(lines);
            return mission;
        }
    }
    // The line leaves no water on one of its sides.
    for_a_chip(number + 36, cells, steps)
}

/// The same on a chart that is made up: all open, comb-like bays, a maze of a cell's width, ponds, or any cells. The start
/// may be on land.
///
/// # Panics
/// Never: it has a lake's size.
pub fn made_up(number: u64, cells: u16, steps: u32) -> Mission {
    let mut mission = for_a_chip(number, cells, steps);
    let lake = mission.lake.as_mut().and_then(Arc::get_mut).expect("a lake of its own");
    let ([columns, rows], corner) = (lake.chart.size(), lake.chart.bounds().min());
    let words = Chart::words_in(columns);
    let mut bits = vec![0_u32; words * usize::from(rows)];
    let mut rng = ChaCha8Rng::seed_from_u64(seed(55) + number);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |it| (row, it))) {
        let is_open = match number / 10 % 5 {
            0 => true,
            1 => row % 4 > 0 || column < 3,
            2 => row % 2 == 0 || column == if row % 4 == 1 { 0 } else { columns - 1 },
            3 => row % 40 > 0 && column % 30 > 0,
            _ => rng.random_range(0..12) > 0,
        };
        bits[usize::from(row) * words + usize::from(column / 32)] |=
            u32::from(is_open) << (column % 32);
    }
    let chart = Chart::new(corner, lake.chart.side(), [columns, rows], Vec::leak(bits));
    lake.chart = chart.expect("as the lake has");
    mission
}
