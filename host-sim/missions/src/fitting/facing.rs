//! Two convex hulls that face each other, one of each label.
//!
//! Subtract each position labelled -1 from each one labelled +1. The differences fill a convex polygon, which has an
//! edge for each edge of the two hulls. A line separates the labels exactly if the origin lies outside of the polygon.
//! The view from the origin shows the rest:
//!
//! - The polygon's two ends, as seen from the origin, are the two lines that touch both hulls and pass between them. On
//!   each hull, these lines end a stretch that faces the other hull. Only corners on these stretches bound a separating
//!   line.
//!
//! Everything is decided in integers, in a time that grows with the number of corners.

use planner_core::{Label, Sample, Vector};

use crate::fitting::hull::{Hull, Row};

/// A sample of each label.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    positive: Row,
    negative: Row,
}

impl Pair {
    /// The difference of their positions: the vector from the negative one to the positive one.
    pub fn apart(self) -> Vector {
        self.positive.site() - self.negative.site()
    }

    /// The one labelled +1.
    pub fn positive(self) -> Sample {
        self.positive.sample
    }

    /// The one labelled -1.
    pub fn negative(self) -> Sample {
        self.negative.sample
    }
}

/// The hulls of both labels and their polygon of differences.
#[derive(Debug)]
pub struct Facing {
    positive: Hull,
    negative: Hull,
    /// The polygon's corners, counter-clockwise, some of them more than once. Where an edge comes of two that
    /// are parallel, a point on it is there too.
    differences: Vec<Pair>,
}

impl Facing {
    /// The hulls of the first `count` samples of a record.
    pub fn of(rows: &[Row], count: usize) -> Self {
        let rows = rows.iter().filter(|row| row.index < count);
        let positive = Hull::of(rows.clone(), Label::Positive);
        let negative = Hull::of(rows, Label::Negative);
        let mut differences = merged(&positive.lower, &negative.upper);
        differences.extend(merged(&positive.upper, &negative.lower));
        Self { positive, negative, differences }
    }

    /// Whether one of the labels is missing.
    pub fn are_of_one_label(&self) -> bool {
        self.differences.is_empty()
    }

    /// The corners of the polygon of differences, counter-clockwise, some of them more than once.
    pub fn differences(&self) -> &[Pair] {
        &self.differences
    }

    /// The rightmost and the leftmost difference as seen from the origin, the nearest of several: samples
    /// through which the lines pass that touch both hulls and pass between them. `None` when the hulls touch
    /// each other: no line separates them.
    pub fn ends(&self) -> Option<[Pair; 2]> {
        let length = |pair: Pair| pair.apart().dot(pair.apart());
        let end = |side: i64| {
            self.differences.iter().copied().reduce(|end, pair| {
                let beyond = side * end.apart().cross(pair.apart());
                let is_nearer = beyond == 0 && length(pair) < length(end);
                if beyond > 0 || is_nearer { pair } else { end }
            })
        };
        let (right, left) = (end(-1)?, end(1)?);
        let is_ahead = |pair: &Pair| right.apart().dot(pair.apart()) > 0;
        let are_apart =
            right.apart().cross(left.apart()) > 0 || self.differences.iter().all(is_ahead);
        // Whatever has been found: it holds only if every corner is on its side.
        (are_apart && self.separates(right, 1) && self.separates(left, -1)).then_some([right, left])
    }

    /// Whether no sample is on the wrong side of the line through two. `side` is the side of positive samples, seen from
    /// the negative one of the two: 1 is the left, -1 the right.
    fn separates(&self, pair: Pair, side: i64) -> bool {
        let height = |row: Row| side * pair.apart().cross(row.site() - pair.negative.site());
        self.positive.corners().all(|row| height(row) >= 0)
            && self.negative.corners().all(|row| height(row) <= 0)
    }
}

/// The corners of half of the polygon of differences. The walk goes along a chain of each hull, the negative one's
/// backwards, and always takes the edge that turns less.
fn merged(positive: &[Row], negative: &[Row]) -> Vec<Pair> {
    let (Some((&p, mut ps)), Some((&n, mut ns))) = (positive.split_first(), negative.split_first())
    else {
        return Vec::new();
    };
    let mut pair = Pair { positive: p, negative: n };
    let mut pairs = vec![pair];
    loop {
        let turn = match (ps, ns) {
            ([], []) => return pairs,
            ([_, ..], []) => 1,
            ([], [_, ..]) => -1,
            ([p, ..], [n, ..]) => {
                (p.site() - pair.positive.site()).cross(pair.negative.site() - n.site())
            }
        };
        let (next, rest) =
            if turn >= 0 { (&mut pair.positive, &mut ps) } else { (&mut pair.negative, &mut ns) };
        if let Some((row, after)) = rest.split_first() {
            (*next, *rest) = (*row, after);
        }
        pairs.push(pair);
    }
}
