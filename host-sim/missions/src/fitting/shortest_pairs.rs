//! The paper's printed estimate of a record of any length: it rests on the two shortest pairs of opposite labels
//! that share no position.

use planner_core::belief::estimate;
use planner_core::{Label, LocalLine, Sample};
use rand::SeedableRng;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;
use rstar::RTree;
use rstar::primitives::GeomWithData;

use crate::fitting::hull::Row;

/// A row at its position.
type Placed = GeomWithData<[i64; 2], Row>;

/// `estimate::bisector` of a separable record whose rows [in order](crate::fitting::hull::in_order) are these.
pub fn bisector(rows: &[Row]) -> Option<LocalLine> {
    let of = |label| rows.iter().copied().filter(move |row| row.sample.label == label);
    let mut negative: Vec<_> = of(Label::Negative).collect();
    // In no order, the shortest so far is soon so short that few positive samples come into question. Only arcs
    // about one middle, of tens of thousands of samples each, take long.
    negative.shuffle(&mut ChaCha8Rng::seed_from_u64(0));
    let positive =
        RTree::bulk_load(of(Label::Positive).map(|row| Placed::new(place(row), row)).collect());
    let mut ends: Vec<Sample> = Vec::new();
    for _ in 0..2 {
        let pair = shortest(&negative, &positive, &ends);
        ends.extend(pair.into_iter().flatten());
    }
    // The two pairs alone have the bisector that all samples have.
    estimate::bisector(&ends)
}

fn place(row: Row) -> [i64; 2] {
    [i64::from(row.site().x()), i64::from(row.site().z())]
}

/// The shortest pair, apart from the positions of some samples; of several, the one whose negative sample comes
/// first in the record, then whose positive one does.
fn shortest(negative: &[Row], positive: &RTree<Placed>, but: &[Sample]) -> Option<[Sample; 2]> {
    let is_free = |row: &Row| but.iter().all(|taken| taken.site != row.site());
    let mut shortest: Option<((i64, usize, usize), [Sample; 2])> = None;
    for n in negative.iter().filter(|n| is_free(n)) {
        let most = shortest.map_or(i64::MAX, |((length, ..), _)| length);
        let within = positive.locate_within_distance(place(*n), most).map(|placed| placed.data);
        for p in within.filter(is_free) {
            let apart = p.site() - n.site();
            let rank = (apart.dot(apart), n.index, p.index);
            if shortest.is_none_or(|(least, _)| rank < least) {
                shortest = Some((rank, [n.sample, p.sample]));
            }
        }
    }
    shortest.map(|(_, pair)| pair)
}
