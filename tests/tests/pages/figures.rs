//! The figures of `docs/figures.md`: its tables are what its commands print.
//!
//! Each section has a line `Run: ... after ...` and a table. The first cell of a row has more flags of the command; `N` in
//! them is the number of labels of the row. `UPDATE_EXPECT=1 LONG=1 cargo test -p tests figures::` writes the tables anew:
//! a new row needs its first cell only. `LONG=1` compares the tables with what is flown now, and `LONG=1 SEED=2` with
//! other fields.

use std::collections::HashMap;
use std::env;
use std::fmt::Write as _;
use std::fs;

use serde_json::Value;
use tests::build::{is_long, root};
use tests::command;
use tests::is_updating;

const HEAD: &str =
    "| flags | after | slope error, degrees | 90 % | worst | misclassified, % | metres |
| --- | ---: | ---: | ---: | ---: | ---: | ---: |
";

/// The cells that are compared: medians, and a mean. The spread of both medians is taken to be that of the first, whose
/// 90th percentile is behind it.
const MEDIANS: [usize; 2] = [0, 3];
const SPREAD: [usize; 2] = [0, 1];
const MEAN: usize = 4;

/// How far medians and means of the same fields may be off: what compilers and rounding may change.
const SAME: f64 = 1.03;

/// How far those of other fields may be off, unless the standard error of a median is large.
const OTHER: f64 = 1.2;

/// What a command flies, and after how many labels or motions it is looked at.
#[derive(Clone, Debug, Default)]
struct Section {
    command: String,
    after: Vec<u32>,
    /// The flags of each row, and the cells behind them.
    rows: Vec<(String, u32, Vec<String>)>,
}

impl Section {
    /// The flags and stages of which there is to be a row.
    fn wanted(&self) -> Vec<(String, u32)> {
        let mut flags: Vec<_> = self.rows.iter().map(|row| &row.0).collect();
        flags.dedup();
        let stages = |flags: &String| self.after.iter().map(|&at| (flags.clone(), at)).collect();
        flags.into_iter().flat_map::<Vec<_>, _>(stages).collect()
    }
}

/// Three digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().expect("a number");
    let places = if rounded > 0.0 { 2 - rounded.log10().floor() as i32 } else { 0 };
    if places > 6 { format!("{value:.2e}") } else { format!("{value:.*}", places.max(0) as usize) }
}

/// The fields of another seed, if there is one.
fn other_seed() -> Option<String> {
    env::var("SEED").ok()
}

/// What commands print for programs. Rows share commands.
#[derive(Default)]
struct Flown(HashMap<String, Value>);

impl Flown {
    fn found(&mut self, command: &str, flags: &str, after: u32) -> &Value {
        let seed = other_seed().unwrap_or_else(|| "1".to_owned());
        let line = format!("host-sim {command} {flags} --seed {seed}");
        let line = line.replace('N', &after.to_string());
        self.0.entry(line).or_insert_with_key(|line| command::record(line))
    }
}

/// The cells of a row.
fn cells(found: &Value, after: u32) -> Vec<String> {
    let at = |row: &&Value| ["step", "labels"].iter().any(|it| row[*it] == after);
    let rows = found["rows"].as_array().expect("rows");
    let row = rows.iter().find(at).unwrap_or_else(|| panic!("nothing after {after}: {found}"));
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let of = |names: [&str; 2], scale: f64| {
        let it = names.iter().map(|it| &row[*it]).find(|it| !it.is_null()).expect("errors");
        ["median", "p90", "worst"].map(|which| digits(scale * number(&it[which])))
    };
    let slope = of(["centre_deg", "mean_deg"], 1.0);
    let missed = of(["centre_misclassified", "mean_misclassified"], 100.0);
    [&slope[..], &missed[..1], &[digits(number(&row["metres"]))]].concat()
}

/// The sections of a page, and the text between their tables.
fn read(page: &str) -> (Vec<String>, Vec<Section>) {
    let (mut texts, mut sections) = (vec![String::new()], Vec::<Section>::new());
    for line in page.lines() {
        let mut row = line.trim_matches('|').split('|').map(str::trim);
        match (line.strip_prefix("Run: `"), sections.last_mut()) {
            (Some(run), _) => {
                let (command, after) = run.split_once("`, after ").expect(line);
                let after = after.trim_end_matches('.').split(", ");
                let after = after.map(|it| it.parse().expect(line)).collect();
                sections.push(Section { command: command.to_owned(), after, rows: vec![] });
                let _ = writeln!(texts.last_mut().expect("one"), "{line}\n");
                texts.push(String::new());
            }
            (None, Some(section)) if line.starts_with("| `") => {
                let flags = row.next().expect(line).trim_matches('`').to_owned();
                let after = row.next().and_then(|it| it.parse().ok()).unwrap_or(0);
                section.rows.push((flags, after, row.map(str::to_owned).collect()));
            }
            _ if line.starts_with('|') => {}
            _ => {
                let text = texts.last_mut().expect("one");
                if !(text.is_empty() && line.is_empty()) {
                    let _ = writeln!(text, "{line}");
                }
            }
        }
    }
    (texts, sections)
}

fn written(texts: &[String], sections: &[Section]) -> String {
    let mut page = texts[0].clone();
    for (section, text) in sections.iter().zip(&texts[1..]) {
        page += HEAD;
        for (flags, after, cells) in &section.rows {
            let _ = writeln!(page, "| `{flags}` | {after} | {} |", cells.join(" | "));
        }
        let _ = write!(page, "\n{text}");
    }
    format!("{}\n", page.trim_end())
}

/// The largest factor between a median of so many fields and that of as many others: four standard errors of the
/// difference. The logarithms of errors are taken to be normal about the median, so the 90th percentile tells their
/// deviation.
fn by_chance(median: f64, ninety: f64, fields: f64) -> f64 {
    let deviation = (ninety / median).ln() / 1.2816;
    (4.0 * 1.2533 * deviation * (2.0 / fields).sqrt()).exp()
}

/// How medians and means differ that should not.
fn differs(was: &[String], is: &[String], fields: f64) -> Option<String> {
    let at = |row: &[String], k: usize| row.get(k).and_then(|it| it.parse::<f64>().ok());
    let is_near = |k: usize, most: f64| {
        let (Some(was), Some(is)) = (at(was, k), at(is, k)) else { return false };
        let (less, more) = (was.min(is), was.max(is));
        more <= most * less
    };
    let [most, most_mean] = match (other_seed(), SPREAD.map(|k| at(was, k))) {
        (None, _) => [SAME; 2],
        (_, [Some(median), Some(ninety)]) => [OTHER.max(by_chance(median, ninety, fields)), OTHER],
        _ => [OTHER; 2],
    };
    let are_near = MEDIANS.iter().all(|&k| is_near(k, most)) && is_near(MEAN, most_mean);
    (!are_near).then(|| format!("{} is {}", was.join(" "), is.join(" ")))
}

#[test]
fn are_what_the_commands_print() {
    let path = root().join("docs/figures.md");
    let page = fs::read_to_string(&path).expect("the page");
    let (texts, mut sections) = read(&page);
    if !is_long("the figures of docs/figures.md", "figures") {
        assert_eq!(written(&texts, &sections), page, "a table is not as the test writes it");
        for section in &sections {
            let rows: Vec<_> = section.rows.iter().map(|row| (row.0.clone(), row.1)).collect();
            assert_eq!(rows, section.wanted(), "{}: a row is missing or doubled", section.command);
        }
        return;
    }
    assert!(!is_updating() || other_seed().is_none(), "SEED is for comparing: the page has seed 1");
    let (mut wrong, mut flown) = (String::new(), Flown::default());
    for section in &mut sections {
        let wanted = section.wanted();
        let was = std::mem::take(&mut section.rows);
        for (flags, after) in wanted {
            let found = flown.found(&section.command, &flags, after);
            let (is, fields) = (cells(found, after), found["fields"].as_f64().expect("a number"));
            let before = was.iter().find(|row| row.0 == flags && row.1 == after);
            if let Some(differs) = differs(before.map_or(&[], |row| &row.2), &is, fields) {
                let _ = writeln!(wrong, "{} {flags}, {after}: {differs}", section.command);
            }
            section.rows.push((flags, after, is));
        }
    }
    if is_updating() {
        fs::write(&path, written(&texts, &sections)).expect("the page");
    } else {
        assert!(wrong.is_empty(), "{wrong}");
    }
}
