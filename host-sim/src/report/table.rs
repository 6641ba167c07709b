//! A table for people: a title a column, a line a row.

use std::fmt::{self, Write as _};

#[derive(Clone, Copy, Debug)]
enum Align {
    Left,
    Centre,
    Right,
}

/// A column: its title, and how its cells are set. One of width 0 is as wide as each cell is.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    title: &'static str,
    align: Align,
    width: usize,
    gap: usize,
}

impl Column {
    const fn new(title: &'static str, align: Align, width: usize) -> Self {
        Self { title, align, width, gap: 1 }
    }

    /// A column of words.
    pub const fn left(title: &'static str, width: usize) -> Self {
        Self::new(title, Align::Left, width)
    }

    /// A column of cells with several numbers.
    pub const fn centre(title: &'static str, width: usize) -> Self {
        Self::new(title, Align::Centre, width)
    }

    /// A column of numbers.
    pub const fn right(title: &'static str, width: usize) -> Self {
        Self::new(title, Align::Right, width)
    }

    /// The same, further from the column before it.
    #[must_use]
    pub const fn apart(self) -> Self {
        Self { gap: 2, ..self }
    }
}

/// A table that is being written.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<Column>,
    text: String,
}

/// A column, and the cell that it has for a row.
pub type Cells<'a, R> = (Column, &'a dyn Fn(&R) -> String);

impl Table {
    /// A table of rows of one kind.
    pub fn of<R>(rows: &[R], columns: &[Cells<R>]) -> Self {
        let mut table = Self::new(columns.iter().map(|(column, _)| *column).collect::<Vec<_>>());
        for row in rows {
            table.row(columns.iter().map(|(_, cell)| cell(row)));
        }
        table
    }

    /// A table with no row yet.
    pub fn new(columns: impl Into<Vec<Column>>) -> Self {
        let columns = columns.into();
        let titled = columns.iter().rposition(|column| !column.title.is_empty());
        let titles: Vec<_> = columns
            .iter()
            .map(|column| column.title.to_owned())
            .take(titled.map_or(0, |k| k + 1))
            .collect();
        let mut table = Self { columns, text: String::new() };
        table.row(titles);
        table
    }

    /// Adds a row. It may end early.
    ///
    /// # Panics
    /// Never: writing to a string cannot fail.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        for (k, (cell, column)) in cells.into_iter().zip(&self.columns).enumerate() {
            let &Column { align, width, gap, .. } = column;
            let gap = if k == 0 { 0 } else { gap };
            self.text.extend(std::iter::repeat_n(' ', gap));
            let written = match align {
                Align::Left => write!(self.text, "{cell:<width$}"),
                Align::Centre => write!(self.text, "{cell:^width$}"),
                Align::Right => write!(self.text, "{cell:>width$}"),
            };
            written.expect("a string takes all");
        }
        self.text.push('\n');
    }

    /// Adds a line that is no row.
    pub fn line(&mut self, line: &str) {
        self.text += line;
        self.text.push('\n');
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
