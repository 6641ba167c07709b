//! What a search sees from a position: where certain ground and the area end.
//!
//! The positions of one speed lie on a circle around the agent. If all lines that bound the uncertain ground have a
//! point of the circle on one side, the ground at that point is certain. So the search can turn at once to the first
//! place where such a line crosses the circle.

use heapless::Vec;

use crate::belief::cells::{CellView, Certainty};
use crate::belief::sample::Label;
use crate::geometry::angle::CoarseAngle;
use crate::geometry::approximate::{single, sqrt};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::line::Bound;
use crate::geometry::span::Span;
use crate::geometry::workspace::Workspace;
use crate::motion::action::ActionGrid;
use crate::motion::dynamics::Side;
use crate::search::crossing::SeenLine;

/// Lines that are kept. Where there are more, each stands for several.
const MOST_LINES: usize = 16;

/// A margin greater than there is between any two headings.
const NOTHING_IS_CERTAIN: f32 = core::f32::consts::PI;

/// Where certain ground ends, as seen from one position.
struct Ground {
    /// The label that all lines give to the agent's position.
    own_label: Certainty,
    /// Within this distance all ground is certain, lattice units, the margin taken off.
    certain_within: f32,
    /// The lines within reach that bound the uncertain ground, or every so-many-th of all.
    bounds: Vec<SeenLine, MOST_LINES, u8>,
    /// How far within reach the others are from the ones that stand for them, lattice units.
    aside: f32,
    /// Whether there are bounds beyond reach that have the agent on their -1 side, or on their +1 side.
    beyond: [bool; 2],
}

/// All that a search sees from one position.
pub(crate) struct View<'a, G> {
    lines: CellView<'a>,
    area: G,
    site: Site,
    speeds: u16,
    /// The shortest motion, lattice units.
    step: f32,
    /// Safety margin as a share of the radius. It covers lattice rounding and approximation errors on the
    /// smallest circle, where they matter most: what is certain there all along a ray is so on all of it.
    margin: f32,
    /// Where certain ground ends.
    ground: Ground,
    /// The sides of the area within reach, with what is outside uphill; crossed with the present circle
    /// when it comes to them.
    sides: Vec<SeenLine, 4, u8>,
    sides_are_crossed: bool,
    /// Of the present circle.
    inverse_radius: f32,
    /// The sides within the shortest motion, as they cross its circle.
    near_sides: Vec<SeenLine, 4, u8>,
}

impl<'a, G: Workspace> View<'a, G> {
    /// From a position, for motions on some grid; nothing is seen before
    /// [`open`](Self::open).
    #[expect(clippy::inline_always, reason = "its buffers are made where they stay")]
    #[inline(always)]
    pub(crate) fn new(lines: CellView<'a>, area: G, site: Site, grid: ActionGrid) -> Self {
        // A position is rounded by 0.71 units at most.
        let margin = 3e-5 + 1.0 / grid.step_units();
        let margin = if margin < 0.01 { margin } else { NOTHING_IS_CERTAIN };
        Self {
            lines,
            area,
            site,
            speeds: grid.speeds(),
            step: grid.step_units(),
            margin,
            ground: Ground {
                own_label: Certainty::Uncertain,
                certain_within: 0.0,
                bounds: Vec::new(),
                aside: 0.0,
                beyond: [false; 2],
            },
            sides: Vec::new(),
            sides_are_crossed: false,
            inverse_radius: 0.0,
            near_sides: Vec::new(),
        }
    }

    /// Sees what there is.
    pub(crate) fn open(&mut self) {
        let reach = f32::from(self.speeds) * self.step * (1.0 + self.margin);
        self.ground.see(self.lines, self.site, reach, self.margin);
        self.see_sides(reach);
    }

    fn see_sides(&mut self, reach: f32) {
        let Self { area, site, step, margin, sides, near_sides, .. } = self;
        let (area, site, step) = (&*area, *site, *step);
        let mut see = |mut side: SeenLine, has_us_inside: bool| {
            // Beyond four the others pass nothing over: the exact predicate is left.
            if -side.height < reach {
                let _ = sides.push(side);
            }
            // From beyond it a longer motion may come back to this side.
            if has_us_inside && -side.height < step {
                side.cross(1.0 / step, *margin);
                let _ = near_sides.push(side);
            }
        };
        for side in area.sides() {
            let inside = side.at(site);
            let outwards = Bound { through: side.from, along: side.along.reversed() };
            see(SeenLine::of(outwards, -inside), inside >= 0);
        }
        let (from, to) = (area.bounds().min(), area.bounds().max());
        let inside =
            [to.x() - site.x(), to.z() - site.z(), site.x() - from.x(), site.z() - from.z()];
        for (inside, quarters) in inside.into_iter().zip(0..) {
            see(SeenLine::new(-(inside as f32), Heading(quarters << 30)), inside >= 0);
        }
    }

    /// The label that all lines give to the agent's position.
    pub(crate) const fn own_label(&self) -> Certainty {
        self.ground.own_label
    }

    /// Where positions stay.
    pub(crate) const fn area(&self) -> &G {
        &self.area
    }

    /// The shortest motion, lattice units.
    pub(crate) const fn step(&self) -> f32 {
        self.step
    }

    /// How far one can travel with no uncertain ground in reach, lattice units; negative if some may be.
    pub(crate) fn out_of_reach_for(&self) -> f32 {
        let reach = f32::from(self.speeds) * self.step * (1.0 + self.margin);
        0.999 * self.ground.certain_within - reach
    }

    /// Whether a label at a position can tell something. Exact.
    pub(crate) fn can_cut(&self, site: Site) -> bool {
        self.lines.can_cut(site)
    }

    /// From a position where no label is worth it, the turn within which none is on the same circle either. Where
    /// positions err, the turn covers at least a quarter of the larger component of the shift.
    pub(crate) fn passed_over(&self, site: Site) -> u32 {
        let Vector { x, z } = self.lines.shift;
        let shift = x.unsigned_abs().max(z.unsigned_abs()) as f32;
        let (dull, skipped) = (self.lines.dull_within(site), 0.25 * shift);
        let turn = if dull > skipped { dull } else { skipped } * self.inverse_radius;
        CoarseAngle::radians(if turn < 1.0 { turn } else { 1.0 }).turn()
    }

    /// Whether what lies this way is further than one motion reaches.
    pub(crate) fn is_far(&self, way: Vector) -> bool {
        let reach = f32::from(self.speeds - 1) * self.step * (1.0 + self.margin);
        self.ground.own_label != Certainty::Uncertain && single(way.dot(way)) > reach * reach
    }

    /// Looks at the circle of a speed, unless all ground up to there is certain.
    pub(crate) fn enter_circle(&mut self, speed: u16) -> bool {
        let inverse_radius = 1.0 / (f32::from(speed) * self.step);
        let may_be_uncertain = self.ground.certain_within * inverse_radius < 1.0;
        if may_be_uncertain {
            cross_all(&mut self.ground.bounds, inverse_radius, self.margin);
            if self.ground.aside > 0.0 {
                self.widen(inverse_radius);
            }
            (self.inverse_radius, self.sides_are_crossed) = (inverse_radius, false);
        }
        may_be_uncertain
    }

    /// Crosses again where lines stand for others beside them.
    #[cold]
    fn widen(&mut self, inverse_radius: f32) {
        let margin = self.margin + self.ground.aside * inverse_radius;
        let margin = if margin < NOTHING_IS_CERTAIN { margin } else { NOTHING_IS_CERTAIN };
        self.ground.bounds.iter_mut().for_each(|line| line.cross_wide(inverse_radius, margin));
    }

    /// The label of the circle's ground at a heading, where it is certain, and how far a turn to a side
    /// keeps it so.
    pub(crate) fn certain_until(&self, heading: Heading, side: Side) -> Option<(Label, u32)> {
        certain_until(&self.ground.bounds, self.ground.beyond, heading, side)
    }

    /// How far a turn to a side keeps the circle outside the area, if it is certain to be outside at a
    /// heading.
    pub(crate) fn outside_until(&mut self, heading: Heading, side: Side) -> Option<u32> {
        if !self.sides_are_crossed {
            cross_all(&mut self.sides, self.inverse_radius, self.margin);
            self.sides_are_crossed = true;
        }
        outside_until(&self.sides, heading, side)
    }

    /// The same of all circles: a ray that leaves a convex area does not come back.
    pub(crate) fn leaves_area_until(&self, heading: Heading, side: Side) -> Option<u32> {
        outside_until(&self.near_sides, heading, side)
    }

    /// The way to the nearest uncertain ground inside the area; `None` when there is none.
    pub(crate) fn way_out(&self) -> Option<Vector> {
        self.way_out_from(self.site, |_| true).map(|(way, _)| way)
    }

    /// The same from a position, of the ways that are open, and its length.
    pub(crate) fn way_out_from(
        &self,
        here: Site,
        is_open: impl Fn(Vector) -> bool,
    ) -> Option<(Vector, f32)> {
        let bounds = self.area.bounds();
        let apart = |a: i32, b: i32| (a - b) as f32;
        let from = [apart(bounds.min().x(), here.x()), apart(bounds.min().z(), here.z())];
        let to = [apart(bounds.max().x(), here.x()), apart(bounds.max().z(), here.z())];
        let mut nearest: Option<(Vector, f32)> = None;
        let all_are_kept = here == self.site && self.ground.bounds.len() == self.lines.edges.len();
        for (k, bound) in self.lines.bounds().enumerate() {
            let kept = self.ground.bounds.get(k).filter(|_| all_are_kept);
            let line = kept.copied().unwrap_or_else(|| SeenLine::of(bound, bound.at(here)));
            let (foot, along) = line.foot_and_way();
            let mut inside = Span::inside(foot, along, from, to);
            for side in self.area.sides() {
                let way = [side.along.x as f32, side.along.z as f32];
                let cross = |v: [f32; 2]| way[0] * v[1] - way[1] * v[0];
                let t = -(single(side.at(here)) + cross(foot)) / cross(along);
                if cross(along) > 0.0 { inside.keep_above(t) } else { inside.keep_below(t) }
            }
            if inside.is_empty() {
                continue;
            }
            let t = inside.nearest(0.0);
            let distance = line.height * line.height + t * t;
            let way = [foot[0] + t * along[0], foot[1] + t * along[1]];
            let way = Vector { x: way[0] as i32, z: way[1] as i32 };
            if nearest.is_none_or(|(_, least)| distance < least) && is_open(way) {
                nearest = Some((way, distance));
            }
        }
        nearest.map(|(way, square)| (way, sqrt(square)))
    }
}

// The loops over lines depend on no type parameter. So they are compiled once, at the level of this crate.

impl Ground {
    /// Sees where it ends, as far as one motion reaches.
    fn see(&mut self, lines: CellView<'_>, site: Site, reach: f32, margin: f32) {
        let (mut signs, mut nearest) = ([false; 2], f32::INFINITY);
        // Neighbours in the order of the cell look alike.
        let stride = lines.edges.len().div_ceil(MOST_LINES);
        for (k, bound) in lines.bounds().enumerate() {
            let value = bound.at(site);
            let line = SeenLine::of(bound, value);
            let [below, above] = &mut signs;
            *below |= value < 0;
            *above |= value > 0;
            let distance = line.height.abs();
            nearest = if distance < nearest { distance } else { nearest };
            if stride > 1 && !k.is_multiple_of(stride) {
                let aside = self.bounds.last().map_or(0.0, |kept| kept.aside(&line, reach));
                self.aside = if aside > self.aside { aside } else { self.aside };
            } else if distance < reach || stride > 1 {
                // There are so many at most: nothing is refused.
                let _ = self.bounds.push(line);
            } else {
                let [below, above] = &mut self.beyond;
                *below |= value < 0;
                *above |= value > 0;
            }
        }
        self.own_label = match signs {
            [true, true] => Certainty::Uncertain,
            [true, false] => Certainty::Certain(Label::Negative),
            [false, _] => Certainty::Certain(Label::Positive),
        };
        let is_certain = self.own_label != Certainty::Uncertain;
        self.certain_within = if is_certain { nearest / (1.0 + margin) } else { 0.0 };
    }
}

/// Looks at a circle, where it crosses each of the lines.
fn cross_all(lines: &mut [SeenLine], inverse_radius: f32, margin: f32) {
    for line in lines {
        line.cross(inverse_radius, margin);
    }
}

/// The label that all lines give a circle at a heading, and how far a turn to a side keeps it so. `beyond` says whether
/// lines that are not among these have the agent on their -1 side, or on their +1 side.
fn certain_until(
    lines: &[SeenLine],
    beyond: [bool; 2],
    heading: Heading,
    side: Side,
) -> Option<(Label, u32)> {
    let mut lines = lines.iter();
    let (label, mut turn) = match (lines.next(), beyond) {
        (Some(first), _) => first.certain_until(heading, side)?,
        (None, [true, _]) => (Label::Negative, CoarseAngle::WHOLE_TURN),
        (None, [false, _]) => (Label::Positive, CoarseAngle::WHOLE_TURN),
    };
    for line in lines {
        let (other, least) = line.certain_until(heading, side)?;
        if other != label {
            return None;
        }
        turn = turn.min(least);
    }
    let [below, above] = beyond;
    let contradicted = if label == Label::Positive { below } else { above };
    (!contradicted).then(|| (label, turn.turn()))
}

/// How far a turn keeps a circle beyond one of these sides, if it is certain to be there at a heading.
fn outside_until(sides: &[SeenLine], heading: Heading, side: Side) -> Option<u32> {
    sides.iter().find_map(|line| match line.certain_until(heading, side) {
        Some((Label::Positive, turn)) => Some(turn.turn()),
        _ => None,
    })
}
