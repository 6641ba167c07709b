//! `budgets.toml`: what every figure may be, what it was, and what the project wants it to be.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::sync::MutexGuard;

use toml_edit::{Array, DocumentMut, Item, Value};

use crate::budget::readme::{self, grouped};
use crate::is_long;

/// The file, from the workspace's root.
const FILE: &str = "tests/budgets.toml";

/// The chip's clock, cycles in a microsecond: it turns cycles into time.
const CYCLES_PER_US: f64 = 168.0;

/// How far above its figure the budget of a missed goal may be, per cent.
const SLACK: i64 = 5;

/// The file, and what was found against it.
#[derive(Debug)]
pub struct Budgets {
    document: DocumentMut,
    updating: bool,
    _alone: Option<MutexGuard<'static, ()>>,
    report: String,
    failures: Vec<String>,
    /// What was measured: section and name.
    seen: Vec<(String, String)>,
}

impl Budgets {
    /// Reads the file. With `UPDATE_EXPECT` set, what is measured will be committed.
    ///
    /// # Panics
    /// If it is not as it should be.
    pub fn open() -> Self {
        let alone = readme::one_at_a_time();
        let text = fs::read_to_string(root(FILE)).expect("tests/budgets.toml");
        let mut report = String::new();
        let titles = ["measured", "budget", "margin", "committed", "goal"];
        let [measured, budget, margin, committed, goal] = titles;
        let _ = writeln!(
            report,
            "{:<42}{measured:>10}{budget:>10}{margin:>8}  {committed:<12}{goal:>9}",
            "budgets"
        );
        Self {
            document: text.parse().expect("TOML"),
            updating: readme::is_updating(),
            _alone: alone,
            report,
            failures: Vec::new(),
            seen: Vec::new(),
        }
    }

    /// A line for the report alone.
    pub fn note(&mut self, line: &str) {
        let _ = writeln!(self.report, "{line}");
    }

    /// Something that fails by itself.
    pub fn fail(&mut self, what: String) {
        self.failures.push(what);
    }

    /// A figure that is the same on every machine.
    pub fn figure(&mut self, section: &str, name: &str, measured: u64) {
        self.enter(section, name, measured as i64, true);
    }

    /// A figure that depends on paths of this machine. It only has to keep its budget.
    pub fn figure_here(&mut self, section: &str, name: &str, measured: u64) {
        self.enter(section, name, measured as i64, false);
    }

    fn enter(&mut self, section: &str, name: &str, measured: i64, exact: bool) {
        self.seen.push((section.into(), name.into()));
        let place = format!("{section}.{name}");
        let Some(row) = self.document.get_mut(section).and_then(|it| it.get_mut(name)) else {
            self.failures.push(format!("{place} is not in {FILE}: it measures {measured}"));
            return;
        };
        let read = |key: &str| row.get(key).and_then(Item::as_integer);
        let (Some(budget), Some(committed)) = (read("budget"), read("committed")) else {
            self.failures.push(format!("{place} wants a budget and a committed figure"));
            return;
        };
        let goal = read("goal");
        let margin = 100.0 * (budget - measured) as f64 / budget.max(1) as f64;
        let change = match measured - committed {
            0 => "as before".into(),
            change => format!("{change:+}"),
        };
        let wanted = goal.map_or(String::new(), |goal| verdict(measured, goal));
        let _ = writeln!(
            self.report,
            "{place:<42}{measured:>10}{budget:>10}{margin:>7.1}%  {change:<12}{wanted}"
        );
        if measured > budget {
            self.failures.push(format!("{place} is over its budget: {measured}, {budget}"));
        }
        if let Some(goal) = goal {
            let most = goal.max(measured + measured * SLACK / 100);
            if budget > most {
                self.failures.push(format!(
                    "{place} has a budget looser than its goal: {budget}, at most {most}"
                ));
            }
        }
        if self.updating {
            if let Some(value) = row.get_mut("committed").and_then(Item::as_value_mut) {
                replace(value, measured.into());
            }
        } else if exact && measured != committed {
            self.failures.push(format!("{place} has changed: {measured}, committed {committed}"));
        }
    }

    /// A list that has to be as it is committed.
    pub fn list(&mut self, section: &str, name: &str, found: &[String]) {
        self.seen.push((section.into(), name.into()));
        let Some(value) = self
            .document
            .get_mut(section)
            .and_then(|it| it.get_mut(name))
            .and_then(Item::as_value_mut)
        else {
            self.failures.push(format!("{section}.{name} is not in {FILE}: {found:#?}"));
            return;
        };
        let committed: Vec<&str> =
            value.as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        if committed == found {
            return;
        }
        if self.updating {
            replace(value, array(found).into());
        } else {
            let new = found.iter().filter(|it| !committed.contains(&it.as_str()));
            let gone = committed.iter().filter(|it| !found.iter().any(|found| found == *it));
            let change: Vec<String> =
                new.map(|it| format!("+ {it}")).chain(gone.map(|it| format!("- {it}"))).collect();
            self.failures.push(format!("{section}.{name} has changed:\n  {}", change.join("\n  ")));
        }
    }

    /// The names of all sections but one.
    pub fn others(&self, section: &str) -> Vec<String> {
        let names = self.document.iter().map(|(name, _)| name.to_owned());
        names.filter(|name| name != section).collect()
    }

    /// Compares the readme's table, or writes both files. Returns the report and the failures. Sections in `skipped`
    /// could not be measured, and are left as they are.
    ///
    /// # Panics
    /// If the readme has no place for the table, or a file cannot be written.
    pub fn close(mut self, skipped: &[&str]) -> (String, Vec<String>) {
        for (section, rows) in self.document.iter() {
            for (name, _) in rows.as_table_like().into_iter().flat_map(|it| it.iter()) {
                let measured = self.seen.iter().any(|it| (&*it.0, &*it.1) == (section, name));
                if is_long() && !measured && !skipped.contains(&section) {
                    self.failures.push(format!("{section}.{name} is not measured"));
                }
            }
        }
        if !readme::write_or_compare("budgets", &table(&self.document)) {
            self.failures.push(format!("the readme's table is not that of {FILE}"));
        }
        if self.updating {
            fs::write(root(FILE), self.document.to_string()).expect("writes the budgets");
        }
        (self.report, self.failures)
    }
}

/// Whether a goal is met, and by how much not.
fn verdict(measured: i64, goal: i64) -> String {
    if measured <= goal {
        format!("{goal:>9} met")
    } else {
        let missed = 100.0 * (measured - goal) as f64 / goal as f64;
        format!("{goal:>9} missed by {missed:.0} %")
    }
}

/// Replaces a value, and keeps the space around it.
fn replace(value: &mut Value, mut by: Value) {
    *by.decor_mut() = value.decor().clone();
    *value = by;
}

fn array(lines: &[String]) -> Array {
    let mut array: Array = lines.iter().map(String::as_str).collect();
    for value in array.iter_mut() {
        value.decor_mut().set_prefix("\n    ");
    }
    if !lines.is_empty() {
        array.set_trailing_comma(true);
        array.set_trailing("\n");
    }
    array
}

/// The committed figures as a table: a column for each program, cycles as time beside instructions.
fn table(document: &DocumentMut) -> String {
    let programs = ["alone", "small", "medium", "standard", "large", "track", "watch", "firmware"];
    let read = |program: &str, name: &str| {
        document.get(program)?.get(name)?.get("committed")?.as_integer()
    };
    let mut names: Vec<&str> = Vec::new();
    for program in programs {
        let rows = document.get(program).and_then(Item::as_table_like);
        for (name, row) in rows.into_iter().flat_map(|it| it.iter()) {
            if row.get("committed").is_some()
                && !name.ends_with("_cycles")
                && !names.contains(&name)
            {
                names.push(name);
            }
        }
    }
    readme::table(&programs, &names, |program, name| {
        let figure = grouped(read(programs[program], name)?);
        let cycles = read(programs[program], &format!("{name}_cycles"));
        let time = cycles
            .map_or(String::new(), |it| format!(", {:.2} ms", it as f64 / CYCLES_PER_US / 1_000.0));
        Some(figure + &time)
    })
}

fn root(file: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file)
}
