//! A sum of Gaussians: three for each of five gaits.
//!
//! On the way a share of the mass leaves its gait, and comes back as one Gaussian into each. A label splits each Gaussian:
//! the label tells nothing with the chance that it is false, or it is true. Those that change the distribution of the
//! offset the least are merged until three are left (Runnalls 2007).

use crate::belief::curve::gaussian::{BEND, Gait, Gaussian, Offset};
use crate::belief::curve::normal::Normal;
use crate::geometry::approximate::sqrt;

/// Gaussians of a gait.
const EACH: usize = 3;

/// The gaits: straight on, gentle and tight bends, and corners.
const GAITS: [Gait; 5] = [
    Gait { noise: [0.0003, 0.0, 0.0], fades: 0.0, prior: 0.30 },
    Gait { noise: [0.015, 0.0, 0.0], fades: 1.0 / 20.0, prior: 0.45 },
    Gait { noise: [0.05, 0.0, 0.0], fades: 1.0 / 8.0, prior: 0.20 },
    Gait { noise: [0.1, 0.4, 0.0], fades: 1.0 / 3.0, prior: 0.03 },
    Gait { noise: [0.1, 0.4, 0.7], fades: 1.0 / 3.0, prior: 0.02 },
];

/// The mass that leaves its gait in a reach.
const LEAVES: f32 = 0.02;

/// Of a Gaussian of less weight none is made.
const LIGHT: f32 = 1e-6;

/// Three Gaussians one deviation of the turn apart have so much of it each: together they have all of it.
const APART: f32 = 0.577_35;

/// Halvings in which a quantile is found.
const HALVINGS: u32 = 14;

/// All Gaussians at a place, as many as there are.
pub(crate) type Offsets = [Offset; EACH * GAITS.len()];

const NOTHING: Offsets = [Offset { weight: 0.0, mean: 0.0, variance: 1.0 }; EACH * GAITS.len()];

/// The sum. Weights make 1 together.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Bank {
    of: [[Gaussian; EACH]; GAITS.len()],
}

/// A label as it is taken in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Heard {
    /// +1 or -1.
    pub(crate) sign: f32,
    /// Where, to the left of the reference, in reaches.
    pub(crate) left: f32,
    /// The chance that it is false.
    pub(crate) errs: f32,
    /// The variance of where it was read.
    pub(crate) blur: f32,
}

/// Gaussians that are to be as few as [`EACH`].
type Crowd = heapless::Vec<(Gaussian, f32), { 2 * EACH }>;

impl Bank {
    /// Nothing is known.
    pub(crate) const NONE: Self = Self { of: [[Gaussian::NONE; EACH]; GAITS.len()] };

    /// Begins with deviations of offset and turn, where it is: it is large.
    #[inline(never)]
    pub(crate) fn begin(&mut self, [offset, turn]: [f32; 2]) {
        for (some, gait) in self.of.iter_mut().zip(&GAITS) {
            for (it, side) in some.iter_mut().zip([-1.0, 0.0, 1.0]) {
                let spread = [offset, APART * turn, BEND];
                *it = Gaussian::about(gait.prior / EACH as f32, side * turn, spread);
            }
        }
    }

    fn all(&self) -> impl Iterator<Item = &Gaussian> {
        self.of.iter().flatten()
    }

    /// Whether motions and labels can have made it.
    pub(crate) fn is_valid(&self) -> bool {
        let sum: f32 = self.all().map(|it| it.weight).sum();
        (sum - 1.0).abs() < 1e-2 && self.all().all(Gaussian::is_valid)
    }

    /// Goes along the reference, which has a curvature, in reaches.
    pub(crate) fn advance(&mut self, way: f32, bend: f32) {
        for (some, gait) in self.of.iter_mut().zip(&GAITS) {
            for it in some {
                it.advance(way, bend, gait);
            }
        }
        self.mix(way.abs());
    }

    /// Adds to the variance of the offset.
    pub(crate) fn widen(&mut self, variance: f32) {
        self.of.iter_mut().flatten().for_each(|it| it.widen(variance));
    }

    /// Lets a share of the mass leave its gait on a way, and come back into each.
    fn mix(&mut self, way: f32) {
        let leaves = 1.0 - libm::expf(-LEAVES * way);
        let pool = self
            .all()
            .filter(|it| it.weight > LIGHT)
            .fold(Gaussian::NONE, |pool, it| if pool.weight > 0.0 { pool.merged(it) } else { *it });
        for (some, gait) in self.of.iter_mut().zip(&GAITS) {
            let mut crowd = Crowd::new();
            for it in some.iter() {
                join(&mut crowd, Gaussian { weight: it.weight * (1.0 - leaves), ..*it });
            }
            join(&mut crowd, Gaussian { weight: leaves * gait.prior, ..pool });
            settle(&mut crowd, some);
        }
    }

    /// The place where the robot is becomes the first one behind it.
    pub(crate) fn pass(&mut self) {
        self.of.iter_mut().flatten().for_each(Gaussian::pass);
    }

    /// Takes in a label. Returns how likely it was.
    pub(crate) fn hear(&mut self, heard: Heard) -> f32 {
        let Heard { sign, left, errs, blur } = heard;
        let mut chance = 0.0;
        for some in &mut self.of {
            let mut crowd = Crowd::new();
            for it in some.iter() {
                let per = 1.0 / sqrt(it.variance + blur);
                let u = sign * (left - it.mean) * per;
                let Normal { below, hazard, .. } = Normal::at(u);
                let mut told = Gaussian { weight: it.weight * (1.0 - 2.0 * errs) * below, ..*it };
                told.hear(-sign * hazard * per, (hazard * hazard + u * hazard) * per * per);
                chance += told.weight + it.weight * errs;
                join(&mut crowd, told);
                join(&mut crowd, Gaussian { weight: it.weight * errs, ..*it });
            }
            settle(&mut crowd, some);
        }
        let each = if chance > 0.0 { 1.0 / chance } else { 1.0 };
        self.of.iter_mut().flatten().for_each(|it| it.weight *= each);
        chance
    }

    /// Where the front lies so far ahead.
    pub(crate) fn ahead(&self, way: f32) -> Offsets {
        let mut all = NOTHING;
        let of = self
            .of
            .iter()
            .zip(&GAITS)
            .flat_map(|(some, gait)| some.iter().map(move |it| (it, gait)));
        for (to, (it, gait)) in all.iter_mut().zip(of) {
            *to = it.ahead(way, gait);
        }
        all
    }

    /// Where it lies at a place behind.
    pub(crate) fn behind(&self, place: usize) -> Offsets {
        let mut all = NOTHING;
        for (to, it) in all.iter_mut().zip(self.all()) {
            *to = it.offset_behind(place);
        }
        all
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

/// What a sum of Gaussians says of the front at a place.
pub(crate) trait Sum {
    /// How much of it lies below a place.
    fn below(&self, left: f32, blur: f32) -> f32;
    /// The mean place.
    fn mean(&self) -> f32;
    /// The standard deviation.
    fn deviation(&self) -> f32;
    /// The mean distance of each Gaussian from a place.
    fn distance(&self, from: f32) -> f32;
    /// The place with so much below.
    fn quantile(&self, share: f32) -> f32;
    /// So far on either side of a place lies this share.
    fn half_width(&self, about: f32, share: f32) -> f32;
}

impl Sum for Offsets {
    fn below(&self, left: f32, blur: f32) -> f32 {
        let below = |it: &Offset| {
            if it.weight < LIGHT {
                return 0.0;
            }
            it.weight * Normal::below((left - it.mean) / sqrt(it.variance + blur))
        };
        self.iter().map(below).sum()
    }

    fn mean(&self) -> f32 {
        self.iter().map(|it| it.weight * it.mean).sum()
    }

    fn deviation(&self) -> f32 {
        let mean = self.mean();
        let square = |it: &Offset| it.weight * (it.variance + (it.mean - mean) * (it.mean - mean));
        sqrt(self.iter().map(square).sum())
    }

    fn distance(&self, from: f32) -> f32 {
        let off = |it: &Offset| it.weight * sqrt(it.variance + (it.mean - from) * (it.mean - from));
        self.iter().map(off).sum()
    }

    fn quantile(&self, share: f32) -> f32 {
        let (mean, reach) = (self.mean(), 4.0 * self.deviation());
        let (mut low, mut high) = (mean - reach, mean + reach);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.below(middle, 0.0) < share { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    fn half_width(&self, about: f32, share: f32) -> f32 {
        let (mut low, mut high) = (0.0, 4.0 * self.deviation() + (self.mean() - about).abs());
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let within = self.below(about + middle, 0.0) - self.below(about - middle, 0.0);
            if within < share { low = middle } else { high = middle }
        }
        high
    }
}

/// Adds one with the logarithm of its variance, if it has a weight.
fn join(crowd: &mut Crowd, it: Gaussian) {
    if it.weight > LIGHT * LIGHT {
        let _ = crowd.push((it, libm::log2f(it.variance)));
    }
}

/// Merges those that change the offset's distribution the least, until there is room.
#[inline(never)] // it is called in two places, with many Gaussians on the stack
fn settle(crowd: &mut Crowd, into: &mut [Gaussian; EACH]) {
    while crowd.len() > EACH {
        let mut best: Option<(f32, usize, usize)> = None;
        for (j, (b, b_log)) in crowd.iter().enumerate() {
            for (i, (a, a_log)) in crowd.iter().take(j).enumerate() {
                let weight = a.weight + b.weight;
                let (share, off) = (b.weight / weight, b.mean - a.mean);
                let variance =
                    (1.0 - share) * (a.variance + share * off * off) + share * b.variance;
                let cost = weight * libm::log2f(variance) - a.weight * a_log - b.weight * b_log;
                if best.is_none_or(|best| cost < best.0) {
                    best = Some((cost, i, j));
                }
            }
        }
        let Some((_, i, j)) = best else { break };
        let (gone, _) = crowd.remove(j);
        if let Some((it, log)) = crowd.get_mut(i) {
            *it = it.merged(&gone);
            *log = libm::log2f(it.variance);
        }
    }
    let mut left = crowd.iter();
    for it in into {
        *it = left.next().map_or(Gaussian { weight: 0.0, ..*it }, |it| it.0);
    }
}
