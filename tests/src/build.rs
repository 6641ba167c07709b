//! What tests need besides themselves: programs that cargo builds, tools, and a list of what was left out without them.

use std::collections::BTreeSet;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

/// Builds host-sim with `MAVLink`, in a target directory of its own.
///
/// # Errors
/// What cargo said.
pub fn flying() -> Result<PathBuf, String> {
    let target = scratch().with_file_name("mavlink");
    let mut cargo = cargo();
    cargo
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

/// The repository's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Cargo, in the repository's folder.
pub fn cargo() -> Command {
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.current_dir(root());
    cargo
}

/// What a program prints.
///
/// # Panics
/// With all that it said, when it fails; when it does not start.
pub fn printed(program: &mut Command) -> String {
    let run = program.output().unwrap_or_else(|error| panic!("{program:?}: {error}"));
    let [said, errors] =
        [run.stdout, run.stderr].map(|it| String::from_utf8_lossy(&it).into_owned());
    assert!(run.status.success(), "{program:?}: {said}{errors}");
    said
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

/// Says that tests are left out, in CI too.
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
