//! Programs for a chip, built by cargo for a test.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, io};

/// Builds the programs of a package in the release profile and returns the folder they are in.
///
/// `scratch` is the test's `CARGO_TARGET_TMPDIR`; beside it is the target directory of all such
/// builds. Cargo's lock on that keeps tests apart that build at the same time.
///
/// # Errors
/// What cargo said.
pub fn build(scratch: &str, package: &str, target: &str) -> Result<PathBuf, String> {
    let directory = Path::new(scratch).with_file_name("elf");
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["build", "--quiet", "--release", "--package", package, "--target", target])
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
    Ok(directory.join(target).join("release"))
}

/// Whether the standard library for a target is installed.
pub fn can_build(target: &str) -> bool {
    let libraries =
        Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
    libraries.is_ok_and(|it| Path::new(String::from_utf8_lossy(&it.stdout).trim()).is_dir())
}

/// Whether a program is on `PATH`.
pub fn has_tool(name: &str) -> bool {
    Command::new(name).arg("--version").output().is_ok()
}

/// Says that a part of a test is left out, and why.
///
/// # Panics
/// With `CI` set: there nothing may be left out.
pub fn skip(what: &str, why: &str) {
    assert!(env::var_os("CI").is_none(), "cannot run {what}: {why}");
    // Straight to the handle: what the print macros write, libtest swallows when a test passes.
    let _ = io::stderr().write_all(format!("SKIPPED {what}: {why}\n").as_bytes());
}
