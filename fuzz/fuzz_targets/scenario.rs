#![no_main]
//! Scenario files: one that is taken flies and leaves a trace that can be read again; one that is not gets one line
//! that names the file.

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace::{self, Record};
use host_sim::world::errors::{CUT, Errors};
use libfuzzer_sys::fuzz_target;
use planner_core::Workspace as _;

fuzz_target!(|text: &str| {
    let overrides = Overrides::default();
    let mission = match scenario::parse("it.toml", text, overrides) {
        Ok(mission) => mission,
        Err(error) => {
            let message = format!("{error:#}");
            assert!(message.starts_with("it.toml:") && !message.contains('\n'), "{message}");
            return;
        }
    };
    // Algorithm 1 may be misled by labels that are not true, and each planner by positions that err by more than it
    // was told: an error, and nothing else.
    let recording = match Recording::of(&mission) {
        Ok(recording) => recording,
        Err(error) => {
            let noisy = mission.noise.is_some_and(|noise| noise.p < 1.0);
            let strays = mission.config.tolerance.metres() < CUT * mission.errors.position;
            assert!(noisy && mission.algorithm == Algorithm::Cfc || strays, "{error:#}");
            return;
        }
    };
    for line in trace::lines(&recording.results).lines() {
        Record::read(line.as_bytes()).expect("a record");
    }
    // A robot that errs may end outside.
    let errs = mission.errors != Errors::default();
    for (step, recorded) in recording.steps.iter().zip(&recording.results.steps) {
        assert!(errs || mission.config.area.contains(step.pose.site));
        assert!(
            recorded.bits.is_finite()
                && recorded.slope_arcs.iter().flatten().all(|it| it.is_finite())
        );
    }
});
