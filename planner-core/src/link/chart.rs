//! A chart on the wire: its shape, and its cells in pieces.

use crc::Digest;
use heapless::Vec;
use serde::{Deserialize, Serialize};

use crate::geometry::chart::Chart;
use crate::link::frame::CHECK;

/// Bytes of cells that a piece has, but for the last, which may have fewer.
pub const CELL_BYTES: usize = 256;

/// The shape of a [`Chart`], and the check sum of its cells. The chart lies on [`Settings::area`](super::message::Settings).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ChartShape {
    /// The side of a cell, lattice units.
    pub side: u32,
    /// Columns and rows.
    pub size: [u16; 2],
    /// The CRC-32 of the cells' bytes: of all pieces, one behind the other.
    pub sum: u32,
}

/// Some of the cells of a chart.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ChartPiece {
    /// Which piece it is, from 0.
    pub number: u8,
    /// Words of [`Chart::cells`], the lowest byte of each first.
    pub bytes: Vec<u8, CELL_BYTES, u16>,
}

/// Why a chart has not arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ChartFault {
    /// The chip has room for so many words of cells.
    Room(u16),
    /// There is no chart of this shape, or it is not as large as the area.
    Shape,
    /// The vehicle has not sent this piece.
    Missing(u8),
    /// The vehicle has sent this piece again in place of a later one.
    Repeated(u8),
    /// In place of this piece the vehicle has sent a later one, or one of another length.
    Wrong(u8),
    /// The cells have another check sum.
    Sum,
}

impl core::fmt::Display for ChartFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Room(words) => write!(f, "the chip has room for {words} words of cells"),
            Self::Shape => f.write_str("there is no chart of this shape in the area"),
            Self::Missing(piece) => write!(f, "piece {piece} of the chart is missing"),
            Self::Repeated(piece) => write!(f, "piece {piece} of the chart came twice"),
            Self::Wrong(piece) => write!(f, "another piece came for piece {piece} of the chart"),
            Self::Sum => f.write_str("the cells of the chart have another check sum"),
        }
    }
}

impl core::error::Error for ChartFault {}

impl ChartShape {
    /// That of a chart.
    pub fn of(chart: &Chart<'_>) -> Self {
        let mut sum = CHECK.digest();
        chart.cells().iter().for_each(|word| sum.update(&word.to_le_bytes()));
        Self { side: chart.side(), size: chart.size(), sum: sum.finalize() }
    }

    /// How many words its cells have.
    pub(crate) fn words(&self) -> usize {
        let [columns, rows] = self.size;
        Chart::words_in(columns) * usize::from(rows)
    }
}

impl ChartPiece {
    /// The piece of a chart with a number, if the chart has so many.
    pub fn of(chart: &Chart<'_>, number: u8) -> Option<Self> {
        let words = chart.cells().chunks(CELL_BYTES / 4).nth(number.into())?;
        let mut bytes = Vec::new();
        for word in words {
            bytes.extend_from_slice(&word.to_le_bytes()).ok()?;
        }
        Some(Self { number, bytes })
    }

    /// Writes the cells of this piece to where they belong, and takes their bytes into a check sum.
    ///
    /// # Errors
    /// [`ChartFault`] if it is not the piece with that number, or has not as many words.
    pub(crate) fn write(
        &self,
        (number, to): (u8, &mut [u32]),
        sum: &mut Digest<'_, u32>,
    ) -> Result<(), ChartFault> {
        if self.number < number {
            return Err(ChartFault::Repeated(self.number));
        }
        let (words, rest) = self.bytes.as_chunks();
        if self.number > number || words.len() != to.len() || !rest.is_empty() {
            return Err(ChartFault::Wrong(number));
        }
        to.iter_mut().zip(words).for_each(|(to, word)| *to = u32::from_le_bytes(*word));
        sum.update(&self.bytes);
        Ok(())
    }
}
