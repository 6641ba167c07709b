//! The knowledge of the ground, as shapes: certain ground, and how likely the line is to pass elsewhere.

use planner_core::link::message::MissionArea;
use planner_core::{Label, Sample};
use serde::Serialize;

use crate::mission::given::Lines;
use crate::mission::read_out::ReadOut;
use crate::report::bands::{self, Band};
use crate::world::polygon::Polygon;
use crate::world::way::Way;

/// What is known of the ground.
#[derive(Clone, Debug, Serialize)]
pub enum Ground {
    /// Where a label is told, +1 and -1.
    #[serde(rename = "certain")]
    Labelled([Polygon; 2]),
    /// Where lines of the credible set pass, the least likely band first; each lies within the one before it.
    #[serde(rename = "bands")]
    Credible(Vec<Band>),
    /// Nothing to show.
    #[serde(rename = "plain")]
    Plain,
}

// What a legend says of labelled ground, and of the white rest.

/// All lines left have the label there.
pub(crate) const CERTAIN: [&str; 2] = ["ground certain to have label", "white: still uncertain"];
/// The same, but a label contradicts it.
pub(crate) const REFUTED: [&str; 2] =
    ["ground taken to be certain of label", "white: still uncertain"];
/// All lines of a credible set have the label there.
pub(crate) const AGREED: [&str; 2] =
    ["all lines of the set have label", "white: lines of the set differ"];
impl Ground {
    /// What a belief knows of an area.
    pub fn of(belief: &dyn ReadOut, area: MissionArea) -> Self {
        if let Some(table) = belief.hypotheses() {
            return Self::Credible(bands::of(table, &area));
        }
        let support = |lines: &Lines| lines.support().collect::<Vec<_>>();
        belief.version_space().map_or(Self::Plain, |lines| Self::certain(area, &support(lines)))
    }

    /// Its polygons.
    pub(crate) fn rings(&mut self) -> Vec<&mut Way> {
        match self {
            Self::Labelled(regions) => regions.iter_mut().map(|it| &mut it.0).collect(),
            Self::Credible(bands) => bands.iter_mut().flat_map(|it| &mut it.rings).collect(),
            Self::Plain => Vec::new(),
        }
    }

    /// The ground that some samples leave certain. They bound the lines, in cyclic order.
    pub fn certain(area: MissionArea, support: &[Sample]) -> Self {
        let certain = |label| Polygon::certain(area, support, label);
        Self::Labelled([Label::Positive, Label::Negative].map(certain))
    }
}
