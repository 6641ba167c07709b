//! `replay` of recordings of other kinds than the plain one: the same samples by other columns, delimiters, labels and
//! coordinates, our own traces, labels that are wrong and positions that are off. What is known of each is checked
//! against the truth, or against lines tried one after the other.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{GOOD, folder, prints, refuses};

pub(crate) const SLOPE: f64 = 0.41;
pub(crate) const INTERCEPT: f64 = 3.5;

/// Where and on which side.
pub(crate) type Row = ([f64; 2], bool);

/// Numbers that fill [0, 1) evenly enough.
pub(crate) fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Samples of an area of 20 m by 20 m, to the millimetre, with true labels.
pub(crate) fn rows(count: usize) -> Vec<Row> {
    let mut state = 7;
    let mut place = || (random(&mut state) * 20_000.0).round() / 1_000.0;
    let places = (0..count).map(|_| [place(), place()]);
    places.map(|[x, z]| ([x, z], z > SLOPE * x + INTERCEPT)).collect()
}

pub(crate) fn file(header: &str, rows: &[Row], row: impl Fn([f64; 2], bool) -> String) -> String {
    let lines = rows.iter().map(|(at, label)| row(*at, *label));
    [header.to_owned()]
        .into_iter()
        .filter(|it| !it.is_empty())
        .chain(lines)
        .collect::<Vec<_>>()
        .join("\n")
        + "\n"
}

pub(crate) fn sign(label: bool) -> i8 {
    if label { 1 } else { -1 }
}

pub(crate) fn plain(rows: &[Row]) -> String {
    file("x,z,label", rows, |[x, z], label| format!("{x},{z},{}", sign(label)))
}

pub(crate) fn answer(folder: &Path, content: &str, flags: &[&str]) -> Value {
    fs::write(folder.join("s.csv"), content).expect("a file");
    let args = [&["replay", "s.csv", "--format", "json"], flags].concat();
    serde_json::from_str(&prints(folder, &args)).expect("JSON")
}

pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Whether intervals of an answer hold a number.
pub(crate) fn hold(intervals: &Value, wanted: f64) -> bool {
    let holds = |it: &Value| number(&it[0]) <= wanted && wanted <= number(&it[1]);
    intervals.as_array().expect("intervals").iter().any(holds)
}

pub(crate) fn near(found: &Value, wanted: f64, within: f64) {
    assert!((number(found) - wanted).abs() <= within, "{found} is not {wanted} to {within}");
}

#[test]
fn the_same_samples_in_other_files_have_the_same_answer() {
    let folder = folder();
    let rows = rows(60);
    let expected = answer(folder.path(), &plain(&rows), &[]);
    assert!(hold(&expected["slope_arcs"], SLOPE.atan().to_degrees()), "{expected}");
    let comma = |v: f64| v.to_string().replace('.', ",");
    let bit = |label: bool| i32::from(label);
    let word = |label: bool| if label { "YES" } else { "no" };
    let named = "x=easting,z=northing,label=wet";
    let kinds: [(String, &[&str]); 10] = [
        (
            file("z;label;x", &rows, |[x, z], l| format!("{};{};{}", comma(z), bit(l), comma(x))),
            &[],
        ),
        (
            file("time\teasting\twet\tnorthing", &rows, |[x, z], l| format!("1,5\t{x}\t{l}\t{z}")),
            &["--columns", named],
        ),
        (
            file("easting | northing | wet", &rows, |[x, z], l| format!("{x} | {z} | {}", word(l))),
            &["--columns", named],
        ),
        (file("  x   z  label", &rows, |[x, z], l| format!(" {x}   {z} {:>5}", sign(l))), &[]),
        // Without titles, by number; with a byte order mark; with titles that are not looked at.
        (
            file("", &rows, |[x, z], l| format!("a;{x};{z};{}", bit(l))),
            &["--columns", "x=2,z=3,label=4"],
        ),
        (
            format!("\u{feff}{}", file("", &rows, |[x, z], l| format!("{x},{z},{}", sign(l)))),
            &["--columns", "x=1,z=2,label=3"],
        ),
        (
            file("a,b,c", &rows, |[x, z], l| format!("{x},{z},{}", sign(l))),
            &["--columns", "x=1,z=2,label=3"],
        ),
        (
            file("x:z;x;z;label", &rows, |[x, z], l| format!("1,2,3;{x};{z};{l}")),
            &["--delimiter", ";"],
        ),
        (
            file("x,z,wet", &rows, |[x, z], l| format!("{x},{z},{:+}.0", sign(l))),
            &["--columns", "label=wet"],
        ),
        // A tolerance of nothing, and labels that are sure to be true.
        (plain(&rows), &["--tolerance", "0", "--p", "1"]),
    ];
    for (content, flags) in kinds {
        assert_eq!(answer(folder.path(), &content, flags), expected, "{flags:?} of {content}");
    }
}

#[test]
fn eastings_and_northings_are_taken_about_their_middle() {
    let folder = folder();
    let rows = rows(60);
    let far = file("x,z,label", &rows, |[x, z], l| {
        format!("{:.3},{:.3},{}", x + 500_000.0, z + 5_600_000.0, sign(l))
    });
    let found = answer(folder.path(), &far, &[]);
    let [x, z] = [0, 1].map(|k| number(&found["origin"][k]));
    assert_eq!(found["origin"], serde_json::json!([500_011.0, 5_600_010.0]));
    let near_by = file("x,z,label", &rows, |[x, z], l| {
        format!("{:.3},{:.3},{}", x - 11.0, z - 10.0, sign(l))
    });
    let expected = answer(folder.path(), &near_by, &[]);
    for key in ["samples", "matter", "slope_arcs", "intercept", "estimates"] {
        assert_eq!(found[key], expected[key], "{key}");
    }
    // The line in the file's coordinates, by its intercept and by its ends.
    let own = &found["in_file"]["centre"];
    let local = &expected["estimates"]["centre"];
    let slope = number(&local["slope"]);
    near(&own["slope"], slope, 1e-15);
    near(&own["intercept"], number(&local["intercept"]) + z - slope * x, 1e-8);
    for end in own["ends"].as_array().expect("ends") {
        let (x, z) = (number(&end[0]) - x, number(&end[1]) - z);
        assert!((slope * x + number(&local["intercept"]) - z).abs() < 1e-8, "{own}");
    }
    // An origin of one's own, here and near by.
    let found = answer(folder.path(), &far, &["--origin", "500011,5600010"]);
    assert_eq!(found["estimates"], expected["estimates"]);
    let plain = answer(folder.path(), &plain(&rows), &["--origin", "11,10"]);
    assert_eq!(plain["estimates"], expected["estimates"]);
    fs::write(folder.path().join("s.csv"), far).expect("a file");
    let words = prints(folder.path(), &["replay", "s.csv"]);
    assert!(words.contains("about the origin (500011, 5600010)"), "{words}");
}

/// Latitude and longitude of a place so far to the east and north of another, by the radii of curvature there: good to
/// some millimetres within 100 m.
pub(crate) fn degrees([lat, lon]: [f64; 2], [x, z]: [f64; 2]) -> [f64; 2] {
    let (a, e2) = (6_378_137.0, 0.006_694_379_990_14);
    let w = 1.0 - e2 * lat.to_radians().sin().powi(2);
    let (along, across) = (a * (1.0 - e2) / w.powf(1.5), a / w.sqrt());
    let east = (x / (across * lat.to_radians().cos())).to_degrees();
    [lat + (z / along).to_degrees(), lon + east]
}

#[test]
fn latitude_and_longitude_are_metres_to_the_east_and_north() {
    let folder = folder();
    let rows = rows(60);
    let expected = answer(folder.path(), &plain(&rows), &["--origin", "10,10"]);
    for (origin, titles) in [
        ([53.5334, 9.9424], "lat,lon,label"),
        ([-33.8612, 151.2093], "latitude,longitude,label"),
        ([64.1, 179.9999], "Lat,Lng,label"),
    ] {
        let content = file(titles, &rows, |[x, z], l| {
            let [lat, lon] = degrees(origin, [x - 10.0, z - 10.0]);
            let lon = if lon > 180.0 { lon - 360.0 } else { lon };
            format!("{lat:.9},{lon:.9},{}", sign(l))
        });
        let at = format!("{},{}", origin[0], origin[1]);
        let found = answer(folder.path(), &content, &["--origin", &at]);
        let (found, wanted) = (&found["estimates"]["centre"], &expected["estimates"]["centre"]);
        near(&found["slope"], number(&wanted["slope"]), 1e-4);
        near(&found["intercept"], number(&wanted["intercept"]), 2e-3);
        // The middle is found alone, and the line comes back as latitude and longitude.
        let found = answer(folder.path(), &content, &[]);
        let line = &found["in_file"]["centre"];
        assert!(line.get("slope").is_none(), "{line}");
        for end in line["ends"].as_array().expect("ends") {
            let [lat, lon] = [0, 1].map(|k| number(&end[k]));
            let [from, to] = [[0.0, 0.0], [1.0, 1.0]].map(|it| degrees(origin, it));
            let turned = (lon - origin[1] + 540.0).rem_euclid(360.0) - 180.0;
            let (x, z) = (turned / (to[1] - from[1]), (lat - origin[0]) / (to[0] - from[0]));
            let off = number(&wanted["slope"]) * x + number(&wanted["intercept"]) - z;
            assert!(off.abs() < 0.02, "{off} at {end} of {origin:?}");
        }
    }
}

#[test]
fn a_map_has_lines_ground_and_samples() {
    let folder = folder();
    let origin = [53.5334, 9.9424];
    let content = file("lat,lon,label", &rows(60), |at, l| {
        let [lat, lon] = degrees(origin, at);
        format!("{lat:.9},{lon:.9},{}", sign(l))
    });
    fs::write(folder.path().join("s.csv"), content).expect("a file");
    // The centre and the maximum margin; the most likely line besides.
    for (flags, expected) in [(&[][..], 2), (&["--p", "0.9"], 3), (&["--tolerance", "0.2"], 2)] {
        let args = [&["replay", "s.csv", "--geojson", "s.geojson"], flags].concat();
        prints(folder.path(), &args);
        let text = fs::read_to_string(folder.path().join("s.geojson")).expect("a map");
        let map: Value = serde_json::from_str(&text).expect("JSON");
        let map: geojson::FeatureCollection = serde_json::from_value(map).expect("GeoJSON");
        let (mut samples, mut lines, mut labels) = (0, 0, Vec::new());
        for feature in &map.features {
            let told = |key: &str| feature.property(key).expect("a property").clone();
            match &feature.geometry.as_ref().expect("a geometry").value {
                geojson::GeometryValue::Point { coordinates } => {
                    samples += 1;
                    let (lon, lat) = (coordinates[0], coordinates[1]);
                    assert!((lon - 9.9424).abs() < 1e-3 && (lat - 53.5334).abs() < 1e-3);
                    assert_eq!(told("line"), samples + 1);
                }
                geojson::GeometryValue::LineString { coordinates } => {
                    lines += 1;
                    assert_eq!(coordinates.len(), 2);
                }
                geojson::GeometryValue::Polygon { coordinates } => {
                    labels.push(told("label"));
                    // Closed, and counter-clockwise.
                    let ring = &coordinates[0];
                    assert_eq!(ring.first(), ring.last());
                    let twice: f64 = ring
                        .windows(2)
                        .map(|it| {
                            let [p, q] = [&it[0], &it[1]].map(|p| [p[0] - 9.9424, p[1] - 53.5334]);
                            p[0] * q[1] - p[1] * q[0]
                        })
                        .sum();
                    assert!(twice > 0.0, "{ring:?}");
                }
                other => panic!("{other:?}"),
            }
        }
        assert_eq!((samples, lines, labels.len()), (60, expected, 2), "{flags:?}: {labels:?}");
    }
}

#[test]
fn our_own_traces_are_recordings() {
    let folder = folder();
    let path = folder.path();
    let end = |name: &str| -> Value {
        let trace = fs::read_to_string(path.join(name)).expect("a trace");
        serde_json::from_str(trace.lines().last().expect("an end")).expect("JSON")
    };
    let replayed = |flags: &[&str]| -> Value {
        let args = [&["replay", "t.jsonl", "--format", "json"], flags].concat();
        serde_json::from_str(&prints(path, &args)).expect("JSON")
    };
    fs::write(path.join("m.toml"), GOOD).expect("a scenario");
    prints(path, &["run", "m.toml", "--trace", "t.jsonl"]);
    assert_eq!(replayed(&[])["estimates"], end("t.jsonl")["estimates"]);
    // Labels that may be wrong: the table of the planner and the plane of lines have one answer.
    let noisy = include_str!("../../scenarios/paper-noisy.toml");
    for algorithm in ["scc", "lookahead"] {
        fs::write(path.join("m.toml"), noisy).expect("a scenario");
        let flags = ["--algorithm", algorithm, "--steps", "20", "--trace", "t.jsonl"];
        prints(path, &[&["run", "m.toml"][..], &flags].concat());
        let (found, expected) = (replayed(&[]), end("t.jsonl"));
        assert_eq!(found["p"], 0.7);
        for key in ["slope", "intercept", "angle"] {
            let wanted = number(&expected["estimates"]["centre"][key]);
            near(&found["estimates"]["centre"][key], wanted, 2e-3 * (1.0 + wanted.abs()));
        }
        // One's own word counts for more than the trace's.
        assert_eq!(replayed(&["--p", "0.9"])["p"], 0.9);
    }
}

/// What lines that are tried one after the other come to, with what each weighs; by their angle and their offset from
/// the middle of the area that a figure shows.
struct Tried {
    /// The normal's angle, the offset, the logarithm of the weight.
    lines: Vec<(f64, f64, f64)>,
    middle: [f64; 2],
    total: f64,
}

impl Tried {
    fn of(rows: &[Row], log: impl Fn(f64, bool) -> f64) -> Self {
        let ends = |k: usize| {
            let values = rows.iter().map(move |(at, _)| at[k]);
            [values.clone().fold(f64::INFINITY, f64::min), values.fold(f64::NEG_INFINITY, f64::max)]
        };
        let [[x0, x1], [z0, z1]] = [ends(0), ends(1)];
        let margin = 0.1 * (x1 - x0).max(z1 - z0);
        let middle = [x0.midpoint(x1), z0.midpoint(z1)];
        let half = [x1 - middle[0] + margin, z1 - middle[1] + margin];
        let (angles, offsets) = (2_160, 600);
        let reach = half[0].hypot(half[1]);
        let mut lines = Vec::new();
        for i in 0..angles {
            let angle = (f64::from(i) + 0.5) / f64::from(angles) * TAU;
            let (sin, cos) = angle.sin_cos();
            for j in 0..offsets {
                let offset = ((f64::from(j) + 0.5) / f64::from(offsets) * 2.0 - 1.0) * reach;
                if offset.abs() > half[0] * cos.abs() + half[1] * sin.abs() {
                    continue;
                }
                let told = rows.iter().map(|([x, z], label)| {
                    log((x - middle[0]) * cos + (z - middle[1]) * sin - offset, *label)
                });
                lines.push((angle, offset, told.sum::<f64>()));
            }
        }
        lines.retain(|(.., log)| *log > f64::NEG_INFINITY);
        lines.sort_by(|a, b| b.2.total_cmp(&a.2));
        let most = lines[0].2;
        for (.., log) in &mut lines {
            *log -= most;
        }
        let total = lines.iter().map(|(.., log)| log.exp()).sum();
        Self { lines, middle, total }
    }

    /// Slope and intercept of the mean.
    fn mean(&self) -> [f64; 2] {
        let sum = self.lines.iter().fold([0.0; 3], |[a, b, r], (angle, offset, log)| {
            let weight = log.exp();
            [a + weight * angle.cos(), b + weight * angle.sin(), r + weight * offset]
        });
        let [a, b, r] = sum;
        [-a / b, (r + a * self.middle[0]) / b + self.middle[1]]
    }

    /// The slopes of the likeliest lines that hold nine tenths, degrees, all of those that weigh alike; and what they
    /// hold.
    fn credible(&self) -> ([f64; 2], f64) {
        let (mut held, mut least, mut span) = (0.0, 0.0, [f64::INFINITY, f64::NEG_INFINITY]);
        for (angle, _, log) in &self.lines {
            if held >= 0.9 * self.total && *log < least - 1e-9 {
                break;
            }
            (held, least) = (held + log.exp(), *log);
            let degrees = angle.to_degrees() - 90.0;
            span = [span[0].min(degrees), span[1].max(degrees)];
        }
        (span, held / self.total)
    }
}

/// Some wrong labels among true ones.
fn with_wrong(mut rows: Vec<Row>, every: usize) -> Vec<Row> {
    rows.iter_mut().step_by(every).for_each(|row| row.1 = !row.1);
    rows
}

#[test]
fn labels_that_may_be_wrong_are_weighed_as_line_by_line() {
    let folder = folder();
    for (count, every, p) in [(60, 13, 0.9_f64), (60, 7, 0.8), (30, 9, 0.7)] {
        let rows = with_wrong(rows(count), every);
        let found = answer(folder.path(), &plain(&rows), &["--p", &p.to_string()]);
        let odds = (p / (1.0 - p)).ln();
        let tried =
            Tried::of(&rows, |distance, label| if (distance > 0.0) == label { 0.0 } else { -odds });
        let [slope, intercept] = tried.mean();
        let centre = &found["estimates"]["centre"];
        near(&centre["slope"], slope, 0.005);
        near(&centre["intercept"], intercept, 0.05);
        let (span, held) = tried.credible();
        for k in 0..2 {
            near(&found["slope_arcs"][0][k], span[k], 0.6);
        }
        near(&found["credible"]["probability"], held, 0.01);
        assert!(number(&found["pruned_mass"]) < 1e-4, "{found}");
        assert!(hold(&found["slope_arcs"], SLOPE.atan().to_degrees()), "{found}");
        // No line has fewer labels against it.
        let fewest = rows.iter().map(|(at, label)| {
            let likely = &found["most_likely"];
            let above = at[1] > number(&likely["slope"]) * at[0] + number(&likely["intercept"]);
            usize::from(above != *label)
        });
        let fewest: usize = fewest.sum();
        assert_eq!(found["most_likely"]["disagreeing"].as_array().expect("lines").len(), fewest);
        let least = (0..tried.lines.len()).step_by(50).map(|k| tried.lines[k]);
        let violated = least.map(|(angle, offset, _)| {
            let (sin, cos) = angle.sin_cos();
            let [x, z] = tried.middle;
            let wrong = |row: &&Row| {
                let ([a, b], label) = row;
                ((a - x) * cos + (b - z) * sin > offset) != *label
            };
            rows.iter().filter(wrong).count()
        });
        assert!(violated.min().expect("lines") >= fewest);
    }
}

#[test]
fn positions_that_are_off_blur_what_doubtful_labels_say() {
    let folder = folder();
    let rows = with_wrong(rows(60), 13);
    let found = answer(folder.path(), &plain(&rows), &["--p", "0.9", "--tolerance", "1.5"]);
    // The chance of a label whose true position is spread about the recorded one.
    let log = |distance: f64, label: bool| {
        let on_its_side = if label { distance } else { -distance };
        let above = 0.5 * libm::erfc(-on_its_side / 0.5 / 2.0_f64.sqrt());
        (0.9 * above + 0.1 * (1.0 - above)).ln()
    };
    let tried = Tried::of(&rows, log);
    let [slope, intercept] = tried.mean();
    near(&found["estimates"]["centre"]["slope"], slope, 0.005);
    near(&found["estimates"]["centre"]["intercept"], intercept, 0.05);
    let (span, _) = tried.credible();
    for k in 0..2 {
        near(&found["slope_arcs"][0][k], span[k], 0.3);
    }
    near(&found["credible"]["probability"], 0.9, 0.005);
}

#[test]
fn one_wrong_row_is_named_and_does_not_end_it() {
    let folder = folder();
    let mut rows = rows(200);
    let wrong = rows.iter().position(|([x, z], _)| z - SLOPE * x - INTERCEPT > 8.0).expect("one");
    rows[wrong].1 = false;
    let content = plain(&rows);
    fs::write(folder.path().join("s.csv"), &content).expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:", "no line separates"]);
    let parts = ["s.csv:", "no line separates", "within 0.5 m"];
    refuses(folder.path(), &["replay", "s.csv", "--tolerance", "0.5"], &parts);
    for flags in [&["--p", "0.99"][..], &["--p", "0.99", "--tolerance", "0.1"]] {
        let found = answer(folder.path(), &content, flags);
        assert_eq!(found["most_likely"]["disagreeing"], serde_json::json!([wrong + 2]));
        assert!(hold(&found["slope_arcs"], SLOPE.atan().to_degrees()), "{found}");
        near(&found["estimates"]["centre"]["slope"], SLOPE, 0.05);
    }
    let words = prints(folder.path(), &["replay", "s.csv", "--p", "0.99"]);
    let named = format!("1 of 200 samples: lines {}.", wrong + 2);
    assert!(words.contains(&named), "{words}");
}

#[test]
fn positions_within_a_tolerance_leave_the_lines_that_some_places_agree_with() {
    let folder = folder();
    let tolerance = 0.8;
    for seed in 1..3 {
        let mut state = seed;
        let off = |(at, label): &Row, state: &mut u64| {
            let (angle, far) = (random(state) * TAU, random(state) * tolerance);
            ([at[0] + far * angle.cos(), at[1] + far * angle.sin()], *label)
        };
        let rows: Vec<_> = rows(80).iter().map(|row| off(row, &mut state)).collect();
        let found = answer(folder.path(), &plain(&rows), &["--tolerance", "0.8"]);
        assert!(hold(&found["slope_arcs"], SLOPE.atan().to_degrees()), "{found}");
        assert!(hold(&serde_json::json!([found["intercept"]]), INTERCEPT), "{found}");
        let tried = Tried::of(&rows, |distance, label| {
            let on_its_side = if label { distance } else { -distance };
            if on_its_side >= -tolerance { 0.0 } else { f64::NEG_INFINITY }
        });
        let (span, _) = tried.credible();
        for k in 0..2 {
            near(&found["slope_arcs"][0][k], span[k], 0.3);
        }
        let [slope, intercept] = tried.mean();
        near(&found["estimates"]["centre"]["slope"], slope, 0.005);
        near(&found["estimates"]["centre"]["intercept"], intercept, 0.05);
    }
    // Of nearly nothing it is the answer without one.
    let exact = answer(folder.path(), &plain(&rows(80)), &[]);
    let nearly = answer(folder.path(), &plain(&rows(80)), &["--tolerance", "0.000001"]);
    for k in 0..2 {
        near(&nearly["slope_arcs"][0][k], number(&exact["slope_arcs"][0][k]), 0.01);
        near(&nearly["intercept"][k], number(&exact["intercept"][k]), 0.002);
    }
    for name in ["centre", "maximum_margin"] {
        near(&nearly["estimates"][name]["slope"], number(&exact["estimates"][name]["slope"]), 1e-3);
    }
    let parts = ["s.csv", "off by 30 m", "every direction", "--tolerance"];
    refuses(folder.path(), &["replay", "s.csv", "--tolerance", "30"], &parts);
}

#[test]
fn the_harbour_of_the_repository_has_its_edge() {
    let folder = folder();
    let recording = include_str!("../../recordings/harbour-oil.csv");
    fs::write(folder.path().join("s.csv"), recording).expect("a file");
    let columns = ["--columns", "label=oil"];
    refuses(
        folder.path(),
        &[&["replay", "s.csv"][..], &columns].concat(),
        &["s.csv:29:", "no line separates"],
    );
    // The truth is what harbour-oil.py says.
    let origin = "53.53,9.93";
    let flags = [&columns[..], &["--origin", origin, "--p", "0.95", "--tolerance", "4.5"]].concat();
    let found = answer(folder.path(), recording, &flags);
    assert_eq!(found["samples"], 240);
    assert!(hold(&found["slope_arcs"], 28.0), "{found}");
    let centre = &found["estimates"]["centre"];
    let slope = number(&centre["slope"]);
    near(&centre["angle"], 28.0, 1.0);
    near(&serde_json::json!(slope * 900.0 + number(&centre["intercept"])), 420.0, 5.0);
    let wrong = found["most_likely"]["disagreeing"].as_array().expect("lines").len();
    assert!((8..=16).contains(&wrong), "{wrong}");
}

#[test]
fn bad_flags_and_files_are_refused_by_what_is_wrong() {
    let folder = folder();
    let good = "x,z,label\n2,1,-1\n2,8,1\n18,16,1\n18,5,-1\n";
    let flags: [(&[&str], &[&str]); 22] = [
        (&["--columns", "x"], &["--columns", "\"x\"", "x=TITLE"]),
        (&["--columns", "y=2"], &["--columns", "\"y\"", "x=TITLE"]),
        (&["--columns", "x="], &["--columns", "no title for x"]),
        (&["--columns", "x=1,x=2"], &["--columns", "x twice"]),
        (&["--columns", "x=1,lat=2"], &["--columns", "both kinds"]),
        (&["--columns", "x=east"], &["s.csv:1", "\"x,z,label\"", "\"east\"", "for x"]),
        (&["--columns", "x=4"], &["s.csv:1", "\"4\"", "up to 3"]),
        (&["--columns", "x=0"], &["s.csv:1", "\"0\"", "up to 3"]),
        (&["--columns", "x=z"], &["s.csv:1", "one column for two", "x,z,label"]),
        (&["--columns", "lat=x,lon=z"], &["s.csv", "origin", "metres"]),
        (&["--delimiter", "dot"], &["--delimiter", "\"dot\"", "semicolon"]),
        (&["--delimiter", ";"], &["s.csv:1", "x,z,label"]),
        (&["--origin", "5"], &["--origin", "two numbers"]),
        (&["--origin", "5,inf"], &["--origin", "two numbers"]),
        (&["--origin", "9000,0"], &["s.csv:2", "(2, 1)", "(9000, 0)", "8192"]),
        (&["--p", "0.5"], &["--p", "above 0.5"]),
        (&["--p", "1.1"], &["--p", "at most 1"]),
        (&["--p", "NaN"], &["--p", "above 0.5"]),
        (&["--tolerance", "-1"], &["--tolerance", "0 to 1024"]),
        (&["--tolerance", "1025"], &["--tolerance", "0 to 1024"]),
        (&["--geojson", "m.geojson"], &["--geojson", "s.csv", "latitude and longitude"]),
        (&["--geojson", "s.csv"], &["s.csv", "the samples", "--geojson"]),
    ];
    for (flags, parts) in flags {
        fs::write(folder.path().join("s.csv"), good).expect("a file");
        // Latitudes of 1 and 16 degrees are far apart.
        let parts = if flags == ["--columns", "lat=x,lon=z"] {
            &["s.csv:2", "m from the origin", "8192"]
        } else {
            parts
        };
        let args = [&["replay", "s.csv", "--figure", "f.svg"], flags].concat();
        refuses(folder.path(), &args, parts);
    }
    let utm = "x,z,label\n500000,5600000,1\n500010,5600000,-1\n500010,5600010,1\n";
    let files: [(&str, &[&str], &[&str]); 15] = [
        ("x,z,label\n1,2,1\n1,3,0\n1,4,-1\n", &[], &["s.csv:4", "found -1", "line 3", "one kind"]),
        ("x,z,label\n1,2,true\n1,3,no\n", &[], &["s.csv:3", "found no", "line 2", "one kind"]),
        ("x,z,label\n1,2,1\n1,3,false\n", &[], &["s.csv:3", "found false", "line 2", "one kind"]),
        ("x,z,label\n1,2,0\n1,3,0\n4,3,0\n", &[], &["s.csv:2", "found 0", "0 or 1"]),
        ("x,z,label\n1,2,maybe\n", &[], &["s.csv:2", "\"maybe\"", "yes or no"]),
        ("x;z;label\n1;2,5;1\n1.23,5;2;1\n", &[], &["s.csv:3", "\"1.23,5\"", "finite number"]),
        ("lat,lon,label\n91,9,1\n", &[], &["s.csv", "91", "latitude"]),
        (
            "lat,lon,label\n51,9,1\n51,361,1\n51,9,1\n",
            &["--origin", "51,9"],
            &["s.csv:3", "361", "longitude"],
        ),
        ("lat,lon,label\n51,9,1\n", &["--origin", "99,9"], &["s.csv", "origin", "99", "latitude"]),
        ("lat,lat,lon,label\n51,9,1\n", &[], &["s.csv:1", "the column lat twice"]),
        ("x,z,label\n1,2,1\n3,4,1\n", &["--p", "0.9"], &["s.csv", "samples of both"]),
        (
            "x,z,label\n0,0,1\n5,0,-1\n99000,5,1\n",
            &[],
            &["s.csv:2", "(0, 0)", "(49500, 3)", "8192"],
        ),
        ("{\"record\":\"step\"}\n", &[], &["s.csv:1", "trace"]),
        (
            "{\"record\":\"start\",\"oracle\":[{\"x\":1,\"z\":1,\"label\":0}],\"p\":1}\n",
            &[],
            &["s.csv:1", "found 0"],
        ),
        ("\n{\"record\":\"end\"}\n", &[], &["s.csv:2", "no start"]),
    ];
    for (content, flags, parts) in files {
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        let args = [&["replay", "s.csv", "--figure", "f.svg"], flags].concat();
        refuses(folder.path(), &args, parts);
    }
    fs::write(folder.path().join("s.csv"), utm).expect("a file");
    prints(folder.path(), &["replay", "s.csv", "--tolerance", "0.1"]);
    let trace = "{\"record\":\"start\",\"oracle\":[],\"p\":1}\n";
    fs::write(folder.path().join("s.csv"), trace).expect("a file");
    let args = ["replay", "s.csv", "--delimiter", "comma"];
    refuses(folder.path(), &args, &["s.csv", "a trace", "--delimiter"]);
}
