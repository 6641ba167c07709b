//! Rules on the direction of travel, modulo pi.

use heapless::Vec;

use crate::geometry::approximate::heading_of;
use crate::geometry::arc::SlopeArc;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::Vector;
use crate::motion::dynamics::Side;

/// A rule on the direction of travel.
pub trait DirectionRule {
    /// Whether travel in this direction is allowed. Exact.
    fn admits(&self, direction: Vector) -> bool;

    /// How far a forbidden heading can turn to a side and stay forbidden, in a heading's units; a lower bound.
    fn forbidden_until(&self, heading: Heading, direction: Vector, side: Side) -> u32;
}

/// A rule by arcs. Its default admits any direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ArcRule {
    /// The direction must lie in this arc.
    pub inside: Option<SlopeArc>,
    /// The direction must not lie in this arc.
    pub outside: Option<SlopeArc>,
}

impl DirectionRule for ArcRule {
    fn admits(&self, direction: Vector) -> bool {
        self.inside.is_none_or(|arc| arc.contains(direction))
            && self.outside.is_none_or(|arc| !arc.contains(direction))
    }

    fn forbidden_until(&self, heading: Heading, direction: Vector, side: Side) -> u32 {
        let end = match (self.inside.filter(|arc| !arc.contains(direction)), self.outside) {
            (Some(arc), _) => ends(arc, side).0,
            (None, Some(arc)) => ends(arc, side).1,
            (None, None) => return 0,
        };
        turn_to(heading, end, side)
    }
}

/// Arcs that lie within half a turn of one another, made one where they overlap.
///
/// Up to eight that are apart. A further one is joined to the first, with all that lies between:
/// hypotheses that nothing was pruned from leave no gaps at all.
#[derive(Clone, Debug, Default)]
pub(crate) struct ArcUnion {
    arcs: Vec<SlopeArc, 8, u8>,
}

impl ArcUnion {
    /// The arcs, of which no two overlap.
    pub(crate) fn arcs(&self) -> &[SlopeArc] {
        &self.arcs
    }

    fn join(&mut self, mut arc: SlopeArc) {
        let overlap =
            |a: &SlopeArc, b: &SlopeArc| a.from().cross(b.to()) >= 0 && b.from().cross(a.to()) >= 0;
        // What overlaps none of two that overlap does not overlap their union.
        self.arcs.retain(|other| {
            let apart = !overlap(other, &arc);
            if !apart {
                arc = arc.hull(*other);
            }
            apart
        });
        if let Err(arc) = self.arcs.push(arc)
            && let Some(first) = self.arcs.first_mut()
        {
            *first = first.hull(arc);
        }
    }
}

impl FromIterator<SlopeArc> for ArcUnion {
    fn from_iter<I: IntoIterator<Item = SlopeArc>>(arcs: I) -> Self {
        let mut union = Self::default();
        arcs.into_iter().for_each(|arc| union.join(arc));
        union
    }
}

/// A rule by a union of arcs: the direction must lie in one of them, or in none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnionRule<'a> {
    /// The arcs.
    pub arcs: &'a [SlopeArc],
    /// Whether the direction must lie among them.
    pub among: bool,
}

impl UnionRule<'_> {
    fn holder(&self, direction: Vector) -> Option<&SlopeArc> {
        self.arcs.iter().find(|arc| arc.contains(direction))
    }
}

impl DirectionRule for UnionRule<'_> {
    fn admits(&self, direction: Vector) -> bool {
        self.holder(direction).is_some() == self.among
    }

    fn forbidden_until(&self, heading: Heading, direction: Vector, side: Side) -> u32 {
        if let Some(arc) = self.holder(direction) {
            return turn_to(heading, ends(*arc, side).1, side);
        }
        let turns = self.arcs.iter().map(|arc| turn_to(heading, ends(*arc, side).0, side));
        turns.min().unwrap_or(u32::MAX)
    }
}

/// Covers the error of a heading.
const MARGIN: u32 = Angle::of_radians(1e-4).0;

/// Where a heading that turns to a side, or its opposite, enters an arc, and where it leaves it.
fn ends(arc: SlopeArc, side: Side) -> (Vector, Vector) {
    match side {
        Side::Left => (arc.from(), arc.to()),
        Side::Right => (arc.to(), arc.from()),
    }
}

/// The turn to a side until a heading points along a direction or its opposite, at least.
fn turn_to(heading: Heading, direction: Vector, side: Side) -> u32 {
    let ahead = heading_of(direction).0.wrapping_sub(heading.0);
    let turn = match side {
        Side::Left => ahead,
        Side::Right => ahead.wrapping_neg(),
    } % Angle::HALF_TURN.0;
    // A turn of all but half a turn may be one of none.
    if turn > Angle::HALF_TURN.0 - MARGIN { 0 } else { turn.saturating_sub(MARGIN) }
}
