//! Observations that bring the tolerance of their own position. They never cut off a line that agrees with them. They
//! tell more than observations with the configured tolerance, and a wider tolerance than that is refused.

use std::f64::consts::TAU;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::read_out::AnyPlanner;
use nalgebra::{Point2, Vector2};
use planner_core::error::{GivenError, ObservationError};
use planner_core::estimate::area;
use planner_core::{Label, Line, Plan, Pose, Reading, Sample, Site, Tolerance, VersionSpace};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::ensemble::{self, median, noisy};

/// The most that a position may be off, metres.
const MOST: f64 = 0.8;

fn metres(tolerance: f64) -> Tolerance {
    Tolerance::new(tolerance).expect("a distance")
}

/// A field whose positions may be off by [`MOST`].
fn mission(seed: u64, number: u64, algorithm: Algorithm) -> Mission {
    let mut mission = standard_field::standard(seed, number, algorithm, 24);
    mission.config.tolerance = metres(MOST);
    mission
}

/// A label as it was reported: where, which, and how far that may be off.
type Report = (Point2<f64>, Label, f64);

/// Flies a mission whose positions are off by as much as `errs` says for each step, at most, and whose reports say that
/// they are off by as much as `tells` says. Returns the planner.
fn fly(
    mission: &Mission,
    rng: &mut ChaCha8Rng,
    errs: impl Fn(u32, &mut ChaCha8Rng) -> f64,
    tells: impl Fn(f64) -> f64,
    mut seen: impl FnMut(&AnyPlanner, Report),
) -> AnyPlanner {
    let truth = *mission.world.line().expect("a line divides it");
    let (mut planner, mut pose) = (mission.planner(), mission.start);
    for step in 0..mission.steps {
        let Plan::Move(motion) = planner.plan(pose) else { break };
        let is = Point2::<f64>::from(motion.target.site);
        let (err, angle) = (errs(step, rng), rng.random_range(0.0..TAU));
        // As far off as it may be, half of the time.
        let off = 0.999 * err * rng.random_range(0.0..2.0_f64).min(1.0);
        let reported = is + off * Vector2::new(angle.cos(), angle.sin());
        let site = Site::try_from(reported).expect("on the lattice");
        pose = Pose { site, ..motion.target };
        // A position is rounded to the lattice: that is an error too.
        let told = if err == 0.0 { Point2::<f64>::from(site) } else { is };
        let label = if truth.distance(told) >= 0.0 { Label::Positive } else { Label::Negative };
        let reading = motion.wants_label.then_some(Reading::Side(label));
        let taken = planner.observe_within(pose, reading, metres(tells(err)));
        taken.unwrap_or_else(|refused| panic!("a true label is refused: {refused}"));
        if reading.is_some() {
            seen(&planner, (reported, label, err));
        }
    }
    planner
}

/// The slow twin: lines drawn at random, of which those stay that no report excludes. A report excludes the lines that
/// are further on its wrong side than it may be off.
struct Twin(Vec<Line>);

impl Twin {
    fn new(mission: &Mission, rng: &mut ChaCha8Rng) -> Self {
        let truth = *mission.world.line().expect("a line divides it");
        let [a, b, c] = truth.coefficients();
        let mut near = |spread: f64| {
            let [a, b, c] = [a, b, c / 20.0].map(|it| it + rng.random_range(-spread..=spread));
            Line::from_coefficients(a, b, 20.0 * c)
        };
        let spreads = [0.3, 0.1, 0.03, 0.01, 0.003];
        let drawn = spreads
            .iter()
            .flat_map(|spread| (0..40).filter_map(|_| near(*spread)).collect::<Vec<_>>());
        Self(drawn.chain([truth]).collect())
    }

    fn keep(&mut self, (at, label, off): Report) {
        let sign = f64::from(label.sign());
        self.0.retain(|line| sign * line.distance(at) >= -off - 1e-9);
    }

    /// Those that a version space has cut off.
    fn lost<const N: usize>(&self, space: &VersionSpace<N>) -> usize {
        let agrees = |line: &&Line| {
            space.samples().iter().all(|sample| {
                f64::from(sample.label.sign()) * line.distance(sample.site.into()) >= -1e-7
            })
        };
        self.0.iter().filter(|line| !agrees(line)).count()
    }
}

/// In random missions, with tolerances of nothing, a little, and as much as is allowed.
#[test]
fn no_line_is_cut_off_that_the_reports_leave() {
    let errs = |_: u32, rng: &mut ChaCha8Rng| match rng.random_range(0..4) {
        0 => 0.0,
        1 => MOST,
        2 => rng.random_range(0.0..0.05),
        _ => rng.random_range(0.0..MOST),
    };
    let counts = (0..cases(300, 20_000)).into_par_iter().map(|number| {
        let algorithm = if number % 8 == 0 { Algorithm::Lookahead } else { Algorithm::Cfc };
        let mission = mission(51, number, algorithm);
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
        let mut twin = Twin::new(&mission, &mut rng);
        for sample in mission.given.samples() {
            twin.keep((sample.site.into(), sample.label, 0.0));
        }
        let (mut labels, mut left) = (0, 0);
        fly(
            &mission,
            &mut rng,
            errs,
            |err| err,
            |planner, report| {
                twin.keep(report);
                let space = planner.belief().version_space().expect("true labels");
                assert_eq!(twin.lost(space), 0, "mission {number}: {report:?} cut lines off");
                (labels, left) = (labels + 1, left + twin.0.len());
            },
        );
        [labels, left]
    });
    let [labels, left] = counts.reduce(|| [0, 0], |[a, b], [c, d]| [a + c, b + d]);
    let enough = cases(1_500, 10_000) as usize;
    assert!(labels > enough && left > 2 * labels, "{labels} labels, {left} lines");
}

/// Given samples whose positions err too, each by its own tolerance: no line is cut off that they leave, and all is much less
/// than what one of the largest tolerance leaves for all.
#[test]
fn given_samples_may_err() {
    let (mut own_bits, mut tested, mut vague) = (0.0, 0, 0);
    for number in 0..cases(300, 20_000) {
        let mission = mission(54, number, Algorithm::Cfc);
        let truth = *mission.world.line().expect("a line divides it");
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
        let mut twin = Twin::new(&mission, &mut rng);
        let reports: Vec<_> = mission
            .given
            .samples()
            .iter()
            .map(|sample| {
                let err = [0.0, 0.1, 0.5, 1.0][rng.random_range(0..4)];
                let (off, angle) = (0.999 * err, rng.random_range(0.0..TAU));
                let at =
                    Point2::<f64>::from(sample.site) + off * Vector2::new(angle.cos(), angle.sin());
                let site = Site::try_from(at).expect("on the lattice");
                twin.keep((site.into(), sample.label, err + 1e-4));
                (Sample { site, ..*sample }, metres(err))
            })
            .collect();
        assert!(twin.0.iter().any(|line| line.angle_to_deg(&truth) < 1e-9), "the truth agrees");
        let most: Vec<_> = reports.iter().map(|(sample, _)| (*sample, metres(1.0))).collect();
        match VersionSpace::<16>::of_uncertain(&reports) {
            Ok(space) => {
                // A report is rounded to the lattice, which the twin allows for and no line of it may need.
                let strict = reports.iter().fold(twin, |mut twin, (sample, tolerance)| {
                    twin.keep((sample.site.into(), sample.label, tolerance.metres()));
                    twin
                });
                assert_eq!(strict.lost(&space), 0, "field {number}: {reports:?}");
                tested += 1;
                if let Ok(all) = VersionSpace::<16>::of_uncertain(&most) {
                    let area = |space: &VersionSpace<16>| f64::from(area(space.lines()));
                    own_bits += (area(&all) / area(&space)).log2();
                }
            }
            Err(GivenError::TooVague) => vague += 1,
            Err(other) => panic!("field {number}: {other}"),
        }
    }
    assert!(
        tested > 10 * vague && own_bits > 0.2 * f64::from(tested),
        "{tested} {vague} {own_bits}"
    );
    // Exact samples are taken as they are.
    let mission = mission(54, 1, Algorithm::Cfc);
    let exact: Vec<_> = mission.given.samples().iter().map(|it| (*it, Tolerance::NONE)).collect();
    let space = VersionSpace::<16>::of_uncertain(&exact).expect("exact ones");
    assert_eq!(space.samples(), mission.given.samples());
}

/// The median of the bits that missions learn whose error grows with the way.
fn bits(mission: impl Fn(u64) -> Mission + Sync, tells: impl Fn(f64) -> f64 + Sync) -> f64 {
    // A dead reckoning: from 2 cm to the most.
    let errs = |step: u32, _: &mut ChaCha8Rng| (0.02 + 0.04 * f64::from(step)).min(MOST);
    let each = |number: u64| {
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
        let planner = fly(&mission(number), &mut rng, errs, &tells, |_, _| {});
        planner.belief().information()
    };
    median(ensemble::fly(cases(30, 1_000), each))
}

#[test]
fn own_tolerances_tell_more_than_the_most() {
    for (algorithm, is_true, least) in [
        (Algorithm::Cfc, true, 0.5),
        (Algorithm::Lookahead, true, 0.5),
        (Algorithm::Scc, false, 0.1),
        (Algorithm::Lookahead, false, 0.3),
    ] {
        let mission = |number| {
            let mission = mission(52, number, algorithm);
            if is_true { mission } else { noisy(mission, 0.95, 0.0) }
        };
        let [own, most] = [bits(mission, |err| err), bits(mission, |_| MOST)];
        println!("{algorithm:?}: {own:.2} bits with own tolerances, {most:.2} with the most");
        assert!(own > most + least, "{algorithm:?}: {own} and {most} bits");
    }
}

/// A planner refuses more than was configured, stays as it was, and takes in as much as was configured.
#[test]
fn more_than_was_configured_is_refused_and_changes_nothing() {
    let more = metres(MOST + 0.01);
    for mission in [
        mission(53, 3, Algorithm::Cfc),
        mission(53, 3, Algorithm::Lookahead),
        noisy(mission(53, 3, Algorithm::Lookahead), 0.9, 0.0),
        noisy(mission(53, 3, Algorithm::Scc), 0.9, 0.0),
    ] {
        let (mut planner, start) = (mission.planner(), mission.start);
        let Plan::Move(motion) = planner.plan(start) else { panic!("no motion") };
        let reading = Some(Reading::Side(Label::Positive));
        let chance = |planner: &AnyPlanner| planner.belief().chance(motion.target.site).to_bits();
        let before = chance(&planner);
        let refused = planner.observe_within(motion.target, reading, more);
        assert_eq!(refused, Err(ObservationError::Tolerance(more)));
        assert_eq!(chance(&planner), before);
        assert_eq!(planner.plan(start), Plan::Move(motion));
        planner.observe_within(motion.target, reading, metres(MOST)).expect("as configured");
        assert_ne!(chance(&planner), before);
    }
}
