//! A file that grows beside its place, perhaps for hours. It outlives an interruption, and a later run can continue it.
//! When it is complete, it is moved to its place.
//!
//! If the file does not show by itself which work it belongs to, a record beside it does. So nobody continues the file
//! of another task. The record also contains checksums (`ledger`), so nobody continues a file that was changed. The
//! record is written before the file, and removed when the file is complete.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read as _, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow, bail};

use crate::output::checksum::Checksum;
use crate::output::file::{Output, hand_on_permissions, prepare, refusal};
use crate::output::interruption::unfinished;
use crate::output::ledger::Ledger;
use crate::output::place::Place;

/// A file that is not complete. When this is dropped the file stays, unless this run created it and wrote only a
/// header.
#[derive(Debug)]
pub struct Partial {
    place: PathBuf,
    path: PathBuf,
    record: Option<PathBuf>,
    ledger: Option<Ledger>,
    file: File,
    /// How many of its bytes are as they were written.
    counted: u64,
    /// As the file's user names it.
    name: String,
    /// What it holds.
    holds: &'static str,
    is_worth_keeping: bool,
}

/// What is to be written.
#[derive(Clone, Copy)]
pub struct Begin<'a> {
    /// What it holds, in the plural: rows, steps.
    pub holds: &'static str,
    /// What it begins with.
    pub header: &'a str,
    /// The record of the work, if the file does not show by itself which work it belongs to.
    pub record: Option<Record<'a>>,
    /// Whether to continue an existing file.
    pub resume: bool,
}

/// The record of the work, which stands beside the file.
#[derive(Clone, Copy)]
pub struct Record<'a> {
    /// The record.
    pub text: &'a str,
    /// Checks an existing record.
    pub check: &'a dyn Fn(&str) -> Result<()>,
}

/// Checks an existing file by its record and checksums, and returns how many of its bytes are as they were written.
fn judge(
    ledger: &Ledger,
    check: &dyn Fn(&str) -> Result<()>,
    path: &Path,
    name: &str,
) -> Result<u64> {
    let anew = || format!("remove {name} and {name}.json to begin anew");
    let record = ledger.record().with_context(|| format!("{name}.json"))?;
    let Some(record) = record else {
        bail!("{name}.json: found a record that was cut off, expected a whole one: {}", anew());
    };
    let judged = check(&record).and_then(|()| ledger.verify(path));
    judged.map_err(|why| anyhow!("{name}: {why:#}: {}", anew()))
}

/// A path with something after it.
pub fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut path = OsString::from(path);
    path.push(suffix);
    path.into()
}

impl Partial {
    /// Begins a file, or opens an existing one to continue it.
    ///
    /// # Errors
    /// Names the file if its finished work exists, or if it exists although none is to be continued. Also if another program is writing it, or if it
    /// cannot be written.
    pub fn open(path: &Path, place: &Place, begin: Begin) -> Result<Self> {
        check_free(path, place, begin.holds)?;
        let name = with_suffix(path, ".partial").display().to_string();
        let path = with_suffix(place.path(), ".partial");
        let record = begin.record.map(|_| with_suffix(place.path(), ".partial.json"));
        let is_there = path.try_exists().with_context(|| name.clone())?;
        if is_there && !begin.resume {
            bail!(
                "{name}: found {} of a campaign that was stopped, expected --resume to go on with them, or that \
                 they are removed",
                begin.holds
            );
        }
        let mut ledger = None;
        if let (Some(Record { text, .. }), Some(record), false) = (begin.record, &record, is_there)
        {
            let begun = Ledger::begin(record, text);
            ledger = Some(
                begun.map_err(|error| refusal(&with_suffix(Path::new(&name), ".json"), &error))?,
            );
        }
        let mut options = OpenOptions::new();
        let file = options.read(true).append(true).create_new(!is_there).open(&path);
        let file = file.map_err(|error| refusal(Path::new(&name), &error))?;
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            bail!("{name}: found another program writing it, expected none");
        }
        let mut counted = file.metadata().with_context(|| name.clone())?.len();
        if let (Some(Record { check, .. }), Some(record), true) = (begin.record, &record, is_there)
        {
            let expected = || {
                format!("{name}.json: expected the record of {name}: remove {name} to begin anew")
            };
            let found = Ledger::open(record).with_context(expected)?;
            counted = judge(&found, check, &path, &name)?;
            ledger = Some(found);
        }
        let (place, holds) = (place.path().to_owned(), begin.holds);
        let is_worth_keeping = is_there;
        let mut partial =
            Self { place, path, record, ledger, file, counted, name, holds, is_worth_keeping };
        partial.begin(begin.header).with_context(|| partial.name.clone())?;
        Ok(partial)
    }

    /// Writes the header if it is not there in full.
    fn begin(&mut self, header: &str) -> Result<()> {
        if self.counted < header.len() as u64 {
            let mut found = Vec::new();
            File::open(&self.path)?.take(header.len() as u64).read_to_end(&mut found)?;
            if !header.as_bytes().starts_with(&found) {
                bail!(
                    "found something else than {} under their header, expected them: remove the file to begin anew",
                    self.holds
                );
            }
            self.cut(0)?;
            self.file.write_all(header.as_bytes())?;
            self.note(header.as_bytes())?;
            self.counted = header.len() as u64;
        }
        Ok(())
    }

    /// What its user calls it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Reads the file from its start: this many bytes, but none that may have changed.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn reader(&self, bytes: u64) -> io::Result<io::Take<File>> {
        Ok(File::open(&self.path)?.take(bytes.min(self.counted)))
    }

    /// Cuts the file to this many bytes.
    ///
    /// # Errors
    /// When it cannot be cut.
    pub fn cut(&mut self, bytes: u64) -> io::Result<()> {
        self.file.set_len(bytes)?;
        self.ledger.as_mut().map_or(Ok(()), |it| it.cut(&self.path, bytes))
    }

    /// Notes that the file has grown.
    fn note(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.ledger.as_mut().map_or(Ok(()), |it| it.grown(bytes))
    }

    /// From now on the message at an interruption names this file.
    pub fn announce(&self) {
        unfinished().farewell = Some(format!("stopped: {}", self.farewell()));
    }

    /// Where to find what is finished.
    pub fn farewell(&self) -> String {
        let Self { holds, name, .. } = self;
        format!("finished {holds} are in {name}; the same command with --resume goes on with them")
    }

    /// Moves it to its place. `beside` makes the record that stays beside it from its length and checksum.
    ///
    /// # Errors
    /// Names the file that could not be written or moved.
    pub fn complete(
        &self,
        beside: impl FnOnce(u64, Option<Checksum>) -> Option<String>,
    ) -> Result<()> {
        let named = || self.name.clone();
        let bytes = self.file.metadata().with_context(named)?.len();
        if let Some(record) = beside(bytes, self.ledger.as_ref().map(Ledger::checksum)) {
            let path = with_suffix(&self.place, ".json");
            let [output] = prepare(&[], [("the record", Some(&path))])?;
            output.map_or(Ok(()), |it: Output| it.write(record))?;
        }
        hand_on_permissions(&self.path, &self.place).with_context(named)?;
        let mut unfinished = unfinished();
        unfinished.farewell = None;
        fs::rename(&self.path, &self.place).with_context(named)?;
        self.record.as_ref().map_or(Ok(()), fs::remove_file).with_context(named)
    }
}

/// Checks that no finished work is at a place. A file without content is none.
///
/// # Errors
/// Names the file that is there.
pub fn check_free(path: &Path, place: &Place, holds: &str) -> Result<()> {
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
        let written = self.file.write(bytes)?;
        self.note(&bytes[..written])?;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Partial {
    fn drop(&mut self) {
        if !self.is_worth_keeping {
            // Errors are ignored: the caller already reports another one.
            let _ = fs::remove_file(&self.path);
            let _ = self.record.as_ref().map_or(Ok(()), fs::remove_file);
        }
        // Closing is not enough: a child that another thread starts holds the file until it executes. If this fails,
        // the lock ends then.
        let _ = self.file.unlock();
    }
}
