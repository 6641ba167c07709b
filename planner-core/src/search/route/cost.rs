//! The metres that a route is expected to take until it meets a boundary.
//!
//! Some regions stand for all: each is as likely. A leg that runs through a region for so many metres detects it with
//! probability `1 - exp(-k metres)`. A region that no leg detects costs the way of a whole survey besides.

use heapless::Vec;

use crate::belief::field::{BoundaryOdds, Field, Region, RegionShape};
use crate::geometry::approximate::sqrt;
use crate::search::route::corners::{Corners, Hears};

/// Regions that stand for all.
pub(crate) const REGIONS: usize = 96;

/// The way of a survey that is still to come, as a share of one in lanes of a patch's width.
const SURVEY: f32 = 0.7;

/// A region that is missed with less than this probability is detected.
const HEARD: f32 = 0.03;

/// The regions, and how well a way hears them.
pub(super) struct Costs {
    regions: Vec<Region, REGIONS>,
    /// Detections a metre.
    rate: f32,
    /// Metres that follow where nothing was met.
    after: f32,
    /// Visits of a region by a leg that may still be made.
    pub(super) visits: u32,
}

impl Costs {
    /// Of no regions yet. `visits` bounds the work.
    pub(super) fn new(hears: Hears, visits: u32) -> Self {
        Self { regions: Vec::new(), rate: hears.rate(), after: 0.0, visits }
    }

    /// Takes what a field says, where it is: it is large.
    pub(super) fn stand_for(&mut self, field: &Field, sought: BoundaryOdds) {
        let [x, z] = field.layout.half;
        self.after = SURVEY * 2.0 * x * z / field.layout.patch;
        let step = sought.odds() / REGIONS as f32;
        let (mut sum, mut next) = (0.0, 0.5 * step);
        field.each(|region, odds| {
            sum += odds;
            while sum > next && self.regions.push(region).is_ok() {
                next += step;
            }
        });
    }

    /// The cost of a route from a place, metres. `None` if it is not below `most`, leads nowhere, or the visits are used
    /// up.
    pub(super) fn cost(&mut self, from: [f32; 2], corners: &Corners, most: f32) -> Option<f32> {
        if corners.is_empty() {
            return None;
        }
        let count = self.regions.len() as f32;
        let mut left = [1.0_f32; REGIONS];
        let (mut cost, mut before, mut place) = (0.0, count, from);
        for corner in corners {
            let mut visits = 0;
            let leg = Segment::of(place, *corner);
            let mut sum = 0.0;
            for (left, region) in left.iter_mut().zip(&self.regions) {
                if *left > 0.0 {
                    visits += 1;
                    let way = leg.way_in(region);
                    if way > 0.0 {
                        *left *= missed(self.rate * way);
                    }
                    sum += *left;
                }
            }
            self.visits = self.visits.checked_sub(visits)?;
            cost += 0.5 * (before + sum) * leg.length;
            if cost >= most * count {
                return None;
            }
            (before, place) = (sum, *corner);
        }
        cost += before * self.after;
        (cost < most * count).then_some(cost / if count > 0.0 { count } else { 1.0 })
    }
}

/// About `exp(-x)` of a number that is not negative.
fn missed(x: f32) -> f32 {
    let part = 1.0 + x * (0.25 + 0.031_25 * x);
    let square = part * part;
    let whole = 1.0 / (square * square);
    if whole > HEARD { whole } else { 0.0 }
}

/// A straight way.
struct Segment {
    from: [f32; 2],
    along: [f32; 2],
    length: f32,
}

impl Segment {
    fn of(from: [f32; 2], to: [f32; 2]) -> Self {
        let (x, z) = (to[0] - from[0], to[1] - from[1]);
        let length = sqrt(x * x + z * z);
        let per = if length > 0.0 { 1.0 / length } else { 0.0 };
        Self { from, along: [x * per, z * per], length }
    }

    /// The metres of it that lie in a region.
    fn way_in(&self, region: &Region) -> f32 {
        let inside = match region.shape {
            RegionShape::Disc { centre, radius } => {
                let (x, z) = (centre[0] - self.from[0], centre[1] - self.from[1]);
                let aside = self.along[0] * z - self.along[1] * x;
                let square = radius * radius - aside * aside;
                if square > 0.0 {
                    let (ahead, half) = (self.along[0] * x + self.along[1] * z, sqrt(square));
                    self.between(ahead - half, ahead + half)
                } else {
                    0.0
                }
            }
            RegionShape::HalfPlane { normal, offset } => {
                let off = offset - normal[0] * self.from[0] - normal[1] * self.from[1];
                let pace = normal[0] * self.along[0] + normal[1] * self.along[1];
                match () {
                    () if pace > 1e-6 => self.between(0.0, off / pace),
                    () if pace < -1e-6 => self.between(off / pace, self.length),
                    () => {
                        if off > 0.0 {
                            self.length
                        } else {
                            0.0
                        }
                    }
                }
            }
        };
        if region.is_inside { inside } else { self.length - inside }
    }

    /// How much of it lies between two places ahead.
    fn between(&self, from: f32, to: f32) -> f32 {
        let from = if from > 0.0 { from } else { 0.0 };
        let to = if to < self.length { to } else { self.length };
        if to > from { to - from } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    #[test]
    fn the_way_in_a_region_is_what_many_places_say() {
        let mut draws = Draws::new(3);
        for n in 0..400 {
            let mut place = || [(); 2].map(|()| 100.0 * draws.unit() as f32 - 50.0);
            let (from, to, centre) = (place(), place(), place());
            let turn = f64::from(centre[0]);
            let normal = [libm::cos(turn) as f32, libm::sin(turn) as f32];
            let shape = if n % 2 == 0 {
                RegionShape::Disc { centre, radius: 25.0 }
            } else {
                RegionShape::HalfPlane { normal, offset: 0.5 * centre[1] }
            };
            let leg = Segment::of(from, to);
            let region = Region { shape, is_inside: n % 3 > 0 };
            let is_in = |k: i32| {
                let at = [0, 1].map(|i| from[i] + (to[i] - from[i]) * (k as f32 + 0.5) / 2_000.0);
                let is_in = match shape {
                    RegionShape::Disc { centre, radius } => {
                        (at[0] - centre[0]).powi(2) + (at[1] - centre[1]).powi(2) < radius * radius
                    }
                    RegionShape::HalfPlane { normal, offset } => {
                        at[0] * normal[0] + at[1] * normal[1] < offset
                    }
                };
                is_in == region.is_inside
            };
            let share = (0..2_000).filter(|k| is_in(*k)).count() as f32 / 2_000.0;
            let way = leg.way_in(&region);
            assert!((way - share * leg.length).abs() < 0.2, "{n}: {way}, {share}");
        }
    }

    #[test]
    fn what_is_missed_falls_with_the_way() {
        for k in 0..80 {
            let x = k as f32 * 0.05;
            assert!((missed(x) - (-x).exp()).abs() < 0.04, "{x}: {}", missed(x));
            assert!(missed(x + 0.05) <= missed(x));
        }
    }
}
