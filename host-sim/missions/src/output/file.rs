//! Output: records as text, and files that are written whole or not at all.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow, bail};
use serde::Serialize;
use tempfile::NamedTempFile;

use crate::output::ending;
use crate::output::interruption::unfinished;
use crate::output::kind;
use crate::output::notes::mention;
use crate::output::partial::{Begin, Partial};
use crate::output::place::{Place, hand_on_permissions, refusal};

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

/// A temporary file. It is removed when this value is dropped or the program is interrupted. Its permissions follow the
/// user's umask.
///
/// # Errors
/// When the folder cannot be written to.
pub fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    #[cfg_attr(not(unix), expect(unused_mut, reason = "only Unix has permissions to set"))]
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut unfinished = unfinished();
    let file = builder.tempfile_in(folder)?;
    unfinished.files.insert(file.path().to_owned());
    Ok(file)
}

/// What a command writes: a file or a stream.
#[derive(Debug)]
pub struct Output {
    name: String,
    to: Destination,
}

#[derive(Debug)]
enum Destination {
    /// Begun beside its place, and moved there when it is complete.
    File { place: PathBuf, begun: NamedTempFile },
    /// The same, and an interruption leaves what is there of it.
    Growing(Partial),
    /// Written through.
    Stream(File),
}

/// As [`prepare_all`], of so many outputs.
///
/// # Errors
/// As that.
pub fn prepare<const N: usize>(
    inputs: &[(&str, &Path)],
    asked: [(&str, Option<&Path>); N],
) -> Result<[Option<Output>; N]> {
    let mut outputs = prepare_all(inputs, &asked)?.into_iter();
    Ok([(); N].map(|()| outputs.next().flatten()))
}

/// Prepares everything that a command writes. A place that cannot be written to is found before any work is done. The
/// result is `None` for an output that was not asked for. Inputs and outputs come with their names for messages.
///
/// # Errors
/// Names the place that cannot be written to, or that is an input or another output as well.
pub fn prepare_all(
    inputs: &[(&str, &Path)],
    asked: &[(&str, Option<&Path>)],
) -> Result<Vec<Option<Output>>> {
    // An input that is not there is for its reader to complain of.
    let mut taken: Vec<(String, Place)> = inputs
        .iter()
        .filter_map(|(what, path)| Some(((*what).to_owned(), Place::of(path).ok()?)))
        .collect();
    let mut places = vec![None; asked.len()];
    for (&(what, path), place) in asked.iter().zip(&mut places) {
        let Some(path) = path else { continue };
        let found = place_for(path)?;
        if let Some((other, _)) = taken.iter().find(|(_, other)| other.is(&found)) {
            bail!("{}: found {other}, expected a place of its own for {what}", path.display());
        }
        ending::check(what, path)?;
        taken.push((format!("the place of {what}"), found.clone()));
        *place = Some(found);
    }
    // Opening a pipe waits for its reader, so everything else is checked first.
    let output = |((_, path), place): (&(&str, Option<&Path>), Option<Place>)| {
        let opened = path
            .zip(place)
            .map(|(path, place)| Output::at(path, &place).map_err(|error| refusal(path, &error)));
        opened.transpose()
    };
    asked.iter().zip(places).map(output).collect()
}

/// Where a path leads, if a file can be written there.
///
/// # Errors
/// Why none can.
pub fn place_for(path: &Path) -> Result<Place> {
    if path.is_dir() || path.as_os_str().as_encoded_bytes().ends_with(b"/") {
        bail!("{}: found a directory, expected a file", path.display());
    }
    Place::of(path).map_err(|error| refusal(path, &error))
}

/// Makes a folder and those above it.
///
/// # Errors
/// Names the folder, and the flag that asks for it.
pub fn make_folder(flag: &str, folder: &Path) -> Result<()> {
    fs::create_dir_all(folder).map_err(|error| {
        let (name, found) = (folder.display(), kind::unwritten(&error));
        anyhow!("{flag}{name}: found {found}, expected a place to make a folder")
    })
}

impl Output {
    fn at(path: &Path, place: &Place) -> io::Result<Self> {
        let to = if place.is_stream() {
            Destination::Stream(place.open_stream()?)
        } else {
            let (begun, place) = (temporary(place.folder())?, place.path().to_owned());
            Destination::File { place, begun }
        };
        Ok(Self { name: path.display().to_string(), to })
    }

    /// A file that grows under a header, perhaps for hours, or a stream.
    ///
    /// # Errors
    /// Names the file that is there already, or that cannot be written.
    pub fn growing(path: &Path, header: &str, begin: Begin) -> Result<Self> {
        let place = place_for(path)?;
        if place.is_stream() {
            let mut output = Self::at(path, &place).map_err(|error| refusal(path, &error))?;
            output.write_all(header.as_bytes())?;
            return Ok(output);
        }
        let partial = Partial::open(path, &place, header, begin)?;
        partial.announce();
        Ok(Self { name: path.display().to_string(), to: Destination::Growing(partial) })
    }

    /// Writes all of it, and replaces a file that exists.
    ///
    /// # Errors
    /// Names the file that could not be written.
    pub fn write(mut self, content: impl AsRef<[u8]>) -> Result<()> {
        let content = content.as_ref();
        self.write_all(content).with_context(|| self.name.clone())?;
        let name = self.name.clone();
        self.complete()?;
        mention(format_args!("{name}: written, {} bytes", content.len()));
        Ok(())
    }

    /// Everything is written: moves the file to its place.
    ///
    /// # Errors
    /// Names the file that could not be moved there.
    pub fn complete(self) -> Result<()> {
        match self.to {
            Destination::File { place, begun } => replace(&place, begun).context(self.name),
            Destination::Growing(partial) => partial.complete(),
            Destination::Stream(_) => Ok(()),
        }
    }
}

/// Writes piece by piece. [`complete`](Output::complete) must follow.
impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.to {
            Destination::File { begun, .. } => begun.write(bytes),
            Destination::Growing(partial) => partial.write(bytes),
            Destination::Stream(stream) => match stream.write(bytes) {
                // Whoever reads may stop early.
                Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(bytes.len()),
                written => written,
            },
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Moves a complete file to its place.
fn replace(place: &Path, begun: NamedTempFile) -> io::Result<()> {
    hand_on_permissions(begun.path(), place)?;
    let mut unfinished = unfinished();
    unfinished.files.remove(begun.path());
    begun.persist(place)?;
    Ok(())
}
