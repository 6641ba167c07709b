//! Flash, RAM, stack and instructions on every core, held to the committed figures of `cores.toml`. With
//! `CORES=all` these are the figures of the micro:bit's firmware, and the sizes of the small and the standard program on
//! three cores, and of that for fronts. A long run measures all of them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use host_sim::mission::algorithm::Algorithm;
use host_sim::world::noise::NoiseModel;
use planner_core::motion::unicycle::Grid;
use planner_core::{AnyVehicle, Policy};
use tests::budget::hardest::Hardest;
use tests::budget::readme::{self, grouped};
use tests::budget::timing;
use tests::budget::tolerance::Costs;
use tests::budget::workload::{DOUBT, Workload};
use tests::debugger::{self, Debugger};
use tests::emulator::Core;
use tests::emulator::missions;
use tests::is_long;
use tests::machines::{Kind, Machine, NRF51, riscv};
use tests::missions::of_any_vehicle;
use tests::program::build::CHIP;
use tests::program::image::Image;
use toml_edit::{DocumentMut, Item, Table, value};

const FILE: &str = "cores.toml";

/// Missions drawn at random.
const RANDOM: u64 = 4;

/// Bytes by which flash may differ from what is committed. Cargo names planner-core by where it is, as the micro:bit's
/// firmware is a workspace of its own; functions are ordered by such names, and lie closer in one order than in another:
/// of sixteen folders ten gave 84,340 bytes, and six 84,336. Programs of the workspace are the same everywhere.
fn leeway(program: &str, figure: &str) -> u64 {
    if (program, figure) == ("microbit", "flash") { 16 } else { 0 }
}

/// Figures by their names.
type Figures = BTreeMap<String, u64>;

/// What is flown: the name of its figures, if all calls count, and in `hardest.toml`.
struct Flown {
    figure: &'static str,
    all: bool,
    hardest: &'static str,
    workload: Workload,
}

fn flown(program: &str) -> Vec<Flown> {
    let of = |algorithm, grid: Grid, steps, noise: Option<NoiseModel>| Workload {
        algorithm,
        policy: Policy::MixtureOfOwn,
        steps,
        random: match (algorithm, program) {
            (Algorithm::Cfc, "small") => 1_000,
            (Algorithm::Cfc, _) => 60,
            (_, "small") => 40,
            _ => 10,
        },
        searched: 0,
        sought: 0,
        calls: None,
        vehicle: AnyVehicle::from(grid),
        noise,
        position: 0.0,
        watch: None,
    };
    let flown = |figure, all, hardest, workload| Flown { figure, all, hardest, workload };
    let (cfc, lookahead) = (Algorithm::Cfc, Algorithm::Lookahead);
    if program == "track" {
        let track = Workload { random: 4, ..of(Algorithm::Track, Grid::Fine, 40, None) };
        return vec![flown("", true, "track", track)];
    }
    if program == "small" {
        return vec![
            flown("", true, "small", of(cfc, Grid::Paper, 12, None)),
            flown(
                "lookahead_",
                false,
                "small, look-ahead, fine fan",
                of(lookahead, Grid::Fine, 12, None),
            ),
        ];
    }
    vec![
        flown("", true, "standard, Algorithm 1", of(cfc, Grid::Paper, 32, None)),
        flown(
            "lookahead_",
            false,
            "standard, look-ahead, fine fan",
            of(lookahead, Grid::Fine, 32, None),
        ),
        flown("noisy_", false, "standard, look-ahead, noise", of(lookahead, Grid::Fine, 32, DOUBT)),
    ]
}

/// Plans, observations and estimates of a mission.
type Calls = [Vec<u64>; 3];

/// Has all missions of a program flown, and enters what their calls took.
fn time(
    figures: &mut Figures,
    program: &str,
    mut fly: impl FnMut(&Workload, &[u64]) -> Vec<Calls>,
) {
    let hardest = Hardest::open();
    for it in flown(program) {
        let numbers: Vec<u64> = (0..RANDOM).chain(hardest.of(it.hardest)).collect();
        let calls = fly(&it.workload, &numbers);
        let names = if it.all { &["plan", "observe", "estimate"][..] } else { &["plan"] };
        for (role, name) in names.iter().enumerate() {
            let of = |flights: &[Calls]| -> Vec<u64> {
                flights.iter().flat_map(|it| it[role].iter().copied()).collect()
            };
            let mut random = of(&calls[..RANDOM as usize]);
            random.sort_unstable();
            let figure = |kind| format!("{}{name}_{kind}", it.figure);
            figures.insert(figure("median"), random[random.len() / 2]);
            figures.insert(figure("worst"), of(&calls).into_iter().max().unwrap_or(0));
        }
    }
}

fn sizes(figures: &mut Figures, elf: &[u8]) -> u32 {
    let image = Image::read(elf);
    // A runtime may have a section for the stack, which is all the RAM that is left.
    let statics = image.statics_but(".stack");
    figures.insert("flash".into(), image.flash().into());
    figures.insert("static_ram".into(), statics.into());
    statics
}

/// A Cortex-M in the tests' emulator.
fn cortex(core: Core, target: &str, program: &str) -> Option<Figures> {
    let elf = missions::build(target)?(program);
    let mut figures = Figures::new();
    sizes(&mut figures, &elf);
    if !is_long() {
        return Some(figures);
    }
    let mut lowest = u32::MAX;
    time(&mut figures, program, |workload, numbers| {
        let flights = timing::fly_on(core, &elf, workload, numbers);
        lowest = flights.iter().map(|it| it.lowest_stack).min().unwrap_or(lowest).min(lowest);
        let count =
            |calls: &[tests::emulator::Call]| calls.iter().map(|it| it.instructions).collect();
        let each = flights.iter();
        each.map(|it| [count(&it.plans), count(&it.observations), count(&it.estimates)]).collect()
    });
    figures.insert("stack".into(), (0x2002_0000 - lowest).into());
    for (kind, doubtful) in [("", false), ("scc_", true)].iter().filter(|_| program == "standard") {
        let costs = Costs::worst_under_tolerance(core, &elf, *doubtful, 2);
        figures.insert(format!("{kind}tolerance_observe_worst"), costs.observe_worst);
        figures.insert(format!("{kind}tolerance_wake_worst"), costs.wake_worst);
    }
    Some(figures)
}

/// A machine of QEMU's with a debugger, and where its RAM begins and how much there is.
struct Watched {
    machine: Machine,
    port: u16,
    statics: u32,
    ram: [u32; 2],
}

impl Watched {
    fn start(figures: &mut Figures, kind: Kind, ram: [u32; 2]) -> Option<Self> {
        let statics = sizes(figures, &fs::read(kind.elf()?).expect("cargo left an ELF"));
        let port = debugger::free_port();
        let machine = Machine::start(kind, &["-gdb", &format!("tcp:127.0.0.1:{port}")])?;
        Some(Self { machine, port, statics, ram })
    }

    /// RAM begins as zeros under QEMU: what lies between statics and stack still is.
    fn enter_stack(&self, figures: &mut Figures) {
        self.machine.keep_awake();
        let ([start, size], statics) = (self.ram, self.statics);
        let between = Debugger::connect(self.port).memory(start + statics, size - statics);
        let used = between.iter().skip_while(|byte| **byte == 0).count();
        figures.insert("stack".into(), used as u64);
    }
}

/// RISC-V under QEMU.
fn risc_v(program: &'static str) -> Option<Figures> {
    let mut figures = Figures::new();
    if !is_long() {
        sizes(&mut figures, &fs::read(riscv(program).elf()?).expect("cargo left an ELF"));
        return Some(figures);
    }
    let mut watched = Watched::start(&mut figures, riscv(program), [0x8010_0000, 128 * 1024])?;
    time(&mut figures, program, |workload, numbers| {
        let fly = |number: &u64| {
            let played = watched.machine.fly(&workload.mission(*number)).expect("it flies as here");
            let (took, end) = (&played.took, &played.ending);
            let plans = took.iter().map(|it| it.plan).chain(Some(end.plan).filter(|it| *it > 0));
            [
                plans.map(u64::from).collect(),
                took.iter().map(|it| it.observe.into()).collect(),
                vec![end.estimate.into()],
            ]
        };
        numbers.iter().map(fly).collect()
    });
    watched.enter_stack(&mut figures);
    Some(figures)
}

/// The micro:bit under QEMU: its sizes, and the stack of missions of every vehicle.
fn microbit() -> Option<Figures> {
    let mut figures = Figures::new();
    let mut watched = Watched::start(&mut figures, NRF51, [0x2000_0000, 16 * 1024])?;
    for it in flown("small") {
        let mission = Workload { steps: 64, ..it.workload }.mission(0);
        watched.machine.fly(&mission).expect("it flies as here");
    }
    for number in [2, 4, 8, 12, 14] {
        watched.machine.fly(&of_any_vehicle(number, 16)).expect("it flies as here");
    }
    watched.enter_stack(&mut figures);
    Some(figures)
}

/// The committed figures, as the readme has them.
fn table(document: &DocumentMut) -> String {
    const COLUMNS: [(&str, &str, &str); 10] = [
        ("M0, micro:bit", "cortex-m0", "microbit"),
        ("M0, *small*", "cortex-m0", "small"),
        ("M0, *standard*", "cortex-m0", "standard"),
        ("M0, *track*", "cortex-m0", "track"),
        ("M4F, *small*", "cortex-m4f", "small"),
        ("M4F, *standard*", "cortex-m4f", "standard"),
        ("M4F, *track*", "cortex-m4f", "track"),
        ("RISC-V, *small*", "riscv32imac", "small"),
        ("RISC-V, *standard*", "riscv32imac", "standard"),
        ("RISC-V, *track*", "riscv32imac", "track"),
    ];
    let sizes = ["flash", "static_ram", "stack"].map(str::to_owned);
    let calls = ["plan", "observe", "estimate", "lookahead_plan", "noisy_plan"];
    let times = calls.map(|call| ["median", "worst"].map(|of| format!("{call}_{of}")));
    let tolerance = ["observe", "wake"]
        .map(|of| ["", "scc_"].map(|kind| format!("{kind}tolerance_{of}_worst")));
    let names = sizes.iter().chain(times.as_flattened()).chain(tolerance.as_flattened());
    let names: Vec<_> = names.map(String::as_str).collect();
    readme::table(&COLUMNS.map(|it| it.0), &names, |column, name| {
        let (_, core, program) = COLUMNS[column];
        document.get(core)?.get(program)?.get(name)?.as_integer().map(grouped)
    })
}

#[test]
fn every_core_takes_what_is_committed() {
    let _alone = readme::one_at_a_time();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
    let text = fs::read_to_string(&path).expect("tests/cores.toml");
    let mut document: DocumentMut = text.parse().expect("TOML");
    let mut measured = vec![(["cortex-m0", "microbit"], microbit())];
    for program in ["small", "standard", "track"] {
        let m0 = cortex(Core::M0, "thumbv6m-none-eabi", program);
        let m4f = cortex(Core::M4F, CHIP, program);
        measured.push((["cortex-m0", program], m0));
        measured.push((["cortex-m4f", program], m4f));
        measured.push((["riscv32imac", program], risc_v(program)));
    }
    // All figures of a program or none: new sizes would hide that the others are old.
    let is_committing = readme::is_updating() && is_long();
    let mut changes = Vec::new();
    for ([core, program], figures) in measured {
        let Some(figures) = figures else { continue };
        let of_core = document.entry(core).or_insert(Item::Table(Table::new()));
        let of_core = of_core.as_table_mut().expect("a table");
        of_core.set_implicit(true);
        let table = of_core.entry(program).or_insert(Item::Table(Table::new()));
        for (name, figure) in figures {
            let committed = table.get(&name).and_then(Item::as_integer);
            let is_held = |held: i64| figure.abs_diff(held as u64) <= leeway(program, &name);
            if !committed.is_some_and(is_held) {
                changes.push(format!("{core}.{program}.{name}: {figure}, committed {committed:?}"));
                if is_committing {
                    table[&name] = value(figure as i64);
                }
            }
        }
    }
    if !readme::write_or_compare("cores", &table(&document)) {
        changes.push(format!("the readme's table is not that of {FILE}"));
    }
    if is_committing {
        fs::write(path, document.to_string()).expect("writes the figures");
    } else {
        let remedy = "UPDATE_EXPECT=1 LONG=1 commits all figures";
        assert!(changes.is_empty(), "{}\n{remedy}", changes.join("\n"));
    }
}
