//! Beliefs after some labels: tables for labels that may be wrong, version spaces for true ones.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::Lines;
use host_sim::world::World;
use nalgebra::Point2;
use planner_core::{CellPosterior, Certainty, Label, Noise, Prior, Reliability, Sample, Site};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::cases;

/// A label at a place, seen with some reliability.
pub type Seen = (Sample, f64);

/// A standard field's oracle, and labels seen at random places of the disagreement region and elsewhere. They are true
/// with probability `p`: one `p` for all, or one for each, certain ones included. Also the world that they are of.
///
/// # Panics
/// Never: its sites are within metres of the area.
pub fn labelled(number: u64, t: usize, mixed: bool) -> (Vec<Sample>, Vec<Seen>, World) {
    let field = standard_field::standard(7, number, Algorithm::Cfc, 1);
    let mut rng = ChaCha8Rng::seed_from_u64(number);
    let mut seen = Vec::new();
    while seen.len() < t {
        let mut metres = || rng.random_range(0.0..standard_field::SIDE_M);
        let site = Site::try_from(Point2::new(metres(), metres())).expect("near");
        let dull = field.lines().certainty(site) != Certainty::Uncertain;
        if dull && rng.random_range(0..4) > 0 {
            continue; // three in four of those that could tell nothing
        }
        // A certain label, true or false, is as good as a trusted ball, and leaves few hypotheses.
        let p = match rng.random_range(0..24) {
            0 if mixed => 0.0,
            1 if mixed => 1.0,
            i if mixed => [0.3, 0.5, 0.7, 0.95, 0.999_999, 1e-300][i % 6],
            _ => 0.7,
        };
        let distance = field.world.distance(site);
        let truth = if distance > 0.0 { Label::Positive } else { Label::Negative };
        let label = if rng.random_range(0.0..1.0) < p { truth } else { -truth };
        seen.push((Sample { site, label }, p));
    }
    (field.given.samples().to_vec(), seen, field.world)
}

/// The table of such labels, by the area prior.
///
/// # Panics
/// When it has no room, or a certain label is impossible.
pub fn table<const N: usize, const H: usize>(
    given: &[Sample],
    seen: &[Seen],
) -> CellPosterior<N, H> {
    let mut table = CellPosterior::new(given, Prior::Area, Noise::NONE).expect("an oracle");
    for &(sample, p) in seen {
        let reliability = Reliability::new(p).expect("a probability");
        table.take(sample, reliability).expect("room, and a possible label");
    }
    table
}

/// What is known on standard fields after some steps of look-ahead, and where the agent then is.
///
/// # Panics
/// Never: labels are true.
pub fn spaces(steps: u32) -> impl Iterator<Item = (u64, Lines, Site)> {
    (0..cases(25, 250)).map(move |number| {
        let mission = standard_field::standard(7, number, Algorithm::Lookahead, steps);
        let mut at = mission.start.site;
        let flown = mission.fly(|step, _| at = step.pose.site).expect("labels are true");
        (number, flown.belief.version_space().expect("labels are true").clone(), at)
    })
}
