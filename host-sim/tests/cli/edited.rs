//! Rows of campaigns that somebody has changed, or that another build has flown: none is accepted.

use std::fs;
use std::path::Path;

use crate::{folder, prints, refuses};

const FLAGS: [&str; 4] = ["--fields", "12", "--steps", "5"];
const SHARDS: [&str; 4] = ["s1.csv", "s2.csv", "s3.csv", "s4.csv"];

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).expect("a file");
}

/// FNV-1a of 64 bits, as the records have it.
fn checksum(bytes: &[u8]) -> String {
    let hash = bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

fn fly_shards(folder: &Path, flags: &[&str]) {
    for (number, csv) in (1..).zip(SHARDS) {
        let shard = format!("{number}/4");
        prints(folder, &[&["campaign", "--shard", &shard, "--csv", csv], flags].concat());
    }
}

/// The value of a key of a record, as it stands there.
fn value<'a>(record: &'a str, key: &str) -> &'a str {
    let (_, rest) = record.split_once(&format!("\"{key}\":")).unwrap_or_else(|| panic!("{record}"));
    rest.split([',', '}']).next().expect("a value")
}

/// Makes the record of a shard fit its rows again, as one does who changes them on purpose.
fn forge(folder: &Path, name: &str) {
    let (rows, beside) = (read(folder, name), format!("{name}.json"));
    let record = read(folder, &beside);
    let bytes = format!("\"bytes\":{}", value(&record, "bytes"));
    let sum = format!("\"checksum\":{}", value(&record, "checksum"));
    let record = record
        .replace(&bytes, &format!("\"bytes\":{}", rows.len()))
        .replace(&sum, &format!("\"checksum\":\"{}\"", checksum(rows.as_bytes())));
    write(folder, &beside, &record);
}

/// The rows with another text in a cell.
fn with_cell(rows: &str, line: usize, column: usize, text: &str) -> String {
    let mut lines: Vec<String> = rows.lines().map(str::to_owned).collect();
    let mut cells: Vec<_> = lines[line - 1].split(',').collect();
    cells[column] = text;
    lines[line - 1] = cells.join(",");
    lines.join("\n") + "\n"
}

fn without(rows: &str, line: usize) -> String {
    let lines = rows.split_inclusive('\n').enumerate();
    lines.filter(|(at, _)| at + 1 != line).map(|(_, it)| it).collect()
}

#[test]
fn changed_rows_do_not_fit_their_record() {
    let folder = folder();
    let folder = folder.path();
    fly_shards(folder, &FLAGS);
    let merge = [&["campaign", "merge"], &SHARDS[..]].concat();
    let rows = read(folder, "s2.csv");
    let bits = rows.lines().nth(1).and_then(|it| it.split(',').nth(2)).expect("bits").to_owned();
    // As long as it was.
    let nan = format!("{:>1$}", "NaN", bits.len()).replace(' ', "+");
    let digit = if bits.ends_with('1') { "2" } else { "1" };
    let other = format!("{}{digit}", &bits[..bits.len() - 1]);
    for cell in [nan.replace('+', "0"), other] {
        write(folder, "s2.csv", &with_cell(&rows, 2, 2, &cell));
        refuses(folder, &merge, &["s2.csv: found", "checksum", "s2.csv.json", "again"]);
    }
    write(folder, "s2.csv", &rows);
    prints(folder, &merge);
}

#[test]
fn rows_that_cannot_be_are_refused_by_their_line() {
    let folder = folder();
    let folder = folder.path();
    fly_shards(folder, &FLAGS);
    let merge = [&["campaign", "merge"], &SHARDS[..]].concat();
    let [rows, record] = ["s2.csv", "s2.csv.json"].map(|name| read(folder, name));
    // Shard 2 of 4 has the fields 3 to 5, three stages each.
    let header = rows.replace("field,step", "field,stop");
    let word = rows.replacen(",steps,", ",steps,x", 1);
    let bell = rows.replacen(",steps,", ",steps\x07,", 1);
    let cases: [(String, &[&str]); 14] = [
        (bell, &["s2.csv:2: found \"steps\\u{7}\" for ended", "control"]),
        (header, &["s2.csv:1", "field,stop", "expected"]),
        (word, &["s2.csv:2", "field"]),
        (with_cell(&rows, 2, 2, "NaN"), &["s2.csv:2: found NaN", "bits", "finite"]),
        (with_cell(&rows, 3, 5, "-inf"), &["s2.csv:3: found -inf", "bisector_deg", "finite"]),
        (with_cell(&rows, 3, 10, "1e999"), &["s2.csv:3: found 1e999", "metres", "finite"]),
        (with_cell(&rows, 2, 0, "9"), &["s2.csv:2: found field 9", "expected field 3 at 1"]),
        (with_cell(&rows, 2, 0, "0"), &["s2.csv:2: found field 0", "expected field 3 at 1"]),
        (with_cell(&rows, 2, 0, "-1"), &["s2.csv:2", "field"]),
        (with_cell(&rows, 3, 1, "3"), &["s2.csv:3: found field 3 at 3", "expected field 3 at 2"]),
        (without(&rows, 2), &["s2.csv:2: found field 3 at 2", "expected field 3 at 1"]),
        (without(&rows, 5), &["s2.csv:5: found field 4 at 2", "expected field 4 at 1"]),
        (without(&rows, 10), &["s2.csv:10: found no more rows", "expected field 5 at 5"]),
        (rows.clone() + rows.lines().last().expect("a row") + "\n", &["s2.csv:11: found field 5"]),
    ];
    for (changed, parts) in cases {
        write(folder, "s2.csv", &changed);
        write(folder, "s2.csv.json", &record);
        forge(folder, "s2.csv");
        refuses(folder, &merge, parts);
    }
}

#[test]
fn rows_in_noise_are_of_their_shard_too() {
    let folder = folder();
    let folder = folder.path();
    let flags = ["--fields", "12", "--steps", "12", "--compare", "random,margin", "--p", "0.9"];
    fly_shards(folder, &flags);
    let merge = [&["campaign", "merge"], &SHARDS[..]].concat();
    prints(folder, &merge);
    let [rows, record] = ["s2.csv", "s2.csv.json"].map(|name| read(folder, name));
    for (changed, parts) in [
        (with_cell(&rows, 2, 1, "9"), &["s2.csv:2: found field 9", "fields 3 to 5"][..]),
        (with_cell(&rows, 2, 2, "2"), &["s2.csv:2: found field 3 at 2", "1, 5, 10"]),
        (with_cell(&rows, 2, 3, "nan"), &["s2.csv:2: found nan", "bits", "finite"]),
        (without(&rows, 2), &["s2.csv:2: found field 3 at 5", "1, 5, 10"]),
    ] {
        write(folder, "s2.csv", &changed);
        write(folder, "s2.csv.json", &record);
        forge(folder, "s2.csv");
        refuses(folder, &merge, parts);
    }
}

#[test]
fn shards_of_another_build_are_refused() {
    let folder = folder();
    let folder = folder.path();
    fly_shards(folder, &FLAGS);
    let merge = [&["campaign", "merge"], &SHARDS[..]].concat();
    let record = read(folder, "s2.csv.json");
    let behaviour = value(&record, "behaviour");
    assert_eq!(behaviour, value(&read(folder, "s1.csv.json"), "behaviour"));
    write(folder, "s2.csv.json", &record.replace(behaviour, "\"0123456789abcdef\""));
    refuses(folder, &merge, &["s2.csv", "another build", "s1.csv"]);
    // A record of before there were checksums, or one whose checksum was cut out.
    for key in ["checksum", "behaviour"] {
        let entry = format!(",\"{key}\":{}", value(&record, key));
        assert!(record.contains(&entry), "{record}");
        write(folder, "s2.csv.json", &record.replace(&entry, ""));
        refuses(folder, &merge, &["s2.csv.json: found no", key, "fly the shard again"]);
    }
    for torn in ["", &record[..record.len() / 2]] {
        write(folder, "s2.csv.json", torn);
        refuses(folder, &merge, &["s2.csv.json", "cut off"]);
    }
}

/// A campaign that was stopped: its rows so far and their record, with a checksum of all of them.
fn stopped(folder: &Path) -> (String, String) {
    let flags = ["campaign", "--fields", "12", "--steps", "5", "--csv"];
    prints(folder, &[&flags[..], &["c.csv"]].concat());
    // Of a shard that is the whole there is a record.
    prints(folder, &[&flags[..], &["w.csv", "--shard", "1/1"]].concat());
    let (rows, record) = (read(folder, "c.csv"), read(folder, "w.csv.json"));
    let (record, _) = record.split_once(",\"bytes\"").expect("a record");
    let rows: String = rows.split_inclusive('\n').take(20).collect();
    let sum = checksum(rows.as_bytes());
    (rows.clone(), format!("{record}}}\n{{\"bytes\":{},\"checksum\":\"{sum}\"}}\n", rows.len()))
}

#[test]
fn changed_rows_are_not_gone_on_with() {
    let folder = folder();
    let folder = folder.path();
    let (rows, record) = stopped(folder);
    let whole = read(folder, "c.csv");
    fs::remove_file(folder.join("c.csv")).expect("it is there");
    let resume = ["campaign", "--fields", "12", "--steps", "5", "--csv", "c.csv", "--resume"];
    let begin = |rows: &str, record: &str| {
        write(folder, "c.csv.partial", rows);
        write(folder, "c.csv.partial.json", record);
    };
    let bits = rows.lines().nth(2).and_then(|it| it.split(',').nth(2)).expect("bits").len();
    for changed in [
        with_cell(&rows, 3, 2, &format!("NaN{}", "0".repeat(bits - 3))),
        with_cell(&rows, 3, 2, &format!("{:<1$}", "1.5", bits).replace(' ', "0")),
        with_cell(&rows, 2, 0, "7"),
        without(&rows, 4) + &rows,
    ] {
        begin(&changed, &record);
        refuses(folder, &resume, &["c.csv.partial: found", "checksum", "remove"]);
        assert_eq!(read(folder, "c.csv.partial"), changed);
        assert_eq!(read(folder, "c.csv.partial.json"), record);
    }
    // Rows that end before their checksum are flown again.
    for changed in [with_cell(&rows, 3, 2, "NaN"), with_cell(&rows, 3, 2, "1"), without(&rows, 4)] {
        begin(&changed, &record);
        prints(folder, &resume);
        assert!(read(folder, "c.csv") == whole, "{changed}");
        fs::remove_file(folder.join("c.csv")).expect("it is there");
    }
    // What has no checksum yet is flown again, whatever it is.
    let tails = ["11,1,NaN", "3,1,0.5\n", "\0\0\0\0\n\0", "6,5,0"];
    for (tail, known) in tails.iter().flat_map(|tail| [(tail, &record[..]), (tail, "")]) {
        let first = record.lines().next().expect("a record").to_owned() + "\n";
        let record = if known.is_empty() { first } else { known.to_owned() + "{\"bytes\":9" };
        begin(&format!("{rows}{tail}"), &record);
        prints(folder, &resume);
        assert!(read(folder, "c.csv") == whole, "{tail:?}");
        fs::remove_file(folder.join("c.csv")).expect("it is there");
        assert!(!folder.join("c.csv.partial.json").exists());
    }
}

#[test]
fn a_record_that_was_cut_off_or_is_of_another_build_is_told() {
    let folder = folder();
    let folder = folder.path();
    let (rows, record) = stopped(folder);
    let resume = ["campaign", "--fields", "12", "--steps", "5", "--csv", "c.csv", "--resume"];
    let line = record.lines().next().expect("a record");
    for torn in ["", &line[..line.len() / 2], line, &"\0".repeat(line.len())] {
        write(folder, "c.csv.partial", &rows);
        write(folder, "c.csv.partial.json", torn);
        refuses(folder, &resume, &["c.csv.partial.json", "cut off", "remove", "c.csv.partial"]);
        assert_eq!(read(folder, "c.csv.partial"), rows);
    }
    let other = record.replace(value(&record, "behaviour"), "\"0123456789abcdef\"");
    write(folder, "c.csv.partial.json", &other);
    refuses(folder, &resume, &["c.csv.partial", "another build", "remove"]);
}
