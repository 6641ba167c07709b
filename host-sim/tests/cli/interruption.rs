//! Signals to a running program: its exit status, and that nothing is left behind.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::{GOOD, folder, text};

/// Signals by name, with their numbers.
const SIGNALS: [(&str, i32); 3] = [("HUP", 1), ("INT", 2), ("TERM", 15)];

const LONG: [&str; 5] = ["campaign", "--fields", "10000000", "--csv", "c.csv"];

/// A signal that this test was started with ignored, as a shell's background jobs are, reaches no program of
/// its own either.
fn reaches(number: i32) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    let reaches = mask >> (number - 1) & 1 == 0;
    if !reaches {
        println!("SKIPPED: signal {number} is ignored here");
    }
    reaches
}

fn start(command: &mut Command, folder: &Path) -> Child {
    command
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts")
}

fn host_sim(folder: &Path, args: &[&str]) -> Child {
    start(Command::new(env!("CARGO_BIN_EXE_host-sim")).args(args), folder)
}

fn signal(child: &Child, name: &str) {
    assert!(kill(&format!("-s {name} {}", child.id())), "it has ended");
}

/// The shell's own `kill`; a program of that name is not everywhere.
fn kill(args: &str) -> bool {
    let shell = Command::new("sh").args(["-c", &format!("kill {args}")]).output();
    shell.expect("a shell").status.success()
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let until = Instant::now() + Duration::from_secs(20);
    while !is_so() {
        assert!(Instant::now() < until, "waited in vain until {what}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// What a program ended with, and that it said nothing.
fn status(child: Child) -> Option<i32> {
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(text(&output.stderr), "");
    output.status.code()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> = entries
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Whether a campaign has some rows.
fn has_rows(folder: &Path) -> bool {
    fs::metadata(folder.join("c.csv.partial")).is_ok_and(|found| found.len() > 1_000)
}

/// What a campaign ended with. It leaves its rows and says where.
fn status_of_campaign(campaign: Child, folder: &Path) -> Option<i32> {
    let output = campaign.wait_with_output().expect("it ends");
    let message = text(&output.stderr);
    assert!(message.starts_with("stopped: ") && message.lines().count() == 1, "{message}");
    assert!(message.contains("c.csv.partial") && message.contains("--resume"), "{message}");
    assert_eq!(names(folder), ["c.csv.partial", "c.csv.partial.json"]);
    output.status.code()
}

#[test]
fn an_interrupted_campaign_leaves_its_rows() {
    for (name, number) in SIGNALS.into_iter().filter(|(_, number)| reaches(*number)) {
        let folder = folder();
        let campaign = host_sim(folder.path(), &LONG);
        wait_until("it has rows", || has_rows(folder.path()));
        signal(&campaign, name);
        assert_eq!(status_of_campaign(campaign, folder.path()), Some(128 + number), "{name}");
    }
}

#[test]
fn an_interrupted_campaign_without_rows_leaves_nothing() {
    let folder = folder();
    let campaign = host_sim(folder.path(), &LONG[..3]);
    thread::sleep(Duration::from_millis(300));
    signal(&campaign, "TERM");
    assert_eq!(status(campaign), Some(128 + 15));
    assert_eq!(names(folder.path()), [""; 0]);
}

#[test]
fn a_run_that_waits_for_a_reader_can_be_interrupted() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(pipe).status().expect("mkfifo").success());
    let args = ["run", "m.toml", "--trace", "t.jsonl", "--figure", "pipe"];
    let run = host_sim(folder.path(), &args);
    wait_until("its trace is begun", || names(folder.path()).len() == 3);
    signal(&run, "TERM");
    assert_eq!(status(run), Some(128 + 15));
    assert_eq!(names(folder.path()), ["m.toml", "pipe"]);
}

#[test]
fn a_signal_that_is_ignored_from_the_start_stays_so() {
    let folder = folder();
    let script = format!("trap '' HUP; exec {} {}", env!("CARGO_BIN_EXE_host-sim"), LONG.join(" "));
    let mut campaign = start(Command::new("sh").args(["-c", &script]), folder.path());
    wait_until("it has rows", || has_rows(folder.path()));
    signal(&campaign, "HUP");
    thread::sleep(Duration::from_millis(300));
    assert!(campaign.try_wait().expect("a child").is_none(), "nohup would not help");
    signal(&campaign, "TERM");
    assert_eq!(status_of_campaign(campaign, folder.path()), Some(128 + 15));
}

/// A folder with a mission, what passes for a firmware, and an emulator that logs some words and then does as
/// a script says.
fn with_emulator(words: &str, script: &str) -> tempfile::TempDir {
    let folder = folder();
    let place = |name: &str| folder.path().join(name);
    for name in ["bin", "tmp"] {
        fs::create_dir(place(name)).expect("a folder");
    }
    fs::write(place("m.toml"), GOOD).expect("a file");
    let mut elf = b"\x7fELF".to_vec();
    elf.resize(18, 0);
    elf.extend([40, 0]); // for an Arm
    fs::write(place("firmware"), elf).expect("a file");
    let emulator = place("bin/qemu-system-arm");
    fs::write(&emulator, format!("#!/bin/sh\nwords={words}\n{SPEAK}\n{script}\n")).expect("a file");
    fs::set_permissions(&emulator, fs::Permissions::from_mode(0o755)).expect("a mode");
    folder
}

/// Writes its words to where the log is to go.
const SPEAK: &str =
    r#"for each; do case "$each" in file:*) printf "$words" >"${each#file:}";; esac; done"#;

fn fly(folder: &Path, more: &[&str]) -> Child {
    let path = std::env::var("PATH").unwrap_or_default();
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-sim"));
    command
        .args(["hil", "m.toml", "--emulator=firmware", "--log", "log", "--trace", "t.jsonl"])
        .args(more)
        .env("PATH", format!("{}:{path}", folder.join("bin").display()))
        .env("TMPDIR", folder.join("tmp"));
    start(&mut command, folder)
}

#[test]
fn an_interrupted_emulator_is_no_orphan() {
    for (name, number) in SIGNALS.into_iter().filter(|(_, number)| reaches(*number)) {
        let folder = with_emulator("one", "echo $$ >started; mv started id; exec sleep 600");
        let id = || fs::read_to_string(folder.path().join("id"));
        let hil = fly(folder.path(), &[]);
        wait_until("the emulator runs", || id().is_ok());
        signal(&hil, name);
        assert_eq!(status(hil), Some(128 + number), "{name}");
        let id = id().expect("its id");
        assert!(!kill(&format!("-0 {}", id.trim())), "{name}: the emulator still runs");
        assert_eq!(names(folder.path()), ["bin", "firmware", "id", "m.toml", "tmp"], "{name}");
        assert_eq!(names(&folder.path().join("tmp")), [""; 0], "{name}");
    }
}

/// Steps that were flown before stay, without a line that is not whole, and the message says where.
#[test]
fn an_interrupted_mission_leaves_its_steps() {
    if !reaches(15) {
        return;
    }
    let folder = with_emulator("one", "echo $$ >started; mv started id; exec sleep 600");
    let run = host_sim(folder.path(), &["run", "m.toml", "--trace", "whole"]);
    assert_eq!(status(run), Some(0));
    let whole = fs::read_to_string(folder.path().join("whole")).expect("a trace");
    let at = whole.match_indices('\n').nth(4).expect("a step").0 + 1;
    fs::write(folder.path().join("t.jsonl.partial"), &whole[..at + 30]).expect("a file");
    let hil = fly(folder.path(), &["--resume"]);
    wait_until("the emulator runs", || folder.path().join("id").exists());
    signal(&hil, "TERM");
    let output = hil.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(128 + 15));
    let message = text(&output.stderr);
    assert!(
        message.contains("steps are in t.jsonl.partial") && message.contains("--resume"),
        "{message}"
    );
    let kept = fs::read_to_string(folder.path().join("t.jsonl.partial")).expect("it stays");
    assert_eq!(kept, whole[..at]);
}

#[test]
fn a_failed_mission_keeps_what_the_board_said_or_an_older_log() {
    for (words, kept) in [("one", "one"), ("", "old")] {
        let folder = with_emulator(words, "echo it burns >&2; exit 3");
        fs::write(folder.path().join("log"), "old").expect("a file");
        let output = fly(folder.path(), &[]).wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(2));
        let message = text(&output.stderr);
        assert!(message.contains("qemu-system-arm") && message.contains("it burns"), "{message}");
        assert_eq!(fs::read_to_string(folder.path().join("log")).expect("a log"), kept);
        assert_eq!(names(folder.path()), ["bin", "firmware", "log", "m.toml", "tmp"]);
        assert_eq!(names(&folder.path().join("tmp")), [""; 0]);
    }
}
