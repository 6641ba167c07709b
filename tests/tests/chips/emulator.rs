//! One trace on every machine: missions on bare Arm cores, in the emulator of these tests, equal those of the host byte
//! for byte.
//!
//! The programs are the planner with the chip's side of the link. They are compiled for two cores: Armv7E-M with a
//! single-precision unit, and Armv6-M, which has no such unit, no divider and no long multiplies.

use std::fs;
use std::hash::{DefaultHasher, Hasher as _};
use std::process::{Command, Stdio};

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::report::trace;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::motion::unicycle::Grid;
use planner_core::{Accuracy, Angle, AnyVehicle, Goal, Policy, Unicycle};
use rayon::prelude::*;
use tests::budget::timing;
use tests::budget::workload::Workload;
use tests::emulator::missions::{self, CORES};
use tests::emulator::{Core, Emulator};
use tests::fronts::following;
use tests::missions::of_any_vehicle;
use tests::program::build;
use tests::{cases, is_long};

/// Missions of every vehicle by every algorithm, of some with robots that err. Most of those by look-ahead have far sight,
/// and half of these read only labels that carry enough.
fn vehicles() -> Vec<Mission> {
    let mission = |number| {
        let mut mission = of_any_vehicle(number, 8);
        if mission.algorithm == Algorithm::Lookahead && number % 8 > 2 {
            mission.asking.price = Some(3.0);
            mission.asking.worth = if number % 2 == 0 { 0.9 } else { 0.2 };
        }
        mission
    };
    (0..cases(8, 24)).map(mission).collect()
}

/// The paper's two examples, then random fields: both algorithms and look-ahead with true labels, with the paper's
/// fan and the fine one, and with labels that may be wrong, by turns. Half of those by look-ahead end when enough is
/// known.
fn missions() -> Vec<Mission> {
    let example = |text| scenario::parse("", text, Overrides::default()).expect("a good scenario");
    let mut missions = vec![example(scenario::PAPER_NOISELESS), example(scenario::PAPER_NOISY)];
    // Most of the time goes into looking ahead: the long runs have more of it.
    for number in 0..cases(8, 40) {
        let (algorithm, is_noisy, grid) = match number % 4 {
            0 => (Algorithm::Cfc, false, Grid::Paper),
            1 => (Algorithm::Scc, true, Grid::Paper),
            2 if number % 8 == 2 => (Algorithm::Lookahead, false, Grid::Paper),
            2 => (Algorithm::Lookahead, false, Grid::Fine),
            _ => (Algorithm::Lookahead, true, Grid::Paper),
        };
        let steps = match number % 16 {
            2 | 3 | 6 | 7 => 32, // with an audit
            _ if is_noisy => 8,
            _ => 20,
        };
        let mut mission = standard_field::standard(5, number, algorithm, steps);
        mission.vehicle = grid.into();
        if matches!(number % 16, 3 | 7) {
            // Long motions, so that the steps suffice for the audit as well.
            let far = Unicycle::new(1_000, 1.57, 61, 100).expect("a unicycle");
            mission.vehicle = AnyVehicle::Unicycle(far);
        }
        if is_noisy {
            mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
        }
        let accuracy = match number % 16 {
            2 => Some(Accuracy::Misclassified(30_000)),
            3 => Some(Accuracy::Misclassified(400_000)),
            6 => Angle::from_degrees(5.0).ok().map(Accuracy::SlopeArc),
            7 => Angle::from_degrees(45.0).ok().map(Accuracy::SlopeArc),
            _ => None,
        };
        mission.goal = accuracy.map(|accuracy| Goal { accuracy, level: 500_000 });
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
    let known = compare("standard", &missions());
    assert!(known >= 3, "{known} end when enough is known");
}

#[test]
fn every_machine_makes_the_same_traces_of_every_vehicle_and_of_robots_that_err() {
    compare("vehicles", &vehicles());
}

#[test]
fn every_machine_makes_the_same_traces_and_maps_of_fronts() {
    let missions = |count| (0..count).map(|number| following(5, number, 60)).collect::<Vec<_>>();
    compare_on(&CORES[..1], "track", &missions(cases(8, 24)));
    // A Cortex-M0 needs thirty times as many instructions. It flies one mission, and a few steps of one of each other
    // kind; in a long run all.
    let few = (1..4).map(|number| following(5, number, 10));
    let few = missions(1).into_iter().chain(few).collect();
    compare_on(&CORES[1..], "track", &if is_long() { missions(24) } else { few });
}

/// Flies missions here and with a program on each core; how many of them end when enough is known.
fn compare(name: &str, missions: &[Mission]) -> usize {
    compare_on(&CORES, name, missions)
}

fn compare_on(cores: &[(Core, &str)], name: &str, missions: &[Mission]) -> usize {
    let here = |mission: &Mission| {
        trace::lines(&Recording::of(mission).expect("labels that are certain are true").results)
    };
    let host: Vec<String> = missions.iter().map(here).collect();
    let known = host.iter().filter(|trace| trace.contains("\"reason\":\"known\"")).count();
    let mut hashes = vec![("host", hash(&host))];
    for &(core, target) in cores {
        let Some(program) = missions::build(target) else { continue };
        let elf = program(name);
        let there = |mission: &Mission| {
            let mut emulator = Emulator::load(&elf, core);
            let played = missions::fly(&mut emulator, mission).expect("it flies as the host");
            trace::lines(&played.recording.results)
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
    known
}

#[test]
fn a_mission_leaves_nothing_behind() {
    let (core, target) = CORES[0];
    let Some(program) = missions::build(target) else { return };
    let mut emulator = Emulator::load(&program("standard"), core);
    let missions = missions();
    let [first, second] = [(); 2].map(|()| {
        let fly = |mission| missions::fly(&mut emulator, mission).expect("it flies as the host");
        missions[..6]
            .iter()
            .map(fly)
            .map(|it| trace::lines(&it.recording.results))
            .collect::<Vec<_>>()
    });
    assert_eq!(first, second);
}

#[test]
fn the_small_program_flies_with_true_labels_and_says_so() {
    let (core, target) = CORES[0];
    assert_eq!(core, Core::M4F);
    let Some(program) = missions::build(target) else { return };
    let mut emulator = Emulator::load(&program("small"), core);
    let refusal = |emulator: &mut Emulator, mission: &Mission| {
        missions::fly(emulator, mission).expect_err("it is declined").to_string()
    };
    let mut noisy = standard_field::standard(5, 1, Algorithm::Lookahead, 8);
    noisy.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
    assert!(refusal(&mut emulator, &noisy).contains("algorithm"));
    noisy.algorithm = Algorithm::Scc;
    assert!(refusal(&mut emulator, &noisy).contains("algorithm"));
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        let long = standard_field::standard(5, 1, algorithm, 13);
        assert!(refusal(&mut emulator, &long).contains("at most 12"));
        let fits = standard_field::standard(5, 1, algorithm, 12);
        assert!(missions::fly(&mut emulator, &fits).is_ok());
    }
}

/// What a function executed at each call, by a log of program counters.
fn calls(executed: &[u32], function: u32) -> Vec<u64> {
    let mut calls = Vec::new();
    for (entry, pcs) in executed.windows(2).enumerate().filter(|(_, pcs)| pcs[1] == function) {
        let returns = pcs[0] + 4; // after the call, which is a word long
        let body = executed[entry + 1..].iter().take_while(|pc| **pc != returns);
        calls.push(body.count() as u64);
    }
    calls
}

#[test]
fn qemu_executes_as_many_instructions() {
    let (core, target) = CORES[0];
    let Some(program) = missions::build(target) else { return };
    if !build::has_tool("qemu-system-arm") {
        build::skip("instruction counts under QEMU", "qemu-system-arm is not on PATH");
        return;
    }
    let elf = program("small");
    let workload = Workload {
        algorithm: Algorithm::Cfc,
        policy: Policy::default(),
        steps: 12,
        random: 4,
        searched: 0,
        sought: 0,
        calls: None,
        vehicle: Grid::Paper.into(),
        noise: None,
        position: 0.0,
        watch: None,
    };
    let (_, told) = missions::fly_and_record(&mut Emulator::load(&elf, core), &workload.mission(3))
        .expect("it flies as the host");
    let flights = timing::fly(&elf, &workload, &[3]);

    let folder = tempfile::tempdir().expect("a temporary folder");
    let [elf_file, input, log] = ["elf", "input", "log"].map(|name| folder.path().join(name));
    fs::write(&elf_file, &elf).expect("a file");
    fs::write(&input, &told).expect("a file");
    // One instruction a block, and a line for each; at the end of its input the program ends.
    let qemu = Command::new("qemu-system-arm")
        .args(["-M", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"])
        .args(["-singlestep", "-d", "exec,nochain", "-D"])
        .arg(&log)
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(&elf_file)
        .stdin(fs::File::open(&input).expect("it was written"))
        .stdout(Stdio::null())
        .status()
        .expect("QEMU starts");
    assert!(qemu.success(), "{qemu}");
    // Trace 0: host address [... / program counter / ...] name
    let log = fs::read_to_string(log).expect("QEMU left a log");
    let counter = |line: &str| {
        let counter = line.strip_prefix("Trace")?.split('[').nth(1)?.split('/').nth(1)?;
        u32::from_str_radix(counter, 16).ok()
    };
    let executed: Vec<u32> = log.lines().filter_map(counter).collect();

    let mut compared = 0;
    for calls_here in [&flights[0].plans, &flights[0].observations, &flights[0].estimates] {
        let here: Vec<u64> = calls_here.iter().map(|call| call.instructions).collect();
        let there = calls(&executed, calls_here.first().expect("it was called").function);
        assert_eq!(there, here, "QEMU (left), the emulator (right)");
        compared += here.iter().sum::<u64>();
    }
    println!("{compared} instructions of plans, observations and estimates: as many under QEMU");
}
