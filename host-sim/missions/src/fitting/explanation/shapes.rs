//! Boundaries that are no straight, still line: an arc, a line that moves, two lines. Each with the logarithm of the
//! likelihood of the labels, as near to the greatest as a search comes.

use crate::fitting::explanation::Found;
use crate::fitting::explanation::labels::{Directed, Labels, spread};
use crate::fitting::fewest::threshold;
use crate::world::extent::span;

/// Most labels that a search looks at, at first and in the end.
const SOME: [usize; 2] = [400, 4_000];

/// A line that a further number, the bend, bends or moves: its height over a position falls by `bend * lift[index]`.
struct Lifted<'a> {
    labels: &'a Labels,
    lift: Vec<f64>,
    /// The range of the bend, to either side of 0.
    most: f64,
}

/// The boundary that is an arc of a circle with at least a quarter of the ground's radius.
pub(super) fn arc(labels: &Labels, best: Directed) -> Option<(f64, Found)> {
    let reach = labels.radius;
    let lift = labels.at.iter().map(|at| at.coords.norm_squared() / (2.0 * reach)).collect();
    let lifted = Lifted { labels, lift, most: 4.0 };
    let (directed, bend) = lifted.search(best)?;
    let height = |index: usize| {
        let [up, along] = directed.seen(labels.at[index]);
        // Over the length of the gradient, for the distance.
        let slope = libm::hypot(1.0 - bend * up / reach, bend * along / reach).max(0.1);
        (up - bend * lifted.lift[index] - directed.offset) / slope
    };
    // Of the circle: |q|^2 - 2 (R / bend) n . q + 2 (R / bend) offset = 0.
    let size = reach / bend;
    let radius = (size * size - 2.0 * size * directed.offset).max(0.0).sqrt();
    let [from, to] = span(labels.at.iter().map(|at| best.seen(*at)[1]));
    let half = (0.5 * (to - from)).min(radius);
    let sagitta = radius - (radius * radius - half * half).sqrt();
    let disagreeing = labels.disagreeing(height);
    let log = labels.evidence(height).greatest().0;
    Some((log, Found::Bend { radius, sagitta, disagreeing }))
}

/// The line that moves along its normal, evenly from the first label to the last.
pub(super) fn moving(labels: &Labels, best: Directed) -> Option<(f64, Found)> {
    let [first, last] = span(labels.times.iter().map(|time| f64::from(*time)));
    let time = |time: &u32| 2.0 * (f64::from(*time) - first) / (last - first).max(1.0) - 1.0;
    let lift = labels.times.iter().map(|it| labels.radius * time(it)).collect();
    let lifted = Lifted { labels, lift, most: 1.0 };
    let (directed, bend) = lifted.search(best)?;
    let still = directed.heights(labels);
    let height = |index: usize| still(index) - bend * lifted.lift[index];
    let metres = 2.0 * labels.radius * bend.abs();
    let disagreeing = labels.disagreeing(height);
    Some((labels.evidence(height).greatest().0, Found::Drift { metres, disagreeing }))
}

impl Lifted<'_> {
    /// The line and the bend with the fewest labels against them. `None` if it is straight and still.
    fn search(&self, from: Directed) -> Option<(Directed, f64)> {
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
        let (angle, bend, _) = best;
        let offset = self.threshold(&many, angle, bend).0;
        (bend != 0.0).then_some((Directed { angle, offset }, bend))
    }

    fn threshold(&self, some: &[usize], angle: f64, bend: f64) -> (f64, usize) {
        let seen = Directed { angle, offset: 0.0 }.heights(self.labels);
        let value = |&index: &usize| {
            (seen(index) - bend * self.lift[index], self.labels.is_positive[index])
        };
        let found = threshold(&mut some.iter().map(value).collect::<Vec<_>>());
        (found.at, found.against)
    }
}

/// Two lines: +1 is on the +1 side of both, or of either. The second one is fitted where the first one leaves it open,
/// then each in turn as long as this helps.
pub(super) fn two_lines(labels: &Labels, best: Directed) -> (f64, Found) {
    let all: Vec<_> = (0..labels.count()).collect();
    let fitted = [true, false].map(|both| {
        let heights = |[first, second]: [Directed; 2]| {
            let [first, second] = [first.heights(labels), second.heights(labels)];
            // +1 is where both lines say so, or where either does.
            move |index| {
                if both { first(index).min(second(index)) } else { first(index).max(second(index)) }
            }
        };
        let (mut pair, mut found, mut least) = ([best; 2], [best; 2], usize::MAX);
        for _ in 0..4 {
            for k in [1, 0] {
                let other = pair[1 - k].heights(labels);
                let is_open = |index: &&usize| (other(**index) > 0.0) == both;
                pair[k] = labels.line(&all.iter().filter(is_open).copied().collect::<Vec<_>>());
            }
            let height = heights(pair);
            let disagrees = |index: &&usize| (height(**index) > 0.0) != labels.is_positive[**index];
            let against = all.iter().filter(disagrees).count();
            if against >= least {
                break;
            }
            (found, least) = (pair, against);
        }
        let disagreeing = labels.disagreeing(heights(found));
        (labels.evidence(heights(found)).greatest().0, Found::TwoBoundaries { disagreeing })
    });
    let [first, second] = fitted;
    if first.0 >= second.0 { first } else { second }
}
