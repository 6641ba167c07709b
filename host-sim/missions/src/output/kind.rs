//! What a file is, by how it begins, and why one cannot be read or written; for messages.

use std::io::{self, ErrorKind};

/// A scenario, or what is meant as one.
pub const TOML: &str = "a scenario (TOML)";

/// What a file contains.
pub fn of(content: &[u8]) -> &'static str {
    let Some(text) = str::from_utf8(content).ok().filter(|it| !it.contains('\0')) else {
        return "a binary file";
    };
    let mut lines = text.lines().map(str::trim).filter(|it| !it.is_empty() && !it.starts_with('#'));
    match lines.next() {
        None => "an empty file",
        Some(line) if line.starts_with('{') => "JSON",
        Some(line) if line.starts_with('<') => "XML",
        Some(line) if line.starts_with('[') || line.contains('=') => TOML,
        Some(line) if line.contains([',', ';', '\t', '|']) => "a table (CSV)",
        Some(_) => TOML,
    }
}

/// What was found in place of a file to read.
pub fn unread(error: &io::Error) -> String {
    found(error, "no such file")
}

/// What was found in place of a folder to write into.
pub fn unwritten(error: &io::Error) -> String {
    found(error, "no such folder")
}

fn found(error: &io::Error, none: &str) -> String {
    match error.kind() {
        ErrorKind::NotFound => none.to_owned(),
        ErrorKind::IsADirectory => "a directory".to_owned(),
        ErrorKind::NotADirectory => "a file in place of a folder".to_owned(),
        ErrorKind::PermissionDenied => "no permission".to_owned(),
        ErrorKind::AlreadyExists => "a file".to_owned(),
        ErrorKind::InvalidData => "a binary file".to_owned(),
        // The words of the kind alone: those of the error may have a temporary name.
        kind => kind.to_string(),
    }
}
