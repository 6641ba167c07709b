//! The destination of a path: a file, which may not exist yet, or a stream; and whether two paths lead to the same one.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use anyhow::{Error, anyhow};

use crate::output::kind;

/// Symbolic links that a path may lead through, as many as Linux follows.
const MOST_LINKS: usize = 40;

/// Where the process's own descriptors stand. What looks like a file there may be a stream.
const DESCRIPTORS: [&str; 2] = ["/proc", "/dev/fd"];

/// Where a path leads in the end.
#[derive(Clone, Debug)]
pub struct Place {
    /// Absolute and without symbolic links, but for those that name a descriptor.
    path: PathBuf,
    /// A pipe or a device: to be written through, as it cannot be replaced.
    is_stream: bool,
    /// The file system's number for it, the same under all its names; `None` if nothing is there.
    node: Option<Node>,
}

/// A file system's number and the file's number in it.
type Node = (u64, u64);

impl Place {
    /// Follows a path through symbolic links. The file at its end need not exist.
    ///
    /// # Errors
    /// When a link on the way cannot be read.
    pub fn of(path: &Path) -> io::Result<Self> {
        let mut path = path.to_owned();
        for _ in 0..MOST_LINKS {
            let name = path.file_name().ok_or(ErrorKind::InvalidFilename)?.to_owned();
            let folder = fs::canonicalize(folder(&path))?;
            path = folder.join(name);
            let is_stream = match fs::symlink_metadata(&path) {
                _ if DESCRIPTORS.iter().any(|place| folder.starts_with(place)) => true,
                Ok(found) if found.is_symlink() => {
                    path = folder.join(fs::read_link(&path)?);
                    continue;
                }
                Ok(found) => !found.is_file(),
                Err(error) if error.kind() == ErrorKind::NotFound => false,
                Err(error) => return Err(error),
            };
            return Ok(Self { node: node(fs::metadata(&path)), path, is_stream });
        }
        Err(io::Error::other("it leads through too many symbolic links"))
    }

    /// The path without symbolic links.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder that it stands in.
    pub fn folder(&self) -> &Path {
        folder(&self.path)
    }

    /// Whether it is a pipe or a device.
    pub fn is_stream(&self) -> bool {
        self.is_stream
    }

    /// Whether both are the same place, under whatever names.
    pub fn is(&self, other: &Self) -> bool {
        self.path == other.path || (self.node.is_some() && self.node == other.node)
    }

    /// Opens a stream. A pipe waits for its reader.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn open_stream(&self) -> io::Result<File> {
        match self.node.and_then(own_stream) {
            // Opened a second time, a redirected one would begin anew at its start.
            Some(own) => Ok(own),
            None => OpenOptions::new().write(true).open(&self.path),
        }
    }
}

/// Why nothing can be written at a path.
pub(crate) fn refusal(path: &Path, error: &io::Error) -> Error {
    anyhow!(
        "{}: found {}, expected a place to write a file",
        path.display(),
        kind::unwritten(error)
    )
}

/// Gives a file the permissions of the one that it replaces.
pub(crate) fn hand_on_permissions(to: &Path, replaced: &Path) -> io::Result<()> {
    fs::metadata(replaced).map_or(Ok(()), |it| fs::set_permissions(to, it.permissions()))
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(unix)]
fn node(found: io::Result<Metadata>) -> Option<Node> {
    use std::os::unix::fs::MetadataExt as _;
    let found = found.ok()?;
    Some((found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn node(_: io::Result<Metadata>) -> Option<Node> {
    None
}

/// Standard output or standard error, if that is what stands there.
#[cfg(unix)]
fn own_stream(wanted: Node) -> Option<File> {
    use std::os::fd::AsFd as _;
    let (stdout, stderr) = (io::stdout(), io::stderr());
    let copies = [stdout.as_fd(), stderr.as_fd()].map(|own| own.try_clone_to_owned());
    let mut own = copies.into_iter().flatten().map(File::from);
    own.find(|own| node(own.metadata()) == Some(wanted))
}

#[cfg(not(unix))]
fn own_stream(_: Node) -> Option<File> {
    None
}
