//! The committed measurements, and which of them bound a configuration from above.
//!
//! Each measured program has a certain capacity. A configuration gets the figures of the smallest program with enough
//! capacity. So no figure is estimated, and each is an upper bound on what a program made to measure needs.

use anyhow::{Context as _, Result, bail};
use serde::Serialize;
use toml::Table;

use crate::size::configuration::{Configuration, PROGRAMS, Planner, Program};

/// The figures, and the budgets to which `cargo test -p chips` holds the code.
const FOOTPRINT: &str = include_str!("../../../tests/chips/footprint.toml");

/// A core that was measured.
#[derive(Clone, Copy, Debug)]
pub struct Core {
    /// What people call it.
    pub name: &'static str,
    /// What it is called in `footprint.toml`.
    key: &'static str,
}

/// A Cortex-M4 with single precision: all was measured on it.
pub const M4F: Core = Core { name: "Cortex-M4F", key: "cortex-m4f" };

/// Those that were measured besides, in fewer programs.
pub const OTHERS: [Core; 2] = [
    Core { name: "Cortex-M0", key: "cortex-m0" },
    Core { name: "RISC-V RV32IMAC", key: "riscv32imac" },
];

/// What a configuration takes, at most.
#[derive(Clone, Debug, Serialize)]
pub struct Size {
    /// The program whose flash and stack these are.
    pub program: &'static str,
    /// What it has room for.
    pub room: String,
    /// Bytes of flash on each core, with the link and all.
    pub flash: Vec<Flash>,
    /// Bytes of flash for the planner alone, on the Cortex-M4F.
    pub flash_of_planner: u64,
    /// Bytes of stack at most, the planner on it; a bound from the machine code of the Cortex-M4F.
    pub stack: u64,
    /// Bytes of RAM that are not stack.
    pub static_ram: u64,
    /// What calls take.
    pub calls: Vec<Call>,
    /// What they take on other cores.
    pub others: Vec<Other>,
}

/// Bytes of flash on a core.
#[derive(Clone, Debug, Serialize)]
pub struct Flash {
    /// Which.
    pub core: &'static str,
    /// Bytes.
    pub bytes: u64,
}

/// What a call takes of a core.
#[derive(Clone, Debug, Serialize)]
pub struct Call {
    /// `plan`, `observe` or `estimates`.
    pub call: &'static str,
    /// The program that was timed.
    pub program: &'static str,
    /// Instructions, the median of the states that were recorded.
    pub median: u64,
    /// The worst of these.
    pub worst: u64,
    /// Milliseconds of the worst: on the Cortex-M4F an estimate by the manual's table, without wait states.
    pub worst_ms: f64,
}

/// What calls take on a core that was measured in fewer programs.
#[derive(Clone, Debug, Serialize)]
pub struct Other {
    /// Which.
    pub core: &'static str,
    /// The program that was measured.
    pub program: &'static str,
    /// The deepest stack that was seen, bytes: no bound.
    pub stack_seen: u64,
    /// Its clock, MHz.
    pub mhz: f64,
    /// What calls take; milliseconds are the least, by an instruction a cycle.
    pub calls: Vec<Call>,
}

/// What a configuration takes at a clock.
///
/// # Errors
/// When nothing as large was measured.
pub fn size(asked: Configuration, mhz: f64) -> Result<Size> {
    let footprint: Table = FOOTPRINT.parse().context("tests/chips/footprint.toml")?;
    let mut covering = PROGRAMS.iter().filter(|it| it.covers(asked));
    let Some(program) = covering.next() else {
        bail!("nothing as large was measured as {asked}: the largest is {}", largest(asked));
    };
    let flash_of = |core: Core| {
        let bytes = read(&footprint, core, program.name, "flash")?;
        Some(Flash { core: core.name, bytes })
    };
    let of_program = |figure: &str| {
        let value = read(&footprint, M4F, program.name, figure);
        value.with_context(|| format!("footprint.toml: {} has no {figure}", program.name))
    };
    let other = |core: Core| {
        let mhz = footprint.get("clocks")?.get(core.key)?.as_integer()? as f64 / 1e6;
        let calls = calls(&footprint, core, asked, mhz);
        let program = calls.first()?.program;
        let stack_seen = read(&footprint, core, program, "stack_seen")?;
        Some(Other { core: core.name, program, stack_seen, mhz, calls })
    };
    Ok(Size {
        program: program.name,
        room: program.room(),
        flash: [M4F].into_iter().chain(OTHERS).filter_map(flash_of).collect(),
        flash_of_planner: of_program("flash_of_planner")?,
        stack: of_program("stack")?,
        static_ram: of_program("static_ram")?,
        calls: calls(&footprint, M4F, asked, mhz),
        others: OTHERS.into_iter().filter_map(other).collect(),
    })
}

/// What calls take of a core: of each the figures of the first program that has room and was timed.
fn calls(footprint: &Table, core: Core, asked: Configuration, mhz: f64) -> Vec<Call> {
    // What a call takes does not depend on which vehicles the program knows besides.
    let asked = Configuration { roams: false, ..asked };
    let with_room: Vec<_> = PROGRAMS.iter().filter(|it| it.covers(asked)).collect();
    let timed = |program: &'static str, call, figure: &str| {
        let read = |of: &str| read(footprint, core, program, &format!("{figure}_{of}"));
        let (median, worst) = (read("median")?, read("worst")?);
        let cycles = number(footprint, core, program, &format!("{figure}_worst"), "cycles");
        let worst_ms = cycles.unwrap_or(worst) as f64 / (mhz * 1_000.0);
        Some(Call { call, program, median, worst, worst_ms })
    };
    let first = |(call, figures): (&'static str, &[&str])| {
        let programs =
            with_room.iter().flat_map(|it| figures.iter().map(|figure| (it.name, *figure)));
        programs.into_iter().find_map(|(program, figure)| timed(program, call, figure))
    };
    let calls =
        [("plan", plan(asked)), ("observe", observe(asked)), ("estimates", estimate(asked))];
    calls.into_iter().filter_map(first).collect()
}

/// What plans are called among the measurements.
const fn plan(asked: Configuration) -> &'static [&'static str] {
    match asked.planner {
        Planner::Cfc => &["plan", "cfc_plan"],
        Planner::Scc => &["mixture_plan_at_10"],
        Planner::Lookahead if asked.is_noisy() => &["noisy_plan"],
        Planner::Lookahead => &["lookahead_fine_plan"],
        Planner::Track => &["plan"],
    }
}

const fn observe(asked: Configuration) -> &'static [&'static str] {
    if asked.is_noisy() { &["scc_observe_at_32"] } else { &["observe", "cfc_observe"] }
}

const fn estimate(asked: Configuration) -> &'static [&'static str] {
    if asked.is_noisy() { &["scc_estimate_at_32"] } else { &["estimate", "cfc_estimate"] }
}

/// The largest that was measured for the same planner.
fn largest(asked: Configuration) -> String {
    let none = Configuration { samples: 0, hypotheses: asked.hypotheses.min(2), ..asked };
    // Where no program knows other vehicles, the unicycle's is the largest.
    let same = [none, Configuration { roams: false, ..none }];
    let last = same.into_iter().find_map(|same| PROGRAMS.iter().rfind(|it| it.covers(same)));
    last.map_or_else(|| "none".to_owned(), Program::room)
}

/// A figure that was measured.
fn read(footprint: &Table, core: Core, program: &str, figure: &str) -> Option<u64> {
    number(footprint, core, program, figure, "measured")
}

fn number(footprint: &Table, core: Core, program: &str, figure: &str, of: &str) -> Option<u64> {
    let row = footprint.get(core.key)?.get(program)?.get(figure)?;
    u64::try_from(row.get(of)?.as_integer()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_program_has_its_figures() {
        for planner in [Planner::Cfc, Planner::Scc, Planner::Lookahead] {
            for (samples, hypotheses) in [(16, 1), (36, 1), (36, 529), (68, 2_081)] {
                let hypotheses =
                    if planner == Planner::Scc { hypotheses.max(2) } else { hypotheses };
                if planner == Planner::Cfc && hypotheses > 1 {
                    continue;
                }
                let asked = Configuration { planner, samples, hypotheses, roams: false };
                let size = size(asked, 168.0).unwrap_or_else(|error| panic!("{asked}: {error}"));
                assert_eq!(size.flash.len(), 3, "{asked}: {size:?}");
                assert!(size.stack > 4_000 && size.flash_of_planner > 20_000, "{asked}: {size:?}");
                let timed: Vec<_> = size.calls.iter().map(|it| it.call).collect();
                // With 2,081 hypotheses Algorithm 1 alone was timed.
                if samples < 68 {
                    assert_eq!(timed, ["plan", "observe", "estimates"], "{asked}");
                }
                if samples == 16 && hypotheses == 1 {
                    let cores: Vec<_> = size.others.iter().map(|it| it.core).collect();
                    assert_eq!(cores, OTHERS.map(|it| it.name));
                    assert!(size.others.iter().all(|it| it.calls.len() == 3), "{size:?}");
                }
                for call in size.calls.iter().chain(size.others.iter().flat_map(|it| &it.calls)) {
                    assert!(call.median <= call.worst && call.worst_ms > 0.0, "{asked}: {call:?}");
                }
            }
        }
    }

    #[test]
    fn a_follower_has_figures() {
        let asked =
            Configuration { planner: Planner::Track, samples: 0, hypotheses: 0, roams: false };
        let size = size(asked, 168.0).expect("measured");
        assert_eq!((size.program, size.flash.len()), ("track", 3), "{size:?}");
        let calls: Vec<_> = size.calls.iter().map(|it| it.call).collect();
        assert_eq!(calls, ["plan", "observe", "estimates"]);
        assert!(size.others.iter().all(|it| it.calls.len() == 3), "{size:?}");
    }

    #[test]
    fn more_never_takes_less() {
        let asked = |samples, hypotheses, roams| {
            let planner = Planner::Lookahead;
            let asked = Configuration { planner, samples, hypotheses, roams };
            size(asked, 168.0).expect("measured")
        };
        let sizes =
            [asked(4, 1, false), asked(17, 1, false), asked(36, 529, false), asked(37, 530, false)];
        assert!(sizes.windows(2).all(|it| it[0].stack < it[1].stack));
        assert!(asked(36, 1, true).flash_of_planner > asked(36, 529, false).flash_of_planner);
    }
}
