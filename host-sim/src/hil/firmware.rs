//! The firmware for the emulator: built where this is run in the repository, target and all.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, Result, bail};

use crate::output::interruption::unfinished;
use crate::output::notes::announce;

/// Where it lies when it is built, as seen from the repository.
pub const FIRMWARE: &str = "target/thumbv7em-none-eabihf/release/firmware";

/// The package that it is built from, as seen from the repository.
const PACKAGE: &str = "firmware/Cargo.toml";

const TARGET: &str = "thumbv7em-none-eabihf";

/// The firmware that belongs to this repository, as new as its sources. Elsewhere what lies at its place.
///
/// # Errors
/// When it is not there and cannot be built: what is missing, or what failed to build.
pub fn built() -> Result<PathBuf> {
    if !Path::new(PACKAGE).exists() {
        if Path::new(FIRMWARE).exists() {
            return Ok(FIRMWARE.into());
        }
        bail!(
            "--emulator: found no {FIRMWARE} and no sources to build it from, expected to be run in the \
             repository, or --emulator=ELF"
        );
    }
    if !Path::new(FIRMWARE).exists() {
        announce("The firmware is built first, which takes a minute once.");
        add_target()?;
    }
    let mut cargo = Command::new("cargo");
    // Where people look for it, whatever folder the caller has for targets.
    cargo.args(["firmware", "--quiet", "--locked", "--target-dir", "target"]);
    let status = run(&mut cargo).context("cargo: expected on PATH, to build the firmware")?;
    if !status.success() {
        bail!("--emulator: the firmware does not build, see above");
    }
    Ok(FIRMWARE.into())
}

/// Has rustup add the chip's libraries. Without rustup they are whoever installed Rust's to add, and cargo says so.
fn add_target() -> Result<()> {
    let mut rustup = Command::new("rustup");
    rustup.args(["--quiet", "target", "add", TARGET]);
    match run(&mut rustup) {
        Ok(status) if !status.success() => {
            bail!("--emulator: rustup could not add the target {TARGET}, see above")
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
