//! `footprint.toml`: what was measured, and what it may be at most. `docs/footprint.md` has tables of it.
//!
//! A figure fails only where it passes its budget, and a list only where it has a new entry. So a change of code that
//! costs little needs no new figures.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use tests::is_updating;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value, value};

/// From this crate's folder.
const FILE: &str = "footprint.toml";
const PAGE: &str = "../../docs/footprint.md";

const REMEDY: &str = "tests/chips/footprint.toml has the budgets. If what is new is intended, \
    `UPDATE_EXPECT=1 cargo test -p chips --features all footprint::` writes it there, and in docs/footprint.md.";

/// The hardest missions that are known, by workload.
const HARDEST: &str = "hardest";

/// The chip's clock, cycles in a millisecond: it turns cycles into time.
const CYCLES_PER_MS: f64 = 168_000.0;

/// A core and a program on it.
pub type Place<'a> = [&'a str; 2];

/// The file, and what was found against it.
#[derive(Debug)]
pub struct Book {
    document: DocumentMut,
    failures: Vec<String>,
    /// What was measured: core, program and name.
    seen: BTreeSet<[String; 3]>,
    /// Missions that were the worst of a search, by workload.
    harder: BTreeMap<String, BTreeSet<u64>>,
}

impl Book {
    /// Reads the file. With `UPDATE_EXPECT` set, what is measured will be written.
    ///
    /// # Panics
    /// If it is not as it should be.
    pub fn open() -> Self {
        let text = fs::read_to_string(path(FILE)).expect(FILE);
        Self {
            document: text.parse().expect("TOML"),
            failures: Vec::new(),
            seen: BTreeSet::new(),
            harder: BTreeMap::new(),
        }
    }

    /// The hardest missions that are known of a workload.
    pub fn hardest(&self, workload: &str) -> Vec<u64> {
        let known = self.document.get(HARDEST).and_then(|it| it.get(workload));
        let numbers = known.and_then(Item::as_array).into_iter().flatten();
        numbers.filter_map(Value::as_integer).map(|number| number as u64).collect()
    }

    /// Adds one that was the worst of a search.
    pub fn harder(&mut self, workload: &str, mission: u64) {
        self.harder.entry(workload.to_owned()).or_default().insert(mission);
    }

    /// Something that fails by itself.
    pub fn fail(&mut self, what: String) {
        self.failures.push(what);
    }

    /// Enters a figure. Returns whether it keeps its budget.
    pub fn figure(&mut self, place: Place<'_>, name: &str, measured: u64) -> bool {
        let row = self.row(place, name);
        let read = |key: &str| row.get(key).and_then(Item::as_integer).map(|it| it as u64);
        let place = format!("{}.{name}", place.join("."));
        if is_updating() {
            let goal = read("goal");
            if goal.is_some_and(|goal| measured > goal) {
                eprintln!("{place} misses its goal {goal:?}: {measured}");
            }
            set(row, "measured", measured);
            set(row, "budget", budget(measured, goal));
            return true;
        }
        let keeps = read("budget").is_some_and(|budget| measured <= budget);
        if !keeps {
            let allowed = read("budget").map_or_else(
                || "there is no budget for it".to_owned(),
                |it| format!("its budget is {}", grouped(it)),
            );
            self.failures.push(format!("{place}: measured {}, {allowed}", grouped(measured)));
        }
        keeps
    }

    /// Enters an estimate of the cycles of a figure: for the page, without a budget.
    pub fn cycles(&mut self, place: Place<'_>, name: &str, cycles: u64) {
        if is_updating() {
            set(self.row(place, name), "cycles", cycles);
        }
    }

    /// Enters a list. What is not in the file must not be in the list.
    pub fn list(&mut self, place: Place<'_>, name: &str, found: &[String]) {
        let row = self.row(place, name);
        if is_updating() {
            *row = if found.is_empty() { Item::None } else { value(array(found)) };
            return;
        }
        let known = row.as_array().into_iter().flatten().filter_map(Value::as_str);
        let known: Vec<_> = known.collect();
        let new = found.iter().filter(|it| !known.contains(&it.as_str()));
        let new: Vec<_> =
            new.map(|it| format!("{}.{name}: {it} is new", place.join("."))).collect();
        self.failures.extend(new);
    }

    fn row(&mut self, place: Place<'_>, name: &str) -> &mut Item {
        self.seen.insert([place[0], place[1], name].map(str::to_owned));
        let mut table = self.document.as_table_mut();
        for key in place {
            let below = table.entry(key).or_insert_with(|| {
                let mut below = Table::new();
                below.set_implicit(true);
                Item::Table(below)
            });
            table = below.as_table_mut().expect("a table");
        }
        table.entry(name).or_insert(Item::None)
    }

    /// Writes the file and the page, if that is asked for.
    ///
    /// # Panics
    /// With what was found, or if a file cannot be written.
    pub fn close(mut self) {
        let failures = self.failures.join("\n");
        assert!(self.failures.is_empty(), "{failures}\n{REMEDY}");
        if !is_updating() {
            return;
        }
        for [core, program] in columns(&self.document) {
            let seen = |name: &str| [&*core, &*program, name].map(str::to_owned);
            let is_measured = self.seen.iter().any(|it| it[..2] == [&*core, &*program]);
            let table = self.document[&core][&program].as_table_mut().expect("a table");
            table.retain(|name, _| !is_measured || self.seen.contains(&seen(name)));
        }
        for (workload, missions) in &self.harder {
            let numbers: Array = missions.iter().map(|number| *number as i64).collect();
            self.document[HARDEST][workload] = value(numbers);
        }
        fs::write(path(FILE), self.document.to_string()).expect("writes the figures");
        let page = fs::read_to_string(path(PAGE)).expect("the page");
        fs::write(path(PAGE), with_tables(&page, &self.document)).expect("writes the page");
    }
}

fn path(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(file)
}

/// What a figure may be: 3 % more, rounded up to three digits, but no more than a goal that it meets.
fn budget(measured: u64, goal: Option<u64>) -> u64 {
    let more = measured + (3 * measured).div_ceil(100);
    let digits = more.checked_ilog10().unwrap_or(0).saturating_sub(2);
    let budget = more.next_multiple_of(10_u64.pow(digits));
    goal.filter(|goal| measured <= *goal).map_or(budget, |goal| budget.min(goal))
}

/// Sets a number of a row, which is made where there is none.
fn set(row: &mut Item, key: &str, number: u64) {
    if !row.is_inline_table() {
        *row = value(InlineTable::new());
    }
    row[key] = value(number as i64);
}

fn array(lines: &[String]) -> Array {
    let mut array: Array = lines.iter().map(String::as_str).collect();
    for value in array.iter_mut() {
        value.decor_mut().set_prefix("\n    ");
    }
    array.set_trailing_comma(true);
    array.set_trailing("\n");
    array
}

/// Cores with their programs.
fn columns(document: &DocumentMut) -> Vec<[String; 2]> {
    let cores = document.iter().filter_map(|(core, of_core)| Some((core, of_core.as_table()?)));
    let programs = cores.flat_map(|(core, of_core)| {
        of_core.iter().filter(|it| it.1.is_table()).map(|it| [core.to_owned(), it.0.to_owned()])
    });
    programs.collect()
}

/// The page with its tables, each of which stands between two comments that name its cores.
fn with_tables(page: &str, document: &DocumentMut) -> String {
    let mut page = page.to_owned();
    for cores in [&["cortex-m4f"][..], &["cortex-m0", "riscv32imac"]] {
        let [begin, end] = ["", "/"].map(|mark| format!("<!-- {mark}{} -->", cores.join(" ")));
        let (before, rest) = page.split_once(&begin).expect("a place for a table");
        let (_, after) = rest.split_once(&end).expect("its end");
        page = format!("{before}{begin}\n{}{end}{after}", table(document, cores));
    }
    page
}

/// A column for each program, a row for each figure; cycles as time beside instructions.
fn table(document: &DocumentMut, cores: &[&str]) -> String {
    let mut columns = columns(document);
    columns.retain(|[core, _]| cores.contains(&&**core));
    let rows = |[core, program]: &[String; 2]| document[core][program].as_table().expect("a table");
    let mut names: Vec<&str> = Vec::new();
    for (name, row) in columns.iter().flat_map(|it| rows(it).iter()) {
        if row.get("measured").is_some() && !names.contains(&name) {
            names.push(name);
        }
    }
    let title = |[core, program]: &[String; 2]| match core.as_str() {
        "cortex-m0" => format!("M0, {program}"),
        "riscv32imac" => format!("RISC-V, {program}"),
        _ => program.clone(),
    };
    let titles: Vec<_> = columns.iter().map(title).collect();
    let mut text = format!("| | {} |\n| ---", titles.join(" | "));
    text += &(" | ---:".repeat(titles.len()) + " |\n");
    for name in names {
        let _ = write!(text, "| {} |", name.replace('_', " "));
        for column in &columns {
            let read = |key: &str| Some(rows(column).get(name)?.get(key)?.as_integer()? as u64);
            let figure = read("measured").map(grouped).unwrap_or_default();
            let ms = |it: u64| format!(", {:.2} ms", it as f64 / CYCLES_PER_MS);
            let _ = write!(text, " {figure}{} |", read("cycles").map(ms).unwrap_or_default());
        }
        text.push('\n');
    }
    text
}

/// An integer with commas.
fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    grouped
}
