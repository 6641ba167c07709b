//! What look-ahead predicts by, and what it promises, against slow twins: pictures against the exact shares of
//! version spaces, forecasts against tables and entropies in double precision, goals against areas clipped in that.

use std::f64::consts::PI;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::{Lines, Mission};
use host_sim::world::noise::{Extent, NoiseModel};
use host_sim::world::polygon::Polygon;
use nalgebra::Point2;
use planner_core::belief::Belief as _;
use planner_core::belief::consistent_lines::Certainty;
use planner_core::belief::forecast::Forecast;
use planner_core::belief::goal::Accuracy;
use planner_core::belief::noise::Reliability;
use planner_core::belief::outlook::{Foresight as _, Outlook as _, Prediction as _};
use planner_core::belief::posterior::Posterior;
use planner_core::belief::sample::{Label, Reading, Sample};
use planner_core::geometry::area::Area;
use planner_core::geometry::heading::Heading;
use planner_core::geometry::lattice::Site;
use planner_core::geometry::line::{Bound, Line};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;

/// What is known on standard fields after so many steps of look-ahead, and where the agent then is.
fn spaces(steps: u32) -> impl Iterator<Item = (u64, Lines, Site)> {
    (0..cases(25, 250)).map(move |number| {
        let mission = standard_field::standard(7, number, Algorithm::Lookahead, steps);
        let mut at = mission.start.site;
        let flown = mission.fly(|step, _| at = step.pose.site).expect("labels are true");
        (number, flown.belief.version_space().expect("labels are true").clone(), at)
    })
}

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
            let picture = space.outlook(from);
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
            let picture = space.outlook(from);
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
fn labelled<const N: usize, const H: usize>(
    forecast: &mut Forecast<N, H>,
    mission: &Mission,
    rng: &mut ChaCha8Rng,
    labels: usize,
) {
    let most = forecast.belief().taken() + labels;
    while forecast.belief().taken() < most {
        let site = any_site(rng, mission);
        let label = if rng.random_bool(0.5) { Label::Positive } else { Label::Negative };
        let _ = forecast.observe(site, Reading::Side(label)); // a trusted ball may refuse it
        forecast.observe(site, Reading::Boundary).expect("it tells nothing");
    }
}

#[test]
fn forecasts_are_those_of_the_table_and_of_how_far_labels_can_be_believed() {
    let term = |p: f64| if p > 0.0 { -p * p.log2() } else { 0.0 };
    let coin = |p: f64| term(p) + term(1.0 - p);
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    let (mut asked, mut trusted, mut sums, mut most) = (0, 0, [0.0; 2], [0.0_f64; 3]);
    for number in 0..cases(60, 600) {
        let p = [0.6, 0.7, 0.9, 0.99][number as usize % 4];
        let mission = doubtful(number, p);
        let mut forecast = mission.forecast();
        labelled(&mut forecast, &mission, &mut rng, number as usize % 12);
        forecast.prepare();
        let outlook = forecast.outlook(mission.start.site);
        let mut table = mission.table();
        for &Sample { site, label } in &forecast.belief().samples()[table.given().len()..] {
            table.take(Sample { site, label }, table.reliability(site)).expect("as the forecast");
        }
        let posterior = Posterior::new(&table);
        for _ in 0..12 {
            let [site, next] = [(); 2].map(|()| any_site(&mut rng, &mission));
            assert_eq!(forecast.ground().certainty(site), mission.given.certainty(site));
            let is_trusted = table.reliability(site) == Reliability::CERTAIN;
            let p_here = if is_trusted { 1.0 } else { p };
            let share = outlook.share_above(site);
            let chance = p_here * f64::from(share) + (1.0 - p_here) * (1.0 - f64::from(share));
            let told = (coin(chance) - coin(p_here)) / (1.0 - coin(p));
            let context = format!("field {number}, p {p}, trusted {is_trusted}, share {share}");
            assert!((f64::from(outlook.chance(site, share)) - chance).abs() < 1e-6, "{context}");
            let (off, exact) = (f64::from(share), posterior.share_above(site));
            sums[0] += (off - exact).abs();
            most[0] = most[0].max((off - exact).abs());
            // A label that is next to impossible tells nothing, for want of digits.
            let label = if chance > 0.5 { Label::Positive } else { Label::Negative };
            let after = outlook.after(site, label);
            for got in [outlook.information(site, share), after.information(site, share)] {
                let off = (f64::from(got) - told).abs();
                // Two entropies to 10^-3 bits, near one half to as much of what they lack of a bit.
                let bound = if p_here < 0.75 { 0.01 } else { 2e-3 / (1.0 - coin(p)) };
                assert!(off < bound, "{context}: {got} for {told}");
                most[1] = most[1].max(off);
            }
            let mut known = table.clone();
            if known.take(Sample { site, label }, table.reliability(site)).is_ok() {
                let exact = Posterior::new(&known).share_above(next);
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
fn a_forecast_begins_again_in_place() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    let mut again = doubtful(0, 0.7).forecast();
    for number in 0..20 {
        let mission = doubtful(number, 0.8);
        labelled(&mut again, &mission, &mut rng, 5);
        let given = mission.given.samples();
        again.restart(given, mission.prior, mission.noise_told()).expect("an oracle");
        again.restart(&given[..2], mission.prior, mission.noise_told()).expect_err("two points");
        let mut anew = mission.forecast();
        let mut same = rng.clone();
        labelled(&mut again, &mission, &mut rng, 3);
        labelled(&mut anew, &mission, &mut same, 3);
        again.prepare();
        anew.prepare();
        let [again, anew] = [&again, &anew].map(|it| it.outlook(mission.start.site));
        for _ in 0..20 {
            let site = any_site(&mut rng, &mission);
            let bits = [again.share_above(site), anew.share_above(site)].map(f32::to_bits);
            assert_eq!(bits[0], bits[1], "field {number}");
        }
    }
}

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
    let mut rng = ChaCha8Rng::seed_from_u64(15);
    let at = |x: f64, z: f64| Site::try_from(Point2::new(x, z)).expect("on the lattice");
    let (mut inside, mut all, mut none) = (0, 0, 0);
    for number in 0..cases(3_000, 30_000) {
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
        let is_met = |millionths: f64| {
            Accuracy::Misclassified(millionths as u32).is_met(space.bounds(), area)
        };
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
    println!("{inside} strips through the area, {all} over all of it, {none} beside it");
    assert!(inside > 300 && all > 10 && none > 300);
}

/// Of two directions, from some ten millionths of a degree to 80 degrees: never a heading's unit too little, and a
/// ten-thousandth too much.
#[test]
fn slopes_are_promised_to_the_last_digit() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let (through, area) = (Site::ORIGIN, standard_field::area());
    let site = |x: i32, z: i32| Site::new(x, z).expect("on the lattice");
    for number in 0..cases(20_000, 200_000) {
        let length = rng.random_range(1 << 27..1 << 28);
        let rise = 10_f64.powf(rng.random_range(1.5..9.0)) as i32;
        let (x, z) =
            if rise > length { (length / (rise / length), length) } else { (length, rise) };
        let along = [site(length, 0), site(x, z)].map(|to| to - Site::ORIGIN);
        let bounds = along.map(|along| Bound { through, along });
        let width = f64::from(z).atan2(f64::from(x));
        let units = width * 4_294_967_296.0 / (2.0 * PI);
        let is_met = |units: f64| {
            Accuracy::SlopeArc(Heading(units as u32)).is_met(bounds.iter().copied(), area)
        };
        for less in 1..4 {
            let units = units.ceil() - f64::from(less);
            assert!(units < 1.0 || !is_met(units), "case {number}: {width} rad");
        }
        assert!(is_met(1.000_11 * units + 30.0), "case {number}: {width} rad");
    }
}

#[test]
fn goals_are_met_when_they_are_and_not_before() {
    let (mut met, mut beyond) = (0, 0);
    for steps in [2, 5, 8, 12, 16, 20] {
        for (number, space, _) in spaces(steps) {
            let area = standard_field::area();
            let share = disagreed(&space, area);
            for factor in [0.5, 0.9, 0.999, 1.01, 1.1, 1.5] {
                let millionths = (share * factor * 1e6).floor();
                let is_met =
                    Accuracy::Misclassified(millionths as u32).is_met(space.bounds(), area);
                // Below some ten millionths the twin itself has lost its digits; what much ground is cut off by at
                // the border may be half of it again.
                let is_narrow = space.slope_arc().width_deg() < 40.0 && share < 0.1;
                assert!(!is_met || factor > 0.99 || millionths < 20.0, "field {number}: {share}");
                let is_sharp = is_narrow && millionths > 20.0;
                assert!(is_met || factor < 1.4 || !is_sharp, "field {number}: {share}, {factor}");
                met += u32::from(is_met);
            }
            let width = space.slope_arc().width_deg().to_radians();
            for (factor, is_right) in [(0.9, false), (0.9999, false), (1.001, true), (2.0, true)] {
                let Some(most) = Heading::from_radians(width * factor) else { continue };
                if width * factor > 1.5 || most.0 < 10_000 {
                    continue;
                }
                let is_met = Accuracy::SlopeArc(most).is_met(space.bounds(), area);
                assert_eq!(is_met, is_right, "field {number}, {steps} steps, {factor}");
                beyond += u32::from(!is_met);
            }
        }
    }
    assert!(met > 50 && beyond > 50, "{met}, {beyond}");
}
