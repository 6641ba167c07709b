//! `campaign`.

use std::fs;

use crate::{folder, prints};

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
