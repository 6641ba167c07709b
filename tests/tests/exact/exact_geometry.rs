//! Orientation and cuts against arbitrary-precision integers.

use num_bigint::{BigInt, Sign};
use planner_core::belief::cells::{Constraint, Cut, CutError, DualCell};
use planner_core::geometry::lattice::orient;
use planner_core::{Label, Sample, Site};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::adversarial;

fn coordinates(q: Site) -> [BigInt; 2] {
    [q.x().into(), q.z().into()]
}

fn big_orient(a: Site, b: Site, q: Site) -> BigInt {
    let ([ax, az], [bx, bz], [qx, qz]) = (coordinates(a), coordinates(b), coordinates(q));
    (bx - &ax) * (qz - &az) - (bz - az) * (qx - ax)
}

/// Random numbers for each of many blocks, on all cores.
fn blocks(count: u64, test: impl Fn(&mut ChaCha8Rng, u64) + Sync) {
    (0..count).into_par_iter().for_each(|seed| test(&mut ChaCha8Rng::seed_from_u64(seed), seed));
}

#[test]
fn orientation_agrees_with_big_integers_on_two_million_adversarial_cases() {
    blocks(2_000, |rng, seed| {
        let mut sites = Vec::new();
        for case in 0..1_000 {
            if sites.len() == 6 {
                sites.remove(0);
            }
            sites.push(adversarial(rng, &sites));
            let [a, b, q] = [0; 3].map(|_| sites[rng.random_range(0..sites.len())]);
            let (got, exact) = (orient(a, b, q), big_orient(a, b, q));
            assert_eq!(BigInt::from(got), exact, "seed {seed}, case {case}: {a:?} {b:?} {q:?}");
        }
    });
}

/// The polygon as vertices in big integers: the twin of a cell, cut by Sutherland and Hodgman.
struct BigCell {
    /// Each vertex with the edge that follows it.
    corners: Vec<([BigInt; 3], Constraint)>,
}

type Vector = [BigInt; 3];

fn half_plane(samples: &[Sample], edge: Constraint) -> Vector {
    let y = BigInt::from(edge.label().sign());
    let [x, z] = coordinates(samples[edge.index()].site);
    [&y * x, &y * z, y]
}

fn cross([a, b, c]: &Vector, [d, e, f]: &Vector) -> Vector {
    [b * f - c * e, c * d - a * f, a * e - b * d]
}

fn dot(a: &Vector, b: &Vector) -> BigInt {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl BigCell {
    fn triangle(samples: &[Sample], edges: [Constraint; 3]) -> Option<Self> {
        let normal = edges.map(|edge| half_plane(samples, edge));
        let turn = dot(&normal[0], &cross(&normal[1], &normal[2]));
        let order = match turn.sign() {
            Sign::NoSign => return None,
            Sign::Plus => [0, 1, 2],
            Sign::Minus => [0, 2, 1],
        };
        let corner = |k: usize| {
            let (before, after) = (order[(k + 2) % 3], order[k]);
            (cross(&normal[before], &normal[after]), edges[after])
        };
        Some(Self { corners: (0..3).map(corner).collect() })
    }

    fn edges(&self) -> Vec<Constraint> {
        self.corners.iter().map(|(_, edge)| *edge).collect()
    }

    fn cut(&mut self, samples: &[Sample], edge: Constraint) -> Result<Cut, CutError> {
        let normal = half_plane(samples, edge);
        let signs: Vec<_> = self.corners.iter().map(|(v, _)| dot(v, &normal).sign()).collect();
        if !signs.contains(&Sign::Minus) {
            return Ok(Cut::Unchanged);
        }
        if !signs.contains(&Sign::Plus) {
            return Err(CutError::Contradiction);
        }
        let n = self.corners.len();
        let mut kept = Vec::new();
        for (k, (vertex, side)) in self.corners.iter().enumerate() {
            let (here, next) = (signs[k], signs[(k + 1) % n]);
            let along = half_plane(samples, *side);
            match (here, next) {
                (Sign::Plus, Sign::Plus | Sign::NoSign) | (Sign::NoSign, Sign::Plus) => {
                    kept.push((vertex.clone(), *side));
                }
                (Sign::Plus, Sign::Minus) => {
                    kept.push((vertex.clone(), *side));
                    kept.push((cross(&along, &normal), edge));
                }
                (Sign::Minus, Sign::Plus) => kept.push((cross(&normal, &along), *side)),
                (Sign::NoSign, _) if signs[(k + n - 1) % n] == Sign::Plus => {
                    kept.push((vertex.clone(), edge));
                }
                _ => {}
            }
        }
        self.corners = kept;
        Ok(Cut::Smaller)
    }
}

/// The list from its smallest edge on, as a cyclic list has no beginning.
fn from_smallest(mut edges: Vec<Constraint>) -> Vec<usize> {
    let smallest = (0..edges.len()).min_by_key(|&k| edges[k].index()).unwrap_or(0);
    edges.rotate_left(smallest);
    edges.into_iter().map(Constraint::index).collect()
}

#[test]
fn cuts_agree_with_big_integers_on_a_million_adversarial_samples() {
    use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
    let [cuts, cut_off, refused] = [0; 3].map(AtomicUsize::new);
    blocks(40_000, |rng, seed| {
        let mut sites: Vec<Site> = Vec::new();
        while sites.len() < 32 {
            sites.push(adversarial(rng, &sites[sites.len().saturating_sub(4)..]));
        }
        // The labels of a line through two of the sites, some of them wrong.
        let (a, b) = (sites[rng.random_range(0..32)], sites[rng.random_range(0..32)]);
        let samples: Vec<_> = sites
            .into_iter()
            .map(|site| {
                let above = orient(a, b, site) > 0 || rng.random_range(0..100) == 0;
                Sample { site, label: if above { Label::Positive } else { Label::Negative } }
            })
            .collect();
        let edges: Vec<_> = (0..).zip(&samples).map(|(i, s)| Constraint::new(i, s.label)).collect();
        let Some(k) = (2..32).find(|&k| {
            DualCell::<32>::triangle(&samples, [edges[0], edges[1], edges[k]]).is_some()
        }) else {
            return;
        };
        let first = [edges[0], edges[1], edges[k]];
        let mut cell = DualCell::<32>::triangle(&samples, first).expect("found above");
        let mut big = BigCell::triangle(&samples, first).expect("as the other");
        for edge in edges {
            let before = cell.edges().to_vec();
            let (got, exact) = (cell.cut(&samples, edge), big.cut(&samples, edge));
            assert_eq!(got, exact, "seed {seed}, sample {edge:?} of {samples:?}");
            let (edges, big_edges) = (cell.edges().to_vec(), big.edges());
            assert_eq!(from_smallest(edges), from_smallest(big_edges), "seed {seed}, {edge:?}");
            cuts.fetch_add(1, Relaxed);
            match got {
                Ok(Cut::Smaller) => drop(cut_off.fetch_add(1, Relaxed)),
                Ok(Cut::Unchanged) => {}
                Err(_) => {
                    refused.fetch_add(1, Relaxed);
                    assert_eq!(cell.edges(), before, "seed {seed}: a refused cut left its mark");
                }
            }
        }
    });
    let [cuts, cut_off, refused] = [cuts, cut_off, refused].map(AtomicUsize::into_inner);
    println!("{cuts} cuts: {cut_off} made the cell smaller, {refused} were refused");
    assert!(cuts >= 1_000_000 && cut_off >= 100_000 && refused >= 10_000);
}
