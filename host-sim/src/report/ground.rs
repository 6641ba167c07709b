//! The knowledge of the ground, as shapes: certain ground, and how likely the line is to pass elsewhere.

use planner_core::link::message::MissionArea;
use planner_core::{Label, Sample};

use crate::mission::given::Lines;
use crate::mission::read_out::ReadOut;
use crate::report::bands::{self, Band};
use crate::world::polygon::Polygon;

/// What is known of the ground.
#[derive(Clone, Debug)]
pub enum Ground {
    /// The regions of certainty, of +1 and of -1.
    Certain([Polygon; 2]),
    /// Where all lines of a credible set have +1, and where all have -1.
    Agreed([Polygon; 2]),
    /// Where lines of the credible set pass, the least likely band first; each lies within the one before it.
    Credible(Vec<Band>),
    /// Nothing to show.
    Plain,
}

impl Ground {
    /// What a belief knows of an area.
    pub fn of(belief: &dyn ReadOut, area: MissionArea) -> Self {
        if let Some(table) = belief.hypotheses() {
            return Self::Credible(bands::of(table, &area));
        }
        let support = |lines: &Lines| lines.support().collect::<Vec<_>>();
        belief.version_space().map_or(Self::Plain, |lines| Self::certain(area, &support(lines)))
    }

    /// The ground that some samples leave certain. They bound the lines, in cyclic order.
    pub fn certain(area: MissionArea, support: &[Sample]) -> Self {
        let certain = |label| Polygon::certain(area, support, label);
        Self::Certain([Label::Positive, Label::Negative].map(certain))
    }
}
