//! A Gaussian over the front beside the robot and behind it, of which labels ask the offset alone.
//!
//! It has the front's offset from the reference arc, its turn against the arc, its curvature, and its offsets at a few
//! places behind. All but the first are stored as a slope on the offset (`gain`), and what that leaves open (`rest`). A
//! label changes the mean and the variance of the offset, and none of these. So no label subtracts covariances, and none
//! becomes indefinite. The places behind are not compared with one another.
//!
//! Lengths are in reaches.

/// Places behind the robot of which offsets are kept. With four, maps are 25 to 70 % further off.
pub(crate) const PLACES: usize = 8;

/// What depends on the offset: the turn, the curvature, and the places.
const OTHERS: usize = 2 + PLACES;

/// The deviation of a curvature at first, in a reach.
pub(crate) const BEND: f32 = 0.2;

/// A place differs from the front's smooth curve by this deviation.
const ROUGH: f32 = 0.006;

/// No label takes more than this share of a variance: numbers keep their digits.
const MOST: f32 = 0.95;

/// How a front goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gait {
    /// Deviations of curvature, of direction and of offset that it gains in a reach.
    pub(crate) noise: [f32; 3],
    /// The curvature fades in so many reaches, as the inverse.
    pub(crate) fades: f32,
    /// How likely a front goes so.
    pub(crate) prior: f32,
}

/// A Gaussian and its weight in a sum of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Gaussian {
    pub(crate) weight: f32,
    /// Of the offset.
    pub(crate) mean: f32,
    pub(crate) variance: f32,
    /// The means of the turn, the curvature, and the places.
    pub(crate) means: [f32; OTHERS],
    /// By how much each goes up with the offset.
    pub(crate) gain: [f32; OTHERS],
    /// Covariances of the turn and the curvature beside what the offset says.
    pub(crate) rest: [f32; 3],
    /// The same of each place: with the turn, with the curvature, and its own variance.
    pub(crate) behind: [[f32; 3]; PLACES],
}

/// Where the front lies at a place ahead: mean and variance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Offset {
    pub(crate) weight: f32,
    pub(crate) mean: f32,
    pub(crate) variance: f32,
}

impl Offset {
    /// The Gaussian with the mean and the variance of both together.
    pub(crate) fn with(self, other: Self) -> Self {
        let weight = self.weight + other.weight;
        let (share, off) = (other.weight / weight, other.mean - self.mean);
        let variance = (1.0 - share) * (self.variance + share * off * off) + share * other.variance;
        Self { weight, mean: self.mean + share * off, variance }
    }
}

impl Gaussian {
    pub(crate) const NONE: Self = Self {
        weight: 0.0,
        mean: 0.0,
        variance: 1.0,
        means: [0.0; OTHERS],
        gain: [0.0; OTHERS],
        rest: [1.0, 0.0, 1.0],
        behind: [[0.0, 0.0, 1.0]; PLACES],
    };

    /// About the reference: a turn, and deviations of offset, turn and curvature.
    pub(crate) fn about(weight: f32, turn: f32, [offset, turns, bends]: [f32; 3]) -> Self {
        let mut new = Self { weight, variance: offset * offset, ..Self::NONE };
        new.means[0] = turn;
        new.rest = [turns * turns, 0.0, bends * bends];
        new
    }

    /// Whether its numbers have a size that others can come of.
    pub(crate) fn is_valid(&self) -> bool {
        let has_size = |it: &f32| it.abs() < 1e9;
        let is_wide = |it: f32| it > 1e-12;
        let [turns, _, bends] = self.rest;
        (0.0..=1.01).contains(&self.weight)
            && is_wide(self.variance)
            && turns >= 0.0
            && bends >= 0.0
            && self.behind.iter().all(|it| is_wide(it[2]))
            && has_size(&self.mean)
            && has_size(&self.variance)
            && self.means.iter().chain(&self.gain).chain(&self.rest).all(has_size)
            && self.behind.iter().flatten().all(has_size)
    }

    /// Where the front lies at a place behind.
    pub(crate) fn offset_behind(&self, place: usize) -> Offset {
        let at = |of: &[f32; OTHERS]| of.get(2 + place).copied().unwrap_or(0.0);
        let rest = self.behind.get(place).map_or(0.0, |it| it[2]);
        let gain = at(&self.gain);
        let variance = gain * gain * self.variance + rest;
        Offset { weight: self.weight, mean: at(&self.means), variance }
    }

    /// Where the front lies so far ahead.
    pub(crate) fn ahead(&self, way: f32, gait: &Gait) -> Offset {
        let half = 0.5 * way * way;
        let [turn, bend, ..] = self.means;
        let [by_turn, by_bend, ..] = self.gain;
        let [tt, tb, bb] = self.rest;
        let own = 1.0 + way * by_turn + half * by_bend;
        let rest = way * way * tt + 2.0 * way * half * tb + half * half * bb;
        let [grown, ..] = gait.grown(way);
        Offset {
            weight: self.weight,
            mean: self.mean + way * turn + half * bend,
            variance: own * own * self.variance + rest + grown,
        }
    }

    /// Goes along the reference, whose curvature is `bend`, back if the way is negative.
    pub(crate) fn advance(&mut self, way: f32, bend: f32, gait: &Gait) {
        let (half, size) = (0.5 * way * way, way.abs());
        let kept = 1.0 - gait.fades * size;
        let kept = if kept > 0.0 { kept } else { 0.0 };
        let [turn, curve, ..] = self.means;
        self.mean += way * turn + half * curve;
        self.means[0] = turn + way * curve;
        self.means[1] = kept * (curve + bend) - bend;

        let v = self.variance;
        let [by_turn, by_bend, ..] = self.gain;
        let [tt, tb, bb] = self.rest;
        let own = 1.0 + way * by_turn + half * by_bend;
        let others = [by_turn + way * by_bend, kept * by_bend];
        // What the rest comes to, with what the gait adds.
        let [yy, yt, yb, gtt, gtb, gbb] = gait.grown(way);
        let with_turn = way * tt + half * tb;
        let with_bend = way * tb + half * bb;
        let s = way * with_turn + half * with_bend + yy;
        let to = [with_turn + way * with_bend + yt, kept * with_bend + yb];
        let all = [
            tt + 2.0 * way * tb + way * way * bb + gtt,
            kept * (tb + way * bb) + gtb,
            kept * kept * bb + gbb,
        ];
        let variance = own * own * v + s;
        if s <= 0.0 || variance <= 0.0 {
            return;
        }
        // The rest beside what its own share of the offset says, and what the two shares of the offset leave open.
        let slopes = to.map(|it| it / s);
        let beside =
            [all[0] - slopes[0] * to[0], all[1] - slopes[0] * to[1], all[2] - slopes[1] * to[1]];
        let open = v * s / variance;
        let apart = [others[0] - own * slopes[0], others[1] - own * slopes[1]];
        let least = |it: f32| if it > 0.0 { it } else { 0.0 };
        self.rest = [
            least(beside[0]) + open * apart[0] * apart[0],
            beside[1] + open * apart[0] * apart[1],
            least(beside[2]) + open * apart[1] * apart[1],
        ];
        let [others_turn, others_bend] = others;
        let [to_turn, to_bend] = to;
        let gains = [own * others_turn * v + to_turn, own * others_bend * v + to_bend]
            .map(|it| it / variance);
        for (gain, behind) in self.gain.iter_mut().skip(2).zip(&mut self.behind) {
            let [pt, pb, pp] = *behind;
            let (before, cross) = (*gain, v * *gain);
            let after = (cross * own + way * pt + half * pb) / variance;
            let with = [cross * others[0] + pt + way * pb, cross * others[1] + kept * pb];
            let left = pp + before * cross - after * after * variance;
            *gain = after;
            *behind = [
                with[0] - after * variance * gains[0],
                with[1] - after * variance * gains[1],
                if left > ROUGH * ROUGH { left } else { ROUGH * ROUGH },
            ];
        }
        [self.gain[0], self.gain[1]] = gains;
        self.variance = variance;
    }

    /// Adds to the variance of the offset. The rest grows by what the slopes no longer say.
    pub(crate) fn widen(&mut self, by: f32) {
        let kept = self.variance / (self.variance + by);
        let lost = self.variance * (1.0 - kept);
        let [t, b, ..] = self.gain;
        let [tt, tb, bb] = self.rest;
        self.rest = [tt + t * t * lost, tb + t * b * lost, bb + b * b * lost];
        for (gain, behind) in self.gain.iter().skip(2).zip(&mut self.behind) {
            let [pt, pb, pp] = *behind;
            *behind = [pt + gain * t * lost, pb + gain * b * lost, pp + gain * gain * lost];
        }
        self.gain.iter_mut().for_each(|gain| *gain *= kept);
        self.variance += by;
    }

    /// The place where the robot is becomes the first one behind it.
    pub(crate) fn pass(&mut self) {
        self.means.copy_within(2..OTHERS - 1, 3);
        self.gain.copy_within(2..OTHERS - 1, 3);
        self.behind.copy_within(..PLACES - 1, 1);
        (self.means[2], self.gain[2]) = (self.mean, 1.0);
        self.behind[0] = [0.0, 0.0, ROUGH * ROUGH];
    }

    /// Seen the other way round: left is right. Adds to the variance of the turn.
    pub(crate) fn turn_round(&mut self, turns: f32) {
        self.mean = -self.mean;
        self.means[1] = -self.means[1];
        self.gain[0] = -self.gain[0];
        self.rest = [self.rest[0] + turns, -self.rest[1], self.rest[2]];
    }

    /// Its offset.
    pub(crate) const fn offset(&self) -> Offset {
        Offset { weight: self.weight, mean: self.mean, variance: self.variance }
    }

    /// Its offset, where the logarithm has a gradient and a curvature more: a label.
    pub(crate) fn told(&self, gradient: f32, curvature: f32) -> Offset {
        let (by, taken) = (self.variance * gradient, self.variance * curvature);
        let variance = self.variance * (1.0 - if taken < MOST { taken } else { MOST });
        Offset { weight: self.weight, mean: self.mean + by, variance }
    }

    /// Takes in another one, whose offset is this now, with all that depends on that. It has the mean and the covariance of
    /// both together. One without a weight becomes the other.
    pub(crate) fn join(&mut self, other: &Self, offset: Offset) {
        let shift = offset.mean - other.mean;
        if self.weight <= 0.0 {
            let Offset { weight, mean, variance } = offset;
            *self = Self { weight, mean, variance, ..*other };
            for (mean, gain) in self.means.iter_mut().zip(&self.gain) {
                *mean += gain * shift;
            }
            return;
        }
        let both = self.offset().with(offset);
        let b = offset.weight / both.weight;
        let a = 1.0 - b;
        let off = offset.mean - self.mean;
        let parts = [a * self.variance, b * offset.variance, a * b];
        let per = 1.0 / both.variance;
        // How far each one's slopes are from those of both, and its mean from their line.
        let mut apart = [[0.0; 3]; OTHERS];
        let mine = self.means.iter_mut().zip(&mut self.gain);
        let pairs = mine.zip(other.means.iter().zip(&other.gain));
        for (((mean, gain), (its_mean, its_gain)), apart) in pairs.zip(&mut apart) {
            let way = its_mean + its_gain * shift - *mean;
            let slope = (parts[0] * *gain + parts[1] * its_gain + parts[2] * off * way) * per;
            *apart = [*gain - slope, its_gain - slope, way - slope * off];
            (*mean, *gain) = (*mean + b * way, slope);
        }
        let of = |[x, y, z]: [f32; 3], [u, v, w]: [f32; 3]| {
            parts[0] * x * u + parts[1] * y * v + parts[2] * z * w
        };
        let [turn, bend, places @ ..] = apart;
        let own = [of(turn, turn), of(turn, bend), of(bend, bend)];
        let rests = self.rest.iter_mut().zip(&other.rest);
        for ((rest, its), own) in rests.zip(own) {
            *rest = a * *rest + b * its + own;
        }
        for ((behind, its), place) in self.behind.iter_mut().zip(&other.behind).zip(places) {
            let with = [of(turn, place), of(bend, place), of(place, place)];
            for ((it, its), with) in behind.iter_mut().zip(its).zip(with) {
                *it = a * *it + b * its + with;
            }
        }
        (self.weight, self.mean, self.variance) = (both.weight, both.mean, both.variance);
    }
}

impl Gait {
    /// What a way adds to the covariance of offset, turn and curvature, row by row.
    fn grown(&self, way: f32) -> [f32; 6] {
        let (a, sign) = (way.abs(), if way < 0.0 { -1.0 } else { 1.0 });
        let [bend, turn, offset] = self.noise.map(|it| it * it);
        let (a2, a3) = (a * a, a * a * a);
        [
            a * (offset + a2 * (turn / 3.0 + bend * a2 / 20.0)),
            sign * a2 * (turn * 0.5 + bend * a2 * 0.125),
            bend * a3 / 6.0,
            a * (turn + bend * a2 / 3.0),
            sign * bend * a2 * 0.5,
            bend * a,
        ]
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix4, Vector4};

    use super::*;
    use crate::draws::Draws;

    type Moments = (Vector4<f64>, Matrix4<f64>);

    /// Means and covariance of offset, turn, curvature and one place.
    fn full(it: &Gaussian, place: usize) -> Moments {
        let f = f64::from;
        let k = 2 + place;
        let slope = Vector4::new(1.0, f(it.gain[0]), f(it.gain[1]), f(it.gain[k]));
        let [pt, pb, pp] = it.behind[place].map(f);
        let [tt, tb, bb] = it.rest.map(f);
        let rest = [[0.0; 4], [0.0, tt, tb, pt], [0.0, tb, bb, pb], [0.0, pt, pb, pp]];
        let mean = Vector4::new(f(it.mean), f(it.means[0]), f(it.means[1]), f(it.means[k]));
        (mean, slope * slope.transpose() * f(it.variance) + Matrix4::from(rest))
    }

    fn near(a: Moments, b: Moments, what: &str) {
        for i in 0..4 {
            let off = (a.0[i] - b.0[i]).abs();
            assert!(off < 1e-4 * (1.0 + b.0[i].abs()), "{what} mean {i}: {a:?} {b:?}");
            for j in 0..4 {
                let off = (a.1[(i, j)] - b.1[(i, j)]).abs();
                let scale = (b.1[(i, i)] * b.1[(j, j)]).sqrt();
                assert!(off < 2e-4 * scale, "{what} {i} {j}: {a:?} {b:?}");
            }
        }
    }

    fn drawn(draws: &mut Draws) -> Gaussian {
        let mut unit = || draws.unit() as f32;
        let mut it =
            Gaussian::about(0.1 + unit(), unit() - 0.5, [0.1 + unit(), 0.1 + unit(), 0.1 + unit()]);
        it.mean = unit() - 0.5;
        it.means[1] = unit() - 0.5;
        for _ in 0..3 {
            it.advance(0.3 + unit(), 0.0, &GAIT);
            it.pass();
            let told = it.told(unit() - 0.5, unit());
            let before = core::mem::replace(&mut it, Gaussian::NONE);
            it.join(&before, told);
        }
        it
    }

    const GAIT: Gait = Gait { noise: [0.1, 0.2, 0.05], fades: 0.3, prior: 0.0 };

    #[test]
    fn it_does_what_a_matrix_does() {
        let mut draws = Draws::new(7);
        for _ in 0..200 {
            let it = drawn(&mut draws);
            let other = drawn(&mut draws);
            let way = draws.unit() * 2.0 - 1.0;
            for place in 0..3 {
                let (mean, p) = full(&it, place);
                // Ahead.
                let (half, kept) = (0.5 * way * way, 1.0 - 0.3 * way.abs());
                let f = Matrix4::from([
                    [1.0, 0.0, 0.0, 0.0],
                    [way, 1.0, 0.0, 0.0],
                    [half, way, kept, 0.0],
                    [0.0, 0.0, 0.0, 1.0],
                ]);
                let [yy, yt, yb, tt, tb, bb] = GAIT.grown(way as f32).map(f64::from);
                let grown = [[yy, yt, yb, 0.0], [yt, tt, tb, 0.0], [yb, tb, bb, 0.0], [0.0; 4]];
                let q = f * p * f.transpose() + Matrix4::from(grown);
                let bent = -0.25 * (1.0 - kept);
                let moved = f * mean + Vector4::new(0.0, 0.0, bent, 0.0);
                let mut went = it;
                went.advance(way as f32, 0.25, &GAIT);
                near(full(&went, place), (moved, q), "advance");
                let seen = it.ahead(way as f32, &GAIT);
                assert!((f64::from(seen.variance) - q[(0, 0)]).abs() < 1e-4 * q[(0, 0)]);
                assert!((f64::from(seen.mean) - moved[0]).abs() < 1e-4);
                // A label.
                let (g, b) = (0.3, 0.5 / p[(0, 0)]);
                let mut heard = Gaussian::NONE;
                heard.join(&it, it.told(g as f32, b as f32));
                let means = mean + p.column(0) * g;
                let all = p - p.column(0) * p.row(0) * b;
                near(full(&heard, place), (means, all), "hear");
                let mut widened = it;
                widened.widen(0.4);
                let mut wide = p;
                wide[(0, 0)] += f64::from(0.4_f32);
                near(full(&widened, place), (mean, wide), "widen");
                // Both together.
                let (its, o) = full(&other, place);
                let share = f64::from(other.weight) / f64::from(it.weight + other.weight);
                let (means, apart) = (mean * (1.0 - share) + its * share, mean - its);
                let spread = apart * apart.transpose() * (1.0 - share) * share;
                let all = p * (1.0 - share) + o * share + spread;
                let mut joined = it;
                joined.join(&other, other.offset());
                near(full(&joined, place), (means, all), "join");
            }
        }
    }
}
