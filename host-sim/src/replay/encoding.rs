//! Text in UTF-8, whatever a logger or a spreadsheet wrote it in.

use std::borrow::Cow;

use anyhow::{Result, bail};

/// How files begin that are no tables, and what to do with each.
const OTHERS: [(&[u8], &str); 6] = [
    (b"\x1f\x8b", "found a gzip file, expected text: unpack it by gunzip"),
    (
        b"PK\x03\x04",
        "found an archive (.zip, .xlsx, .ods or .kmz), expected text: unpack it, or save it as CSV",
    ),
    (b"\xd0\xcf\x11\xe0", "found an old spreadsheet (.xls), expected text: save it as CSV"),
    (b"\x89HDF", "found NetCDF or HDF5, expected text: export its columns as CSV"),
    (b"<!DOCTYPE html", "found a web page, expected a file: the server may want a login"),
    (b"CDF", "found NetCDF, expected text: export its columns as CSV"),
];

/// So many bytes show whether a file is text.
const BEGINNING: usize = 64;

/// The text of a file without its byte order mark.
///
/// # Errors
/// Names what the file contains in place of text.
pub(crate) fn utf8(bytes: &[u8]) -> Result<Cow<'_, [u8]>> {
    if let Some((_, what)) = OTHERS.iter().find(|(begins, _)| bytes.starts_with(begins)) {
        bail!("{what}");
    }
    let is_binary = |it: &u8| *it == 0;
    // Of two bytes of a letter or a digit in UTF-16 one is 0.
    let [units, is_big] = match bytes {
        [0xff, 0xfe, rest @ ..] => [rest, &[]],
        [0xfe, 0xff, rest @ ..] => [rest, b"big"],
        [first, 0, second, 0, ..] if *first > 0 && *second > 0 => [bytes, &[]],
        [0, first, 0, second, ..] if *first > 0 && *second > 0 => [bytes, b"big"],
        _ if bytes.iter().take(BEGINNING).any(is_binary) => {
            bail!("found a binary file, expected text: export it as CSV")
        }
        _ => return Ok(Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))),
    };
    let unit = if is_big.is_empty() { u16::from_le_bytes } else { u16::from_be_bytes };
    let units = units.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    let text: String =
        char::decode_utf16(units).map(|it| it.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
    Ok(Cow::Owned(text.into_bytes()))
}
