//! One trace on every machine: missions on bare cores, boards and a RISC-V core equal those of this machine byte for
//! byte. Two Arm cores are in the emulator of these tests, and all others under QEMU.
//!
//! The programs of the bare cores are the planner with the chip's side of the link. They are compiled for Armv7E-M with
//! a single-precision unit; for Armv6-M, which has no such unit, no divider and no long multiplies; and for RISC-V.

use std::fs;
use std::process::{Command, Stdio};

use chips::budget::timing;
use chips::budget::workload::Workload;
use chips::emulator::missions::trace_here;
use chips::emulator::{Core, Emulator};
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::names::FanName;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::{Accuracy, Angle, AnyVehicle, Goal, Unicycle};
use rayon::prelude::*;
use tests::build::{has_tool, skip};
use tests::cases;
use tests::fronts::following;
use tests::lakes;
use tests::missions::{by_turns, of_any_vehicle, reading};

use crate::machines::{Kind, NRF51, STM32, bare, riscv};

const CORES: [Core; 2] = [Core::M4F, Core::M0];

fn example(text: &str) -> Mission {
    scenario::parse("", text, Overrides::default()).expect("a good scenario")
}

/// The paper's two examples, then random fields: both algorithms and look-ahead with true labels, with the paper's
/// fan and the fine one, and with labels that may be wrong, by turns. Half of those by look-ahead end when enough is
/// known.
fn of_the_unicycle() -> Vec<Mission> {
    let mut missions = [scenario::PAPER_NOISELESS, scenario::PAPER_NOISY].map(example).to_vec();
    // Most of the time goes into looking ahead: the long runs have more of it.
    for number in 0..cases(8, 40) {
        let (algorithm, is_noisy, grid) = match number % 4 {
            0 => (Algorithm::Cfc, false, FanName::Paper),
            1 => (Algorithm::Scc, true, FanName::Paper),
            2 if number % 8 == 2 => (Algorithm::Lookahead, false, FanName::Paper),
            2 => (Algorithm::Lookahead, false, FanName::Fine),
            _ => (Algorithm::Lookahead, true, FanName::Paper),
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

/// Missions of every vehicle by every algorithm, of some with robots that err. Most of those by look-ahead have far sight,
/// and half of these read only labels that carry enough.
fn of_every_vehicle() -> Vec<Mission> {
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

/// What the smallest machine is able to fly: labels are true and areas are rectangles. The paper's example; standard
/// fields by both planners with both fans, some of them until enough is known; and every vehicle, half of them with
/// robots that err.
fn small() -> Vec<Mission> {
    let fields = (0..cases(8, 80)).map(|number| {
        let algorithm = if number % 2 == 0 { Algorithm::Cfc } else { Algorithm::Lookahead };
        let mut mission = standard_field::standard(8, number, algorithm, 24);
        mission.vehicle = if number % 4 < 2 { FanName::Paper } else { FanName::Fine }.into();
        let accuracy = Accuracy::Misclassified(5_000);
        mission.goal = (number % 8 == 7).then_some(Goal { accuracy, level: 900_000 });
        mission
    });
    let vehicles = true_labels(cases(20, 120)).map(|number| of_any_vehicle(number, 16));
    [example(scenario::PAPER_NOISELESS)].into_iter().chain(fields).chain(vehicles).collect()
}

/// Of missions of any vehicle those with true labels in a rectangle: the even ones, and of five the last three.
fn true_labels(most: u64) -> impl Iterator<Item = u64> {
    (0..most).step_by(2).filter(|number| number % 5 >= 2)
}

/// Random missions of all that the firmware flies.
fn for_the_firmware() -> Vec<Mission> {
    let random = (0..cases(100, 200)).map(|it| by_turns(6, it, 10 + (it % 11) as u32));
    let readings = (0..cases(12, 48)).map(|number| reading(of_any_vehicle(number, 10)));
    random.chain(readings).chain(of_the_unicycle()).chain(of_every_vehicle()).collect()
}

fn fronts(count: u64, steps: u32) -> Vec<Mission> {
    (0..count).map(|number| following(5, number, steps)).collect()
}

/// Flies missions here and on a machine, and compares the traces. Several in a row are flown on each such machine: one
/// leaves nothing behind for the next.
fn compare(kind: Kind, missions: &[Mission]) {
    let share = missions.len().div_ceil(2 * rayon::current_num_threads());
    missions.par_chunks(share).for_each(|missions| {
        let Some(mut machine) = kind.start() else { return };
        for mission in missions {
            let flown = machine.fly(mission);
            let flown = flown.unwrap_or_else(|e| panic!("{}: {e}: {mission:?}", kind.name));
            let there = trace::lines(&flown.recording.results);
            assert_eq!(there, trace_here(mission), "{}: {mission:?}", kind.name);
        }
    });
}

#[test]
fn bare_cores_make_the_traces_of_this_machine() {
    let missions = of_the_unicycle();
    let is_known = |it: &&Mission| trace_here(it).contains("\"reason\":\"known\"");
    assert!(missions.iter().filter(is_known).count() >= 3);
    for core in CORES {
        compare(bare(core, "standard"), &missions);
        compare(bare(core, "vehicles"), &of_every_vehicle());
    }
    compare(riscv("vehicles"), &small());
}

#[test]
fn bare_cores_make_the_same_maps_of_fronts() {
    compare(bare(Core::M4F, "track"), &fronts(cases(8, 24), 60));
    compare(riscv("track"), &fronts(cases(8, 40), 60));
    // A Cortex-M0 needs thirty times as many instructions: a few steps of two kinds.
    compare(bare(Core::M0, "track"), &fronts(cases(2, 24), cases(8, 60) as u32));
}

/// Lakes from maps, by every planner and vehicle, with positions and labels that err. The budget's test flies more of them,
/// on a bare core.
#[test]
fn in_lakes_the_first_board_makes_the_traces_of_this_machine() {
    let numbers = (0..cases(12, 144)).map(|it| 4 * it + it / 9);
    compare(STM32, &numbers.map(|it| lakes::for_a_chip(it, 256, 24)).collect::<Vec<_>>());
}

#[test]
fn the_first_board_makes_the_traces_of_this_machine() {
    compare(STM32, &for_the_firmware());
    compare(STM32, &small());
    let missions = fronts(cases(8, 40), 60);
    compare(STM32, &missions);
    let watch = |it: Mission| Mission { watch: Some(12.3), until_closed: false, ..it };
    compare(STM32, &missions.into_iter().step_by(2).map(watch).collect::<Vec<_>>());
}

/// Its look-ahead has near sight, which counts on one label a motion: only the others take in labels on the way.
#[test]
fn the_second_board_makes_the_traces_of_this_machine() {
    compare(NRF51, &small());
    let readings = true_labels(30).map(|number| reading(of_any_vehicle(number, 8)));
    let readings: Vec<_> = readings.filter(|it| it.algorithm == Algorithm::Cfc).collect();
    compare(NRF51, &readings);
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
    let Some(elf_file) = bare(Core::M4F, "small").elf() else { return };
    if !has_tool("qemu-system-arm") {
        skip("instruction counts under QEMU", "qemu-system-arm is not on PATH");
        return;
    }
    let elf = fs::read(&elf_file).expect("cargo left an ELF");
    let workload = Workload::of("small")[0];
    let mut emulator = Emulator::load(&elf, Core::M4F);
    emulator.fly(&workload.mission(3)).expect("it flies as the host");
    let flights = timing::fly(Core::M4F, &elf, &[3], |it| workload.mission(it), None);

    let folder = tempfile::tempdir().expect("a temporary folder");
    let [input, log] = ["input", "log"].map(|name| folder.path().join(name));
    fs::write(&input, emulator.supplied()).expect("a file");
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
    for calls_here in [&flights[0].plans, &flights[0].observations, &flights[0].estimates] {
        let here: Vec<u64> = calls_here.iter().map(|call| call.instructions).collect();
        let there = calls(&executed, calls_here.first().expect("it was called").function);
        assert_eq!(there, here, "QEMU (left), the emulator (right)");
    }
}
