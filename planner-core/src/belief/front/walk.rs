//! Masses summed up along a row of cells, from one place to the next.
//!
//! Places are counted in cells from the first one's edge.

/// Goes along two rows of cells, four at a time.
#[expect(clippy::inline_always, reason = "a build for size would call it for each cell")]
#[inline(always)]
pub(super) fn pairs(row: &mut [f32], other: &[f32], mut each: impl FnMut(&mut f32, f32)) {
    let count = row.len().min(other.len());
    let (fours, rest) = row.get_mut(..count).unwrap_or_default().as_chunks_mut::<4>();
    let (other_fours, other_rest) = other.get(..count).unwrap_or_default().as_chunks::<4>();
    for (four, other) in fours.iter_mut().zip(other_fours) {
        four.iter_mut().zip(other).for_each(|(cell, other)| each(cell, *other));
    }
    rest.iter_mut().zip(other_rest).for_each(|(cell, other)| each(cell, *other));
}

/// The mass before a place in each cell, and the whole mass, as multiples of a unit: `by` is one over it. `place` says the
/// former, from what lies before the cell and the mass in it.
#[expect(clippy::inline_always, reason = "a call for each column costs 2 % of a label")]
#[inline(always)]
fn sum_up(masses: &[f32], before: &mut [f32], by: f32, place: impl Fn(f32, f32) -> f32) -> f32 {
    let mut sum = 0.0;
    pairs(before, masses, |before, mass| {
        *before = place(sum, mass);
        sum += by * mass;
    });
    sum
}

/// The density within a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Density {
    /// It has a slope where the product of the differences to both neighbours is more than this.
    least: f32,
}

impl Density {
    /// The same all over the cell. It blurs the masses most.
    pub(crate) const EVEN: Self = Self { least: f32::MAX };

    /// It rises or falls as the masses beside it do.
    pub(crate) const SLOPED: Self = Self { least: 0.0 };

    /// Half of what it rises by within a cell, from the mass and those beside it.
    ///
    /// It is limited, so that no density is negative and no new peak arises (van Leer 1974): half of the harmonic mean of
    /// both differences, or nothing at a peak.
    fn half_rise(self, [before, mass, after]: [f32; 3]) -> f32 {
        let (rise, next) = (mass - before, after - mass);
        let product = rise * next;
        if product > self.least { product / (rise + next) } else { 0.0 }
    }
}

/// Puts the masses of some cells into others: by where the first of these begins and how wide each is, counted in the old
/// ones. The cells at the ends hold what lies beyond. `sums` is room for as many numbers as there are old cells.
#[inline(never)]
pub(crate) fn take(
    old: &[f32],
    new: &mut [f32],
    sums: &mut [f32],
    density: Density,
    [from, each]: [f32; 2],
) {
    let total = sum_up(old, sums, 1.0, |sum, _| sum);
    let until = |place: f32| {
        let cell = place as usize;
        let (Some(before), Some(mass)) = (sums.get(cell), old.get(cell)) else { return total };
        let half = match (old.get(cell.wrapping_sub(1)), old.get(cell + 1)) {
            (Some(left), Some(right)) => density.half_rise([*left, *mass, *right]),
            _ => 0.0,
        };
        let part = place - cell as f32;
        before + part * (mass - half * (1.0 - part))
    };
    let Some((last, but_last)) = new.split_last_mut() else { return };
    let (mut place, mut before) = (from + each, 0.0);
    let mut but_last = but_last.iter_mut();
    while place <= 0.0 {
        let Some(mass) = but_last.next() else { break };
        *mass = 0.0;
        place += each;
    }
    for mass in but_last {
        let until = until(place);
        // Rounding may leave a little less than nothing.
        *mass = (until - before).abs();
        before = until;
        place += each;
    }
    *last = (total - before).abs();
}

/// The sum of some masses, in four parts.
fn sum(masses: &[f32]) -> f32 {
    let (fours, rest) = masses.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for [a, b, c, d] in fours {
        let [e, f, g, h] = sums;
        sums = [e + a, f + b, g + c, h + d];
    }
    sums.iter().chain(rest).sum()
}

/// Blurs masses by a box of so many whole cells to either side of each, and a part of the next. What would lie beyond
/// stays in the edge cells, shared out by what they held. `sums` is room for as many numbers as there are masses.
#[inline(never)]
pub(crate) fn blur(old: &[f32], masses: &mut [f32], sums: &mut [f32], whole: usize, part: f32) {
    let by = 1.0 / (2.0 * (whole as f32 + part) + 1.0);
    // What lies below the upper end of a box that ends in each cell.
    let within = by * part;
    let total = sum_up(old, sums, by, |sum, mass| sum + within * mass);
    let upper = whole.saturating_add(1);
    let ends = sums.get(upper..).unwrap_or_default();
    let (below, beyond) = masses.split_at_mut_checked(ends.len()).unwrap_or_default();
    pairs(below, ends, |mass, end| *mass = end);
    beyond.fill(total);
    // Less what lies below its lower end, which is as far from the upper edge of a cell.
    let rest = by - 2.0 * within;
    let above = masses.get_mut(upper..).unwrap_or_default();
    for ((mass, below), last) in above.iter_mut().zip(&*sums).zip(old) {
        // Rounding may leave a little less than nothing.
        *mass = (*mass - below - rest * last).abs();
    }
    let (total, kept) = (total / by, sum(masses));
    let [first, last] = [old.first(), old.last()].map(|it| it.copied().unwrap_or(0.0));
    let beyond = if total > kept { total - kept } else { 0.0 };
    let share = if first + last > 0.0 { first / (first + last) } else { 0.5 };
    if let Some(mass) = masses.first_mut() {
        *mass += beyond * share;
    }
    if let Some(mass) = masses.last_mut() {
        *mass += beyond * (1.0 - share);
    }
}

/// Lets a share of each cell's mass pass to each neighbour. None passes beyond the edges. At first `masses` are the old
/// ones.
#[inline(never)]
pub(crate) fn mix(old: &[f32], masses: &mut [f32], share: f32) {
    let Some((last, but_last)) = masses.split_last_mut() else { return };
    let mut come = 0.0;
    pairs(but_last, old.get(1..).unwrap_or_default(), |mass, next| {
        let flow = share * (next - *mass);
        *mass += come + flow;
        come = -flow;
    });
    *last += come;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    const CELLS: usize = 14;

    /// Random masses, some of them nothing, from a seed.
    fn drawn(seed: u32) -> [f32; CELLS] {
        let mut draws = Draws::new(seed.into());
        core::array::from_fn(|_| {
            let mass = draws.unit() as f32;
            if mass < 0.2 { 0.0 } else { mass * mass * mass }
        })
    }

    /// Against thin slices of each cell, in double precision.
    #[test]
    fn what_is_taken_is_what_lies_there() {
        const SLICES: usize = 2_000;
        for seed in 0..200 {
            let old = drawn(seed);
            let from = (seed % 17) as f32 * 0.3 - 2.0;
            let each = 0.4 + (seed % 13) as f32 * 0.1;
            let mut twin = [0.0_f64; CELLS];
            for m in 0..CELLS {
                let at = |k: usize| f64::from(old[k]);
                let is_inner = m > 0 && m + 1 < CELLS;
                let slope = if is_inner && (at(m) - at(m - 1)) * (at(m + 1) - at(m)) > 0.0 {
                    2.0 / (1.0 / (at(m) - at(m - 1)) + 1.0 / (at(m + 1) - at(m)))
                } else {
                    0.0
                };
                for slice in 0..SLICES {
                    let part = (slice as f64 + 0.5) / SLICES as f64;
                    let density = at(m) + slope * (part - 0.5);
                    assert!(density >= -1e-9, "{seed}: {density}");
                    let place = (m as f64 + part - f64::from(from)) / f64::from(each);
                    twin[(place.max(0.0) as usize).min(CELLS - 1)] += density / SLICES as f64;
                }
            }
            let mut new = [0.0; CELLS];
            take(&old, &mut new, &mut [0.0; CELLS], Density::SLOPED, [from, each]);
            for (mass, twin) in new.iter().zip(twin) {
                assert!(*mass >= 0.0 && (f64::from(*mass) - twin).abs() < 2e-3, "seed {seed}");
            }
            let sums = [old, new].map(|it| it.iter().sum::<f32>());
            assert!((sums[0] - sums[1]).abs() < 1e-5, "{seed}: {sums:?}");
        }
    }

    /// With an even density in each cell, each shift by half a cell would add a quarter of a cell squared.
    #[test]
    fn shifts_to_and_fro_blur_little() {
        let mut masses: [f32; 32] =
            core::array::from_fn(|m| libm::expf(-0.08 * (m as f32 - 15.5) * (m as f32 - 15.5)));
        let variance = |masses: &[f32; 32]| {
            let square = |(m, mass): (usize, &f32)| mass * (m as f32 - 15.5) * (m as f32 - 15.5);
            masses.iter().enumerate().map(square).sum::<f32>() / masses.iter().sum::<f32>()
        };
        let before = variance(&masses);
        for shift in 0..20 {
            let from = if shift % 2 == 0 { 0.5 } else { -0.5 };
            let old = masses;
            take(&old, &mut masses, &mut [0.0; 32], Density::SLOPED, [from, 1.0]);
        }
        let more = variance(&masses) - before;
        assert!((-0.05..0.25 * 20.0 * 0.25).contains(&more), "{more}");
    }

    /// Against each pair of cells.
    #[test]
    fn a_box_blurs_each_cell() {
        for seed in 0..200 {
            let old = drawn(seed);
            let (whole, part) = (seed as usize % 17, (seed % 11) as f32 * 0.1);
            let mut new = [7.0; CELLS];
            blur(&old, &mut new, &mut [0.0; CELLS], whole, part);
            let by = 1.0 / (2.0 * (whole as f32 + part) + 1.0);
            let mut twin = [0.0; CELLS];
            for (m, mass) in twin.iter_mut().enumerate() {
                for (n, other) in old.iter().enumerate() {
                    let apart = m.abs_diff(n);
                    let share = if apart > whole { part } else { 1.0 };
                    *mass += if apart > whole + 1 { 0.0 } else { by * share * other };
                }
            }
            let [all, kept] = [old, twin].map(|it| it.iter().sum::<f32>());
            let ends = old[0] + old[CELLS - 1];
            let share = if ends > 0.0 { old[0] / ends } else { 0.5 };
            twin[0] += (all - kept) * share;
            twin[CELLS - 1] += (all - kept) * (1.0 - share);
            for (mass, twin) in new.iter().zip(twin) {
                assert!(*mass >= 0.0 && (mass - twin).abs() < 2e-6, "{seed}: {new:?} for {twin}");
            }
        }
    }
}
