//! Ways through some places: how far a place is from one, and the parts of one in an area.

use nalgebra::Point2;

use crate::world::polygon::Polygon;

/// Straight pieces from place to place.
pub type Way = Vec<Point2<f64>>;

/// The distance of a place from the nearest piece of some ways, metres; infinite if there is no piece.
pub fn distance(at: Point2<f64>, ways: &[Way]) -> f64 {
    let pieces = ways.iter().flat_map(|way| way.windows(2));
    pieces.map(|piece| from_piece(at, [piece[0], piece[1]])).fold(f64::INFINITY, f64::min)
}

fn from_piece(at: Point2<f64>, [from, to]: [Point2<f64>; 2]) -> f64 {
    let (along, off) = (to - from, at - from);
    let square = along.x * along.x + along.y * along.y;
    let share = (off.x * along.x + off.y * along.y) / square;
    // A piece without a length has no share.
    let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
    libm::hypot(off.x - share * along.x, off.y - share * along.y)
}

/// The parts of a way in a convex polygon whose corners go counter-clockwise.
pub fn parts(way: &[Point2<f64>], area: &Polygon) -> Vec<Way> {
    let mut parts: Vec<Way> = Vec::new();
    let mut goes_on = false;
    for piece in way.windows(2) {
        let [from, to] = [piece[0], piece[1]];
        let Some([begin, end]) = shares_within(from, to, area) else {
            goes_on = false;
            continue;
        };
        let at = |share: f64| if share >= 1.0 { to } else { from + (to - from) * share };
        match parts.last_mut() {
            Some(part) if goes_on && begin <= 0.0 => part.push(at(end)),
            _ => parts.push(vec![at(begin), at(end)]),
        }
        goes_on = end >= 1.0;
    }
    parts
}

/// The part of a piece in a convex polygon, as shares of its length.
fn shares_within(from: Point2<f64>, to: Point2<f64>, area: &Polygon) -> Option<[f64; 2]> {
    let [mut begin, mut end] = [0.0_f64, 1.0_f64];
    for (p, q) in area.sides() {
        // Positive inside.
        let [at_from, at_to] = [from, to].map(|at| (q - p).perp(&(at - p)));
        let crossing = at_from / (at_from - at_to);
        match (at_from < 0.0, at_to < 0.0) {
            (true, true) => return None,
            (true, false) => begin = begin.max(crossing),
            (false, true) => end = end.min(crossing),
            (false, false) => {}
        }
    }
    (begin < end).then_some([begin, end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, z: f64) -> Point2<f64> {
        Point2::new(x, z)
    }

    #[test]
    fn parts_begin_and_end_at_the_border() {
        let area = Polygon(vec![at(0.0, 0.0), at(4.0, 0.0), at(4.0, 4.0), at(0.0, 4.0)]);
        let way =
            [at(-1.0, 1.0), at(2.0, 1.0), at(2.0, 3.0), at(6.0, 3.0), at(6.0, 2.0), at(3.0, 2.0)];
        let expected = [
            vec![at(0.0, 1.0), at(2.0, 1.0), at(2.0, 3.0), at(4.0, 3.0)],
            vec![at(4.0, 2.0), at(3.0, 2.0)],
        ];
        assert_eq!(parts(&way, &area), expected);
        assert_eq!(parts(&[at(-1.0, 5.0), at(5.0, 5.0)], &area), Vec::<Way>::new());
        assert_eq!(parts(&[at(-1.0, 3.5), at(1.0, 5.5)], &area), Vec::<Way>::new());
    }
}
