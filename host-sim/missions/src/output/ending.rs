//! The ending of a file's name, and the format that it promises.

use std::path::Path;

use anyhow::{Result, bail};

/// What is written, by its flag, and the endings that stand for it, the usual one first.
const WRITTEN: [(&str, &[&str]); 10] = [
    ("--figure", &["svg"]),
    ("--candidates", &["svg"]),
    ("--report", &["html", "htm"]),
    ("--trace", &["jsonl", "json", "ndjson"]),
    ("--mcap", &["mcap"]),
    ("--geojson", &["geojson", "json"]),
    ("--csv", &["csv"]),
    ("--map", &["csv"]),
    ("--fields-csv", &["csv"]),
    ("--timing", &["csv"]),
];

/// Endings of formats that are not written by any of these flags.
const OTHERS: [&str; 20] = [
    "png", "jpg", "jpeg", "gif", "webp", "bmp", "tif", "tiff", "avif", "ico", "pdf", "ps", "eps",
    "tsv", "xls", "xlsx", "ods", "parquet", "bag", "toml",
];

/// Checks that the name of an output does not promise another format than the flag writes. Endings that promise
/// nothing are left alone.
///
/// # Errors
/// Names the file, the flag and the ending to use.
pub fn check(flag: &str, path: &Path) -> Result<()> {
    let Some((_, own)) = WRITTEN.iter().find(|(it, _)| *it == flag) else { return Ok(()) };
    let Some(ending) = path.extension().and_then(|it| it.to_str()) else { return Ok(()) };
    let ending = ending.to_ascii_lowercase();
    let is_known = WRITTEN.iter().flat_map(|(_, all)| *all).chain(&OTHERS).any(|it| *it == ending);
    if is_known && !own.contains(&&*ending) {
        let (path, usual) = (path.display(), own[0]);
        bail!("{path}: found the ending .{ending}, expected .{usual}, which is what {flag} writes");
    }
    Ok(())
}
