//! The promises of look-ahead's goals, against slow twins. The twins clip ground in double precision and compute slopes
//! by arc tangents. For doubtful labels they use the hypotheses that have the level's probability.

use std::f64::consts::PI;

use host_sim::campaign::standard_field;
use host_sim::mission::given::Lines;
use host_sim::world::polygon::Polygon;
use nalgebra::Point2;
use planner_core::parts::Bound;
use planner_core::{
    Accuracy, Angle, Area, Belief as _, CellPosterior, Criterion as _, Goal, Heading, Label, Line,
    PosteriorView, Prior, Sample, ShareWithin, Site, SlopeWithin,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::known::{labelled, spaces, table};
use tests::{cases, wide};

/// The share of the area on which lines that are left disagree: what is left when the ground above all and the
/// ground below all are clipped off.
fn disagreed(space: &Lines, area: Area) -> f64 {
    let all = Polygon::from(area).area();
    let certain = [1.0, -1.0].map(|side| {
        let clip = |ground: Polygon, bound| ground.clip(&Line::from(bound), side);
        space.bounds().fold(Polygon::from(area), clip).area()
    });
    1.0 - (certain[0] + certain[1]) / all
}

/// Lines between two that run along each other, thick or thin, through an area, along its border or beside it; the
/// promise may be too large by what the strip's ends are cut off by, and not too small by a millionth.
#[test]
fn the_share_of_a_strip_is_not_promised_too_small() {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(15));
    let at = |x: f64, z: f64| Site::try_from(Point2::new(x, z)).expect("on the lattice");
    let (mut inside, mut all, mut none) = (0, 0, 0);
    for number in 0..cases(1_500, 30_000) {
        let [x, z] = [(); 2].map(|()| rng.random_range(4.0..20.0));
        let area = Area::new(at(-x, -z), at(x, z)).expect("it has an inside");
        // Every other is in line with a side, so that nothing is cut off.
        let is_upright = number % 2 == 0;
        let quarters = f64::from(rng.random_range(0..4));
        let angle = PI / 2.0 * if is_upright { quarters } else { rng.random_range(0.0..4.0) };
        let (sin, cos) = angle.sin_cos();
        let (middle, half) =
            (rng.random_range(-30.0..30.0), 10_f64.powf(rng.random_range(-3.0..1.5)));
        let run = if is_upright { 5_000.0 } else { rng.random_range(10.0..300.0) };
        let samples =
            [(-run, -half), (-run, half), (run, half), (run, -half)].map(|(run, side)| {
                let (off, label) = (middle + side, side > 0.0);
                let label = if label { Label::Positive } else { Label::Negative };
                Sample { site: at(run * cos - off * sin, run * sin + off * cos), label }
            });
        let space = Lines::new(&samples).expect("lines are left");
        let share = disagreed(&space, area);
        let is_met = |millionths: f64| ShareWithin(millionths as u32).is_met(&space.bounds(), area);
        let is_narrow = space.slope_arc().width_deg() < 44.0;
        let context = format!("strip {number} of {half} m: {share} of the area");
        if share > 1e-6 {
            assert!(!is_met((share * 1e6).ceil() - 1.0), "{context}");
            let most = if is_upright { 1.001 * share } else { 2.0 * share } + half * 1e-3 + 1e-5;
            let is_through = is_upright && is_narrow && middle.abs() + half < x.min(z);
            assert!(!is_through || is_met(most * 1e6), "{context}");
            all += u32::from(share > 0.999_999);
            inside += u32::from(is_through);
        } else if share < 1e-12 && is_narrow {
            assert!(is_met(1.0), "{context}");
            none += 1;
        }
    }
    assert!(inside > 150 && all > 5 && none > 150, "{inside}, {all}, {none}");
}

/// Of two directions, from some ten millionths of a degree to 80 degrees: never a heading's unit too little, and a
/// ten-thousandth too much.
#[test]
fn slopes_are_promised_to_the_last_digit() {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(16));
    let (through, area) = (Site::ORIGIN, standard_field::area());
    let site = |x: i32, z: i32| Site::new(x, z).expect("on the lattice");
    for number in 0..cases(5_000, 200_000) {
        let length = rng.random_range(1 << 27..1 << 28);
        let rise = 10_f64.powf(rng.random_range(1.5..9.0)) as i32;
        let (x, z) =
            if rise > length { (length / (rise / length), length) } else { (length, rise) };
        let along = [site(length, 0), site(x, z)].map(|to| to - Site::ORIGIN);
        let bounds = along.map(|along| Bound { through, along });
        let width = f64::from(z).atan2(f64::from(x));
        let units = width * 4_294_967_296.0 / (2.0 * PI);
        let is_met =
            |units: f64| SlopeWithin(Angle(units as u32)).is_met(&bounds.iter().copied(), area);
        for less in 1..4 {
            let units = units.ceil() - f64::from(less);
            assert!(units < 1.0 || !is_met(units), "case {number}: {width} rad");
        }
        assert!(is_met(1.000_11 * units + 30.0), "case {number}: {width} rad");
    }
}

#[test]
fn shares_are_met_when_they_are_and_not_before() {
    let mut met = 0;
    for steps in [2, 5, 8, 12, 16, 20] {
        for (number, space, _) in spaces(steps) {
            let area = standard_field::area();
            let share = disagreed(&space, area);
            for factor in [0.5, 0.9, 0.999, 1.01, 1.1, 1.5] {
                let millionths = (share * factor * 1e6).floor();
                let is_met = ShareWithin(millionths as u32).is_met(&space.bounds(), area);
                // Below some ten millionths the twin itself has lost its digits; what much ground is cut off by at
                // the border may be half of it again.
                let is_narrow = space.slope_arc().width_deg() < 40.0 && share < 0.1;
                assert!(!is_met || factor > 0.99 || millionths < 20.0, "field {number}: {share}");
                let is_sharp = is_narrow && millionths > 20.0;
                assert!(is_met || factor < 1.4 || !is_sharp, "field {number}: {share}, {factor}");
                met += u32::from(is_met);
            }
        }
    }
    assert!(met > 50, "{met}");
}

/// The narrowest slope arc that a table promises with a level in millionths, radians; `None` if it promises none
/// below a quarter turn.
fn promised<const N: usize, const H: usize>(
    table: &CellPosterior<N, H>,
    level: u32,
) -> Option<f64> {
    let is_met = |units: &u32| {
        let accuracy = Accuracy::SlopeArc(Angle(*units));
        table.meets(Goal { accuracy, level }, standard_field::area())
    };
    let (mut no, mut yes) = (0, (1 << 30) - 1);
    if !is_met(&yes) {
        return None;
    }
    while yes - no > 1 {
        let middle = no + (yes - no) / 2;
        *(if is_met(&middle) { &mut yes } else { &mut no }) = middle;
    }
    Some(Heading(yes).radians())
}

/// The arc that spans the slopes of all hypotheses of a logarithmic weight at least, radians.
fn spanned<const N: usize, const H: usize>(table: &CellPosterior<N, H>, least: f64) -> f64 {
    let within = table.iter().filter(|h| h.weight().value() >= least);
    let along: Vec<_> = within.flat_map(|h| table.lines(h).bounds()).map(|it| it.along).collect();
    let angles = along.iter().map(|v| {
        let ([a, b], [c, d]) = (wide(along[0]), wide(*v));
        ((a * d - b * c) as f64).atan2((a * c + b * d) as f64)
    });
    let (least, most) = angles.fold((0.0_f64, 0.0_f64), |(a, b), it| (a.min(it), b.max(it)));
    most - least
}

/// A goal is asked of the heaviest hypotheses that hold its level: of all that the smallest such set has, and of none
/// that is lighter than its lightest by more than a band of weights. What was given up is in no set.
#[test]
fn a_goal_is_met_by_the_heaviest_that_hold_its_level() {
    /// Of a table; how many sharp promises there were, and levels that nothing holds.
    fn check<const H: usize>(number: u64, table: &CellPosterior<20, H>) -> [u32; 2] {
        let mut counts = [0; 2];
        let mut weights: Vec<_> = table.iter().map(|h| h.weight().value()).collect();
        weights.sort_by(|a, b| b.total_cmp(a));
        let held: f64 = weights.iter().map(|log| log.exp()).sum();
        let all = held / (1.0 - PosteriorView::new(table).pruned_mass());
        // The lightest of the fewest, by falling weight, that hold a share of all there was.
        let lightest = |share: f64| {
            let mut sum = 0.0;
            weights.iter().find(|log| {
                sum += log.exp();
                sum >= share * all
            })
        };
        for level in [0, 300_000, 500_000, 800_000, 900_000, 990_000, 999_000, 999_900] {
            let share = f64::from(level) * 1e-6;
            let got = promised(table, level);
            let case = format!("mission {number}, {H} slots, level {level}: {got:?}");
            // Sums are single precision, and rounded up.
            let [few, many] = [share - 1e-6, share + 1.2e-5].map(lightest);
            let (Some(few), Some(got)) = (few, got) else {
                let is_right = got.is_none() && (many.is_none() || spanned(table, -1e9) > 1.5);
                assert!(is_right, "{case}");
                counts[1] += u32::from(few.is_none());
                continue;
            };
            let least = spanned(table, *few);
            let most = many.map_or(f64::INFINITY, |many| spanned(table, many - 0.5));
            let slack = 1e-8 + 2e-4 * most;
            assert!(least - 1e-8 <= got && got <= most + slack, "{case}, {least} to {most}");
            counts[0] += u32::from(most - least <= slack && most < spanned(table, -1e9) - slack);
        }
        counts
    }
    let sum = |a: [u32; 2], b: [u32; 2]| [a[0] + b[0], a[1] + b[1]];
    let [sharp, none] = (0..cases(40, 1_000))
        .into_par_iter()
        .map(|number| {
            let (given, seen, _) = labelled(number, 16, number % 2 == 0);
            let full = table::<20, 137>(&given, &seen);
            let small = table::<20, 24>(&given, &seen);
            let both = [Prior::Area, Prior::Sequences].map(|prior| {
                let (full, small) = (full.weighed_by(prior), small.weighed_by(prior));
                sum(check(number, &full), check(number, &small))
            });
            sum(both[0], both[1])
        })
        .reduce(|| [0; 2], sum);
    assert!(sharp > 200 && none > 40, "{sharp}, {none}");
}
