//! `campaign --fronts`.

use serde_json::Value;

use crate::{folder, prints, refuses};

const QUICK: [&str; 4] = ["campaign", "--fronts", "--fields", "2"];

fn record(flags: &[&str]) -> Value {
    let args = [&QUICK, flags, &["--format", "json"]].concat();
    serde_json::from_str(&prints(folder().path(), &args)).expect("JSON")
}

/// The records of single campaigns are those of a comparison, and its table has their figures.
#[test]
fn planners_are_compared_on_the_same_fronts() {
    let names = ["track", "zigzag", "bang-bang"];
    let all = record(&["--compare", &names.join(","), "--seed", "3"]);
    for (k, name) in names.iter().enumerate() {
        let single = record(&["--algorithm", name, "--seed", "3"]);
        assert_eq!(all[k], single);
        assert_eq!((&single["algorithm"], &single["missions"]), (&Value::from(*name), &2.into()));
        let rows = single["rows"].as_array().expect("rows");
        assert_eq!(rows.len(), 12, "six kinds of fronts, with p = 1 and 0.9");
        assert!(rows.iter().all(|row| row["covers"].is_null() == (*name != "track")));
    }
    let list = names.join(",");
    let args = [&QUICK[..], &["--compare", &list, "--seed", "3"]].concat();
    let table = prints(folder().path(), &args);
    let off = format!("{:.3}", all[1]["rows"][0]["off_median"].as_f64().expect("a number"));
    let row = table.lines().find(|line| line.trim_start().starts_with("zigzag")).expect("a row");
    assert_eq!(row.split_whitespace().nth(1), Some(&*off), "{table}");
    assert!(table.starts_with("2 missions of 400 m for each kind of front, seed 3"), "{table}");
}

/// By default the tracker flies, as often as the table of the notes says.
#[test]
fn flags_choose_labels_motions_and_what_the_tracker_is_told() {
    let usual = record(&[]);
    assert_eq!((&usual["algorithm"], &usual["reach"]), (&"track".into(), &2.0.into()));
    let rows = |record: &Value| record["rows"].as_array().expect("rows").clone();
    let noisy = record(&["--p", "0.9"]);
    let of_noisy: Vec<_> = rows(&usual).into_iter().filter(|row| row["p"] == 0.9).collect();
    assert_eq!(rows(&noisy), of_noisy);
    let short = record(&["--p", "0.9", "--reach", "1"]);
    assert!(rows(&short).iter().all(|row| row["labels"].as_f64() > Some(300.0)), "{short}");
    for flag in ["--told-radius", "--told-speed"] {
        assert_eq!(record(&["--p", "0.9", flag, "1"]), noisy);
        let told = record(&["--p", "0.9", flag, "0.5"]);
        assert_eq!(told[flag.trim_start_matches('-').replace('-', "_")], 0.5);
        let moving = |of: &Value| rows(of)[5].clone();
        assert_ne!(moving(&told), moving(&noisy), "{flag}");
        // The others stand still.
        assert_eq!(rows(&told)[..5] == rows(&noisy)[..5], flag == "--told-speed");
    }
}

#[test]
fn flags_without_a_meaning_are_refused_by_name() {
    let folder = folder();
    let lone = ["--every", "--resume", "--from-nothing"];
    let others = [
        ("--steps", "3"),
        ("--readings", "2"),
        ("--fan", "fine"),
        ("--vehicle", "car"),
        ("--speed-step", "0.1"),
        ("--sharpest", "1"),
        ("--turn-step", "0.1"),
        ("--radius", "3"),
        ("--shortest", "1"),
        ("--crossing", "anyhow"),
        ("--following", "anyhow"),
        ("--p-prior", "8,2"),
        ("--true-p", "0.8"),
        ("--trusted-radius", "1"),
        ("--position-error", "0.1"),
        ("--motion-error", "0.1"),
        ("--tolerance", "0.1"),
        ("--bend", "1"),
        ("--drift", "1"),
        ("--area", "30,30"),
        ("--price", "4"),
        ("--seek", "bits"),
        ("--worth", "0.1"),
        ("--labels", "9"),
        ("--policy", "joint"),
        ("--prior", "area"),
        ("--csv", "c.csv"),
        ("--shard", "1/2"),
        ("--fields-csv", "f.csv"),
        ("--figure", "f.svg"),
    ];
    let flags = lone.iter().map(|it| vec![*it]).chain(others.iter().map(|it| vec![it.0, it.1]));
    for flag in flags {
        let args = [&QUICK[..], &flag, if flag[0] == "--resume" { &["--csv", "c"] } else { &[] }];
        refuses(folder.path(), &args.concat(), &["--fronts"]);
        if flag[0] != "--resume" && flag[0] != "--shard" {
            refuses(folder.path(), &args.concat(), &[flag[0]]);
        }
    }
    // No flag of `campaign` is left out here, nor taken without a word.
    let help = prints(folder.path(), &["campaign", "--help"]);
    let taken = [
        "--fields",
        "--seed",
        "--algorithm",
        "--compare",
        "--p",
        "--reach",
        "--format",
        "--fronts",
        "--told-radius",
        "--told-speed",
        "--quiet",
        "--verbose",
        "--help",
    ];
    for line in help.lines().map(str::trim_start).filter(|it| it.starts_with('-')) {
        let Some(flag) = line.split([' ', ',']).find(|it| it.starts_with("--")) else { continue };
        let is_known =
            others.iter().any(|it| it.0 == flag) || [&lone[..], &taken].concat().contains(&flag);
        assert!(is_known, "{flag}: refuse it with --fronts, or give it a meaning");
    }
}

#[test]
fn what_cannot_be_flown_is_refused() {
    let folder = folder();
    let cases: [(&[&str], &[&str]); 12] = [
        (&["--fronts", "--algorithm", "cfc"], &["--algorithm: found cfc", "zigzag or bang-bang"]),
        (&["--fronts", "--compare", "track,random"], &["--compare: found random", "--fronts"]),
        (&["--fronts", "--compare", "track,track"], &["--compare: found track twice", "once"]),
        (&["--algorithm", "track"], &["--algorithm: found track", "--fronts"]),
        (&["--compare", "cfc,zigzag"], &["--compare: found zigzag", "--fronts"]),
        (&["--told-speed", "2"], &["--fronts", "--told-speed"]),
        (&["--fronts", "--algorithm", "zigzag", "--told-speed", "2"], &["--told-speed", "zigzag"]),
        (&["--fronts", "--told-radius", "0"], &["--told-radius: found 0", "factor", "radius"]),
        (&["--fronts", "--told-speed", "-1"], &["--told-speed: found -1", "factor", "speed"]),
        (&["--fronts", "--p", "2"], &["--p: found 2", "[0, 1]"]),
        (&["--fronts", "--reach", "0.25"], &["--reach: found 0.25", "0.1 to 2 m"]),
        (&["--fronts", "--fields", "10001"], &["--fields: found 10001", "at most 10000"]),
    ];
    for (flags, parts) in cases {
        refuses(folder.path(), &[&["campaign"], flags].concat(), parts);
    }
}
