//! Masses summed up along a row of cells, from one place to the next.
//!
//! The density within a cell is even. Places are counted in cells from the first one's edge.

/// A walk along some cells. Each place that it is asked for lies no further back than the one before.
#[derive(Clone, Copy)]
pub(crate) struct Walk<'a> {
    masses: &'a [f32],
    next: usize,
    /// Cells that are still to come.
    left: usize,
    /// Where the present cell begins, its mass, and the mass before it.
    begin: f32,
    mass: f32,
    before: f32,
}

impl<'a> Walk<'a> {
    /// Along all cells, from the first to the last.
    pub(crate) fn along(masses: &'a [f32]) -> Self {
        Self { masses, next: 0, left: masses.len(), begin: -1.0, mass: 0.0, before: 0.0 }
    }

    /// All around cells of which the first follows the last, from the cell that holds a place on.
    fn around(masses: &'a [f32], place: f32) -> Self {
        let first = floor(place);
        let next = first.rem_euclid((masses.len() as i32).max(1)) as usize;
        let left = masses.len().wrapping_add(1);
        Self { masses, next, left, begin: first as f32 - 1.0, mass: 0.0, before: 0.0 }
    }

    /// The mass up to a place.
    pub(crate) fn until(&mut self, place: f32) -> f32 {
        while place >= self.begin + 1.0 && self.left > 0 {
            self.before += self.mass;
            self.mass = self.masses.get(self.next).copied().unwrap_or(0.0);
            self.next = if self.next + 1 < self.masses.len() { self.next + 1 } else { 0 };
            self.left -= 1;
            self.begin += 1.0;
        }
        let part = place - self.begin;
        self.before + self.mass * (if part < 1.0 { part } else { 1.0 })
    }
}

/// Whether cells have ends, which hold what lies beyond. Others go all around.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ends {
    Some,
    None,
}

/// The same masses in cells elsewhere, by where the first begins and how wide each is, counted in the old cells.
pub(crate) fn take<const N: usize>(
    masses: &mut [f32; N],
    [from, each]: [f32; 2],
    [had, have]: [Ends; 2],
) {
    let old = *masses;
    let all = N as f32;
    let width = each * all;
    // What goes all around is cut opposite to the middle.
    let middle = from + 0.5 * width;
    let (mut walk, end) = match (had, have) {
        (Ends::Some, _) => (Walk::along(&old), all),
        (Ends::None, Ends::Some) => (Walk::around(&old, middle - 0.5 * all), middle + 0.5 * all),
        (Ends::None, Ends::None) => (Walk::around(&old, from), from + width),
    };
    let start = if had == Ends::Some { 0.0 } else { end - all };
    let (mut before, mut place) = (walk.until(start), from);
    let last = N.saturating_sub(1);
    for (number, mass) in masses.iter_mut().enumerate() {
        place += each;
        let place = if number == last || place > end { end } else { place };
        let until = walk.until(place);
        let until = if until > before { until } else { before };
        *mass = until - before;
        before = until;
    }
}

/// The greatest integer that is no greater.
fn floor(value: f32) -> i32 {
    let near = value as i32;
    if near as f32 > value { near.wrapping_sub(1) } else { near }
}
