//! An area that most likely has one label everywhere, and what may be left of the other one.

use crate::belief::front::Tracker;
use crate::belief::sample::Label;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::search::dead_end::place;

/// So many places stand for an area.
pub(crate) const PLACES: u32 = 36;

/// All of an area has one label, most likely.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OneLabel {
    /// That label.
    pub label: Label,
    /// The share of the area that is expected to have the other label all the same, from 0 to 1. A boundary that is left
    /// cuts off a piece at the border, or a corner.
    pub other: f32,
}

impl OneLabel {
    /// What a tracker says of an area; `None` where places all over it do not most likely have one label.
    ///
    /// Cost: 36 [questions](Tracker::share_above).
    pub fn of<const K: usize, const M: usize, const L: usize>(
        tracker: &Tracker<K, M, L>,
        area: &impl Workspace,
    ) -> Option<Self> {
        let (mut sum, mut count, mut is_above, mut is_below) = (0.0, 0.0, false, false);
        for site in anywhere(area) {
            let share = tracker.share_above(site);
            (is_above, is_below) = (is_above || share > 0.5, is_below || share <= 0.5);
            (sum, count) = (sum + share, count + 1.0);
        }
        let share = sum / count;
        match (is_above, is_below) {
            (true, false) => Some(Self { label: Label::Positive, other: 1.0 - share }),
            (false, true) => Some(Self { label: Label::Negative, other: share }),
            _ => None,
        }
    }
}

/// Some places all over an area.
pub(crate) fn anywhere(area: &impl Workspace) -> impl Iterator<Item = Site> {
    (0..PLACES).filter_map(|k| place(area, k))
}
