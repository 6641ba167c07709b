//! One trace on every machine: missions on bare Arm cores, in the emulator that is part of these
//! tests, are those of the host, byte for byte.
//!
//! The programs are the planner with the chip's side of the link, compiled for Armv7E-M with a
//! single-precision unit and for Armv6-M, which has neither that nor a divider nor long multiplies.

use std::hash::{DefaultHasher, Hasher as _};

use host_sim::field;
use host_sim::mission::{Algorithm, Mission};
use host_sim::recording::Recording;
use host_sim::scenario::{self, Overrides};
use host_sim::trace;
use host_sim::world::{Extent, NoiseModel};
use rayon::prelude::*;
use tests::bench::{self, CORES};
use tests::emulator::{Core, Emulator};

/// The paper's two examples, then random fields, each algorithm by turns.
fn missions() -> Vec<Mission> {
    let example = |text| scenario::parse("", text, Overrides::default()).expect("a good scenario");
    let mut missions = vec![example(scenario::PAPER_NOISELESS), example(scenario::PAPER_NOISY)];
    for number in 0..20 {
        let mut mission = field::standard(5, number, Algorithm::Cfc, 20);
        if number % 2 == 1 {
            mission = field::standard(5, number, Algorithm::Scc, 8);
            mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
        }
        missions.push(mission);
    }
    missions
}

fn hash(traces: &[String]) -> u64 {
    let mut hasher = DefaultHasher::new();
    for trace in traces {
        hasher.write(trace.as_bytes());
    }
    hasher.finish()
}

#[test]
fn every_machine_makes_the_same_traces() {
    let missions = missions();
    let here = |mission: &Mission| {
        trace::lines(&Recording::of(mission).expect("labels that are certain are true"))
    };
    let host: Vec<String> = missions.iter().map(here).collect();
    let mut hashes = vec![("host", hash(&host))];
    for (core, target) in CORES {
        let Some(program) = bench::build(env!("CARGO_TARGET_TMPDIR"), target) else { continue };
        let elf = program("standard");
        let there = |mission: &Mission| {
            let mut emulator = Emulator::load(&elf, core);
            let played = bench::fly(&mut emulator, mission).expect("it flies as the host");
            trace::lines(&played.recording)
        };
        let chip: Vec<String> = missions.par_iter().map(there).collect();
        for (number, (chip, host)) in chip.iter().zip(&host).enumerate() {
            assert_eq!(chip, host, "mission {number}: {core:?} (left), the host (right)");
        }
        hashes.push((target, hash(&chip)));
    }
    for (machine, hash) in &hashes {
        println!("{hash:016x}  {machine}");
    }
    assert!(hashes.iter().all(|(_, hash)| *hash == hashes[0].1));
}

#[test]
fn a_mission_leaves_nothing_behind() {
    let (core, target) = CORES[0];
    let Some(program) = bench::build(env!("CARGO_TARGET_TMPDIR"), target) else { return };
    let mut emulator = Emulator::load(&program("standard"), core);
    let missions = missions();
    let [first, second] = [(); 2].map(|()| {
        let fly = |mission| bench::fly(&mut emulator, mission).expect("it flies as the host");
        missions[..4].iter().map(fly).map(|it| trace::lines(&it.recording)).collect::<Vec<_>>()
    });
    assert_eq!(first, second);
}

#[test]
fn the_small_program_has_one_algorithm_and_says_so() {
    let (core, target) = CORES[0];
    assert_eq!(core, Core::M4F);
    let Some(program) = bench::build(env!("CARGO_TARGET_TMPDIR"), target) else { return };
    let mut emulator = Emulator::load(&program("small"), core);
    let refusal = |emulator: &mut Emulator, mission: &Mission| {
        bench::fly(emulator, mission).expect_err("it is declined").to_string()
    };
    let noisy = field::standard(5, 1, Algorithm::Scc, 8);
    assert!(refusal(&mut emulator, &noisy).contains("algorithm"));
    let long = field::standard(5, 1, Algorithm::Cfc, 13);
    assert!(refusal(&mut emulator, &long).contains("at most 12"));
    let fits = field::standard(5, 1, Algorithm::Cfc, 12);
    assert!(bench::fly(&mut emulator, &fits).is_ok());
}
