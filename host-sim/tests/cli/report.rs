//! The page of a mission: `--report`, and `--compare` of `run`.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::{GOOD, folder, prints, refuses};

const NOISY: &str = include_str!("../../scenarios/paper-noisy.toml");
const MOVING: &str = include_str!("../../scenarios/moving-front.toml");
const CAR: &str = include_str!("../../scenarios/car-among-keep-outs.toml");

fn page(folder: &Path) -> String {
    fs::read_to_string(folder.join("r.html")).expect("a page")
}

/// The page's block of data.
fn data(page: &str) -> Value {
    let start =
        page.split_once("<script type=\"application/json\" id=\"data\">").expect("a block").1;
    let block = start.split_once("</script>").expect("an end").0;
    serde_json::from_str(block).expect("JSON")
}

fn flights(page: &str) -> Vec<Value> {
    data(page)["chapters"][0]["flights"].as_array().expect("flights").clone()
}

/// All that could make a browser load something, or would take it elsewhere.
fn assert_self_contained(page: &str) {
    for loads in [
        "http:", "https:", " src=", " href=", "url(\"", "url(h", "url(/", "@import", "import(",
        "fetch(",
    ] {
        assert!(!page.contains(loads), "{loads:?} in the page");
    }
    assert!(page.contains("default-src 'none'"), "no policy");
}

#[test]
fn a_page_has_all_in_it_and_a_scene_for_each_step() {
    let folder = folder();
    for (scenario, steps) in [(GOOD, 10), (NOISY, 10), (CAR, 20)] {
        fs::write(folder.path().join("m.toml"), scenario).expect("a file");
        let args = ["run", "m.toml", "--report", "r.html"];
        let told = prints(folder.path(), &args);
        assert_eq!(told, prints(folder.path(), &args[..2]), "the text stays as it is");
        let page = page(folder.path());
        assert_self_contained(&page);
        let flights = flights(&page);
        assert_eq!(flights.len(), 1);
        assert_eq!(flights[0]["scenes"].as_array().map(Vec::len), Some(steps + 1));
        assert_eq!(page.matches("<th scope=\"row\">").count(), steps + 1, "a row each");
    }
}

/// A front has no slope and no intercept: the table has where it is known best, as the trace has.
#[test]
fn the_table_of_a_front_has_its_places_and_none_of_a_line() {
    let folder = folder();
    let head = |page: &str| {
        let table = page.split_once("<thead>").expect("a table").1;
        table.split_once("</thead>").expect("an end").0.to_owned()
    };
    fs::write(folder.path().join("m.toml"), MOVING).expect("a file");
    let run = ["run", "m.toml", "--steps", "12", "--report", "r.html", "--format", "json"];
    let trace = prints(folder.path(), &run);
    let html = page(folder.path());
    let columns = ["front at, m", "half-width of the front, m", "front off, m", "cost so far"];
    assert!(columns.iter().all(|it| head(&html).contains(it)), "{}", head(&html));
    assert!(!head(&html).contains("slopes") && !head(&html).contains("intercept"), "{html}");
    let last: Value = trace.lines().nth(12).map(serde_json::from_str).expect("a step").unwrap();
    let half_width = last["front"]["half_width"].as_f64().expect("a front");
    let row = html.split_once("<th scope=\"row\">12</th>").expect("a row").1;
    let cells: Vec<&str> = row.split("<td>").skip(1).take(11).collect();
    assert!(cells[8].starts_with(&format!("{half_width:.2}")), "{cells:?}, {half_width}");
    assert!(cells[7].starts_with('(') && cells[10].contains("</tr>"), "{cells:?}");
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    prints(folder.path(), &["run", "m.toml", "--report", "r.html"]);
    assert!(head(&page(folder.path())).contains("slopes left, deg"));
}

#[test]
fn scenes_tell_what_the_trace_does() {
    let folder = folder();
    for scenario in [GOOD, NOISY, CAR] {
        fs::write(folder.path().join("m.toml"), scenario).expect("a file");
        let args = ["run", "m.toml", "--report", "r.html", "--format", "json"];
        let trace = prints(folder.path(), &args);
        let records: Vec<Value> =
            trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        let (start, steps) = (&records[0], &records[1..records.len() - 1]);
        let flights = flights(&page(folder.path()));
        let scenes = flights[0]["scenes"].as_array().expect("scenes");
        let mut expected_bits = 0.0;
        for (scene, step) in scenes[1..].iter().zip(steps) {
            assert_eq!(scene["slopes"], step["slope_arcs"]);
            assert_eq!(scene["intercepts"], step["intercept"]);
            assert_eq!(scene["bits"], step["bits"]);
            assert_eq!(scene["motion"]["label"], step["label"]);
            for (k, axis) in ["x", "z"].into_iter().enumerate() {
                let [shown, told] =
                    [&scene["at"][k], &step["pose"][axis]].map(|it| it.as_f64().unwrap());
                assert!((shown - told).abs() < 1e-3, "{shown} for {told}");
            }
            // What is expected comes of the chance, and of what a label can tell.
            if let Some(chance) = scene["motion"]["chance"].as_f64() {
                let told = scene["motion"]["expected"].as_f64().expect("both or neither");
                let p = start["p"].as_f64().expect("a probability");
                let trusted = step["trusted"] == Value::Bool(true);
                let most = entropy(chance) - if trusted { 0.0 } else { entropy(p) };
                if start.get("vehicle").is_none() {
                    assert!((told - most).abs() < 1e-6, "{told} for {most}");
                } else {
                    assert!(
                        told <= most + 1e-6,
                        "a position that errs tells less: {told} for {most}"
                    );
                }
                expected_bits += told;
            }
            let sum = scene["expected_bits"].as_f64().expect("a number");
            assert!((sum - expected_bits).abs() < 1e-9, "{sum} for {expected_bits}");
        }
        let last = scenes.last().expect("an end");
        let centre = &records[records.len() - 1]["estimates"]["centre"];
        assert_eq!(last["estimate"]["angle"], centre["angle"]);
        assert_eq!(last["estimate"]["intercept"], centre["intercept"]);
    }
}

/// Of a coin, bits.
fn entropy(p: f64) -> f64 {
    [p, 1.0 - p].into_iter().filter(|p| *p > 0.0).map(|p| -p * p.log2()).sum()
}

#[test]
fn a_name_is_text_whatever_it_is() {
    let folder = folder();
    let name = "<b onclick=alert(1)>&'\"{{data}}-->.toml";
    fs::write(folder.path().join(name), GOOD).expect("a file");
    prints(folder.path(), &["run", name, "--report", "r.html"]);
    let page = page(folder.path());
    assert_eq!(format!("{}.toml", data(&page)["title"].as_str().expect("text")), name);
    assert_self_contained(&page);
    let shown = "&lt;b onclick=alert(1)&gt;&amp;&#39;&quot;{{data}}--&gt;";
    assert!(page.contains(&format!("<h1>{shown}</h1>")), "the title is not text");
    assert!(!page.contains("<b "), "the name became an element");
}

#[test]
fn planners_that_are_compared_are_on_one_page() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let compare = |format| {
        let args = [
            "run",
            "m.toml",
            "--compare",
            "cfc,lookahead,random",
            "--report",
            "r.html",
            "--format",
            format,
        ];
        prints(folder.path(), &args)
    };
    let table = compare("text");
    let page = page(folder.path());
    assert_self_contained(&page);
    let flights = flights(&page);
    for (flight, name) in flights.iter().zip(["Algorithm 1 (cfc)", "look-ahead", "random walk"]) {
        assert_eq!(flight["planner"], name);
        assert!(table.contains(name), "{name} in: {table}");
        assert_eq!(flight["scenes"].as_array().map(Vec::len), Some(11));
    }
    assert_eq!(flights.len(), 3);
    let alone =
        |name| prints(folder.path(), &["run", "m.toml", "--algorithm", name, "--format", "json"]);
    assert_eq!(compare("json"), ["cfc", "lookahead", "random"].map(alone).concat());
}

#[test]
fn wrong_reports_and_comparisons_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    fs::write(folder.path().join("noisy.toml"), NOISY).expect("a file");
    fs::write(folder.path().join("car.toml"), CAR).expect("a file");
    let stop = GOOD.to_owned() + "\n[stop]\nslope_arc_deg = 0.5\n";
    fs::write(folder.path().join("stop.toml"), stop.replace("\"cfc\"", "\"lookahead\""))
        .expect("a file");
    let cases: [(&[&str], &[&str]); 14] = [
        (&["m.toml", "--compare", "cfc,lookahead"], &["--report"]),
        (&["m.toml", "--compare", "cfc,cfc", "--report", "r"], &["--compare", "cfc twice", "once"]),
        (
            &["m.toml", "--compare", "cfc,best", "--report", "r"],
            &["best", "--compare", "lookahead"],
        ),
        (&["m.toml", "--compare", "", "--report", "r"], &["--compare"]),
        (
            &["m.toml", "--compare", "cfc", "--algorithm", "scc", "--report", "r"],
            &["--compare", "--algorithm"],
        ),
        (
            &["m.toml", "--compare", "cfc", "--trace", "t", "--report", "r"],
            &["--compare", "--trace"],
        ),
        (
            &["m.toml", "--compare", "cfc", "--figure", "t", "--report", "r"],
            &["--compare", "--figure"],
        ),
        (
            &["noisy.toml", "--compare", "cfc,lookahead", "--report", "r"],
            &["--compare", "cfc", "true", "noisy.toml", "noise"],
        ),
        (
            &["car.toml", "--compare", "lookahead,random", "--report", "r"],
            &["--compare random", "car.toml", "vehicle"],
        ),
        (
            &["stop.toml", "--compare", "lookahead,cfc", "--report", "r"],
            &["--compare cfc", "stop.toml", "stop"],
        ),
        (&["m.toml", "--report", "m.toml"], &["m.toml", "the scenario", "--report"]),
        (
            &["m.toml", "--compare", "cfc", "--report", "m.toml"],
            &["m.toml", "the scenario", "--report"],
        ),
        (&["m.toml", "--report", "r", "--trace", "r"], &["--report", "--trace"]),
        (&["m.toml", "--report", "no/where.html"], &["no/where.html", "expected a"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), &[&["run"], args].concat(), parts);
    }
    refuses(
        folder.path(),
        &["hil", "m.toml", "--emulator=m.toml", "--compare", "cfc"],
        &["--compare"],
    );
    refuses(
        folder.path(),
        &["hil", "m.toml", "--emulator=car.toml", "--report", "car.toml"],
        &["--report", "the firmware"],
    );
}

#[test]
fn the_bare_command_has_a_page_of_both_examples() {
    let folder = folder();
    let told = prints(folder.path(), &[]);
    assert!(told.ends_with("open out/report.html in a browser.\n"), "{told}");
    let page = fs::read_to_string(folder.path().join("out/report.html")).expect("a page");
    assert_self_contained(&page);
    let data = data(&page);
    for chapter in data["chapters"].as_array().expect("chapters") {
        assert_eq!(chapter["flights"].as_array().map(Vec::len), Some(3), "{}", chapter["title"]);
    }
    assert_eq!(data["chapters"].as_array().map(Vec::len), Some(2));
}
