//! Numbers that stand in a file where nothing was measured, and values and positions that look like such.

use std::mem;

use anyhow::{Error, Result};

use crate::replay::rows::{Layout, Recorded, Rows};
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
        let is_far = |it: &&Recorded| it.position.iter().any(|it| it.abs() > 1.0);
        let far = self.samples.iter().filter(is_far).count();
        if !self.is_geographic || 2 * far < self.samples.len() {
            return Ok(());
        }
        let lacks = "found (0, 0), where receivers are before their first fix";
        let is_unfixed = |it: &Recorded| it.position.iter().all(|it| *it == 0.0);
        self.leave_out(layout, |it| is_unfixed(it).then(|| lacks.to_owned()))
    }

    /// Leaves out the rows whose measured value is a usual fill value and lies outside all others, by more than their
    /// range. Notes the first row whose value is far outside all others.
    ///
    /// # Errors
    /// The row and its value, where the layout is strict.
    pub(crate) fn leave_out_fills(&mut self, layout: &Layout) -> Result<(), (usize, Error)> {
        let values = || self.samples.iter().filter_map(|it| it.value);
        let rest = span(values().filter(|it| !is_usual(*it)));
        let is_outside = |value: f64| rest[0] > rest[1] || ranges_away(value, rest) > 1.0;
        self.leave_out(layout, |it| {
            let value = it.value.filter(|it| is_usual(*it) && is_outside(*it))?;
            Some(format!("label: found {value}, which stands for no value"))
        })?;
        let values = || self.samples.iter().filter_map(|it| Some((it.line, it.value?)));
        let mut odd = None;
        for extreme in span(values().map(|it| it.1)) {
            let is_it = |it: &(usize, f64)| it.1.total_cmp(&extreme).is_eq();
            let others = span(values().filter(|it| !is_it(it)).map(|it| it.1));
            let away = ranges_away(extreme, others);
            if away > FAR && away.is_finite() {
                odd = values().find(is_it).map(|it| (it.0, extreme, others));
            }
        }
        self.odd = odd;
        Ok(())
    }

    /// Leaves samples out, each if something is said that it lacks.
    fn leave_out(
        &mut self,
        layout: &Layout,
        lacks: impl Fn(&Recorded) -> Option<String>,
    ) -> Result<(), (usize, Error)> {
        for it in mem::take(&mut self.samples) {
            match lacks(&it) {
                Some(lacks) => self.skip(layout, it.line, &lacks).map_err(|why| (it.line, why))?,
                None => self.samples.push(it),
            }
        }
        Ok(())
    }
}
