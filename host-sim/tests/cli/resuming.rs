//! Campaigns and missions of a board that were stopped continue where they were. The output equals that of an
//! uninterrupted run.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{GOOD, folder, host_sim, prints, refuses, text};

const ROWS: &str = "c.csv";
const PARTIAL: &str = "c.csv.partial";
const RECORD: &str = "c.csv.partial.json";

fn campaign<'a>(flags: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [&["campaign", "--csv", ROWS], flags, more].concat()
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Starts a campaign and kills it when it has some rows: nothing can be done about that signal.
fn kill_early(folder: &Path, args: &[&str]) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(args)
        .current_dir(folder)
        .stdout(Stdio::null())
        .spawn()
        .expect("it starts");
    let until = Instant::now() + Duration::from_mins(1);
    while fs::metadata(folder.join(PARTIAL)).map_or(0, |found| found.len()) < 2_000 {
        assert!(Instant::now() < until, "waited in vain for rows");
        thread::sleep(Duration::from_millis(1));
    }
    child.kill().expect("it still runs");
    assert!(!child.wait().expect("it ends").success(), "it ended by itself before it was killed");
    assert!(!folder.join(ROWS).exists(), "{ROWS} is not whole");
}

/// A campaign that was killed, or whose rows end at any byte, can be continued. It then gives the rows, the table and
/// the record of one that was not stopped.
fn goes_on(flags: &[&str]) {
    let whole = folder();
    let table = prints(whole.path(), &campaign(flags, &[]));
    let rows = read(whole.path(), ROWS);
    let folder = folder();
    kill_early(folder.path(), &campaign(flags, &[]));
    let record = read(folder.path(), RECORD);
    let resume = |case: &str| {
        assert_eq!(prints(folder.path(), &campaign(flags, &["--resume"])), table, "{case}");
        assert!(read(folder.path(), ROWS) == rows, "{flags:?}: {case}: other rows");
        let left = fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 1, "{flags:?}: {case}: something stays beside the rows");
        fs::remove_file(folder.path().join(ROWS)).expect("rows");
    };
    resume("killed");
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let anywhere = (0..3).map(|_| rng.random_range(0..rows.len()));
    for bytes in anywhere.chain([0, 10, rows.len() - 1, rows.len()]) {
        fs::write(folder.path().join(PARTIAL), &rows[..bytes]).expect("a file");
        fs::write(folder.path().join(RECORD), &record).expect("a file");
        resume(&format!("{bytes} bytes"));
    }
    // After a loss of power a file may end with what never was written.
    let lost = [&rows[..rows.len() / 2], &[0; 600]].concat();
    fs::write(folder.path().join(PARTIAL), lost).expect("a file");
    fs::write(folder.path().join(RECORD), &record).expect("a file");
    resume("zeros at the end");
}

#[test]
fn a_campaign_goes_on() {
    goes_on(&["--fields", "1500"]);
}

#[test]
fn a_comparison_goes_on() {
    goes_on(&["--fields", "600", "--compare", "random,cfc"]);
}

#[test]
fn a_campaign_in_noise_goes_on() {
    goes_on(&["--fields", "500", "--steps", "8", "--every", "--algorithm", "random", "--p", "0.8"]);
}

#[test]
fn a_comparison_in_noise_goes_on() {
    goes_on(&["--fields", "250", "--steps", "11", "--compare", "random,scc"]);
}

#[test]
fn a_shard_goes_on() {
    let flags = ["--fields", "1600", "--shard", "2/2"];
    let [whole, folder] = [folder(), folder()];
    let table = prints(whole.path(), &campaign(&flags, &[]));
    kill_early(folder.path(), &campaign(&flags, &[]));
    assert_eq!(prints(folder.path(), &campaign(&flags, &["--resume"])), table);
    for name in [ROWS, "c.csv.json"] {
        assert!(read(folder.path(), name) == read(whole.path(), name), "{name}");
    }
}

#[test]
fn what_was_never_begun_begins() {
    let folder = folder();
    let table = prints(folder.path(), &campaign(&["--fields", "5"], &["--resume"]));
    assert_eq!(table, prints(folder.path(), &campaign(&["--fields", "5"], &[])));
}

/// Nobody's rows are lost, and none are gone on with that are another campaign's: what differs is named.
#[test]
fn the_rows_of_another_campaign_are_refused() {
    let folder = folder();
    let flags = ["--fields", "1500", "--steps", "10", "--fan", "fine"];
    kill_early(folder.path(), &campaign(&flags, &[]));
    let kept = [PARTIAL, RECORD].map(|name| read(folder.path(), name));
    refuses(folder.path(), &campaign(&flags, &[]), &[PARTIAL, "--resume", "removed"]);
    let cases: [(&[&str], &[&str]); 11] = [
        (
            &["--fields", "1501", "--steps", "10", "--fan", "fine"],
            &["--fields 1500", "expected --fields 1501"],
        ),
        (
            &["--fields", "1500", "--steps", "11", "--fan", "fine"],
            &["--steps 10", "expected --steps 11"],
        ),
        (&["--fields", "1500", "--steps", "10"], &["--fan fine", "expected no --fan"]),
        (&[&flags[..], &["--every"]].concat(), &["no --every", "expected --every"]),
        (&[&flags[..], &["--seed", "2"]].concat(), &["--seed 1", "expected --seed 2"]),
        (&[&flags[..], &["--algorithm", "lookahead"]].concat(), &["--algorithm cfc", "lookahead"]),
        (
            &[&flags[..], &["--compare", "cfc,lookahead"]].concat(),
            &["no --compare", "--compare cfc,lookahead"],
        ),
        (&[&flags[..], &["--reach", "1"]].concat(), &["no --reach", "expected --reach 1"]),
        (
            &[&flags[..], &["--speed-step", "0.2"]].concat(),
            &["no --speed-step", "--speed-step 0.2"],
        ),
        (&[&flags[..], &["--tolerance", "0.01"]].concat(), &["no --tolerance", "--tolerance 0.01"]),
        (&[&flags[..], &["--shard", "1/2"]].concat(), &["--shard 1/1", "expected 1/2"]),
    ];
    for (flags, parts) in cases {
        refuses(folder.path(), &campaign(flags, &["--resume"]), &[&[PARTIAL], parts].concat());
    }
    assert_eq!([PARTIAL, RECORD].map(|name| read(folder.path(), name)), kept);
    let edit = |from: &str, to: &str| {
        let record = String::from_utf8(kept[1].clone()).expect("text");
        assert!(record.contains(from), "{record}");
        fs::write(folder.path().join(RECORD), record.replace(from, to)).expect("a file");
    };
    let resume = campaign(&flags, &["--resume"]);
    edit(r#""version":""#, r#""version":"0."#);
    refuses(folder.path(), &resume, &[PARTIAL, "of version 0."]);
    edit(r#""seed":1"#, r#""sow":1"#);
    refuses(folder.path(), &resume, &[PARTIAL, "its record", "sow", "remove"]);
    fs::remove_file(folder.path().join(RECORD)).expect("a file");
    refuses(folder.path(), &resume, &[RECORD, "remove c.csv.partial to begin anew"]);
    fs::write(folder.path().join(RECORD), &kept[1]).expect("a file");
    fs::write(folder.path().join(PARTIAL), [b"algorithm,", &kept[0][..]].concat()).expect("a file");
    refuses(folder.path(), &resume, &[PARTIAL, "found lines 1 to", "checksum", "remove"]);
}

#[test]
fn what_cannot_be_gone_on_with_is_refused() {
    let folder = folder();
    let needs_file = ["campaign", "--fields", "2", "--resume"];
    refuses(folder.path(), &needs_file, &["--csv"]);
    for flag in [&["--resume"][..], &["--shard", "1/2"]] {
        let args = [&["campaign", "--fields", "2", "--csv", "/dev/null"], flag].concat();
        refuses(folder.path(), &args, &["/dev/null", "a stream", "a file with", flag[0]]);
    }
}

/// Rows of a second program would stand between those of the first.
#[test]
fn two_programs_do_not_write_one_file() {
    let folder = folder();
    let args = campaign(&["--fields", "10000000"], &[]);
    let mut first = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(&args)
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .expect("it starts");
    while fs::metadata(folder.path().join(PARTIAL)).map_or(0, |found| found.len()) < 2_000 {
        thread::sleep(Duration::from_millis(1));
    }
    let second = host_sim(folder.path(), &campaign(&["--fields", "10000000"], &["--resume"]));
    first.kill().expect("it runs");
    first.wait().expect("it ends");
    assert_eq!(second.status.code(), Some(2));
    assert!(text(&second.stderr).contains("another program"), "{}", text(&second.stderr));
}

/// A folder with a scenario, what passes for no firmware, and the trace of the scenario's mission with these flags.
fn with_trace(flags: &[&str]) -> (tempfile::TempDir, String) {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    prints(folder.path(), &[&["run", "m.toml", "--trace", "whole"], flags].concat());
    let trace = String::from_utf8(read(folder.path(), "whole")).expect("text");
    (folder, trace)
}

/// Steps of another mission, or what are none, are refused by the line and the key that differs, and stay as they are.
#[test]
fn the_steps_of_another_mission_are_refused() {
    const HIL: [&str; 6] = ["hil", "m.toml", "--emulator=m.toml", "--trace", "t.jsonl", "--resume"];
    let (folder, trace) = with_trace(&[]);
    let (_, other) = with_trace(&["--seed", "2"]);
    let mut lines: Vec<_> = trace.lines().collect();
    let steps = lines.len() - 2;
    let label = if lines[3].contains("\"label\":-1") { ["-1", "1"] } else { ["1", "-1"] };
    let [from, to] = label.map(|label| format!("\"label\":{label},"));
    let wrong = lines[3].replace(&from, &to);
    let with = |at: usize, line: &str| {
        let mut lines = lines.clone();
        lines[at] = line;
        lines.join("\n") + "\n"
    };
    let torn_start = format!("{}\n", &lines[0][..40]);
    let zeros = "\0".repeat(5_000);
    let cases: [(String, &[&str], &[&str]); 11] = [
        (other, &[], &[":1: found seed 2, expected 1"]),
        ("\0".repeat(500), &[], &["found something else than", "remove"]),
        (zeros.clone(), &[], &[":1: found", "start of this mission's trace", "remove"]),
        (zeros + "\n" + &trace, &[], &[":1: found", "start of this mission's trace", "remove"]),
        (torn_start + &lines[1..].join("\n") + "\n", &[], &[":1: found", "remove"]),
        (format!("{}{}", "x".repeat(1_000_000), &trace), &[], &[":1: found", "remove"]),
        (with(3, &wrong), &[], &[":4: found label", &format!("expected {}", label[0])]),
        (with(2, "{}"), &[], &[":3: expected a step"]),
        (with(2, "?"), &[], &[":3: expected a step"]),
        (trace.clone(), &["--steps", "3"], &[":5: expected no more than 3 steps"]),
        ("notes\n".to_owned(), &[], &["something else than steps"]),
    ];
    for (content, flags, parts) in cases {
        let partial = folder.path().join("t.jsonl.partial");
        fs::write(&partial, &content).expect("a file");
        let parts = [&["t.jsonl.partial"], parts].concat();
        refuses(folder.path(), &[&HIL[..], flags].concat(), &parts);
        assert_eq!(fs::read_to_string(&partial).expect("it stays"), content);
    }
    // What is not whole is made again; then comes the firmware, which this is not.
    lines.truncate(5);
    let cut = lines.join("\n") + "\n" + &trace.lines().nth(5).expect("a step")[..20];
    fs::write(folder.path().join("t.jsonl.partial"), cut).expect("a file");
    refuses(folder.path(), &HIL, &["m.toml", "firmware's ELF"]);
    assert_eq!(read(folder.path(), "t.jsonl.partial"), (lines.join("\n") + "\n").into_bytes());
    assert!(steps > 5);
    // A start that is not whole is written anew, as is one that a loss of power left without its end.
    for bytes in [0, 1, lines[0].len() - 1, lines[0].len()] {
        fs::write(folder.path().join("t.jsonl.partial"), &trace[..bytes]).expect("a file");
        refuses(folder.path(), &HIL, &["m.toml", "firmware's ELF"]);
        let kept = read(folder.path(), "t.jsonl.partial");
        assert_eq!(text(&kept), format!("{}\n", lines[0]), "{bytes}");
    }
    // What is no text ends the steps only where it has no end of its own.
    for (tail, is_torn) in [(&b"\xff\xfe"[..], true), (b"\xff\xfe\n", false)] {
        let partial = [lines[..3].join("\n").as_bytes(), b"\n", tail].concat();
        fs::write(folder.path().join("t.jsonl.partial"), partial).expect("a file");
        let parts = if is_torn { ["m.toml", "ELF"] } else { ["t.jsonl.partial:4", "a step"] };
        refuses(folder.path(), &HIL, &parts);
    }
}

#[test]
fn a_mission_that_cannot_be_gone_on_with_is_refused() {
    let (folder, _) = with_trace(&[]);
    let hil = ["hil", "m.toml", "--emulator=m.toml", "--resume", "--trace"];
    refuses(folder.path(), &[&hil[..], &["/dev/null"]].concat(), &["/dev/null", "a stream"]);
    refuses(folder.path(), &[&hil[..], &["m.toml"]].concat(), &["m.toml", "the scenario"]);
    // Nothing was flown, so nothing stays.
    refuses(folder.path(), &[&hil[..], &["t.jsonl"]].concat(), &["firmware's ELF"]);
}
