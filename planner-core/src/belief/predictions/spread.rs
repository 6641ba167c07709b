//! How far lines lie apart over a stretch, and by how much one more label is expected to bring them together.
//!
//! Over a stretch a line is an offset at its middle and a turn against it. The variance of the lines over the stretch is
//!
//! ```text
//! V = var offset + l^2 var turn,   l^2 = length^2 / 12
//! ```
//!
//! A label parts the lines in two, and what it removes of the variance is what lies between the means of the parts. With
//! the share `F` of the lines on one side, their mean offset `r` and their mean turn `t`, and `r'` and `t'` of the others:
//!
//! ```text
//! (2 p - 1)^2 F^2 (1 - F)^2 ((r - r')^2 + l^2 (t - t')^2) / (P (1 - P) V)
//! ```
//!
//! `P` is the chance of a label +1. Bits do not care where along the line they are asked; the variance does. It is nearly
//! the square of the ground that the estimate misclassifies.

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

/// The variance of lines over a stretch.
pub trait Spread {
    /// The share of it that a label at a site is expected to remove.
    fn reduction(&self, site: Site) -> f32;
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
    /// `l^2`, in squares of the unit of offsets.
    lever: f32,
    variance: f32,
}

impl Whole {
    /// All lines, with the sums of the squares of their offsets and turns, over a stretch so long.
    pub(crate) fn new(sums: LineSums, [offsets, turns]: [f32; 2], length: f32) -> Self {
        let (lever, each) = (length * length / 12.0, 1.0 / sums.mass);
        let (offset, turn) = (sums.offset * each, sums.turn * each);
        let variance = offsets * each - offset * offset + lever * (turns * each - turn * turn);
        Self { lever, variance }
    }

    /// The share of the variance that a label is expected to remove which parts the lines into these two, and is true
    /// with probability `p`.
    pub(crate) fn reduction(self, [part, other]: [LineSums; 2], p: f32) -> f32 {
        let (a, b) = (1.0 / part.mass, 1.0 / other.mass);
        let offset = part.offset * a - other.offset * b;
        let turn = part.turn * a - other.turn * b;
        let apart = offset * offset + self.lever * (turn * turn);
        let share = part.mass / (part.mass + other.mass);
        let (bias, chance) = (2.0 * p - 1.0, p * share + (1.0 - p) * (1.0 - share));
        let (between, odds) = (bias * share * (1.0 - share), chance * (1.0 - chance));
        let parts = share > LEAST && share < 1.0 - LEAST && self.variance > 0.0;
        let reduction = between * between * apart / (odds * self.variance);
        match () {
            () if !parts => 0.0,
            () if reduction > 1.0 => 1.0,
            () => reduction,
        }
    }
}
