//! Boundaries that are no straight line: an arc, a line that moves, two lines.
//!
//! Each kind has a grid of members that depends on nothing but the number of labels and the size of the ground: `4 n`
//! steps for each of its numbers. Some members are looked at, as near to the labels as a search comes. Each member is a
//! complete statement about all labels, so the mean of the likelihoods over the grid is one too. A single member is a
//! lower bound on the sum. The *odds* of a kind are this bound by the greatest likelihood of any straight line with any
//! share of wrong labels. If a straight line is true, they reach `c` with probability `1 / c` at most.

use std::f64::consts::TAU;

use nalgebra::Point2;

use crate::fitting::fit::labels::Labels;
use crate::fitting::fit::sweep::{Directed, line, spread, threshold};

/// A boundary that explains the labels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Explained {
    /// The logarithm of the odds against all straight lines.
    pub(crate) log_odds: f64,
    /// How many labels disagree with it by more than the tolerance, which is three deviations.
    pub(crate) disagreeing: usize,
    /// The shape's own number: of an arc the radius, of a line that moves how far it does, metres.
    pub(crate) number: f64,
}

/// Most labels that a search looks at, at first and in the end.
const SOME: [usize; 2] = [400, 4_000];

/// The nearest step of a grid over a range.
fn snapped(value: f64, [low, high]: [f64; 2], steps: f64) -> f64 {
    let step = (high - low) / steps;
    (((value - low) / step).round().clamp(0.0, steps)).mul_add(step, low)
}

/// Steps of the grid for each number.
fn steps(labels: &Labels) -> f64 {
    4.0 * labels.count() as f64
}

/// The logarithm of the number of members with so many numbers.
fn members(labels: &Labels, numbers: i32) -> f64 {
    f64::from(numbers) * libm::log(steps(labels) + 1.0)
}

/// What bends or moves a line.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Lift {
    Arc,
    Drift,
}

impl Lift {
    fn of(self, labels: &Labels) -> Vec<f64> {
        let (count, radius) = (labels.count(), labels.radius);
        let last = (count - 1).max(1) as f64;
        let arc = |at: &Point2<f64>| at.coords.norm_squared() / (2.0 * radius);
        match self {
            Self::Arc => labels.at.iter().map(arc).collect(),
            Self::Drift => {
                (0..count).map(|index| radius * (2.0 * index as f64 / last - 1.0)).collect()
            }
        }
    }

    fn family<'a>(self, labels: &'a Labels, lift: &'a [f64]) -> Lifted<'a> {
        let (most, reach) = match self {
            Self::Arc => (4.0, 3.0),
            Self::Drift => (1.0, 2.0),
        };
        Lifted { labels, lift, most, reach }
    }

    /// How many of the labels disagree with the best member of the family that a search finds, which begins at a line.
    pub(crate) fn fewest(self, labels: &Labels, from: Directed) -> usize {
        self.family(labels, &self.of(labels)).search(from).2
    }
}

/// A line that a further number bends or moves: its height over a position falls by `bend * lift[index]`.
struct Lifted<'a> {
    labels: &'a Labels,
    lift: &'a [f64],
    /// The range of the number, to either side of 0.
    most: f64,
    /// Offsets reach so many radii.
    reach: f64,
}

/// The boundary that is an arc of a circle with at least a quarter of the ground's radius.
pub(crate) fn arc(labels: &Labels, best: Directed, straight: f64) -> Option<Explained> {
    let radius = labels.radius;
    let lift = Lift::Arc.of(labels);
    let (directed, bend, _) = Lift::Arc.family(labels, &lift).search(best);
    if bend == 0.0 {
        return None;
    }
    let (sin, cos) = libm::sincos(directed.angle);
    let height = |index: usize| {
        let at = labels.at[index];
        let (up, along) = (at.x * cos + at.y * sin, at.y * cos - at.x * sin);
        // Over the length of the gradient, for the distance.
        let slope = (1.0 - bend * up / radius).hypot(bend * along / radius).max(0.1);
        (up - bend * lift[index] - directed.offset) / slope
    };
    // Of the circle: |q|^2 - 2 (R / bend) n . q + 2 (R / bend) offset = 0.
    let size = radius / bend;
    let number = (size * size - 2.0 * size * directed.offset).max(0.0).sqrt();
    Some(explained(labels, height, members(labels, 3), straight, number))
}

/// The line that moves along its normal, evenly from the first row of the file to the last.
pub(crate) fn moving(labels: &Labels, best: Directed, straight: f64) -> Option<Explained> {
    let lift = Lift::Drift.of(labels);
    let (directed, bend, _) = Lift::Drift.family(labels, &lift).search(best);
    if bend == 0.0 {
        return None;
    }
    let still = directed.heights(labels);
    let height = |index: usize| still(index) - bend * lift[index];
    let number = 2.0 * labels.radius * bend.abs();
    Some(explained(labels, height, members(labels, 3), straight, number))
}

fn explained(
    labels: &Labels,
    height: impl Fn(usize) -> f64,
    price: f64,
    straight: f64,
    number: f64,
) -> Explained {
    let (log, _) = labels.evidence(0..labels.count(), &height).mixed();
    let disagrees = |index: &usize| {
        let on_its_side = if labels.is_positive[*index] { 1.0 } else { -1.0 } * height(*index);
        on_its_side < -3.0 * labels.sigma
    };
    let disagreeing = (0..labels.count()).filter(disagrees).count();
    Explained { log_odds: log - price - straight, disagreeing, number }
}

impl Lifted<'_> {
    /// The member of the grid with the fewest labels against it, and a number of labels that disagree with a
    /// neighbouring one.
    fn search(&self, from: Directed) -> (Directed, f64, usize) {
        let all: Vec<_> = (0..self.labels.count()).collect();
        let few = spread(&all, SOME[0]);
        let mut best = (from.angle, 0.0, usize::MAX);
        for turn in -4..=4 {
            for k in -8..=8_i32 {
                let angle = from.angle + f64::from(turn) * 0.12;
                // Finer about 0: gentle bends are the usual ones.
                let bend = self.most * f64::from(k * k.abs()) / 64.0;
                let against = self.threshold(&few, angle, bend).1;
                if against < best.2 {
                    best = (angle, bend, against);
                }
            }
        }
        let many = spread(&all, SOME[1]);
        best.2 = self.threshold(&many, best.0, best.1).1;
        let (mut turn, mut change) = (0.06, 0.5 * (0.015 * self.most).max(0.25 * best.1.abs()));
        for _ in 0..7 {
            let (angle, bend, _) = best;
            for [a, b] in [[-1, -1], [-1, 0], [-1, 1], [0, -1], [0, 1], [1, -1], [1, 0], [1, 1]] {
                let angle = angle + f64::from(a) * turn;
                let bend = (bend + f64::from(b) * change).clamp(-self.most, self.most);
                let against = self.threshold(&many, angle, bend).1;
                if against < best.2 {
                    best = (angle, bend, against);
                }
            }
            turn *= 0.6;
            change *= 0.6;
        }
        let steps = steps(self.labels);
        let angle = snapped(best.0.rem_euclid(TAU), [0.0, TAU], steps);
        let bend = snapped(best.1, [-self.most, self.most], steps);
        let (offset, _) = self.threshold(&many, angle, bend);
        let reach = self.reach * self.labels.radius;
        let offset = snapped(offset, [-reach, reach], steps);
        (Directed { angle, offset }, bend, best.2)
    }

    fn threshold(&self, some: &[usize], angle: f64, bend: f64) -> (f64, usize) {
        let (sin, cos) = libm::sincos(angle);
        let value = |&index: &usize| {
            let at = self.labels.at[index];
            let height = at.x * cos + at.y * sin - bend * self.lift[index];
            (height, self.labels.is_positive[index])
        };
        let found = threshold(&mut some.iter().map(value).collect::<Vec<_>>());
        (found.at, found.against)
    }
}

/// Two lines: +1 is on the +1 side of both, or of either.
pub(crate) fn two_lines(labels: &Labels, best: Directed, straight: f64) -> Explained {
    let all: Vec<_> = (0..labels.count()).collect();
    let few = spread(&all, SOME[0]);
    let quantiles = [-0.4, 0.0, 0.4].map(|part| part * labels.radius);
    let fan = (0..8).flat_map(|k| {
        let angle = f64::from(k) * TAU / 8.0;
        quantiles.map(|offset| Directed { angle, offset })
    });
    let mut starts: Vec<(usize, Pair)> = Vec::new();
    for first in std::iter::once(best).chain(fan) {
        for both in [true, false] {
            let pair = Pair { lines: [first; 2], both };
            starts.push(pair.improved(labels, &few, 1));
        }
    }
    starts.sort_by_key(|(against, _)| *against);
    let many = spread(&all, SOME[1]);
    let finished = starts.into_iter().take(4).map(|(_, pair)| {
        let (_, pair) = pair.improved(labels, &few, 0);
        pair.improved(labels, &many, 1)
    });
    let (_, mut pair) = finished
        .min_by_key(|(against, _)| *against)
        .unwrap_or((usize::MAX, Pair { lines: [best; 2], both: true }));
    let (steps, reach) = (steps(labels), labels.radius);
    for line in &mut pair.lines {
        line.angle = snapped(line.angle.rem_euclid(TAU), [0.0, TAU], steps);
        line.offset = snapped(line.offset, [-reach, reach], steps);
    }
    let price = members(labels, 4) + std::f64::consts::LN_2;
    let between = pair.lines[0].angle - pair.lines[1].angle;
    explained(labels, pair.heights(labels), price, straight, between)
}

#[derive(Clone, Copy, Debug)]
struct Pair {
    lines: [Directed; 2],
    /// +1 is where both lines say so, not where either does.
    both: bool,
}

impl Pair {
    fn heights(self, labels: &Labels) -> impl Fn(usize) -> f64 {
        let [first, second] = self.lines.map(|line| line.heights(labels));
        let both = self.both;
        move |index| {
            let (a, b) = (first(index), second(index));
            if both { a.min(b) } else { a.max(b) }
        }
    }

    /// Each line is fitted in turn where the other one leaves it open, as long as this helps; `most` rounds at most,
    /// or 4 if it is 0. How many labels disagree then.
    fn improved(mut self, labels: &Labels, some: &[usize], most: usize) -> (usize, Self) {
        let mut least = usize::MAX;
        for round in 0..if most == 0 { 4 } else { most } {
            for k in [1, 0] {
                let other = self.lines[1 - k].heights(labels);
                let is_open = |&&index: &&usize| (other(index) > 0.0) == self.both;
                let open: Vec<_> = some.iter().filter(is_open).copied().collect();
                if open.is_empty() {
                    return (least, self);
                }
                // At the first round the second line is yet to be found.
                let near = (round > 0 || k == 0).then_some(self.lines[k].angle);
                self.lines[k] = line(labels, &open, near).0;
            }
            let height = self.heights(labels);
            let disagrees = |&&index: &&usize| (height(index) > 0.0) != labels.is_positive[index];
            let against = some.iter().filter(disagrees).count();
            if against >= least {
                break;
            }
            least = against;
        }
        (least, self)
    }
}
