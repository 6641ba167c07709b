//! What a search sees from a position: where certain ground and the area end.
//!
//! The positions of one speed lie on a circle around the agent. Where all bounds of the candidates have
//! the circle on one side, the ground there is certain; so one can turn at once to where the first of
//! them cuts the circle.

use heapless::Vec;

use crate::belief::candidates::{Candidates, Certainty};
use crate::belief::sample::Label;
use crate::geometry::approximate::HALF_TURN;
use crate::geometry::area::Area;
use crate::geometry::direction::Heading;
use crate::geometry::lattice::{Site, Vector};
use crate::motion::action::ActionGrid;
use crate::motion::dynamics::Side;
use crate::search::circles::Ranked;
use crate::search::crossing::Mark;
use crate::search::problem::Effort;

/// Marks that are kept. Where there are more bounds, each mark stands for several.
const MARKS: usize = 16;

/// More room than there is between any two headings.
const NOTHING_IS_SURE: f32 = core::f32::consts::PI;

/// A turn as a binary angle.
fn turned(turn: i32) -> u32 {
    (turn.max(0) as u32) << 2
}

/// All that a search sees from one position.
pub(crate) struct Sight<'a> {
    pub(crate) ground: Candidates<'a>,
    pub(crate) area: Area,
    pub(crate) site: Site,
    pub(crate) grid: ActionGrid,
    /// Room for the rounding of positions to the lattice and for the errors of marks, in radii: enough
    /// for the innermost circle if the ray to this one is certain throughout.
    room: f32,
    /// What all candidates say of where the agent stands.
    pub(crate) here: Certainty,
    /// Within this distance all ground is certain, lattice units.
    clear: f32,
    /// The bounds of the candidates within reach, or every so-many-th of all.
    marks: Vec<Mark, MARKS, u8>,
    /// How far within reach the bounds are from the marks that stand for them, lattice units.
    aside: f32,
    /// Whether some of those beyond reach lie below, or above.
    beyond: [bool; 2],
    /// The sides of the area within reach, with what is outside uphill; cut with the circle looked at
    /// when it comes to them.
    sides: Vec<Mark, 4, u8>,
    sides_are_cut: bool,
    /// Of the circle looked at.
    inverse_radius: f32,
    /// Those within the shortest motion, as they cut its circle.
    walls: Vec<Mark, 4, u8>,
    /// What searches may cost, and have: with no looks left they end with the best so far.
    pub(crate) effort: Effort,
    /// The best action that a rule has barred: after a search that found none, the best by no rule.
    pub(crate) barred: Option<Ranked>,
    /// Whether searches are to keep it.
    pub(crate) keeps_barred: bool,
}

impl<'a> Sight<'a> {
    /// From a position inside the area, for motions on some grid; nothing is seen before
    /// [`open`](Self::open).
    pub(crate) fn new(
        ground: Candidates<'a>,
        area: Area,
        site: Site,
        grid: ActionGrid,
        effort: Effort,
    ) -> Self {
        // A position is rounded by 0.71 units at most.
        let room = 3e-5 + 1.0 / grid.step_units();
        let room = if room < 0.01 { room } else { NOTHING_IS_SURE };
        Self {
            ground,
            area,
            site,
            grid,
            room,
            here: Certainty::Uncertain,
            clear: f32::INFINITY,
            marks: Vec::new(),
            aside: 0.0,
            beyond: [false; 2],
            sides: Vec::new(),
            sides_are_cut: false,
            inverse_radius: 0.0,
            walls: Vec::new(),
            effort,
            barred: None,
            keeps_barred: false,
        }
    }

    /// Sees what there is. A step of its own, so that all of this is made where it stays.
    #[must_use]
    pub(crate) fn open(&mut self) -> &mut Self {
        let grid = self.grid;
        let reach = f32::from(grid.speeds()) * grid.step_units() * (1.0 + self.room);
        self.see_bounds(reach);
        self.see_sides(reach);
        self
    }

    fn see_bounds(&mut self, reach: f32) {
        let mut signs = [false; 2];
        // Neighbours in the order of the cell look alike.
        let stride = self.ground.edges.len().div_ceil(MARKS);
        for (k, bound) in self.ground.bounds().enumerate() {
            let value = bound.at(self.site);
            let mark = Mark::of(bound, value);
            let [below, above] = &mut signs;
            *below |= value < 0;
            *above |= value > 0;
            let distance = mark.height.abs();
            self.clear = if distance < self.clear { distance } else { self.clear };
            if stride > 1 && !k.is_multiple_of(stride) {
                let aside = self.marks.last().map_or(0.0, |kept| kept.aside(&mark, reach));
                self.aside = if aside > self.aside { aside } else { self.aside };
            } else if distance < reach || stride > 1 {
                // There are so many at most: nothing is refused.
                let _ = self.marks.push(mark);
            } else {
                let [below, above] = &mut self.beyond;
                *below |= value < 0;
                *above |= value > 0;
            }
        }
        self.here = match signs {
            [true, true] => Certainty::Uncertain,
            [true, false] => Certainty::Certain(Label::Negative),
            [false, _] => Certainty::Certain(Label::Positive),
        };
        if self.here == Certainty::Uncertain {
            self.clear = 0.0;
        }
    }

    fn see_sides(&mut self, reach: f32) {
        let (from, to, site) = (self.area.min(), self.area.max(), self.site);
        let inside =
            [to.x() - site.x(), to.z() - site.z(), site.x() - from.x(), site.z() - from.z()];
        for (inside, quarters) in inside.into_iter().zip(0..) {
            let mut side = Mark::new(-(inside as f32), Heading(quarters << 30));
            // There are four: nothing is refused.
            if (inside as f32) < reach {
                let _ = self.sides.push(side);
            }
            let shortest = self.grid.step_units();
            if (inside as f32) < shortest {
                side.cut(1.0 / shortest, self.room);
                let _ = self.walls.push(side);
            }
        }
    }

    /// Whether what lies this way is further than one motion reaches.
    pub(crate) fn is_far(&self, way: Vector) -> bool {
        let reach = f32::from(self.grid.speeds() - 1) * self.grid.step_units() * (1.0 + self.room);
        self.here != Certainty::Uncertain && way.dot(way) as f32 > reach * reach
    }

    fn inverse_radius(&self, speed: u16) -> f32 {
        1.0 / (f32::from(speed) * self.grid.step_units())
    }

    /// Whether some ground on a circle may be uncertain.
    fn reaches(&self, inverse_radius: f32) -> bool {
        self.clear * inverse_radius < 1.0 + self.room
    }

    /// Looks at the circle of a speed, unless all ground up to there is certain.
    pub(crate) fn look(&mut self, speed: u16) -> bool {
        let inverse_radius = self.inverse_radius(speed);
        let reaches = self.reaches(inverse_radius);
        if reaches {
            let room = self.room;
            self.marks.iter_mut().for_each(|mark| mark.cut(inverse_radius, room));
            if self.aside > 0.0 {
                self.widen(inverse_radius);
            }
            (self.inverse_radius, self.sides_are_cut) = (inverse_radius, false);
        }
        reaches
    }

    /// Cuts again where marks stand for lines beside them.
    #[cold]
    fn widen(&mut self, inverse_radius: f32) {
        let room = self.room + self.aside * inverse_radius;
        let room = if room < NOTHING_IS_SURE { room } else { NOTHING_IS_SURE };
        self.marks.iter_mut().for_each(|mark| mark.cut_wide(inverse_radius, room));
    }

    /// The label that the circle surely has at a heading, and how far a turn keeps it.
    pub(crate) fn surely(&self, heading: Heading, side: Side) -> Option<(Label, u32)> {
        let mut marks = self.marks.iter();
        let (label, mut turn) = match (marks.next(), self.beyond) {
            (Some(first), _) => first.surely(heading, side)?,
            (None, [true, _]) => (Label::Negative, 2 * HALF_TURN),
            (None, [false, _]) => (Label::Positive, 2 * HALF_TURN),
        };
        for mark in marks {
            let (other, least) = mark.surely(heading, side)?;
            if other != label {
                return None;
            }
            turn = turn.min(least);
        }
        let [below, above] = self.beyond;
        let contradicted = if label == Label::Positive { below } else { above };
        (!contradicted).then(|| (label, turned(turn)))
    }

    /// Whether the circle surely is outside the area at a heading, and how far a turn keeps it there.
    pub(crate) fn outside(&mut self, heading: Heading, side: Side) -> Option<u32> {
        if !self.sides_are_cut {
            let (inverse_radius, room) = (self.inverse_radius, self.room);
            self.sides.iter_mut().for_each(|mark| mark.cut(inverse_radius, room));
            self.sides_are_cut = true;
        }
        beyond(&self.sides, heading, side)
    }

    /// The same of all circles: who leaves a convex area does not come back.
    pub(crate) fn walled(&self, heading: Heading, side: Side) -> Option<u32> {
        beyond(&self.walls, heading, side)
    }

    /// The way to the nearest uncertain ground inside the area; `None` when there is none.
    pub(crate) fn way_out(&self) -> Option<Vector> {
        const ONE: i32 = 1 << 30;
        let here = self.site;
        let apart = |a: i32, b: i32| (a - b) as f32;
        let from = [apart(self.area.min().x(), here.x()), apart(self.area.min().z(), here.z())];
        let to = [apart(self.area.max().x(), here.x()), apart(self.area.max().z(), here.z())];
        let mut nearest: Option<(f32, [f32; 2])> = None;
        for bound in self.ground.bounds() {
            let mark = Mark::of(bound, bound.at(here));
            let normal = mark.uphill.unit().scaled(ONE);
            let normal = [normal.x, normal.z].map(|v| v as f32 / ONE as f32);
            let along = [-normal[1], normal[0]];
            // The line's foot, and the part of the line that is inside: foot + t along.
            let foot = normal.map(|v| -v * mark.height);
            let (mut low, mut high) = (f32::NEG_INFINITY, f32::INFINITY);
            for (((foot, along), from), to) in foot.iter().zip(along).zip(from).zip(to) {
                let (a, b) = ((from - foot) / along, (to - foot) / along);
                low = low.max(a.min(b));
                high = high.min(a.max(b));
            }
            if low <= high {
                let t = 0.0_f32.clamp(low, high);
                let distance = mark.height * mark.height + t * t;
                if nearest.is_none_or(|(least, _)| distance < least) {
                    nearest = Some((distance, [foot[0] + t * along[0], foot[1] + t * along[1]]));
                }
            }
        }
        nearest.map(|(_, [x, z])| Vector { x: x as i32, z: z as i32 })
    }
}

/// Whether a circle surely is beyond one of these lines at a heading, and how far a turn keeps it there.
fn beyond(lines: &[Mark], heading: Heading, side: Side) -> Option<u32> {
    lines.iter().find_map(|line| match line.surely(heading, side) {
        Some((Label::Positive, turn)) => Some(turned(turn)),
        _ => None,
    })
}
