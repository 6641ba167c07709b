//! The estimates against brute force, and against what must not change them.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::CAPACITY;
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::{Point2, Rotation2, Vector2};
use planner_core::belief::estimate::{area, bisector, centre, maximum_margin};
use planner_core::geometry::lattice::orient;
use planner_core::{Belief, Label, Line, LocalLine, PosteriorView, Sample, Site, VersionSpace};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::twins::exact_mean::{ExactLine, Separating};
use tests::{adversarial, cases};

/// The version spaces of the first fields after some steps each.
fn spaces(fields: u64, steps: u32) -> Vec<(u64, VersionSpace<CAPACITY>)> {
    (0..fields)
        .map(|number| {
            let mission = standard_field::standard(4, number, Algorithm::Cfc, steps);
            let flown = mission.fly(|_, _| {}).expect("labels are true");
            (number, flown.belief.version_space().expect("labels are true").clone())
        })
        .collect()
}

/// The least signed distance of the samples to the side that their labels say.
fn margin(line: &Line, samples: &[Sample]) -> f64 {
    let distance = |s: &Sample| f64::from(s.label.sign()) * line.distance(Point2::from(s.site));
    samples.iter().map(distance).fold(f64::INFINITY, f64::min)
}

/// The best line of a fine sweep of angles: the slow twin of the hard margin.
fn swept_margin(samples: &[Sample]) -> f64 {
    let best_at = |angle: f64| {
        let normal = Vector2::new(-angle.sin(), angle.cos());
        let along = |s: &Sample| normal.dot(&Point2::<f64>::from(s.site).coords);
        let of = |label| samples.iter().filter(move |s| s.label == label);
        let low = of(Label::Positive).map(along).fold(f64::INFINITY, f64::min);
        let high = of(Label::Negative).map(along).fold(f64::NEG_INFINITY, f64::max);
        (low - high) / 2.0
    };
    // The margin is a unimodal function of the angle where it is positive: refine about the best.
    let (mut best, mut width) = (0.0, std::f64::consts::PI);
    for _ in 0..40 {
        let angles = (-200..=200).map(|i| best + width * f64::from(i) / 200.0);
        best = angles.max_by(|a, b| best_at(*a).total_cmp(&best_at(*b))).expect("some");
        width /= 4.0;
    }
    best_at(best)
}

#[test]
fn the_maximum_margin_is_the_largest() {
    for steps in [0, 3, 10, 20] {
        for (number, space) in spaces(150, steps) {
            let line = Line::from(maximum_margin(space.lines()).expect("separable"));
            // All samples count, though only those that still matter were looked at.
            let (got, best) = (margin(&line, space.samples()), swept_margin(space.samples()));
            assert!(
                (got - best).abs() < 3e-7 * best + 1e-9,
                "field {number}, {steps} steps: {got} for {best}"
            );
        }
    }
}

#[test]
fn the_centre_and_the_area_are_those_of_lines_drawn_at_random() {
    for (number, space) in spaces(6, 2) {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let (half, radius) = (standard_field::SIDE_M / 2.0, 20.0);
        let middle = Point2::new(half, half);
        let (draws, mut hits, mut mean) = (2_000_000, 0_u32, Vector2::zeros());
        let mut offset = 0.0;
        for _ in 0..draws {
            let angle: f64 = rng.random_range(0.0..std::f64::consts::TAU);
            let normal = Vector2::new(angle.cos(), angle.sin());
            let r = rng.random_range(-radius..radius);
            let agrees = |s: &Sample| {
                let distance = normal.dot(&(Point2::<f64>::from(s.site) - middle)) - r;
                (distance > 0.0) == (s.label == Label::Positive)
            };
            if space.support().all(|s| agrees(&s)) {
                (hits, mean, offset) = (hits + 1, mean + normal, offset + r);
            }
        }
        let share = f64::from(hits) / f64::from(draws);
        let drawn = share * std::f64::consts::TAU * 2.0 * radius;
        let noise = 5.0 / f64::from(hits).sqrt();
        assert!(
            (f64::from(area(space.lines())) / drawn - 1.0).abs() < noise,
            "field {number}: {} for {drawn}",
            area(space.lines())
        );
        let norm = mean.norm();
        let mean = Line::through(middle + mean / norm * (offset / norm), mean).expect("a line");
        let centre = Line::from(centre(space.lines()).expect("a line"));
        assert!(centre.angle_to_deg(&mean) < 0.3, "field {number}");
        assert!((centre.distance(middle) - mean.distance(middle)).abs() < 0.05, "field {number}");
    }
}

/// How far an estimate of the centre and the measure is off, as shares of the cell: by its angle, by where it
/// passes any of the samples, and by the measure.
fn error_of(samples: &[Sample], centre: LocalLine, area: f32) -> Option<[f64; 3]> {
    let exact = Separating::of(samples)?;
    let found = ExactLine::of(centre);
    let off = |s: &Sample| {
        let off = &found.distance(s.site) - &exact.mean.distance(s.site);
        off.value().abs() / exact.farthest(s.site)
    };
    let turn = found.turn_to(&exact.mean).abs() / exact.width();
    let measure = f64::from(area) * 65_536.0 / exact.measure.value() - 1.0;
    Some([turn, samples.iter().map(off).fold(0.0, f64::max), measure.abs()])
}

fn largest(errors: impl ParallelIterator<Item = [f64; 3]>) -> [f64; 3] {
    errors.reduce(|| [0.0; 3], |a, b| [0, 1, 2].map(|i| a[i].max(b[i])))
}

fn error_of_space<const N: usize>(space: &VersionSpace<N>) -> Option<[f64; 3]> {
    let centre = centre(space.lines()).expect("a line");
    error_of(space.samples(), centre, area(space.lines()))
}

#[test]
fn the_centre_is_the_exact_mean_to_single_precision_of_the_cell() {
    for steps in [0, 10, 40, 60] {
        let spaces = spaces(cases(60, 1_000), steps);
        let errors = largest(spaces.par_iter().filter_map(|(_, space)| error_of_space(space)));
        println!("{steps} steps: angle, place, measure off by {errors:?} of the cell");
        assert!(errors.iter().all(|error| *error < 2e-6), "{steps} steps: {errors:?}");
    }
}

/// Sites to trip over, anywhere on the lattice, nearly on one line or one unit apart.
#[test]
fn the_centre_is_as_good_for_adversarial_samples() {
    let errors = (0..cases(4_000, 100_000)).into_par_iter().filter_map(|seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut sites: Vec<Site> = Vec::new();
        while sites.len() < 3 + seed as usize % 12 {
            sites.push(adversarial(&mut rng, &sites[sites.len().saturating_sub(4)..]));
        }
        let [a, b] = [0; 2].map(|_| sites[rng.random_range(0..sites.len())]);
        let label = |site| if orient(a, b, site) > 0 { Label::Positive } else { Label::Negative };
        let samples: Vec<_> =
            sites.iter().map(|&site| Sample { site, label: label(site) }).collect();
        let errors = error_of_space(&VersionSpace::<16>::new(&samples).ok()?)?;
        assert!(errors.iter().all(|error| *error < 2e-6), "seed {seed}: {errors:?}, {samples:?}");
        Some(errors)
    });
    println!("angle, place, measure off by {:?} of the cell", largest(errors));
}

/// The mean over hypotheses against the sum of their exact means by their probabilities.
#[test]
fn the_posterior_mean_is_that_of_the_hypotheses_exact_means() {
    (0..cases(12, 200)).into_par_iter().for_each(|number| {
        let mut mission = standard_field::standard(6, number, Algorithm::Scc, 12);
        mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
        let flown = mission.fly(|_, _| {}).expect("no trusted label");
        let table = flown.belief.hypotheses().expect("labels may err");
        let posterior = PosteriorView::new(table);
        let about = table.samples()[0].site;
        let (mut normal, mut offset) = (Vector2::zeros(), 0.0);
        for h in table.iter() {
            let support: Vec<_> = table.lines(h).support().collect();
            let exact = Separating::of(&support).expect("a cell");
            let weight = posterior.probability(h) * exact.concord.value();
            normal += Vector2::from(exact.mean.normal()) * weight;
            offset -= exact.mean.distance(about).value() / 65_536.0 * weight;
        }
        let foot = Point2::from(about) + normal * (offset / normal.norm_squared());
        let exact = Line::through(foot, normal).expect("a line");
        let mean = Line::from(posterior.mean().expect("a line"));
        assert!(mean.angle_to_deg(&exact) < 1e-4, "field {number}");
        let off = mean.distance(Point2::from(about)) - exact.distance(Point2::from(about));
        assert!(off.abs() < 1e-5, "field {number}: off by {off} m");
    });
}

#[test]
fn the_centre_agrees_with_every_sample() {
    for steps in [0, 10, 40] {
        for (number, space) in spaces(200, steps) {
            let centre = Line::from(centre(space.lines()).expect("a line"));
            assert!(margin(&centre, space.samples()) > 0.0, "field {number}, {steps} steps");
        }
    }
}

#[test]
fn no_motion_of_the_plane_changes_the_centre_or_the_maximum_margin() {
    for (number, space) in spaces(100, 8) {
        let before = space.estimates();
        let turn = Rotation2::new(0.1 * number as f64);
        let away = Vector2::new(7_000.0, -6_500.0);
        let moved = |s: &Sample| {
            let site = Site::try_from(turn * Point2::<f64>::from(s.site) + away);
            Sample { site: site.expect("on the lattice"), label: s.label }
        };
        let moved: Vec<_> = space.samples().iter().map(moved).collect();
        let moved = VersionSpace::<CAPACITY>::new(&moved).expect("separable as before");
        let after = moved.estimates();
        // Rounding to the lattice moves samples by some micrometres.
        assert!((area(moved.lines()) / area(space.lines()) - 1.0).abs() < 1e-3, "field {number}");
        for (name, before, after) in [
            ("centre", before.centre, after.centre),
            ("maximum margin", before.maximum_margin, after.maximum_margin),
        ] {
            let [before, after] = [before, after].map(|it| Line::from(it.expect("a line")));
            let at = Point2::new(10.0, 10.0);
            let off = (before.distance(at) - after.distance(turn * at + away)).abs();
            assert!(off < 0.02, "field {number}: {name} is off by {off} m");
        }
    }
}

#[test]
fn the_bisector_is_the_paper_s() {
    let sample = |(x, z, y): (f64, f64, i8)| Sample {
        site: Site::try_from(Point2::new(x, z)).expect("near"),
        label: if y > 0 { Label::Positive } else { Label::Negative },
    };
    // A symmetric quadrilateral about z = 2: the diagonals cross on it.
    let square = [(1.0, 1.0, -1), (1.0, 3.0, 1), (9.0, 3.0, 1), (9.0, 1.0, -1), (5.0, 9.0, 1)];
    let line = Line::from(bisector(&square.map(sample)).expect("a line"));
    assert!(line.slope().expect("level").abs() < 1e-7);
    assert!((line.intercept().expect("level") - 2.0).abs() < 1e-6);
    assert!(line.distance(Point2::new(0.0, 5.0)) > 0.0, "+1 is above");
    // One pair alone has no bisector, nor have diagonals that do not cross.
    assert!(bisector(&[(1.0, 1.0, -1), (1.0, 3.0, 1), (9.0, 3.0, 1)].map(sample)).is_none());
    let parallel = [(0.0, 0.0, -1), (0.0, 1.0, 1), (5.0, 6.0, -1), (5.0, 5.0, 1)];
    assert!(bisector(&parallel.map(sample)).is_none());
}

#[test]
fn the_bisector_is_that_of_the_two_shortest_pairs() {
    for (number, space) in spaces(200, 12) {
        let samples = space.samples();
        let of = |label: Label| samples.iter().filter(move |s| s.label == label);
        let opposite = of(Label::Negative).flat_map(|n| of(Label::Positive).map(move |p| [*n, *p]));
        let mut pairs: Vec<[Sample; 2]> = opposite.collect();
        pairs.sort_by_key(|[n, p]| (p.site - n.site).dot(p.site - n.site));
        let apart = |pair: &&[Sample; 2]| !pairs[0].iter().any(|s| pair.contains(s));
        let second = pairs.iter().find(apart).expect("the oracle's points are four");
        let alone = bisector(&[pairs[0], *second].concat());
        assert_eq!(bisector(samples), alone, "field {number}");
    }
}

/// The chances that the evidence takes in, where positions are exact.
fn single_precision_agrees(belief: &impl Belief, site: Site, above: f64) {
    let chances = [(Label::Positive, above), (Label::Negative, 1.0 - above)];
    for (label, chance) in chances {
        let single = f64::from(belief.chance_of(site, label));
        assert!((single - chance).abs() < 5e-6, "{site:?}, {label:?}: {single} for {chance}");
    }
}

/// The chance of a label against the measures of what either label would leave.
#[test]
fn chances_are_shares_of_what_is_left() {
    let mut split = 0;
    for (number, space) in spaces(60, 6) {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        for _ in 0..20 {
            let mut metres = || rng.random_range(0.0..standard_field::SIDE_M);
            let site = Site::try_from(Point2::new(metres(), metres())).expect("near");
            let left = |label| -> f64 {
                let mut space = space.clone();
                space.insert(Sample { site, label }).map_or(0.0, |_| area(space.lines()).into())
            };
            let (above, below) = (left(Label::Positive), left(Label::Negative));
            let share = above / (above + below);
            let chance = space.chance(site);
            assert!(
                (chance - share).abs() < 1e-6,
                "field {number}, {site:?}: {chance} for {share}"
            );
            single_precision_agrees(&space, site, share);
            split += u32::from(share > 0.0 && share < 1.0);
        }
    }
    assert!(split > 200, "{split}");
}

/// The same of labels that may err: each hypothesis adds its share, and the sensor its errors.
#[test]
fn chances_of_labels_that_may_err_are_those_of_the_next_posterior() {
    for number in 0..20 {
        let mut mission = standard_field::standard(5, number, Algorithm::Scc, 8);
        let (p, extent) = (0.8, Extent::OutsideBalls(0.0));
        mission.noise = Some(NoiseModel { p, extent });
        let flown = mission.fly(|_, _| {}).expect("no trusted label");
        let table = flown.belief.hypotheses().expect("labels may err");
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        for _ in 0..10 {
            let mut metres = || rng.random_range(0.0..standard_field::SIDE_M);
            let site = Site::try_from(Point2::new(metres(), metres())).expect("near");
            let chance = table.chance(site);
            // By Bayes's rule: what a certain label of either kind would leave of each hypothesis.
            let posterior = PosteriorView::new(table);
            let above: f64 = table
                .iter()
                .map(|h| {
                    let lines = table.lines(h);
                    let support: Vec<_> = lines.support().collect();
                    let whole = VersionSpace::<CAPACITY>::new(&support).expect("a cell");
                    posterior.probability(h) * whole.chance(site)
                })
                .sum();
            let expected = above * p + (1.0 - above) * (1.0 - p);
            assert!((chance - expected).abs() < 1e-6, "field {number}: {chance} for {expected}");
            single_precision_agrees(table, site, expected);
            assert!((0.2 - 1e-6..=0.8 + 1e-6).contains(&chance));
        }
    }
}
