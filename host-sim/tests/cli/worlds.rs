//! Worlds that no straight line divides: each kind flies a mission, and wrong values are refused.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::{GOOD, folder, host_sim, prints, refuses, text};

const LINE: &str = "truth = { slope = 0.41, intercept = 3.5 }";

/// A grid of 4 x 4 cells of 5 m, which rises to the upper left.
const GRID: &str = "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 5\n\
                    9 9 9 6\n9 8 6 4\n7 4 3 2\n1 1 0 0\n";

/// The paper's scenario in another world.
fn scenario(truth: &str) -> String {
    assert!(GOOD.contains(LINE));
    GOOD.replace(LINE, &format!("truth = {truth}"))
}

/// Values of 20 x 20 cells from the upper left: 100 above a line of slope 1/2, and 0 below.
fn field() -> impl Iterator<Item = u8> {
    (0..400_u16).map(|n| {
        let (x, z) = (f64::from(n % 20) + 0.5, 19.5 - f64::from(n / 20));
        if z > 0.5 * x + 3.0 { 100 } else { 0 }
    })
}

/// An image of these cells, 100 of 255 being grey: in grey or in colour, of 8 or 16 bits.
fn image(path: &Path, color: png::ColorType, depth: png::BitDepth) {
    let mut encoder = png::Encoder::new(fs::File::create(path).expect("a file"), 20, 20);
    encoder.set_color(color);
    encoder.set_depth(depth);
    let bytes = field().flat_map(|value| {
        let samples = match color {
            png::ColorType::Rgb => vec![value; 3],
            png::ColorType::GrayscaleAlpha => vec![value, 7],
            _ => vec![value],
        };
        let wide = depth == png::BitDepth::Sixteen;
        samples.into_iter().flat_map(move |it| if wide { vec![it, 0] } else { vec![it] })
    });
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&bytes.collect::<Vec<u8>>()).expect("an image");
}

/// The same field as [`image`] as an ASCII grid of metres.
fn grid(path: &Path) {
    let values = field().map(|it| it.to_string()).collect::<Vec<_>>().join(" ");
    let head = "ncols 20\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 1\n";
    fs::write(path, format!("{head}{values}\n")).expect("a file");
}

/// The same field as a `GeoTIFF` of metres.
fn geotiff(path: &Path, compression: tiff::encoder::Compression) {
    use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
    use tiff::tags::Tag;
    let file = fs::File::create(path).expect("a file");
    let mut encoder = TiffEncoder::new(file).expect("a file").with_compression(compression);
    let mut image = encoder.new_image::<Gray32Float>(20, 20).expect("an image");
    let tags = image.encoder();
    tags.write_tag(Tag::ModelPixelScaleTag, &[1.0, 1.0, 0.0][..]).expect("a scale");
    // The upper left corner.
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 0.0, 20.0, 0.0][..]).expect("a place");
    let values: Vec<f32> = field().map(f32::from).collect();
    image.write_data(&values).expect("values");
}

fn records(printed: &str) -> Vec<Value> {
    printed.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// Flies `m.toml` with all outputs, whether a label contradicts what is known or not: what it printed, and the trace.
fn flown(folder: &Path) -> (String, Vec<Value>) {
    let flags = ["run", "m.toml", "-q", "--trace", "t.jsonl", "--figure", "f.svg"];
    let flags = [&flags[..], &["--report", "r.html", "--mcap", "l.mcap"]].concat();
    let output = host_sim(folder, &flags);
    let message = text(&output.stderr);
    assert!(output.status.success() || message.contains("contradicts"), "{message}");
    let trace = fs::read_to_string(folder.join("t.jsonl")).expect("a trace");
    (text(&output.stdout), records(&trace))
}

#[test]
fn each_world_flies_a_mission_and_is_drawn() {
    let folder = folder();
    fs::write(folder.path().join("grid.asc"), GRID).expect("a file");
    image(&folder.path().join("map.png"), png::ColorType::Grayscale, png::BitDepth::Eight);
    let slope = -0.6;
    let sine = "{ sine = [1.5, 9.0, 0.5], slope = 0.41, intercept = 3.5 }";
    for (truth, boundary, words) in [
        (
            "{ circle = [6.0, 22.0, 16.0] }".to_owned(),
            json!({ "circle": [6.0, 22.0, 16.0] }),
            "a circle about (6, 22) with a radius of 16 m, +1 inside",
        ),
        (
            sine.to_owned(),
            json!({ "sine": [1.5, 9.0, 0.5] }),
            "a sine of height 1.5 m, length 9 m and phase 0.5 rad about z = 0.4100 x +3.5000 (22.29 deg)",
        ),
        (
            "{ sine = [1, 9, 0], line = [-0.41, 1, -3.5] }".to_owned(),
            json!({ "sine": [1.0, 9.0, 0.0] }),
            "a sine of height 1 m, length 9 m and phase 0 rad about z = 0.4100 x +3.5000 (22.29 deg)",
        ),
        (
            "{ polyline = [[0, 3], [10, 6], [18, 12]] }".to_owned(),
            json!({ "polyline": [[0.0, 3.0], [10.0, 6.0], [18.0, 12.0]] }),
            "a polyline through 3 points, +1 above",
        ),
        (
            "{ raster = \"grid.asc\", threshold = 5 }".to_owned(),
            json!({ "raster": "grid.asc", "threshold": 5.0 }),
            "the raster grid.asc, +1 from 5 up",
        ),
        (
            "{ raster = \"map.png\", threshold = 50 }".to_owned(),
            json!({ "raster": "map.png", "threshold": 50.0 }),
            "the raster map.png, +1 from 50 up",
        ),
        (
            "{ slope = 0.41, intercept = 3.5, drift = [0.05, -0.6] }".to_owned(),
            json!({ "drift": [0.05, slope] }),
            "z = 0.4100 x +3.5000 (22.29 deg) at the start; each motion moves it by 0.05 m and turns it by -0.6 deg",
        ),
    ] {
        let path = folder.path().join("m.toml");
        let noisy = scenario(&truth).replace("steps = 10", "steps = 12\nnoise = { p = 0.9 }");
        fs::write(&path, noisy.replace("\"cfc\"", "\"lookahead\"")).expect("a file");
        let (_, noisy) = flown(folder.path());
        assert_eq!((noisy.len(), &noisy[13]["reason"]), (14, &json!("steps")), "{truth}");
        fs::write(&path, scenario(&truth)).expect("a file");
        let (said, records) = flown(folder.path());
        let (start, end) = (&records[0], &records[records.len() - 1]);
        assert!(start["truth"].is_null());
        for (key, value) in boundary.as_object().expect("an object") {
            assert_eq!(&start["boundary"][key], value, "{truth}");
        }
        let share = end["fit"]["misclassified"].as_f64().expect("a share");
        let moves = truth.contains("drift");
        assert!(
            if moves { share == 0.0 } else { (1e-4..0.2).contains(&share) },
            "{truth}: {share}"
        );
        assert!(end["fit"]["slope"].is_number() && end["fit"]["angle"].is_number());
        if let Some(inside) = inside(&truth) {
            for name in ["bisector", "centre", "maximum_margin"] {
                let estimate = &end["estimates"][name];
                let slow = misclassified(estimate, inside);
                let told = end["fit"]["estimates"][name].as_f64().expect("a share");
                assert!((told - slow).abs() < 2e-3, "{truth}: {name} {told}, {slow}");
                assert!(told >= share - 1e-4, "{truth}: {name} is better than the best line");
            }
        }
        let line = format!("True boundary, unknown to the agent: {words}\n");
        assert!(said.contains(&line), "{line} in {said}");
        let best =
            said.lines().find(|line| line.starts_with("line that fits best")).expect("a row");
        assert!(best.ends_with(&format!("{:.3}%", 100.0 * share)), "{best}");
        let figure = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
        let page = fs::read_to_string(folder.path().join("r.html")).expect("a page");
        let log = fs::read(folder.path().join("l.mcap")).expect("a log");
        let names: &[&str] = if moves {
            &["true line at the start", "true line at the end"]
        } else {
            &["true boundary"]
        };
        for name in names {
            assert!(
                figure.contains(name) && page.contains(&format!("\"name\":\"{name}\"")),
                "{name}"
            );
            let topic = format!("/map/{}", name.replace(' ', "_"));
            assert!(log.windows(topic.len()).any(|it| it == topic.as_bytes()), "{topic}");
        }
        assert!(
            figure.contains("class=\"truth\"") && figure.contains("class=\"past-truth\"") == moves
        );
        assert!(
            page.contains("The true boundary, unknown to a planner")
                && page.contains("deg off the best line")
        );
    }
}

/// What is positive on the +1 side of some of the worlds, by formulas of their own.
fn inside(truth: &str) -> Option<fn(f64, f64) -> f64> {
    match truth {
        _ if truth.contains("circle") => Some(|x, z| 16.0 - (x - 6.0).hypot(z - 22.0)),
        // From (0, 3) by (10, 6) to (18, 12), and on beyond its ends.
        _ if truth.contains("polyline") => {
            Some(|x, z| z - if x < 10.0 { 3.0 + 0.3 * x } else { 6.0 + 0.75 * (x - 10.0) })
        }
        _ => None,
    }
}

/// The share of the area that a line of the trace misclassifies, by the labels of a grid of places. +1 is above it.
fn misclassified(line: &Value, inside: fn(f64, f64) -> f64) -> f64 {
    const SIDE: i32 = 500;
    let [slope, intercept] = ["slope", "intercept"].map(|key| line[key].as_f64().expect("metres"));
    let at = |k: i32| 20.0 * (f64::from(k) + 0.5) / f64::from(SIDE);
    let places = (0..SIDE * SIDE).map(|k| (at(k % SIDE), at(k / SIDE)));
    let wrong = places.filter(|(x, z)| (*z > slope * x + intercept) != (inside(*x, *z) > 0.0));
    wrong.count() as f64 / f64::from(SIDE * SIDE)
}

/// What is positive on the +1 side at x, z and after so many motions.
type Height = fn(f64, f64, f64) -> f64;

/// Labels of a mission without faults or noise are those of the boundary, by a formula of its own.
#[test]
fn labels_are_those_of_the_boundary_at_their_time() {
    let folder = folder();
    let flat =
        |x: f64, z: f64, k: f64| z - 0.41 * x - 3.5 - 0.1 * k * (1.0_f64 + 0.41 * 0.41).sqrt();
    let cases: [(&str, Height); 4] = [
        ("{ circle = [6.0, 22.0, 16.0] }", |x, z, _| 16.0 - (x - 6.0).hypot(z - 22.0)),
        ("{ sine = [3.0, 40.0, 0] }", |x, z, _| z - 3.0 * (std::f64::consts::TAU * x / 40.0).sin()),
        ("{ sine = [1.0, 8.0, 0], intercept = 5.0 }", |x, z, _| {
            z - 5.0 - (std::f64::consts::TAU * x / 8.0).sin()
        }),
        ("{ slope = 0.41, intercept = 3.5, drift = [0.1, 0] }", flat),
    ];
    for (truth, height) in cases {
        // The sine about the x axis has points of its own.
        let own = "oracle = [{ x = 2, z = 0.5, label = -1 }, { x = 2, z = 8, label = 1 }, \
                   { x = 30, z = 9, label = 1 }, { x = 15, z = 0.5, label = -1 }]\n";
        let mut text =
            scenario(truth).replace("\"cfc\"", "\"random\"").replace("steps = 10", "steps = 60");
        if truth.contains("40.0") {
            let (before, _) = text.split_once("oracle = [").expect("an oracle");
            text = format!("{before}{own}").replace("x = [0.0, 20.0]", "x = [0.0, 40.0]");
        }
        fs::write(folder.path().join("m.toml"), &text).expect("a file");
        let (_, records) = flown(folder.path());
        let steps = &records[1..records.len() - 1];
        let mut seen = [0, 0];
        for (k, step) in (1_u32..).zip(steps) {
            let [x, z] = ["x", "z"].map(|axis| step["pose"][axis].as_f64().expect("metres"));
            let label = if height(x, z, k.into()) > 0.0 { 1 } else { -1 };
            assert_eq!(step["label"], label, "{truth}: step {k} at ({x}, {z})");
            seen[usize::from(label > 0)] += 1;
        }
        assert!(steps.len() > 5 && (seen[0] > 0 || truth.contains("40.0")), "{truth}: {seen:?}");
    }
}

/// Labels that are true when they are read are never called wrong, however far the line has moved since.
#[test]
fn a_label_is_judged_by_the_line_at_its_time() {
    let folder = folder();
    let text = scenario("{ slope = 0.41, intercept = 3.5, drift = [0.1, 1.0] }");
    let text = text.replace("\"cfc\"", "\"lookahead\"");
    let text = text.replace("steps = 10", "steps = 30\nnoise = { p = 0.9 }");
    for (p, is_wrong) in [("0.9", true), ("1.0", false)] {
        fs::write(folder.path().join("m.toml"), text.replace("0.9", p)).expect("a file");
        let (said, _) = flown(folder.path());
        let figure = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
        assert_eq!(
            (said.contains(" !"), figure.contains("ringed")),
            (is_wrong, is_wrong),
            "{said}"
        );
    }
}

/// A drift of nothing and a sine without height are the line itself, but for what results call it.
#[test]
fn what_does_not_move_or_bend_flies_as_the_line_does() {
    let folder = folder();
    let steps = |truth: &str| {
        let text = scenario(truth).replace("\"cfc\"", "\"lookahead\"");
        fs::write(folder.path().join("m.toml"), text).expect("a file");
        let printed = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let mut records = records(&printed);
        let end = records.pop().expect("an end");
        (records.split_off(1), end)
    };
    let (line, end) = steps("{ slope = 0.41, intercept = 3.5 }");
    assert!(end.get("fit").is_none());
    for truth in [
        "{ slope = 0.41, intercept = 3.5, drift = [0, 0] }",
        "{ line = [-0.41, 1, -3.5], drift = [0.0, 0.0] }",
        "{ slope = 0.41, intercept = 3.5, sine = [0, 1, 0] }",
    ] {
        let (bent, end) = steps(truth);
        assert_eq!(bent, line, "{truth}");
        let slope = end["fit"]["slope"].as_f64().expect("a slope");
        assert!((slope - 0.41).abs() < 1e-3, "{truth}: {slope}");
    }
}

/// An image is stretched over the rectangle around the area, and its luminance counts, whatever it is stored as.
#[test]
fn images_of_every_kind_are_one_world() {
    use png::{BitDepth, ColorType};
    use tiff::encoder::{Compression, DeflateLevel};
    let folder = folder();
    fs::create_dir(folder.path().join("sub")).expect("a folder");
    let mut flown = Vec::new();
    for (color, depth, threshold) in [
        (ColorType::Grayscale, BitDepth::Eight, 100),
        (ColorType::Rgb, BitDepth::Eight, 100),
        (ColorType::GrayscaleAlpha, BitDepth::Eight, 100),
        (ColorType::Grayscale, BitDepth::Sixteen, 25_600),
        (ColorType::Rgb, BitDepth::Sixteen, 25_600),
    ] {
        image(&folder.path().join("sub/map.PNG"), color, depth);
        let truth = format!("{{ raster = \"map.PNG\", threshold = {threshold} }}");
        fs::write(folder.path().join("sub/m.toml"), scenario(&truth)).expect("a file");
        // The file is sought beside the scenario.
        let printed = prints(folder.path(), &["run", "sub/m.toml", "--format", "json"]);
        let records = records(&printed);
        flown.push((records[1..].to_vec(), color, depth));
    }
    assert!(flown.windows(2).all(|pair| pair[0].0 == pair[1].0), "{flown:?}");
    // Grids have a place of their own, which is here that of the area.
    let sub = folder.path().join("sub");
    grid(&sub.join("map.asc"));
    geotiff(&sub.join("map.tif"), Compression::Uncompressed);
    geotiff(&sub.join("map.TIFF"), Compression::Deflate(DeflateLevel::default()));
    geotiff(&sub.join("lzw.tif"), Compression::Lzw);
    for name in ["map.asc", "map.tif", "map.TIFF", "lzw.tif"] {
        let truth = format!("{{ raster = \"{name}\", threshold = 100 }}");
        fs::write(sub.join("m.toml"), scenario(&truth)).expect("a file");
        let printed = prints(folder.path(), &["run", "sub/m.toml", "--format", "json"]);
        assert_eq!(records(&printed)[1..], flown[0].0, "{name}");
    }
    let slope = flown[0].0.last().expect("an end")["fit"]["slope"].as_f64().expect("a slope");
    assert!((slope - 0.5).abs() < 0.02, "{slope}");
}

#[test]
fn wrong_worlds_are_refused() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("grid.asc", GRID);
    write("short.asc", "ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 5\n1 2 3\n");
    write("none.png", "no image");
    write("map.tif", "II*");
    let cases: [(&str, &[&str]); 32] = [
        ("{ circle = [10, 10] }", &["bad.toml:9", "array of 3 numbers"]),
        ("{ circle = [10, 10, 0] }", &["truth.circle: found [10, 10, 0]", "a radius above 0"]),
        ("{ circle = [10, nan, 3] }", &["truth.circle", "NaN"]),
        ("{ circle = [2e6, 10, 3] }", &["truth.circle", "up to 1e6"]),
        (
            "{ circle = [10, 10, 3] }",
            &["oracle[1].label: found 1, expected -1, as the truth has it"],
        ),
        ("{ sine = [1, 2] }", &["bad.toml:9", "array of 3 numbers"]),
        ("{ sine = [-1, 2, 0] }", &["truth.sine: found [-1, 2, 0]", "metres from 0"]),
        ("{ sine = [1, 0, 0] }", &["truth.sine", "metres from 0.001"]),
        ("{ sine = [1, 2, inf] }", &["truth.sine", "inf", "radians"]),
        ("{ sine = [1, 20, 0], slope = inf }", &["truth", "slope inf, intercept 0", "finite"]),
        ("{ sine = [1, 20, 0], line = [0, 0, 1] }", &["truth", "[0.0, 0.0, 1.0]", "not both 0"]),
        (
            "{ sine = [1, 20, 0], line = [0, 1, 1], slope = 1 }",
            &["truth: found both, expected either"],
        ),
        ("{ sine = [1, 20, 0], intercept = 20 }", &["oracle[1].label: found 1, expected -1"]),
        ("{ polyline = [[0, 1]] }", &["truth.polyline: found 1 points, expected 2 at least"]),
        (
            "{ polyline = [[0, 1], [0, 2]] }",
            &["truth.polyline[1]: found [0, 2]", "above that", "before, 0"],
        ),
        ("{ polyline = [[0, 1], [nan, 2]] }", &["truth.polyline[1]: found [NaN, 2]"]),
        ("{ polyline = [[0, 1, 2], [1, 2]] }", &["bad.toml:9", "array of 2 numbers"]),
        ("{ polyline = [[0, 1], [20, 30]] }", &["oracle[2].label: found 1, expected -1"]),
        ("{ raster = \"grid.asc\" }", &["truth: found raster without threshold, expected both"]),
        ("{ threshold = 5 }", &["truth: found threshold without raster, expected both"]),
        ("{ raster = \"grid.asc\", threshold = nan }", &["truth.threshold: found NaN"]),
        (
            "{ raster = \"map.tif\", threshold = 5 }",
            &["truth.raster: found map.tif, expected a GeoTIFF:"],
        ),
        (
            "{ raster = \"map.bmp\", threshold = 5 }",
            &["truth.raster: found map.bmp", ".png", ".asc", ".tif"],
        ),
        (
            "{ raster = \"no.asc\", threshold = 5 }",
            &["truth.raster: found no.asc, expected a readable file"],
        ),
        ("{ raster = \"none.png\", threshold = 5 }", &["found none.png, expected a PNG image:"]),
        (
            "{ raster = \"short.asc\", threshold = 5 }",
            &["an ESRI ASCII grid: found 3 values, expected 4 x 4"],
        ),
        ("{ raster = \"grid.asc\", threshold = 9.5 }", &["oracle[1].label: found 1, expected -1"]),
        ("{ slope = 0.41, intercept = 3.5, drift = [0.1] }", &["bad.toml:9", "array of 2 numbers"]),
        ("{ slope = 0.41, intercept = 3.5, drift = [nan, 0] }", &["truth.drift: found [NaN, 0]"]),
        ("{ drift = [0.1, 0] }", &["truth: found neither", "{ slope, intercept }"]),
        (
            "{ circle = [1, 2, 3], sine = [1, 2, 3] }",
            &["truth: found circle and sine, expected one boundary"],
        ),
        ("{ slope = 0, polyline = [[0, 1], [1, 2]] }", &["truth: found polyline and a line"]),
    ];
    for (truth, parts) in cases {
        write("bad.toml", &scenario(truth));
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    write("bad.toml", &scenario("{ circle = [6.0, 22.0, 16.0] }"));
    let args = ["reference", "bad.toml", "--horizon", "2"];
    refuses(folder.path(), &args, &["bad.toml", "truth: found none, or no fixed line"]);
}

/// Where labels contradict every line, the mission ends as it does elsewhere, and the message claims no more.
#[test]
fn a_contradiction_of_a_world_that_is_no_line_is_told_plainly() {
    let folder = folder();
    let text = scenario("{ slope = 0.41, intercept = 3.5, drift = [-0.4, 5] }");
    let text = text.replace("\"cfc\"", "\"random\"").replace("steps = 10", "steps = 64");
    fs::write(folder.path().join("m.toml"), text).expect("a file");
    let output = host_sim(folder.path(), &["run", "m.toml", "-q", "--format", "json"]);
    let message = crate::text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("contradicts the region of certainty it lies in"), "{message}");
    let records = records(&crate::text(&output.stdout));
    assert_eq!(records[records.len() - 1]["reason"], "broken off");
}
