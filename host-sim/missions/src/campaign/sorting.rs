//! Any number of values in ascending order, in bounded memory.
//!
//! Medians and percentiles are exact, and so is the split into bins of equal size. So all values are sorted by slot (a
//! stage and what was measured there). Memory holds one run of values at a time. Runs go to a temporary file and are
//! merged as they are read. If all values fit into one run, there is no file.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::vec;

use rayon::prelude::*;

use crate::world::in_order::{in_order, number};

/// Values in a run: 16 MB, and as much again while it is sorted.
const RUN: usize = 1 << 20;

/// Bytes of a value in the file: its slot and mark, then its order.
const BYTES: usize = 12;

/// Bytes that all runs together hold while they are merged.
const MERGED: usize = 16 << 20;

/// A value in its slot. Equal ones stay in the order in which they came.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Value {
    /// The slot whose values are sorted together. Below 2^31.
    pub(crate) slot: u32,
    /// Goes with the value and plays no part in its order.
    pub(crate) is_marked: bool,
    order: i64,
}

impl Value {
    pub(crate) fn new(slot: u32, value: f64, is_marked: bool) -> Self {
        Self { slot, is_marked, order: in_order(value) }
    }

    pub(crate) fn value(self) -> f64 {
        number(self.order)
    }

    fn key(&self) -> (u32, i64) {
        (self.slot, self.order)
    }

    fn to_bytes(self) -> [u8; BYTES] {
        let mut bytes = [0; BYTES];
        let slot = self.slot << 1 | u32::from(self.is_marked);
        bytes[..4].copy_from_slice(&slot.to_le_bytes());
        bytes[4..].copy_from_slice(&self.order.to_le_bytes());
        bytes
    }

    fn from_bytes(bytes: &[u8; BYTES]) -> Self {
        let [a, b, c, d, order @ ..] = *bytes;
        let slot = u32::from_le_bytes([a, b, c, d]);
        Self { slot: slot >> 1, is_marked: slot & 1 == 1, order: i64::from_le_bytes(order) }
    }
}

/// Values that are being collected.
#[derive(Debug)]
pub(crate) struct Sorting {
    run: Vec<Value>,
    room: usize,
    /// Full runs, one after the other.
    file: Option<File>,
    runs: usize,
}

impl Default for Sorting {
    fn default() -> Self {
        Self::with_runs_of(RUN)
    }
}

impl Sorting {
    fn with_runs_of(room: usize) -> Self {
        Self { run: Vec::new(), room, file: None, runs: 0 }
    }

    /// Takes a value in.
    ///
    /// # Errors
    /// When the temporary file cannot be written.
    pub(crate) fn push(&mut self, value: Value) -> io::Result<()> {
        self.run.push(value);
        if self.run.len() == self.room { self.write_run() } else { Ok(()) }
    }

    fn write_run(&mut self) -> io::Result<()> {
        self.run.par_sort_by_key(Value::key);
        let mut file = match self.file.take() {
            Some(file) => file,
            None => tempfile::tempfile()?,
        };
        let mut bytes = Vec::with_capacity(1 << 16);
        for values in self.run.chunks(bytes.capacity() / BYTES) {
            bytes.clear();
            bytes.extend(values.iter().flat_map(|value| value.to_bytes()));
            file.write_all(&bytes)?;
        }
        (self.file, self.runs) = (Some(file), self.runs + 1);
        self.run.clear();
        Ok(())
    }

    /// All values: slot by slot, in each in ascending order.
    ///
    /// # Errors
    /// When the temporary file cannot be read.
    pub(crate) fn sorted(mut self) -> io::Result<Sorted> {
        self.run.par_sort_by_key(Value::key);
        let (room, last) = (self.room as u64, self.runs as u64);
        let chunk = (MERGED / BYTES / (self.runs + 1)).clamp(64, 1 << 14);
        let filed = (0..last).map(|run| Run {
            next: run * room,
            end: (run + 1) * room,
            held: Vec::new().into_iter(),
        });
        let held = Run { next: 0, end: 0, held: self.run.into_iter() };
        let mut sorted = Sorted {
            file: self.file,
            runs: filed.chain([held]).collect(),
            heads: BinaryHeap::new(),
            chunk,
        };
        for run in 0..sorted.runs.len() {
            sorted.advance(run)?;
        }
        Ok(sorted)
    }
}

/// Values in ascending order.
#[derive(Debug)]
pub(crate) struct Sorted {
    file: Option<File>,
    runs: Vec<Run>,
    /// The first value left of each run: its key, the run, the mark. Of equal ones the earlier run's comes first.
    heads: BinaryHeap<Reverse<Head>>,
    chunk: usize,
}

/// The key of a value, its run, and its mark.
type Head = ((u32, i64), usize, bool);

/// What is left of a run.
#[derive(Debug)]
struct Run {
    /// The place in the file of the next value that is not held, counted in values.
    next: u64,
    end: u64,
    held: vec::IntoIter<Value>,
}

impl Sorted {
    /// The next value of a run takes its place among the heads.
    fn advance(&mut self, number: usize) -> io::Result<()> {
        let run = &mut self.runs[number];
        if run.held.len() == 0
            && run.next < run.end
            && let Some(file) = &mut self.file
        {
            let values = (run.end - run.next).min(self.chunk as u64);
            let mut bytes = vec![0; values as usize * BYTES];
            file.seek(SeekFrom::Start(run.next * BYTES as u64))?;
            file.read_exact(&mut bytes)?;
            let (values_read, _) = bytes.as_chunks();
            run.held = values_read.iter().map(Value::from_bytes).collect::<Vec<_>>().into_iter();
            run.next += values;
        }
        if let Some(value) = run.held.next() {
            self.heads.push(Reverse((value.key(), number, value.is_marked)));
        }
        Ok(())
    }
}

impl Iterator for Sorted {
    type Item = io::Result<Value>;

    fn next(&mut self) -> Option<Self::Item> {
        let Reverse(((slot, order), run, is_marked)) = self.heads.pop()?;
        Some(self.advance(run).map(|()| Value { slot, is_marked, order }))
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Against a stable sort of all at once, with runs of all sorts: many values are equal, so that it shows if
    /// equal ones change places.
    #[test]
    fn values_come_out_sorted_and_equal_ones_in_their_order() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        for (n, room) in [(0, 4), (3, 4), (4, 4), (5, 4), (1_000, 7), (1_000, 1_000), (20_000, 300)]
        {
            let values: Vec<_> = (0..n)
                .map(|_| {
                    let value = f64::from(rng.random_range(-3..3)) / 3.0;
                    let slot = rng.random_range(0..5);
                    (
                        slot,
                        if value == 0.0 && slot == 0 { -0.0 } else { value },
                        rng.random_range(0..2) == 1,
                    )
                })
                .collect();
            let mut sorting = Sorting::with_runs_of(room);
            for &(slot, value, is_marked) in &values {
                sorting.push(Value::new(slot, value, is_marked)).expect("room on the disc");
            }
            let found = sorting.sorted().expect("its file").map(|it| {
                let it = it.expect("its file");
                (it.slot, it.value().to_bits(), it.is_marked)
            });
            let mut expected = values;
            expected.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            let expected =
                expected.into_iter().map(|(slot, value, mark)| (slot, value.to_bits(), mark));
            assert!(found.eq(expected), "{n} values in runs of {room}");
        }
    }

    #[test]
    fn every_float_comes_back_as_it_was() {
        for value in [0.0, -0.0, 1e-300, -1e300, f64::MIN_POSITIVE, f64::INFINITY, f64::NAN, 0.1] {
            let found = Value::from_bytes(&Value::new(7, value, true).to_bytes());
            assert_eq!((found.slot, found.is_marked), (7, true));
            assert_eq!(found.value().to_bits(), value.to_bits());
        }
    }
}
