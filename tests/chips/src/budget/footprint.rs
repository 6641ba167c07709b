//! The flash and stack that a program needs, read from its ELF.
//!
//! **The planner's flash** is the size of all functions that the planner's entries reach, and of the constants in
//! `.rodata` that these point to. The entries are those of `station::seam`: plan, observe, estimates, and what makes a
//! planner of a `Setup`. They are kept as functions of their own. So code that the planner shares with the link (`memcpy`)
//! counts as the planner's, and so does its code from libm, nalgebra, heapless and compiler-builtins. A mission's loop,
//! messages, frames and start-up do not count. **The planner's stack** is the deepest chain from one of the entries.
//!
//! **The stack** is an upper bound: the deepest chain of calls from the reset, plus every handler in the vectors once,
//! each with the frame that the core stacks. A panic ends the program. The panic handler may itself panic once while it
//! reports the first panic (`firmware`'s `stop`). So the handler's own chain counts twice, and is not followed where
//! another function calls it.

use std::collections::BTreeSet;

use super::book::Book;
use crate::emulator::Core;
use crate::program::graph::{Chain, Graph, Known};
use crate::program::image::Image;

/// Where calls through registers lead.
pub const KNOWN: Known<'static> = &[
    ("bare_core::on_target::fly", &["bare_core::port::ticks"]),
    ("firmware::mission::Board::run", &["firmware::time::ticks"]),
    (
        "planner_core::link::station::planners::<impl planner_core::link::station::flight::Station<P,S>>::fly_with",
        &["firmware::time::ticks"],
    ),
    // It would wake tasks that wait on the monotonic. There are none.
    ("SysTick", &[]),
];

/// What the core stacks for an exception with floating point: 26 words, and one to align them.
const FRAME: u32 = 4 * 27;

/// The function through which every panic goes.
const PANIC: &str = "core::panicking::panic_fmt";

/// The linker's script: how much RAM there is.
const MEMORY_X: &str = include_str!("../../../../memory.x");

/// What a program takes of a chip.
#[derive(Clone, Debug)]
pub struct Footprint {
    /// Bytes of flash, all of it.
    pub flash: u32,
    /// Bytes of flash for the planner.
    pub planner: u32,
    /// Bytes of RAM that are not stack.
    pub statics: u32,
    /// Bytes of stack at most.
    pub stack: u32,
    /// Bytes of it at most for the planner.
    pub planner_stack: u32,
    /// The chain of calls from the reset that takes the most of it.
    pub chain: Vec<String>,
    /// Functions that can panic, each with how.
    pub panics: Vec<String>,
    /// The functions that an entry reaches and that compute in `f64`, for which these cores have no instructions.
    pub doubles: [Vec<String>; 3],
}

/// Entries that must not compute in `f64`.
const ENTRIES: [&str; 3] = ["plan", "observe", "estimates"];

impl Footprint {
    /// Reads a program.
    ///
    /// # Errors
    /// As [`Graph::of`] and [`Graph::deepest`].
    pub fn of(image: &Image) -> Result<Self, String> {
        let graph = Graph::of(image, KNOWN)?;
        let from_reset = deepest(&graph, image.handlers().first().copied())?;
        let mut stack = from_reset.stack;
        for handler in image.handlers().into_iter().skip(1) {
            stack += FRAME + deepest(&graph, Some(handler))?.stack;
        }
        for panic in graph.named(|it| it == PANIC) {
            stack += 2 * deepest(&graph, Some(panic))?.stack;
        }
        let entries = graph.named(is_planner_s);
        let mut planner_stack = 0;
        for entry in &entries {
            planner_stack = planner_stack.max(deepest(&graph, Some(*entry))?.stack);
        }
        Ok(Self {
            flash: image.flash(),
            planner: graph.flash(&graph.closure(&entries)),
            statics: image.statics(),
            stack,
            planner_stack,
            chain: from_reset.functions.iter().map(|it| graph.name(*it).to_owned()).collect(),
            panics: panics(&graph),
            doubles: ENTRIES.map(|entry| doubles(&graph, entry)),
        })
    }
}

/// The deepest chain from a function, up to where it panics.
fn deepest(graph: &Graph<'_>, function: Option<u32>) -> Result<Chain, String> {
    let function = function.ok_or("no vectors")?;
    graph.deepest(function, &graph.named(|it| it == PANIC))
}

fn is_planner_s(name: &str) -> bool {
    name.starts_with(SEAM)
}

/// The planner's entries while a mission runs.
pub const SEAM: &str = "planner_core::link::station::seam::";

/// Functions of the standard library that are there for panics alone, whatever else they are called.
fn is_panic(name: &str) -> bool {
    name.starts_with("core::panicking::")
        || name.contains("rust_begin_unwind")
        || name.starts_with("core::")
            && ["_failed", "_fail", "slice_error", "_overflow"].iter().any(|it| name.contains(it))
}

/// The functions that can panic, in the whole program and not only where it is known to reach: `caller -> how`.
fn panics(graph: &Graph<'_>) -> Vec<String> {
    let how: BTreeSet<u32> = graph.named(is_panic).into_iter().collect();
    let mut panics = BTreeSet::new();
    for caller in graph.named(|it| !is_panic(it)) {
        let ways = graph.callees(caller).into_iter().filter(|it| how.contains(it));
        panics.extend(ways.map(|way| format!("{} -> {}", graph.name(caller), graph.name(way))));
    }
    // One that nobody calls is still in the program.
    let called: BTreeSet<u32> =
        graph.named(|_| true).into_iter().flat_map(|it| graph.callees(it)).collect();
    panics.extend(how.difference(&called).map(|way| format!("? -> {}", graph.name(*way))));
    panics.into_iter().collect()
}

/// Routines that compute in `f64`.
fn is_double(name: &str) -> bool {
    let routine = name.rsplit("::").next().unwrap_or(name);
    let run_time = routine.starts_with("__");
    run_time && (routine.contains("df") || routine.contains("aeabi_d") || routine.ends_with("2d"))
}

/// The functions that call such routines on behalf of an entry.
fn doubles(graph: &Graph<'_>, entry: &str) -> Vec<String> {
    let entries = graph.named(|it| it.strip_prefix(SEAM) == Some(entry));
    let mut doubles = BTreeSet::new();
    for function in graph.closure(&entries) {
        let computes = graph.callees(function).into_iter().any(|it| is_double(graph.name(it)));
        if computes && !is_double(graph.name(function)) {
            doubles.insert(graph.name(function).to_owned());
        }
    }
    doubles.into_iter().collect()
}

/// Bytes of RAM by the linker's script.
///
/// # Panics
/// If the script has another form.
pub fn ram() -> u32 {
    let line = MEMORY_X.lines().find(|it| it.trim_start().starts_with("RAM"));
    let kib = line.and_then(|it| it.rsplit('=').next()?.trim().strip_suffix('K'));
    1024 * kib.and_then(|it| it.parse::<u32>().ok()).expect("memory.x says how much RAM there is")
}

/// Enters what a program takes of a Cortex-M4F: sizes, stack, panics and `f64`.
///
/// # Panics
/// If its machine code cannot be followed.
pub fn measure(book: &mut Book, name: &str, elf: &[u8]) -> Footprint {
    let image = Image::read(elf);
    let it = Footprint::of(&image).unwrap_or_else(|error| panic!("{name}: {error}"));
    let (place, ram_needed) = ([Core::M4F.name(), name], it.statics + it.stack);
    for (figure, bytes) in [
        ("flash", it.flash),
        ("flash_of_planner", it.planner),
        ("static_ram", it.statics),
        ("stack_of_planner", it.planner_stack),
        ("ram", ram_needed),
    ] {
        book.figure(place, figure, bytes.into());
    }
    if !book.figure(place, "stack", it.stack.into()) {
        book.fail(format!("{name}, deepest: {}", it.chain.join(" > ")));
    }
    book.list(place, "panics", &it.panics);
    for (entry, doubles) in ENTRIES.iter().zip(&it.doubles) {
        book.list(place, &format!("doubles_of_{entry}"), doubles);
    }
    if ram_needed > ram() {
        book.fail(format!("{name} can need {ram_needed} bytes of RAM; there are {}", ram()));
    }
    let allocates = |name: &str| name.contains("__rust_alloc") || name.starts_with("alloc::");
    if let Some(function) = image.functions().iter().find(|it| allocates(&it.name)) {
        book.fail(format!("{name} allocates: {}", function.name));
    }
    it
}
