//! Recorded samples: how files are read, and what [`fitting`](crate::fitting) says of them.

pub mod answer;
pub mod columns;
mod degrees;
mod encoding;
#[cfg(test)]
mod false_alarms;
mod fills;
mod fit_record;
mod fit_words;
pub mod front;
pub mod geojson;
pub mod geojson_file;
pub mod gpx_file;
pub mod joined;
pub mod label_words;
pub mod line;
mod map_file;
pub mod numbers;
mod placed_map;
mod reading;
pub mod rows;
pub mod sample_file;
pub mod table_file;
pub mod trace_file;
mod track;

use anyhow::{Result, bail};

/// Rows, pieces and alarms that are named in words; the record has all.
const MOST_NAMED: usize = 20;

/// What a command says of its files: the same facts in each form.
pub trait Report {
    /// For people.
    fn words(&self) -> String;

    /// For programs.
    fn json(&self) -> String;

    /// As an SVG document.
    ///
    /// # Errors
    /// When it could not be drawn.
    fn figure(&self) -> Result<String>;

    /// For a map.
    ///
    /// # Errors
    /// For positions in metres, as these have no place on a map by themselves. Also for positions on both sides of the
    /// 180th meridian.
    fn geojson(&self) -> Result<String>;

    /// The vertices of a front.
    ///
    /// # Errors
    /// When a row could not be written.
    fn csv(&self) -> Result<String> {
        bail!("found a line, expected a front")
    }

    /// Why not to rely on it.
    fn warning(&self) -> Option<String>;
}
