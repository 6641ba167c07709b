//! Budgets that fail the build: flash, RAM, stack, time, panics and `f64`, of the planner on a bare core
//! and of the firmware. `budgets.toml` has them. A plain run looks at the programs that people build and
//! flies the hardest missions that are known. With `CORES=all` it looks at all programs. A long one, `LONG=1`, also finds
//! the hardest anew, and commits:
//!
//! ```sh
//! UPDATE_EXPECT=1 LONG=1 cargo test -p tests budgets::
//! ```

use std::io::{self, Write as _};

use host_sim::mission::algorithm::Algorithm;
use planner_core::motion::unicycle::Grid;
use planner_core::{AnyVehicle, Policy, Track, Unicycle};
use tests::anything;
use tests::budget::footprint::{self, Footprint};
use tests::budget::hardest::Hardest;
use tests::budget::table::Budgets;
use tests::budget::timing::{self, Flight, Took};
use tests::budget::tolerance::Costs;
use tests::budget::workload::{DOUBT, Workload};
use tests::emulator::{Call, Core};
use tests::is_long;
use tests::program::build::{CHIP, all_cores, programs};
use tests::program::image::Image;

/// The cores whose sizes alone are compared.
const OTHERS: [&str; 2] = ["thumbv6m-none-eabi", "riscv32imac-unknown-none-elf"];

/// The programs. A run for one core leaves out the last.
const PROGRAMS: [&str; 8] =
    ["alone", "small", "medium", "standard", "vehicles", "track", "watch", "large"];

fn looked_at() -> &'static [&'static str] {
    // The last takes long.
    &PROGRAMS[..PROGRAMS.len() - usize::from(!all_cores())]
}

const MEMORY_X: &str = include_str!("../../../memory.x");

/// What would bring the goals nearer that are missed.
const NEXT: [(&str, &str); 1] = [(
    "flash_of_planner",
    "the plan's search is four fifths of it in small, estimates a sixth: less code for the search",
)];

/// The planner of the program `track`. A host needs no less memory for it than a chip.
type Follower = Track<Unicycle, 16, 16, 3>;

/// Where figures go.
struct Books {
    budgets: Budgets,
    hardest: Hardest,
}

#[test]
fn every_figure_keeps_its_budget() {
    let mut books = Books { budgets: Budgets::open(), hardest: Hardest::open() };
    // Held by `anything_on_a_chip`.
    let mut skipped = vec![anything::SECTION];
    if let (Some(bare), Some(firmware)) = (programs("bare-core", CHIP), programs("firmware", CHIP))
    {
        for name in looked_at() {
            let elf = bare(name);
            let (needs, fits) = size(&mut books.budgets, name, &elf);
            let stack = match *name {
                "alone" | "medium" | "vehicles" => 0, // what they do is measured in `small` and `standard`
                "small" => time_small(&mut books, &elf),
                "standard" => time_standard(&mut books, &elf),
                "track" => {
                    let ram = size_of::<Follower>() as u64 + u64::from(needs.planner_stack);
                    books.budgets.figure(name, "ram_of_planner", ram);
                    time_track(&mut books, &elf, "track", None)
                }
                "watch" => time_track(&mut books, &elf, "watch", Some(20.0)),
                _ => time_large(&mut books, &elf, fits),
            };
            books.budgets.note(&format!("{name}: {stack} bytes of stack in the emulator"));
            if stack > needs.stack {
                let what = format!("{name} has {stack} bytes of stack, more than its bound");
                books.budgets.fail(what);
            }
        }
        size(&mut books.budgets, "firmware", &firmware("firmware"));
    } else {
        skipped.extend(["firmware"].into_iter().chain(PROGRAMS));
    }
    for target in OTHERS.into_iter().filter(|_| all_cores()) {
        let Some(program) = programs("bare-core", target) else {
            skipped.push(target);
            continue;
        };
        for name in PROGRAMS {
            books.budgets.figure(target, name, Image::read(&program(name)).flash().into());
        }
    }
    for (goal, reduction) in NEXT {
        books.budgets.note(&format!("{goal}, next: {reduction}"));
    }
    let (report, failures) = books.budgets.close(&skipped);
    books.hardest.close();
    // Straight to the handle: what the print macros write, libtest swallows when a test passes.
    let _ = io::stderr().write_all(report.as_bytes());
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Sizes, stack, panics and `f64` of a program, and whether there is RAM for it.
fn size(budgets: &mut Budgets, name: &str, elf: &[u8]) -> (Footprint, bool) {
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
    budgets.figure(name, "stack_of_planner", it.planner_stack.into());
    budgets.figure(name, "ram", ram);
    budgets.list(name, "panics", &it.panics);
    budgets.list(name, "doubles_of_plan", &it.doubles_of_plan);
    budgets.list(name, "doubles_of_observe", &it.doubles_of_observe);
    budgets.list(name, "doubles_of_estimates", &it.doubles_of_estimates);
    budgets.note(&format!("{name}: deepest {}", it.chain.join(" > ")));
    let there_is = footprint::ram(MEMORY_X).expect("memory.x says how much RAM there is");
    let fits = ram <= there_is.into();
    if !fits {
        budgets.fail(format!("{name} can need {ram} bytes of RAM; there are {there_is}"));
    }
    (it, fits)
}

/// The flights of a workload: those drawn at random, and all others.
struct Flown {
    name: &'static str,
    flights: [Vec<Flight>; 2],
}

impl Flown {
    /// Flies all of a workload in a long run, and its hardest missions in any other.
    fn of(books: &mut Books, elf: &[u8], name: &'static str, workload: Workload) -> Self {
        let (random, others) =
            if is_long() { workload.missions() } else { (Vec::new(), books.hardest.of(name)) };
        let count = random.len();
        let numbers = [random, others].concat();
        let mut flights = timing::fly(elf, &workload, &numbers);
        let others = flights.split_off(count);
        let flown = Self { name, flights: [flights, others] };
        let sum = |of: fn(&Flight) -> usize| flown.all().map(of).sum::<usize>();
        books.budgets.note(&format!(
            "{name}: {} missions, {} plans, {} steps recovered, {} missions ended by resolution",
            flown.all().count(),
            sum(|it| it.plans.len()),
            sum(Flight::recoveries),
            sum(|it| usize::from(it.ended_by_resolution())),
        ));
        flown
    }

    fn all(&self) -> impl Iterator<Item = &Flight> {
        self.flights.iter().flatten()
    }

    /// Enters some of the calls of each flight as a figure.
    fn record<'a, I: IntoIterator<Item = &'a Call>>(
        &'a self,
        books: &mut Books,
        [section, figure]: [&str; 2],
        calls: impl Fn(&'a Flight) -> I,
    ) {
        let [random, others] = [0, 1].map(|n| {
            let numbered = |it: &'a Flight| calls(it).into_iter().map(|call| (*call, it.number));
            self.flights[n].iter().flat_map(numbered).collect::<Vec<_>>()
        });
        let Took { median, worst, worst_cycles } = Took::of(&random, &others);
        if let Some(median) = median {
            books.budgets.figure(section, &format!("{figure}_median"), median);
        }
        books.budgets.figure(section, &format!("{figure}_worst"), worst.0);
        books.budgets.figure(section, &format!("{figure}_worst_cycles"), worst_cycles.0);
        books.hardest.add(self.name, [worst.1, worst_cycles.1]);
    }

    /// Enters all plans, observations and estimates.
    fn record_all(&self, books: &mut Books, section: &str, prefix: &str) {
        let figure = |name| format!("{prefix}{name}");
        self.record(books, [section, &figure("plan")], |it| &it.plans);
        self.record(books, [section, &figure("observe")], |it| &it.observations);
        self.record(books, [section, &figure("estimate")], |it| &it.estimates);
    }

    /// The deepest stack.
    fn stack(&self) -> u32 {
        let top = 0x2002_0000;
        self.all().map(|it| top - it.lowest_stack).max().unwrap_or(0)
    }
}

const CFC: Workload = Workload {
    algorithm: Algorithm::Cfc,
    policy: Policy::MixtureOfOwn,
    steps: 12,
    random: 1_000,
    searched: 4_000,
    sought: 4,
    calls: None,
    vehicle: AnyVehicle::Unicycle(Unicycle::paper()),
    noise: None,
    position: 0.0,
    watch: None,
};

const LOOKAHEAD: Workload =
    Workload { algorithm: Algorithm::Lookahead, random: 40, searched: 2_000, sought: 3, ..CFC };

fn time_small(books: &mut Books, elf: &[u8]) -> u32 {
    let flown = Flown::of(books, elf, "small", CFC);
    flown.record_all(books, "small", "");
    let mut stack = flown.stack();
    for (figure, name, grid) in [
        ("lookahead_plan", "small, look-ahead, paper's fan", Grid::Paper),
        ("lookahead_fine_plan", "small, look-ahead, fine fan", Grid::Fine),
    ] {
        let flown = Flown::of(books, elf, name, Workload { vehicle: grid.into(), ..LOOKAHEAD });
        flown.record(books, ["small", figure], |it| &it.plans);
        stack = stack.max(flown.stack());
    }
    stack
}

/// Missions of fronts: a plan takes about as long in all of them.
fn time_track(books: &mut Books, elf: &[u8], program: &'static str, watch: Option<f64>) -> u32 {
    let track = Workload {
        algorithm: Algorithm::Track,
        steps: 80,
        random: 40,
        searched: 0,
        sought: 0,
        watch,
        ..CFC
    };
    let flown = Flown::of(books, elf, program, track);
    flown.record_all(books, program, "");
    flown.stack()
}

fn time_standard(books: &mut Books, elf: &[u8]) -> u32 {
    let cfc = Workload { steps: 32, random: 60, searched: 1_000, sought: 2, ..CFC };
    let flown = Flown::of(books, elf, "standard, Algorithm 1", cfc);
    flown.record_all(books, "standard", "cfc_");
    let mut stack = flown.stack();
    for (figure, name, grid, noise) in [
        ("lookahead_plan", "standard, look-ahead, paper's fan", Grid::Paper, None),
        ("lookahead_fine_plan", "standard, look-ahead, fine fan", Grid::Fine, None),
        ("noisy_plan", "standard, look-ahead, noise", Grid::Fine, DOUBT),
    ] {
        let workload = Workload {
            steps: 32,
            random: 10,
            searched: 1_000,
            vehicle: grid.into(),
            noise,
            ..LOOKAHEAD
        };
        let flown = Flown::of(books, elf, name, workload);
        flown.record(books, ["standard", figure], |it| &it.plans);
        stack = stack.max(flown.stack());
    }
    let scc = Workload { algorithm: Algorithm::Scc, searched: 400, noise: DOUBT, ..CFC };
    for (figure, name, policy) in [
        ("joint_plan_at_10", "standard, joint, 10 labels", Policy::Joint),
        ("mixture_plan_at_10", "standard, mixture, 10 labels", Policy::MixtureOfOwn),
    ] {
        // Up to the plan after ten plans and observations.
        let workload = Workload { policy, steps: 11, calls: Some(21), ..scc };
        let flown = Flown::of(books, elf, name, workload);
        flown.record(books, ["standard", figure], |it| it.plan_at_label(10));
        stack = stack.max(flown.stack());
    }
    let scc = Workload { policy: Policy::Joint, steps: 32, ..scc };
    let workload = Workload { random: 100, searched: 1_000, calls: Some(64), ..scc };
    let flown = Flown::of(books, elf, "standard, 32 labels", workload);
    flown.record(books, ["standard", "scc_observe_at_32"], |it| it.observation_of_label(32));
    // Seven million instructions each.
    let workload = Workload { random: 60, searched: 0, ..scc };
    let flown = Flown::of(books, elf, "standard, estimates", workload);
    flown.record(books, ["standard", "scc_estimate_at_32"], |it| &it.estimates);
    record_tolerance(books, elf);
    stack.max(flown.stack())
}

/// Enters what observing and waking take under a tolerance.
fn record_tolerance(books: &mut Books, elf: &[u8]) {
    for (kind, doubtful) in [("cfc", false), ("scc", true)] {
        let costs = Costs::worst_under_tolerance(Core::M4F, elf, doubtful, 2);
        let mut enter = |name: &str, figure| {
            books.budgets.figure("standard", &format!("{kind}_{name}_worst"), figure);
        };
        enter("tolerance_observe", costs.observe_worst);
        enter("tolerance_wake", costs.wake_worst);
    }
}

fn time_large(books: &mut Books, elf: &[u8], fits: bool) -> u32 {
    let cfc = Workload { steps: 64, random: 20, searched: 200, sought: 1, ..CFC };
    let flown = Flown::of(books, elf, "large, Algorithm 1", cfc);
    flown.record_all(books, "large", "cfc_");
    if !fits {
        return flown.stack(); // the other algorithm would run into the end of RAM
    }
    // For the stack: what all 2,081 hypotheses take of it does not grow with the labels.
    let scc = Workload {
        algorithm: Algorithm::Scc,
        steps: 4,
        random: 4,
        searched: 0,
        noise: DOUBT,
        ..CFC
    };
    flown.stack().max(Flown::of(books, elf, "large, Algorithm 2", scc).stack())
}

#[test]
fn a_program_that_can_panic_is_found_out() {
    let Some(bare) = programs("bare-core", CHIP) else { return };
    let panics = |name| Footprint::of(&Image::read(&bare(name))).expect("a graph").panics;
    assert_eq!(
        panics("panicking"),
        ["bare_core::on_target::panicking -> core::panicking::panic_bounds_check"]
    );
    for name in looked_at() {
        assert_eq!(panics(name), [""; 0], "{name}");
    }
}

#[test]
fn the_planner_forbids_unsafe_code_and_does_not_allocate() {
    let text = include_str!("../../../planner-core/src/lib.rs");
    assert!(text.starts_with("#![no_std]\n#![forbid(unsafe_code)]\n"));
    let Some(bare) = programs("bare-core", CHIP) else { return };
    for name in looked_at() {
        let image = Image::read(&bare(name));
        let allocates = |name: &str| name.contains("__rust_alloc") || name.starts_with("alloc::");
        assert!(!image.functions().iter().any(|it| allocates(&it.name)), "{name}");
    }
}
