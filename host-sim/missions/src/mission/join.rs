//! The maps of several robots on one front, joined to one map.
//!
//! A vertex says where the front is and which way it goes there. So the joined map needs neither the order of the
//! vertices nor whose they are. Of vertices at one place the one with the smallest half-width is kept. Then each vertex is
//! linked to the next one ahead. The front is still: one that moves is mapped where it was at different times.

use nalgebra::Vector2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::mission::front::VertexRecord;

/// Vertices are at one place if they are closer along the front than this share of the usual distance of two of them.
const ONE: f64 = 0.5;

/// Vertices are at one place if they are closer across the front than so many times the sum of their half-widths: that is
/// three standard deviations and more.
const WIDE: f64 = 2.0;

/// Vertices are linked if they are no further apart than so many usual distances, or if one robot knew the front all the
/// way between.
const REACH: f64 = 3.0;

/// One robot knew the front between two vertices of a piece if one nearly follows the other among those that are kept.
/// They need not be next to each other: where a robot stayed for some steps, its vertices lie to and fro.
const NEIGHBOURS: usize = 4;

/// The map of a robot by its pieces, each vertex with its number.
pub type Pieces = crate::mission::map::Places;

/// A vertex of the joined map.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Whose it is, from 1.
    pub robot: usize,
    /// The piece of its map, from 1.
    pub piece: usize,
    /// Its number in the map of that robot.
    pub number: usize,
    /// The vertex.
    pub vertex: VertexRecord,
}

/// The joined map.
#[derive(Clone, Debug, Default)]
pub struct Joined {
    /// In the direction of the front, with +1 on the left, and the longest first. None is empty.
    pub pieces: Vec<Vec<Place>>,
    /// Whether the first piece goes all round: its last vertex is linked to its first.
    pub is_closed: bool,
}

impl Joined {
    /// Joins the maps of robots. For `n` vertices it takes a time that grows with `n log n`.
    pub fn of(robots: &[Pieces]) -> Self {
        Self::until(robots, usize::MAX)
    }

    /// The same of the vertices up to a number.
    pub fn until(robots: &[Pieces], most: usize) -> Self {
        let usual = usual_distance(robots);
        let kept = narrowest(places(robots, most), usual);
        Self::linked(&kept, usual)
    }

    /// The first number up to which the map is closed, if all of it is; found by halving.
    pub fn closes_at(robots: &[Pieces]) -> Option<usize> {
        let is_closed = |most| Self::until(robots, most).is_closed;
        let numbers = robots.iter().flatten().flatten().map(|it| it.0);
        let (mut not, mut at) = (0, numbers.max().filter(|last| is_closed(*last))?);
        while at - not > 1 {
            let middle = not.midpoint(at);
            *(if is_closed(middle) { &mut at } else { &mut not }) = middle;
        }
        Some(at)
    }

    /// Metres along the map. The way between two pieces is not counted.
    pub fn metres(&self) -> f64 {
        let way = |piece: &Vec<Place>| {
            piece.windows(2).map(|it| (it[1].vertex.at() - it[0].vertex.at()).norm()).sum::<f64>()
        };
        let closing = match self.pieces.first().map(Vec::as_slice) {
            Some([first, .., last]) if self.is_closed => {
                (first.vertex.at() - last.vertex.at()).norm()
            }
            _ => 0.0,
        };
        closing + self.pieces.iter().map(way).sum::<f64>()
    }

    /// Links each vertex to the next one ahead, and then the ends that are left, as long as some can be linked. There are
    /// such ends where vertices of two robots lie side by side: the nearest one ahead may have another one behind it.
    fn linked(kept: &[Place], usual: f64) -> Self {
        let all: Vec<_> = (0..kept.len()).collect();
        let (mut next, mut has_before) = (vec![None; kept.len()], vec![false; kept.len()]);
        let ranked = Ranked::of(kept);
        loop {
            let ends: Vec<_> = all.iter().copied().filter(|it| next[*it].is_none()).collect();
            let begins: Vec<_> = all.iter().copied().filter(|it| !has_before[*it]).collect();
            let found = links(&ranked, &ends, &begins, usual);
            if found.is_empty() {
                break;
            }
            for (from, to) in found {
                (next[from], has_before[to]) = (Some(to), true);
            }
        }
        let mut is_taken = vec![false; kept.len()];
        let mut follow = |first: usize| {
            let (mut piece, mut at) = (Vec::new(), Some(first));
            while let Some(it) = at.filter(|it| !is_taken[*it]) {
                is_taken[it] = true;
                piece.push(kept[it]);
                at = next[it];
            }
            (piece, at == Some(first))
        };
        let begins = all.iter().copied().filter(|it| !has_before[*it]);
        let mut pieces: Vec<_> = begins.map(|it| follow(it).0).collect();
        // What is left goes round. It begins with the last vertex of the first robot: where they met.
        let mut left = all.clone();
        left.sort_by_key(|it| (kept[*it].robot, usize::MAX - kept[*it].number));
        let mut is_closed = false;
        for first in left {
            let (piece, goes_round) = follow(first);
            let is_longest = || pieces.iter().all(|it| it.len() < piece.len());
            if goes_round && is_longest() {
                is_closed = true;
                pieces.insert(0, piece);
            } else if !piece.is_empty() {
                pieces.push(piece);
            }
        }
        pieces.sort_by_key(|it| usize::MAX - it.len());
        let (mut lone, mut pieces): (Vec<_>, Vec<_>) =
            pieces.into_iter().partition(|it| it.len() == 1);
        let pairs: Vec<_> = pieces.iter().flat_map(|piece| piece.windows(2)).collect();
        let begun: Vec<_> = pairs.iter().zip(0..).map(|(pair, k)| at(&pair[0], k)).collect();
        let begun = RTree::bulk_load(begun);
        lone.retain(|it| !is_passed(&it[0], (&begun, &pairs), REACH * usual));
        pieces.append(&mut lone);
        Self { pieces, is_closed }
    }
}

/// A place on the map, by its number in a list.
type Numbered = GeomWithData<[f64; 2], usize>;

fn at(place: &Place, number: usize) -> Numbered {
    GeomWithData::new([place.vertex.x, place.vertex.z], number)
}

/// The numbers of the places within a distance of one, and of some that are a little further away.
fn around(places: &RTree<Numbered>, of: &Place, distance: f64) -> impl Iterator<Item = usize> {
    const SPARE: f64 = 1.0 + 1e-9;
    let within = (SPARE * distance).powi(2);
    places.locate_within_distance([of.vertex.x, of.vertex.z], within).map(|it| it.data)
}

/// The vertices that are kept, and in which order their robots mapped them.
struct Ranked<'a> {
    kept: &'a [Place],
    order: Vec<usize>,
    /// The place of each in the order.
    rank: Vec<usize>,
}

impl<'a> Ranked<'a> {
    fn of(kept: &'a [Place]) -> Self {
        let mut order: Vec<_> = (0..kept.len()).collect();
        order.sort_by_key(|it| (kept[*it].robot, kept[*it].piece, kept[*it].number));
        let mut rank = vec![0; kept.len()];
        for (place, it) in order.iter().enumerate() {
            rank[*it] = place;
        }
        Self { kept, order, rank }
    }

    /// Those that nearly precede or follow one in a piece of its robot.
    fn neighbours(&self, one: usize) -> impl Iterator<Item = usize> {
        let of = |it: usize| (self.kept[it].robot, self.kept[it].piece);
        let rank = self.rank[one];
        let around = rank.saturating_sub(NEIGHBOURS)..self.order.len().min(rank + NEIGHBOURS + 1);
        self.order[around].iter().copied().filter(move |it| of(*it) == of(one))
    }
}

/// Links from ends to begins: each is the nearest one ahead of the other, and the nearest one behind.
fn links(ranked: &Ranked<'_>, ends: &[usize], begins: &[usize], usual: f64) -> Vec<(usize, usize)> {
    let kept = ranked.kept;
    let tree = |of: &[usize]| RTree::bulk_load(of.iter().map(|it| at(&kept[*it], *it)).collect());
    let is_in = |of: &[usize]| {
        let mut is_in = vec![false; kept.len()];
        for it in of {
            is_in[*it] = true;
        }
        is_in
    };
    let (ends_at, begins_at) = ((tree(ends), is_in(ends)), (tree(begins), is_in(begins)));
    let nearest = |from: usize, (others, is_other): &(RTree<Numbered>, Vec<bool>), sign: f64| {
        let way = |other: &usize| kept[*other].vertex.at() - kept[from].vertex.at();
        let is_ahead = |other: &usize| {
            let way = sign * way(other);
            [from, *other].iter().all(|it| direction(&kept[*it].vertex).dot(&way) > 0.0)
        };
        let reach = REACH * usual;
        let near = around(others, &kept[from], reach);
        let near = near.filter(|it| way(it).norm() <= reach);
        let own = ranked.neighbours(from).filter(|it| is_other[*it]);
        let ahead = near.chain(own).filter(is_ahead);
        // Of those as near the first.
        let key = |it: &usize| (way(it).norm_squared(), *it);
        ahead.min_by(|a, b| {
            let ((a, first), (b, second)) = (key(a), key(b));
            a.total_cmp(&b).then(first.cmp(&second))
        })
    };
    let link = |from: &usize| {
        let to = nearest(*from, &begins_at, 1.0)?;
        (nearest(to, &ends_at, -1.0) == Some(*from)).then_some((*from, to))
    };
    ends.iter().filter_map(link).collect()
}

/// Whether a vertex has one of some linked pairs around it, one behind it and one ahead. The pairs begin at these places.
fn is_passed(place: &Place, (begun, pairs): (&RTree<Numbered>, &[&[Place]]), reach: f64) -> bool {
    let ahead = direction(&place.vertex);
    let along = |other: &Place| {
        let way = other.vertex.at() - place.vertex.at();
        let is_near = way.norm() <= reach && direction(&other.vertex).dot(&ahead) > 0.0;
        is_near.then(|| way.dot(&ahead))
    };
    let goes_by = |pair: &[Place]| {
        along(&pair[0]).is_some_and(|it| it <= 0.0) && along(&pair[1]).is_some_and(|it| it >= 0.0)
    };
    around(begun, place, reach).any(|it| goes_by(pairs[it]))
}

/// All vertices up to a number.
fn places(robots: &[Pieces], most: usize) -> Vec<Place> {
    let mut places = Vec::new();
    for (robot, pieces) in (1..).zip(robots) {
        for (piece, vertices) in (1..).zip(pieces) {
            let up_to = vertices.iter().filter(|it| it.0 <= most);
            places.extend(up_to.map(|&(number, vertex)| Place { robot, piece, number, vertex }));
        }
    }
    places
}

/// The median distance of a vertex from the one before in its piece, metres; 0 if no piece has two.
fn usual_distance(robots: &[Pieces]) -> f64 {
    let ways = robots.iter().flatten().flat_map(|piece| piece.windows(2));
    let mut ways: Vec<_> = ways.map(|it| (it[1].1.at() - it[0].1.at()).norm()).collect();
    ways.sort_by(f64::total_cmp);
    ways.get(ways.len() / 2).copied().unwrap_or(0.0)
}

/// Of vertices at one place the one with the smallest half-width, and of equals the first.
fn narrowest(mut places: Vec<Place>, reach: f64) -> Vec<Place> {
    places.sort_by(|a, b| a.vertex.half_width.total_cmp(&b.vertex.half_width));
    let (mut kept, mut tree) = (Vec::<Place>::new(), RTree::new());
    for place in places {
        // None before has a wider half-width.
        let across = reach.max(2.0 * WIDE * place.vertex.half_width);
        let is_there = |it: usize| are_at_one_place(&kept[it].vertex, &place.vertex, reach);
        if !around(&tree, &place, across.hypot(ONE * reach)).any(is_there) {
            tree.insert(at(&place, kept.len()));
            kept.push(place);
        }
    }
    kept
}

/// Whether two vertices are the same place of the front. Where they are near and the front goes the other way, it is the
/// other side of a narrow bay.
fn are_at_one_place(one: &VertexRecord, other: &VertexRecord, reach: f64) -> bool {
    let (ahead, way) = (direction(one), other.at() - one.at());
    let (along, across) = (ahead.dot(&way).abs(), ahead.perp(&way).abs());
    let within = reach.max(WIDE * (one.half_width + other.half_width));
    direction(other).dot(&ahead) > 0.0 && along < ONE * reach && across <= within
}

fn direction(vertex: &VertexRecord) -> Vector2<f64> {
    let (sin, cos) = libm::sincos(vertex.heading);
    Vector2::new(cos, sin)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::*;

    /// A vertex of a circle of 20 m at an angle. The front goes counter-clockwise.
    fn on_circle(angle: f64, half_width: f64) -> VertexRecord {
        let (sin, cos) = libm::sincos(angle);
        let (heading, curvature, turn_deviation) = (angle + PI / 2.0, 0.05, 0.01);
        VertexRecord {
            x: 20.0 * cos,
            z: 20.0 * sin,
            heading,
            curvature,
            half_width,
            turn_deviation,
        }
    }

    /// A robot that goes by 0.1 radians (2 m) a step from an angle, one way or the other.
    fn robot(from: f64, way: f64, steps: usize, half_width: f64) -> Pieces {
        let vertex = |k: usize| (k, on_circle(from + way * 0.1 * k as f64, half_width));
        vec![(1..=steps).map(vertex).collect()]
    }

    #[test]
    fn two_robots_back_to_back_make_one_way() {
        let robots = [robot(0.0, 1.0, 12, 0.5), robot(0.0, -1.0, 9, 0.5)];
        let it = Joined::of(&robots);
        let [piece] = &it.pieces[..] else { panic!("{it:?}") };
        let numbers: Vec<_> = piece.iter().map(|it| (it.robot, it.number)).collect();
        let far = (1..=9).rev().map(|k| (2, k)).chain((1..=12).map(|k| (1, k)));
        assert_eq!(numbers, far.collect::<Vec<_>>());
        assert!(!it.is_closed && Joined::closes_at(&robots).is_none());
        assert!((it.metres() - 42.0).abs() < 0.1, "{}", it.metres());
    }

    #[test]
    fn where_two_robots_meet_the_narrower_is_kept() {
        let robots = [robot(0.0, 1.0, 40, 0.5), robot(0.02, -1.0, 40, 0.3)];
        let it = Joined::of(&robots);
        assert!(it.is_closed && it.pieces.len() == 1, "{it:?}");
        // All of the second, and of the first what the second has not mapped.
        let of = |robot: usize| it.pieces[0].iter().filter(move |it| it.robot == robot);
        assert_eq!(of(2).count(), 40);
        assert!(of(1).all(|it| it.number < 24), "{it:?}");
        assert!((it.metres() - 40.0 * PI).abs() < 0.5, "{}", it.metres());
        let met = Joined::closes_at(&robots).expect("closed");
        assert!((29..=32).contains(&met), "{met}: half of {} steps", (TAU / 0.1) as u32);
        // It begins where they met.
        assert_eq!(it.pieces[0][0].robot, 1);
    }

    /// A vertex of a nearly straight front.
    fn on_line(x: f64, z: f64, heading: f64) -> VertexRecord {
        VertexRecord { x, z, heading, ..on_circle(0.0, 0.5) }
    }

    #[test]
    fn the_sides_of_a_narrow_bay_are_two_places() {
        let out = (1..=5).map(|k| (k, on_line(2.0 * k as f64, 0.0, 0.0))).collect();
        let back = (1..=5).map(|k| (k, on_line(12.0 - 2.0 * k as f64, 0.6, PI))).collect();
        let it = Joined::of(&[vec![out], vec![back]]);
        let count: usize = it.pieces.iter().map(Vec::len).sum();
        assert_eq!((count, it.is_closed), (10, false), "{it:?}");
        let is_one_way = |piece: &Vec<Place>| piece.iter().all(|it| it.robot == piece[0].robot);
        assert!(it.pieces.iter().all(is_one_way), "{it:?}");
    }

    /// The nearest vertex ahead of the third has another one nearest behind it, which lies beside the way.
    #[test]
    fn vertices_side_by_side_do_not_break_the_map() {
        let line = [-4.0, -2.0, 0.0].map(|x| on_line(x, 0.0, 0.0));
        let bend = [(2.0, 0.0), (3.9, -0.6), (5.8, -1.2)].map(|(x, z)| on_line(x, z, -0.3));
        let one = (1..).zip(line.into_iter().chain(bend)).collect();
        let other = vec![vec![(1, on_line(1.2, 1.65, 0.0))]];
        let it = Joined::of(&[vec![one], other]);
        let lengths: Vec<_> = it.pieces.iter().map(Vec::len).collect();
        assert_eq!(lengths, [7], "{it:?}");
    }

    /// The robot stays for some steps where the front is not well known, and then knows it far ahead.
    #[test]
    fn a_robots_own_piece_has_no_gap() {
        let angles = [0.0, 0.1, 0.2, 0.28, 0.24, 0.8, 0.9, 1.0];
        let vertices = (1..).zip(angles.map(|it| on_circle(it, 0.5)));
        let it = Joined::of(&[vec![vertices.collect()]]);
        assert_eq!(it.pieces.len(), 1, "{it:?}");
    }

    /// Three quarters of a circle do not close, although a robot mapped them in one piece.
    #[test]
    fn an_arc_does_not_close() {
        let it = Joined::of(&[robot(0.0, 1.0, 47, 0.5)]);
        assert_eq!((it.pieces.len(), it.is_closed), (1, false), "{it:?}");
    }

    /// The joined map does not depend on the order of the maps, but for whose its vertices are.
    #[test]
    fn the_order_of_maps_does_not_matter() {
        let [one, other] = [robot(0.0, 1.0, 40, 0.5), robot(0.02, -1.0, 40, 0.3)];
        let places = |robots: &[Pieces]| {
            let it = Joined::of(robots);
            let mut bits: Vec<_> = it.pieces[0]
                .iter()
                .map(|it| [it.vertex.x, it.vertex.z].map(f64::to_bits))
                .collect();
            bits.sort_unstable();
            bits
        };
        assert_eq!(places(&[one.clone(), other.clone()]), places(&[other, one]));
    }

    #[test]
    fn a_gap_stays_a_gap() {
        let it = Joined::of(&[robot(0.0, 1.0, 5, 0.5), robot(3.0, 1.0, 7, 0.5)]);
        let lengths: Vec<_> = it.pieces.iter().map(Vec::len).collect();
        assert_eq!((lengths, it.is_closed), (vec![7, 5], false));
        assert!(Joined::of(&[vec![], vec![]]).pieces.is_empty());
        assert_eq!(Joined::of(&[robot(0.0, 1.0, 1, 0.5)]).pieces.len(), 1);
    }
}
