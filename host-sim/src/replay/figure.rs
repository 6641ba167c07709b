//! Recorded samples and what they determine, drawn.

use anyhow::{Context as _, Result};
use planner_core::Sample;

use crate::replay::answer::Answer;
use crate::replay::record::Replay;
use crate::report::ground::{AGREED, CERTAIN, Ground};
use crate::report::look::{self, DISAGREES};
use crate::report::picture::{Dot, Drawn, Picture, area_around};
use crate::report::style::ESTIMATE;

/// Samples that a figure shows beside those that bound the line.
const MOST_OTHERS: usize = 2_000;

impl Replay {
    /// The samples and what they determine, as an SVG document. Of very many samples it shows all that bound
    /// the line, and some of the others.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let samples = &self.file.samples;
        let area = area_around(samples).context("no area around the samples")?;
        let Answer { bounding, doubt, .. } = &self.answer;
        let read = |s: &Sample| Dot::new(s.site, look::read(s.label));
        let mut dots: Vec<_> = samples.iter().map(read).collect();
        for &index in doubt.iter().flat_map(|doubt| &doubt.disagreeing) {
            dots[index].ring = Some(DISAGREES);
        }
        let count = samples.len();
        let every =
            if count - bounding.len() > MOST_OTHERS { count.div_ceil(MOST_OTHERS) } else { 1 };
        if every > 1 {
            dots = dots.into_iter().step_by(every).chain(bounding.iter().map(read)).collect();
        }
        let sparse = (every > 1).then(|| {
            let bounding = bounding.len();
            format!("shown: one in {every} of {count} samples, all {bounding} that bound the line")
        });
        let note = match (sparse, doubt) {
            (note, None) => note,
            (None, Some(_)) => Some("set: the 90 % credible set of lines".to_owned()),
            (Some(_), Some(_)) => {
                Some(format!("one in {every} of {count}; set: the 90 % credible set"))
            }
        };
        let verdict = &self.answer.fit.verdict;
        let note = if verdict.is_bad() {
            note.map(|note| format!("{note}; verdict: {}", verdict.name()))
        } else {
            note
        };
        let (name, line) = self.named()[0];
        let estimate =
            |line| Drawn::across(&area.into(), line, ESTIMATE, format!("estimate: {name}"));
        let picture = Picture {
            ground: Ground::Labelled(self.answer.ground(area)),
            says: if doubt.is_some() { AGREED } else { CERTAIN },
            samples: dots,
            lines: line.map(estimate).into_iter().collect(),
            ..Picture::bare(&self.file.name, note.unwrap_or_default(), area)
        };
        Ok(picture.svg())
    }
}
