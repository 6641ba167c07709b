//! Numbers that stand in a file where nothing was measured, and values and positions that look like such.

use crate::replay::rows::{Layout, Rows};

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

/// The least and the most of some values; the first exceeds the second if there are none.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], it| [a.min(it), b.max(it)])
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
    pub(crate) fn leave_out_unfixed(
        &mut self,
        layout: &Layout,
    ) -> Result<(), (usize, anyhow::Error)> {
        let is_far = |at: &&[f64; 2]| at.iter().any(|it| it.abs() > 1.0);
        let far = self.positions.iter().filter(is_far).count();
        if !self.is_geographic || 2 * far < self.positions.len() {
            return Ok(());
        }
        let unfixed: Vec<_> =
            self.positions.iter().map(|at| at.iter().all(|it| *it == 0.0)).collect();
        for (index, _) in unfixed.iter().enumerate().filter(|it| *it.1) {
            let (line, lacks) =
                (self.lines[index], "found (0, 0), where receivers are before their first fix");
            self.skip(layout, line, lacks.to_owned()).map_err(|error| (line, error))?;
        }
        self.leave_out(&unfixed);
        Ok(())
    }

    /// Leaves out the rows whose measured value is a usual fill value and lies outside all others, by more than their
    /// range. Notes the first row whose value is far outside all others.
    ///
    /// # Errors
    /// The row and its value, where the layout is strict.
    pub(crate) fn leave_out_fills(
        &mut self,
        layout: &Layout,
    ) -> Result<(), (usize, anyhow::Error)> {
        let rest = range(self.values.iter().copied().filter(|it| !is_usual(*it)));
        let is_outside = |value: f64| rest[0] > rest[1] || ranges_away(value, rest) > 1.0;
        let is_fill = |value: f64| is_usual(value) && is_outside(value);
        let fills: Vec<_> = self.values.iter().map(|it| is_fill(*it)).collect();
        for (index, _) in fills.iter().enumerate().filter(|it| *it.1) {
            let (value, line) = (self.values[index], self.lines[index]);
            let lacks = format!("label: found {value}, which stands for no value");
            self.skip(layout, line, lacks).map_err(|error| (line, error))?;
        }
        self.leave_out(&fills);
        let [least, most] = range(self.values.iter().copied());
        for extreme in [least, most] {
            let others =
                range(self.values.iter().copied().filter(|it| it.total_cmp(&extreme).is_ne()));
            let away = ranges_away(extreme, others);
            if away > FAR && away.is_finite() {
                let line = self
                    .values
                    .iter()
                    .position(|it| it.total_cmp(&extreme).is_eq())
                    .map(|it| self.lines[it]);
                self.odd = line.map(|line| (line, extreme, others)).or(self.odd);
            }
        }
        Ok(())
    }
}
