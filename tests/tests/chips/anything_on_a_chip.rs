//! Plans of random missions keep their budget in instructions of a Cortex-M4, 20 million: every vehicle, area and setting. A
//! long run flies 200 missions and commits the figures if `UPDATE_EXPECT` is set.

use std::collections::BTreeMap;

use rayon::prelude::*;
use tests::anything::draw::draw;
use tests::anything::{SECTION, asked_for, kind};
use tests::budget::footprint::SEAM;
use tests::budget::table::Budgets;
use tests::cases;
use tests::emulator::Emulator;
use tests::emulator::missions::{self, CORES};
use tests::program::image::Image;

const SEED: u64 = 21;

/// Labels of a mission at most, and what the program `vehicles` has room for, the given samples included.
const LABELS: u32 = 32;
const SAMPLES: u32 = 36;

#[test]
fn no_plan_takes_more_than_its_bound() {
    let (core, target) = CORES[0];
    let Some(program) = missions::build(target) else { return };
    let elf = program("vehicles");
    let image = Image::read(&elf);
    let plans: Vec<u32> = image
        .functions()
        .iter()
        .filter(|it| it.name.strip_prefix(SEAM) == Some("plan"))
        .map(|it| it.address)
        .collect();
    let start = || {
        let mut emulator = Emulator::load(&elf, core);
        for function in &plans {
            emulator.watch(*function);
        }
        emulator
    };
    let fly = |emulator: &mut Emulator, number: u64| {
        let mut mission = draw(SEED, number);
        // The program has room for so many samples, and no code for labels on the way.
        mission.steps = LABELS.min(SAMPLES - mission.given.samples().len() as u32);
        mission.readings = 1;
        emulator.restart();
        missions::fly(emulator, &mission)
            .unwrap_or_else(|error| panic!("mission {number}: {error}"));
        let worst = emulator.calls().iter().map(|call| call.instructions).max().unwrap_or(0);
        let algorithm = format!("{:?}", mission.algorithm).to_lowercase();
        (format!("{}_{algorithm}", kind(&mission.vehicle)), worst, number)
    };
    let worst: Vec<_> = asked_for(cases(8, 200)).into_par_iter().map_init(start, fly).collect();
    let mut by_kind = BTreeMap::<String, Vec<(u64, u64)>>::new();
    for (kind, worst, number) in worst {
        by_kind.entry(kind).or_default().push((worst, number));
    }
    let mut budgets = Budgets::open();
    for (kind, mut worst) in by_kind {
        worst.sort_unstable();
        let (most, number) = worst[worst.len() - 1];
        println!("{kind}: {most} in mission {number}, median {}", worst[worst.len() / 2].0);
        budgets.figure_here(SECTION, &format!("{kind}_plan_worst"), most);
    }
    let others = budgets.others(SECTION);
    let (_, failures) = budgets.close(&others.iter().map(String::as_str).collect::<Vec<_>>());
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
