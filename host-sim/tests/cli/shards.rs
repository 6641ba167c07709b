//! Campaigns in shards: together they are the whole.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::{folder, prints, refuses};

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Flies the shards of a campaign, `s1.csv` and so on.
fn fly_shards(folder: &Path, flags: &[&str], of: usize) {
    for number in 1..=of {
        let (shard, csv) = (format!("{number}/{of}"), format!("s{number}.csv"));
        let args = [&["campaign", "--shard", &shard, "--csv", &csv], flags].concat();
        let told = prints(folder, &args);
        assert!(told.starts_with(&format!("Shard {shard}: fields ")), "{told}");
    }
}

const FOUR: [&str; 4] = ["s3.csv", "s1.csv", "s4.csv", "s2.csv"];

/// Rows, table and record of the whole come from its shards.
fn is_its_shards(flags: &[&str]) {
    let folder = folder();
    let whole = |more: &[&str]| prints(folder.path(), &[&["campaign"], flags, more].concat());
    let (table, record) = (whole(&["--csv", "w.csv"]), whole(&["--format", "json"]));
    fly_shards(folder.path(), flags, 4);
    let merge =
        |more: &[&str]| prints(folder.path(), &[&["campaign", "merge"], &FOUR[..], more].concat());
    assert_eq!(merge(&["--csv", "m.csv"]), table, "{flags:?}");
    assert_eq!(merge(&["--format", "json"]), record, "{flags:?}");
    assert!(read(folder.path(), "m.csv") == read(folder.path(), "w.csv"), "{flags:?}");
}

#[test]
fn a_campaign_is_its_shards() {
    is_its_shards(&["--fields", "101"]);
    is_its_shards(&["--fields", "4", "--steps", "3", "--every", "--seed", "7"]);
}

#[test]
fn a_comparison_is_its_shards() {
    is_its_shards(&[
        "--fields",
        "50",
        "--compare",
        "random,lookahead,cfc",
        "--position-error",
        "0.05",
    ]);
}

#[test]
fn a_campaign_in_noise_is_its_shards() {
    is_its_shards(&["--fields", "41", "--steps", "12", "--algorithm", "scc"]);
    is_its_shards(&[
        "--fields",
        "30",
        "--steps",
        "6",
        "--compare",
        "random,margin",
        "--p",
        "0.9",
        "--every",
    ]);
}

#[test]
fn what_is_no_shard_is_refused() {
    let folder = folder();
    for shard in ["0/4", "5/4", "4", "a/b", "1/0", "-1/2"] {
        let shard = format!("--shard={shard}");
        let args = ["campaign", "--fields", "9", "--csv", "c.csv", &shard];
        refuses(folder.path(), &args, &["--shard", "2/4"]);
    }
    let args = ["campaign", "--fields", "3", "--csv", "c.csv", "--shard", "1/4"];
    refuses(folder.path(), &args, &["--shard", "1/4 of 3 fields"]);
    refuses(folder.path(), &["campaign", "--shard", "1/2"], &["--csv"]);
    refuses(folder.path(), &["campaign", "merge"], &["SHARD.csv"]);
}

#[test]
fn shards_that_do_not_make_a_whole_are_refused() {
    let folder = folder();
    let flags = ["--fields", "12", "--steps", "5"];
    fly_shards(folder.path(), &flags, 4);
    let fly = |csv: &str, more: &[&str]| {
        let args = [&["campaign", "--steps", "5", "--csv", csv], more].concat();
        prints(folder.path(), &args);
    };
    fly("seed.csv", &["--fields", "12", "--shard", "2/4", "--seed", "2"]);
    fly("thirds.csv", &["--fields", "12", "--shard", "2/3"]);
    fly("whole.csv", &["--fields", "12"]);
    let refuse = |shards: &[&str], parts: &[&str]| {
        let args = [&["campaign", "merge"], shards, &["--csv", "m.csv"]].concat();
        refuses(folder.path(), &args, parts);
    };
    refuse(&["s1.csv", "s2.csv", "s4.csv"], &["no shard 3/4"]);
    refuse(&["s1.csv", "s2.csv", "s3.csv"], &["no shard 4/4"]);
    refuse(&["s1.csv", "s2.csv", "s2.csv", "s3.csv", "s4.csv"], &["s2.csv", "2/4 twice"]);
    refuse(
        &["s1.csv", "seed.csv", "s3.csv", "s4.csv"],
        &["seed.csv", "--seed 2", "expected --seed 1"],
    );
    refuse(&["s1.csv", "thirds.csv"], &["thirds.csv", "shard 2/3", "one of 4"]);
    refuse(&["whole.csv"], &["whole.csv.json", "the record of whole.csv"]);
    refuse(&["none.csv"], &["none.csv.json"]);
    let args = ["campaign", "merge", "s1.csv", "s2.csv", "s3.csv", "s4.csv", "--csv", "s2.csv"];
    refuses(folder.path(), &args, &["s2.csv", "a shard", "--csv"]);
    let spoil = |name: &str, from: &str, to: &str| {
        let good = read(folder.path(), name);
        assert!(good.contains(from), "{good}");
        fs::write(folder.path().join(name), good.replacen(from, to, 1)).expect("a file");
        good
    };
    for (name, from, to, parts) in [
        ("s2.csv", "\n", "\n\n", &["s2.csv: found", "bytes", "s2.csv.json"][..]),
        ("s2.csv", ",steps,", ",step,s", &["s2.csv: found", "checksum"]),
        ("s2.csv", "\n4,", "\n3,", &["s2.csv: found", "checksum"]),
        ("s2.csv", "field,step", "field,stop", &["s2.csv: found", "checksum"]),
        ("s2.csv.json", "{", "[", &["s2.csv.json", "the record of a campaign"]),
        ("s2.csv.json", r#""steps":5"#, r#""steps":99"#, &["--steps 99", "--steps 5"]),
    ] {
        let good = spoil(name, from, to);
        refuse(&FOUR, parts);
        fs::write(folder.path().join(name), good).expect("a file");
    }
    prints(folder.path(), &[&["campaign", "merge"], &FOUR[..]].concat());
}

/// The recipe of docs/campaigns.md, as it stands there.
#[test]
fn gnu_parallel_flies_shards() {
    let recipes = include_str!("../../../docs/campaigns.md");
    let recipe = recipes.split("```").find(|it| it.contains("parallel ")).expect("a recipe");
    let recipe = recipe.trim_start_matches("sh\n");
    let has = |program: &str| {
        let found = Command::new("sh").args(["-c", &format!("{program} --version")]).output();
        found.is_ok_and(|it| String::from_utf8_lossy(&it.stdout).contains("GNU parallel"))
    };
    if !has("parallel") {
        assert!(std::env::var_os("CI").is_none(), "CI has no GNU parallel");
        println!("skipped: GNU parallel is not installed");
        return;
    }
    let folder = folder();
    // The recipe's campaign is large; the test's is the same with fewer fields.
    let script = recipe.replace("--fields 1000000", "--fields 50");
    assert_ne!(script, recipe, "{recipe}");
    let program = Path::new(env!("CARGO_BIN_EXE_host-sim"));
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().expect("a folder").display());
    let shell = Command::new("sh")
        .args(["-ec", &script])
        .env("PATH", path)
        .env("HOME", folder.path())
        .current_dir(folder.path())
        .output()
        .expect("a shell");
    assert!(shell.status.success(), "{}", String::from_utf8_lossy(&shell.stderr));
    prints(folder.path(), &["campaign", "--fields", "50", "--steps", "20", "--csv", "w.csv"]);
    assert!(read(folder.path(), "whole.csv") == read(folder.path(), "w.csv"));
}
