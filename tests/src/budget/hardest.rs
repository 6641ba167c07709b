//! `hardest.toml`: for each workload, the worst missions of a long run, one for each figure.
//!
//! A long run finds them among thousands. All other runs fly only these, and so reach the same worst case.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use toml_edit::{Array, DocumentMut, Item, Value, value};

use crate::budget::readme;
use crate::is_long;

const FILE: &str = "hardest.toml";

/// The file, and what a long run found.
#[derive(Debug)]
pub struct Hardest {
    document: DocumentMut,
    found: BTreeMap<String, BTreeSet<u64>>,
}

impl Hardest {
    /// Reads the file.
    ///
    /// # Panics
    /// If it is not as it should be.
    pub fn open() -> Self {
        let text = fs::read_to_string(path()).expect("tests/hardest.toml");
        Self { document: text.parse().expect("TOML"), found: BTreeMap::new() }
    }

    /// The missions of a workload.
    pub fn of(&self, workload: &str) -> Vec<u64> {
        let numbers = self.document.get(workload).and_then(Item::as_array).into_iter().flatten();
        numbers.filter_map(Value::as_integer).map(|number| number as u64).collect()
    }

    /// Adds missions that were the worst of a long run.
    pub fn add(&mut self, workload: &str, missions: impl IntoIterator<Item = u64>) {
        self.found.entry(workload.to_owned()).or_default().extend(missions);
    }

    /// Writes what a long run found, if that is to be committed.
    ///
    /// # Panics
    /// If the file cannot be written.
    pub fn close(mut self) {
        if !readme::is_updating() || !is_long() {
            return;
        }
        for (workload, missions) in &self.found {
            let numbers: Array = missions.iter().map(|number| *number as i64).collect();
            self.document.insert(workload, value(numbers));
        }
        fs::write(path(), self.document.to_string()).expect("writes the missions");
    }
}

fn path() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE)
}
