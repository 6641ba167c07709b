//! What every program takes of every core keeps its budgets. A long run, `LONG=1`, searches for harder missions first.

use std::fs;

use chips::budget::book::{Book, Place};
use chips::budget::dearest::{BOUND, by_kind, dearest, in_lakes};
use chips::budget::footprint::{self, Footprint};
use chips::budget::timing::{self, Flight};
use chips::budget::workload::Workload;
use chips::emulator::{Call, Core};
use chips::program::image::Image;
use chips::program::{CHIP, bare};
use planner_core::{Track, Unicycle};
use tests::build::leave_out;
use tests::missions::of_any_vehicle;
use tests::{is_long, is_updating};

use crate::board::Board;
use crate::debugger::{Debugger, free_port};
use crate::machines::{self, Machine as _, NRF51, STM32, riscv};

/// The programs of `tests/bare-core`.
const PROGRAMS: [&str; 9] =
    ["alone", "small", "medium", "standard", "vehicles", "lakes", "large", "track", "watch"];

/// Those that are built for every core in a short run.
const EVERYWHERE: [&str; 4] = ["alone", "small", "standard", "track"];

/// The planner of the program `track`. A host needs no less memory for it than a chip.
type Follower = Track<Unicycle>;

#[test]
fn every_program_keeps_its_budgets() {
    let mut book = Book::open();
    for name in PROGRAMS {
        let Some(elf) = bare(CHIP, name) else { return };
        let Footprint { stack, planner_stack, .. } = footprint::measure(&mut book, name, &elf);
        if name == "track" {
            let ram = size_of::<Follower>() as u64 + u64::from(planner_stack);
            book.figure([Core::M4F.name(), name], "ram_of_planner", ram);
        }
        let seen = time_emulated(&mut book, Core::M4F, name, &elf);
        assert!(seen <= stack, "{name}: {seen} bytes of stack, more than its bound of {stack}");
    }
    if let Some(elf) = STM32.elf() {
        footprint::measure(&mut book, "firmware", &fs::read(elf).expect("cargo left an ELF"));
    }
    micro_bit(&mut book);
    let others: &[_] = if is_updating() || is_long() { &PROGRAMS } else { &EVERYWHERE };
    if others.len() < PROGRAMS.len() {
        let why = "a long run has it: LONG=1 cargo test -p chips --features all footprint::";
        leave_out("half of the programs on a Cortex-M0 and RISC-V", why);
    }
    for &name in others {
        if let Some(elf) = bare(Core::M0.target(), name) {
            let place = [Core::M0.name(), name];
            sizes(&mut book, place, &elf);
            let seen = time_emulated(&mut book, Core::M0, name, &elf);
            enter_seen(&mut book, place, seen);
        }
        if let Some(elf) = riscv(name).elf() {
            let place = ["riscv32imac", name];
            let statics = sizes(&mut book, place, &fs::read(elf).expect("cargo left an ELF"));
            if Workload::of(name).iter().any(|it| it.everywhere) {
                time_risc_v(&mut book, place, name, statics);
            }
        }
    }
    book.close();
}

/// A long run says what the 500 dearest take.
#[test]
fn no_plan_of_any_mission_passes_the_bound() {
    let Some(elf) = bare(CHIP, "vehicles") else { return };
    let plans = dearest(&elf);
    for (of, (most, number)) in by_kind(&plans) {
        println!("{of}: {most} in mission {number}");
    }
    let few: Vec<_> = plans.iter().take(500).map(|it| it.0).collect();
    println!("the dearest: {few:?}");
    assert!(few[0] <= BOUND, "{:?}", plans[0]);
}

/// The same on charts of 128 x 128 cells.
#[test]
fn no_plan_in_a_lake_passes_the_bound() {
    let Some(elf) = bare(CHIP, "lakes") else { return };
    let plans = in_lakes(&elf);
    for (of, (most, number)) in by_kind(&plans) {
        println!("{of}: {most} in mission {number}");
    }
    println!("median: {}", plans[plans.len() / 2].0);
    assert!(plans[0].0 <= BOUND, "{:?}", plans[0]);
}

fn sizes(book: &mut Book, place: Place<'_>, elf: &[u8]) -> u32 {
    let image = Image::read(elf);
    book.figure(place, "flash", image.flash().into());
    book.figure(place, "static_ram", image.statics().into());
    image.statics()
}

fn enter_seen(book: &mut Book, place: Place<'_>, stack: u32) {
    if stack > 0 {
        book.figure(place, "stack_seen", stack.into());
    }
}

fn time_emulated(book: &mut Book, core: Core, name: &str, elf: &[u8]) -> u32 {
    timing::time(book, [core.name(), name], |workload, numbers| {
        timing::fly(core, elf, numbers, |it| at(core, workload).mission(it), workload.calls)
    })
}

/// RAM begins as zeros under QEMU: what lies between statics and stack still is.
fn seen(debugger: &mut Debugger, [start, size]: [u32; 2], statics: u32) -> u32 {
    let between = debugger.memory(start + statics, size - statics);
    between.iter().skip_while(|byte| **byte == 0).count() as u32
}

/// RISC-V under QEMU.
fn time_risc_v(book: &mut Book, place: Place<'_>, name: &'static str, statics: u32) {
    let port = free_port();
    let debug = ["-gdb", &format!("tcp:127.0.0.1:{port}")];
    let Some(mut core) = machines::Core::start(riscv(name), &debug) else { return };
    let call = |ticks: u32| Call { function: 0, instructions: ticks.into(), cycles: 0 };
    timing::time(book, place, |workload, numbers| {
        let workload = at(Core::M0, workload);
        let fly = |&number: &u64| {
            let played = core.fly(&workload.mission(number)).expect("it flies as here");
            let (took, end) = (&played.took, &played.ending);
            let plans = took.iter().map(|it| it.plan).chain(Some(end.plan).filter(|it| *it > 0));
            Flight {
                number,
                plans: plans.map(call).collect(),
                observations: took.iter().map(|it| call(it.observe)).collect(),
                estimates: vec![call(end.estimate)],
                results: played.recording.results,
                stack: 0,
            }
        };
        numbers.iter().map(fly).collect()
    });
    core.keep_awake();
    let stack = seen(&mut Debugger::connect(port), [0x8010_0000, 128 * 1024], statics);
    enter_seen(book, place, stack);
}

/// The micro:bit under QEMU: its sizes, and the stack of missions of every vehicle.
fn micro_bit(book: &mut Book) {
    let port = free_port();
    let debug = ["-gdb", &format!("tcp:127.0.0.1:{port}")];
    let Some(mut board) = Board::start(NRF51, &debug) else { return };
    let place = [Core::M0.name(), "microbit"];
    let elf = fs::read(NRF51.elf().expect("it runs")).expect("cargo left an ELF");
    let statics = sizes(book, place, &elf);
    let of_small = Workload::of("small").iter().filter(|it| it.everywhere);
    let missions = of_small.map(|it| Workload { steps: 64, ..*it }.mission(0));
    for mission in missions.chain([2, 4, 8, 12, 14].map(|number| of_any_vehicle(number, 16))) {
        machines::Machine::fly(&mut board, &mission).expect("it flies as here");
    }
    enter_seen(book, place, seen(&mut Debugger::connect(port), [0x2000_0000, 16 * 1024], statics));
}

/// A workload for a core. The slower ones fly fewer steps along fronts.
fn at(core: Core, workload: &Workload) -> Workload {
    let most = if core == Core::M4F { u32::MAX } else { 40 };
    Workload { steps: workload.steps.min(most), ..*workload }
}

#[test]
fn a_program_that_can_panic_is_found_out() {
    let Some(elf) = bare(CHIP, "panicking") else { return };
    let footprint = Footprint::of(&Image::read(&elf)).expect("a graph");
    assert_eq!(
        footprint.panics,
        ["bare_core::on_target::panicking -> core::panicking::panic_bounds_check"]
    );
}
