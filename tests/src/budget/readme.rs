//! Tables in the readme: each stands between two comments that name it, and is written anew from committed figures.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{env, fs};

/// Whether what is measured is committed (`UPDATE_EXPECT`).
pub fn is_updating() -> bool {
    env::var_os("UPDATE_EXPECT").is_some()
}

/// Where figures are committed, tests wait here for each other: they write the same files.
pub fn one_at_a_time() -> Option<MutexGuard<'static, ()>> {
    static BOOKS: Mutex<()> = Mutex::new(());
    is_updating().then(|| BOOKS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// A row for each figure, a column for each program; `cell` is what a program has of a figure, or nothing.
pub fn table(
    programs: &[&str],
    figures: &[&str],
    cell: impl Fn(usize, &str) -> Option<String>,
) -> String {
    let columns = " ---: |".repeat(programs.len());
    let mut table = format!("| | {} |\n| --- |{columns}\n", programs.join(" | "));
    for figure in figures {
        let _ = write!(table, "| {} |", figure.replace('_', " "));
        for program in 0..programs.len() {
            let _ = write!(table, " {} |", cell(program, figure).unwrap_or_default());
        }
        table.push('\n');
    }
    table
}

/// An integer with commas.
pub fn grouped(value: i64) -> String {
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

/// Writes the table of a name if figures are committed anew (`UPDATE_EXPECT`). Otherwise returns whether the readme has
/// this table.
///
/// # Panics
/// If the readme has no place for it, or cannot be written.
pub fn write_or_compare(name: &str, table: &str) -> bool {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md");
    let readme = fs::read_to_string(&path).expect("the readme");
    let [begin, end] = [format!("<!-- {name} -->\n"), format!("<!-- /{name} -->")];
    let (before, rest) = readme.split_once(&begin).expect("a place for the table");
    let (_, after) = rest.split_once(&end).expect("its end");
    let wanted = format!("{before}{begin}{table}{end}{after}");
    if is_updating() {
        fs::write(path, wanted).expect("writes the readme");
        return true;
    }
    wanted == readme
}
