//! The firmwares for the emulator: built if this program runs in the repository, with the target if necessary.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, Result, bail};

use crate::output::interruption::unfinished;
use crate::output::notes::announce;

/// A board that this repository has a firmware for. Places are as seen from the repository.
#[derive(Debug)]
pub struct Firmware {
    /// The machine of QEMU's that runs it.
    pub machine: &'static str,
    /// Where it lies when it is built.
    pub elf: &'static str,
    /// The package that it is built from.
    package: &'static str,
    profile: &'static str,
    target: &'static str,
}

/// The default board: an STM32F405.
pub const STM32F405: Firmware = Firmware {
    machine: "netduinoplus2",
    elf: "target/thumbv7em-none-eabihf/chip/firmware",
    package: "firmware/Cargo.toml",
    profile: "chip",
    target: "thumbv7em-none-eabihf",
};

/// The BBC micro:bit.
pub const MICROBIT: Firmware = Firmware {
    machine: "microbit",
    elf: "target/thumbv6m-none-eabi/release/microbit",
    package: "firmware/microbit/Cargo.toml",
    profile: "release",
    target: "thumbv6m-none-eabi",
};

impl Firmware {
    /// The firmware of a machine, if there is one.
    pub fn of(machine: &str) -> Option<&'static Self> {
        [&STM32F405, &MICROBIT].into_iter().find(|it| it.machine == machine)
    }

    /// The path of the firmware. It is built if its sources are here; else the ELF that is there is taken.
    ///
    /// # Errors
    /// When it is not there and cannot be built: what is missing, or what failed to build.
    pub fn built(&self) -> Result<PathBuf> {
        let Self { elf, package, profile, target, .. } = *self;
        if !Path::new(package).exists() {
            if Path::new(elf).exists() {
                return Ok(elf.into());
            }
            bail!(
                "--emulator: found no {elf} and no sources to build it from, expected to be run in the repository, \
                 or --emulator=ELF"
            );
        }
        if !Path::new(elf).exists() {
            announce("The firmware is built first, which takes a minute once.");
            add_target(target)?;
        }
        let mut cargo = Command::new("cargo");
        cargo.args(["build", "--profile", profile, "--quiet", "--locked"]);
        cargo.args(["--manifest-path", package, "--target", target]);
        // Where people look for it, whatever folder the caller has for targets.
        cargo.args(["--target-dir", "target"]);
        let status = run(&mut cargo).context("cargo: expected on PATH, to build the firmware")?;
        if !status.success() {
            bail!("--emulator: the firmware does not build, see above");
        }
        Ok(elf.into())
    }
}

/// Lets rustup add the chip's libraries. Without rustup nothing is added, and cargo says what is missing.
fn add_target(target: &str) -> Result<()> {
    let mut rustup = Command::new("rustup");
    rustup.args(["--quiet", "target", "add", target]);
    match run(&mut rustup) {
        Ok(status) if !status.success() => {
            bail!("--emulator: rustup could not add the target {target}, see above")
        }
        _ => Ok(()),
    }
}

/// Runs a program to its end; an interruption ends it too.
fn run(command: &mut Command) -> Result<ExitStatus> {
    let id = {
        let mut unfinished = unfinished();
        let child = command.stdin(Stdio::null()).stdout(Stdio::null()).spawn()?;
        let id = child.id();
        unfinished.children.insert(id, child);
        id
    };
    loop {
        let mut unfinished = unfinished();
        let child = unfinished.children.get_mut(&id).context("it was ended")?;
        if let Some(status) = child.try_wait()? {
            unfinished.children.remove(&id);
            return Ok(status);
        }
        drop(unfinished);
        thread::sleep(Duration::from_millis(20));
    }
}
