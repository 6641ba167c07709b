//! Where a segment crosses rows: the whole coordinates that lie about the point, at one row or at one after the other.

/// The whole x of a straight way from a lower to a higher end, at one z after the other.
pub(super) struct Walk {
    z: i64,
    /// The x at that z, rounded down, and what is left of it, of the way's height.
    x: i64,
    rest: i64,
    height: i64,
    /// From one z to the next.
    step: [i64; 3],
}

impl Walk {
    /// From a z on, and one side further each time.
    pub(super) fn new(([x0, z0], [x1, z1]): ([i64; 2], [i64; 2]), z: i64, side: i64) -> Self {
        let (rise, height) = (x1 - x0, z1 - z0);
        // Differences are below 2^30, and z is less than a row and a distance away, so products are below 2^62.
        let split = |product: i64| {
            let part = product.checked_div_euclid(height).unwrap_or(0);
            (part, product - part * height)
        };
        let (part, rest) = split(rise * (z - z0));
        let (by, more) = split(rise * side);
        Self { z, x: x0 + part, rest, height, step: [side, by, more] }
    }

    /// The least and the greatest whole x at the present z, or at the end of the way that is nearer. Of a level way these are
    /// the ends of its own.
    pub(super) fn next(&mut self, [a, b]: [[i64; 2]; 2]) -> (i64, i64) {
        let Self { z, x, rest, height, step: [side, by, more] } = *self;
        self.z += side;
        self.x += by;
        self.rest += more;
        if self.rest >= height {
            self.rest -= height;
            self.x += 1;
        }
        if height == 0 {
            (a[0].min(b[0]), a[0].max(b[0]))
        } else if z <= a[1] {
            (a[0], a[0])
        } else if z >= b[1] {
            (b[0], b[0])
        } else {
            (x, x + i64::from(rest > 0))
        }
    }
}

/// The least and the greatest whole x of the point with such a z on a segment from a lower to a higher end. A level segment
/// has all of its x.
pub(super) fn along([x0, z0]: [i64; 2], [x1, z1]: [i64; 2], z: i64) -> (i64, i64) {
    // Differences are below 2^30, so products are below 2^60.
    let (product, height) = ((x1 - x0) * (z - z0), z1 - z0);
    if height > 0 && (product == 0 || z == z1) {
        let x = if z == z1 { x1 } else { x0 };
        return (x, x);
    }
    match product.checked_div_euclid(height) {
        Some(part) => (x0 + part, x0 + part + i64::from(part * height < product)),
        None => (x0.min(x1), x0.max(x1)),
    }
}
