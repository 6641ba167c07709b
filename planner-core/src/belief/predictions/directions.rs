//! Directions that represent those of all lines, placed where the lines are.
//!
//! The table gives a density over directions. The mass of each of the heaviest hypotheses is spread evenly across its
//! slope arc, and the mass of all others across the starting arc. This density is only roughly the true one. It is
//! divided into `K` equal parts, and each part is represented by its median direction *and the density there*. A user
//! who knows the true mass in that direction divides it by this density. (This is importance sampling, stratified and
//! without chance.)

use heapless::binary_heap::{BinaryHeap, Min};

use crate::belief::doubtful_labels::CellPosterior;
use crate::belief::trust::Trust;
use crate::belief::weight::LogWeight;
use crate::geometry::approximate::precise_heading_of;
use crate::geometry::arc::SlopeArc;
use crate::geometry::heading::{Angle, Heading};

/// A direction, and the density that it was drawn from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Direction {
    pub(crate) heading: Heading,
    /// Mass in a unit of a heading, on a scale for all.
    pub(crate) density: f32,
}

/// Hypotheses whose own slope arcs are used. More of them do not improve the predicted probabilities; with half as
/// many, some are off by a third.
const HEAVY: usize = 32;

/// Where the lines of a table lie.
pub(crate) fn directions<
    const N: usize,
    const H: usize,
    const E: usize,
    R: Trust,
    const K: usize,
>(
    table: &CellPosterior<N, H, E, R>,
) -> [Direction; K] {
    let (mut heaviest, mut rest) = (BinaryHeap::<(u32, u16), Min, HEAVY>::new(), 0.0);
    for (k, hypothesis) in (0..).zip(table.iter()) {
        let weight = rough_exp(hypothesis.weight());
        rest += weight;
        // Numbers that are not negative sort as their bits.
        let item = (weight.to_bits(), k);
        if heaviest.is_full() && heaviest.peek().is_some_and(|least| *least < item) {
            let _ = heaviest.pop();
        }
        let _ = heaviest.push(item); // refused if it is lighter than all
    }
    let start = table.start().slope_arc();
    let mut density = DirectionDensity::over(start);
    for &(weight, k) in &heaviest {
        let weight = f32::from_bits(weight);
        let Some(hypothesis) = table.iter().nth(k.into()) else { continue };
        density.add(table.lines(hypothesis).slope_arc(), weight);
        rest -= weight;
    }
    density.add(start, if rest > 0.0 { rest } else { 0.0 });
    density.medians()
}

/// The number whose logarithm this is, at most 0, to 6 %. Between powers of two it is interpolated linearly, as the
/// bits of a number approximate its logarithm. A density need not be accurate, as long as its value is known.
fn rough_exp(LogWeight(units): LogWeight) -> f32 {
    /// Bits of a number in 2^-16 of its logarithm.
    const BITS: f32 = (1 << (23 - 16)) as f32 * core::f32::consts::LOG2_E;
    const LEAST: i64 = -(87 << 16);
    let log = (units >> 16).clamp(LEAST, 0) as i32;
    f32::from_bits(1.0_f32.to_bits() - (-log as f32 * BITS) as u32)
}

/// By how much the density changes at a direction so far from the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Change {
    at: u32,
    by: i64,
}

/// A density over directions, constant between changes. It is in integers, so that a narrow peak leaves no residue
/// behind it. The unit is as small as lets 2^16 hypotheses of a weight of 1 add up.
struct DirectionDensity {
    first: Heading,
    mass: u64,
    changes: BinaryHeap<Change, Min, { 2 * (HEAVY + 1) }>,
}

impl DirectionDensity {
    const ONE: f32 = (1_u64 << 46) as f32;

    /// None as yet, over the directions of an arc.
    fn over(arc: SlopeArc) -> Self {
        const MARGIN: Angle = Angle(64); // for what headings are rounded by
        let first = precise_heading_of(arc.from()).turned(MARGIN.mirrored());
        Self { first, mass: 0, changes: BinaryHeap::new() }
    }

    /// Adds a mass, evenly across an arc within.
    fn add(&mut self, arc: SlopeArc, mass: f32) {
        let turn = |to| precise_heading_of(to).0.wrapping_sub(self.first.0);
        let (from, to) = (turn(arc.from()), turn(arc.to()));
        let width = to.saturating_sub(from).max(1);
        let by = (mass * Self::ONE / width as f32) as i64;
        self.mass += by as u64 * u64::from(width);
        // There is room for as many as are looked at, and one.
        let _ = self.changes.push(Change { at: from, by });
        let _ = self.changes.push(Change { at: from.saturating_add(width), by: -by });
    }

    /// The medians of `K` equal parts: half a part of the mass lies before the first, and a part between two.
    fn medians<const K: usize>(mut self) -> [Direction; K] {
        let half = self.mass / (2 * K as u64);
        let mut medians = [Direction { heading: self.first, density: f32::INFINITY }; K];
        let mut places = medians.iter_mut();
        let (mut from, mut density, mut to_next) = (0, 0_i64, half);
        while let Some(Change { at: to, by }) = self.changes.pop() {
            let mut ahead = density as u64 * u64::from(to - from);
            while ahead > to_next
                && let Some(place) = places.next()
            {
                ahead -= to_next;
                to_next = 2 * half;
                let turn = to.saturating_sub((ahead as f32 / density as f32) as u32);
                let heading = self.first.turned(Angle(turn));
                *place = Direction { heading, density: density as f32 };
            }
            to_next = to_next.saturating_sub(ahead);
            (from, density) = (to, density + by);
        }
        medians
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::lattice::Vector;

    #[test]
    fn a_rough_exponential_is_near() {
        for n in 0..=8_600 {
            let log = f64::from(n) / -100.0;
            let off = f64::from(rough_exp(LogWeight::from_log(log))) / libm::exp(log) - 1.0;
            assert!((-1e-4..0.062).contains(&off), "{log}: {off}");
        }
        assert_eq!(rough_exp(LogWeight::ZERO).to_bits(), 1.0_f32.to_bits());
        assert!(rough_exp(LogWeight(i64::MIN / 2)) > 0.0);
    }

    #[test]
    fn medians_part_the_mass_evenly() {
        // From -45 to 45 degrees, and a peak of a millionth of a radian that holds half.
        let v = |x, z| Vector::new(x, z).unwrap();
        let whole = SlopeArc::new(v(1000, -1000), v(1000, 1000));
        let peak = SlopeArc::new(v(1_000_000, 0), v(1_000_000, 1));
        let mut density = DirectionDensity::over(whole);
        density.add(peak, 1.0);
        density.add(whole, 1.0);
        let medians = density.medians::<8>().map(|it| (it.heading.radians(), it.density));
        let eighth = core::f64::consts::FRAC_PI_2 / 4.0;
        for (k, (at, density)) in medians.into_iter().enumerate() {
            let (exact, off) = match k {
                0 | 1 => (eighth * (k as f64 - 1.5), 1e-6),
                2..=5 => ((k as f64 - 1.5) / 4.0 * 1e-6, 1e-8),
                _ => (eighth * (k as f64 - 5.5), 1e-6),
            };
            assert!((at - exact).abs() < off, "{k}: {at} for {exact}");
            let width = if (2..=5).contains(&k) { 1e-6 } else { 4.0 * eighth };
            let units = f64::from(Angle::of_radians(1.0).0) * width;
            let exact = f64::from(DirectionDensity::ONE) / units;
            assert!((f64::from(density) / exact - 1.0).abs() < 0.01, "{k}: {density}");
        }
    }
}
