//! Which mission something is of: a number made of its settings.

use crate::geometry::workspace::Workspace;

/// Tells the settings of a mission from others. Two missions have the same with a probability of one in four thousand
/// million.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mark(u32);

impl Mark {
    /// Of no settings.
    pub const NONE: Self = Self(0x811C_9DC5);

    /// The same with more settings, given as numbers.
    #[must_use]
    pub fn and(self, words: impl IntoIterator<Item = u32>) -> Self {
        Self(words.into_iter().fold(self.0, |mark, word| {
            let mixed = (mark ^ word).wrapping_mul(0x9E37_79B1);
            mixed ^ mixed >> 15
        }))
    }

    /// The same with the area in which motions end.
    #[must_use]
    pub(crate) fn within<G: Workspace>(self, area: &G) -> Self {
        let bounds = area.bounds();
        let corners = [bounds.min(), bounds.max()].into_iter();
        let corners = corners.chain(area.sides().map(|side| side.from));
        let places = corners.flat_map(|at| [at.x() as u32, at.z() as u32]);
        let keep_outs = area.keep_outs().flat_map(|it| {
            let corners = it.corners.iter().flat_map(|at| [at.x() as u32, at.z() as u32]);
            corners.chain([it.radius])
        });
        let chart = area.chart().into_iter().flat_map(|it| {
            let (corner, [columns, rows]) = (it.bounds().min(), it.size());
            let frame =
                [corner.x() as u32, corner.z() as u32, it.side(), columns.into(), rows.into()];
            frame.into_iter().chain(it.cells().iter().copied())
        });
        self.and([bounds.margin()]).and(places).and(keep_outs).and(chart)
    }
}
