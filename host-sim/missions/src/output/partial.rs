//! A file that grows beside its place, perhaps for hours. It outlives an interruption, and a later run may continue it.
//! When it is complete, it is moved to its place.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};

use crate::output::interruption::unfinished;
use crate::output::place::{Place, hand_on_permissions, refusal};

/// A file that is not complete. When this is dropped the file stays, unless this run created it and wrote only a
/// header.
#[derive(Debug)]
pub struct Partial {
    place: PathBuf,
    path: PathBuf,
    file: File,
    /// As the file's user names it.
    name: String,
    begin: Begin,
    is_worth_keeping: bool,
}

/// What is to be written.
#[derive(Clone, Copy, Debug)]
pub struct Begin {
    /// What it holds, in the plural: rows, steps.
    pub holds: &'static str,
    /// What goes on after an interruption.
    pub goes_on: &'static str,
    /// Whether to continue an existing file.
    pub resume: bool,
}

impl Partial {
    /// Begins a file with its header, or opens an existing one to continue it.
    ///
    /// # Errors
    /// Names the file if its finished work exists, or if it exists although none is to be continued. Also if another program is writing it, or if it
    /// cannot be written.
    pub fn open(path: &Path, place: &Place, header: &str, begin: Begin) -> Result<Self> {
        check_free(path, place, begin.holds)?;
        let beside = |path: &Path| {
            let mut path = OsString::from(path);
            path.push(".partial");
            PathBuf::from(path)
        };
        let name = beside(path).display().to_string();
        let path = beside(place.path());
        let is_there = path.try_exists().with_context(|| name.clone())?;
        if is_there && !begin.resume {
            let Begin { holds, goes_on, .. } = begin;
            bail!(
                "{name}: found {holds} of a command that was stopped, expected none: remove the file or give it another \
                 name; {goes_on}"
            );
        }
        let mut options = OpenOptions::new();
        let file = options.read(true).append(true).create_new(!is_there).open(&path);
        let file = file.map_err(|error| refusal(Path::new(&name), &error))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            bail!("{name}: found another program writing it, expected none");
        }
        let place = place.path().to_owned();
        let mut partial = Self { place, path, file, name, begin, is_worth_keeping: is_there };
        partial.begin(header).with_context(|| partial.name.clone())?;
        Ok(partial)
    }

    /// Writes the header if it is not there in full.
    fn begin(&mut self, header: &str) -> Result<()> {
        if self.file.metadata()?.len() < header.len() as u64 {
            let mut found = Vec::new();
            self.reader()?.read_to_end(&mut found)?;
            if !header.as_bytes().starts_with(&found) {
                bail!(
                    "found something else than {} under their header, expected them: remove the file to begin anew",
                    self.begin.holds
                );
            }
            self.cut(0)?;
            self.file.write_all(header.as_bytes())?;
        }
        Ok(())
    }

    /// What its user calls it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Reads the file from its start.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn reader(&self) -> io::Result<File> {
        File::open(&self.path)
    }

    /// Cuts the file to this many bytes.
    ///
    /// # Errors
    /// When it cannot be cut.
    pub fn cut(&mut self, bytes: u64) -> io::Result<()> {
        self.file.set_len(bytes)
    }

    /// From now on the message at an interruption names this file.
    pub fn announce(&self) {
        unfinished().farewell = Some(format!("stopped: {}", self.farewell()));
    }

    /// Where to find what is finished.
    pub fn farewell(&self) -> String {
        let Self { name, begin: Begin { holds, goes_on, .. }, .. } = self;
        format!("finished {holds} are in {name}; {goes_on}")
    }

    /// Moves it to its place.
    ///
    /// # Errors
    /// Names the file that could not be moved.
    pub fn complete(&self) -> Result<()> {
        let named = || self.name.clone();
        hand_on_permissions(&self.path, &self.place).with_context(named)?;
        let mut unfinished = unfinished();
        unfinished.farewell = None;
        fs::rename(&self.path, &self.place).with_context(named)
    }
}

/// Checks that no finished work is at a place. A file without content is none.
///
/// # Errors
/// Names the file that is there.
fn check_free(path: &Path, place: &Place, holds: &str) -> Result<()> {
    if place.is_stream() || fs::metadata(place.path()).is_ok_and(|it| it.len() == 0) {
        return Ok(());
    }
    if place.path().try_exists().with_context(|| path.display().to_string())? {
        bail!(
            "{}: found a file, and {holds} are never replaced; expected none there: remove it, or name another",
            path.display()
        );
    }
    Ok(())
}

impl Write for Partial {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.is_worth_keeping = true;
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if !self.is_worth_keeping {
            // An error is ignored: the caller already reports another one.
            let _ = fs::remove_file(&self.path);
        }
        // Closing is not enough: a child that another thread starts holds the file until it executes. If this fails,
        // the lock ends then.
        let _ = self.file.unlock();
    }
}
