//! `replay` of recorded samples.

use std::fmt::Write as _;
use std::fs;
use std::time::{Duration, Instant};

use crate::recordings::{SLOPE, answer, hold, near, random, sign};
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
        ("x,z,label\n1,2\n", &["s.csv:2", "label: found \"\"", "--strict"]),
        ("x,z,label\n1,2,1\na,2,1\n", &["s.csv:3", "x: found \"a\"", "finite number"]),
        ("x,z,label\n1,,1\n", &["s.csv:2", "z: found \"\"", "--strict"]),
        ("x,z,label\n1,NaN,1\n", &["s.csv:2", "z: found \"NaN\"", "--strict"]),
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
        refuses(folder.path(), &["replay", "s.csv", "--strict", "--figure", "f.svg"], parts);
    }
}

#[test]
fn the_line_that_is_named_is_the_one_on_which_the_row_begins() {
    let folder = folder();
    let cases: [(&str, &str); 14] = [
        ("x,z,label\r\n1,2,1\r\nbad,2,1\r\n", "s.csv:3"),
        ("x,z,label\n\n\n1,2,1\n\nbad,2,1\n", "s.csv:6"),
        ("x,z,label\r\n\r\n1,2,1\r\n\r\n\r\nbad,2,1\r\n", "s.csv:6"),
        ("# one\n# two\nx,z,label\n# three\n1,2,1\n# four\n\n# five\nbad,2,1", "s.csv:9"),
        ("# one\r\n\r\nx,z,label\r\n# two\r\nbad,2,1\r\n", "s.csv:5"),
        ("x,z,label\r1,2,1\r\rbad,2,1\r", "s.csv:4"),
        ("x,z,label,note\n1,2,1,\"two\nlines\"\nbad,2,1,\n", "s.csv:4"),
        ("x,z,label,note\n1,2,1,\nbad,2,1,\"two\nlines\"\n", "s.csv:3"),
        ("\u{feff}x,z,label\n1,2,1\nbad,2,1\n", "s.csv:3"),
        ("\u{feff}x,z,label\r\n\r\nbad,2,1\r\n", "s.csv:3"),
        ("x,z,label\n1,2,1\n  \n", "s.csv:3"),
        // What no line separates, and the header, are named alike.
        ("x,z,label\r\n\r\n0,0,1\r\n# a comment\r\n1,1,-1\r\n\r\n2,2,1\r\n", "s.csv:7"),
        ("# a comment\r\n\r\nx,y,label\r\n", "s.csv:3"),
        ("\n\nx,z,x,label\n", "s.csv:3"),
    ];
    for (rows, place) in cases {
        fs::write(folder.path().join("s.csv"), rows).expect("a file");
        let args = ["replay", "s.csv", "--strict"];
        refuses(folder.path(), &args, &[&format!("error: {place}: ")]);
    }
}

#[test]
fn a_column_that_comes_twice_is_refused_by_name() {
    let folder = folder();
    for (header, name) in
        [("x,x,z,label", "x"), ("label,x,z, label", "label"), ("x,z,label,z", "z")]
    {
        let rows = format!("{header}\n2,2,1,-1\n2,2,8,1\n18,18,16,1\n18,18,5,-1\n");
        fs::write(folder.path().join("s.csv"), rows).expect("a file");
        let parts = ["s.csv:1", &format!("the column {name} twice"), "x,z,label once"];
        refuses(folder.path(), &["replay", "s.csv"], &parts);
    }
    // What is not looked at may come as it likes, and in any encoding.
    let rows = b"note,x,z,label,note\n\xe9,2,1,-1,\n,2,8,1,\n,18,16,1,\n,18,5,-1,\n";
    fs::write(folder.path().join("s.csv"), rows).expect("a file");
    prints(folder.path(), &["replay", "s.csv"]);
}

#[test]
fn replay_is_quick_with_very_many_rows() {
    let folder = folder();
    let count = 200_000_u32;
    let mut rows = String::from("x,z,label\n");
    for i in 0..count {
        // Numbers that fill their ranges evenly, one after the other.
        let part = |step: u32| f64::from(i.wrapping_mul(step) % 999_983) / 999_983.0;
        let (x, off) = (100.0 * part(7_919), 0.5 + 40.0 * part(104_729));
        let off = if i % 2 == 0 { off } else { -off };
        writeln!(rows, "{x:.4},{:.4},{}", 0.41 * x + 3.5 + off, off.signum()).expect("a string");
    }
    fs::write(folder.path().join("s.csv"), &rows).expect("a file");
    let begun = Instant::now();
    let args = ["replay", "s.csv", "--format", "json", "--figure", "f.svg"];
    let record: serde_json::Value =
        serde_json::from_str(&prints(folder.path(), &args)).expect("JSON");
    // Quadratic, it takes minutes.
    assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    assert_eq!(record["samples"], count);
    for name in ["centre", "maximum_margin", "bisector"] {
        let slope = record["estimates"][name]["slope"].as_f64().expect("a slope");
        assert!((slope - 0.41).abs() < 0.01, "{name}: {slope}");
    }
    // The figure shows some of them, and says so.
    let svg = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
    let bounding = record["matter"].as_u64().expect("a count");
    assert!(svg.contains(&format!("one in 100 of 200000 samples, all {bounding} that bound")));
    let marks = svg.matches("<circle").count() + svg.matches("<rect").count();
    assert!((2_000..2_100).contains(&marks), "{marks}");
    // The row that no line allows is found as soon.
    let begun = Instant::now();
    fs::write(folder.path().join("s.csv"), rows + "50,44,-1\n0,0,-1\n").expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:200002:", "no line separates"]);
    assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
}

#[test]
fn any_number_of_samples_may_bound_the_line() {
    let folder = folder();
    let mut rows = String::from("x,z,label\n");
    let half = 1_500_i32;
    for i in -half..=half {
        // Corners of a convex arc on the lattice: the second difference of z is one unit in 2^16.
        let units = f64::from(i * (i + 1) / 2 + half * half);
        let (x, z) = (f64::from(i) / 65_536.0, units / 65_536.0);
        writeln!(rows, "{x},{z},1\n{x},{},-1", -z).expect("a string");
    }
    fs::write(folder.path().join("s.csv"), rows).expect("a file");
    let args = ["replay", "s.csv", "--format", "json", "--figure", "f.svg"];
    let record: serde_json::Value =
        serde_json::from_str(&prints(folder.path(), &args)).expect("JSON");
    assert_eq!(
        (&record["samples"], &record["matter"]),
        (&(4 * half + 2).into(), &(4 * half + 2).into())
    );
    assert!(record["estimates"]["maximum_margin"]["slope"].as_f64().expect("one").abs() < 1e-3);
}

#[test]
fn a_steep_line_is_told_by_where_it_is() {
    let folder = folder();
    // Columns of samples that lean by as much as is said, +1 on the right.
    for (lean, centre) in [
        (0.0, "x = 9.2500   (vertical)"),
        (0.000_61, "x = 9.2500 +0.0006 z   (89.97 deg)"),
        (-0.099, "x = 9.2500 -0.0990 z   (-84.35 deg)"),
        (0.125, "z = 8.0000 x -74.0000   (82.87 deg)"),
    ] {
        let mut rows = String::from("x,z,label\n");
        for z in [0.0, 10.0] {
            let x = 9.25 + lean * z;
            writeln!(rows, "{},{z},-1\n{},{z},1", x - 0.5, x + 0.5).expect("a string");
        }
        fs::write(folder.path().join("s.csv"), rows).expect("a file");
        let words = prints(folder.path(), &["replay", "s.csv"]);
        let margin = words.lines().find(|line| line.starts_with("maximum margin")).expect("one");
        assert_eq!(margin["maximum margin".len()..].trim(), centre);
    }
}

#[test]
fn hundreds_of_thousands_of_doubtful_rows_with_a_tolerance_have_an_answer() {
    let folder = folder();
    let mut state = 3;
    let mut rows = String::from("x,z,label\n");
    for _ in 0..400_000 {
        let [x, z] = [0; 2].map(|_| (random(&mut state) * 100_000.0).round() / 100.0);
        // Off by some metres, and one label in a hundred wrong.
        let off = 6.0 * (random(&mut state) + random(&mut state) - 1.0);
        let label = (z + off > SLOPE * x + 200.0) != (random(&mut state) < 0.01);
        writeln!(rows, "{x},{z},{}", sign(label)).expect("a string");
    }
    let found = answer(folder.path(), &rows, &["--p", "0.99", "--tolerance", "10"]);
    assert!(hold(&found["slope_arcs"], SLOPE.atan().to_degrees()), "{}", found["slope_arcs"]);
    near(&found["estimates"]["centre"]["slope"], SLOPE, 2e-3);
}
