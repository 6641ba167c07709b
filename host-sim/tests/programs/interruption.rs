//! Signals to a running program: its exit status, and what it leaves behind.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};

use tempfile::TempDir;

use crate::{GOOD, folder, names, prints, text, wait_until};

/// Signals by name, with their numbers.
const SIGNALS: [(&str, i32); 3] = [("HUP", 1), ("INT", 2), ("TERM", 15)];

const LONG: &str = "campaign --fields 1000000 --csv c.csv";

/// A mask of signals in the status of a process; no signal where there is no such file.
fn has_signal(process: &str, mask: &str, number: i32) -> bool {
    let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix(mask)?.strip_prefix(':'));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (number - 1) & 1 == 1
}

/// A program inherits ignored signals, as background jobs of a shell do. No test can send those.
fn sendable() -> impl Iterator<Item = (&'static str, i32)> {
    SIGNALS.into_iter().filter(|(_, number)| !has_signal("self", "SigIgn", *number))
}

fn start(command: &mut Command, folder: &Path) -> Child {
    command
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts")
}

fn host_sim(folder: &Path, args: &str) -> Child {
    start(Command::new(env!("CARGO_BIN_EXE_host-sim")).args(args.split(' ')), folder)
}

/// The shell's own `kill`: not every system has a program of that name.
fn kill(args: &str) -> bool {
    let shell = Command::new("sh").args(["-c", &format!("kill {args} 2>&-")]).status();
    shell.expect("a shell").success()
}

/// Sends the signal: the exit status, and what the program said.
fn ended(child: Child, signal: &str) -> (Option<i32>, String) {
    assert!(kill(&format!("-s {signal} {}", child.id())), "it has ended");
    let Output { status, stderr, .. } = child.wait_with_output().expect("it ends");
    (status.code(), text(&stderr))
}

fn length(file: &Path) -> u64 {
    fs::metadata(file).map_or(0, |found| found.len())
}

/// A campaign that is ended leaves its rows and says where.
fn leaves_rows(campaign: Child, folder: &Path, signal: &str, number: i32) {
    let (status, message) = ended(campaign, signal);
    assert_eq!(status, Some(128 + number), "{signal}");
    assert!(message.starts_with("stopped: ") && message.lines().count() == 1, "{message}");
    assert!(message.contains("c.csv.partial") && message.contains("--from"), "{message}");
    assert_eq!(names(folder), ["c.csv.partial"]);
}

#[test]
fn an_interrupted_campaign_leaves_its_rows() {
    for (signal, number) in sendable() {
        let folder = folder();
        let campaign = host_sim(folder.path(), LONG);
        wait_until("it has rows", || length(&folder.path().join("c.csv.partial")) > 1_000);
        leaves_rows(campaign, folder.path(), signal, number);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_campaign_without_rows_leaves_nothing() {
    let folder = folder();
    let campaign = host_sim(folder.path(), "campaign --fields 1000000");
    let id = campaign.id().to_string();
    wait_until("it handles signals", || has_signal(&id, "SigCgt", 15));
    assert_eq!(ended(campaign, "TERM"), (Some(128 + 15), String::new()));
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_run_that_waits_for_a_reader_can_be_interrupted() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(pipe).status().expect("mkfifo").success());
    let run = host_sim(folder.path(), "run m.toml --trace t.jsonl --figure pipe");
    wait_until("its trace is begun", || names(folder.path()).len() == 3);
    assert_eq!(ended(run, "TERM"), (Some(128 + 15), String::new()));
    assert_eq!(names(folder.path()), ["m.toml", "pipe"]);
}

/// As with `nohup`.
#[test]
fn a_signal_that_is_ignored_from_the_start_stays_so() {
    let folder = folder();
    let script = format!("trap '' HUP; exec {} {LONG}", env!("CARGO_BIN_EXE_host-sim"));
    let campaign = start(Command::new("sh").args(["-c", &script]), folder.path());
    let rows = folder.path().join("c.csv.partial");
    wait_until("it has rows", || length(&rows) > 1_000);
    assert!(kill(&format!("-s HUP {}", campaign.id())), "it has ended");
    let then = length(&rows);
    wait_until("it has more rows", || length(&rows) > then + 1_000);
    leaves_rows(campaign, folder.path(), "TERM", 15);
}

/// A folder with a mission, what passes for a firmware, and an emulator that does not end.
fn with_emulator() -> TempDir {
    let folder = folder();
    let place = |name: &str| folder.path().join(name);
    for name in ["bin", "tmp"] {
        fs::create_dir(place(name)).expect("a folder");
    }
    fs::write(place("m.toml"), GOOD).expect("a file");
    // The header of an ELF file for an Arm.
    fs::write(place("firmware"), [b"\x7fELF\x01".as_slice(), &[0; 13], &[40, 0]].concat())
        .expect("a file");
    let emulator = place("bin/qemu-system-arm");
    fs::write(&emulator, "#!/bin/sh\necho $$ >started; mv started id; exec sleep 600\n")
        .expect("a file");
    fs::set_permissions(&emulator, fs::Permissions::from_mode(0o755)).expect("a mode");
    folder
}

/// Flies with that emulator, until it runs.
fn fly(folder: &Path, flags: &str) -> Child {
    let args = format!("hil m.toml --emulator=firmware --log log --trace t.jsonl {flags}");
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command
        .args(args.split_whitespace())
        .env("PATH", format!("{}:{path}", folder.join("bin").display()))
        .env("TMPDIR", folder.join("tmp"));
    let child = start(&mut command, folder);
    wait_until("the emulator runs", || folder.join("id").exists());
    child
}

#[test]
fn an_interrupted_emulator_is_no_orphan() {
    for (signal, number) in sendable() {
        let folder = with_emulator();
        let hil = fly(folder.path(), "");
        assert_eq!(ended(hil, signal), (Some(128 + number), String::new()), "{signal}");
        let id = fs::read_to_string(folder.path().join("id")).expect("its id");
        assert!(!kill(&format!("-0 {}", id.trim())), "{signal}: the emulator still runs");
        assert_eq!(names(folder.path()), ["bin", "firmware", "id", "m.toml", "tmp"], "{signal}");
        assert_eq!(names(&folder.path().join("tmp")), [""; 0], "{signal}");
    }
}

/// Steps that were flown before stay, without a line that is not whole, and the message says where.
#[test]
fn an_interrupted_mission_leaves_its_steps() {
    let folder = with_emulator();
    let whole = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
    let at = whole.match_indices('\n').nth(4).expect("a step").0 + 1;
    let partial = folder.path().join("t.jsonl.partial");
    fs::write(&partial, &whole[..at + 30]).expect("a file");
    let (status, message) = ended(fly(folder.path(), "--resume"), "TERM");
    assert_eq!(status, Some(128 + 15));
    let says = "steps are in t.jsonl.partial";
    assert!(message.contains(says) && message.contains("--resume"), "{message}");
    assert_eq!(fs::read_to_string(partial).expect("it stays"), whole[..at]);
}
