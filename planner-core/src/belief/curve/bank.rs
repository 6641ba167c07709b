//! A sum of Gaussians: three for each of five gaits.
//!
//! On the way a share of the mass leaves its gait, and comes back as one Gaussian into each. Where a front has often turned
//! corners, more leaves, and more of it comes back into corners. So places of a jagged shore are wider than those of a
//! smooth one.
//!
//! A label splits each Gaussian: the label tells nothing with the chance that it is false, or it is true. Those that change
//! the distribution of the offset the least are merged until three are left (Runnalls 2007).

use crate::belief::curve::gaussian::{BEND, Gait, Gaussian, Offset};
use crate::belief::curve::mixture::Mixture;
use crate::belief::curve::normal::Normal;
use crate::geometry::approximate::{inverse_sqrt, sqrt};

/// Gaussians of a gait. With four or five, maps are up to 10 % nearer, and a label costs a third to two thirds more.
const EACH: usize = 3;

/// The gaits: straight on, gentle and tight bends, and corners.
const GAITS: [Gait; 5] = [
    Gait { noise: [0.0003, 0.0, 0.0], fades: 0.0, prior: 0.30 },
    Gait { noise: [0.015, 0.0, 0.0], fades: 1.0 / 20.0, prior: 0.45 },
    Gait { noise: [0.05, 0.0, 0.0], fades: 1.0 / 8.0, prior: 0.20 },
    Gait { noise: [0.1, 0.4, 0.0], fades: 1.0 / 3.0, prior: 0.03 },
    Gait { noise: [0.1, 1.0, 0.7], fades: 1.0 / 3.0, prior: 0.02 },
];

/// So many of them are smooth; what the corners are of the whole if nothing is known.
const SMOOTH: usize = 3;
const CORNERS: f32 = 0.05;

/// Parts of a gait's Gaussians: a label splits each of them.
const PARTS: usize = 2 * EACH;

/// The mass that leaves its gait in a reach.
const LEAVES: f32 = 0.02;

/// And so much more by the share of corners, where these are more than usual.
const OFTEN: f32 = 0.5;

/// How fast the usual share follows that of the corners, in a reach. So much of it stays as it was at first.
const LEARNS: f32 = 0.025;
const KEPT: f32 = 0.2;

/// Of a Gaussian of less weight none is made.
const LIGHT: f32 = 1e-6;

/// Three Gaussians one deviation of the turn apart have so much of it each: together they have all of it.
const APART: f32 = 0.577_35;

/// How many there are.
const ALL: usize = EACH * GAITS.len();

/// What they say of the offset at a place.
pub(crate) type Offsets = Mixture<ALL>;

/// The sum. Weights make 1 together.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Bank {
    of: [[Gaussian; EACH]; GAITS.len()],
    /// How much of the front went round corners so far.
    corners: f32,
}

/// A label as it is taken in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrontLabel {
    /// +1 or -1.
    pub(crate) sign: f32,
    /// Where, to the left of the reference, in reaches.
    pub(crate) left: f32,
    /// The chance that it is false.
    pub(crate) errs: f32,
    /// The variance of where it was read.
    pub(crate) blur: f32,
}

impl Bank {
    /// Nothing is known.
    pub(crate) const NONE: Self =
        Self { of: [[Gaussian::NONE; EACH]; GAITS.len()], corners: CORNERS };

    /// Forgets how the front went.
    pub(crate) const fn forget(&mut self) {
        self.corners = CORNERS;
    }

    /// Begins with deviations of offset and turn, where it is: it is large.
    #[inline(never)]
    pub(crate) fn begin(&mut self, [offset, turn]: [f32; 2]) {
        for (some, share) in self.of.iter_mut().zip(shares(self.corners)) {
            for (it, side) in some.iter_mut().zip([-1.0, 0.0, 1.0]) {
                let spread = [offset, APART * turn, BEND];
                *it = Gaussian::about(share / EACH as f32, side * turn, spread);
            }
        }
    }

    fn all(&self) -> impl Iterator<Item = &Gaussian> {
        self.of.iter().flatten()
    }

    /// Whether motions and labels can have made it.
    pub(crate) fn is_valid(&self) -> bool {
        let sum: f32 = self.all().map(|it| it.weight).sum();
        let is_share = (0.0..=1.01).contains(&self.corners);
        (sum - 1.0).abs() < 1e-2 && is_share && self.all().all(Gaussian::is_valid)
    }

    /// Goes along the reference, which has a curvature, in reaches.
    pub(crate) fn advance(&mut self, way: f32, bend: f32) {
        for (some, gait) in self.of.iter_mut().zip(&GAITS) {
            for it in some {
                it.advance(way, bend, gait);
            }
        }
    }

    /// Adds to the variance of the offset.
    pub(crate) fn widen(&mut self, variance: f32) {
        self.of.iter_mut().flatten().for_each(|it| it.widen(variance));
    }

    /// Seen the other way round. Adds to the variance of the turn.
    pub(crate) fn turn_round(&mut self, turns: f32) {
        self.of.iter_mut().flatten().for_each(|it| it.turn_round(turns));
    }

    /// Takes in how the front goes on a way. Not of a front that moves: that looks like bends.
    pub(crate) fn learn(&mut self, way: f32) {
        let learns = 1.0 - libm::expf(-LEARNS * way);
        let weight: f32 = self.of.iter().skip(SMOOTH).flatten().map(|it| it.weight).sum();
        self.corners += learns * (KEPT * CORNERS + (1.0 - KEPT) * weight - self.corners);
    }

    /// Lets a share of the mass leave its gait on a way, and come back into each.
    #[inline(never)] // what it needs is not on the stack of all that observes
    pub(crate) fn mix(&mut self, way: f32) {
        let often = self.corners - CORNERS;
        let leaves = LEAVES + if often > 0.0 { OFTEN * often } else { 0.0 };
        let leaves = 1.0 - libm::expf(-leaves * way);
        let mut pool = Gaussian::NONE;
        for it in self.all().filter(|it| it.weight > LIGHT) {
            pool.join(it, it.offset());
        }
        let all = pool.offset();
        for (some, share) in self.of.iter_mut().zip(shares(self.corners)) {
            let mut crowd = Crowd::NONE;
            for (k, it) in some.iter().enumerate() {
                crowd.add(k, Offset { weight: it.weight * (1.0 - leaves), ..it.offset() });
            }
            crowd.add(EACH, Offset { weight: leaves * share, ..all });
            crowd.settle(some, &pool);
        }
    }

    /// The place where the robot is becomes the first one behind it.
    pub(crate) fn pass(&mut self) {
        self.of.iter_mut().flatten().for_each(Gaussian::pass);
    }

    /// Takes in a label. Returns how likely it was.
    pub(crate) fn hear(&mut self, heard: FrontLabel) -> f32 {
        let FrontLabel { sign, left, errs, blur } = heard;
        let mut chance = 0.0;
        for some in &mut self.of {
            let mut crowd = Crowd::NONE;
            for (k, it) in some.iter().enumerate() {
                let per = inverse_sqrt(it.variance + blur);
                let u = sign * (left - it.mean) * per;
                let Normal { below, hazard, .. } = Normal::at(u);
                let told =
                    it.told(-sign * hazard * per, (hazard * hazard + u * hazard) * per * per);
                let told = Offset { weight: it.weight * (1.0 - 2.0 * errs) * below, ..told };
                let untold = Offset { weight: it.weight * errs, ..it.offset() };
                chance += told.weight + untold.weight;
                crowd.add(k, told);
                crowd.add(k, untold);
            }
            crowd.settle(some, &Gaussian::NONE);
        }
        let each = if chance > 0.0 { 1.0 / chance } else { 1.0 };
        self.of.iter_mut().flatten().for_each(|it| it.weight *= each);
        chance
    }

    /// Where the front lies so far ahead, with a variance that is added.
    pub(crate) fn ahead(&self, way: f32, blur: f32) -> Offsets {
        let of = |(some, gait): (&[Gaussian; EACH], &Gait)| {
            some.each_ref().map(|it| it.ahead(way, gait))
        };
        Mixture::of(self.of.iter().zip(&GAITS).flat_map(of), blur)
    }

    /// Where it lies at a place behind.
    pub(crate) fn behind(&self, place: usize) -> Offsets {
        Mixture::of(self.all().map(|it| it.offset_behind(place)), 0.0)
    }

    /// The mean turn and curvature, and the deviation of the turn.
    pub(crate) fn direction(&self) -> [f32; 3] {
        let sum =
            |of: &dyn Fn(&Gaussian) -> f32| self.all().map(|it| it.weight * of(it)).sum::<f32>();
        let [turn, bend] = [sum(&|it| it.means[0]), sum(&|it| it.means[1])];
        let square = sum(&|it| {
            let off = it.means[0] - turn;
            off * off + it.rest[0] + it.gain[0] * it.gain[0] * it.variance
        });
        [turn, bend, sqrt(square)]
    }

    /// Moves the reference: by an offset, a turn, and a curvature.
    pub(crate) fn shift(&mut self, [offset, turn, bend]: [f32; 3]) {
        for it in self.of.iter_mut().flatten() {
            it.mean -= offset;
            it.means[0] -= turn;
            it.means[1] -= bend;
        }
    }
}

/// The share of each gait where the front went round corners for so much of its way.
fn shares(corners: f32) -> impl Iterator<Item = f32> {
    let smooth = (1.0 - corners) / (1.0 - CORNERS);
    let factor = move |n: usize| if n < SMOOTH { smooth } else { corners / CORNERS };
    GAITS.iter().enumerate().map(move |(n, gait)| gait.prior * factor(n))
}

/// An offset of one of the Gaussians that come together.
#[derive(Clone, Copy, Debug)]
struct CrowdMember {
    /// The number of the Gaussian that it is of.
    of: usize,
    /// Those with the same number go into one.
    group: usize,
    offset: Offset,
}

/// Offsets that are to be as few Gaussians as [`EACH`]. All else of a Gaussian goes with its offset.
struct Crowd {
    parts: heapless::Vec<CrowdMember, PARTS, u8>,
}

impl Crowd {
    const NONE: Self = Self { parts: heapless::Vec::new() };

    /// Adds an offset of a Gaussian, if it has a weight.
    fn add(&mut self, of: usize, offset: Offset) {
        if offset.weight > LIGHT * LIGHT {
            let group = self.parts.len();
            let _ = self.parts.push(CrowdMember { of, group, offset }); // there is room
        }
    }

    /// Puts those into one group that change the distribution the least, until there are few.
    fn group(&mut self) {
        let mut groups = [None; PARTS];
        for (it, part) in groups.iter_mut().zip(&self.parts) {
            *it = Some((part.offset, libm::log2f(part.offset.variance)));
        }
        for _ in EACH..self.parts.len() {
            let mut best: Option<(f32, usize, usize, Offset)> = None;
            for (j, b) in groups.iter().enumerate() {
                for (i, a) in groups.iter().take(j).enumerate() {
                    let (Some((a, a_log)), Some((b, b_log))) = (a, b) else { continue };
                    let both = a.with(*b);
                    let cost = both.weight * libm::log2f(both.variance)
                        - a.weight * a_log
                        - b.weight * b_log;
                    if best.is_none_or(|best| cost < best.0) {
                        best = Some((cost, i, j, both));
                    }
                }
            }
            let Some((_, into, gone, both)) = best else { break };
            for (n, it) in groups.iter_mut().enumerate() {
                match n {
                    _ if n == into => *it = Some((both, libm::log2f(both.variance))),
                    _ if n == gone => *it = None,
                    _ => {}
                }
            }
            for part in self.parts.iter_mut().filter(|it| it.group == gone) {
                part.group = into;
            }
        }
    }

    /// Makes them Gaussians again, in place of those that they are of. The pool comes after these.
    #[inline(never)] // it is called in two places, with some Gaussians on the stack
    fn settle(&mut self, some: &mut [Gaussian; EACH], pool: &Gaussian) {
        self.group();
        let mut new = [Gaussian::NONE; EACH];
        let mut free = new.iter_mut();
        for group in 0..PARTS {
            if !self.parts.iter().any(|it| it.group == group) {
                continue;
            }
            let Some(to) = free.next() else { break };
            for of in 0..=EACH {
                let offsets = self
                    .parts
                    .iter()
                    .filter(|it| (it.group, it.of) == (group, of))
                    .map(|it| it.offset);
                if let Some(offset) = offsets.reduce(Offset::with) {
                    to.join(some.get(of).unwrap_or(pool), offset);
                }
            }
        }
        *some = new;
    }
}
