//! `replay` of recorded samples.

use std::fmt::Write as _;
use std::fs;

use crate::{folder, prints, refuses};

#[test]
fn replay_says_what_samples_determine() {
    let folder = folder();
    let rows = "# by hand\n label , x,z,note\n-1,2,1,a\n1,2,8,b\n+1.0,18.0,16,\n-1,18,5,\n";
    fs::write(folder.path().join("s.csv"), rows).expect("a file");
    let words = prints(folder.path(), &["replay", "s.csv", "--figure", "s.svg"]);
    for part in ["4 samples", "-10.62 to 43.15", "-0.875 to 8.375", "centre"] {
        assert!(words.contains(part), "{part}: {words}");
    }
    assert!(folder.path().join("s.svg").exists());
    let record: serde_json::Value =
        serde_json::from_str(&prints(folder.path(), &["replay", "s.csv", "--format", "json"]))
            .expect("JSON");
    assert_eq!((&record["samples"], &record["matter"]), (&4.into(), &4.into()));
    assert!(record["estimates"]["centre"]["slope"].is_f64());
}

#[test]
fn replay_takes_more_rows_than_any_buffer_holds() {
    let folder = folder();
    // A thousand samples of z = 0.5 x + 7001.25 kilometres away, the first hundreds of one label.
    let mut rows = String::from("x,z,label\n");
    for i in 0..1000_i32 {
        let x = f64::from(i * 37 % 1000) / 50.0 - 7000.0;
        let off =
            f64::from(i * 61 % 97 + 3) / 10.0 * if i < 300 || i % 2 == 0 { 1.0 } else { -1.0 };
        let z = 0.5 * x + 7001.25 + off;
        writeln!(rows, "{x},{z},{}", if off > 0.0 { 1 } else { -1 }).expect("a string");
    }
    fs::write(folder.path().join("s.csv"), &rows).expect("a file");
    let record: serde_json::Value =
        serde_json::from_str(&prints(folder.path(), &["replay", "s.csv", "--format", "json"]))
            .expect("JSON");
    assert_eq!(record["samples"], 1000);
    let slope = record["estimates"]["centre"]["slope"].as_f64().expect("a slope");
    assert!((slope - 0.5).abs() < 0.02, "{slope}");
    // And the row that no line allows is named.
    rows += "-6990,3515,-1\n";
    fs::write(folder.path().join("s.csv"), rows).expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:1002", "no line separates"]);
}

#[test]
fn bad_samples_are_refused_by_file_and_line() {
    let folder = folder();
    let cases: [(&str, &[&str]); 13] = [
        ("", &["s.csv:1", "x,z,label"]),
        ("x,y,label\n1,2,1\n", &["s.csv:1", "x,y,label", "x,z,label"]),
        ("x,z,label\n", &["s.csv", "collinear"]),
        ("x,z,label\n1,2\n", &["s.csv:2", "label: found \"\"", "finite number"]),
        ("x,z,label\n1,2,1\na,2,1\n", &["s.csv:3", "x: found \"a\"", "finite number"]),
        ("x,z,label\n1,,1\n", &["s.csv:2", "z: found \"\"", "finite number"]),
        ("x,z,label\n1,NaN,1\n", &["s.csv:2", "z: found \"NaN\"", "finite number"]),
        ("x,z,label\n1,9000,1\n", &["s.csv:2", "(1, 9000)", "8192"]),
        ("x,z,label\n1,2,0\n", &["s.csv:2", "label: found 0", "-1 or 1"]),
        ("x,z,label\n0,0,1\n1,1,1\n2,5,1\n", &["s.csv", "one label"]),
        ("x,z,label\n0,0,1\n1,1,1\n2,2,-1\n", &["s.csv", "collinear"]),
        ("x,z,label\n0,0,1\n1,1,-1\n2,2,1\n3,9,1\n", &["s.csv:4", "no line separates"]),
        (
            "x,z,label\n0,0,1\n4,0,1\n2,5,-1\n2,-1,1\n2,1,1\n2,0,-1\n",
            &["s.csv:7", "no line separates"],
        ),
    ];
    for (rows, parts) in cases {
        fs::write(folder.path().join("s.csv"), rows).expect("a file");
        refuses(folder.path(), &["replay", "s.csv", "--figure", "f.svg"], parts);
    }
}
