//! The order of a campaign's rows: by planner, field and stage, each once and none missing.

use std::fmt::Write as _;
use std::ops::Range;

use anyhow::{Result, bail};

use crate::campaign::ensemble::{Campaign, Measure};

/// The planner's number, the field and the stage of a row.
pub type Key = (usize, u64, u32);

/// The rows that a file is to have, and which of them it was found to have so far.
#[derive(Clone, Debug)]
pub struct Order {
    planners: usize,
    fields: Range<u64>,
    /// In rising order.
    stages: Vec<u32>,
    /// Whether each mission has a row at each stage. Else one that ended early has fewer, or none.
    is_whole: bool,
    /// Whether the rows may end before all are there.
    is_beginning: bool,
    last: Option<Key>,
}

impl Order {
    /// Of campaigns that measure alike, over these fields.
    pub fn new<M: Measure>(measure: &M, campaigns: &[Campaign], fields: Range<u64>) -> Self {
        let stages = campaigns.first().map_or(Vec::new(), |it| it.stages(measure));
        let is_whole = M::IS_WHOLE;
        let planners = campaigns.len();
        Self { planners, fields, stages, is_whole, is_beginning: false, last: None }
    }

    /// The same, of a file that was not completed.
    #[must_use]
    pub fn beginning(self) -> Self {
        Self { is_beginning: true, ..self }
    }

    /// Takes in the next row.
    ///
    /// # Errors
    /// Says which row was found and which was expected.
    pub fn take(&mut self, row: Key) -> Result<()> {
        let is_next = if self.is_whole { self.next() == Some(row) } else { self.may_follow(row) };
        if !is_next {
            bail!("found {}, expected {}", Self::name(row), self.expected());
        }
        self.last = Some(row);
        Ok(())
    }

    /// Takes in that there are no more rows.
    ///
    /// # Errors
    /// Says which row is missing.
    pub fn end(&self) -> Result<()> {
        if self.is_whole && !self.is_beginning && self.next().is_some() {
            bail!("found no more rows, expected {}", self.expected());
        }
        Ok(())
    }

    /// The row that follows if none is missing.
    fn next(&self) -> Option<Key> {
        let first = *self.stages.first()?;
        let Some((planner, field, stage)) = self.last else {
            return (!self.fields.is_empty()).then_some((0, self.fields.start, first));
        };
        if let Some(stage) = self.stages.iter().find(|it| **it > stage) {
            return Some((planner, field, *stage));
        }
        if field + 1 < self.fields.end {
            return Some((planner, field + 1, first));
        }
        (planner + 1 < self.planners).then_some((planner + 1, self.fields.start, first))
    }

    /// Whether a row may follow where missions may have fewer rows than there are stages.
    fn may_follow(&self, row: Key) -> bool {
        let (planner, field, stage) = row;
        let is_mission_s_first = self.stages.first() == Some(&stage);
        let goes_on = self.next() == Some(row);
        let is_later = self.last.is_none_or(|(p, f, _)| (planner, field) > (p, f));
        let is_ours = planner < self.planners && self.fields.contains(&field);
        is_ours && (goes_on || is_later && is_mission_s_first)
    }

    fn name((_, field, stage): Key) -> String {
        format!("field {field} at {stage}")
    }

    fn expected(&self) -> String {
        if self.is_whole {
            return self.next().map_or("no more rows".to_owned(), Self::name);
        }
        let Range { start, end } = self.fields;
        let mut text =
            format!("the next of the fields {start} to {}, each at ", end.saturating_sub(1));
        for (k, stage) in self.stages.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{}{stage}", if k == 0 { "" } else { ", " });
        }
        text + " until its mission ends"
    }
}
