//! `hil`: one mission that a board plans, or its firmware under emulation.

use std::path::{Path, PathBuf};
use std::{env, fs};

use anyhow::{Context as _, Result, bail};
use clap::{Args, ValueEnum};
use planner_core::link::message::LabelSource;

use crate::cli::done::Done;
use crate::cli::help;
use crate::cli::run::{Format, Run};
use crate::hil::faults::Faults;
use crate::hil::firmware::{Firmware, STM32F405};
use crate::hil::flight::{self, Chip, Timings};
use crate::hil::player::Player;
use crate::hil::qemu::usual_machine;
use crate::output::file::{place_for, prepare_all, temporary};
use crate::output::notes::announce;

/// The speed of the firmware's serial lines, bits per second.
const BAUD: u32 = 115_200;

#[derive(Debug, Args)]
#[command(after_help = help::HIL)]
#[group(id = "chip", required = true, multiple = false, args = ["port", "emulator"])]
pub(crate) struct HilArgs {
    #[command(flatten)]
    pub(crate) run: Run,
    /// The serial port of the board
    #[arg(long, value_name = "DEVICE")]
    pub(crate) port: Option<String>,
    /// The port's speed, bits per second [default: 115200]
    #[arg(long, conflicts_with = "emulator")]
    pub(crate) baud: Option<u32>,
    /// Emulate the firmware under QEMU instead; without a path it is built here where needed
    #[arg(long, value_name = "ELF", num_args = 0..=1, require_equals = true)]
    #[expect(clippy::option_option, reason = "as clap tells a flag from one with a value")]
    pub(crate) emulator: Option<Option<PathBuf>>,
    /// The machine that QEMU emulates: netduinoplus2, microbit, or the name of one for your ELF [default:
    /// netduinoplus2, or virt for RISC-V]
    #[arg(long, value_name = "NAME", conflicts_with = "port", value_parser = machine)]
    pub(crate) machine: Option<String>,
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
    /// Continue the steps of the same command, if it was stopped, and after a restart of the board
    #[arg(long, requires = "trace")]
    pub(crate) resume: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Labels {
    /// The simulated vehicle
    #[default]
    Vehicle,
    /// The board's own sensor
    Chip,
}

/// What QEMU runs.
#[derive(Clone, Copy)]
enum Emulated<'a> {
    /// A firmware of this repository, to be built where needed.
    Ours(&'static Firmware),
    /// An ELF.
    Yours(&'a Path),
}

impl Emulated<'_> {
    fn elf(&self) -> &Path {
        match self {
            Self::Ours(firmware) => Path::new(firmware.elf),
            Self::Yours(elf) => elf,
        }
    }
}

impl HilArgs {
    fn machine(&self) -> &str {
        let usual = || match &self.emulator {
            Some(Some(elf)) => usual_machine(elf),
            _ => STM32F405.machine,
        };
        self.machine.as_deref().unwrap_or_else(usual)
    }

    fn emulated(&self) -> Result<Emulated<'_>> {
        if let Some(Some(elf)) = &self.emulator {
            return Ok(Emulated::Yours(elf));
        }
        let machine = self.machine();
        let ours = Firmware::of(machine).with_context(|| {
            format!("--machine {machine}: no firmware for it is here, expected --emulator=ELF")
        });
        ours.map(Emulated::Ours)
    }
}

/// The name of a machine, without options for it: these are QEMU's to take.
fn machine(name: &str) -> Result<String, String> {
    let is_name = |c: char| c.is_ascii_alphanumeric() || "-._".contains(c);
    if name.is_empty() || !name.chars().all(is_name) {
        return Err("expected the name of a machine of QEMU's, as microbit".into());
    }
    Ok(name.into())
}

/// Flies it, and what to print.
pub(crate) fn hil(args: &HilArgs) -> Result<Done> {
    let mission = args.run.mission()?;
    let emulated = args.emulated()?;
    let (chip, board) = match &args.port {
        Some(device) => ("the port", Path::new(device)),
        None => ("the firmware", emulated.elf()),
    };
    let growing = args.run.trace.as_deref().filter(|_| args.resume);
    if let Some(path) = growing
        && place_for(path)?.is_stream()
    {
        bail!("{}: found a stream, expected a file with --resume", path.display());
    }
    let live = args.run.live(&mission)?;
    let own = [("--timing", args.timing.as_deref()), ("--log", args.log.as_deref())];
    let asked = [&own[..], &args.run.outputs()].concat();
    let mut outputs = prepare_all(&[args.run.input(), (chip, board)], &asked)?.into_iter();
    let [timing, log] = [outputs.next().flatten(), outputs.next().flatten()];
    // The place of a trace that grows will do: it grows beside it.
    let outputs = asked[own.len()..].iter().zip(outputs);
    let outputs =
        outputs.map(|((flag, _), it)| it.filter(|_| !(args.resume && *flag == "--trace")));
    // The emulator writes its log as it goes; it comes to its place when it is whole.
    let log = log.map(|log| Ok::<_, anyhow::Error>((log, temporary(&env::temp_dir())?)));
    let log = log.transpose().context("expected a place for temporary files")?;
    let labels = match args.labels {
        Labels::Vehicle => LabelSource::Vehicle,
        Labels::Chip => LabelSource::Chip,
    };
    let mut player =
        Player::new(&mission, labels, flight::start_number()).with_context(|| args.run.name())?;
    player = player.shown(live);
    if let Some(path) = growing {
        player = player.keeping(path)?;
    }
    let chip = if let Some(device) = &args.port {
        Chip::Board { device: device.clone(), baud: args.baud.unwrap_or(BAUD) }
    } else {
        let elf = match emulated {
            Emulated::Ours(firmware) => {
                if let Some(live) = player.live() {
                    live.say("the firmware is built, if it is not there yet");
                }
                firmware.built()?
            }
            Emulated::Yours(elf) => elf.to_owned(),
        };
        let log = log.as_ref().map(|(_, said)| said.path().to_owned());
        Chip::Emulated { elf, machine: args.machine().to_owned(), log }
    };
    let faults = args.fault.unwrap_or_default();
    let made_before = player.steps();
    let flown = flight::fly(&mut player, &chip, faults, mission.seed);
    if let Some((log, said)) = log {
        let said = fs::read(said.path())?;
        // What the board said is wanted most when its mission has failed.
        if flown.is_ok() || !said.is_empty() {
            log.write(said)?;
        }
    }
    if let (Some(logbook), Err(_)) = (player.logbook(), &flown)
        && player.steps() > made_before
    {
        announce(logbook.farewell());
    }
    if let (Some(live), Err(why)) = (player.live(), &flown) {
        live.break_off(why);
    }
    let turnarounds = flown?;
    let played = player.finish_as_far_as_flown().with_context(|| args.run.name());
    let (mut played, failure) = played?;
    if let Some(live) = &mut played.live {
        if let Some(why) = &failure {
            live.say(why);
        }
        live.end(&played.recording);
    }
    let timings = Timings::new(&played, &turnarounds);
    let rows = timings.csv()?;
    let mut text = args.run.tell(outputs, &played.recording)?;
    match (played.logbook.take(), &failure) {
        (Some(logbook), None) => logbook.complete(&played.recording.results.end)?,
        // A sensor or a vehicle that failed may work again, so the mission can go on.
        (Some(logbook), Some(_)) => announce(logbook.farewell()),
        (None, _) => {}
    }
    if let Some(output) = timing {
        output.write(rows)?;
    }
    if args.run.format == Format::Text {
        text.push('\n');
        text.push_str(&timings.report());
    }
    Ok(args.run.done(text, failure))
}
