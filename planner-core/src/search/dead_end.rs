//! Why a search for a way on has found none.

use crate::geometry::region::Region;

/// Why there is no way on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DeadEnd {
    /// What is uncertain is thinner than the action grid can hit, or lies outside the area.
    Resolution,
    /// There is uncertain ground, but no motion that leads towards it: the border or a keep-out is in the
    /// way, or the agent cannot turn.
    Cornered,
    /// A plan may look at so many rays, and none of these was a way on.
    Undecided,
    /// The agent is outside the area, and no motion leads back.
    Outside,
}

/// What it is where uncertain ground is in reach and no action asks there: it is too thin, unless it may lie behind a
/// keep-out.
pub(crate) fn dead_end_at<G: Region>(area: &G) -> DeadEnd {
    if area.keep_outs().next().is_some() { DeadEnd::Cornered } else { DeadEnd::Resolution }
}
