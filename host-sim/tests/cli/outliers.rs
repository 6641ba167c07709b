//! `replay` of true labels that no line separates: the row that is to blame, if there is one.

use std::fmt::Write as _;
use std::fs;
use std::time::{Duration, Instant};

use crate::recordings::{INTERCEPT, SLOPE, plain, rows};
use crate::{folder, refuses};

/// A row of wrong label far from the line, by its place in the file.
fn with_wrong(at: usize, count: usize) -> (String, usize) {
    let mut rows = rows(count);
    let is_far = |[x, z]: [f64; 2]| (z - SLOPE * x - INTERCEPT).abs() > 4.0;
    let wrong = (at..count).find(|k| is_far(rows[*k].0)).expect("a far one");
    rows[wrong].1 = !rows[wrong].1;
    (plain(&rows), wrong + 2)
}

#[test]
fn the_one_row_that_is_wrong_is_named_wherever_it_is() {
    let folder = folder();
    for at in [0, 1, 5, 60, 150, 190] {
        let (content, line) = with_wrong(at, 200);
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        let place = format!("error: s.csv:{line}: ");
        let parts = [&place, "no line separates", "without this row", "other 199"];
        refuses(folder.path(), &["replay", "s.csv"], &parts);
        let parts = [&place, "within 0.5 m", "without this row"];
        refuses(folder.path(), &["replay", "s.csv", "--tolerance", "0.5"], &parts);
    }
}

#[test]
fn rows_that_explain_it_as_well_are_all_named() {
    let folder = folder();
    let cases: [(&str, &[&str]); 4] = [
        // Either end of three in a row.
        ("x,z,label\n0,0,1\n1,1,-1\n2,2,1\n5,0,-1\n3,9,1\n", &["s.csv:", "without line"]),
        // The same place and label twice: both go together.
        (
            "x,z,label\n0,0,-1\n9,0,-1\n4,1,-1\n4,8,-1\n4,8,-1\n0,5,1\n9,5,1\n0,9,1\n9,9,1\n",
            &["s.csv:5:", "lines 5 and 6", "same position"],
        ),
        // Two wrong labels far apart: no single row explains them.
        (
            "x,z,label\n0,0,-1\n9,0,-1\n4,2,-1\n4,1,1\n4,8,-1\n0,5,1\n9,5,1\n4,9,1\n",
            &["s.csv:", "no single row", "--p"],
        ),
        // Both labels at one place: either may be wrong.
        ("x,z,label\n0,0,-1\n9,0,-1\n4,5,1\n4,5,-1\n0,9,1\n", &["s.csv:5:", "no line separates"]),
    ];
    for (content, parts) in cases {
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        refuses(folder.path(), &["replay", "s.csv"], parts);
    }
}

#[test]
fn the_wrong_row_among_very_many_is_found_soon() {
    let folder = folder();
    let mut content = String::from("x,z,label\n50,10,1\n");
    for i in 0..200_000_u32 {
        let part = |step: u32| f64::from(i.wrapping_mul(step) % 999_983) / 999_983.0;
        let (x, off) = (100.0 * part(7_919), 0.5 + 40.0 * part(104_729));
        let off = if i % 2 == 0 { off } else { -off };
        writeln!(content, "{x:.4},{:.4},{}", 0.41 * x + 3.5 + off, off.signum()).expect("a string");
    }
    fs::write(folder.path().join("s.csv"), content).expect("a file");
    for flags in [&[][..], &["--tolerance", "0.1"]] {
        let begun = Instant::now();
        let args = [&["replay", "s.csv"], flags].concat();
        refuses(folder.path(), &args, &["s.csv:2: ", "without this row"]);
        assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    }
}
