//! `size`: the flash, RAM and time of a planner on a chip, from the committed measurements.

use crate::{folder, prints, refuses};

#[test]
fn it_says_what_was_measured() {
    let text = prints(folder().path(), &["size", "--samples", "16"]);
    for part in
        ["at most what `small` takes", "flash, RISC-V RV32IMAC", "instructions in the median"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    // As much at half the clock takes twice as long.
    let ms = |mhz: &str| {
        let json = prints(
            folder().path(),
            &["size", "--hypotheses", "529", "--mhz", mhz, "--format", "json"],
        );
        let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        assert_eq!(value[1]["program"], "standard");
        value[1]["calls"][0]["worst_ms"].as_f64().expect("a plan")
    };
    assert!((ms("84") / ms("168") - 2.0).abs() < 1e-9);
}

#[test]
fn it_knows_the_follower_of_fronts() {
    let text = prints(folder().path(), &["size", "--algorithm", "track", "--cells", "12,12,3"]);
    for part in
        ["12 x 12 x 3 cells", "`track`", "room for 16 x 16 x 3 cells", "the tracker as asked"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("samples"), "{text}");
    let json = prints(folder().path(), &["size", "--algorithm", "track", "--format", "json"]);
    let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(value[0]["cells"], serde_json::json!([16, 16, 3]));
    assert_eq!(value[1]["calls"].as_array().map(Vec::len), Some(3));
    let refuses = |flags: &[&str], parts: &[&str]| {
        refuses(folder().path(), &[&["size"], flags].concat(), parts);
    };
    refuses(&["--algorithm", "track", "--cells", "24,24,1"], &["24 x 24 x 1", "16 x 16 x 3"]);
    refuses(&["--algorithm", "track", "--cells", "3,16,3"], &["--cells", "4 directions"]);
    refuses(&["--algorithm", "track", "--any-vehicle"], &["any vehicle", "16 x 16 x 3"]);
    refuses(&["--algorithm", "track", "--samples", "36"], &["--samples", "--cells"]);
    refuses(&["--algorithm", "track", "--hypotheses", "9"], &["--hypotheses", "--cells"]);
    refuses(&["--cells", "16,16,3"], &["--cells", "--algorithm track"]);
}

#[test]
fn what_was_not_measured_is_refused_by_name() {
    refuses(folder().path(), &["size", "--samples", "69"], &["69 samples", "68 samples"]);
    refuses(folder().path(), &["size", "--hypotheses", "3000"], &["3000 hypotheses", "2081"]);
    refuses(
        folder().path(),
        &["size", "--any-vehicle", "--samples", "40"],
        &["any vehicle", "36 samples"],
    );
    refuses(folder().path(), &["size", "--samples", "2"], &["--samples", "2"]);
    refuses(folder().path(), &["size", "--algorithm", "scc"], &["--hypotheses", "529"]);
    refuses(
        folder().path(),
        &["size", "--algorithm", "cfc", "--hypotheses", "9"],
        &["--hypotheses", "Algorithm 1"],
    );
    refuses(folder().path(), &["size", "--mhz", "0"], &["--mhz", "0.001"]);
}
