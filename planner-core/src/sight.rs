//! What the search sees along a ray: which ground surely has one label, and how to get past it.
//!
//! Ground that is certain to have one label is convex, so on a ray it is an interval of speeds. But
//! positions are rounded to the lattice and so not quite on the ray. A [`Sightline`] carries a proven
//! bound on that rounding: ground is skipped only where it is certain whatever the rounding, and what
//! is left is settled by the exact predicate.

use heapless::Vec;

use crate::area::Area;
use crate::candidates::Candidates;
use crate::cell::Certainty;
use crate::dynamics::Ray;
use crate::lattice::{Site, Vector};
use crate::sample::Label;

/// A bound of the candidates, seen from where the agent stands.
struct Sightline {
    along: Vector,
    /// The bound's value at the agent's position.
    here: i64,
    /// How far rounding can put a value off the ray's linear prediction.
    slack: i64,
}

impl Sightline {
    /// The bound's value at a speed on a ray, within `slack`.
    ///
    /// From the agent's position it is `k step / 2^8 + e` to the one at speed `k`, with components
    /// of `e` of at most 1/2, so the value there is `here + k cross(along, step) / 2^8 +
    /// cross(along, e)`. Shifting the product loses less than 1, `k` times; `cross(along, e)` is at
    /// most `(|along.x| + |along.z|) / 2`.
    const fn at(&self, step: Vector, speed: u16) -> i64 {
        self.here + speed as i64 * (self.along.cross(step) >> Ray::STEP_BITS)
    }
}

/// All that a search sees from one position.
pub(crate) struct Sight<'a, const E: usize> {
    ground: Candidates<'a, E>,
    area: Area,
    from: Site,
    lines: Vec<Sightline, E, u8>,
    examined: u32,
}

impl<'a, const E: usize> Sight<'a, E> {
    /// What the bounds of candidates look like from a position, for motions of some number of speeds.
    pub(crate) fn new(ground: Candidates<'a, E>, area: Area, from: Site, speeds: u16) -> Self {
        let mut lines = Vec::new();
        for bound in ground.bounds() {
            let along = bound.along;
            let size = i64::from(along.x.unsigned_abs()) + i64::from(along.z.unsigned_abs());
            let slack = size / 2 + 1 + i64::from(speeds);
            // As many vertices as edges, and these fit: nothing is refused.
            let _ = lines.push(Sightline { along, here: bound.at(from), slack });
        }
        Self { ground, area, from, lines, examined: 0 }
    }

    /// Actions whose position was looked at so far.
    pub(crate) fn examined(&self) -> u32 {
        self.examined
    }

    /// The highest speed from `slowest` to `fastest` at which the ray ends inside the area on
    /// uncertain ground.
    pub(crate) fn fastest(&mut self, ray: &Ray, slowest: u16, fastest: u16) -> Option<u16> {
        let mut high = self.farthest_inside(ray, fastest)?;
        while high >= slowest {
            let Some(label) = self.surely(ray, high) else {
                if self.is_uncertain(ray, high) {
                    return Some(high);
                }
                high = high.checked_sub(1)?;
                continue;
            };
            // Ground that surely has one label is an interval of speeds: if it holds the slowest
            // too, it holds all between.
            if self.surely(ray, slowest) == Some(label) {
                return None;
            }
            let mut low = slowest;
            while high - low > 1 {
                let middle = low.midpoint(high);
                if self.surely(ray, middle) == Some(label) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            high = low;
        }
        None
    }

    /// The highest speed, up to `fastest`, that does not leave the area: a ray leaves it once.
    fn farthest_inside(&self, ray: &Ray, fastest: u16) -> Option<u16> {
        let inside = |speed| self.position(ray, speed).is_some_and(|q| self.area.contains(q));
        if inside(fastest) {
            return Some(fastest);
        }
        let (mut low, mut high) = (0, fastest);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if inside(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        inside(low).then_some(low)
    }

    fn position(&self, ray: &Ray, speed: u16) -> Option<Site> {
        self.from.step(ray.displacement(speed)).ok()
    }

    /// The label that the ray's ground at a speed has however positions are rounded.
    fn surely(&mut self, ray: &Ray, speed: u16) -> Option<Label> {
        self.examined += 1;
        let (mut below, mut above) = (true, true);
        for line in &self.lines {
            let value = line.at(ray.step, speed);
            below &= value <= -line.slack;
            above &= value >= line.slack;
            if !below && !above {
                return None;
            }
        }
        Some(if above { Label::Positive } else { Label::Negative })
    }

    fn is_uncertain(&self, ray: &Ray, speed: u16) -> bool {
        self.position(ray, speed).is_some_and(|q| self.ground.certainty(q) == Certainty::Uncertain)
    }
}
