//! Masses summed up along a row of cells, from one place to the next.
//!
//! The density within a cell is even. Places are counted in cells from the first one's edge.

/// A walk along some cells. Each place that it is asked for lies no further back than the one before.
#[derive(Clone, Copy)]
struct Walk<'a> {
    /// The cells that are still to come.
    rest: &'a [f32],
    /// Where the present cell ends, its mass, and the mass before it.
    end: f32,
    mass: f32,
    before: f32,
}

impl<'a> Walk<'a> {
    /// Along all cells, from the first to the last.
    fn along(masses: &'a [f32]) -> Self {
        Self { rest: masses, end: 0.0, mass: 0.0, before: 0.0 }
    }

    /// The mass up to a place, which may lie before the first cell.
    #[inline]
    fn until(&mut self, place: f32) -> f32 {
        while place > self.end {
            let Some((mass, rest)) = self.rest.split_first() else {
                return self.before + self.mass;
            };
            self.before += self.mass;
            (self.mass, self.rest) = (*mass, rest);
            self.end += 1.0;
        }
        self.before + self.mass * (place - self.end + 1.0)
    }
}

/// The masses of some cells in cells elsewhere, by where the first begins and how wide each is, counted in the old ones.
/// The cells at the ends hold what lies beyond.
#[inline(never)]
pub(crate) fn take(old: &[f32], new: &mut [f32], [from, each]: [f32; 2]) {
    let mut rest = old.iter();
    let mut mass = rest.next().copied().unwrap_or(0.0);
    let (mut place, mut edge, mut end) = (0.0, 1.0, from);
    let Some((last, but_last)) = new.split_last_mut() else { return };
    let mut until = |end: f32| {
        let mut sum = 0.0;
        if end <= place {
            return sum;
        }
        while edge < end {
            sum += mass * (edge - place);
            place = edge;
            let Some(next) = rest.next() else {
                (mass, edge) = (0.0, f32::MAX);
                break;
            };
            (mass, edge) = (*next, edge + 1.0);
        }
        sum += mass * (end - place);
        place = end;
        sum
    };
    for cell in but_last {
        end += each;
        *cell = until(end);
    }
    *last = until(f32::MAX);
}

/// Blurs masses by a box of so many cells to either side. What would lie beyond stays in the edge cells.
#[inline(never)]
pub(crate) fn blur(old: &[f32], new: &mut [f32], half: f32) {
    let per_width = 0.5 / half;
    let [first, last] = [old.first(), old.last()].map(|it| it.copied().unwrap_or(0.0));
    let [mut behind, mut ahead] = [Walk::along(old); 2];
    let (mut cell, mut kept) = (0.5, 0.0);
    for mass in new.iter_mut() {
        *mass = (ahead.until(cell + half) - behind.until(cell - half)) * per_width;
        kept += *mass;
        cell += 1.0;
    }
    let beyond = old.iter().sum::<f32>() - kept;
    let beyond = if beyond > 0.0 { beyond } else { 0.0 };
    let share = if first + last > 0.0 { first / (first + last) } else { 0.5 };
    if let Some(mass) = new.first_mut() {
        *mass += beyond * share;
    }
    if let Some(mass) = new.last_mut() {
        *mass += beyond * (1.0 - share);
    }
}
