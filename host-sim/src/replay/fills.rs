//! Numbers that stand in a file where nothing was measured, and values and positions that look like such.

use anyhow::{Error, Result};

use crate::replay::rows::{Layout, Rows};
use crate::world::extent::span;

/// The usual ones, as loggers, GIS and servers write them.
const USUAL: [f64; 22] = [
    -99.0, -99.9, -99.99, -999.0, -999.9, -999.99, -9999.0, -9999.9, -9999.99, -99999.0,
    -999_999.0, -32767.0, -32768.0, 32767.0, 999.0, 999.9, 999.99, 9999.0, 9999.9, 9999.99,
    99999.0, 65535.0,
];

/// No measured value is so large: fill values of 1e20, 1e35 and 9.97e36 are.
const HUGE: f64 = 1e15;

/// A value is far outside others if it is so many of their ranges away.
const FAR: f64 = 3.0;

fn is_usual(value: f64) -> bool {
    USUAL.contains(&value) || value.abs() >= HUGE
}

/// How many of their ranges a value is away from others.
fn ranges_away(value: f64, [least, most]: [f64; 2]) -> f64 {
    let away = (least - value).max(value - most);
    if away <= 0.0 { 0.0 } else { away / (most - least) }
}

impl Rows {
    /// Leaves out the rows at latitude and longitude 0, which receivers write before their first fix, if most others are
    /// further than a degree away.
    ///
    /// # Errors
    /// The row, where the layout is strict.
    pub(crate) fn leave_out_unfixed(&mut self, layout: &Layout) -> Result<(), (usize, Error)> {
        let is_far = |at: &&[f64; 2]| at.iter().any(|it| it.abs() > 1.0);
        let far = self.positions.iter().filter(is_far).count();
        if !self.is_geographic || 2 * far < self.positions.len() {
            return Ok(());
        }
        let lacks = "found (0, 0), where receivers are before their first fix";
        let unfixed = |at: &[f64; 2]| (*at == [0.0; 2]).then(|| lacks.to_owned());
        self.leave_out(layout, self.positions.iter().map(unfixed).collect())
    }

    /// Leaves out the rows whose measured value is a usual fill value and lies outside all others, by more than their
    /// range. Notes the first row whose value is far outside all others.
    ///
    /// # Errors
    /// The row and its value, where the layout is strict.
    pub(crate) fn leave_out_fills(&mut self, layout: &Layout) -> Result<(), (usize, Error)> {
        let rest = span(self.values.iter().copied().filter(|it| !is_usual(*it)));
        let is_outside = |value: f64| rest[0] > rest[1] || ranges_away(value, rest) > 1.0;
        let fill = |value: &f64| {
            (is_usual(*value) && is_outside(*value))
                .then(|| format!("label: found {value}, which stands for no value"))
        };
        self.leave_out(layout, self.values.iter().map(fill).collect())?;
        for extreme in span(self.values.iter().copied()) {
            let is_it = |value: &f64| value.total_cmp(&extreme).is_eq();
            let others = span(self.values.iter().copied().filter(|it| !is_it(it)));
            let away = ranges_away(extreme, others);
            if away > FAR && away.is_finite() {
                let first = self.values.iter().position(is_it);
                self.odd = first.map(|it| (self.lines[it], extreme, others)).or(self.odd);
            }
        }
        Ok(())
    }

    /// Leaves rows out, each if something is said that it lacks.
    fn leave_out(
        &mut self,
        layout: &Layout,
        lacks: Vec<Option<String>>,
    ) -> Result<(), (usize, Error)> {
        fn kept<T>(of: &mut Vec<T>, is_left: &[bool]) {
            let mut is_left = is_left.iter();
            of.retain(|_| is_left.next() != Some(&true));
        }
        let is_left: Vec<_> = lacks.iter().map(Option::is_some).collect();
        for (index, lacks) in lacks.into_iter().enumerate() {
            let line = self.lines[index];
            lacks
                .map_or(Ok(()), |it| self.skip(layout, line, it))
                .map_err(|error| (line, error))?;
        }
        kept(&mut self.positions, &is_left);
        kept(&mut self.labels, &is_left);
        kept(&mut self.values, &is_left);
        kept(&mut self.lines, &is_left);
        kept(&mut self.told, &is_left);
        Ok(())
    }
}
