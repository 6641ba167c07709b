//! Programs for a chip: how they are built, what their ELF holds, who calls whom in it.
//!
//! Stack bounds, paths to a panic and callers of `f64` routines follow from the decoded instructions. So they are facts of the
//! machine code, and an instruction that the decoder does not know is an error.

mod body;
pub mod graph;
pub mod image;
mod thumb;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

use tests::build::{cargo, printed, root, scratch, skip};

/// The target of the chip that any run builds for.
pub const CHIP: &str = "thumbv7em-none-eabihf";

/// A package that is a workspace of its own, and its folder. Its release profile is for chips.
const ALONE: (&str, &str) = ("microbit", "firmware/microbit");

/// The program of `tests/bare-core` that takes charts. It is built by itself, with a feature that the others do not have.
const WITH_CHARTS: &str = "lakes";

/// A program of `tests/bare-core` for a target; `None`, and a visible line, where it cannot be built.
///
/// # Panics
/// As [`folder`].
pub fn bare(target: &str, program: &str) -> Option<Vec<u8>> {
    Some(fs::read(folder("bare-core", target, program)?.join(program)).expect("cargo left an ELF"))
}

/// The folder with the programs of a package for a target; `None`, and a visible line, where they cannot be built. All
/// are built at once but for the one with charts, or with one core in view the program alone that is asked for.
///
/// # Panics
/// When they fail to build, or with `CI` set where they cannot be built.
pub fn folder(package: &str, target: &str, program: &str) -> Option<PathBuf> {
    static BUILT: Mutex<BTreeMap<[String; 3], Option<PathBuf>>> = Mutex::new(BTreeMap::new());
    let is_alone = !cfg!(feature = "all") || program == WITH_CHARTS;
    let one = if is_alone { program } else { "" };
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let made = built.entry([package, target, one].map(str::to_owned)).or_insert_with(|| {
        if has_library(target) {
            return Some(build(package, target, one));
        }
        skip(&format!("{package} for {target}"), "the target is not installed");
        None
    });
    made.clone()
}

/// Builds in a target folder for such programs, in their profile.
fn build(package: &str, target: &str, program: &str) -> PathBuf {
    let directory = scratch().with_file_name("elf");
    let (workspace, profile) = if package == ALONE.0 { (ALONE.1, "release") } else { ("", "chip") };
    let mut cargo = cargo();
    cargo
        .current_dir(root().join(workspace))
        .args(["build", "--quiet", "--profile", profile, "--package", package, "--target", target])
        .arg("--target-dir")
        .arg(&directory)
        .env("DEFMT_LOG", "info")
        // Incremental builds inline otherwise, and what they measure is of no program that ships.
        .env("CARGO_INCREMENTAL", "0");
    if !program.is_empty() {
        cargo.args(["--bin", program]);
    }
    if program == WITH_CHARTS {
        cargo.args(["--features", "charts"]);
    }
    // Flags and wrappers of the host's build (coverage, for one) are not the chip's.
    for host in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER"]
    {
        cargo.env_remove(host);
    }
    printed(&mut cargo);
    directory.join(target).join(profile)
}

/// Whether the standard library for a target is installed; where it is missing, rustup is asked to add it.
fn has_library(target: &str) -> bool {
    let is_there = || {
        let library =
            Command::new("rustc").args(["--print", "target-libdir", "--target", target]).output();
        library.is_ok_and(|it| Path::new(String::from_utf8_lossy(&it.stdout).trim()).is_dir())
    };
    // Whether that worked shows when one looks again.
    is_there()
        || Command::new("rustup").args(["target", "add", target]).output().is_ok() && is_there()
}
