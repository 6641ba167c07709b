//! The playground: its module flies missions as the host does, byte for byte, and its page works by mouse, finger and
//! keys.
//!
//! It needs node and the target of WebAssembly; in a browser also Debian's chromium, and `npm ci` in `tests/browser`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use expect_test::expect_file;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use tests::{build, cases, ensemble};

use crate::page;

/// Kinds of scenarios.
const KINDS: u64 = 10;

/// A scenario with the files beside it.
#[derive(Serialize)]
struct Scenario {
    text: String,
    files: BTreeMap<&'static str, String>,
}

/// The page with its module, built once; or what it lacks.
static BUILT: LazyLock<Result<PathBuf, String>> = LazyLock::new(|| {
    if !build::has_tool("node") {
        return Err("node is not on the path".into());
    }
    let folder = build::scratch().join("playground");
    fs::create_dir_all(&folder).expect("a folder");
    let mut cargo = build::cargo();
    cargo.args(["run", "--quiet", "--locked", "-p", "playground", "--"]);
    let file = folder.join("playground.html");
    let run = cargo.arg("--output").arg(&file).output().expect("cargo starts");
    let said = String::from_utf8_lossy(&run.stderr);
    if said.contains("rustup target add") {
        return Err(said.trim().into());
    }
    assert!(run.status.success(), "{said}");
    Ok(file)
});

#[test]
fn missions_in_node_are_those_of_the_host() {
    compare("the playground's module in node", "in-node");
}

#[test]
fn missions_in_a_browser_are_those_of_the_host() {
    if page::lacks_browser("the playground's module in a browser") {
        return;
    }
    compare("the playground's module in a browser", "in-browser");
}

#[test]
fn the_page_works_by_mouse_finger_and_keys() {
    const WHAT: &str = "the playground's page in a browser";
    if page::lacks_browser(WHAT) {
        return;
    }
    let Some(file) = built(WHAT) else { return };
    node(&["playground.mjs".as_ref(), file, file.parent().expect("a folder")]);
}

#[test]
fn the_planner_alone_is_small_and_finds_a_line() {
    const TARGET: &str = "wasm32-unknown-unknown";
    // What that needs is built with the page.
    if built("the planner alone as a module").is_none() {
        return;
    }
    let mut cargo = build::cargo();
    cargo.args(["build", "--quiet", "--locked", "-p", "playground", "--example", "alone"]);
    cargo.args(["--profile", "page", "--target", TARGET, "--message-format", "json"]);
    let said = build::printed(&mut cargo);
    let module = said.split('"').rfind(|it| it.ends_with("alone.wasm")).expect("a module");
    println!("{}", node(&["alone.mjs".as_ref(), module.as_ref()]));
}

/// `UPDATE_EXPECT=1 cargo test -p tests playground::` draws it anew.
#[test]
fn the_picture_of_the_docs_is_what_the_page_shows() {
    const WHAT: &str = "the picture of docs/try-it.md";
    if page::lacks_browser(WHAT) {
        return;
    }
    let Some(file) = built(WHAT) else { return };
    let drawn = file.with_file_name("try-it.svg");
    node(&["animation.mjs".as_ref(), file, &drawn]);
    let drawn = fs::read_to_string(drawn).expect("a picture");
    expect_file!["../../../docs/try-it.svg"].assert_eq(&drawn);
}

#[test]
fn what_is_copied_is_flown_and_compiled() {
    const WHAT: &str = "what the playground copies";
    if !build::has_tool("node") {
        return build::skip(WHAT, "node is not on the path");
    }
    let folder = build::scratch().join("copied");
    let programs = folder.join("src/bin");
    fs::create_dir_all(&programs).expect("folders");
    node(&["programs.mjs".as_ref(), &folder]);
    let of_kind = |folder: &Path, ending: &str| -> Vec<PathBuf> {
        let all = fs::read_dir(folder).expect("a folder").map(|it| it.expect("an entry").path());
        all.filter(|it| it.extension().is_some_and(|it| it == ending)).collect()
    };
    let scenarios = of_kind(&folder, "scenario");
    assert!(scenarios.len() > 10, "{scenarios:?}");
    for file in scenarios {
        let mission = scenario::read(&file, Overrides::default()).expect("a good scenario");
        Recording::of(&mission).unwrap_or_else(|why| panic!("{}: {why}", file.display()));
    }
    let choices = of_kind(&folder.join("choices"), "scenario");
    assert!(choices.len() > 200, "{} choices", choices.len());
    for file in choices {
        let read = scenario::read(&file, Overrides::default());
        read.unwrap_or_else(|why| {
            panic!("{why:#}\n{}", fs::read_to_string(&file).unwrap_or_default())
        });
    }
    if !build::is_long("programs in Rust that the playground copies", "playground") {
        return;
    }
    for file in of_kind(&folder, "rs") {
        fs::copy(&file, programs.join(file.file_name().expect("a name"))).expect("a file");
    }
    let core = build::root().canonicalize().expect("a path").join("planner-core");
    let manifest = format!(
        "[package]\nname = \"copied\"\nedition = \"2024\"\n[workspace]\n[dependencies]\nplanner-core.path = {core:?}\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).expect("a manifest");
    fs::copy(build::root().join("Cargo.lock"), folder.join("Cargo.lock")).expect("a lock");
    let mut cargo = build::cargo();
    cargo.current_dir(&folder).args(["check", "--quiet", "--offline"]);
    build::printed(cargo.env("RUSTFLAGS", "-D warnings"));
}

fn built(what: &str) -> Option<&'static Path> {
    BUILT.as_deref().map_err(|missing| build::skip(what, missing)).ok()
}

/// Runs a script of `tests/browser`.
fn node(arguments: &[&Path]) -> String {
    build::printed(page::node().args(arguments))
}

/// Flies a few of the scenarios, in a long run all.
fn compare(what: &str, folder: &str) {
    let Some(file) = built(what) else { return };
    let folder = file.with_file_name(folder);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let all: Vec<_> = (0..cases(2 * KINDS, 10 * KINDS)).map(scenario).collect();
    let list = folder.join("scenarios.json");
    fs::write(&list, serde_json::to_string(&all).expect("plain")).expect("a file");
    println!("{}", node(&["played.mjs".as_ref(), file, &list, &folder]));
    let mut refused = 0;
    for (number, scenario) in all.iter().enumerate() {
        let expected = flown(&folder, scenario).unwrap_or_else(|why| {
            refused += 1;
            format!("{why:#}")
        });
        let found = fs::read_to_string(folder.join(number.to_string())).expect("an answer");
        assert!(
            found == expected,
            "scenario {number}:\n{}\n{found:.999}\n{expected:.999}",
            scenario.text
        );
    }
    assert!(refused <= all.len() / 10, "{refused} scenarios are refused");
}

/// What the host says of a scenario: its trace, or why it is refused.
fn flown(folder: &Path, Scenario { text, files }: &Scenario) -> anyhow::Result<String> {
    for (name, content) in files {
        fs::write(folder.join(name), content)?;
    }
    let mission = scenario::parse_in("scenario.toml", text, folder, Overrides::default())?;
    Ok(trace::lines(&Recording::until_refusal(&mission).0.results))
}

/// A scenario of each kind by turns.
fn scenario(number: u64) -> Scenario {
    let mut rng = ensemble::rng(0x5eed, number);
    let mut files = BTreeMap::new();
    let mut text = format!("seed = {number}\n");
    let rng = &mut rng;
    let p = [0.8, 0.9, 0.95][number as usize / 10 % 3];
    let _ = text.write_str(&match number % KINDS {
        0 => {
            let planner = ["lookahead", "cfc", "chords", "margin"][number as usize / 10 % 4];
            format!("algorithm = \"{planner}\"\nsteps = 30\n{}", line(rng))
        }
        1 => {
            let planner = ["lookahead", "scc"][number as usize / 10 % 2];
            let p = if number % 30 == 1 { "[18.0, 2.0]".to_owned() } else { p.to_string() };
            format!("algorithm = \"{planner}\"\nsteps = 24\nnoise = {{ p = {p} }}\n{}", line(rng))
        }
        2 => {
            let radius: f64 = rng.random_range(0.5..1.5);
            format!(
                "algorithm = \"lookahead\"\nsteps = 30\nvehicle = {{ kind = \"car\", reach = 3.0, radius = {radius:.3} }}\n\
                 keep_out = [{{ x = 10.0, z = 2.0, radius = {radius:.2} }}, {{ polygon = [[5, 15], [8, 15], [8, 18]] }}]\n{}",
                line(rng)
            )
        }
        3 => {
            files.insert("grid.asc", grid(rng));
            format!(
                "algorithm = \"track\"\nsteps = 80\nstart = {{ x = 3, z = 3 }}\noracle = []\nnoise = {{ p = {p} }}\n\
                 truth = {{ raster = \"grid.asc\", threshold = 5.0 }}\n"
            )
        }
        4 => {
            let from = rng.random_range(2..9);
            let fault = ["inverted = true", "garbage = true", "dropouts = 0.4", "delayed = 2", "stuck = 1"];
            let fault = fault[rng.random_range(0..fault.len())];
            format!(
                "algorithm = \"lookahead\"\nsteps = 24\nnoise = {{ p = {p} }}\nsensor = [{{ {fault}, from = {from} }}, {{ slow = 0.3 }}]\n{}",
                line(rng)
            )
        }
        5 => format!(
            "algorithm = \"track\"\nsteps = 120\narea = {{ x = [0, 160], z = [0, 60] }}\nnoise = {{ p = {p} }}\n\
             oracle = [{{ x = 8, z = 10, label = -1 }}, {{ x = 8, z = 50, label = 1 }}]\n\
             truth = {{ coast = {{ height = 6.0, length = 25.0, seed = {number} }} }}\n"
        ),
        6 => {
            let [phase, drift] = [rng.random_range(0.0..6.0), rng.random_range(0.0..0.06)];
            format!(
                "algorithm = \"track\"\nsteps = 100\narea = {{ x = [0, 200], z = [0, 60] }}\nfront = {{ speed = 0.06 }}\n\
                 start = {{ x = 8, z = 27 }}\noracle = []\nnoise = {{ p = {p} }}\n\
                 truth = {{ sine = [4.0, 100.0, {phase:.4}], slope = 0.0, intercept = 25.0, drift = [0.0, {drift:.4}] }}\n"
            )
        }
        7 => {
            let [x, z]: [f64; 2] = [rng.random_range(30.0..70.0), rng.random_range(25.0..55.0)];
            let truth = if number % 20 == 7 {
                format!("circle = [{x:.2}, {z:.2}, 15.0]")
            } else {
                let corner = |dx: f64, dz: f64| format!("[{:.2}, {:.2}]", x + dx, z + dz);
                let all = [corner(-15.0, -9.0), corner(14.0, -12.0), corner(2.0, 1.0), corner(-6.0, 16.0)];
                format!("polygon = [{}]", all.join(", "))
            };
            format!(
                "algorithm = \"track\"\nsteps = 300\narea = {{ x = [0, 100], z = [0, 80] }}\nstart = {{ x = 5, z = 5 }}\n\
                 oracle = []\nseek = {{ likely = \"spill\" }}\nnoise = {{ p = {p} }}\ntruth = {{ {truth} }}\n"
            )
        }
        8 => format!(
            "algorithm = \"lookahead\"\nsteps = 40\nreadings = 3\nprice = 4.0\nlabels = 20\n\
             errors = {{ motion = 0.02, turn = 0.01, position = 0.02, heading = 0.01 }}\n{}",
            line(rng)
        ),
        _ => {
            const LAKE: &str = include_str!("../../../host-sim/scenarios/lakes/kyyvesi.geojson");
            files.insert("lake.geojson", LAKE.into());
            let [x, radius] = [rng.random_range(-60.0..-20.0), rng.random_range(50.0..80.0)];
            format!(
                "algorithm = \"track\"\nsteps = 80\narea = {{ geojson = \"lake.geojson\", cells = 128 }}\n\
                 vehicle = {{ kind = \"boat\", reach = 10.0, step = 0.5, sharpest = 0.5 }}\n\
                 start = {{ lat = 60.1990, lon = 24.9020 }}\noracle = []\ntruth = {{ circle = [{x:.2}, -60.0, {radius:.2}] }}\n"
            )
        }
    });
    Scenario { text, files }
}

/// A line through a square of 20 m, with points that it divides.
fn line(rng: &mut ChaCha8Rng) -> String {
    let [slope, intercept] = [rng.random_range(-0.1..0.5), rng.random_range(4.0..6.0)];
    let points: Vec<_> = [[2.0, 1.0], [2.0, 15.0], [18.0, 18.0], [18.0, 1.0]]
        .iter()
        .map(|[x, z]| {
            let label = if *z > slope * x + intercept { 1 } else { -1 };
            format!("{{ x = {x}, z = {z}, label = {label} }}")
        })
        .collect();
    format!(
        "oracle = [{}]\ntruth = {{ slope = {slope:.5}, intercept = {intercept:.5} }}\n",
        points.join(", ")
    )
}

/// A hill on a grid of 20 m.
fn grid(rng: &mut ChaCha8Rng) -> String {
    let [x, z]: [f64; 2] = [rng.random_range(8.0..13.0), rng.random_range(8.0..13.0)];
    let mut text = "ncols 40\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 0.5\n".to_owned();
    for row in 0..40 {
        for column in 0..40 {
            let [dx, dz] = [0.5 * f64::from(column) - x, 20.0 - 0.5 * f64::from(row) - z];
            let _ = write!(text, "{:.3} ", 9.0 - 0.2 * (dx * dx + dz * dz));
        }
        text += "\n";
    }
    text
}
