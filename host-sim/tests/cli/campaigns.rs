//! `campaign`.

use std::fs;

use crate::{GOOD, folder, prints};

#[test]
fn a_campaign_prints_tables_and_writes_rows() {
    let folder = folder();
    let args = ["campaign", "--fields", "20", "--steps", "12", "--csv", "c.csv"];
    let table = prints(folder.path(), &args);
    for part in
        ["20 standard fields, seed 1", "bits/step", "Ended by: steps 20", "Actions examined"]
    {
        assert!(table.contains(part), "{part}: {table}");
    }
    let rows = fs::read_to_string(folder.path().join("c.csv")).expect("rows");
    assert_eq!(rows.lines().count(), 1 + 20 * 5, "marks at 1, 2, 5, 10 and 12");
    let json = prints(
        folder.path(),
        &["campaign", "--fields", "5", "--algorithm", "random", "--format", "json"],
    );
    let summary: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!((&summary["fields"], &summary["algorithm"]), (&5.into(), &"random".into()));
}

/// The flag and the scenario's key choose the action set: more actions, and turns that are no multiples of
/// 10 mrad.
#[test]
fn the_fan_can_be_fine() {
    let folder = folder();
    let args = ["campaign", "--fields", "3", "--format", "json", "--fan"];
    for (fan, actions) in [("paper", 6_657), ("fine", 65_973_495)] {
        let summary = prints(folder.path(), &[&args[..], &[fan]].concat());
        let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
        assert_eq!(summary["actions"], actions);
    }
    let steps = |text: &str| {
        fs::write(folder.path().join("m.toml"), text).expect("a file");
        let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
        let records = trace.lines().map(|it| serde_json::from_str(it).expect("JSON"));
        let records: Vec<serde_json::Value> = records.collect();
        let index = records.iter().filter_map(|it| it["action"]["index"].as_u64()).max();
        (trace, index.expect("a step"))
    };
    let (trace, index) = steps(GOOD);
    assert_eq!(steps(&format!("fan = \"paper\"\n{GOOD}")), (trace, index));
    assert!(index < 6_657 && steps(&format!("fan = \"fine\"\n{GOOD}")).1 > 6_657);
}

#[test]
fn of_labels_that_tell_nothing_there_is_no_share() {
    let folder = folder();
    let coin = ["campaign", "--fields", "2", "--steps", "5", "--algorithm", "scc", "--p", "0.5"];
    let table = prints(folder.path(), &coin);
    let row = table.lines().find(|line| line.trim_start().starts_with("5 ")).expect("a row");
    assert_eq!(row.split_whitespace().nth(4), Some("-"), "{table}");
    assert!(!table.contains("inf") && !table.contains("NaN"), "{table}");
    let record = prints(folder.path(), &[&coin[..], &["--format", "json"]].concat());
    let record: serde_json::Value = serde_json::from_str(&record).expect("JSON");
    assert_eq!(record["limit"], 0.0);
    // Where labels tell something it is as it was.
    let table = prints(folder.path(), &[&coin[..8], &["0.9"]].concat());
    let row = table.lines().find(|line| line.trim_start().starts_with("5 ")).expect("a row");
    assert!(row.split_whitespace().nth(4).is_some_and(|share| share.ends_with('%')), "{table}");
}
