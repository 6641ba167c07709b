//! Integrals over a cell of lines by the measure d(angle) d(offset), and the mean line that follows from them.
//!
//! The integrals are taken in a frame that fits the cell: along its first direction, and about the sample at which its
//! lines spread the least. In this frame the cell's angles and offsets are small. So the integrals are accurate to some
//! 10^-6 of the cell's own extent, however thin the cell is and wherever it lies.

use core::f32::consts::FRAC_PI_2;

use crate::belief::cells::cell_view::CellView;
use crate::belief::cells::trapezoids::{Trapezoid, Trapezoids};
use crate::belief::sample::Sample;
use crate::geometry::approximate::{METRE, UnitVector, cross, inverse_sqrt};
use crate::geometry::lattice::Site;
use crate::geometry::local_line::{LocalAxes, LocalLine};

/// The integrals over some lines, each times 2^60; `n` is a line's unit normal and `r` its offset,
/// `n . q = r`.
#[derive(Clone, Copy)]
pub(crate) struct Moments {
    frame: LocalAxes,
    /// Of 1.
    measure: f32,
    /// Of `n`: along the frame and to its left.
    normal: [f32; 2],
    /// Of `r`, metres.
    offset: f32,
}

/// The factor of all integrals. Without it, integrals over the thinnest cells of the lattice would be too small for
/// single precision.
const SCALE: f32 = (1_u64 << 60) as f32;

/// An end of a trapezoid of lines, in the frame.
#[derive(Clone, Copy)]
struct End {
    /// The unit vector of its lines.
    unit: [f32; 2],
    /// The lowest of their offsets, metres.
    lowest: f32,
    /// The width of the interval of their offsets, metres.
    width: f32,
}

/// A turn of directions from `-h` to `h` about the middle one.
struct TurnIntegrals {
    middle: [f32; 2],
    /// Of `h`.
    cos: f32,
    sin: f32,
    /// The integral of `cos^2`.
    even: f32,
    /// The integral of `sin^2` by the sine of `h`, and by its square.
    odd: f32,
    odder: f32,
}

impl TurnIntegrals {
    /// From one unit vector to another, less than half a turn to its left. What is small is computed without the
    /// difference of like numbers.
    fn of([x0, z0]: [f32; 2], [x1, z1]: [f32; 2]) -> Self {
        let (sin, cos) = (x0 * z1 - z0 * x1, x0 * x1 + z0 * z1);
        let is_wide = cos < 0.0;
        // Of the sine and the cosine of `h` the larger, and the smaller.
        let square = 0.5 + 0.5 * cos.abs();
        let larger = square * inverse_sqrt(square);
        let smaller = sin / (2.0 * larger);
        let scale = 0.5 / larger;
        let (x, z) = if is_wide { (z1 - z0, x0 - x1) } else { (x0 + x1, z0 + z1) };
        let middle = [x * scale, z * scale];
        let series = SERIES.iter().fold(0.0, |sum, factor| smaller * smaller * sum + factor);
        let cubic = smaller * smaller * series;
        if is_wide {
            let even = FRAC_PI_2 - smaller * cubic;
            let (odd, odder) = ((even - sin) / larger, (even - sin) / (larger * larger));
            Self { middle, cos: smaller, sin: larger, even, odd, odder }
        } else {
            let (even, odder) = (smaller * cubic + sin, smaller * series);
            Self { middle, cos: larger, sin: smaller, even, odd: cubic, odder }
        }
    }
}

impl Moments {
    /// Over a cell.
    pub(crate) fn of(lines: CellView<'_>) -> Option<Self> {
        Self::over(lines.trapezoids()?)
    }

    /// Over the cell of some trapezoids.
    pub(crate) fn over<F: Fn(usize) -> Option<Sample> + Clone>(
        trapezoids: Trapezoids<F>,
    ) -> Option<Self> {
        let mut all = trapezoids.clone();
        let first = all.next()?;
        let frame = frame(first, all.last().unwrap_or(first), trapezoids.sites())?;
        let mut moments = Self::none(frame);
        let lowest = frame.distance(first.below, frame.unit(), first.from);
        let mut begins = End { unit: [1.0, 0.0], lowest, width: 0.0 };
        for trapezoid in trapezoids {
            let unit = UnitVector::of(trapezoid.to);
            let ends = End {
                unit: frame.seen(trapezoid.to, unit),
                lowest: frame.distance(trapezoid.below, unit, trapezoid.to),
                width: trapezoid.width_at_end(unit) * METRE,
            };
            moments.add(begins, ends);
            begins = ends;
        }
        Some(moments)
    }

    /// Adds the integrals over a trapezoid.
    ///
    /// Let its direction turn from `-h` to `h`. Width, offset and normal are sinusoids of the direction. Each has an
    /// even part, a multiple of the cosine, and an odd part, a multiple of the sine. Half the sum of the values at both
    /// ends gives the even part, half their difference the odd one. Only even products contribute, and these reduce to
    /// the integrals of `cos^2`, `h + sin h cos h`, and of `sin^2`, `h - sin h cos h`.
    fn add(&mut self, begins: End, ends: End) {
        let TurnIntegrals { middle: [x, z], cos, sin, even, odd, odder } =
            TurnIntegrals::of(begins.unit, ends.unit);
        let width = (begins.width + ends.width) / (2.0 * cos);
        let widening = 0.5 * (ends.width - begins.width);
        // Of the middle of the interval.
        let offset = (begins.lowest + ends.lowest) / (2.0 * cos) + 0.5 * width;
        let rise = 0.5 * (ends.lowest - begins.lowest + widening);
        self.measure += 2.0 * sin * (width * SCALE);
        let (even, odd) = (even * (width * SCALE), odd * (widening * SCALE));
        let [ahead, left] = self.normal;
        self.normal = [ahead - z * even - x * odd, left + x * even - z * odd];
        self.offset += even * offset + odder * (widening * SCALE) * rise;
    }

    /// No line, in a frame.
    pub(crate) const fn none(frame: LocalAxes) -> Self {
        Self { frame, measure: 0.0, normal: [0.0; 2], offset: 0.0 }
    }

    pub(crate) const fn frame(&self) -> LocalAxes {
        self.frame
    }

    /// Adds the means over other lines, with a weight.
    pub(crate) fn add_means(&mut self, other: &Self, weight: f32) {
        let weight = weight / other.measure;
        // Where the other's frame is in this, and how its directions are turned.
        let [cos, sin] = self.frame.seen(other.frame.along(), other.frame.unit());
        let [x, z] = other.frame.place(self.frame.about());
        let ([ahead, left], [ahead_so_far, left_so_far]) = (other.normal, self.normal);
        self.measure += weight * other.measure;
        self.normal = [
            ahead_so_far + weight * (cos * ahead - sin * left),
            left_so_far + weight * (sin * ahead + cos * left),
        ];
        self.offset += weight * (other.offset - (ahead * x + left * z));
    }

    /// The mean line; `None` if single precision cannot tell it.
    pub(crate) fn mean(&self) -> Option<LocalLine> {
        self.frame.line(self.normal, self.offset)
    }
}

/// `(h - sin h cos h) / sin^3 h` up to an eighth of a turn, to 4 10^-7, as a polynomial in `sin^2 h`; highest
/// power first.
const SERIES: [f32; 7] = [
    0.178_592_28,
    -0.099_111_05,
    0.103_453_085,
    0.059_266_236,
    0.108_030_59,
    0.199_971_62,
    0.666_666_8,
];

/// The frame in which a cell is small: along its first direction, about that of its samples to which the lines
/// through its first and its last vertex come nearest.
fn frame(
    first: Trapezoid,
    last: Trapezoid,
    samples: impl Iterator<Item = Site>,
) -> Option<LocalAxes> {
    let [from, to] = [first.from, last.to];
    let [per_from, per_to] = [from, to].map(|v| UnitVector::of(v).per_length);
    let mut nearest = None;
    let mut least = f32::INFINITY;
    for site in samples {
        let apart = cross(from, site - first.below).abs() * per_from
            + cross(to, site - last.below).abs() * per_to;
        if apart < least {
            (nearest, least) = (Some(site), apart);
        }
    }
    nearest.map(|about| LocalAxes::new(about, from))
}
