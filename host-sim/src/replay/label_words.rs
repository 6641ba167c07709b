//! The labels of a file, as its recorder wrote them. They are -1 and 1, 0 and 1, true and false, yes and no, or ja and
//! nein. Or they are measured values, of which those above a threshold are +1.
//!
//! A file has one kind. A 0 may also mean that nothing was measured. So it counts as -1 only in a file that contains a
//! 1 as well.

use anyhow::{Context as _, Result, anyhow, bail};
use planner_core::Label;

use crate::replay::numbers::Numbers;

/// Words of each kind for +1 and -1. The first two kinds are of numbers.
const WORDS: [[&str; 2]; 5] =
    [["1", "-1"], ["1", "0"], ["true", "false"], ["yes", "no"], ["ja", "nein"]];
const SIGNS: usize = 0;
const BITS: usize = 1;

/// The labels read so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LabelWords {
    /// Their kind, and the line that showed it.
    kind: Option<(usize, usize)>,
    /// The line of the first 1, which is of two kinds.
    one: Option<usize>,
    /// Above it a value is +1, where labels are values.
    threshold: Option<f64>,
}

const EXPECTED: &str = "-1 or 1, 0 or 1, true or false, yes or no, ja or nein";

impl LabelWords {
    /// Reads words, or values if there is a threshold.
    pub(crate) fn of(threshold: Option<f64>) -> Self {
        Self { threshold, ..Self::default() }
    }

    /// The label in a field on some line, and the value that it was measured as. `None` if the field says only that the
    /// value is below a limit above the threshold, or above a limit below it.
    ///
    /// # Errors
    /// What was found and what was expected.
    pub(crate) fn read(
        &mut self,
        field: &str,
        numbers: &mut Numbers,
        line: usize,
    ) -> Result<Option<(Label, Option<f64>)>> {
        let Some(threshold) = self.threshold else {
            return Ok(Some((self.word(field, line)?, None)));
        };
        let (is_below, is_above) =
            (field.starts_with(['<', '\u{2264}']), field.starts_with(['>', '\u{2265}']));
        let number = field.trim_start_matches(['<', '>', '=', '\u{2264}', '\u{2265}']).trim_start();
        let value = numbers.read(number, line).with_context(|| {
            format!("label: found {field:?}, expected a finite number, as --threshold says")
        })?;
        let is_positive = value > threshold;
        let is_open = is_below && is_positive || is_above && value < threshold;
        let label = if is_positive || is_above { Label::Positive } else { Label::Negative };
        Ok((!is_open).then_some((label, Some(value))))
    }

    /// The label that a word says.
    fn word(&mut self, field: &str, line: usize) -> Result<Label> {
        let (kind, is_positive) = match (field.parse::<f64>(), self.kind) {
            (Ok(1.0), None) => {
                self.one.get_or_insert(line);
                return Ok(Label::Positive);
            }
            (Ok(1.0), Some((kind, _))) => {
                self.one.get_or_insert(line);
                (if kind == BITS { BITS } else { SIGNS }, true)
            }
            (Ok(-1.0), _) => (SIGNS, false),
            (Ok(0.0), _) => (BITS, false),
            (Ok(other), _) if other.is_finite() => {
                bail!(
                    "label: found {other}, expected {EXPECTED}, or for measured values --threshold"
                )
            }
            _ => {
                let place =
                    |pair: &[&str; 2]| pair.iter().position(|it| field.eq_ignore_ascii_case(it));
                let found =
                    (0..).zip(&WORDS).find_map(|(kind, pair)| Some((kind, place(pair)? == 0)));
                found.with_context(|| {
                    format!(
                        "label: found {field:?}, expected a finite number or a word: {EXPECTED}"
                    )
                })?
            }
        };
        let earlier = match self.kind {
            Some((other, line)) => (other != kind).then_some(line),
            None => self.one.filter(|_| kind > BITS),
        };
        if let Some(earlier) = earlier {
            bail!(
                "label: found {field} after one of another kind on line {earlier}, expected all of one kind: {EXPECTED}"
            );
        }
        self.kind.get_or_insert((kind, line));
        Ok(if is_positive { Label::Positive } else { Label::Negative })
    }

    /// All labels are read.
    ///
    /// # Errors
    /// The line of a 0 where there is no 1, and what was expected.
    pub(crate) fn end(self) -> Result<(), (usize, anyhow::Error)> {
        match self {
            Self { kind: Some((BITS, line)), one: None, .. } => Err((
                line,
                anyhow!("label: found 0 and nowhere a 1 in the file, expected {EXPECTED}"),
            )),
            _ => Ok(()),
        }
    }
}
