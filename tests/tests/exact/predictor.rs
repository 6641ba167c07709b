//! The predictions of look-ahead against slow twins: pictures against the exact shares of version spaces, noisy beliefs
//! against tables and entropies in double precision.

use std::f64::consts::PI;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::{DoubtfulBelief, Mission};
use host_sim::mission::given::Lines;
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::Point2;
use planner_core::belief::predictions::{Prediction as _, Predictor as _};
use planner_core::{
    Belief as _, Certainty, Label, Line, PosteriorView, PredictiveBelief as _, Reading,
    Reliability, Sample, Site,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;
use tests::known::spaces;

/// A site within reach whose label is uncertain, if one of some comes up: by the sides of a line that is left.
fn uncertain_site(space: &Lines, from: Site, rng: &mut ChaCha8Rng) -> Option<Site> {
    let bounds: Vec<_> = space.bounds().collect();
    (0..200).find_map(|_| {
        let [a, b] = [0, 1].map(|_| Line::from(bounds[rng.random_range(0..bounds.len())]));
        let t = rng.random_range(0.0..1.0);
        let [p, q] = [a.coefficients(), b.coefficients()];
        let [x, z, c] = [0, 1, 2].map(|k| p[k] + t * (q[k] - p[k]));
        let line = Line::from_coefficients(x, z, c)?;
        // Its point nearest to the agent, and up to 2 m along it.
        let here = Point2::<f64>::from(from);
        let off = line.distance(here);
        let along = rng.random_range(-2.0..2.0);
        let norm = x.hypot(z);
        let (nx, nz) = (x / norm, z / norm);
        let site = Point2::new(here.x - off * nx - along * nz, here.y - off * nz + along * nx);
        let site = Site::try_from(site).ok()?;
        (space.certainty(site) == Certainty::Uncertain).then_some(site)
    })
}

#[test]
fn pictures_are_those_of_the_version_space() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut asked, mut most) = (0, [0.0_f64; 2]);
    for steps in [1, 3, 6, 10, 15, 20, 25, 30] {
        for (number, space, from) in spaces(steps) {
            let picture = space.predictor(from);
            for _ in 0..4 {
                let Some(site) = uncertain_site(&space, from, &mut rng) else { continue };
                let (share, exact) = (picture.share_above(site), space.chance(site));
                let off = (f64::from(share) - exact).abs();
                assert!(off < 5e-6, "field {number}, {steps} steps: {share}, {exact}");
                most[0] = most[0].max(off);
                asked += 1;
                // Of a label that is next to certain not to come, hardly a digit is left.
                let labels = [Label::Positive, Label::Negative];
                for label in labels.into_iter().filter(|_| (0.02..0.98).contains(&exact)) {
                    let mut known = space.clone();
                    known.insert(Sample { site, label }).expect("uncertain ground");
                    let Some(next) = uncertain_site(&known, site, &mut rng) else { continue };
                    let share = picture.after(site, label).share_above(next);
                    let exact = known.chance(next);
                    let off = (f64::from(share) - exact).abs();
                    assert!(off < 2e-5, "field {number}, {steps} steps: {share}, {exact}");
                    most[1] = most[1].max(off);
                }
            }
        }
    }
    println!("{asked} places: {:.1e} off at most, {:.1e} after a label", most[0], most[1]);
    assert!(asked > 400);
}

#[test]
fn where_all_agree_shares_are_beyond() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for steps in [0, 4, 12, 24] {
        for (number, space, from) in spaces(steps) {
            let picture = space.predictor(from);
            for _ in 0..50 {
                let angle = rng.random_range(0.0..2.0 * PI);
                let radius = rng.random_range(0.0..3.0);
                let here = Point2::<f64>::from(from);
                let site =
                    Point2::new(here.x + radius * angle.cos(), here.y + radius * angle.sin());
                let Ok(site) = Site::try_from(site) else { continue };
                let share = picture.share_above(site);
                let agrees = match space.certainty(site) {
                    Certainty::Certain(Label::Positive) => share >= 1.0 - 1e-3,
                    Certainty::Certain(Label::Negative) => share <= 1e-3,
                    Certainty::Uncertain => (-1e-3..=1.0 + 1e-3).contains(&share),
                };
                assert!(agrees, "field {number}, {steps} steps: {share}");
            }
        }
    }
}

/// A standard field whose labels may be wrong outside half a metre from the given points.
fn doubtful(number: u64, p: f64) -> Mission {
    let mut mission = standard_field::standard(8, number, Algorithm::Lookahead, 1);
    mission.noise = Some(NoiseModel { p, extent: Extent::OutsideBalls(0.5) });
    mission
}

/// A site of the area, every fourth in the ball about a given point.
fn any_site(rng: &mut ChaCha8Rng, mission: &Mission) -> Site {
    let mut metres = || rng.random_range(0.0..standard_field::SIDE_M);
    let far = Point2::new(metres(), metres());
    let given = Point2::<f64>::from(mission.given.samples()[rng.random_range(0..4)].site);
    let near = given + (far - given) * 0.01;
    Site::try_from(if rng.random_range(0..4) == 0 { near } else { far }).expect("on the lattice")
}

/// So many labels, true or false, that are possible.
fn labelled(noisy: &mut DoubtfulBelief, mission: &Mission, rng: &mut ChaCha8Rng, labels: usize) {
    let most = noisy.belief().taken() + labels;
    while noisy.belief().taken() < most {
        let site = any_site(rng, mission);
        let label = if rng.random_bool(0.5) { Label::Positive } else { Label::Negative };
        let tolerance = noisy.belief().tolerance();
        // A trusted ball may refuse it.
        let _ = noisy.observe_within(site, Reading::Side(label), tolerance);
        noisy.observe_within(site, Reading::Boundary, tolerance).expect("it tells nothing");
    }
}

#[test]
fn noisy_beliefs_are_those_of_the_table_and_of_how_far_labels_can_be_believed() {
    let term = |p: f64| if p > 0.0 { -p * p.log2() } else { 0.0 };
    let coin = |p: f64| term(p) + term(1.0 - p);
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let (mut asked, mut trusted, mut sums, mut most) = (0, 0, [0.0; 2], [0.0_f64; 3]);
    for number in 0..cases(60, 600) {
        let p = [0.6, 0.7, 0.9, 0.99][number as usize % 4];
        let mission = doubtful(number, p);
        let mut noisy = mission.noisy_belief();
        labelled(&mut noisy, &mission, &mut rng, number as usize % 12);
        noisy.prepare();
        let predictor = noisy.predictor(mission.start.site);
        let mut table = mission.table();
        for &Sample { site, label } in &noisy.belief().samples()[table.given().len()..] {
            table
                .take(Sample { site, label }, table.reliability(site))
                .expect("as the noisy belief");
        }
        let posterior = PosteriorView::new(&table);
        for _ in 0..12 {
            let [site, next] = [(); 2].map(|()| any_site(&mut rng, &mission));
            assert_eq!(noisy.ground().certainty(site), mission.lines().certainty(site));
            let is_trusted = table.reliability(site) == Reliability::CERTAIN;
            let p_here = if is_trusted { 1.0 } else { p };
            let share = predictor.share_above(site);
            let chance = p_here * f64::from(share) + (1.0 - p_here) * (1.0 - f64::from(share));
            let told = (coin(chance) - coin(p_here)) / (1.0 - coin(p));
            let context = format!("field {number}, p {p}, trusted {is_trusted}, share {share}");
            assert!((f64::from(predictor.chance(site, share)) - chance).abs() < 1e-6, "{context}");
            let (off, exact) = (f64::from(share), posterior.share_above(site));
            sums[0] += (off - exact).abs();
            most[0] = most[0].max((off - exact).abs());
            // A label that is next to impossible tells nothing, for want of digits.
            let label = if chance > 0.5 { Label::Positive } else { Label::Negative };
            let after = predictor.after(site, label);
            for got in [predictor.information(site, share), after.information(site, share)] {
                let off = (f64::from(got) - told).abs();
                // Two entropies to 10^-3 bits, near one half to as much of what they lack of a bit.
                let bound = if p_here < 0.75 { 0.01 } else { 2e-3 / (1.0 - coin(p)) };
                assert!(off < bound, "{context}: {got} for {told}");
                most[1] = most[1].max(off);
            }
            let mut known = table.clone();
            if known.take(Sample { site, label }, table.reliability(site)).is_ok() {
                let exact = PosteriorView::new(&known).share_above(next);
                let off = (f64::from(after.share_above(next)) - exact).abs();
                sums[1] += off;
                most[2] = most[2].max(off);
            }
            (asked, trusted) = (asked + 1, trusted + u32::from(is_trusted));
        }
    }
    let mean = sums.map(|sum| sum / f64::from(asked));
    println!("{asked} places, {trusted} trusted: shares {mean:.4?} off, {most:.4?} at most");
    assert!(mean[0] < 0.003 && mean[1] < 0.003 && most[0] < 0.1 && most[2] < 0.13, "{mean:?}");
    assert!(trusted > 100);
}

#[test]
fn a_noisy_belief_begins_again_in_place() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let mut again = doubtful(0, 0.7).noisy_belief();
    for number in 0..20 {
        let mission = doubtful(number, 0.8);
        labelled(&mut again, &mission, &mut rng, 5);
        let given = mission.given.samples();
        again.restart(given, mission.prior, mission.noise_told()).expect("an oracle");
        again.restart(&given[..2], mission.prior, mission.noise_told()).expect_err("two points");
        let mut anew = mission.noisy_belief();
        let mut same = rng.clone();
        labelled(&mut again, &mission, &mut rng, 3);
        labelled(&mut anew, &mission, &mut same, 3);
        again.prepare();
        anew.prepare();
        let [again, anew] = [&again, &anew].map(|it| it.predictor(mission.start.site));
        for _ in 0..20 {
            let site = any_site(&mut rng, &mission);
            let bits = [again.share_above(site), anew.share_above(site)].map(f32::to_bits);
            assert_eq!(bits[0], bits[1], "field {number}");
        }
    }
}
