//! Masses summed up along a row of cells, from one place to the next.
//!
//! The density within a cell is even. Places are counted in cells from the first one's edge.

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

/// The mass before each cell, and the whole mass, as multiples of a unit: `by` is one over it.
#[expect(clippy::inline_always, reason = "a call for each column costs 2 % of a label")]
#[inline(always)]
fn sum_up(masses: &[f32], before: &mut [f32], by: f32) -> f32 {
    let mut sum = 0.0;
    pairs(before, masses, |before, mass| {
        *before = sum;
        sum += by * mass;
    });
    sum
}

/// Puts the masses of some cells into others: by where the first of these begins and how wide each is, counted in the old
/// ones. The cells at the ends hold what lies beyond. `sums` is room for as many numbers as there are old cells.
#[inline(never)]
pub(crate) fn take(old: &[f32], new: &mut [f32], sums: &mut [f32], [from, each]: [f32; 2]) {
    let total = sum_up(old, sums, 1.0);
    let until = |place: f32| {
        let cell = place as usize;
        let of_cell = sums.get(cell).zip(old.get(cell));
        let within = |(before, mass): (&f32, &f32)| before + mass * (place - cell as f32);
        if place > 0.0 { of_cell.map_or(total, within) } else { 0.0 }
    };
    let Some((last, but_last)) = new.split_last_mut() else { return };
    let (mut place, mut before) = (from, 0.0);
    for cell in but_last {
        place += each;
        let until = until(place);
        *cell = until - before;
        before = until;
    }
    *last = total - before;
}

/// Blurs masses by a box of so many whole cells to either side of each, and a part of the next. What would lie beyond
/// stays in the edge cells, shared out by what they held. `sums` is room for as many numbers as there are masses.
#[inline(never)]
pub(crate) fn blur(old: &[f32], masses: &mut [f32], sums: &mut [f32], whole: usize, part: f32) {
    let by = 1.0 / (2.0 * (whole as f32 + part) + 1.0);
    let (total, part) = (sum_up(old, sums, by), by * part);
    // What lies below the upper end of each box, less what lies below its lower end.
    let upper = whole.saturating_add(1);
    let ends = old.get(upper..).unwrap_or_default();
    let (below, beyond) = masses.split_at_mut_checked(ends.len()).unwrap_or_default();
    pairs(below, sums.get(upper..).unwrap_or_default(), |mass, sum| *mass = sum);
    pairs(below, ends, |mass, next| *mass += part * next);
    beyond.fill(total);
    let above = masses.get_mut(upper..).unwrap_or_default();
    pairs(above, sums.get(1..).unwrap_or_default(), |mass, sum| *mass -= sum);
    pairs(above, old, |mass, last| *mass += part * last);
    let (total, kept) = (total / by, masses.iter().sum::<f32>());
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
