//! What some boundary says of labels: a likelihood with a share of wrong labels that nobody knows.

use nalgebra::Point2;
use planner_core::Label;

use crate::fitting::explanation::Question;
use crate::fitting::fewest::all_around;
use crate::world::extent::around;

/// Labels that may be wrong, in order.
pub(super) struct Labels {
    /// The middle of the ground.
    pub(super) middle: Point2<f64>,
    /// Metres from the middle.
    pub(super) at: Vec<Point2<f64>>,
    pub(super) is_positive: Vec<bool>,
    /// When they were read.
    pub(super) times: Vec<u32>,
    /// The standard deviation of positions, metres; 0 where they are exact.
    pub(super) sigma: f64,
    /// No position is further from the middle, metres.
    pub(super) radius: f64,
}

/// Beyond this many deviations a position is certainly on its side.
const FAR: f64 = 7.0;

/// What a boundary says: how many labels agree and disagree, and the chance of being on the label's side for those
/// whose position is near.
pub(super) struct Evidence {
    agreeing: f64,
    disagreeing: f64,
    near: Vec<f64>,
}

impl Labels {
    /// Those that were read. `None` without any.
    pub(super) fn of(question: &Question) -> Option<Self> {
        let samples = || question.read.iter().map(|(sample, _)| sample);
        let places = || samples().map(|it| Point2::<f64>::from(it.site));
        let [low, high] = around(places())?;
        let middle = nalgebra::center(&low, &high);
        Some(Self {
            middle,
            at: places().map(|at| Point2::from(at - middle)).collect(),
            is_positive: samples().map(|it| it.label == Label::Positive).collect(),
            times: question.read.iter().map(|(_, time)| *time).collect(),
            sigma: question.tolerance / 3.0,
            radius: 0.5 * (high - low).norm(),
        })
    }

    pub(super) fn count(&self) -> usize {
        self.at.len()
    }

    /// The chance that each position is on the side of its label, by how high it seems to be on the +1 side of a
    /// boundary.
    pub(super) fn sides(&self, height: impl Fn(usize) -> f64) -> impl Iterator<Item = f64> {
        self.is_positive.iter().enumerate().map(move |(index, is_positive)| {
            let on_its_side = if *is_positive { height(index) } else { -height(index) };
            if self.sigma == 0.0 || on_its_side.abs() >= FAR * self.sigma {
                return if on_its_side >= 0.0 { 1.0 } else { 0.0 };
            }
            0.5 * libm::erfc(-on_its_side / self.sigma * std::f64::consts::FRAC_1_SQRT_2)
        })
    }

    /// What a boundary says.
    pub(super) fn evidence(&self, height: impl Fn(usize) -> f64) -> Evidence {
        Evidence::of(self.sides(height))
    }

    /// The line that the fewest of some labels disagree with; of many, of those that stand for them.
    pub(super) fn line(&self, some: &[usize]) -> Directed {
        let some: Vec<_> = spread(some, 2_000)
            .into_iter()
            .map(|index| (self.at[index].coords, self.is_positive[index]))
            .collect();
        let found = all_around(&some, 48);
        found.map_or(Directed { angle: 0.0, offset: 0.0 }, |(angle, it)| Directed {
            angle,
            offset: it.at,
        })
    }

    /// How many labels disagree with a boundary by more than the tolerance, which is three deviations.
    pub(super) fn disagreeing(&self, height: impl Fn(usize) -> f64) -> usize {
        let on_its_side =
            |index: usize| if self.is_positive[index] { height(index) } else { -height(index) };
        (0..self.count()).filter(|index| on_its_side(*index) < -3.0 * self.sigma).count()
    }
}

/// Some `most` of the indices, evenly spread.
pub(super) fn spread(indices: &[usize], most: usize) -> Vec<usize> {
    let count = indices.len();
    if count <= most {
        return indices.to_vec();
    }
    (0..most).map(|k| indices[(k as u64 * count as u64 / most as u64) as usize]).collect()
}

/// `count ln(chance)`, also of no labels without a chance.
fn times_log(count: f64, chance: f64) -> f64 {
    if count == 0.0 { 0.0 } else { count * libm::log(chance) }
}

impl Evidence {
    /// What a boundary says by the chance that each position is on the side of its label.
    pub(super) fn of(sides: impl Iterator<Item = f64>) -> Self {
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
    pub(super) fn greatest(&self) -> (f64, f64) {
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
}

/// A directed line: the angle of its normal, radians, and its distance along it, metres.
#[derive(Clone, Copy)]
pub(super) struct Directed {
    pub(super) angle: f64,
    pub(super) offset: f64,
}

impl Directed {
    /// How far along its normal a position is, and how far along the line.
    pub(super) fn seen(self, at: Point2<f64>) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.angle);
        [at.x * cos + at.y * sin, at.y * cos - at.x * sin]
    }

    /// How far above the line each position is.
    pub(super) fn heights(self, labels: &Labels) -> impl Fn(usize) -> f64 {
        let (sin, cos) = libm::sincos(self.angle);
        move |index| labels.at[index].x * cos + labels.at[index].y * sin - self.offset
    }
}
