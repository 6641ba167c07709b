//! The hypothesis table against brute force over all sequences of labels.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use host_sim::world::World;
use nalgebra::Point2;
use planner_core::belief::doubtful_labels::Hypothesis;
use planner_core::belief::estimate;
use planner_core::error::ObservationError;
use planner_core::{
    CellPosterior, Label, Line, Noise, PosteriorView, Prior, Reliability, Sample, Site,
    VersionSpace,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::known::{Seen, labelled, table};
use tests::twins::brute;
use tests::twins::exact_mean::Separating;

/// The labels of the samples that a hypothesis stands for: those of any of its lines.
fn sequence<const N: usize, const H: usize>(
    table: &CellPosterior<N, H>,
    h: &Hypothesis<15>,
) -> u64 {
    let centre = Line::from(estimate::centre(table.lines(h)).expect("a line"));
    let taken = &table.samples()[table.given().len()..];
    taken.iter().rev().fold(0, |bits, sample| {
        2 * bits + u64::from(centre.distance(Point2::from(sample.site)) > 0.0)
    })
}

/// All separable sequences with their posterior weights by both priors, over all `2^t`; in logarithms,
/// as labels can be all but certain.
fn brute_force(given: &[Sample], seen: &[Seen]) -> BTreeMap<u64, [f64; 2]> {
    let mut weights = BTreeMap::new();
    for bits in 0..1u64 << seen.len() {
        let label = |i: usize| if bits >> i & 1 == 1 { Label::Positive } else { Label::Negative };
        let likelihood: f64 = seen
            .iter()
            .enumerate()
            .map(|(i, (s, p))| if label(i) == s.label { p.ln() } else { (-p).ln_1p() })
            .sum();
        let labelled = seen.iter().enumerate().map(|(i, (s, _))| Sample { label: label(i), ..*s });
        let samples: Vec<_> = given.iter().copied().chain(labelled).collect();
        let area = if likelihood.is_finite() { brute::measure(&samples) } else { 0.0 };
        if area > LEAST_AREA {
            weights.insert(bits, [likelihood + area.ln(), likelihood]);
        }
    }
    for prior in 0..2 {
        let most = weights.values().map(|w| w[prior]).fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = weights.values().map(|w| (w[prior] - most).exp()).sum();
        for w in weights.values_mut() {
            w[prior] = (w[prior] - most).exp() / total;
        }
    }
    weights
}

/// Thinner cells than this, in radian metres, are lost in the rounding of the brute force.
const LEAST_AREA: f64 = 1e-13;

#[test]
fn equals_brute_force_over_all_sequences() {
    let cells: usize = (0..400u64)
        .into_par_iter()
        .map(|number| {
            let t = 1 + number as usize % 12;
            let (given, seen, _) = labelled(number, t, number % 3 != 0);
            let table = table::<16, 79>(&given, &seen);
            let exact = brute_force(&given, &seen);
            let tables = [Prior::Area, Prior::Sequences].map(|prior| table.weighed_by(prior));
            let posteriors = [0, 1].map(|prior| PosteriorView::new(&tables[prior]));
            let mut found = BTreeMap::new();
            for (h, other) in table.iter().zip(tables[1].iter()) {
                let probabilities =
                    [posteriors[0].probability(h), posteriors[1].probability(other)];
                let again = found.insert(sequence(&table, h), probabilities);
                assert!(again.is_none(), "mission {number}: a sequence twice");
            }
            assert!(found.keys().eq(exact.keys()), "mission {number}: {found:?} for {exact:?}");
            for (bits, got) in &found {
                for prior in 0..2 {
                    let off = (got[prior] - exact[bits][prior]).abs();
                    assert!(
                        off < 1e-6,
                        "mission {number}, sequence {bits:b}, prior {prior}: {off}"
                    );
                }
            }
            assert_eq!(
                (posteriors[0].pruned_mass(), posteriors[1].pruned_mass(), table.outer_cells()),
                (0.0, 0.0, 0)
            );
            found.len()
        })
        .sum();
    println!("400 missions, {cells} hypotheses");
    assert!(cells > 3_000);
}

#[test]
fn the_count_stays_within_that_of_an_arrangement() {
    let most: Vec<_> = (0..40u64)
        .into_par_iter()
        .map(|number| {
            let (given, seen, _) = labelled(number, 64, false);
            let mut table = CellPosterior::<68, 2081>::new(&given, Prior::Area, Noise::NONE)
                .expect("an oracle");
            let mut edges = 0;
            for (t, &(sample, p)) in (1..).zip(&seen) {
                table.take(sample, Reliability::new(p).expect("p")).expect("room");
                assert!(table.iter().len() <= 1 + t + t * (t - 1) / 2);
                edges = edges.max(table.iter().map(|h| h.cell().edges().len()).max().unwrap_or(0));
            }
            assert!(PosteriorView::new(&table).pruned_mass() <= 0.0, "nothing was given up");
            assert_eq!(table.outer_cells(), 0);
            // The cells tile the starting polygon.
            let area = |h| f64::from(estimate::area(table.lines(h)));
            let sum: f64 = table.iter().map(area).sum();
            let whole = f64::from(estimate::area(table.start()));
            assert!((sum / whole - 1.0).abs() < 3e-7, "{sum} of {whole}");
            (table.iter().len(), edges)
        })
        .collect();
    let (cells, edges) = most.iter().fold((0, 0), |m, n| (m.0.max(n.0), m.1.max(n.1)));
    println!("64 labels: at most {cells} of 2081 hypotheses, at most {edges} edges");
}

#[test]
fn thirty_labels_fit_466_slots_without_pruning() {
    for number in 0..100 {
        let (given, seen, _) = labelled(number, 30, false);
        let small = table::<34, 466>(&given, &seen);
        let large = table::<34, 600>(&given, &seen);
        assert_eq!(
            format!("{:?}", small.iter().collect::<Vec<_>>()),
            format!("{:?}", large.iter().collect::<Vec<_>>())
        );
    }
}

#[test]
fn a_table_begins_again_in_place() {
    // Small enough that something is given up.
    let of = |number| {
        let (given, seen, _) = labelled(number, 12, false);
        (table::<20, 30>(&given, &seen), given, seen)
    };
    let (mut again, ..) = of(0);
    for number in 1..20 {
        let (anew, given, seen) = of(number);
        again.restart(&given, Prior::Area, Noise::NONE).expect("an oracle");
        again.restart(&given[..2], Prior::Area, Noise::NONE).expect_err("it is left as it was");
        for (sample, p) in seen {
            let reliability = Reliability::new(p).expect("a probability");
            again.take(sample, reliability).expect("room, and a possible label");
        }
        assert_eq!(format!("{again:?}"), format!("{anew:?}"));
    }
}

#[test]
fn tables_are_as_small_as_they_should_be() {
    const { assert!(size_of::<Hypothesis<15>>() == 24) };
    const { assert!(size_of::<CellPosterior<20, 137>>() <= 4 << 10) };
    const { assert!(size_of::<CellPosterior<36, 529>>() <= 13 << 10) };
    const { assert!(size_of::<CellPosterior<68, 2081>>() <= 56 << 10) };
    println!(
        "16, 32, 64 labels: {}, {}, {} bytes",
        size_of::<CellPosterior<20, 137>>(),
        size_of::<CellPosterior<36, 529>>(),
        size_of::<CellPosterior<68, 2081>>()
    );
}

/// Labels that are all but certain and contradict each other: as many of each kind leave one half.
#[test]
fn contradictions_cancel_however_certain_each_label_is() {
    let (given, seen, _) = labelled(3, 1, false);
    for p in [0.6, 0.999, 1.0 - 1e-16, 1e-9, 1e-300] {
        for n in [1, 20, 60] {
            let mut table = CellPosterior::<128, 2>::new(&given, Prior::Sequences, Noise::NONE)
                .expect("an oracle");
            let reliability = Reliability::new(p).expect("a probability");
            let mut see = |label| {
                let sample = Sample { label, ..seen[0].0 };
                table.take(sample, reliability).expect("room");
            };
            (0..n).for_each(|_| see(Label::Positive));
            (0..n).for_each(|_| see(Label::Negative));
            let posterior = PosteriorView::new(&table);
            assert_eq!((table.iter().len(), posterior.pruned_mass()), (2, 0.0));
            for h in table.iter() {
                let probability = posterior.probability(h);
                assert!((probability - 0.5).abs() < 1e-6, "p = {p}, n = {n}: {probability}");
            }
        }
    }
}

#[test]
fn certain_labels_leave_the_version_space() {
    for number in 0..100 {
        let (given, seen, _) = labelled(number, 30, false);
        let mut space = VersionSpace::<64>::new(&given).expect("an oracle");
        let mut table =
            CellPosterior::<64, 1>::new(&given, Prior::Area, Noise::NONE).expect("an oracle");
        for (sample, _) in seen {
            let (alone, among) = (space.insert(sample), table.take(sample, Reliability::CERTAIN));
            assert_eq!(alone.is_ok(), among.is_ok());
            let one = table.iter().next().expect("one hypothesis");
            assert_eq!(table.iter().len(), 1);
            let corners = |edges: &[planner_core::belief::cells::Constraint],
                           samples: &[Sample]| {
                let mut sites: Vec<_> = edges
                    .iter()
                    .map(|e| {
                        (samples[e.index()].site.x(), samples[e.index()].site.z(), e.label().sign())
                    })
                    .collect();
                sites.sort_unstable();
                sites
            };
            assert_eq!(
                corners(one.cell().edges(), table.samples()),
                corners(space.cell().edges(), space.samples()),
            );
        }
    }
}

#[test]
fn labels_that_say_nothing_leave_the_prior() {
    let (given, seen, _) = labelled(3, 20, false);
    let seen: Vec<_> = seen.into_iter().map(|(sample, _)| (sample, 0.5)).collect();
    let table = table::<24, 211>(&given, &seen);
    let posterior = PosteriorView::new(&table);
    for h in table.iter() {
        let share = f64::from(estimate::area(table.lines(h)) / estimate::area(table.start()));
        assert!((posterior.probability(h) - share).abs() < 1e-7);
    }
    assert!(posterior.information().abs() < 1e-6);
}

#[test]
fn the_bound_on_what_was_given_up_holds() {
    let worst = (0..200u64)
        .into_par_iter()
        .map(|number| {
            let (given, seen, _) = labelled(number, 24, false);
            let prior = if number % 2 == 0 { Prior::Area } else { Prior::Sequences };
            let mut small =
                CellPosterior::<28, 24>::new(&given, prior, Noise::NONE).expect("an oracle");
            let mut full =
                CellPosterior::<28, 301>::new(&given, prior, Noise::NONE).expect("an oracle");
            let mut most = 0.0f64;
            for &(sample, p) in &seen {
                let reliability = Reliability::new(p).expect("p");
                full.take(sample, reliability).expect("room");
                small.take(sample, reliability).expect("room");
                assert!(small.iter().len() <= 24);
                for prior in [Prior::Area, Prior::Sequences] {
                    let (full, small) = (full.weighed_by(prior), small.weighed_by(prior));
                    let whole = PosteriorView::new(&full);
                    let cells: BTreeMap<_, _> =
                        full.iter().map(|h| (sequence(&full, h), whole.probability(h))).collect();
                    let kept: f64 = small.iter().map(|h| cells[&sequence(&small, h)]).sum();
                    let bound = PosteriorView::new(&small).pruned_mass();
                    assert!(
                        bound >= 1.0 - kept - 1e-6,
                        "mission {number}: {bound} for {}",
                        1.0 - kept
                    );
                    most = most.max(1.0 - kept);
                }
            }
            most
        })
        .reduce(|| 0.0, f64::max);
    println!(
        "24 of 301 hypotheses: at most {worst:.3} of the mass was given up, never more than bounded"
    );
    assert!(worst > 0.01, "nothing was pruned");
}

#[test]
fn a_certain_label_that_leaves_no_hypothesis_is_refused() {
    let (given, seen, _) = labelled(5, 10, false);
    let mut table = table::<16, 79>(&given, &seen);
    let before = format!("{table:?}");
    let impossible = Sample { label: -given[0].label, ..given[0] };
    let refused = table.take(impossible, Reliability::CERTAIN);
    assert_eq!(refused, Err(ObservationError::Contradiction(impossible)));
    assert_eq!(format!("{table:?}"), before);
    // The very same label with room for doubt is taken.
    table.take(impossible, Reliability::new(0.9).expect("p")).expect("possible");
    // Where positions err, it has the reliability of the noise or none.
    let noise = Noise::new(0.8).and_then(|it| it.with_tolerance(0.1)).expect("a noise");
    let mut blurred =
        CellPosterior::<8, 30>::new(table.given(), Prior::Area, noise).expect("given");
    let before = format!("{blurred:?}");
    let own = blurred.take(impossible, Reliability::new(0.9).expect("p"));
    assert_eq!(own, Err(ObservationError::Reliability));
    assert_eq!(format!("{blurred:?}"), before);
    assert_eq!(blurred.take(impossible, noise.reliability), Ok(()));
    assert!(Reliability::new(1.1).is_err());
    assert!(Reliability::new(-0.1).is_err());
    assert!(Reliability::new(f64::NAN).is_err());
}

#[test]
fn a_credible_set_is_the_smallest() {
    for number in 0..100 {
        let (given, seen, _) = labelled(number, 12, number % 2 == 0);
        let table = table::<16, 79>(&given, &seen);
        for prior in [Prior::Area, Prior::Sequences] {
            let table = table.weighed_by(prior);
            let posterior = PosteriorView::new(&table);
            let mut all: Vec<_> = table.iter().map(|h| posterior.probability(h)).collect();
            all.sort_by(|a, b| b.total_cmp(a));
            let best = posterior.best().expect("a hypothesis").probability;
            assert!((best - all[0]).abs() < 1e-12);
            for level in [0.0, 0.3, 0.9, 1.0] {
                let set = posterior.credible(level);
                let mut sum = 0.0;
                let fewest = all
                    .iter()
                    .take_while(|p| {
                        let more = sum < level - 1e-12;
                        sum += **p;
                        more
                    })
                    .count();
                // To hold all there is it takes those too that no sum shows.
                let right = if level < 1.0 { set.cells == fewest } else { set.cells >= fewest };
                assert!(right, "mission {number}, level {level}: {} of {fewest}", set.cells);
                assert_eq!(posterior.members(&set).count(), set.cells);
                let members: f64 = posterior.members(&set).map(|h| posterior.probability(h)).sum();
                assert!((members - set.probability).abs() < 1e-9);
            }
        }
    }
}

/// Areas in single precision against exact ones.
#[test]
fn areas_in_single_precision_are_as_good_as_their_units() {
    let worst = (0..cases(40, 400))
        .into_par_iter()
        .map(|number| {
            let (given, mut seen, _) = labelled(number, 32, false);
            for k in (2..32).step_by(3) {
                // A hair's breadth beside the one before, for slivers.
                let near = seen[k - 1].0.site;
                let site = Site::new(near.x() + 1, near.z() + k as i32 % 3).expect("near");
                seen[k].0.site = site;
            }
            let away = 7_000 * 65_536 * (number as i32 % 3 - 1);
            let moved = |s: &Sample| Sample {
                site: Site::new(s.site.x() + away, s.site.z() - away).expect("on the lattice"),
                ..*s
            };
            let given: Vec<_> = given.iter().map(moved).collect();
            let seen: Vec<_> = seen.iter().map(|(s, p)| (moved(s), *p)).collect();
            let table = table::<36, 529>(&given, &seen);
            let off = |h: &Hypothesis<15>| {
                let support: Vec<_> = table.lines(h).support().collect();
                let exact = Separating::of(&support).expect("a cell").measure.value() / 65_536.0;
                (table.log_area(h).exp() / exact - 1.0).abs()
            };
            table.iter().map(off).fold(0.0, f64::max)
        })
        .reduce(|| 0.0, f64::max);
    println!("areas are off by {worst:.1e} of themselves at most");
    assert!(worst < 1e-6);
}

/// Cells with room for few edges hold more lines than they should, never fewer.
#[test]
fn a_cell_that_cannot_hold_its_edges_holds_more_lines_and_says_so() {
    let mut outer = 0;
    for number in 0..200 {
        let (given, seen, world) = labelled(number, 16, false);
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let mut table =
            CellPosterior::<20, 137, 4>::new(&given, Prior::Area, Noise::NONE).expect("an oracle");
        let mut exact =
            CellPosterior::<20, 137>::new(&given, Prior::Area, Noise::NONE).expect("an oracle");
        for &(sample, p) in &seen {
            let reliability = Reliability::new(p).expect("p");
            if table.take(sample, reliability).is_err() {
                break;
            }
            exact.take(sample, reliability).expect("room");
            // The true line is still among the lines of some hypothesis, unless that was given up.
            let held = table.iter().any(|h| world.is_among(table.lines(h)) == Some(true));
            let lost = PosteriorView::new(&table).pruned_mass();
            assert!(held || lost > 0.0, "mission {number}");
        }
        // So is every line of every exact hypothesis.
        if PosteriorView::new(&table).pruned_mass() <= 0.0 {
            for h in exact.iter().filter(|_| rng.random_range(0..4) == 0) {
                let line = Line::from(estimate::centre(exact.lines(h)).expect("a line"));
                let world = World::divided_by(line);
                assert!(table.iter().any(|h| world.is_among(table.lines(h)) == Some(true)));
            }
        }
        outer += u32::from(table.outer_cells());
    }
    println!("{outer} cells kept lines that they should not have");
    assert!(outer > 100);
}

/// Labels that are right one time in two tell nothing. Cells that cannot hold all their edges overlap; then they come to
/// more than the whole.
#[test]
fn labels_never_tell_less_than_nothing() {
    fn least<const E: usize>() -> (f64, u16) {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let at = |x, z| Site::try_from(Point2::<f64>::new(x, z)).expect("on the lattice");
        let given = [(2.0, 1.0, -1), (2.0, 8.0, 1), (18.0, 16.0, 1), (18.0, 5.0, -1)].map(|it| {
            let label = if it.2 > 0 { Label::Positive } else { Label::Negative };
            Sample { site: at(it.0, it.1), label }
        });
        let reliability = Reliability::new(0.500_001).expect("a probability");
        let noise = Noise { reliability, ..Noise::NONE };
        let (mut least, mut outer) = (f64::INFINITY, 0);
        for _ in 0..20 {
            let table = CellPosterior::<68, 600, E>::new(&given, Prior::Area, noise);
            let mut table = table.expect("they are apart");
            for _ in 0..40 {
                let angle = rng.random_range(0.0..TAU);
                let site = at(10.0 + 3.0 * angle.cos(), 8.0 + 3.0 * angle.sin());
                let label = if rng.random() { Label::Positive } else { Label::Negative };
                table.take(Sample { site, label }, reliability).expect("there is room");
                least = least.min(PosteriorView::new(&table).information());
            }
            outer += table.outer_cells();
        }
        (least, outer)
    }
    let (all, outer) = least::<15>();
    assert!(all >= 0.0 && outer == 0, "{all}, {outer}");
    for (bits, outer) in [least::<4>(), least::<5>(), least::<6>()] {
        assert!(bits >= 0.0 && outer > 0, "{bits}, {outer}");
    }
}
