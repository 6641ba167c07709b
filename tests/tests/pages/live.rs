//! A live page in a browser (`browser/live.mjs`): steps as they are made, a line that breaks, the end.
//!
//! The browser says how many steps are to be made, so nothing depends on time.

use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Stdio;

use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::report::live::Live;
use host_sim::report::page::{Chapter, Page};
use tests::build;

use crate::page::{lacks_browser, node};

#[test]
fn a_line_in_a_browser() {
    look_at("line", include_str!("../../../host-sim/scenarios/begin-noisy.toml"));
}

#[test]
fn a_coast_in_a_browser() {
    look_at("coast", include_str!("../../../host-sim/scenarios/coast.toml"));
}

#[test]
fn a_spill_in_a_browser() {
    look_at("spill", include_str!("../../../host-sim/scenarios/begin-spill.toml"));
}

#[test]
fn a_front_that_moves_away_in_a_browser() {
    // It moves ten times as fast as the planner is told, so the robot loses it.
    let text = include_str!("../../../host-sim/scenarios/moving-front.toml");
    look_at("lost", &text.replace("drift = [0.0, 0.05]", "drift = [0.0, 0.5]"));
}

fn look_at(name: &str, text: &str) {
    if lacks_browser("pages in a browser") {
        return;
    }
    let place = build::scratch().join("pages");
    fs::create_dir_all(&place).expect("a folder");
    let report = place.join(format!("live-{name}.html"));
    let mission = scenario::parse(name, text, Overrides::default()).expect("a good file");
    let mut live = Live::open(&"127.0.0.1:0".parse().expect("an address"), name, &mission)
        .expect("a free port");
    let mut node = node();
    node.arg("live.mjs").arg(live.link()).args([&report, &place]).arg(name);
    let mut node = node.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("node starts");
    let mut answer = node.stdin.take().expect("a pipe");
    let mut said = BufReader::new(node.stdout.take().expect("a pipe")).lines();
    // How many steps the browser still waits for.
    let mut ask = || said.next().expect("a line").expect("text");
    let mut left = ask();
    let (recording, refusal) = Recording::until_refusal_watched(&mission, |recorder| {
        live.step(recorder);
        let Ok(steps) = left.parse::<usize>() else { return };
        left = (steps - 1).to_string();
        if steps == 1 {
            writeln!(answer).expect("it listens");
            left = ask();
        }
    });
    assert!(refusal.is_none(), "{refusal:?}");
    assert_eq!(left, "all", "{name}");
    let planner = mission.algorithm.title();
    let chapter = Chapter::new(format!("Flown by {planner}"), [(planner, &recording)]);
    fs::write(&report, Page::new(name, vec![chapter]).html()).expect("a page");
    live.end(&recording);
    writeln!(answer).expect("it listens");
    let faults: Vec<_> = said.map(|it| it.expect("text")).collect();
    assert!(node.wait().expect("it ends").success(), "{}", faults.join("\n"));
}
