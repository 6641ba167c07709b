//! The hypothesis table against brute force over all sequences of labels and all reliabilities, and what it refuses.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use host_sim::world::World;
use nalgebra::Point2;
use planner_core::error::{GivenError, ObservationError};
use planner_core::parts::Hypothesis;
use planner_core::{
    AnyReliability, Belief as _, CellPosterior, Label, Line, Noise, PosteriorView, Prior,
    Reliability, Sample, Site, Tolerance, Trust, UnknownReliability, estimate,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::known::{labelled, table};
use tests::twins::exact_mean::Separating;
use tests::twins::joint::{Doubtful, Joint};
use tests::{cases, is_long};

type Table<const N: usize, const H: usize, const E: usize = 15> =
    CellPosterior<N, H, E, AnyReliability>;

const PRIORS: [Prior; 2] = [Prior::Area, Prior::Sequences];

const BETAS: [[f64; 2]; 6] =
    [[8.0, 2.0], [2.0, 1.0], [1.5, 0.5], [40.25, 7.5], [3.0, 2.999], [1000.0, 250.0]];

/// Labels at places of a standard field.
struct Case {
    given: Vec<Sample>,
    seen: Vec<Doubtful>,
    noise: Noise<AnyReliability>,
    beta: [f64; 2],
    world: World,
}

impl Case {
    /// By turns labels are true with a probability of 0.7, each with another, or with one that nobody knows: then one in
    /// eight is certain, if it is true.
    fn new(number: u64, labels: usize) -> Self {
        let kind = number % 3;
        let (given, seen, world) = labelled(number, labels, kind == 1);
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
        let [a, b] = BETAS[number as usize / 3 % BETAS.len()];
        let mut certain =
            |it: Sample| world.agrees(it.site, it.label) && rng.random_range(0..8) == 0;
        let chance = |(sample, p): (Sample, f64)| match kind {
            2 => (sample, certain(sample).then_some(1.0)),
            _ => (sample, Some(p)),
        };
        let seen = seen.into_iter().map(chance).collect();
        let noise = match kind {
            2 => Noise::beta(a, b).expect("a prior").into(),
            _ => Noise::new(0.7).expect("a probability").into(),
        };
        Self { given, seen, noise, beta: [a, b], world }
    }

    /// The table before the first label.
    fn start<const N: usize, const H: usize, const E: usize>(
        &self,
        prior: Prior,
    ) -> Table<N, H, E> {
        Table::new(&self.given, prior, self.noise).expect("an oracle")
    }

    /// How far a label can be believed.
    fn reliability(&self, p: Option<f64>) -> Reliability {
        let nominal = self.noise.reliability.nominal();
        p.map_or(nominal, |p| Reliability::new(p).expect("a probability"))
    }

    /// The table after all labels.
    fn table<const N: usize, const H: usize>(&self, prior: Prior) -> Table<N, H> {
        let mut table = self.start(prior);
        for &(sample, p) in &self.seen {
            table.take(sample, self.reliability(p)).expect("room, and a possible label");
        }
        table
    }
}

/// The labels that a hypothesis stands for: those of any of its lines.
fn sequence<const N: usize, const H: usize>(
    table: &Table<N, H>,
    h: &Hypothesis<15, AnyReliability>,
) -> u64 {
    let centre = Line::from(estimate::centre(table.lines(h)).expect("a line"));
    let taken = &table.samples()[table.given().len()..];
    taken.iter().rev().fold(0, |bits, sample| {
        2 * bits + u64::from(centre.distance(Point2::from(sample.site)) > 0.0)
    })
}

fn probabilities<const N: usize, const H: usize>(table: &Table<N, H>) -> BTreeMap<u64, f64> {
    let posterior = PosteriorView::new(table);
    table.iter().map(|h| (sequence(table, h), posterior.probability(h))).collect()
}

/// Hypotheses, what is known of an unknown reliability, and the chances of labels. As many slots as an arrangement has
/// cells do.
#[test]
fn a_table_is_the_sum_over_all_sequences_and_probabilities() {
    let cells = (0..cases(48, 1_200)).into_par_iter().map(|number| {
        let most = if number % 3 == 2 { 10 } else { 12 };
        // The first ones fill the table.
        let labels = most - number as usize / 3 % most;
        let case = Case::new(number, labels);
        let table = case.table::<16, 79>(Prior::Area);
        for (prior, by_area) in PRIORS.into_iter().zip([true, false]) {
            let table = table.weighed_by(prior);
            let exact = Joint::of(&case.given, &case.seen, case.beta, by_area);
            let (got, is) = (probabilities(&table), exact.sequences());
            let context = format!("mission {number}, {labels} labels, {:?}, {prior:?}", case.noise);
            assert_eq!(got.len(), table.iter().len(), "{context}: a sequence twice");
            assert!(got.keys().eq(is.keys()), "{context}: {got:?} for {is:?}");
            for (bits, got) in &got {
                let off = (got - is[bits]).abs();
                assert!(off < 1e-6, "{context}: sequence {bits:b} off by {off}");
            }
            let posterior = PosteriorView::new(&table);
            if number % 3 == 2 {
                let ([mean, deviation], got) = (exact.p(), posterior.reliability());
                let off = (got.mean - mean).abs().max((got.deviation - deviation).abs());
                assert!(off < 1e-6, "{context}: p is off by {off}");
            }
            assert_eq!((posterior.pruned_mass(), table.outer_cells()), (0.0, 0), "{context}");
            let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
            for _ in 0..if by_area { 3 } else { 0 } {
                let mut metres = || rng.random_range(0.0..20.0);
                let site = Site::try_from(Point2::new(metres(), metres())).expect("near");
                let is = exact.chance(site, (number % 3 < 2).then_some(0.7));
                let got = table.chance(site);
                assert!((got - is).abs() < 1e-6, "{context}: a label is off: {got} for {is}");
                for (label, is) in [(Label::Positive, is), (Label::Negative, 1.0 - is)] {
                    let got = f64::from(table.chance_of(site, label));
                    assert!((got - is).abs() < 5e-6, "{context}: in single precision {got}");
                }
            }
        }
        table.iter().len()
    });
    assert!(cells.sum::<usize>() > cases(400, 10_000) as usize);
}

#[test]
fn the_count_stays_within_that_of_an_arrangement() {
    (0..cases(8, 40)).into_par_iter().for_each(|number| {
        let case = Case::new(3 * number, 64);
        let mut table = case.start::<68, 2081, 15>(Prior::Area);
        for (t, &(sample, p)) in (1..).zip(&case.seen) {
            table.take(sample, case.reliability(p)).expect("room");
            assert!(table.iter().len() <= 1 + t + t * (t - 1) / 2);
        }
        assert!(PosteriorView::new(&table).pruned_mass() <= 0.0, "nothing was given up");
        assert_eq!(table.outer_cells(), 0);
        // The cells tile the starting polygon.
        let sum: f64 = table.iter().map(|h| f64::from(estimate::area(table.lines(h)))).sum();
        let whole = f64::from(estimate::area(table.start()));
        assert!((sum / whole - 1.0).abs() < 3e-7, "{sum} of {whole}");
    });
}

#[test]
fn a_table_begins_again_in_place() {
    let mut again = Case::new(0, 12).table::<20, 30>(Prior::Area);
    for number in 1..30 {
        let case = Case::new(number, 12);
        again.restart(&case.given, Prior::Area, case.noise).expect("an oracle");
        again.restart(&case.given[..2], Prior::Area, case.noise).expect_err("it is left as it was");
        // Small enough that something is given up, and then a certain label may be none of those left.
        let mut anew = case.start::<20, 30, 15>(Prior::Area);
        for &(sample, p) in &case.seen {
            let reliability = case.reliability(p);
            assert_eq!(again.take(sample, reliability), anew.take(sample, reliability));
        }
        assert_eq!(format!("{again:?}"), format!("{anew:?}"));
    }
}

#[test]
fn tables_are_as_small_as_they_should_be() {
    type Unknown<const N: usize, const H: usize> = CellPosterior<N, H, 15, UnknownReliability>;
    const { assert!(size_of::<Hypothesis<15>>() == 24) };
    const { assert!(size_of::<Hypothesis<15, UnknownReliability>>() == 24) };
    const { assert!(size_of::<CellPosterior<20, 137>>() <= 4 << 10) };
    const { assert!(size_of::<CellPosterior<36, 529>>() <= 13 << 10) };
    const { assert!(size_of::<CellPosterior<68, 2081>>() <= 56 << 10) };
    const { assert!(size_of::<Unknown<36, 529>>() <= size_of::<CellPosterior<36, 529>>() + 8) };
}

/// Labels that are all but certain and contradict each other: as many of each kind leave one half.
#[test]
fn contradictions_cancel_however_certain_each_label_is() {
    let (given, seen, _) = labelled(3, 1, false);
    for p in [0.6, 0.999, 1.0 - 1e-16, 1e-9, 1e-300] {
        for n in [1, 20, 60] {
            let mut table = CellPosterior::<128, 2>::new(&given, Prior::Sequences, Noise::NONE)
                .expect("an oracle");
            for label in [Label::Positive, Label::Negative].into_iter().flat_map(|it| vec![it; n]) {
                let sample = Sample { label, ..seen[0].0 };
                table.take(sample, Reliability::new(p).expect("a probability")).expect("room");
            }
            let posterior = PosteriorView::new(&table);
            assert_eq!((table.iter().len(), posterior.pruned_mass()), (2, 0.0));
            for h in table.iter() {
                let probability = posterior.probability(h);
                assert!((probability - 0.5).abs() < 1e-6, "p = {p}, n = {n}: {probability}");
            }
        }
    }
}

/// The two ways to say that a reliability is unknown, and the two to say that it is known, agree bit for bit.
#[test]
fn a_choice_made_while_a_program_runs_changes_nothing() {
    fn told<R: Trust>(case: &Case, reliability: R) -> Vec<u64> {
        let noise = Noise { reliability, trusted_radius: 0, tolerance: Tolerance::NONE };
        let mut table = CellPosterior::<24, 100, 15, R>::new(&case.given, Prior::Area, noise)
            .expect("an oracle");
        for &(sample, p) in &case.seen {
            let reliability =
                if p.is_some() { Reliability::CERTAIN } else { reliability.nominal() };
            table.take(sample, reliability).expect("room, and a possible label");
        }
        let posterior = PosteriorView::new(&table);
        let weights = table.iter().map(|h| h.weight().value().to_bits());
        let p = posterior.reliability();
        let chance = table.chance(case.given[0].site);
        let rest = [p.mean, p.deviation, posterior.pruned_mass(), chance].map(f64::to_bits);
        weights.chain(rest).collect()
    }
    for number in 0..20 {
        let case = Case::new(3 * number + 2, 20);
        let known = Reliability::new(0.8).expect("a probability");
        let unknown = UnknownReliability::beta(8.0, 2.0).expect("a prior");
        let of = |any: AnyReliability| told(&case, any);
        assert_eq!(of(known.into()), told(&case, known));
        assert_eq!(of(unknown.into()), told(&case, unknown));
        assert_ne!(of(known.into()), of(unknown.into()));
    }
}

#[test]
fn the_bound_on_what_was_given_up_holds() {
    let worst = (0..cases(100, 1_000)).into_par_iter().map(|number| {
        let case = Case::new(number / 2 * 3 + number % 2 * 2, 24);
        let prior = PRIORS[number as usize / 2 % 2];
        let (mut small, mut full) =
            (case.start::<28, 24, 15>(prior), case.start::<28, 301, 15>(prior));
        let mut most = 0.0_f64;
        for (k, &(sample, p)) in case.seen.iter().enumerate() {
            full.take(sample, case.reliability(p)).expect("room");
            if small.take(sample, case.reliability(p)).is_err() {
                assert_eq!(p, Some(1.0), "certain, and none of those left have it");
                break;
            }
            assert!(small.iter().len() <= 24);
            for prior in PRIORS.into_iter().filter(|_| k > 5) {
                let (full, small) = (full.weighed_by(prior), small.weighed_by(prior));
                let cells = probabilities(&full);
                let lost = 1.0 - small.iter().map(|h| cells[&sequence(&small, h)]).sum::<f64>();
                let bound = PosteriorView::new(&small).pruned_mass();
                assert!(bound >= lost - 1e-6, "mission {number}: {bound} for {lost}");
                most = most.max(lost);
            }
        }
        most
    });
    assert!(worst.reduce(|| 0.0, f64::max) > 0.01, "nothing was pruned");
}

/// A certain label that leaves no hypothesis, and labels of reliabilities that the table does not keep apart.
#[test]
fn what_is_refused_changes_nothing() {
    let refuses = |table: &mut Table<16, 79>, sample, reliability, error| {
        let before = format!("{table:?}");
        assert_eq!(table.take(sample, reliability), Err(error));
        assert_eq!(format!("{table:?}"), before);
    };
    let number = |p| Reliability::new(p).expect("a probability");
    let case = Case::new(6, 10);
    let mut table = case.table::<16, 79>(Prior::Area);
    let wrong = Sample { label: -case.given[0].label, ..case.given[0] };
    refuses(&mut table, wrong, Reliability::CERTAIN, ObservationError::Contradiction(wrong));
    // The very same label with room for doubt is taken.
    table.take(wrong, number(0.9)).expect("possible");
    // Where positions err, it has the reliability of the noise or none.
    let noise = Noise::new(0.8).and_then(|it| it.with_tolerance(0.1)).expect("a noise");
    let mut blurred = Table::new(&case.given, Prior::Area, noise.into()).expect("given");
    refuses(&mut blurred, wrong, number(0.9), ObservationError::Reliability);
    assert_eq!(blurred.take(wrong, noise.reliability), Ok(()));
    // Where nobody knows it, counts cannot tell another from it, nor positions that err.
    let case = Case::new(5, 8);
    let mut unknown = case.table::<16, 79>(Prior::Area);
    for p in [0.9, 0.5, 0.0] {
        refuses(&mut unknown, wrong, number(p), ObservationError::Reliability);
    }
    let (before, tolerance) = (format!("{unknown:?}"), noise.tolerance);
    let within = unknown.read_within(wrong.site, wrong.label, tolerance);
    assert_eq!(within, Err(ObservationError::Tolerance(tolerance)));
    assert_eq!(format!("{unknown:?}"), before);
    let none = Table::<16, 79>::new(&case.given, Prior::Area, Noise { tolerance, ..case.noise });
    assert_eq!(none.err(), Some(GivenError::Reliability));
    for none in [1.1, -0.1, f64::NAN] {
        assert!(Reliability::new(none).is_err(), "{none}");
    }
}

#[test]
fn a_credible_set_is_the_smallest() {
    for number in 0..60 {
        let table = Case::new(number, 12).table::<16, 79>(Prior::Area);
        for prior in PRIORS {
            let table = table.weighed_by(prior);
            let posterior = PosteriorView::new(&table);
            let mut all: Vec<_> = table.iter().map(|h| posterior.probability(h)).collect();
            all.sort_by(|a, b| b.total_cmp(a));
            let best = posterior.best().expect("a hypothesis").probability;
            assert!((best - all[0]).abs() < 1e-12);
            for level in [0.0, 0.3, 0.9, 1.0] {
                let set = posterior.credible(level);
                let mut sum = 0.0;
                let is_short = |p: &&f64| {
                    let more = sum < level - 1e-12;
                    sum += **p;
                    more
                };
                let fewest = all.iter().take_while(is_short).count();
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
    (0..cases(9, 400)).into_par_iter().for_each(|number| {
        let (given, mut seen, _) = labelled(number, 32, false);
        for k in (2..32).step_by(3) {
            // A hair's breadth beside the one before, for slivers.
            let near = seen[k - 1].0.site;
            seen[k].0.site = Site::new(near.x() + 1, near.z() + k as i32 % 3).expect("near");
        }
        let away = 7_000 * 65_536 * (number as i32 % 3 - 1);
        let moved = |s: &Sample| Sample {
            site: Site::new(s.site.x() + away, s.site.z() - away).expect("on the lattice"),
            ..*s
        };
        let given: Vec<_> = given.iter().map(moved).collect();
        let seen: Vec<_> = seen.iter().map(|(s, p)| (moved(s), *p)).collect();
        let table = table::<36, 529>(&given, &seen);
        for h in table.iter().step_by(if is_long() { 1 } else { 9 }) {
            let support: Vec<_> = table.lines(h).support().collect();
            let exact = Separating::of(&support).expect("a cell").measure.value() / 65_536.0;
            let off = (table.log_area(h).exp() / exact - 1.0).abs();
            assert!(off < 1e-6, "mission {number}: {off}");
        }
    });
}

/// Cells with room for few edges hold more lines than they should, never fewer.
#[test]
fn a_cell_that_cannot_hold_its_edges_holds_more_lines_and_says_so() {
    let mut outer = 0;
    for number in 0..cases(60, 200) {
        let case = Case::new(3 * number, 16);
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
        let mut table = case.start::<20, 137, 4>(Prior::Area);
        let mut exact = case.start::<20, 137, 15>(Prior::Area);
        for &(sample, p) in &case.seen {
            let reliability = case.reliability(p);
            if table.take(sample, reliability).is_err() {
                break;
            }
            exact.take(sample, reliability).expect("room");
            // The true line is still among the lines of some hypothesis, unless that was given up.
            let held = table.iter().any(|h| case.world.is_among(table.lines(h)) == Some(true));
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
        outer += table.outer_cells();
    }
    assert!(outer > 30, "{outer}");
}

/// Labels that are right one time in two tell nothing. Cells that cannot hold all their edges overlap; then they come to
/// more than the whole.
#[test]
fn labels_never_tell_less_than_nothing() {
    fn least<const E: usize>() -> (f64, u16) {
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(1));
        let (given, ..) = labelled(3, 0, false);
        let reliability = Reliability::new(0.500_001).expect("a probability");
        let noise = Noise { reliability, ..Noise::NONE };
        let (mut least, mut outer) = (f64::INFINITY, 0);
        for _ in 0..cases(6, 20) {
            let table = CellPosterior::<68, 600, E>::new(&given, Prior::Area, noise);
            let mut table = table.expect("they are apart");
            for _ in 0..40 {
                let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
                let site = Point2::new(10.0 + 3.0 * cos, 8.0 + 3.0 * sin);
                let site = Site::try_from(site).expect("on the lattice");
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
