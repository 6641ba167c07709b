//! Files that a scenario names. A browser has none: what is opened there was handed over before.

use std::io::{self, Read as _};
use std::path::Path;

#[cfg(not(target_family = "wasm"))]
pub use of_disk::{open, size};

#[cfg(target_family = "wasm")]
pub use handed::{hand, open, size};

/// A file, whole.
///
/// # Errors
/// When it cannot be read.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(not(target_family = "wasm"))]
mod of_disk {
    use std::fs::{self, File};
    use std::io;
    use std::path::Path;

    /// Opens a file.
    ///
    /// # Errors
    /// When it cannot be opened.
    pub fn open(path: &Path) -> io::Result<File> {
        File::open(path)
    }

    /// The bytes of a file. A device or a pipe may have no end.
    pub fn size(path: &Path) -> Option<u64> {
        fs::metadata(path).ok().filter(fs::Metadata::is_file).map(|it| it.len())
    }
}

#[cfg(target_family = "wasm")]
mod handed {
    use std::collections::BTreeMap;
    use std::io::{self, Cursor, ErrorKind};
    use std::path::{Path, PathBuf};
    use std::sync::{Mutex, MutexGuard, PoisonError};

    type Files = BTreeMap<PathBuf, Vec<u8>>;

    static FILES: Mutex<Files> = Mutex::new(Files::new());

    fn files() -> MutexGuard<'static, Files> {
        FILES.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on there is a file.
    pub fn hand(path: PathBuf, bytes: Vec<u8>) {
        files().insert(path, bytes);
    }

    /// Opens a file.
    ///
    /// # Errors
    /// When it was not handed over.
    pub fn open(path: &Path) -> io::Result<Cursor<Vec<u8>>> {
        files().get(path).cloned().map(Cursor::new).ok_or(ErrorKind::NotFound.into())
    }

    /// The bytes of a file.
    pub fn size(path: &Path) -> Option<u64> {
        files().get(path).map(|it| it.len() as u64)
    }
}
