//! An area that most likely has one label everywhere, and what may be left of the other one.

use crate::belief::field::{Field, Left, Seeking};
use crate::belief::sample::{Label, Sample};
use crate::belief::trust::AnyReliability;
use crate::geometry::workspace::Workspace;

/// The area has one label where what is left has at most this probability.
const LEFT: f32 = 0.01;

/// All of an area has one label, most likely.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OneLabel {
    /// That label.
    pub label: Label,
    /// Patches that hold a disc of this radius were sought, metres. A smaller one may have been missed, and a boundary
    /// that cuts off less than half of it at the border.
    pub radius: f32,
    /// The boundaries that may be left all the same.
    pub left: Left,
}

impl OneLabel {
    /// What given points and labels say that were read all over the part of an area that motions
    /// [aim for](crate::planner::setup::aimed_for); `None` where it does not most likely have one label. A straight
    /// boundary has no patches.
    pub fn of<G: Workspace>(
        area: &G,
        (seeking, patches): (Seeking, bool),
        reliability: AnyReliability,
        (given, labels): (&[Sample], &[Sample]),
    ) -> Option<Self> {
        let p = match reliability {
            AnyReliability::Known(known) => known.single(),
            AnyReliability::Unknown(prior) => {
                let [a, b] = prior.parameters().map(|it| it as f32);
                a / (a + b)
            }
        };
        let mut field = Field::NONE;
        field.begin(area, (seeking, patches), p).ok()?;
        for it in given {
            field.know(it.site, it.label);
        }
        for it in labels {
            field.observe(it.site, it.label);
        }
        Self::of_field(&field, field.left(field.sought()))
    }

    /// What a field says that leaves so much.
    pub(crate) fn of_field(field: &Field, left: Left) -> Option<Self> {
        let is_one = left.coast < LEFT && left.patch.is_none_or(|it| it < LEFT);
        is_one.then(|| Self { label: field.label(), radius: field.layout.patch, left })
    }
}
