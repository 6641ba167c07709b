//! The report's page in a browser (`browser/page.mjs`): what steps, what loads, what fits, what axe finds.
//!
//! It needs node, Debian's chromium, and `npm ci` in `tests/browser`.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

use host_sim::cli::paper::{self, FLIGHTS, Flight};
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::report::page::{Chapter, Page};
use tests::build;

const CAR: &str = include_str!("../../../host-sim/scenarios/car-among-keep-outs.toml");
const SPILL: &str = include_str!("../../../host-sim/scenarios/begin-spill.toml");

/// Where Debian's package puts it, unless `CHROMIUM` says another place.
const CHROMIUM: &str = "/usr/bin/chromium";

#[test]
fn examples_in_a_browser() {
    look_at("examples", examples);
}

#[test]
fn a_car_in_a_browser() {
    look_at("car", car);
}

#[test]
fn a_spill_in_a_browser() {
    look_at("spill", spill);
}

fn look_at(name: &str, page: fn() -> String) {
    if lacks_browser("pages in a browser") {
        return;
    }
    let place = build::scratch().join("pages");
    fs::create_dir_all(&place).expect("a folder");
    let file = place.join(format!("{name}.html"));
    fs::write(&file, page()).expect("a page");
    let mut node = node();
    node.arg("page.mjs").args([&file, &place]);
    // Each width in each scheme: a long run's.
    node.args(tests::is_long().then_some("all"));
    build::printed(&mut node);
}

/// Node, in the folder of the scripts.
pub(crate) fn node() -> Command {
    let mut node = Command::new("node");
    node.current_dir("browser");
    node
}

/// Whether something that a browser needs is not there; then a visible line says what is skipped.
pub(crate) fn lacks_browser(what: &str) -> bool {
    let missing = missing();
    if let Some(missing) = &missing {
        build::skip(what, missing);
    }
    missing.is_some()
}

fn missing() -> Option<String> {
    let chromium = env::var_os("CHROMIUM").unwrap_or(CHROMIUM.into());
    if !build::has_tool("node") {
        return Some("node is not on the path".into());
    }
    if !Path::new(&chromium).exists() {
        return Some(format!("no {}", chromium.display()));
    }
    let is_there = |package| Path::new("browser/node_modules").join(package).is_dir();
    let has_packages = ["axe-core", "playwright-core"].into_iter().all(is_there);
    (!has_packages).then(|| "expected npm ci in tests/browser".into())
}

/// Two chapters, of true labels and of labels that may be wrong, each of three planners.
fn examples() -> String {
    let recordings: Vec<_> = FLIGHTS.iter().map(|it: &Flight| it.fly().expect("sound")).collect();
    paper::page(&recordings)
}

/// One mission: a polygon, keep-outs, arcs, positions that err, steps without a label.
fn car() -> String {
    page("car", CAR)
}

/// One mission in a part of its area: a spill that is sought and mapped.
fn spill() -> String {
    let far = ["x = [0.0, 100.0], z = [0.0, 80.0]", "x = [-100.0, 100.0], z = [-100.0, 80.0]"];
    let known = ["oracle = []", "oracle = [{ x = 60.0, z = 45.0, label = 1 }]"];
    page("spill", &SPILL.replace(far[0], far[1]).replace(known[0], known[1]))
}

fn page(name: &str, text: &str) -> String {
    let mission = scenario::parse(name, text, Overrides::default()).expect("a good file");
    let recording = Recording::of(&mission).expect("no contradiction");
    Page::new(name, vec![Chapter::new("A mission", [("it", &recording)])]).html()
}
