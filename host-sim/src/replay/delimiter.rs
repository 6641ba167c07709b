//! The delimiter between the fields of a row.

use std::str::FromStr;

use anyhow::{Result, bail};

/// A character between fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delimiter {
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// A tabulator
    Tab,
    /// `|`
    Pipe,
    /// One space or several
    Space,
}

impl FromStr for Delimiter {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        Ok(match text {
            "," | "comma" => Self::Comma,
            ";" | "semicolon" => Self::Semicolon,
            "\t" | "tab" => Self::Tab,
            "|" | "pipe" => Self::Pipe,
            " " | "space" => Self::Space,
            _ => bail!("found {text:?}, expected comma, semicolon, tab, pipe or space"),
        })
    }
}

impl Delimiter {
    /// In the order in which they are tried.
    pub(crate) const ALL: [Self; 5] =
        [Self::Comma, Self::Semicolon, Self::Tab, Self::Pipe, Self::Space];

    pub(crate) const fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Pipe => b'|',
            Self::Space => b' ',
        }
    }
}
