//! `hil`: one mission that a board plans, or its firmware under emulation.

use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context as _, Result};
use clap::{Args, ValueEnum};
use planner_core::link::message::LabelSource;

use crate::cli::help;
use crate::cli::run::{Format, Run};
use crate::hil::faults::Faults;
use crate::hil::firmware::{self, FIRMWARE};
use crate::hil::flight::{self, Chip, Timings};
use crate::hil::player::Player;
use crate::output::file::{prepare, temporary};

/// The speed of the firmware's serial lines, bits per second.
const BAUD: u32 = 115_200;

#[derive(Debug, Args)]
#[command(after_help = help::HIL)]
#[group(id = "chip", required = true, multiple = false, args = ["port", "emulator"])]
pub(crate) struct HilArgs {
    #[command(flatten)]
    pub(crate) run: Run,
    /// The serial port that a board is at
    #[arg(long, value_name = "DEVICE")]
    pub(crate) port: Option<String>,
    /// The port's speed, bits per second [default: 115200]
    #[arg(long, conflicts_with = "emulator")]
    pub(crate) baud: Option<u32>,
    /// Emulate the firmware under QEMU instead; without a path it is built here where needed
    #[arg(
        long,
        value_name = "ELF",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = FIRMWARE
    )]
    pub(crate) emulator: Option<PathBuf>,
    /// Write the emulated board's log here, for defmt-print
    #[arg(long, value_name = "FILE", conflicts_with = "port")]
    pub(crate) log: Option<PathBuf>,
    /// Who reads labels: the simulated vehicle, or the board's own pin
    #[arg(long, value_enum, default_value_t)]
    pub(crate) labels: Labels,
    /// Spoil the link: drop, cut, corrupt, duplicate (probabilities of a frame), delay (at most)
    #[arg(long, value_name = "drop=0.1,delay=20ms,...")]
    pub(crate) fault: Option<Faults>,
    /// Write what each step took here
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) timing: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Labels {
    /// The simulated vehicle
    #[default]
    Vehicle,
    /// The board's own sensor
    Chip,
}

/// Flies it, and what to print.
pub(crate) fn hil(args: &HilArgs) -> Result<String> {
    let mission = args.run.mission()?;
    let elf = args.emulator.clone().unwrap_or_else(|| FIRMWARE.into());
    let (chip, board) = match &args.port {
        Some(device) => ("the port", Path::new(device)),
        None => ("the firmware", elf.as_path()),
    };
    let [trace, figure, candidates, report, mcap] = args.run.outputs();
    let (timing, log) = (args.timing.as_deref(), args.log.as_deref());
    let asked = [trace, figure, candidates, report, mcap, ("--timing", timing), ("--log", log)];
    let prepared = prepare(&[args.run.input(), (chip, board)], asked)?;
    let [trace, figure, candidates, report, mcap, timing, log] = prepared;
    // The emulator writes its log as it goes; it comes to its place when it is whole.
    let log = log.map(|log| Ok::<_, anyhow::Error>((log, temporary(&env::temp_dir())?)));
    let log = log.transpose().context("expected a place for temporary files")?;
    let labels = match args.labels {
        Labels::Vehicle => LabelSource::Vehicle,
        Labels::Chip => LabelSource::Chip,
    };
    let mut player =
        Player::new(&mission, labels, flight::start_number()).with_context(|| args.run.name())?;
    let chip = if let Some(device) = &args.port {
        Chip::Board { device: device.clone(), baud: args.baud.unwrap_or(BAUD) }
    } else {
        let elf = if elf == Path::new(FIRMWARE) { firmware::built()? } else { elf };
        Chip::Emulated { elf, log: log.as_ref().map(|(_, said)| said.path().to_owned()) }
    };
    let faults = args.fault.unwrap_or_default();
    let flown = flight::fly(&mut player, &chip, faults, mission.seed);
    if let Some((log, said)) = log {
        let said = fs::read(said.path())?;
        // What the board said is wanted most when its mission has failed.
        if flown.is_ok() || !said.is_empty() {
            log.write(said)?;
        }
    }
    let turnarounds = flown?;
    let played = player.finish().with_context(|| args.run.name())?;
    let timings = Timings::new(&played, &turnarounds);
    let rows = timings.csv()?;
    let mut text = args.run.tell([trace, figure, candidates, report, mcap], &played.recording)?;
    if let Some(output) = timing {
        output.write(rows)?;
    }
    if args.run.format == Format::Text {
        text.push('\n');
        text.push_str(&timings.report());
    }
    Ok(text)
}
