//! The ledger beside a file that grows, as JSON Lines. It begins with a record of the work in progress. Each time the
//! file has grown, a checkpoint follows: the file's length and the checksum of all of it.
//!
//! After an interruption the checkpoints tell which bytes of the file are as they were written. The end of either file
//! may be lost. Bytes after the last checkpoint are ignored.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead as _, BufReader, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use serde::{Deserialize, Serialize};

use crate::output::checksum::Checksum;
use crate::output::file::json;

/// A file's length, and the checksum of so much of it.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Checkpoint {
    bytes: u64,
    checksum: Checksum,
}

/// The record and the checkpoints of a file that is being written.
#[derive(Debug)]
pub(crate) struct Ledger {
    path: PathBuf,
    file: File,
    now: Checkpoint,
}

/// How much of a file is as it was written.
struct Verified {
    /// The last checkpoint that holds.
    last: Checkpoint,
    /// Bytes of the ledger up to it.
    ledger: u64,
    /// The lines that were changed, first and last, if any were.
    changed: Option<(u64, u64)>,
}

impl Ledger {
    /// Begins a ledger for an empty file.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn begin(path: &Path, record: &str) -> io::Result<Self> {
        fs::write(path, record)?;
        Self::open(path)
    }

    /// Opens an existing ledger.
    ///
    /// # Errors
    /// When it cannot be read or written.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().append(true).open(path)?;
        Ok(Self { path: path.to_owned(), file, now: Checkpoint::default() })
    }

    /// Its first line, if that is whole.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(crate) fn record(&self) -> io::Result<Option<String>> {
        let mut line = Vec::new();
        BufReader::new(File::open(&self.path)?).read_until(b'\n', &mut line)?;
        let is_whole = line.ends_with(b"\n") && !line.contains(&0);
        Ok(String::from_utf8(line).ok().filter(|_| is_whole))
    }

    /// How many bytes of a file are as they were written.
    ///
    /// # Errors
    /// Names the lines that are not as they were written.
    pub(crate) fn verify(&self, file: &Path) -> Result<u64> {
        let Verified { last, changed, .. } = self.walk(File::open(file)?, u64::MAX)?;
        if let Some((from, to)) = changed {
            bail!("found lines {from} to {to} that do not fit their checksum");
        }
        Ok(last.bytes)
    }

    /// Notes that the file was cut to this many bytes.
    ///
    /// # Errors
    /// When either cannot be read, or this cannot be noted.
    pub(crate) fn cut(&mut self, file: &Path, bytes: u64) -> io::Result<()> {
        let Verified { last, ledger, .. } = self.walk(File::open(file)?, bytes)?;
        self.file.set_len(ledger)?;
        self.now = last;
        let (mut file, mut rest) = (File::open(file)?, Vec::new());
        file.seek(SeekFrom::Start(last.bytes))?;
        file.read_to_end(&mut rest)?;
        if rest.is_empty() { Ok(()) } else { self.grown(&rest) }
    }

    /// Notes that the file has grown by these bytes.
    ///
    /// # Errors
    /// When it cannot be noted.
    pub(crate) fn grown(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.now.add(bytes);
        self.file.write_all(json(&self.now).as_bytes())
    }

    /// The checksum of the whole file.
    pub(crate) fn checksum(&self) -> Checksum {
        self.now.checksum
    }

    /// Compares a file with the checkpoints. Stops at one that is cut off, or is beyond the file's end or beyond `most`
    /// bytes.
    fn walk(&self, file: File, most: u64) -> io::Result<Verified> {
        let mut file = BufReader::new(file);
        let mut lines = BufReader::new(File::open(&self.path)?);
        let mut line = Vec::new();
        let mut ledger = lines.read_until(b'\n', &mut line)? as u64;
        let (mut last, mut read) = (Checkpoint::default(), Checkpoint::default());
        let mut number = 1;
        loop {
            line.clear();
            lines.read_until(b'\n', &mut line)?;
            let noted = line.strip_suffix(b"\n").and_then(|it| serde_json::from_slice(it).ok());
            let Some(noted): Option<Checkpoint> =
                noted.filter(|it: &Checkpoint| it.bytes > read.bytes)
            else {
                break;
            };
            if noted.bytes > most {
                break;
            }
            let mut part = Vec::new();
            let wanted = noted.bytes - read.bytes;
            if (file.by_ref().take(wanted).read_to_end(&mut part)? as u64) < wanted {
                break;
            }
            read.add(&part);
            let from = number;
            number += part.split(|byte| *byte == b'\n').count() as u64 - 1;
            if read.checksum != noted.checksum {
                // After a loss of power there are zeros where nothing had been written yet.
                let changed = (!part.contains(&0)).then_some((from, number));
                return Ok(Verified { last, ledger, changed });
            }
            (last, ledger) = (noted, ledger + line.len() as u64);
        }
        Ok(Verified { last, ledger, changed: None })
    }
}

impl Checkpoint {
    fn add(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        self.checksum.add(bytes);
    }
}
