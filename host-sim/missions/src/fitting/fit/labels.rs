//! What some boundary says of recorded labels: a likelihood with a share of wrong labels that nobody knows.

use nalgebra::Point2;

/// Labels that may be wrong, in the order of the file.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    /// Metres from the middle of the ground.
    pub(crate) at: Vec<Point2<f64>>,
    pub(crate) is_positive: Vec<bool>,
    /// The standard deviation of positions, metres; 0 where they are exact.
    pub(crate) sigma: f64,
    /// No position is further from the middle, metres.
    pub(crate) radius: f64,
}

/// How often labels may be wrong, in alternatives: 0.375, 0.28, ... down to 0.0005.
const SHARES: i32 = 24;

/// Beyond this many deviations a position is certainly on its side.
const FAR: f64 = 7.0;

/// What a boundary says: how many labels agree and disagree, and the chance of being on the label's side for those
/// whose position is near.
pub(crate) struct Evidence {
    agreeing: f64,
    pub(crate) disagreeing: f64,
    near: Vec<f64>,
}

impl Labels {
    pub(crate) fn count(&self) -> usize {
        self.at.len()
    }

    /// The chance that a position which seems to be `height` metres on the +1 side is on the side of its label.
    pub(crate) fn side(&self, index: usize, height: f64) -> f64 {
        let on_its_side = if self.is_positive[index] { height } else { -height };
        if self.sigma == 0.0 || on_its_side.abs() >= FAR * self.sigma {
            return if on_its_side >= 0.0 { 1.0 } else { 0.0 };
        }
        0.5 * libm::erfc(-on_its_side / self.sigma * std::f64::consts::FRAC_1_SQRT_2)
    }

    /// What a boundary says by the height of each of some positions above it, on the +1 side.
    pub(crate) fn evidence(
        &self,
        some: impl Iterator<Item = usize>,
        height: impl Fn(usize) -> f64,
    ) -> Evidence {
        Evidence::of(some.map(|index| self.side(index, height(index))))
    }
}

/// `count ln(chance)`, also of no labels without a chance.
fn times_log(count: f64, chance: f64) -> f64 {
    if count == 0.0 { 0.0 } else { count * libm::log(chance) }
}

impl Evidence {
    /// What a boundary says by the chance that each position is on the side of its label.
    pub(crate) fn of(sides: impl Iterator<Item = f64>) -> Self {
        let mut evidence = Self { agreeing: 0.0, disagreeing: 0.0, near: Vec::new() };
        for side in sides {
            if side >= 1.0 {
                evidence.agreeing += 1.0;
            } else if side <= 0.0 {
                evidence.disagreeing += 1.0;
            } else {
                evidence.near.push(side);
            }
        }
        evidence
    }

    /// The logarithm of the likelihood if this share of the labels is wrong.
    fn log(&self, share: f64) -> f64 {
        let near = |side: &f64| libm::log(share + (1.0 - 2.0 * share) * side);
        times_log(self.disagreeing, share)
            + times_log(self.agreeing, 1.0 - share)
            + self.near.iter().map(near).sum::<f64>()
    }

    /// The greatest, over all shares up to a half, and its share.
    pub(crate) fn greatest(&self) -> (f64, f64) {
        let all = self.agreeing + self.disagreeing;
        if self.near.is_empty() {
            let share = if all > 0.0 { (self.disagreeing / all).min(0.5) } else { 0.0 };
            return (self.log(share), share);
        }
        // The logarithm is concave in the share.
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..40 {
            let third = (high - low) / 3.0;
            let (a, b) = (low + third, high - third);
            if self.log(a) < self.log(b) {
                low = a;
            } else {
                high = b;
            }
        }
        let share = f64::midpoint(low, high);
        (self.log(share).max(self.log(0.5)), share)
    }

    /// A likelihood that names no share: the mean over some. This bounds it from below, to the share that does best.
    pub(crate) fn mixed(&self) -> (f64, f64) {
        let price = libm::log(f64::from(SHARES));
        let shares = (1..=SHARES).map(|k| 0.5 * libm::pow(0.75, f64::from(k)));
        let logs = shares.map(|share| (self.log(share) - price, share));
        logs.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NEG_INFINITY, 0.5))
    }
}
