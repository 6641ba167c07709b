//! Campaigns that are killed can be continued. The output equals that of an uninterrupted campaign.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::{folder, host_sim, names, prints, text, wait_until};

const ROWS: &str = "c.csv";
const PARTIAL: &str = "c.csv.partial";
const RECORD: &str = "c.csv.partial.json";

fn args(flags: &str) -> Vec<&str> {
    ["campaign", "--csv", ROWS].into_iter().chain(flags.split_whitespace()).collect()
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// A campaign that has some rows.
fn with_rows(folder: &Path, flags: &str) -> Child {
    let child = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(args(flags))
        .current_dir(folder)
        .stdout(Stdio::null())
        .spawn()
        .expect("it starts");
    let length = || fs::metadata(folder.join(PARTIAL)).map_or(0, |found| found.len());
    wait_until("it has rows", || length() > 2_000);
    child
}

/// Kills it by a signal that no program can handle.
fn kill(mut child: Child) {
    child.kill().expect("it still runs");
    assert!(!child.wait().expect("it ends").success(), "it ended by itself before it was killed");
}

/// A campaign that was killed, or whose rows end at any byte, can be continued. It then has the files and the table of
/// one that was not stopped.
#[test]
fn a_campaign_goes_on() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for flags in [
        "--fields 1500",
        "--fields 600 --compare random,cfc",
        "--fields 500 --steps 8 --every --algorithm random --p 0.8",
        "--fields 250 --steps 11 --compare random,scc",
        "--fields 1600 --shard 2/2",
    ] {
        let [whole, folder] = [folder(), folder()];
        let table = prints(whole.path(), &args(flags));
        let rows = read(whole.path(), ROWS);
        kill(with_rows(folder.path(), flags));
        let record = read(folder.path(), RECORD);
        let resume = |case: &str| {
            let flags = format!("{flags} --resume");
            assert_eq!(prints(folder.path(), &args(&flags)), table, "{flags}: {case}");
            assert_eq!(names(folder.path()), names(whole.path()), "{flags}: {case}");
            for name in names(whole.path()) {
                let is_same = read(folder.path(), &name) == read(whole.path(), &name);
                assert!(is_same, "{flags}: {case}: another {name}");
                fs::remove_file(folder.path().join(name)).expect("a file");
            }
        };
        resume("killed");
        let mut ends = vec![rng.random_range(0..rows.len())];
        if flags == "--fields 1500" {
            ends.extend([0, 10, rows.len() - 1, rows.len()]);
        }
        let mut cases: Vec<_> = ends.into_iter().map(|bytes| rows[..bytes].to_vec()).collect();
        // After a loss of power a file may end with zeros that nobody wrote.
        cases.push([&rows[..rows.len() / 2], &[0; 600]].concat());
        for partial in cases {
            fs::write(folder.path().join(PARTIAL), &partial).expect("a file");
            fs::write(folder.path().join(RECORD), &record).expect("a file");
            resume(&format!("{} bytes", partial.len()));
        }
    }
}

/// Rows of a second program would stand between those of the first.
#[test]
fn two_programs_do_not_write_one_file() {
    let folder = folder();
    let first = with_rows(folder.path(), "--fields 10000000");
    let second = host_sim(folder.path(), &args("--fields 10000000 --resume"));
    kill(first);
    assert_eq!(second.status.code(), Some(2));
    assert!(text(&second.stderr).contains("another program"), "{}", text(&second.stderr));
}
