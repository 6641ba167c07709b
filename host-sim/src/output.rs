//! Output: records as text, and files that are written whole or not at all.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde::Serialize;
use tempfile::NamedTempFile;

/// A record as a line of JSON.
///
/// # Panics
/// Never for the records of this crate: plain structures whose keys are strings.
pub fn json(record: &impl Serialize) -> String {
    serde_json::to_string(record).expect("a plain structure") + "\n"
}

/// Records as CSV, under a header.
///
/// # Errors
/// When a record could not be written.
pub fn csv(records: &[impl Serialize]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for record in records {
        writer.serialize(record)?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// A file that is to be written. It is opened beside its place before any work is done, so that a
/// place that cannot be written to is found at once, and moved there when it is complete.
#[derive(Debug)]
pub struct Output {
    path: PathBuf,
    file: NamedTempFile,
}

impl Output {
    /// Prepares to write a file.
    ///
    /// # Errors
    /// Names the file when its place cannot be written to.
    pub fn create(path: &Path) -> Result<Self> {
        let refuse = || format!("{}: expected a place to write a file", path.display());
        if path.is_dir() {
            anyhow::bail!("{}: found a directory, expected a file", path.display());
        }
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let file = NamedTempFile::new_in(folder).with_context(refuse)?;
        Ok(Self { path: path.to_owned(), file })
    }

    /// Prepares to write a file if its path is given.
    ///
    /// # Errors
    /// As [`create`](Self::create).
    pub fn create_if(path: Option<&PathBuf>) -> Result<Option<Self>> {
        path.map(|path| Self::create(path)).transpose()
    }

    /// Writes the file, in place of one that may be there.
    ///
    /// # Errors
    /// Names the file that could not be written.
    pub fn write(mut self, content: &str) -> Result<()> {
        let name = self.path.display().to_string();
        self.file.write_all(content.as_bytes()).context(name.clone())?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            // Temporary files are private; a result is an ordinary file.
            let ordinary = fs::Permissions::from_mode(0o644);
            fs::set_permissions(self.file.path(), ordinary).context(name.clone())?;
        }
        self.file.persist(&self.path).context(name)?;
        Ok(())
    }
}
