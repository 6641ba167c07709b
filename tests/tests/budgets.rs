//! Budgets that fail the build: flash, RAM, stack, time, panics and `f64`, of the planner on a bare core
//! and of the firmware. `budgets.toml` has them; to commit new figures:
//!
//! ```sh
//! UPDATE_EXPECT=1 cargo test -p tests --test budgets
//! ```

use std::io::{self, Write as _};
use std::{fs, path::Path};

use host_sim::mission::Algorithm;
use planner_core::scc::Policy;
use tests::budget::Budgets;
use tests::elf;
use tests::footprint::{self, Footprint};
use tests::image::Image;
use tests::timing::{self, Flight, Took};
use tests::workload::Workload;

/// The chip, and the cores whose sizes alone are compared.
const CHIP: &str = "thumbv7em-none-eabihf";
const OTHERS: [&str; 2] = ["thumbv6m-none-eabi", "riscv32imac-unknown-none-elf"];

const PROGRAMS: [&str; 3] = ["small", "standard", "large"];

const MEMORY_X: &str = include_str!("../../memory.x");

/// What would bring the goals nearer that are missed.
const NEXT: [(&str, &str); 1] = [(
    "flash_of_planner",
    "estimates and what they need of f64 are two fifths of it in small: single precision, about a sample",
)];

/// A program for a target; `None`, and a visible line, where it cannot be built.
fn build(package: &str, target: &str) -> Option<impl Fn(&str) -> Vec<u8> + use<>> {
    if !elf::can_build(target) {
        elf::skip(package, &format!("the target {target} is not installed"));
        return None;
    }
    let folder = elf::build(env!("CARGO_TARGET_TMPDIR"), package, target);
    let folder = folder.unwrap_or_else(|errors| panic!("{errors}"));
    Some(move |name: &str| fs::read(Path::new(&folder).join(name)).expect("cargo left an ELF"))
}

#[test]
fn every_figure_keeps_its_budget() {
    let mut budgets = Budgets::open();
    let mut skipped = Vec::new();
    if let (Some(bench), Some(firmware)) = (build("bench", CHIP), build("firmware", CHIP)) {
        let [small, standard, large] = PROGRAMS.map(&bench);
        for (name, elf) in PROGRAMS.into_iter().zip([small, standard, large]) {
            let (bound, fits) = size(&mut budgets, name, &elf);
            let stack = match name {
                "small" => time_small(&mut budgets, &elf),
                "standard" => time_standard(&mut budgets, &elf),
                _ => time_large(&mut budgets, &elf, fits),
            };
            budgets.note(&format!("{name}: {stack} bytes of stack in the emulator"));
            if stack > bound {
                budgets.fail(format!("{name} has {stack} bytes of stack, more than its bound"));
            }
        }
        size(&mut budgets, "firmware", &firmware("firmware"));
    } else {
        skipped.extend(["firmware"].into_iter().chain(PROGRAMS));
    }
    for target in OTHERS {
        let Some(program) = build("bench", target) else {
            skipped.push(target);
            continue;
        };
        for name in PROGRAMS {
            budgets.figure(target, name, Image::read(&program(name)).flash().into());
        }
    }
    for (goal, reduction) in NEXT {
        budgets.note(&format!("{goal}, next: {reduction}"));
    }
    let (report, failures) = budgets.close(&skipped);
    // Straight to the handle: what the print macros write, libtest swallows when a test passes.
    let _ = io::stderr().write_all(report.as_bytes());
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Sizes, stack, panics and `f64` of a program; the bound of its stack, and whether there is RAM for it.
fn size(budgets: &mut Budgets, name: &str, elf: &[u8]) -> (u32, bool) {
    let it = Footprint::of(&Image::read(elf)).unwrap_or_else(|error| panic!("{name}: {error}"));
    let ram = u64::from(it.statics) + u64::from(it.stack);
    // The firmware's dependencies can panic, and name their files by where cargo put them.
    if name == "firmware" {
        budgets.figure_here(name, "flash", it.flash.into());
    } else {
        budgets.figure(name, "flash", it.flash.into());
    }
    budgets.figure(name, "flash_of_planner", it.planner.into());
    budgets.figure(name, "static_ram", it.statics.into());
    budgets.figure(name, "stack", it.stack.into());
    budgets.figure(name, "ram", ram);
    budgets.list(name, "panics", &it.panics);
    budgets.list(name, "doubles_of_plan", &it.doubles_of_plan);
    budgets.list(name, "doubles_of_observe", &it.doubles_of_observe);
    budgets.note(&format!("{name}: deepest {}", it.chain.join(" > ")));
    let there_is = footprint::ram(MEMORY_X).expect("memory.x says how much RAM there is");
    let fits = ram <= there_is.into();
    if !fits {
        budgets.fail(format!("{name} can need {ram} bytes of RAM; there are {there_is}"));
    }
    (it.stack, fits)
}

/// Flies a workload; the missions drawn at random, and all others.
fn fly(budgets: &mut Budgets, elf: &[u8], what: &str, workload: Workload) -> [Vec<Flight>; 2] {
    let (random, sought) = workload.missions();
    let count = random.len();
    let mut flights = timing::fly(elf, &[random, sought].concat(), workload.calls);
    let sought = flights.split_off(count);
    let flights = [flights, sought];
    let all = || flights.iter().flatten();
    let sum = |of: fn(&Flight) -> usize| all().map(of).sum::<usize>();
    budgets.note(&format!(
        "{what}: {} missions, {} plans, {} steps recovered, {} missions ended by resolution",
        all().count(),
        sum(|it| it.plans.len()),
        sum(Flight::recoveries),
        sum(|it| usize::from(it.ended_by_resolution())),
    ));
    flights
}

fn record(budgets: &mut Budgets, section: &str, name: &str, took: Took) {
    budgets.figure(section, &format!("{name}_median"), took.median);
    budgets.figure(section, &format!("{name}_worst"), took.worst);
    budgets.figure(section, &format!("{name}_worst_cycles"), took.worst_cycles);
}

/// All plans, observations and estimates of flights; the deepest stack.
fn record_all(
    budgets: &mut Budgets,
    section: &str,
    prefix: &str,
    flights: &[Vec<Flight>; 2],
) -> u32 {
    for (name, calls) in [
        ("plan", (|it| &it.plans) as fn(&Flight) -> &Vec<_>),
        ("observe", |it| &it.observations),
        ("estimate", |it| &it.estimates),
    ] {
        let [random, sought] =
            [0, 1].map(|n| flights[n].iter().flat_map(calls).copied().collect::<Vec<_>>());
        let took = Took::of(&random, &sought);
        record(budgets, section, &format!("{prefix}{name}"), took);
    }
    deepest(flights)
}

fn deepest(flights: &[Vec<Flight>; 2]) -> u32 {
    let top = 0x2002_0000;
    flights.iter().flatten().map(|it| top - it.lowest_stack).max().unwrap_or(0)
}

const CFC: Workload = Workload {
    algorithm: Algorithm::Cfc,
    policy: Policy::MixtureOfOwn,
    steps: 12,
    random: 1_000,
    searched: 4_000,
    sought: 4,
    calls: None,
};

fn time_small(budgets: &mut Budgets, elf: &[u8]) -> u32 {
    let flights = fly(budgets, elf, "small", CFC);
    record_all(budgets, "small", "", &flights)
}

fn time_standard(budgets: &mut Budgets, elf: &[u8]) -> u32 {
    let cfc = Workload { steps: 32, random: 60, searched: 1_000, sought: 2, ..CFC };
    let flights = fly(budgets, elf, "standard, Algorithm 1", cfc);
    let mut stack = record_all(budgets, "standard", "cfc_", &flights);
    let scc = Workload { algorithm: Algorithm::Scc, searched: 400, ..CFC };
    for (name, policy) in [("joint", Policy::Joint), ("mixture", Policy::MixtureOfOwn)] {
        // Up to the plan after ten plans and observations.
        let workload = Workload { policy, steps: 11, calls: Some(21), ..scc };
        let flights = fly(budgets, elf, &format!("standard, {name}, 10 labels"), workload);
        let [random, sought] = [0, 1]
            .map(|n| flights[n].iter().filter_map(|it| it.at_label(10).0).collect::<Vec<_>>());
        record(budgets, "standard", &format!("{name}_plan_at_10"), Took::of(&random, &sought));
        stack = stack.max(deepest(&flights));
    }
    let scc = Workload { policy: Policy::Joint, steps: 32, searched: 0, ..scc };
    let workload = Workload { calls: Some(64), ..scc };
    let [flights, _] = fly(budgets, elf, "standard, 32 labels", workload);
    let observations: Vec<_> = flights.iter().filter_map(|it| it.at_label(32).1).collect();
    record(budgets, "standard", "scc_observe_at_32", Took::of(&observations, &[]));
    // Seven million instructions each.
    let flights = fly(budgets, elf, "standard, estimates", Workload { random: 60, ..scc });
    let estimates: Vec<_> = flights[0].iter().flat_map(|it| it.estimates.clone()).collect();
    record(budgets, "standard", "scc_estimate_at_32", Took::of(&estimates, &[]));
    stack.max(deepest(&flights))
}

fn time_large(budgets: &mut Budgets, elf: &[u8], fits: bool) -> u32 {
    let cfc = Workload { steps: 64, random: 20, searched: 200, sought: 1, ..CFC };
    let flights = fly(budgets, elf, "large, Algorithm 1", cfc);
    let stack = record_all(budgets, "large", "cfc_", &flights);
    if !fits {
        return stack; // the other algorithm would run into the end of RAM
    }
    // For the stack: what all 2,081 hypotheses take of it does not grow with the labels.
    let scc = Workload { algorithm: Algorithm::Scc, steps: 4, random: 4, searched: 0, ..CFC };
    let flights = fly(budgets, elf, "large, Algorithm 2", scc);
    stack.max(deepest(&flights))
}

#[test]
fn a_program_that_can_panic_is_found_out() {
    let Some(bench) = build("bench", CHIP) else { return };
    let panics = |name| Footprint::of(&Image::read(&bench(name))).expect("a graph").panics;
    assert_eq!(
        panics("panicking"),
        ["bench::on_target::panicking -> core::panicking::panic_bounds_check"]
    );
    for name in PROGRAMS {
        assert_eq!(panics(name), [""; 0], "{name}");
    }
}

#[test]
fn the_planner_forbids_unsafe_code_and_does_not_allocate() {
    let text = include_str!("../../planner-core/src/lib.rs");
    assert!(text.starts_with("#![no_std]\n#![forbid(unsafe_code)]\n"));
    let Some(bench) = build("bench", CHIP) else { return };
    for name in PROGRAMS {
        let image = Image::read(&bench(name));
        let allocates = |name: &str| name.contains("__rust_alloc") || name.starts_with("alloc::");
        assert!(!image.functions().iter().any(|it| allocates(&it.name)), "{name}");
    }
}
