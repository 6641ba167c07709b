//! The estimates against brute force, and against what must not change them.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::CAPACITY;
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::{Point2, Rotation2, Vector2};
use planner_core::estimate::{area, bisector, centre, maximum_margin};
use planner_core::lattice::orient;
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
    let of = |label| {
        let of = samples.iter().filter(move |s| s.label == label);
        of.map(|s| Point2::<f64>::from(s.site)).map(|it| [it.x, it.y]).collect::<Vec<_>>()
    };
    let (positive, negative) = (of(Label::Positive), of(Label::Negative));
    let best_at = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let along = |[x, z]: &[f64; 2]| z * cos - x * sin;
        let low = positive.iter().map(along).fold(f64::INFINITY, f64::min);
        let high = negative.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        (low - high) / 2.0
    };
    // The margin is a unimodal function of the angle where it is positive: refine about the best.
    let (mut best, mut width) = (0.0, std::f64::consts::PI);
    for _ in 0..25 {
        let angles = (-200..=200).map(|i| best + width * f64::from(i) / 200.0);
        best = angles.max_by(|a, b| best_at(*a).total_cmp(&best_at(*b))).expect("some");
        width /= 4.0;
    }
    best_at(best)
}

/// Near the origin, and turned and moved by kilometres. All samples count, though only those that still matter were
/// looked at. The centre agrees with every sample.
#[test]
fn the_maximum_margin_is_the_largest() {
    for steps in [0, 3, 10, 20, 40] {
        for (number, space) in spaces(cases(10, 150), steps) {
            let turn = Rotation2::new(0.1 * number as f64);
            let away = if number % 2 == 0 { Vector2::zeros() } else { Vector2::new(7e3, -6.5e3) };
            let moved = |s: &Sample| {
                let site = Site::try_from(turn * Point2::<f64>::from(s.site) + away);
                Sample { site: site.expect("on the lattice"), label: s.label }
            };
            let moved: Vec<_> = space.samples().iter().map(moved).collect();
            let space = VersionSpace::<CAPACITY>::new(&moved).expect("separable as before");
            let context = format!("field {number}, {steps} steps");
            let line = Line::from(maximum_margin(space.lines()).expect("separable"));
            let (got, best) = (margin(&line, &moved), swept_margin(&moved));
            let rounding = if number % 2 == 0 { 1e-9 } else { 1e-7 };
            assert!((got - best).abs() < 3e-7 * best + rounding, "{context}: {got} for {best}");
            let centre = Line::from(centre(space.lines()).expect("a line"));
            assert!(margin(&centre, &moved) > 0.0, "{context}");
        }
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

fn error_of_space<const N: usize>(space: &VersionSpace<N>) -> Option<[f64; 3]> {
    let centre = centre(space.lines()).expect("a line");
    error_of(space.samples(), centre, area(space.lines()))
}

#[test]
fn the_centre_is_the_exact_mean_to_single_precision_of_the_cell() {
    for steps in [0, 10, 40, 60] {
        spaces(cases(15, 1_000), steps).par_iter().for_each(|(number, space)| {
            let errors = error_of_space(space).unwrap_or_default();
            assert!(errors.iter().all(|it| *it < 2e-6), "{number}, {steps} steps: {errors:?}");
        });
    }
}

/// Sites to trip over, anywhere on the lattice, nearly on one line or one unit apart.
#[test]
fn the_centre_is_as_good_for_adversarial_samples() {
    let errors = (0..cases(700, 100_000)).into_par_iter().filter_map(|seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(seed));
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
    let count = errors.count();
    assert!(count > 200, "{count}");
}

/// The mean over hypotheses against the sum of their exact means by their probabilities.
#[test]
fn the_posterior_mean_is_that_of_the_hypotheses_exact_means() {
    (0..cases(6, 200)).into_par_iter().for_each(|number| {
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

/// The paper's bisector of the two shortest pairs that share no point: it halves the angle in which their diagonals cross.
/// There is none where these are parallel, nor of one pair alone.
#[test]
fn the_bisector_is_that_of_the_two_shortest_pairs() {
    let (mut none, mut swapped) = (0, 0);
    for (number, space) in spaces(200, 12) {
        let samples = space.samples();
        let of = |label: Label| samples.iter().filter(move |s| s.label == label);
        let opposite = of(Label::Negative).flat_map(|n| of(Label::Positive).map(move |p| [*n, *p]));
        let mut pairs: Vec<[Sample; 2]> = opposite.collect();
        pairs.sort_by_key(|[n, p]| (p.site - n.site).dot(p.site - n.site));
        let apart = |pair: &&[Sample; 2]| !pairs[0].iter().any(|s| pair.contains(s));
        let second = pairs.iter().find(apart).expect("the oracle's points are four");
        let [n1, p1, n2, p2] =
            [pairs[0][0], pairs[0][1], second[0], second[1]].map(|it| Point2::<f64>::from(it.site));
        let (d, e) = (p2 - n1, n2 - p1);
        let crossed = d.perp(&e);
        let (on_d, on_e) = ((p1 - n1).perp(&e) / crossed, (p1 - n1).perp(&d) / crossed);
        let line = bisector(samples).map(Line::from);
        if crossed == 0.0 || on_d == 0.0 || on_e == 0.0 {
            assert!(line.is_none(), "field {number}");
            none += 1;
            continue;
        }
        // Each diagonal towards the crossing.
        let [d, e] = [d * on_d.signum(), e * on_e.signum()].map(|it| it.normalize());
        let crossing = n1 + (p2 - n1) * on_d;
        let line = line.expect("they cross");
        for place in [crossing, crossing + (d + e).normalize()] {
            let most = 2e-6 * (1.0 + (crossing - n1).norm());
            assert!(line.distance(place).abs() < most, "field {number}: {line:?}");
        }
        assert!(line.distance(p1) * line.distance(n1) < 0.0, "field {number}: {line:?}");
        let rise = line.distance(p1) - line.distance(n1) + line.distance(p2) - line.distance(n2);
        assert!(rise > -1e-5, "field {number}: {line:?}");
        let above = |s: &Sample| line.distance(Point2::from(s.site)) > 0.0;
        let agree = samples.iter().filter(|s| above(s) == (s.label == Label::Positive)).count();
        swapped += usize::from(2 * agree < samples.len());
    }
    assert!(none < 20 && swapped < 4, "{none} {swapped}");
    let alone = [(1.0, 1.0, false), (1.0, 3.0, true), (9.0, 3.0, true)].map(|(x, z, above)| {
        let label = if above { Label::Positive } else { Label::Negative };
        Sample::at([x, z], label).expect("near")
    });
    assert!(bisector(&alone).is_none());
}

/// The chance of a label against the measures of what either label would leave. The evidence takes it in in single
/// precision.
#[test]
fn chances_are_shares_of_what_is_left() {
    let mut split = 0;
    for (number, space) in spaces(60, 6) {
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
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
            let context = format!("field {number}, {site:?}: {chance} for {share}");
            assert!((chance - share).abs() < 1e-6, "{context}");
            for (label, share) in [(Label::Positive, share), (Label::Negative, 1.0 - share)] {
                let single = f64::from(space.chance_of(site, label));
                assert!((single - share).abs() < 5e-6, "{context}: {single}");
            }
            split += u32::from(share > 0.0 && share < 1.0);
        }
    }
    assert!(split > 200, "{split}");
}
