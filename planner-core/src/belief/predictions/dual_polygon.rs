//! A cell of lines as a polygon: each line is a point of slope and offset, in a frame at a place.
//!
//! The first axis of the frame runs along the cell's bisector. In it a line is `z = slope x + offset`, and the lines of
//! a cell form a convex polygon whose vertices are the cell's. A place cuts the polygon along a straight line. The
//! lines that have the place on their +1 side are one part, and a label +1 there leaves that part. Its measure is their
//! share.
//!
//! Cross products are exact in integers, and everything else is in single precision. The polygon only predicts; it
//! decides nothing about certainty.

use heapless::Vec;

use crate::belief::cells::{CellView, Certainty};
use crate::belief::predictions::predictor::{
    Prediction, PredictiveBelief, Predictor, entropy, log2,
};
use crate::belief::predictions::spread::{Covariance, LineSums, Spread, Stretch, Whole};
use crate::belief::predictions::verdicts::Decisive;
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Reading};
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::VersionSpace;
use crate::belief::{Belief, ObservationError};
use crate::geometry::approximate::{METRE, UnitVector, cross, distance, inverse_sqrt};
use crate::geometry::lattice::{Site, Vector};

/// The number of vertices that a polygon keeps. From a cell with more, it takes this many, spread evenly.
const VERTICES: usize = 16;

/// The first axis of a polygon's frame. The second axis is to its left.
#[derive(Clone, Copy, Debug)]
struct Axis {
    along: Vector,
    unit: UnitVector,
}

impl Axis {
    /// A displacement in these axes, metres. How far to the left is exact before it is rounded.
    fn see(&self, by: Vector) -> [f32; 2] {
        let ahead = self.unit.along(by);
        [ahead * METRE, cross(self.along, by) * (self.unit.per_length * METRE)]
    }
}

/// A line in a frame: `z = slope x + offset`.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    slope: f32,
    offset: f32,
    /// The secant of its angle to the first axis.
    secant: f32,
}

impl Vertex {
    fn new(slope: f32, offset: f32) -> Self {
        let square = 1.0 + slope * slope;
        Self { slope, offset, secant: square * inverse_sqrt(square) }
    }

    /// The measure of the lines between three, radian metres; its sign is that of the way round.
    ///
    /// The density depends on the slope alone: it is the second derivative of the secant `sqrt(1 + m^2)`. So the
    /// measure is the determinant of the three lines times the divided difference of their secants (Hermite and
    /// Genocchi). This code computes it without subtracting nearly equal numbers.
    fn triangle(self, b: Self, c: Self) -> f32 {
        let determinant = (b.slope - self.slope) * (c.offset - self.offset)
            - (c.slope - self.slope) * (b.offset - self.offset);
        let [ab, bc, ca] = [self.secant + b.secant, b.secant + c.secant, c.secant + self.secant];
        let slopes = (self.slope + b.slope) * (self.slope + c.slope);
        determinant * (ab * ca - slopes) / (ab * bc * ca)
    }

    /// How far a place lies above it.
    fn below(self, [x, z]: [f32; 2]) -> f32 {
        z - self.slope * x - self.offset
    }

    /// How far from the frame's origin it passes, and about how far it is turned against the first axis.
    fn polar(self) -> [f32; 2] {
        [self.offset / self.secant, self.slope / self.secant]
    }

    /// The line between this one and another that passes through a place. `above` and `above_other` are how far the
    /// place lies above the two.
    fn between(self, above: f32, other: Self, above_other: f32) -> Self {
        let t = above / (above - above_other);
        Self::new(
            self.slope + t * (other.slope - self.slope),
            self.offset + t * (other.offset - self.offset),
        )
    }
}

/// The lines of a polygon below a place, or above it. `start` and `end` are lines through the place. Between them lie
/// `count` vertices of the polygon, from number `first` on.
struct PolygonPart {
    start: Vertex,
    first: usize,
    count: usize,
    end: Vertex,
}

/// A cell of lines as seen from a place.
#[derive(Clone, Debug)]
pub struct DualPolygon {
    origin: Site,
    axis: Axis,
    /// Where a label +1 is taken in, from where it is read: see [`CellView::shift`].
    shift: Vector,
    vertices: Vec<Vertex, VERTICES, u8>,
    /// The cell's measure, radian metres; its sign is that of the way round.
    measure: f32,
}

impl DualPolygon {
    /// The polygon of some lines, in a frame at a site.
    pub fn of(lines: CellView<'_>, origin: Site) -> Self {
        let along = lines.slope_arc().bisector();
        let axis = Axis { along, unit: UnitVector::of(along) };
        let mut vertices = Vec::new();
        let count = lines.edges.len().max(VERTICES);
        let mut due = 0;
        for bound in lines.bounds() {
            due += VERTICES;
            if due < count {
                continue; // there is no room for all
            }
            due -= count;
            let run = cross(bound.along, along.left());
            let slope = cross(along, bound.along) / run;
            let value = cross(bound.along, origin - bound.through);
            let offset = -value * METRE / (run * axis.unit.per_length);
            let _ = vertices.push(Vertex::new(slope, offset));
        }
        Self { origin, axis, shift: lines.shift, vertices, measure: 0.0 }.measured()
    }

    fn measured(mut self) -> Self {
        self.measure = match *self.vertices {
            [apex, ref rest @ ..] => measure(apex, rest.iter()),
            [] => 0.0,
        };
        self
    }

    /// The lines below a place, or above it; `None` if they are all or none.
    #[inline(never)] // called from two places, and not small
    fn part(&self, place: [f32; 2], label: Label) -> Option<PolygonPart> {
        let sign = if label == Label::Positive { 1.0 } else { -1.0 };
        let mut before = *self.vertices.last()?;
        let mut above_before = sign * before.below(place);
        let (mut enters, mut leaves) = (None, None);
        for (k, &vertex) in self.vertices.iter().enumerate() {
            let above = sign * vertex.below(place);
            if (above > 0.0) != (above_before > 0.0) {
                let crossing = Some((k, before.between(above_before, vertex, above)));
                *(if above > 0.0 { &mut enters } else { &mut leaves }) = crossing;
            }
            (before, above_before) = (vertex, above);
        }
        let ((first, start), (after, end)) = enters.zip(leaves)?;
        let all = self.vertices.len();
        let count = if after > first { after - first } else { after + all - first };
        Some(PolygonPart { start, first, count, end })
    }

    /// The part that remains after a label where all lines agree: everything.
    fn whole(&self) -> Option<PolygonPart> {
        let (start, end) = (*self.vertices.first()?, *self.vertices.last()?);
        Some(PolygonPart { start, first: 1, count: self.vertices.len() - 2, end })
    }

    /// The vertices of a part but for its start.
    fn rest<'a>(&'a self, part: &'a PolygonPart) -> impl Iterator<Item = &'a Vertex> {
        let (before, from) = self.vertices.split_at_checked(part.first).unwrap_or_default();
        let wrapped = part.count.saturating_sub(from.len());
        let from = from.get(..part.count).unwrap_or(from);
        let before = before.get(..wrapped).unwrap_or(before);
        from.iter().chain(before).chain(core::slice::from_ref(&part.end))
    }

    /// The place at which a label is taken in that is read at a site.
    fn place(&self, site: Site, label: Label) -> [f32; 2] {
        let by = site - self.origin;
        let shift = if label == Label::Positive { self.shift } else { self.shift.reversed() };
        self.axis.see(Vector { x: by.x.saturating_add(shift.x), z: by.z.saturating_add(shift.z) })
    }

    /// The share of the lines that have a place on their +1 side.
    fn share(&self, place: [f32; 2]) -> f32 {
        let Some(part) = self.part(place, Label::Positive) else { return self.beyond(place) };
        (measure(part.start, self.rest(&part)) / self.measure).clamp(0.0, 1.0)
    }

    /// [`share`](Self::share) at a place where all lines agree. It is below 0 or above 1 by the distance to the nearest
    /// line, divided by the breadth of the lines there.
    fn beyond(&self, place: [f32; 2]) -> f32 {
        let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
        for vertex in &self.vertices {
            let above = vertex.below(place);
            least = if above < least { above } else { least };
            most = if above > most { above } else { most };
        }
        let breadth = most - least + f32::MIN_POSITIVE;
        if least >= 0.0 { 1.0 + least / breadth } else { most / breadth }
    }
}

/// The measure of a polygon of lines, from one of them to the others in turn.
#[inline]
fn measure<'a>(apex: Vertex, rest: impl Iterator<Item = &'a Vertex>) -> f32 {
    let (_, sum) = rest
        .fold((apex, 0.0), |(before, sum), vertex| (*vertex, sum + apex.triangle(before, *vertex)));
    sum
}

impl<const N: usize> PredictiveBelief for VersionSpace<N> {
    type Belief = Self;
    type Verdicts = Decisive;
    type Predictor<'a> = DualPolygon;
    type Spread<'a> = PolygonSpread;

    fn belief(&self) -> &Self {
        self
    }

    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        Belief::observe_within(self, site, reading, tolerance)
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        Belief::observe_on_the_way(self, site, reading)
    }

    fn prepare(&mut self) {}

    fn predictor(&self, from: Site) -> DualPolygon {
        DualPolygon::of(self.lines(), from)
    }

    fn spread(&self, over: &Stretch) -> PolygonSpread {
        PolygonSpread::of(DualPolygon::of(self.lines(), over.middle), over)
    }

    fn capacity(&self) -> f32 {
        1.0
    }

    fn ground(&self) -> CellView<'_> {
        self.lines()
    }

    fn sure_of(
        &self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Option<(Label, Reliability)> {
        let lines = self.lines();
        let shift = tolerance.shift(lines.slope_arc()).unwrap_or(lines.shift);
        let lines = CellView { shift, ..lines };
        let Certainty::Certain(label) = lines.certainty(site) else { return None };
        // Wherever the position really is, the lines agree.
        let is_certain = lines.certainty(lines.place(site, -label)?) == Certainty::Certain(label);
        // One of the lines may pass just here.
        let is_open = reading == Reading::Boundary && lines.certain_within(site) <= 0.0;
        (is_certain && !is_open).then_some((label, Reliability::CERTAIN))
    }

    fn margin(&self) -> f32 {
        let lines = self.lines();
        let shift = Belief::tolerance(self).shift(lines.slope_arc()).unwrap_or(lines.shift);
        2.0 * distance(shift)
    }

    fn lacks(&self, site: Site, _: Site, due: f32) -> f32 {
        due - self.lines().certain_within(site)
    }
}

impl Prediction for DualPolygon {
    fn share_above(&self, site: Site) -> f32 {
        self.share(self.axis.see(site - self.origin))
    }

    fn information(&self, site: Site, share: f32) -> f32 {
        if self.shift == Vector::default() {
            return entropy(share);
        }
        // Either label leaves more than what agrees with it at the site: what agrees at the place where it is taken in.
        let [positive, negative] = [Label::Positive, Label::Negative]
            .map(|label| self.share(self.place(site, label)).clamp(0.0, 1.0));
        -share * log2(positive) - (1.0 - share) * log2(1.0 - negative)
    }

    fn reliability(&self, _: Site) -> f32 {
        1.0
    }
}

impl Predictor for DualPolygon {
    type After<'a> = Self;

    fn chance(&self, _: Site, share: f32) -> f32 {
        share
    }

    fn after(&self, site: Site, label: Label) -> Self {
        let [x, z] = self.axis.see(site - self.origin);
        let mut after = Self { origin: site, vertices: Vec::new(), measure: 0.0, ..*self };
        let part = self.part(self.place(site, label), label).or_else(|| self.whole());
        if let Some(part) = &part {
            for vertex in core::iter::once(&part.start).chain(self.rest(part)).take(VERTICES) {
                let offset = vertex.offset + vertex.slope * x - z;
                // A part has at most one vertex more than the whole. A full polygon loses its last.
                let _ = after.vertices.push(Vertex { offset, ..*vertex });
            }
        }
        after.measured()
    }
}

/// How far the lines of a polygon lie apart over a stretch.
#[derive(Clone, Debug)]
pub struct PolygonSpread {
    polygon: DualPolygon,
    whole: Whole,
}

impl PolygonSpread {
    /// Over a stretch in the middle of which the polygon's frame lies.
    fn of(polygon: DualPolygon, over: &Stretch) -> Self {
        // Where the frame's axis points the other way, offsets are to the other side.
        let length =
            if polygon.axis.along.dot(over.along) < 0 { -over.length } else { over.length };
        let length = length * METRE;
        let (mut sums, mut squares) = (LineSums::default(), [0.0; 3]);
        if let [apex, ref rest @ ..] = *polygon.vertices {
            for (mass, corners) in triangles(apex, rest.iter()) {
                sums.add(mass, mean(corners));
                let sum = mean(corners).map(|it| 3.0 * it);
                let all = corners.into_iter().chain([sum]);
                let more = all.fold([0.0; 3], |[a, b, c], [offset, turn]| {
                    [a + offset * offset, b + offset * turn, c + turn * turn]
                });
                for (square, more) in squares.iter_mut().zip(more) {
                    *square += mass * more / 12.0;
                }
            }
        }
        Self { polygon, whole: Whole::new(sums, squares, length) }
    }
}

impl Spread for PolygonSpread {
    fn covariance(&self) -> Covariance {
        self.whole.covariance
    }

    fn lever(&self) -> f32 {
        self.whole.lever
    }

    fn after(&self, site: Site) -> Covariance {
        let polygon = &self.polygon;
        let place = polygon.axis.see(site - polygon.origin);
        let sums = [Label::Positive, Label::Negative].map(|label| {
            let mut sums = LineSums::default();
            if let Some(part) = polygon.part(place, label) {
                for (mass, corners) in triangles(part.start, polygon.rest(&part)) {
                    sums.add(mass, mean(corners));
                }
            }
            sums
        });
        // Where positions err, a label removes as much less as it tells less.
        let share = (sums[0].mass / polygon.measure).clamp(0.0, 1.0);
        let told = polygon.information(site, share);
        let most = entropy(share);
        let told = if told < most { told / most } else { 1.0 };
        self.whole.after(sums, 1.0, told)
    }
}

/// The triangles of a polygon of lines: the measure of each, and its corners as offsets and turns.
fn triangles<'a>(
    apex: Vertex,
    rest: impl Iterator<Item = &'a Vertex>,
) -> impl Iterator<Item = (f32, [[f32; 2]; 3])> {
    rest.scan(apex, move |before, &vertex| {
        let corners = [apex, *before, vertex].map(Vertex::polar);
        let triangle = (apex.triangle(*before, vertex), corners);
        *before = vertex;
        Some(triangle)
    })
}

fn mean([a, b, c]: [[f32; 2]; 3]) -> [f32; 2] {
    [a[0] + b[0] + c[0], a[1] + b[1] + c[1]].map(|sum| sum * (1.0 / 3.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::sample::{Label, Sample};
    use crate::belief::true_labels::VersionSpace;

    #[test]
    fn shares_are_those_of_the_version_space() {
        let samples = [
            ([2.0, 1.0], Label::Negative),
            ([2.0, 8.0], Label::Positive),
            ([18.0, 16.0], Label::Positive),
            ([18.0, 5.0], Label::Negative),
        ];
        let samples = samples.map(|(place, label)| Sample::at(place, label).unwrap());
        let space = VersionSpace::<16>::new(&samples).unwrap();
        let picture = DualPolygon::of(space.lines(), samples[0].site);
        let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0);
        for k in 0..1_600 {
            let place = Site::metres([k / 40, k % 40].map(|it| f64::from(it) / 2.0)).unwrap();
            let (got, is) = (picture.share_above(place).clamp(0.0, 1.0), space.chance(place));
            let off = (f64::from(got) - is).abs();
            (sum, most, count) = (sum + off, most.max(off), count + 1);
        }
        let mean = sum / f64::from(count);
        assert!(mean < 1e-6 && most < 1e-5, "mean {mean}, most {most}");
    }
}
