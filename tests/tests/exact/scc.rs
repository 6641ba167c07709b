//! Algorithm 2: the vote against the slow way, the world's noise, and what its posterior is worth.

use std::collections::BTreeMap;

use host_sim::campaign::calibration::{Calibrated, Summary};
use host_sim::campaign::ensemble::Campaign;
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::baseline::motion;
use host_sim::mission::definition::{HYPOTHESES, Mission, Table};
use host_sim::mission::given::CAPACITY;
use host_sim::mission::names::FanName;
use host_sim::mission::read_out::LEVEL;
use host_sim::world::noise::{Extent, Flipped, NoiseModel, limit};
use host_sim::world::robot::{Ideal, Robot as _};
use nalgebra::Point2;
use planner_core::dynamics::Action;
use planner_core::lattice::LIMIT;
use planner_core::link::message::MissionArea;
use planner_core::{
    AnyReliability, Heading, Label, Noise, Plan, Planner, Policy, Pose, PosteriorView, Prior,
    Reliability, Sample, Scc, Site, Tolerance, Unicycle,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::ensemble::{self, mean};

type Planner64 = Scc<Unicycle, CAPACITY, HYPOTHESES, MissionArea, AnyReliability>;

/// The election the slow way: every hypothesis tries every action, and all votes are summed.
fn slow_election(planner: &Planner64, pose: Pose) -> Option<Action> {
    let weights = || planner.belief().iter().map(|h| h.weight().exp());
    let most = weights().fold(0.0, f64::max);
    let mut sums: BTreeMap<Action, u64> = BTreeMap::new();
    for (hypothesis, weight) in planner.belief().iter().zip(weights()) {
        let votes = (weight / most * f64::from(1 << 20)).round() as u64;
        let search = planner.problem(hypothesis).solve_exhaustively(&Unicycle::paper(), pose);
        if let (Some(best), 1..) = (search.best, votes) {
            *sums.entry(best.action).or_default() += votes;
        }
    }
    let most = sums.values().max()?;
    sums.iter().find(|(_, votes)| *votes == most).map(|(action, _)| *action)
}

#[test]
fn a_vote_is_the_sum_over_hypotheses_computed_the_slow_way() {
    let elections: u64 = (0..cases(5, 24))
        .into_par_iter()
        .map(|number| {
            let policy = [Policy::MixtureOfOwn, Policy::MixtureOfStart][number as usize % 2];
            let prior = [Prior::Area, Prior::Sequences][number as usize / 2 % 2];
            let mut mission = standard_field::standard(9, number, Algorithm::Scc, 12);
            mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
            (mission.policy, mission.prior) = (policy, prior);
            let (mut from, mut before) = (mission.start, mission.table());
            let mut elections = 0;
            let flown = mission.fly(|step, belief| {
                let planner = |table: Table| -> Planner64 {
                    let planner = Scc::new(mission.config.area, Unicycle::paper(), table);
                    let planner = planner.expect("settings that agree");
                    planner.with(mission.config.options()).voting(policy)
                };
                // From where it was and, facing elsewhere, where it was not.
                let elsewhere = Pose { heading: Heading(from.heading.0.wrapping_mul(77)), ..from };
                for pose in [from, elsewhere] {
                    let mut planner = planner(before.clone());
                    let slow = slow_election(&planner, pose);
                    let Plan::Move(motion) = planner.plan(pose) else { panic!("it moves") };
                    let elected = motion.recovery.is_none().then_some(motion.action);
                    assert_eq!(elected, slow, "{number}");
                    elections += 1;
                }
                let table = belief.hypotheses().expect("labels may err");
                (from, before) = (step.pose, table.clone());
            });
            assert!(flown.is_ok());
            elections
        })
        .sum();
    assert!(elections > cases(80, 400), "{elections}");
}

#[test]
fn the_world_flips_labels_where_it_should_and_as_often() {
    let mission = standard_field::standard(1, 2, Algorithm::Scc, 1);
    let world = mission.world.clone();
    let given = mission.given.samples();
    for extent in [Extent::OutsideBalls(3.0), Extent::Band(2.0), Extent::OutsideBalls(0.0)] {
        let model = NoiseModel { p: 0.7, extent };
        let noisy = Mission { noise: Some(model), ..mission.clone() };
        let (body, rng) = (Ideal { world: world.clone() }, ChaCha8Rng::seed_from_u64(4));
        let noise = noisy.noise_told();
        let mut robot = Flipped {
            body: Box::new(body),
            model,
            world: world.clone(),
            given: given.to_vec(),
            rng,
        };
        let mut places = ChaCha8Rng::seed_from_u64(5);
        let (mut exposed, mut flipped) = (0, 0);
        for _ in 0..40_000 {
            let mut metres = || places.random_range(0.0..standard_field::SIDE_M);
            let at = Point2::new(metres(), metres());
            let site = Site::try_from(at).expect("near");
            let mut pose = mission.start;
            let motion = motion(&Unicycle::paper(), pose, Action(0), Pose { site, ..pose });
            let wrong = robot.perform(&motion, &mut pose) != Some(world.reading(site));
            let near = |s: &Sample| (Point2::<f64>::from(s.site) - at).norm();
            let safe = match extent {
                Extent::OutsideBalls(radius) => given.iter().any(|s| near(s) < radius - 1e-3),
                Extent::Band(half) => world.distance(site).abs() > half + 1e-3,
            };
            assert!(!(safe && wrong), "{extent:?}: a flip at {at}");
            if !safe {
                exposed += 1;
                flipped += i32::from(wrong);
            }
            // What the planner is told of the balls is what the world does.
            if let Extent::OutsideBalls(_) = extent {
                let trusted = noise.at(site, given) == Reliability::CERTAIN;
                assert!(!trusted || !wrong);
            }
        }
        let share = f64::from(flipped) / f64::from(exposed);
        assert!((share - 0.3).abs() < 0.02, "{extent:?}: {share}");
    }
}

#[test]
fn a_trusted_ball_ends_where_it_should_whatever_its_radius() {
    let reliability = Reliability::new(0.7).expect("a probability");
    let at = |x, z| Site::new(x, z).expect("on the lattice");
    let corner = LIMIT - 1;
    let given = [(0, 0), (-corner, -corner)]
        .map(|(x, z)| Sample { site: at(x, z), label: Label::Positive });
    for (radius, x, z, trusted) in [
        (0, 0, 0, false),
        (5, 3, 4, true),
        (5, 5, 1, false),
        (5, -corner + 3, -corner + 4, true),
        (100_000, 0, -100_000, true),
        (100_000, 0, -100_001, false),
        (3_037_000_500, corner, corner, true),
        (u32::MAX, corner, corner, true),
    ] {
        let noise = Noise { reliability, trusted_radius: radius, tolerance: Tolerance::NONE };
        let is_trusted = noise.at(at(x, z), &given) == Reliability::CERTAIN;
        assert_eq!(is_trusted, trusted, "{radius} at ({x}, {z})");
    }
}

/// Labels are true with a probability of 0.7.
fn campaign(algorithm: Algorithm, fields: u64, policy: Policy) -> Campaign {
    let noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.0) });
    let (vehicle, usual) = (FanName::Paper.into(), Campaign::of(algorithm, 36));
    Campaign { fields, vehicle, noise, policy, ..usual }
}

/// The mean of what is learnt in 30 labels, of 80 fields.
fn bits_of(algorithm: Algorithm, policy: Policy) -> f64 {
    let campaign = campaign(algorithm, 80, policy);
    let rows = campaign.run(&Calibrated).expect("there is room");
    let summary = Summary::of(&campaign, rows).expect("no trusted label");
    summary.rows.iter().find(|row| row.labels == 30).expect("a mark").bits
}

/// What a posterior states by a prior of its credible set and of its best hypothesis: the probability of each, and whether it
/// holds the true line.
fn stated(mission: &Mission, table: &Table, prior: Prior) -> [(f64, bool); 2] {
    let table = table.weighed_by(prior);
    let posterior = PosteriorView::new(&table);
    let (set, best) = (posterior.credible(LEVEL), posterior.best().expect("a hypothesis"));
    let holds = |it: &_| mission.world.is_among(table.lines(it)) == Some(true);
    let set_holds = posterior.members(&set).any(holds);
    [(set.probability, set_holds), (best.probability, holds(best.hypothesis))]
}

/// How many there are, the mean of what is stated, and the share that holds.
fn summed(stated: &[(f64, bool)]) -> (f64, f64, f64) {
    let holding = stated.iter().filter(|it| it.1).count() as f64;
    let count = stated.len() as f64;
    (count, mean(stated.iter().map(|it| it.0)), holding / count)
}

/// What is stated holds, by the area prior. A label tells less than a channel with its errors could, and the default policy
/// learns the most.
#[test]
fn credible_sets_cover_as_they_state_and_the_default_policy_learns_the_most() {
    let own = campaign(Algorithm::Scc, cases(400, 2_000), Policy::MixtureOfOwn);
    let of_each = ensemble::fly(own.fields, |number| {
        let (mission, mut labels, mut after) = (own.mission(number), 0, Vec::new());
        let flown = mission.fly(|step, belief| {
            labels += u32::from(step.reading.is_some());
            if step.reading.is_some() && [10, 20, 30].contains(&labels) {
                let table = belief.hypotheses().expect("labels may err");
                assert!(PosteriorView::new(table).pruned_mass() <= 0.0);
                let by = [Prior::Area, Prior::Sequences].map(|it| stated(&mission, table, it));
                after.push((belief.information(), by));
            }
        });
        assert!(flown.is_ok());
        after
    });
    for (k, labels) in [10, 20, 30].into_iter().enumerate() {
        let of = |prior: usize, what: usize| -> Vec<_> {
            of_each.iter().map(|after| after[k].1[prior][what]).collect()
        };
        let ((_, stated, holds), (_, _, by_sequences)) = (summed(&of(0, 0)), summed(&of(1, 0)));
        assert!((holds - stated).abs() < 0.02, "{labels}: {stated} {holds}");
        assert!(by_sequences < holds, "{labels}: the paper's prior is overconfident");
        let mut best = of(0, 1);
        best.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (n, stated, hit) in best.chunks(best.len().div_ceil(5)).map(summed) {
            // Two points, and what chance adds in a bin of this size.
            let chance = 3.0 * (stated * (1.0 - stated) / n).sqrt();
            assert!((hit - stated).abs() < 0.02 + chance, "{labels}: {n} {stated} {hit}");
        }
    }
    let bits = mean(of_each.iter().map(|after| after[2].0));
    assert!((limit(0.7) - 0.1187).abs() < 1e-4);
    assert!(bits >= 2.1 && bits / 30.0 <= limit(0.7), "{bits}");
    for policy in [Policy::MixtureOfStart, Policy::Joint] {
        assert!(bits > 1.2 * bits_of(Algorithm::Scc, policy), "{policy:?}");
    }
    assert!(bits > 2.0 * bits_of(Algorithm::Random, Policy::default()));
}
