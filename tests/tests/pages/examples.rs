//! The examples of `planner-core`, run: each fails by itself where it does not find its line.

#![allow(clippy::duplicate_mod, reason = "each example has the field that they share")]

#[path = "../../../planner-core/examples/analogue_sensor.rs"]
mod analogue_sensor;
#[path = "../../../planner-core/examples/asynchronous.rs"]
mod asynchronous;
#[path = "../../../planner-core/examples/garden.rs"]
mod garden;
#[path = "../../../planner-core/examples/noisy_labels.rs"]
mod noisy_labels;
#[path = "../../../planner-core/examples/own_dynamics.rs"]
mod own_dynamics;
#[path = "../../../planner-core/examples/own_robot.rs"]
mod own_robot;
#[path = "../../../planner-core/examples/readings_on_the_way.rs"]
mod readings_on_the_way;
#[path = "../../../planner-core/examples/sleep_and_wake.rs"]
mod sleep_and_wake;

#[test]
fn each_finds_its_line() {
    let works = |name: &str, main: fn() -> Result<(), Box<dyn std::error::Error>>| {
        main().unwrap_or_else(|error| panic!("{name}: {error}"));
    };
    works("analogue_sensor", analogue_sensor::main);
    works("asynchronous", asynchronous::main);
    works("garden", garden::main);
    works("noisy_labels", noisy_labels::main);
    works("own_dynamics", own_dynamics::main);
    works("own_robot", own_robot::main);
    works("readings_on_the_way", readings_on_the_way::main);
    works("sleep_and_wake", sleep_and_wake::main);
}

/// None that is added is left out.
#[test]
fn these_are_all() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../planner-core/examples");
    let all = std::fs::read_dir(folder).expect("examples").map(|it| it.expect("a file").path());
    let missing: Vec<_> = all
        .filter_map(|path| {
            let name = path.file_name()?.to_str()?.to_owned();
            let is_run = include_str!("examples.rs").contains(&format!("examples/{name}\""));
            (path.extension()? == "rs" && !is_run).then_some(name)
        })
        .collect();
    assert!(missing.is_empty(), "not run: {missing:?}");
}

/// The program that the READMEs show is the front page's, which is run as a doctest.
#[test]
fn the_readmes_show_the_program_of_the_front_page() {
    let page = include_str!("../../../planner-core/src/lib.rs");
    let block = page.split("//! ```\n").nth(1).expect("a program");
    let shown = block.lines().filter(|line| !line.starts_with("//! #"));
    let shown: Vec<_> = shown.map(|line| line.strip_prefix("//! ").unwrap_or("")).collect();
    assert!(shown.len() <= 15, "{} lines", shown.len());
    for readme in
        [include_str!("../../../README.md"), include_str!("../../../planner-core/README.md")]
    {
        let block = readme.split("```rust\n").nth(1).and_then(|rest| rest.split("\n```").next());
        let block: Vec<_> = block.expect("a program").lines().collect();
        assert_eq!(block, shown);
    }
}

/// The page tells how long each is.
#[test]
fn the_page_tells_their_lines() {
    let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let rows = include_str!("../../../docs/your-robot.md").lines().filter_map(|line| {
        let (path, rest) = line.split_once("](../planner-core/")?.1.split_once(") | ")?;
        let told = rest.strip_suffix(" |")?.rsplit(" | ").next()?.parse::<usize>().ok()?;
        let text = std::fs::read_to_string(docs.join("../planner-core").join(path)).expect(path);
        assert_eq!(told, text.lines().count(), "{path}");
        Some(())
    });
    assert!(rows.count() > 8);
}
