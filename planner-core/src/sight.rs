//! What a search sees from a position: where certain ground and the area end, circle by circle.
//!
//! The positions of one speed lie on a circle around the agent. Seen from there a bound of the
//! candidates is a height and a heading, and it cuts the circle where an arc cosine says. Where all
//! bounds have the circle on one side, the ground is certain; so a search turns at once to where the
//! first of them cuts it. And as certain ground of one label is convex, a ray whose end has the label
//! of the agent's own position has it throughout.
//!
//! All of this is approximate and on the safe side: what is passed over is certain. The rest is
//! settled by the exact predicate.

use heapless::Vec;

use crate::action::ActionGrid;
use crate::approximate::{HALF_TURN, UNITS_PER_RADIAN, acos, sqrt};
use crate::area::Area;
use crate::candidates::Candidates;
use crate::cell::Certainty;
use crate::direction::Heading;
use crate::dynamics::{Dynamics, Pose, Ray, Side};
use crate::lattice::{Site, Vector};
use crate::line::Bound;
use crate::problem::{Candidate, Varrho};
use crate::rule::DirectionRule;
use crate::sample::Label;

/// Room for the error of an arc cosine and of a heading: 2 10^-4 rad.
const ROOM: i32 = 35_000;

/// Within this the arc cosine falls by less than 2.3, or 2.4 with some room beside.
const STEEP: f32 = 0.9;

/// A line as seen from the agent: at a radius `r` and a heading `t` its value is
/// `height + r cos(t - uphill)`.
#[derive(Clone, Copy)]
struct Mark {
    /// Distance of the agent from the line in lattice units, positive on its +1 side, to 10^-5 of it.
    height: f32,
    /// The heading of its normal.
    uphill: Heading,
    /// On the circle looked at: up to this angle to either side of uphill, it surely is on the line's
    /// +1 side.
    above: i32,
    /// On the circle looked at: from this angle on it surely is on the other side.
    below: i32,
}

impl Mark {
    const fn new(height: f32, uphill: Heading) -> Self {
        Self { height, uphill, above: -1, below: 2 * HALF_TURN }
    }

    fn of(Bound { along, .. }: Bound, value: i64) -> Self {
        let (x, z) = (along.x as f32, along.z as f32);
        Self::new(value as f32 / sqrt(x * x + z * z), Heading::near(along.left()))
    }

    /// Looks at a circle; `room`, in radii, is for the rounding of positions to the lattice, and `slack`
    /// what it comes to as an angle where the circle is not cut at a slant.
    fn cut(&mut self, inverse_radius: f32, room: f32, slack: i32) {
        let depth = -self.height * inverse_radius;
        let (most, least) = (depth + room, depth - room);
        (self.above, self.below) = if depth.abs() < STEEP {
            let angle = acos(depth);
            (angle - slack, angle + slack)
        } else if most <= -1.0 {
            // A line that misses the circle leaves it on one side all around.
            (2 * HALF_TURN, 2 * HALF_TURN)
        } else if least >= 1.0 {
            (-1, -HALF_TURN)
        } else {
            (acos(most.clamp(-1.0, 1.0)) - ROOM, acos(least.clamp(-1.0, 1.0)) + ROOM)
        };
    }

    /// Which side of the line the circle surely is on at a heading, and how far a turn stays there.
    fn surely(&self, heading: Heading, side: Side) -> Option<(Label, i32)> {
        let turned = (heading.0.wrapping_sub(self.uphill.0) as i32) >> 2;
        let turned = if side == Side::Left { turned } else { -turned };
        let away = turned.abs();
        if away <= self.above {
            return Some((Label::Positive, self.above - turned));
        }
        // The other way around to uphill.
        let around = if turned > 0 { 2 * HALF_TURN - turned } else { away };
        (away >= self.below).then(|| (Label::Negative, around - self.below))
    }
}

/// A turn as a binary angle.
fn turned(turn: i32) -> u32 {
    (turn.max(0) as u32) << 2
}

/// The rays to one side of a heading.
struct Arm {
    pose: Pose,
    side: Side,
    /// The first that may lead anywhere.
    first: u32,
    count: u32,
}

/// A candidate and the number and side of its ray, by which ties are settled.
type Ranked = (Candidate, (u16, Side));

/// All that a search sees from one position.
pub(crate) struct Sight<'a, const E: usize> {
    ground: Candidates<'a, E>,
    area: Area,
    site: Site,
    grid: ActionGrid,
    /// Room for the rounding of positions to the lattice and for the errors of marks, in radii: enough
    /// for the innermost circle if the ray to this one is certain throughout.
    room: f32,
    /// What this comes to as an angle.
    slack: i32,
    /// What all candidates say of where the agent stands.
    here: Certainty,
    /// Within this distance all ground is certain, lattice units.
    clear: f32,
    /// The bounds of the candidates within reach.
    marks: Vec<Mark, E, u8>,
    /// Whether some of those beyond it lie below, or above.
    beyond: [bool; 2],
    /// The sides of the area within reach, with what is outside uphill.
    sides: Vec<Mark, 4, u8>,
    examined: u32,
    barred: bool,
}

impl<'a, const E: usize> Sight<'a, E> {
    /// The view from a position inside the area, for motions on some grid.
    pub(crate) fn new(ground: Candidates<'a, E>, area: Area, site: Site, grid: ActionGrid) -> Self {
        let room = 3e-5 + 3.0 / grid.step_units();
        let slack =
            if room < 0.01 { (room * 2.5 * UNITS_PER_RADIAN) as i32 + ROOM } else { HALF_TURN };
        let reach = f32::from(grid.speeds()) * grid.step_units() * (1.0 + room);
        let (mut marks, mut sides) = (Vec::new(), Vec::new());
        let (mut signs, mut beyond) = ([false; 2], [false; 2]);
        let mut clear = f32::INFINITY;
        for bound in ground.bounds() {
            let value = bound.at(site);
            let mark = Mark::of(bound, value);
            let [below, above] = &mut signs;
            *below |= value < 0;
            *above |= value > 0;
            let distance = mark.height.abs();
            clear = if distance < clear { distance } else { clear };
            if distance < reach {
                // As many vertices as edges, and these fit: nothing is refused.
                let _ = marks.push(mark);
            } else {
                let [below, above] = &mut beyond;
                *below |= value < 0;
                *above |= value > 0;
            }
        }
        let here = match signs {
            [true, true] => Certainty::Uncertain,
            [true, false] => Certainty::Certain(Label::Negative),
            [false, _] => Certainty::Certain(Label::Positive),
        };
        let (from, to) = (area.min(), area.max());
        let inside =
            [to.x() - site.x(), to.z() - site.z(), site.x() - from.x(), site.z() - from.z()];
        for (inside, quarters) in inside.into_iter().zip(0..) {
            if (inside as f32) < reach {
                let _ = sides.push(Mark::new(-(inside as f32), Heading(quarters << 30)));
            }
        }
        let clear = if here == Certainty::Uncertain { 0.0 } else { clear };
        Self {
            ground,
            area,
            site,
            grid,
            room,
            slack,
            here,
            clear,
            marks,
            beyond,
            sides,
            examined: 0,
            barred: false,
        }
    }

    /// Actions whose position was looked at so far.
    pub(crate) fn examined(&self) -> u32 {
        self.examined
    }

    /// Whether all ground is certain that one motion can reach.
    pub(crate) fn is_clear(&self) -> bool {
        !self.reaches(self.inverse_radius(self.grid.speeds() - 1))
    }

    fn inverse_radius(&self, speed: u16) -> f32 {
        1.0 / (f32::from(speed) * self.grid.step_units())
    }

    /// Whether some ground on a circle may be uncertain.
    fn reaches(&self, inverse_radius: f32) -> bool {
        self.clear * inverse_radius < 1.0 + self.room
    }

    /// Looks at the circle of a speed, unless all ground up to there is certain.
    fn look(&mut self, speed: u16) -> bool {
        let inverse_radius = self.inverse_radius(speed);
        let reaches = self.reaches(inverse_radius);
        if reaches {
            let (room, slack) = (self.room, self.slack);
            self.marks.iter_mut().for_each(|mark| mark.cut(inverse_radius, room, slack));
            self.sides.iter_mut().for_each(|mark| mark.cut(inverse_radius, room, slack));
        }
        reaches
    }

    /// The label that the circle surely has at a heading, and how far a turn keeps it.
    fn surely(&self, heading: Heading, side: Side) -> Option<(Label, u32)> {
        let mut label = match self.beyond {
            [true, true] => return None,
            [true, false] => Some(Label::Negative),
            [false, true] => Some(Label::Positive),
            [false, false] => None,
        };
        let mut turn = 2 * HALF_TURN;
        for mark in &self.marks {
            let (other, least) = mark.surely(heading, side)?;
            if *label.get_or_insert(other) != other {
                return None;
            }
            turn = turn.min(least);
        }
        label.map(|label| (label, turned(turn)))
    }

    /// Whether the circle surely is outside the area at a heading, and how far a turn keeps it there.
    fn outside(&self, heading: Heading, side: Side) -> Option<u32> {
        self.sides.iter().find_map(|mark| match mark.surely(heading, side) {
            Some((Label::Positive, turn)) => Some(turned(turn)),
            _ => None,
        })
    }

    /// The best action from here when facing some heading: see
    /// [`Problem::solve`](crate::problem::Problem::solve).
    pub(crate) fn best<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        heading: Heading,
        varrho: Varrho,
        rule: &R,
    ) -> Option<Candidate> {
        self.search(dynamics, [heading; 2], varrho, rule).map(|(candidate, _)| candidate)
    }

    /// On which side there is the better action: on the left of one heading or the right of another.
    pub(crate) fn better_side<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        headings: [Heading; 2],
        varrho: Varrho,
        rule: &R,
    ) -> Option<Side> {
        self.search(dynamics, headings, varrho, rule).map(|(_, (_, side))| side)
    }

    /// Whether the rule has kept a search from a ray that may have had a place to go.
    pub(crate) fn was_barred(&self) -> bool {
        self.barred
    }

    /// The best action on the left of one heading and the right of another.
    ///
    /// The outermost circle first, and on it to either side the first ray that will do: those after it
    /// turn more. The search ends where a circle is no better even straight ahead.
    fn search<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        [left, right]: [Heading; 2],
        varrho: Varrho,
        rule: &R,
    ) -> Option<Ranked> {
        let (grid, fan) = (self.grid, dynamics.fan());
        let arm = |heading, side, first, count| Arm {
            pose: Pose { site: self.site, heading },
            side,
            first,
            count,
        };
        let mut arms = [
            arm(left, Side::Left, 0, u32::from(fan.left)),
            arm(right, Side::Right, 1, u32::from(fan.right) + 1),
        ];
        let mut best: Option<Ranked> = None;
        for speed in (1..grid.speeds()).rev() {
            let objective = |effort| varrho.objective(grid.reach_mm(speed), effort);
            let done = arms.iter().all(|arm| arm.first >= arm.count);
            if done || best.is_some_and(|(b, _)| objective(0) < b.objective) || !self.look(speed) {
                break;
            }
            for arm in &mut arms {
                let side = arm.side;
                let found = self.first(dynamics, arm, speed, rule, |ray, n| {
                    let value = objective(ray.effort);
                    best.is_none_or(|(b, order)| {
                        value > b.objective || (value == b.objective && (n, side) < order)
                    })
                });
                if let Some((ray, n, target)) = found {
                    let (action, objective) =
                        (grid.action(ray.index, speed), objective(ray.effort));
                    best = Some((Candidate { action, target, objective }, (n, side)));
                }
            }
        }
        best
    }

    /// The first ray of an arm whose end on a circle will do, as long as rays are worth it.
    fn first<D: Dynamics, R: DirectionRule>(
        &mut self,
        dynamics: &D,
        arm: &mut Arm,
        speed: u16,
        rule: &R,
        is_worth_it: impl Fn(&Ray, u16) -> bool,
    ) -> Option<(Ray, u16, Pose)> {
        let spacing = dynamics.fan().spacing.0.max(1);
        let (pose, side) = (arm.pose, arm.side);
        let mut next = arm.first;
        while next < arm.count {
            let n = next as u16;
            let heading = dynamics.heading(pose, side, n);
            // How far this ray's verdict holds, and whether it does for the inner circles too.
            let (turn, throughout) = if let Some((label, turn)) = self.surely(heading, side) {
                (turn, self.here == Certainty::Certain(label))
            } else if let Some(turn) = self.outside(heading, side) {
                (turn, false)
            } else {
                let ray = dynamics.ray(pose, side, n);
                if !is_worth_it(&ray, n) {
                    return None;
                }
                if rule.admits(ray.step) {
                    if let Some(target) = self.uncertain_end(&ray, speed) {
                        return Some((ray, n, target));
                    }
                    (0, false)
                } else {
                    self.barred = true;
                    (rule.barred(heading, ray.step, side), true)
                }
            };
            // Rays within the turn are like this one: it is below 2^32, and a step above 2^15.
            let after = next + turn / spacing + 1;
            if throughout && next == arm.first {
                arm.first = after;
            }
            next = after;
        }
        None
    }

    /// The pose at a ray's end, if that is inside the area and on uncertain ground.
    fn uncertain_end(&mut self, ray: &Ray, speed: u16) -> Option<Pose> {
        let target = ray.arrive(self.site, speed).ok()?;
        self.examined += 1;
        let feasible = self.area.contains(target.site)
            && self.ground.certainty(target.site) == Certainty::Uncertain;
        feasible.then_some(target)
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
