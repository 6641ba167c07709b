//! Recorded samples and what they determine, drawn.

use anyhow::{Context as _, Result};
use planner_core::Sample;

use crate::replay::answer::Answer;
use crate::replay::record::Replay;
use crate::report::picture::{Dot, Ground, Kind, Named, Picture, Ring, area_around};
use crate::report::ribbon::Ribbon;

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
        let mut rings = vec![None; samples.len()];
        for &index in doubt.iter().flat_map(|doubt| &doubt.disagreeing) {
            rings[index] = Some(Ring::Disagrees);
        }
        let count = samples.len();
        let every =
            if count - bounding.len() > MOST_OTHERS { count.div_ceil(MOST_OTHERS) } else { 1 };
        let dot = |s: &Sample, ring| Dot { at: s.site.into(), label: s.label, ring, sought: false };
        let mut dots: Vec<_> =
            samples.iter().zip(rings).step_by(every).map(|(s, ring)| dot(s, ring)).collect();
        if every > 1 {
            dots.extend(bounding.iter().map(|s| dot(s, None)));
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
        let centre = line.map(|line| Named {
            name: format!("estimate: {name}"),
            line,
            kind: Kind::Estimate,
            beside: None,
        });
        let svg = Picture {
            title: self.file.name.clone(),
            note,
            area: area.into(),
            ground: match doubt {
                None => Ground::Certain(self.answer.ground(area)),
                Some(_) => Ground::Agreed(self.answer.ground(area)),
            },
            is_refuted: false,
            samples: dots,
            given: 0,
            path: None,
            truth: None,
            lines: centre.into_iter().collect(),
            follows: false,
            front: Ribbon::default(),
        }
        .svg();
        Ok(svg)
    }
}
