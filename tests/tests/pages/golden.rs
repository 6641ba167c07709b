//! Results that change only on purpose.
//!
//! `golden/scenarios.txt` contains the standard scenarios to the last step. `golden/hashes.txt` contains hashes of the
//! traces of 200 missions, of the figures, and of the output of campaigns for programs.
//! `UPDATE_EXPECT=1 cargo test -p tests golden::` writes both anew.

use std::fmt::Write as _;

use expect_test::expect_file;
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::results::{LineError, Results};
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use host_sim::report::picture::Picture;
use host_sim::report::text;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::{Policy, Prior};
use tests::{build, command};

#[test]
fn standard_scenarios() {
    let folder = build::root().join("host-sim/scenarios");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .expect("the scenarios")
        .map(|entry| entry.expect("an entry").path())
        .filter(|file| file.is_file())
        .collect();
    files.sort();
    let mut table = String::new();
    for file in files {
        let mission = scenario::read(&file, Overrides::default()).expect("a good file");
        let recording = Recording::of(&mission).expect("no contradiction");
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        describe(&mut table, &name, &recording.results).expect("a string");
    }
    expect_file!["../golden/scenarios.txt"].assert_eq(&table);
}

/// FNV-1a, so that a hash means the same for ever.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Missions from this number on are look-ahead's.
const LOOKAHEAD: u64 = 200;

/// A random mission of each other algorithm by turns, with noise and without.
fn mission(number: u64) -> Mission {
    let algorithms = [Algorithm::Cfc, Algorithm::Scc, Algorithm::Random, Algorithm::Random];
    let algorithm = match number {
        LOOKAHEAD.. => Algorithm::Lookahead,
        _ => algorithms[number as usize % 4],
    };
    let steps = 10 + (number % 50) as u32;
    let mut mission = standard_field::standard(17, number, algorithm, steps);
    if algorithm == Algorithm::Scc || number % 4 == 3 {
        let p = [0.6, 0.7, 0.9, 0.99][number as usize / 4 % 4];
        let extents = [Extent::OutsideBalls(0.5), Extent::OutsideBalls(0.0), Extent::Band(3.0)];
        mission.noise = Some(NoiseModel { p, extent: extents[number as usize / 4 % 3] });
        mission.policy =
            [Policy::MixtureOfOwn, Policy::Joint, Policy::MixtureOfStart][number as usize / 8 % 3];
        mission.prior = [Prior::Area, Prior::Sequences][number as usize / 4 % 2];
    }
    mission
}

#[test]
fn hashes_of_traces_figures_and_campaigns() {
    let mut table = String::new();
    let mut line = |name: &str, text: &str| {
        let _ = writeln!(table, "{:016x}  {:>7} bytes  {name}", hash(text), text.len());
    };
    for number in 0..LOOKAHEAD + 24 {
        let recording = Recording::of(&mission(number)).expect("trusted labels are true");
        line(&format!("trace {number}"), &trace::lines(&recording.results));
        if number % 10 < 2 {
            line(&format!("report {number}"), &text::mission("a mission", &recording.results));
            let figure = Picture::of("a mission", &recording).svg();
            line(&format!("figure {number}"), &figure);
        }
    }
    let program = build::root().join("host-sim/scenarios");
    let run = |args: &str| command::told(&format!("host-sim {args}"));
    for args in [
        "campaign --fields 40 --steps 40 --format json",
        "campaign --fields 40 --steps 40",
        "campaign --fields 40 --algorithm random --format json",
        "campaign --fields 20 --steps 36 --algorithm scc --format json",
        "campaign --fields 20 --steps 36 --algorithm scc --policy joint --prior sequences",
        "campaign --fields 20 --steps 12 --algorithm random --p 0.8 --format json",
        "campaign --fields 40 --steps 40 --algorithm lookahead --format json",
        "campaign --fields 10 --steps 24 --algorithm lookahead --p 0.8 --format json",
        "campaign --fields 20 --steps 12 --compare cfc,lookahead,margin",
    ] {
        line(args, &run(args));
    }
    let samples = program.join("../../fuzz/corpus/samples/by-hand.csv");
    let samples = samples.to_str().expect("UTF-8");
    line("replay", &run(&format!("replay {samples} --format json")));
    expect_file!["../golden/hashes.txt"].assert_eq(&table);
}

fn describe(table: &mut String, name: &str, results: &Results) -> std::fmt::Result {
    let truth = results.start.truth.as_ref();
    writeln!(table, "{name}: {}", truth.map_or_else(|| "a front".into(), text::line))?;
    for step in &results.steps {
        let line = format!(
            "{:>4} {} {:>5} {:>5.2} {:>3.1} ({:.4}, {:.4}) {:>2} {:>6.3} bits {}",
            step.step,
            step.problem.as_deref().unwrap_or("--"),
            step.action.index,
            step.action.w,
            step.action.v,
            step.pose.x,
            step.pose.z,
            step.label.map_or("-".into(), |label| format!("{label:+}")),
            step.bits,
            step.recovery.as_deref().unwrap_or_default(),
        );
        writeln!(table, "{}", line.trim_end())?;
    }
    writeln!(table, "     {} samples; ended by: {}", results.samples(), results.end.reason)?;
    for (name, estimate) in text::estimates(results) {
        let Some(line) = estimate else {
            writeln!(table, "     {name}: none")?;
            continue;
        };
        let LineError { degrees, misclassified } = line.error.expect("there is a truth");
        let (line, wrong) = (text::line(&line), 100.0 * misclassified);
        writeln!(table, "     {name}: {line}, off by {degrees:.3} deg and {wrong:.3} %")?;
    }
    writeln!(table)
}
