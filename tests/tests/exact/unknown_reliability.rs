//! A reliability that nobody knows: the table against brute force over all sequences and probabilities, against a known
//! reliability, and what is refused.

use std::collections::BTreeMap;

use nalgebra::Point2;
use planner_core::belief::doubtful_labels::Hypothesis;
use planner_core::belief::estimate;
use planner_core::belief::predictions::{Prediction as _, Predictor as _};
use planner_core::error::{GivenError, ObservationError};
use planner_core::{
    AnyReliability, Belief as _, CellPosterior, FromLog as _, Label, Line, Noise, NoisyBelief,
    PosteriorView, PredictiveBelief as _, Prior, Reliability, Sample, Site, Tolerance, Trust,
    UnknownReliability,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::known::labelled;
use tests::twins::unknown_p::Joint;

type Unknown<const N: usize, const H: usize> = CellPosterior<N, H, 15, UnknownReliability>;

/// Labels at places of a standard field, and which of them are certain.
type Labels = Vec<(Sample, bool)>;

const PRIORS: [[f64; 2]; 5] = [[8.0, 2.0], [2.0, 1.0], [1.5, 0.5], [40.25, 7.5], [3.0, 2.999]];

/// One label in eight is certain, if it is true.
fn drawn(number: u64, t: usize) -> (Vec<Sample>, Labels) {
    let (given, seen, world) = labelled(number, t, false);
    let mut rng = ChaCha8Rng::seed_from_u64(number);
    let labels = seen.into_iter().map(|(sample, _)| {
        let is_true = world.agrees(sample.site, sample.label);
        (sample, is_true && rng.random_range(0..8) == 0)
    });
    (given, labels.collect())
}

fn take<const N: usize, const H: usize, R: Trust>(
    table: &mut CellPosterior<N, H, 15, R>,
    labels: &[(Sample, bool)],
) {
    let doubtful = table.noise().reliability.nominal();
    for &(sample, is_certain) in labels {
        let reliability = if is_certain { Reliability::CERTAIN } else { doubtful };
        table.take(sample, reliability).expect("room, and a possible label");
    }
}

/// The labels that a hypothesis stands for: those of any of its lines.
fn sequence<const N: usize, const H: usize, R: Trust>(
    table: &CellPosterior<N, H, 15, R>,
    h: &Hypothesis<15, R>,
) -> u64 {
    let centre = Line::from(estimate::centre(table.lines(h)).expect("a line"));
    let taken = &table.samples()[table.given().len()..];
    taken.iter().rev().fold(0, |bits, sample| {
        2 * bits + u64::from(centre.distance(Point2::from(sample.site)) > 0.0)
    })
}

fn probabilities<const N: usize, const H: usize, R: Trust>(
    table: &CellPosterior<N, H, 15, R>,
) -> BTreeMap<u64, f64> {
    let posterior = PosteriorView::new(table);
    table.iter().map(|h| (sequence(table, h), posterior.probability(h))).collect()
}

fn anywhere(rng: &mut ChaCha8Rng) -> Site {
    let mut metres = || rng.random_range(0.0..20.0);
    Site::try_from(Point2::new(metres(), metres())).expect("near")
}

#[test]
fn it_is_the_sum_over_all_sequences_and_probabilities() {
    let worst = (0..cases(60, 600))
        .into_par_iter()
        .map(|number| {
            let t = 1 + number as usize % 10;
            let (given, labels) = drawn(number, t);
            let [a, b] = PRIORS[number as usize % PRIORS.len()];
            let by_area = number % 3 != 0;
            let exact = Joint::of(&given, &labels, [a, b], by_area);
            let prior = if by_area { Prior::Area } else { Prior::Sequences };
            let noise = Noise::beta(a, b).expect("a prior");
            let mut table = Unknown::<16, 79>::new(&given, prior, noise).expect("an oracle");
            take(&mut table, &labels);
            let (got, is) = (probabilities(&table), exact.sequences());
            assert!(got.keys().eq(is.keys()), "mission {number}: {got:?} for {is:?}");
            let mut off = [0.0_f64; 4];
            for (bits, got) in &got {
                off[0] = off[0].max((got - is[bits]).abs());
            }
            let ([mean, deviation], got) = (exact.p(), PosteriorView::new(&table).reliability());
            off[1] = (got.mean - mean).abs().max((got.deviation - deviation).abs());
            let mut rng = ChaCha8Rng::seed_from_u64(number);
            for _ in 0..4 {
                let site = anywhere(&mut rng);
                let is = exact.chance(site);
                off[2] = off[2].max((table.chance(site) - is).abs());
                for (label, is) in [(Label::Positive, is), (Label::Negative, 1.0 - is)] {
                    off[3] = off[3].max((f64::from(table.chance_of(site, label)) - is).abs());
                }
            }
            let most = [1e-6, 1e-6, 1e-6, 5e-6];
            for ((what, off), most) in ["a sequence", "p", "a label", "a label in single precision"]
                .iter()
                .zip(off)
                .zip(most)
            {
                assert!(off < most, "mission {number}, {t} labels, Beta({a}, {b}), {what}: {off}");
            }
            off
        })
        .reduce(|| [0.0; 4], |a, b| [0, 1, 2, 3].map(|k| f64::max(a[k], b[k])));
    println!(
        "off by at most: sequences {:.1e}, p {:.1e}, labels {:.1e}, in single precision {:.1e}",
        worst[0], worst[1], worst[2], worst[3]
    );
}

/// The chance of a sequence of labels is the product of the chances of each. So it does not depend on their order.
#[test]
fn labels_in_any_order_come_to_the_same() {
    for number in 0..cases(40, 400) {
        let (given, labels) = drawn(number, 12);
        let of = |labels: &[(Sample, bool)]| {
            let noise = Noise::beta(8.0, 2.0).expect("a prior");
            let mut table = Unknown::<16, 79>::new(&given, Prior::Area, noise).expect("an oracle");
            let mut chance = 0.0;
            for label in labels {
                if !label.1 {
                    chance += f64::from(table.chance_of(label.0.site, label.0.label)).ln();
                }
                take(&mut table, &[*label]);
            }
            (chance, PosteriorView::new(&table).reliability(), labels.iter().any(|it| it.1))
        };
        let backwards: Vec<_> = labels.iter().rev().copied().collect();
        let ((one, p, certain), (other, q, _)) = (of(&labels), of(&backwards));
        assert!((p.mean - q.mean).abs() < 2e-6, "mission {number}: {p:?}, {q:?}");
        // A certain label has a chance of its own, which depends on what came before.
        assert!(certain || (one - other).abs() < 2e-5, "mission {number}: {one}, {other}");
    }
}

/// With huge parameters `p` is known: Beta(1000 p / q, 1000) for the odds `p / q`.
#[test]
fn a_narrow_prior_is_a_number() {
    let mut worst = 0.0_f64;
    for number in 0..cases(40, 400) {
        let (given, seen, _) = labelled(number, 12, false);
        for (a, b) in [(1000.0, 250.0), (1000.0, 999.0)] {
            let p = a / (a + b);
            let noise = Noise::new(p).expect("a probability");
            let mut known =
                CellPosterior::<16, 79>::new(&given, Prior::Area, noise).expect("an oracle");
            let noise = Noise::beta(a, b).expect("a prior");
            let mut unknown =
                Unknown::<16, 79>::new(&given, Prior::Area, noise).expect("an oracle");
            for (sample, _) in &seen {
                known.read(sample.site, sample.label).expect("room");
                unknown.read(sample.site, sample.label).expect("room");
            }
            let (known, unknown) = (probabilities(&known), probabilities(&unknown));
            assert!(known.keys().eq(unknown.keys()));
            // The variance of p is about p q / (a + b): t labels change a likelihood by a multiple of t^2 / b.
            let most = 12.0 * 12.0 / (20.0 * b);
            for (bits, it) in &known {
                let off = (unknown[bits] - it).abs();
                worst = worst.max(off / most);
                assert!(off < most, "mission {number}, Beta({a}, {b}): {off}");
            }
        }
    }
    println!("at most {worst:.3} of the bound");
}

/// The two ways to say that a reliability is unknown, and the two to say that it is known, agree bit for bit.
#[test]
fn a_choice_made_while_a_program_runs_changes_nothing() {
    fn told<R: Trust>(given: &[Sample], labels: &[(Sample, bool)], reliability: R) -> Vec<u64> {
        let noise = Noise { reliability, trusted_radius: 0, tolerance: Tolerance::NONE };
        let mut table =
            CellPosterior::<24, 100, 15, R>::new(given, Prior::Area, noise).expect("an oracle");
        take(&mut table, labels);
        let posterior = PosteriorView::new(&table);
        let weights = table.iter().map(|h| h.weight().value().to_bits());
        let p = posterior.reliability();
        weights
            .chain([p.mean, p.deviation, posterior.pruned_mass()].map(f64::to_bits))
            .chain([table.chance(given[0].site)].map(f64::to_bits))
            .collect()
    }
    for number in 0..20 {
        let (given, labels) = drawn(number, 20);
        let known = Reliability::new(0.8).expect("a probability");
        let unknown = UnknownReliability::beta(8.0, 2.0).expect("a prior");
        let of = |any: AnyReliability| told(&given, &labels, any);
        assert_eq!(of(known.into()), told(&given, &labels, known));
        assert_eq!(of(unknown.into()), told(&given, &labels, unknown));
        assert_ne!(of(known.into()), of(unknown.into()));
    }
}

#[test]
fn the_bound_on_what_was_given_up_holds() {
    let worst = (0..cases(150, 1_500))
        .into_par_iter()
        .map(|number| {
            let (given, labels) = drawn(number, 24);
            let [a, b] = PRIORS[number as usize % PRIORS.len()];
            let noise = Noise::beta(a, b).expect("a prior");
            let prior = if number % 2 == 0 { Prior::Area } else { Prior::Sequences };
            let mut small = Unknown::<28, 24>::new(&given, prior, noise).expect("an oracle");
            let mut full = Unknown::<28, 301>::new(&given, prior, noise).expect("an oracle");
            // How much was given up, and how much more the bound says, as a factor.
            let mut most = [0.0_f64; 2];
            for label in &labels {
                take(&mut full, &[*label]);
                if small.iter().all(|h| {
                    let centre = Line::from(estimate::centre(small.lines(h)).expect("a line"));
                    let above = centre.distance(Point2::from(label.0.site)) > 0.0;
                    label.1 && above != (label.0.label == Label::Positive)
                }) {
                    break; // a certain label that no hypothesis has that is left
                }
                take(&mut small, &[*label]);
                for prior in [Prior::Area, Prior::Sequences] {
                    let (full, small) = (full.weighed_by(prior), small.weighed_by(prior));
                    let cells = probabilities(&full);
                    let kept: f64 = small.iter().map(|h| cells[&sequence(&small, h)]).sum();
                    let bound = PosteriorView::new(&small).pruned_mass();
                    let lost = 1.0 - kept;
                    assert!(bound >= lost - 1e-6, "mission {number}: {bound} for {lost}");
                    most[0] = most[0].max(lost);
                    if lost > 1e-3 {
                        most[1] = most[1].max(bound / lost);
                    }
                }
            }
            most
        })
        .reduce(|| [0.0; 2], |a, b| [0, 1].map(|k| f64::max(a[k], b[k])));
    println!(
        "24 of 301 hypotheses: {:.3} given up at most; the bound is {:.1} times that at most",
        worst[0], worst[1]
    );
    assert!(worst[0] > 0.01, "nothing was pruned");
}

/// Predictions by columns beside the table, now and after one more label, at places where either label is likely.
#[test]
fn predictions_are_near_the_table() {
    let compared: Vec<[f64; 3]> = (0..cases(60, 600))
        .into_par_iter()
        .flat_map_iter(|number| {
            let (given, labels) = drawn(number, 8 + number as usize % 23);
            let [a, b] = PRIORS[number as usize % 4];
            let noise = Noise::beta(a, b).expect("a prior");
            let mut belief =
                NoisyBelief::<36, 529, UnknownReliability>::new(&given, noise).expect("an oracle");
            for &(sample, is_certain) in &labels {
                let doubtful = noise.reliability.nominal();
                let reliability = if is_certain { Reliability::CERTAIN } else { doubtful };
                belief.take(sample, reliability).expect("room");
            }
            belief.prepare();
            let predictor = belief.predictor(given[0].site);
            let mut rng = ChaCha8Rng::seed_from_u64(number);
            let posterior = PosteriorView::new(belief.belief());
            let mut place = || {
                let sites = (0..400).map(|_| anywhere(&mut rng));
                sites.into_iter().find(|it| (0.1..0.9).contains(&posterior.share_above(*it)))
            };
            let (Some(site), Some(next)) = (place(), place()) else { return None };
            let share = predictor.share_above(site);
            let chance = predictor.chance(site, share);
            let after = predictor.after(site, Label::Positive).share_above(next);
            let mut then = belief.belief().clone();
            then.read(site, Label::Positive).expect("room");
            let off = |got: f32, is: f64| (f64::from(got) - is).abs();
            Some([
                off(share, posterior.share_above(site)),
                off(chance, belief.belief().chance(site)),
                off(after, PosteriorView::new(&then).share_above(next)),
            ])
        })
        .collect();
    let count = compared.len();
    assert!(count > 20, "{count}");
    for (k, (what, most)) in [
        ("share", [0.016, 0.12]),
        ("chance", [0.025, 0.15]),
        ("share after a label", [0.025, 0.15]),
    ]
    .into_iter()
    .enumerate()
    {
        let mean = compared.iter().map(|it| it[k]).sum::<f64>() / count as f64;
        let worst = compared.iter().map(|it| it[k]).fold(0.0, f64::max);
        println!("{what} at {count} places: off by {mean:.4} on average, {worst:.3} at most");
        assert!(mean < most[0] && worst < most[1], "{what}: {mean}, {worst}");
    }
}

#[test]
fn a_log_restores_the_same_belief() {
    for number in 0..20 {
        let (given, labels) = drawn(number, 20);
        let noise = Noise::beta(8.0, 2.0).expect("a prior");
        let mut belief =
            NoisyBelief::<24, 301, UnknownReliability>::new(&given, noise).expect("an oracle");
        for &(sample, is_certain) in &labels {
            let doubtful = noise.reliability.nominal();
            let reliability = if is_certain { Reliability::CERTAIN } else { doubtful };
            belief.take(sample, reliability).expect("room");
        }
        let mut again = NoisyBelief::new(&given, noise).expect("an oracle");
        again.replay(&belief.log()).expect("its own log");
        let of = |it: &NoisyBelief<24, 301, UnknownReliability>| format!("{:?}", it.belief());
        assert_eq!(of(&again), of(&belief));
    }
}

#[test]
fn what_counts_cannot_tell_is_refused() {
    let (given, labels) = drawn(3, 8);
    let noise = Noise::beta(8.0, 2.0).expect("a prior");
    let mut table = Unknown::<16, 79>::new(&given, Prior::Area, noise).expect("an oracle");
    take(&mut table, &labels);
    let before = format!("{table:?}");
    let sample = Sample { label: Label::Positive, ..given[0] };
    for p in [0.9, 0.5, 0.0] {
        let reliability = Reliability::new(p).expect("a probability");
        assert_eq!(table.take(sample, reliability), Err(ObservationError::Reliability), "{p}");
    }
    let tolerance = Tolerance::new(0.1).expect("a tolerance");
    let within = table.read_within(sample.site, sample.label, tolerance);
    assert_eq!(within, Err(ObservationError::Tolerance(tolerance)));
    assert_eq!(format!("{table:?}"), before);
    let blurred = Noise { tolerance, ..noise };
    let none = Unknown::<16, 79>::new(&given, Prior::Area, blurred);
    assert_eq!(none.err(), Some(GivenError::Reliability));
}

#[test]
fn it_takes_no_more_room_than_it_says() {
    const { assert!(size_of::<Hypothesis<15, UnknownReliability>>() == 24) };
    const { assert!(size_of::<Unknown<36, 529>>() <= size_of::<CellPosterior<36, 529>>() + 8) };
}
