//! How far lines lie apart over a stretch, and how far they are expected to after one more label.
//!
//! Over a stretch a line is an offset at its middle and a turn against it. With the lever `l = length / sqrt(12)`, the
//! distance of a line from the estimate at `s` levers from the middle is `offset + s l turn`. The variance of the lines over
//! the stretch is the sum of the variances of `offset` and `l turn`. It is also their mean at `s = -1` and `s = 1`.
//!
//! A label parts the lines in two, and what it removes of the covariance is what lies between the means of the parts. With
//! the share `F` of the lines on one side, and `d` from the mean offset and turn of the one part to those of the other:
//!
//! ```text
//! (2 p - 1)^2 F^2 (1 - F)^2 d d' / (P (1 - P))
//! ```
//!
//! `P` is the chance of a label +1. Bits do not care where along the line they are asked; the variance does. It is nearly
//! the square of the ground that the estimate misclassifies.

use crate::geometry::approximate::{LEVER, single};
use crate::geometry::lattice::{Site, Vector};

/// A label that leaves out less than this share of the lines removes nothing: single precision has no digits for it.
const LEAST: f32 = 1.0 / 1024.0;

/// Where lines are compared.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// The middle of it, on the estimate.
    pub middle: Site,
    /// Its direction, of a length near 2^24.
    pub along: Vector,
    /// How long it is, lattice units.
    pub length: f32,
}

impl Stretch {
    /// Its lever, lattice units.
    pub(crate) fn lever(&self) -> f32 {
        LEVER * self.length
    }

    /// How far along it a site lies from the middle, and how far to its left; lattice units.
    pub(crate) fn sees(&self, site: Site) -> [f32; 2] {
        let by = site - self.middle;
        [self.along.dot(by), self.along.cross(by)].map(|it| single(it) / (1 << 24) as f32)
    }
}

/// The covariance of the lines' offsets and turns over a stretch, in squares of a length that a belief chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Covariance {
    /// The variance of the offset to the left, at the middle.
    pub offset: f32,
    /// What offset and lever times turn have in common.
    pub both: f32,
    /// The variance of lever times turn to the left, radians.
    pub turn: f32,
}

impl Covariance {
    /// The variance of the lines over the stretch: the squared error.
    pub(crate) fn trace(self) -> f32 {
        self.offset + self.turn
    }

    /// Its square root is the least trace of lines as many.
    pub(crate) fn determinant(self) -> f32 {
        let (det, least) = (self.offset * self.turn - self.both * self.both, DIGITS * self.trace());
        if det > least * least { det } else { least * least }
    }

    /// The trace after labels at a place, so many levers `s` from the middle. They leave a share of the variance there.
    ///
    /// With `h = (1, s)`, the place tells `|S h|^2 / h' S h` of the trace. By the theorem of Cayley and Hamilton the rest is
    /// `det S h'h / h' S h`, which single precision knows far better.
    pub(crate) fn trace_after(self, levers: f32, leaves: f32) -> f32 {
        let there = self.offset + levers * (2.0 * self.both + levers * self.turn);
        let least = DIGITS * self.trace();
        let there = if there > least { there } else { least };
        let rest = self.determinant() * (1.0 + levers * levers) / there;
        let rest = if rest < self.trace() { rest } else { self.trace() };
        leaves * self.trace() + (1.0 - leaves) * rest
    }
}

/// The least of a variance that counts, as a share of all of it: single precision has no digits for less.
const DIGITS: f32 = 1e-6;

/// How far lines lie apart over a stretch.
pub trait Spread {
    /// The covariance of all lines.
    fn covariance(&self) -> Covariance;

    /// The lever of the stretch, in the unit of the covariance.
    fn lever(&self) -> f32;

    /// What it is expected to be after a label at a site.
    fn after(&self, site: Site) -> Covariance;
}

/// The mass of some lines, and the sums of their offsets and turns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LineSums {
    pub(crate) mass: f32,
    pub(crate) offset: f32,
    pub(crate) turn: f32,
}

impl LineSums {
    /// Adds some more: their mass, mean offset and mean turn.
    pub(crate) fn add(&mut self, mass: f32, [offset, turn]: [f32; 2]) {
        self.mass += mass;
        self.offset += mass * offset;
        self.turn += mass * turn;
    }

    /// The others, if these are all and some are among them.
    pub(crate) fn without(self, some: Self) -> Self {
        Self {
            mass: self.mass - some.mass,
            offset: self.offset - some.offset,
            turn: self.turn - some.turn,
        }
    }
}

/// All lines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Whole {
    /// In the unit of offsets.
    pub(crate) lever: f32,
    pub(crate) covariance: Covariance,
}

impl Whole {
    /// All lines, with the sums of the squares of their offsets, of offset times turn, and of the squares of turns, over a
    /// stretch so long.
    pub(crate) fn new(sums: LineSums, [offsets, products, turns]: [f32; 3], length: f32) -> Self {
        let (lever, each) = (LEVER * length, 1.0 / sums.mass);
        let (offset, turn) = (sums.offset * each, sums.turn * each);
        let covariance = Covariance {
            offset: offsets * each - offset * offset,
            both: lever * (products * each - offset * turn),
            turn: lever * lever * (turns * each - turn * turn),
        };
        Self { lever, covariance }
    }

    /// The covariance that is expected after a label that parts the lines into these two, and is true with probability
    /// `p`. It removes a share `told` of what it would by itself.
    pub(crate) fn after(self, [part, other]: [LineSums; 2], p: f32, told: f32) -> Covariance {
        let (a, b) = (1.0 / part.mass, 1.0 / other.mass);
        let offset = part.offset * a - other.offset * b;
        let turn = self.lever * (part.turn * a - other.turn * b);
        let share = part.mass / (part.mass + other.mass);
        let (bias, chance) = (2.0 * p - 1.0, p * share + (1.0 - p) * (1.0 - share));
        let (between, odds) = (bias * share * (1.0 - share), chance * (1.0 - chance));
        let all = self.covariance;
        if !(share > LEAST && share < 1.0 - LEAST) {
            return all;
        }
        let part = told * between * between / odds;
        Covariance {
            offset: all.offset - part * offset * offset,
            both: all.both - part * offset * turn,
            turn: all.turn - part * turn * turn,
        }
    }
}
