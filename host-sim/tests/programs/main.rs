//! What pages in `cases` cannot show of the command line: signals, programs that are killed, and results that a slow twin
//! computes.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

mod figures;
mod help;
mod tables;

const GOOD: &str = include_str!("../../scenarios/paper-noiseless.toml");

fn host_sim(folder: &Path, args: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_host-sim");
    Command::new(program).args(args).current_dir(folder).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The command succeeds; what it prints.
fn prints(folder: &Path, args: &[&str]) -> String {
    let output = host_sim(folder, args);
    assert!(output.status.success(), "{args:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}
