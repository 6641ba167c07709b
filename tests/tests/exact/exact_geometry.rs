//! Orientation and cuts against integers of 128 bits, in which nothing overflows: coordinates are below 2^30.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use planner_core::lattice::orient;
use planner_core::parts::{Constraint, Cut, CutError, DualCell};
use planner_core::{Label, Sample, Site};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::{adversarial, cases, sign};

type Wide = [i128; 3];

fn wide(site: Site) -> Wide {
    [site.x().into(), site.z().into(), 1]
}

fn cross([a, b, c]: Wide, [d, e, f]: Wide) -> Wide {
    [b * f - c * e, c * d - a * f, a * e - b * d]
}

fn dot([a, b, c]: Wide, [d, e, f]: Wide) -> i128 {
    a * d + b * e + c * f
}

/// Random numbers for each of many blocks, on all cores.
fn blocks(count: u64, test: impl Fn(&mut ChaCha8Rng, u64) + Sync) {
    (0..count)
        .into_par_iter()
        .for_each(|seed| test(&mut ChaCha8Rng::seed_from_u64(tests::seed(seed)), seed));
}

#[test]
fn orientation_agrees_with_wide_integers_on_adversarial_cases() {
    blocks(cases(400, 2_000), |rng, seed| {
        let mut sites = Vec::new();
        for case in 0..1_000 {
            if sites.len() == 6 {
                sites.remove(0);
            }
            sites.push(adversarial(rng, &sites));
            let [a, b, q] = [0; 3].map(|_| sites[rng.random_range(0..sites.len())]);
            let exact = dot(cross(wide(a), wide(b)), wide(q));
            let got = i128::from(orient(a, b, q));
            assert_eq!(got, exact, "seed {seed}, case {case}: {a:?} {b:?} {q:?}");
        }
    });
}

/// A polygon by its vertices: the twin of a cell, cut by Sutherland and Hodgman.
struct Polygon {
    /// Each vertex with the edge that follows it.
    corners: Vec<(Wide, Constraint)>,
}

fn half_plane(samples: &[Sample], edge: Constraint) -> Wide {
    wide(samples[edge.index()].site).map(|it| sign(edge.label()) * it)
}

impl Polygon {
    fn triangle(samples: &[Sample], edges: [Constraint; 3]) -> Option<Self> {
        let normal = edges.map(|edge| half_plane(samples, edge));
        let order = match dot(normal[0], cross(normal[1], normal[2])).signum() {
            0 => return None,
            1 => [0, 1, 2],
            _ => [0, 2, 1],
        };
        let corner = |k: usize| {
            let (before, after) = (order[(k + 2) % 3], order[k]);
            (cross(normal[before], normal[after]), edges[after])
        };
        Some(Self { corners: (0..3).map(corner).collect() })
    }

    fn cut(&mut self, samples: &[Sample], edge: Constraint) -> Result<Cut, CutError> {
        let normal = half_plane(samples, edge);
        let signs: Vec<_> = self.corners.iter().map(|it| dot(it.0, normal).signum()).collect();
        if !signs.contains(&-1) {
            return Ok(Cut::Unchanged);
        }
        if !signs.contains(&1) {
            return Err(CutError::Contradiction);
        }
        let n = self.corners.len();
        let mut kept = Vec::new();
        for (k, &(vertex, side)) in self.corners.iter().enumerate() {
            let along = half_plane(samples, side);
            match (signs[k], signs[(k + 1) % n]) {
                (1, 0 | 1) | (0, 1) => kept.push((vertex, side)),
                (1, _) => kept.extend([(vertex, side), (cross(along, normal), edge)]),
                (-1, 1) => kept.push((cross(normal, along), side)),
                (0, _) if signs[(k + n - 1) % n] == 1 => kept.push((vertex, edge)),
                _ => {}
            }
        }
        self.corners = kept;
        Ok(Cut::Smaller)
    }
}

/// The list from its smallest edge on, as a cyclic list has no beginning.
fn from_smallest(edges: impl Iterator<Item = Constraint>) -> Vec<usize> {
    let mut edges: Vec<_> = edges.map(Constraint::index).collect();
    let smallest = (0..edges.len()).min_by_key(|&k| edges[k]).unwrap_or(0);
    edges.rotate_left(smallest);
    edges
}

#[test]
fn cuts_agree_with_wide_integers_on_adversarial_samples() {
    let [cuts, cut_off, refused] = [0; 3].map(AtomicUsize::new);
    blocks(cases(4_000, 40_000), |rng, seed| {
        let mut sites: Vec<Site> = Vec::new();
        while sites.len() < 32 {
            sites.push(adversarial(rng, &sites[sites.len().saturating_sub(4)..]));
        }
        // The labels of a line through two of the sites, some of them wrong.
        let (a, b) = (sites[rng.random_range(0..32)], sites[rng.random_range(0..32)]);
        let mut label = |site| {
            let above = orient(a, b, site) > 0 || rng.random_range(0..100) == 0;
            if above { Label::Positive } else { Label::Negative }
        };
        let samples: Vec<_> =
            sites.into_iter().map(|site| Sample { site, label: label(site) }).collect();
        let edges: Vec<_> = (0..).zip(&samples).map(|(i, s)| Constraint::new(i, s.label)).collect();
        let started = edges[2..].iter().find_map(|third| {
            let first = [edges[0], edges[1], *third];
            let cell = DualCell::<32>::triangle(&samples, first);
            let twin = Polygon::triangle(&samples, first);
            assert_eq!(cell.is_some(), twin.is_some(), "seed {seed}: {first:?} of {samples:?}");
            cell.zip(twin)
        });
        let Some((mut cell, mut twin)) = started else { return };
        for edge in edges {
            let before = cell.edges().to_vec();
            let (got, exact) = (cell.cut(&samples, edge), twin.cut(&samples, edge));
            assert_eq!(got, exact, "seed {seed}, sample {edge:?} of {samples:?}");
            let is = from_smallest(twin.corners.iter().map(|it| it.1));
            let got_edges = from_smallest(cell.edges().iter().copied());
            assert_eq!(got_edges, is, "seed {seed}, {edge:?}");
            cuts.fetch_add(1, Relaxed);
            cut_off.fetch_add(usize::from(got == Ok(Cut::Smaller)), Relaxed);
            if got.is_err() {
                refused.fetch_add(1, Relaxed);
                assert_eq!(cell.edges(), before, "seed {seed}: a refused cut left its mark");
            }
        }
    });
    let [cuts, cut_off, refused] = [cuts, cut_off, refused].map(AtomicUsize::into_inner);
    let enough = cases(100_000, 1_000_000) as usize;
    assert!(cuts >= enough && cut_off >= enough / 10 && refused >= enough / 100);
}
