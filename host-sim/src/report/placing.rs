//! Where words stand beside what they name: off marks, ways and each other.

use nalgebra::{Point2, Vector2};
use rstar::primitives::Line;
use rstar::{AABB, RTree, RTreeObject};

use crate::report::shapes::Spot;

/// An upright rectangle, by its middle and half its size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) middle: Spot,
    pub(crate) half: Vector2<f64>,
}

impl RTreeObject for Frame {
    type Envelope = AABB<[f64; 2]>;

    fn envelope(&self) -> Self::Envelope {
        let corners = [self.middle - self.half, self.middle + self.half];
        AABB::from_corners(corners[0].into(), corners[1].into())
    }
}

/// A figure on which words find their places.
pub(crate) struct Placing {
    within: Frame,
    taken: RTree<Frame>,
    ways: RTree<Line<[f64; 2]>>,
}

impl Frame {
    pub(crate) fn between(from: Spot, to: Spot) -> Self {
        Self { middle: nalgebra::center(&from, &to), half: (to - from).abs() / 2.0 }
    }

    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let apart = (self.middle - other.middle).abs();
        let reach = self.half + other.half;
        apart.x < reach.x && apart.y < reach.y
    }

    fn is_within(&self, other: &Self) -> bool {
        let reach = (self.middle - other.middle).abs() + self.half;
        reach.x <= other.half.x && reach.y <= other.half.y
    }

    /// Whether a straight way meets it: no axis separates the two.
    pub(crate) fn meets(&self, [from, to]: &[Spot; 2]) -> bool {
        let (way, off) = ((to - from) / 2.0, nalgebra::center(from, to) - self.middle);
        let across = way.perp(&off).abs();
        off.x.abs() <= self.half.x + way.x.abs()
            && off.y.abs() <= self.half.y + way.y.abs()
            && across <= self.half.x * way.y.abs() + self.half.y * way.x.abs()
    }
}

impl Placing {
    pub(crate) fn new(within: Frame) -> Self {
        Self { within, taken: RTree::new(), ways: RTree::new() }
    }

    /// A rectangle that words stay off.
    pub(crate) fn block(&mut self, frame: Frame) {
        self.taken.insert(frame);
    }

    /// A mark of some radius, which words stay off.
    pub(crate) fn mark(&mut self, middle: Spot, radius: f64) {
        self.taken.insert(Frame { middle, half: Vector2::repeat(radius) });
    }

    /// A way through some places, which words stay off.
    pub(crate) fn way(&mut self, places: &[Spot]) {
        places.windows(2).for_each(|it| self.ways.insert(Line::new(it[0].into(), it[1].into())));
    }

    /// The nearest free place for words of some size, between two distances from a spot. It is taken then. `None` if
    /// there is none.
    pub(crate) fn place(
        &mut self,
        at: Spot,
        size: Vector2<f64>,
        from: f64,
        reach: f64,
    ) -> Option<Frame> {
        const STEP: f64 = 2.0;
        const DIRECTIONS: u32 = 16;
        let half = size / 2.0;
        let rounds = (0..).map(|k| from + STEP * f64::from(k)).take_while(|away| *away <= reach);
        let candidates = rounds.flat_map(|away| (0..DIRECTIONS).map(move |k| (away, k)));
        let found = candidates
            .map(|(away, k)| {
                let turn = std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS);
                let (sin, cos) = libm::sincos(turn + std::f64::consts::FRAC_PI_4);
                let way = Vector2::new(cos, -sin);
                let middle = at + way * away + way.component_mul(&half);
                Frame { middle, half }
            })
            .find(|frame| self.is_free(frame))?;
        self.taken.insert(found);
        Some(found)
    }

    fn is_free(&self, frame: &Frame) -> bool {
        let around = frame.envelope();
        let mut taken = self.taken.locate_in_envelope_intersecting(around);
        let mut ways = self.ways.locate_in_envelope_intersecting(around);
        frame.is_within(&self.within)
            && !taken.any(|taken| taken.overlaps(frame))
            && !ways.any(|way| frame.meets(&[way.from.into(), way.to.into()]))
    }
}

/// The foot of words in a frame, in its middle.
pub(crate) fn foot(frame: &Frame) -> Spot {
    Point2::new(frame.middle.x, frame.middle.y + frame.half.y - 1.0)
}
