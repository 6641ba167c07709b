//! Programs for a chip, built by cargo for a test.

use std::collections::BTreeSet;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::{env, fs, io};

/// A package that is a workspace of its own, and its folder. Its release profile is for chips.
const ALONE: (&str, &str) = ("microbit", "firmware/microbit");

/// Builds the programs of a package in their profile for chips and returns the folder they are in.
///
/// All such builds have a target directory of their own. Cargo's lock on that keeps tests apart that build at the same
/// time.
///
/// # Errors
/// What cargo said.
pub fn build(package: &str, target: &str) -> Result<PathBuf, String> {
    let directory = scratch().with_file_name("elf");
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    let (workspace, profile) = if package == ALONE.0 { (ALONE.1, "release") } else { ("", "chip") };
    cargo
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(workspace))
        .args(["build", "--quiet", "--profile", profile])
        .args(["--package", package, "--target", target])
        .arg("--target-dir")
        .arg(&directory)
        .env("DEFMT_LOG", "info");
    // Flags and wrappers of the host's build (coverage, for one) are not the chip's.
    for host in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER"]
    {
        cargo.env_remove(host);
    }
    let built = cargo.output().map_err(|error| format!("cargo does not start: {error}"))?;
    if !built.status.success() {
        let errors = String::from_utf8_lossy(&built.stderr);
        return Err(format!("{package} fails to build for {target}:\n{errors}"));
    }
    Ok(directory.join(target).join(profile))
}

/// The target of the chip that budgets are for. Any run builds for it.
pub const CHIP: &str = "thumbv7em-none-eabihf";

/// Whether the other cores are asked for too: by `CORES=all` in the environment, or by a long run.
pub fn all_cores() -> bool {
    crate::is_long() || env::var("CORES").is_ok_and(|it| it == "all")
}

/// The folder with the programs of a package for a target, built; `None`, and a visible line, where nobody asks for
/// its core, or where that cannot be done.
///
/// # Panics
/// When they fail to build, or with `CI` set where they cannot be built.
pub fn folder(package: &str, target: &str) -> Option<PathBuf> {
    let what = format!("{package} for {target}");
    if target != CHIP && !all_cores() {
        leave_out(&what, "CORES=all cargo test has it");
        return None;
    }
    if !can_build(target) {
        skip(&what, "the target is not installed");
        return None;
    }
    Some(build(package, target).unwrap_or_else(|errors| panic!("{errors}")))
}

/// As [`folder`], as a function that reads a program.
///
/// # Panics
/// As [`folder`].
pub fn programs(package: &str, target: &str) -> Option<impl Fn(&str) -> Vec<u8> + use<>> {
    let folder = folder(package, target)?;
    Some(move |name: &str| fs::read(folder.join(name)).expect("cargo left an ELF"))
}

/// Builds host-sim with `MAVLink`, in a target directory of its own.
///
/// # Errors
/// What cargo said.
pub fn flying() -> Result<PathBuf, String> {
    let target = scratch().with_file_name("mavlink");
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["build", "--quiet", "--package", "host-sim", "--features", "mavlink"])
        .arg("--target-dir")
        .arg(&target)
        // It waits for vehicles most of the time, so it need not be fast.
        .env("CARGO_PROFILE_DEV_OPT_LEVEL", "0");
    let built = cargo.output().map_err(|error| format!("cargo does not start: {error}"))?;
    if !built.status.success() {
        return Err(String::from_utf8_lossy(&built.stderr).into_owned());
    }
    Ok(target.join("debug").join("host-sim"))
}

/// Whether the standard library for a target is installed; where it is missing, rustup is asked to add
/// it.
fn can_build(target: &str) -> bool {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _guard = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let is_there = || {
        let libraries =
            Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
        libraries.is_ok_and(|it| Path::new(String::from_utf8_lossy(&it.stdout).trim()).is_dir())
    };
    if !is_there() {
        // Whether it worked shows when one looks again.
        let _ = Command::new("rustup").args(["target", "add", target]).output();
    }
    is_there()
}

/// Whether a program is on `PATH`.
pub fn has_tool(name: &str) -> bool {
    Command::new(name).arg("--version").output().is_ok()
}

/// Whether Python has a module of a package. If not, says which part of a test is left out.
///
/// # Panics
/// As [`skip`].
pub fn has_module(module: &str, package: &str, what: &str) -> bool {
    let import = Command::new("python3").args(["-c", &format!("import {module}")]).output();
    let is_there = import.is_ok_and(|it| it.status.success());
    if !is_there {
        skip(what, &format!("python3 has no {package}"));
    }
    is_there
}

/// Says that a part of a test is left out, and why: at once, and again when all tests have run (the test
/// `zz_skipped`).
///
/// # Panics
/// With `CI` set: there nothing may be left out.
pub fn skip(what: &str, why: &str) {
    assert!(env::var_os("CI").is_none(), "cannot run {what}: {why}");
    leave_out(what, why);
}

/// Whether this is a long run. If it is not, says that only a long run has a test.
pub fn is_long(what: &str, module: &str) -> bool {
    if !crate::is_long() {
        leave_out(what, &format!("a long run has it: LONG=1 cargo test -p tests {module}::"));
    }
    crate::is_long()
}

/// Says that a test is left out, in CI too: it needs what nobody has to have.
pub fn leave_out(what: &str, why: &str) {
    let line = format!("SKIPPED {what}: {why}\n");
    // Straight to the handle: what the print macros write, libtest swallows when a test passes.
    let _ = io::stderr().write_all(line.as_bytes());
    let list = OpenOptions::new().create(true).append(true).open(list());
    let _ = list.and_then(|mut list| list.write_all(line.as_bytes()));
}

/// What the tests of this run left out so far, and an empty list for the next.
pub fn skipped() -> Vec<String> {
    let lines = fs::read_to_string(list()).unwrap_or_default();
    let _ = fs::remove_file(list());
    let lines: BTreeSet<_> = lines.lines().map(str::to_owned).collect();
    lines.into_iter().collect()
}

fn list() -> PathBuf {
    scratch().join("skipped")
}

/// Where tests may write: `tmp` in the target folder that they run from.
///
/// # Panics
/// When this program is in no such folder.
pub fn scratch() -> PathBuf {
    let program = env::current_exe().expect("a path");
    let target = program.ancestors().nth(3).expect("it is in target/debug/deps");
    target.join("tmp")
}
