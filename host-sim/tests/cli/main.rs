//! The command line as its users meet it: the commands, and one wrong input of each kind.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

mod flying;

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

/// The command fails with status 2, prints nothing but one message, and leaves no file behind.
fn refuses(folder: &Path, args: &[&str], parts: &[&str]) {
    let files = |folder: &Path| {
        let mut names: Vec<_> = fs::read_dir(folder)
            .expect("a folder")
            .map(|e| e.expect("an entry").file_name())
            .collect();
        names.sort();
        names
    };
    let before = files(folder);
    let output = host_sim(folder, args);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    assert_eq!(text(&output.stdout), "", "{args:?}");
    assert!(message.starts_with("error: "), "{args:?}: {message}");
    for part in parts {
        assert!(message.contains(part), "{args:?}: expected {part:?} in: {message}");
    }
    assert_eq!(files(folder), before, "{args:?} left a file behind");
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}
