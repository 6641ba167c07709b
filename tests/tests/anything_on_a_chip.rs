//! Plans of random missions keep their bound in instructions of a Cortex-M4: every vehicle, area and setting.

use std::collections::BTreeMap;

use rayon::prelude::*;
use tests::anything::draw::draw;
use tests::anything::{asked_for, kind};
use tests::budget::footprint::SEAM;
use tests::cases;
use tests::emulator::Emulator;
use tests::emulator::missions::{self, CORES};
use tests::program::image::Image;

const SEED: u64 = 21;

/// Instructions that no plan exceeds.
const MOST: u64 = 20_000_000;

/// What the program `vehicles` has room for beside the given samples.
const LABELS: u32 = 32;

#[test]
fn no_plan_takes_more_than_its_bound() {
    let (core, target) = CORES[0];
    let Some(program) = missions::build(env!("CARGO_TARGET_TMPDIR"), target) else { return };
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
        mission.steps = LABELS;
        emulator.restart();
        missions::fly(emulator, &mission)
            .unwrap_or_else(|error| panic!("mission {number}: {error}"));
        let worst = emulator.calls().iter().map(|call| call.instructions).max().unwrap_or(0);
        (format!("{} {:?}", kind(&mission.vehicle), mission.algorithm), worst, number)
    };
    let worst: Vec<_> = asked_for(cases(24, 200)).into_par_iter().map_init(start, fly).collect();
    let mut by_kind = BTreeMap::<String, Vec<(u64, u64)>>::new();
    for (kind, worst, number) in worst {
        by_kind.entry(kind).or_default().push((worst, number));
    }
    let mut most = 0;
    for (kind, mut worst) in by_kind {
        worst.sort_unstable();
        println!("{kind}: {:?}, median {}", worst[worst.len() - 1], worst[worst.len() / 2].0);
        most = most.max(worst[worst.len() - 1].0);
    }
    assert!(most <= MOST, "{most}");
}
