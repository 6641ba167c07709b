//! Hardware in the loop: a chip plans, this program plays its world.

use std::hash::{BuildHasher as _, Hasher as _, RandomState};
use std::io::Write as _;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, anyhow, bail};
use planner_core::link::message::{ClockRate, Took};
use serde::Serialize;

use crate::hil::cable::Cable;
use crate::hil::faults::Faults;
use crate::hil::player::{Played, Player};
use crate::hil::qemu::{Emulator, NS_PER_INSTRUCTION};
use crate::output::file::csv;
use crate::output::notes::count;
use crate::report::table::{Column, Table};

/// Where the chip is.
#[derive(Clone, Debug)]
pub enum Chip {
    /// A board at a serial port.
    Board {
        /// The port.
        device: String,
        /// Its speed, bits per second.
        baud: u32,
    },
    /// A firmware under emulation.
    Emulated {
        /// Its ELF.
        elf: PathBuf,
        /// The machine of QEMU's that it runs on.
        machine: String,
        /// Where its log goes, as defmt encodes it.
        log: Option<PathBuf>,
    },
}

/// How long a chip may be silent before it counts as gone: longer than it waits itself.
const PATIENCE: Duration = Duration::from_secs(30);

/// How long to listen to a chip after its mission, as it may not have heard that the mission is over.
const FAREWELL: Duration = Duration::from_secs(2);

/// What a step took.
#[derive(Clone, Copy, Debug, Serialize)]
struct Timing {
    step: usize,
    plan_ticks: u32,
    observe_ticks: u32,
    /// By the board's clock; empty under emulation.
    plan_us: Option<f64>,
    observe_us: Option<f64>,
    /// Under emulation; empty on a board.
    plan_instructions: Option<u64>,
    observe_instructions: Option<u64>,
    turnaround_ms: f64,
}

/// Lets a chip fly a player's mission. Returns the time from each answer to the next request, as measured here.
///
/// # Errors
/// When there is no chip, or it falls silent, gives up, or sends a request that makes no sense.
pub fn fly(player: &mut Player, chip: &Chip, faults: Faults, seed: u64) -> Result<Vec<Duration>> {
    match chip {
        Chip::Board { device, baud } => {
            let read_timeout = Duration::from_millis(100);
            let port = serialport::new(device, *baud).timeout(read_timeout).open();
            let port = port.map_err(|why| {
                let found = why.to_string().to_lowercase();
                anyhow!("{device}: found {found}, expected a serial port")
            })?;
            let reader = port.try_clone().with_context(|| device.clone())?;
            play(player, Cable::new(reader, port, faults, seed))
        }
        Chip::Emulated { elf, machine, log } => {
            let (mut emulator, link) = Emulator::start(elf, machine, log.as_deref(), &[])?;
            let reader = link.try_clone()?;
            let played = play(player, Cable::new(reader, link, faults, seed));
            played.map_err(|error| emulator.blame(error))
        }
    }
}

/// Plays a world over a cable until the mission is over.
///
/// # Errors
/// As [`fly`].
pub fn play(player: &mut Player, mut cable: Cable) -> Result<Vec<Duration>> {
    let bar = count("steps flown")?;
    let mut turnarounds = Vec::new();
    let mut answered = Instant::now();
    let mut until = answered + PATIENCE;
    while !player.is_dismissed() {
        let bytes = match cable.receive(until) {
            Ok(Some(bytes)) => bytes,
            // It may be gone as soon as its mission is over.
            Ok(None) | Err(_) if player.is_over() => break,
            Ok(None) if player.unreadable() > 0 => bail!(
                "the board has been silent for {} s but for frames that make no sense, {} of them: \
                 does it speak another version of the protocol?",
                PATIENCE.as_secs(),
                player.unreadable()
            ),
            Ok(None) => bail!("the board has been silent for {} s", PATIENCE.as_secs()),
            Err(error) => return Err(error),
        };
        for byte in bytes {
            let (motions, was_over) = (player.motions(), player.is_over());
            let Some(frame) = player.hear(byte)? else { continue };
            if player.motions() > motions {
                // A chip that restarts begins again.
                turnarounds.truncate(motions);
                turnarounds.push(answered.elapsed());
                bar.set_position(player.steps() as u64);
            }
            cable.send(frame.bytes())?;
            answered = Instant::now();
            // Silence is counted from the last word, the farewell from the end of the mission.
            if !was_over {
                until = answered + if player.is_over() { FAREWELL } else { PATIENCE };
            }
        }
    }
    bar.finish_and_clear();
    if player.unreadable() > 0 {
        // Standard error may be closed.
        let _ = writeln!(
            std::io::stderr(),
            "warning: {} frames came whole from the board and held no message",
            player.unreadable()
        );
    }
    Ok(turnarounds)
}

/// A random number, so that each start of this program has another.
pub fn start_number() -> u32 {
    RandomState::new().build_hasher().finish() as u32
}

/// What the steps of a mission took.
#[derive(Clone, Debug)]
pub struct Timings {
    emulated: bool,
    rows: Vec<Timing>,
}

impl Timings {
    /// The chip's own figures and those from here.
    pub fn new(played: &Played, turnarounds: &[Duration]) -> Self {
        let clock = played.clock;
        let each = played.took.iter().zip(turnarounds).zip(1..);
        let rows = each.map(|((took, around), step)| timing(step, *took, clock, *around));
        Self { emulated: clock.emulated, rows: rows.collect() }
    }

    /// As CSV.
    ///
    /// # Errors
    /// When a record could not be written.
    pub fn csv(&self) -> Result<String> {
        csv(&self.rows)
    }

    /// For people.
    pub fn report(&self) -> String {
        let unit = if self.emulated { "instructions" } else { "us" };
        let number = |count: Option<u64>, time: Option<f64>| match (count, time) {
            (Some(count), _) => count.to_string(),
            (_, Some(time)) => format!("{time:.1}"),
            _ => "-".into(),
        };
        let observe = |row: &Timing| number(row.observe_instructions, row.observe_us);
        let table = Table::of(
            &self.rows,
            &[
                (Column::right("step", 4), &|row| row.step.to_string()),
                (Column::right("plan", 12), &|row| number(row.plan_instructions, row.plan_us)),
                (Column::right("observe", 12), &observe),
                (Column::right("round trip ms", 14), &|row| format!("{:.1}", row.turnaround_ms)),
            ],
        );
        format!("What each step took on the chip, {unit}, and from here:\n{table}")
    }
}

fn timing(step: usize, took: Took, clock: ClockRate, turnaround: Duration) -> Timing {
    let seconds = |ticks: u32| f64::from(ticks) / f64::from(clock.per_second.max(1));
    let time = |ticks| (!clock.emulated).then(|| seconds(ticks) * 1e6);
    let count =
        |ticks| clock.emulated.then(|| (seconds(ticks) * 1e9 / NS_PER_INSTRUCTION).round() as u64);
    Timing {
        step,
        plan_ticks: took.plan,
        observe_ticks: took.observe,
        plan_us: time(took.plan),
        observe_us: time(took.observe),
        plan_instructions: count(took.plan),
        observe_instructions: count(took.observe),
        turnaround_ms: turnaround.as_secs_f64() * 1e3,
    }
}
