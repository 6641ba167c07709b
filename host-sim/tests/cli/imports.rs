//! Recordings as they come from loggers and spreadsheets: rows without a value, labels that are measured values, labels in
//! German, numbers with separators between thousands, and columns that have to be named.

use std::fs;

use serde_json::json;

use crate::recordings::{answer, file, plain, rows, sign};
use crate::{folder, prints, refuses};

#[test]
fn rows_without_a_value_are_skipped_and_counted() {
    let folder = folder();
    let rows = rows(60);
    let expected = answer(folder.path(), &plain(&rows), &[]);
    assert_eq!(expected["skipped"], json!({ "rows": 0 }));
    for gap in [
        "NaN,2,1",
        "1,,1",
        "1,2",
        "1,2,nan",
        "-9999,2,1",
        "1,-9999.0,-1",
        "1,2,NA",
        "1,2,null",
        "n/a,2,1",
        "1,2,-9999",
    ] {
        // The third row, and the last.
        let mut lines: Vec<_> = plain(&rows).lines().map(str::to_owned).collect();
        lines.insert(3, gap.to_owned());
        lines.push(gap.to_owned());
        let content = lines.join("\n") + "\n";
        let mut found = answer(folder.path(), &content, &[]);
        assert_eq!(found["skipped"]["rows"], 2, "{gap}");
        assert_eq!(found["skipped"]["first"], 4, "{gap}");
        found["skipped"] = expected["skipped"].clone();
        assert_eq!(found, expected, "{gap}");
        let words = prints(folder.path(), &["replay", "s.csv"]);
        assert!(words.contains("Skipped 2 rows") && words.contains("line 4"), "{gap}: {words}");
        refuses(folder.path(), &["replay", "s.csv", "--strict"], &["s.csv:4: ", "--strict"]);
    }
    // Lines of the file keep their numbers.
    let content = "x,z,label\nNaN,1,1\n0,0,1\n1,1,-1\n0,1,\n2,2,1\n3,9,1\n";
    fs::write(folder.path().join("s.csv"), content).expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:6:", "no line separates"]);
    // In a file without titles the first row may be one of these.
    let content = plain(&rows).replace("x,z,label", "NaN,2,1");
    let found = answer(folder.path(), &content, &["--columns", "x=1,z=2,label=3"]);
    assert_eq!(found["skipped"], json!({ "rows": 1, "first": 1 }));
    // Nothing left, and what is no number at all.
    fs::write(folder.path().join("s.csv"), "x,z,label\nNaN,1,1\n1,2,\n").expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv", "all 2 rows", "line 2", "x"]);
    for (row, parts) in [("abc,2,1", ["\"abc\"", "number"]), ("inf,2,1", ["\"inf\"", "number"])] {
        fs::write(folder.path().join("s.csv"), format!("x,z,label\n{row}\n")).expect("a file");
        refuses(folder.path(), &["replay", "s.csv"], &["s.csv:2", parts[0], parts[1]]);
    }
}

#[test]
fn measured_values_are_labels_by_a_threshold() {
    let folder = folder();
    let rows = rows(60);
    let expected = answer(folder.path(), &plain(&rows), &[]);
    let measured = |above: f64, below: f64| {
        file("x,z,salinity", &rows, |[x, z], l| {
            format!("{x},{z},{}", if l { above } else { below } + x / 1000.0)
        })
    };
    let flags = |threshold: &'static str| ["--columns", "label=salinity", "--threshold", threshold];
    let content = measured(34.2, 33.1);
    assert_eq!(answer(folder.path(), &content, &flags("34")), expected);
    assert_eq!(answer(folder.path(), &measured(-1.5, -2.5), &flags("-2")), expected);
    // The threshold itself is not above it.
    let content = "x,z,label\n2,1,5\n2,8,5.1\n18,16,6\n18,5,-7\n";
    let found = answer(folder.path(), content, &["--threshold", "5"]);
    let signs = "x,z,label\n2,1,-1\n2,8,1\n18,16,1\n18,5,-1\n";
    assert_eq!(found, answer(folder.path(), signs, &[]));
    for (content, flags, parts) in [
        ("x,z,label\n1,2,0.7\n", &[][..], &["s.csv:2", "0.7", "--threshold"][..]),
        ("x,z,label\n1,2,yes\n", &["--threshold", "1"], &["s.csv:2", "\"yes\"", "--threshold"]),
        (content, &["--threshold", "9"], &["s.csv", "--threshold 9", "both sides"]),
        (content, &["--threshold", "NaN"], &["--threshold", "finite number"]),
        (
            "{\"record\":\"start\",\"oracle\":[],\"p\":1}\n",
            &["--threshold", "1"],
            &["--threshold", "trace"],
        ),
    ] {
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        refuses(folder.path(), &[&["replay", "s.csv"], flags].concat(), parts);
    }
}

#[test]
fn numbers_may_have_separators_between_thousands() {
    let folder = folder();
    // Positions beyond a thousand metres, with a tenth.
    let rows: Vec<_> =
        rows(60).into_iter().map(|([x, z], l)| ([100.0 * x, 100.0 * z], l)).collect();
    let tenth = |v: f64| format!("{v:.1}");
    let expected = {
        let content = file("x,z,label", &rows, |[x, z], l| format!("{x:.1},{z:.1},{}", sign(l)));
        answer(folder.path(), &content, &[])
    };
    let grouped = |v: f64, group: &str, decimal: &str| {
        let text = tenth(v);
        let (whole, rest) = text.split_once('.').expect("a point");
        let whole = match whole.len() {
            4.. => format!("{}{group}{}", &whole[..whole.len() - 3], &whole[whole.len() - 3..]),
            _ => whole.to_owned(),
        };
        format!("{whole}{decimal}{rest}")
    };
    for (group, decimal, delimiter) in [
        (",", ".", ";"),
        (".", ",", ";"),
        (" ", ",", ";"),
        ("'", ".", ";"),
        ("\u{a0}", ",", "\t"),
        ("\u{202f}", ",", "|"),
        ("\u{2019}", ".", ","),
        (" ", ".", ","),
        ("'", ".", " "),
    ] {
        let d = delimiter;
        let content = file(&format!("x{d}z{d}label"), &rows, |[x, z], l| {
            format!("{}{d}{}{d}{}", grouped(x, group, decimal), grouped(z, group, decimal), sign(l))
        });
        assert_eq!(
            answer(folder.path(), &content, &[]),
            expected,
            "{group:?} {decimal:?} {content}"
        );
    }
    // In quotes between commas.
    let content = file("x,z,label", &rows, |[x, z], l| {
        format!("\"{}\",\"{}\",{}", grouped(x, ",", "."), grouped(z, ",", "."), sign(l))
    });
    assert_eq!(answer(folder.path(), &content, &[]), expected);
    // One number that is clear settles the others: 1,234 is a thousand and more here.
    let clear = "x;z;label\n1,234.5;1;-1\n1,234;2,500;1\n1,300;2,600;1\n1,400;1;-1\n";
    let plain = "x;z;label\n1234.5;1;-1\n1234;2500;1\n1300;2600;1\n1400;1;-1\n";
    assert_eq!(answer(folder.path(), clear, &[]), answer(folder.path(), plain, &[]));
    for (content, parts) in [
        // Which of the two 1,234 is, and 1.234, nobody knows here.
        (
            "x;z;label\n1,234;1;-1\n12.5;2;1\n3;2;1\n",
            &["s.csv:2", "\"1,234\"", "1234 or 1.234", "line 3"][..],
        ),
        (
            "x;z;label\n12,5;1;-1\n1.234;2;1\n3;2;1\n",
            &["s.csv:3", "\"1.234\"", "1234 or 1.234", "line 2"],
        ),
        ("x,z,label\n\"1,234\",1,-1\n12,2,1\n", &["s.csv:2", "\"1,234\"", "1234 or 1.234"]),
        ("x;z;label\n1,234.5;1;-1\n1.234,5;2;1\n", &["s.csv:3", "\"1.234,5\"", "line 2"]),
        ("x;z;label\n1,234.5;1;-1\n12,5;2;1\n", &["s.csv:3", "\"12,5\"", "line 2"]),
        ("x;z;label\n12,34.5;1;-1\n", &["s.csv:2", "\"12,34.5\"", "finite number"]),
        ("x;z;label\n1'23;1;-1\n", &["s.csv:2", "\"1'23\"", "finite number"]),
        ("x;z;label\n1 2;1;-1\n", &["s.csv:2", "\"1 2\"", "finite number"]),
        ("x;z;label\n1,2,3;1;-1\n", &["s.csv:2", "\"1,2,3\"", "finite number"]),
        ("x;z;label\n0,123.5;1;-1\n", &["s.csv:2", "\"0,123.5\"", "finite number"]),
    ] {
        fs::write(folder.path().join("s.csv"), content).expect("a file");
        refuses(folder.path(), &["replay", "s.csv"], parts);
    }
}

#[test]
fn labels_may_be_german() {
    let folder = folder();
    let rows = rows(60);
    let word = |l: bool| if l { "Ja" } else { "nein" };
    let content = file("x,z,label", &rows, |[x, z], l| format!("{x},{z},{}", word(l)));
    assert_eq!(answer(folder.path(), &content, &[]), answer(folder.path(), &plain(&rows), &[]));
    fs::write(folder.path().join("s.csv"), "x,z,label\n1,2,ja\n1,3,no\n").expect("a file");
    refuses(folder.path(), &["replay", "s.csv"], &["s.csv:3", "found no", "line 2", "ja or nein"]);
}

#[test]
fn an_unknown_column_is_told_by_the_flag_that_names_columns() {
    let folder = folder();
    let content = "Breite,Laenge,oil\n53.5,9.9,1\n";
    fs::write(folder.path().join("1_gps.csv"), content).expect("a file");
    for (flags, parts) in [
        (&[][..], &["1_gps.csv:1", "\"Breite,Laenge,oil\"", "--columns"][..]),
        (
            &["--columns", "label=oil"],
            &["1_gps.csv:1", "\"Breite,Laenge,oil\"", "--columns", "lat="],
        ),
        (&["--columns", "lat=Breite,lon=Länge,label=oil"], &["--columns lon=Länge", "1_gps.csv:1"]),
        (
            &["--columns", "lat=Breite,lon=7,label=oil"],
            &["--columns lon=7", "1_gps.csv:1", "up to 3"],
        ),
        (&["--columns", "lat=Breite,lon=Breite,label=oil"], &["--columns", "one column for two"]),
    ] {
        refuses(folder.path(), &[&["replay", "1_gps.csv"], flags].concat(), parts);
    }
}
