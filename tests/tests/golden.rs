//! The standard scenarios at a glance: what each comes to, to the last step. A change of behaviour
//! shows as a diff of `golden/scenarios.txt`; `UPDATE_EXPECT=1 cargo test -p tests --test golden`
//! writes it anew.

use std::fmt::Write as _;
use std::path::Path;

use expect_test::expect_file;
use host_sim::commands::PAPER_TITLE;
use host_sim::figure::Figure;
use host_sim::polygon::misclassified;
use host_sim::recording::{Recording, recovery_name};
use host_sim::report;
use host_sim::scenario::{self, Overrides};
use nalgebra::Point2;

#[test]
fn standard_scenarios() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenarios");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .expect("the scenarios")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    files.sort();
    let mut table = String::new();
    for file in files {
        let mission = scenario::read(&file, Overrides::default()).expect("a good file");
        let recording = Recording::of(&mission).expect("no contradiction");
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        describe(&mut table, &name, &recording).expect("a string");
    }
    expect_file!["golden/scenarios.txt"].assert_eq(&table);
}

/// The README's picture is the one that the bare command draws.
#[test]
fn the_picture_in_the_readme() {
    let mission = scenario::parse("", scenario::PAPER_NOISELESS, Overrides::default());
    let recording = Recording::of(&mission.expect("a good file")).expect("noiseless");
    let figure = Figure::of(PAPER_TITLE, &recording).svg().expect("a figure");
    expect_file!["../../host-sim/figures/paper-noiseless.svg"].assert_eq(&figure);
}

fn describe(table: &mut String, name: &str, recording: &Recording) -> std::fmt::Result {
    let mission = &recording.mission;
    writeln!(table, "{name}: {}", report::line(&mission.truth))?;
    for (recorded, number) in recording.steps.iter().zip(1..) {
        let step = &recorded.step;
        let at = Point2::<f64>::from(step.pose.site);
        let line = format!(
            "{number:>4} {} {:>5} {:>5.2} {:>3.1} ({:.4}, {:.4}) {:>2} {:>6.3} bits {}",
            step.motion.stage.map_or("--", host_sim::recording::stage_name),
            step.motion.action.0,
            step.motion.control.w,
            step.motion.control.v,
            at.x,
            at.y,
            step.reading.map_or("-".into(), |r| format!("{:+}", r.sign())),
            recorded.bits,
            step.motion.recovery.map_or("", recovery_name),
        );
        writeln!(table, "{}", line.trim_end())?;
    }
    writeln!(table, "     {} samples; ended by: {}", recording.samples(), recording.end.name())?;
    for (name, estimate) in report::estimates(recording) {
        let Some(line) = estimate else {
            writeln!(table, "     {name}: none")?;
            continue;
        };
        let error = line.angle_to_deg(&mission.truth);
        let wrong = 100.0 * misclassified(mission.config.area, &mission.truth, &line);
        let line = report::line(&line);
        writeln!(table, "     {name}: {line}, off by {error:.3} deg and {wrong:.3} %")?;
    }
    writeln!(table)
}
