//! One trace on every machine: the same missions here, on the firmwares of two boards and on a RISC-V core, byte for
//! byte. All but the first run under QEMU.
//!
//! The smallest machine, the micro:bit, must be able to fly them. So labels are true and areas are rectangles.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::report::trace;
use planner_core::motion::unicycle::Grid;
use planner_core::{Accuracy, Goal};
use rayon::prelude::*;
use tests::cases;
use tests::fronts::following;
use tests::machines::{Kind, Machine, NRF51, STM32, riscv};
use tests::missions::{of_any_vehicle, reading};

const SEED: u64 = 8;

const MACHINES: [Kind; 3] = [STM32, NRF51, riscv("vehicles")];

/// The paper's example; standard fields by both planners with both fans, some of them until enough is known; and every
/// vehicle, half of them with robots that err.
fn missions() -> Vec<Mission> {
    let overrides = Overrides::default();
    let example = scenario::parse("", scenario::PAPER_NOISELESS, overrides).expect("a scenario");
    let fields = (0..cases(8, 80)).map(|number| {
        let algorithm = if number % 2 == 0 { Algorithm::Cfc } else { Algorithm::Lookahead };
        let mut mission = standard_field::standard(SEED, number, algorithm, 24);
        mission.vehicle = if number % 4 < 2 { Grid::Paper } else { Grid::Fine }.into();
        let accuracy = Accuracy::Misclassified(5_000);
        mission.goal = (number % 8 == 7).then_some(Goal { accuracy, level: 900_000 });
        mission
    });
    // Of these the even ones have true labels, and two of five a polygon.
    let vehicles = (0..cases(20, 120)).step_by(2).filter(|number| number % 5 >= 2);
    let vehicles = vehicles.map(|number| of_any_vehicle(number, 16));
    [example].into_iter().chain(fields).chain(vehicles).collect()
}

/// The programs of the two boards take in labels on the way; that of the RISC-V core has no code for them.
#[test]
fn the_boards_take_in_labels_on_the_way() {
    let vehicles = (0..30).step_by(2).filter(|number| number % 5 >= 2);
    let missions: Vec<_> = vehicles.map(|number| reading(of_any_vehicle(number, 8))).collect();
    for kind in [STM32, NRF51] {
        let Some(mut machine) = Machine::start(kind, &[]) else { continue };
        for mission in &missions {
            let here = Recording::of(mission).expect("labels are true");
            let flown = machine.fly(mission);
            // The micro:bit's look-ahead has near sight, which counts on one label a motion.
            if kind.name == NRF51.name && mission.algorithm == Algorithm::Lookahead {
                let refusal = flown.expect_err("it is declined").to_string();
                assert!(refusal.contains("readings: declined"), "{refusal}");
                continue;
            }
            let flown = flown.unwrap_or_else(|e| panic!("{}: {e}: {mission:?}", kind.name));
            let there = trace::lines(&flown.recording.results);
            assert_eq!(there, trace::lines(&here.results), "{}: {mission:?}", kind.name);
        }
    }
}

#[test]
fn four_machines_make_the_same_traces_byte_for_byte() {
    compare(&missions(), &MACHINES);
}

/// Every pose, and every vertex of the map. The micro:bit has no room for the follower of fronts.
#[test]
fn three_machines_make_the_same_maps_of_fronts_byte_for_byte() {
    let missions: Vec<_> = (0..cases(8, 40)).map(|number| following(SEED, number, 60)).collect();
    compare(&missions, &[STM32, riscv("track")]);
    // The program of the RISC-V core watches no stretch.
    let watch = |it: Mission| Mission { watch: Some(12.3), until_closed: false, ..it };
    let watching: Vec<_> = missions.iter().step_by(2).cloned().map(watch).collect();
    compare(&watching, &[STM32]);
    if let Some(mut small) = Machine::start(NRF51, &[]) {
        let refusal = small.fly(&missions[0]).expect_err("it is declined").to_string();
        assert!(refusal.contains("algorithm: found track, declined"), "{refusal}");
    }
}

/// Flies missions here and on machines, and compares the traces.
fn compare(missions: &[Mission], kinds: &[Kind]) {
    let here: Vec<String> = missions
        .par_iter()
        .map(|it| trace::lines(&Recording::of(it).expect("labels are true").results))
        .collect();
    let mut machines = vec!["this machine"];
    for &kind in kinds {
        let Some(mut machine) = Machine::start(kind, &[]) else {
            continue;
        };
        for (number, (mission, here)) in missions.iter().zip(&here).enumerate() {
            let flown = machine.fly(mission);
            let flown = flown.unwrap_or_else(|e| panic!("{}, mission {number}: {e}", kind.name));
            let there = trace::lines(&flown.recording.results);
            assert_eq!(&there, here, "{}, mission {number}: {mission:?}", kind.name);
        }
        machines.push(kind.name);
    }
    println!("{} missions, the same bytes: {}", missions.len(), machines.join(", "));
}
