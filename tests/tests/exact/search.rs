//! The search returns the very action that trying all of them would return, ties included. Along missions
//! `missions::fields` says so of every plan.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::CAPACITY;
use planner_core::dynamics::Dynamics;
use planner_core::parts::{ArcRule, LOOKS, Problem, Solution};
use planner_core::{
    Area, Boat, Car, CarShape, Certainty, Cfc, EffortWeight, Heading, Holonomic, Label, Plan,
    Planner as _, Pose, Recovery, Sample, Site, SlopeArc, Unicycle, Vector, VersionSpace,
    Workspace,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::{cases, clamped};

/// Solves the problems P1, P2, the one without a rule, and one that tracks a direction, both ways.
fn check<D: Dynamics, const N: usize>(
    dynamics: &D,
    space: &VersionSpace<N>,
    area: impl Workspace,
    weight: EffortWeight,
    pose: Pose,
    context: &str,
) -> (u64, u64) {
    let arc = space.slope_arc();
    let rules = [
        ArcRule { inside: None, outside: Some(arc) },
        ArcRule { inside: Some(arc), outside: None },
        ArcRule { inside: Some(arc.middle()), outside: None },
        ArcRule {
            inside: Some(SlopeArc::tracking(Vector::new(3, 5_000).expect("small"))),
            outside: Some(arc),
        },
        ArcRule::default(),
    ];
    let (mut states, mut examined) = (0, 0);
    for rule in rules {
        let problem = Problem { lines: space.lines(), area, weight, rule };
        let quick = problem.solve(dynamics, pose);
        let slow = problem.solve_exhaustively(dynamics, pose);
        assert_eq!(quick.best, slow.best, "{context}: {rule:?} from {pose:?} in {space:?}");
        assert_eq!(u64::from(slow.examined), dynamics.grid().actions());
        states += 1;
        examined += u64::from(quick.examined);
    }
    (states, examined)
}

/// Beside the area, where an error may bring the agent: motions lead back in.
#[test]
fn equals_exhaustive_search_from_outside_the_area() {
    let (unicycle, weight) = (Unicycle::paper(), EffortWeight::PAPER);
    let found: u64 = (0..cases(4, 100))
        .into_par_iter()
        .map(|number| {
            let mission = standard_field::standard(11, number, Algorithm::Cfc, 1);
            let (space, area) = (mission.lines(), mission.config.area);
            let mut found = 0;
            for k in 0..20_i64 {
                let along = i64::from(area.bounds().min().z()) + (k << 16);
                let site = clamped(i64::from(area.bounds().min().x()) - (k + 1) * 5_000, along);
                let pose = Pose { site, heading: Heading((k as u32) << 25) };
                let context = format!("field {number}, place {k}");
                check(&unicycle, &space, area, weight, pose, &context);
                let rule = ArcRule::default();
                let problem = Problem { lines: space.lines(), area, weight, rule };
                found += u64::from(problem.solve(&unicycle, pose).best.is_some());
            }
            found
        })
        .sum();
    assert!(found >= cases(4, 100), "{found}");
}

/// A version space of a few random samples, the area around it, and a pose inside.
fn anywhere(rng: &mut ChaCha8Rng) -> Option<(VersionSpace<CAPACITY>, Area, Pose)> {
    // From centimetres, where rounding to the lattice shows, to kilometres.
    let extent = 1i64 << rng.random_range(6..=28);
    let far = (1i64 << 28) * rng.random_range(-1..=1);
    let within = |rng: &mut ChaCha8Rng, reach: i64| {
        clamped(far + rng.random_range(-reach..=reach), rng.random_range(-reach..=reach))
    };
    let (a, b) = (within(rng, extent), within(rng, extent));
    let samples: Vec<_> = (0..rng.random_range(4..12))
        .map(|_| within(rng, extent))
        .map(|site| {
            let above = planner_core::lattice::orient(a, b, site) > 0;
            Sample { site, label: if above { Label::Positive } else { Label::Negative } }
        })
        .collect();
    let space = VersionSpace::new(&samples).ok()?;
    let reach = 2 * extent.max(40_000);
    let corner = |v: i64| clamped(far + v, v);
    let area = Area::new(corner(-reach), corner(reach)).ok()?;
    let near = samples[rng.random_range(0..samples.len())].site;
    let nudge =
        |rng: &mut ChaCha8Rng, v: i32| i64::from(v) + rng.random_range(-2..=2) * extent / 64;
    let site = match rng.random_range(0..3) {
        0 => near,
        1 => clamped(nudge(rng, near.x()), nudge(rng, near.z())),
        _ => within(rng, extent),
    };
    let heading = Heading(rng.random_range(0..=u32::MAX));
    area.contains(site).then_some((space, area, Pose { site, heading }))
}

/// A car of metres, with a shortest motion, and one of millimetres, whose positions are rounded by much.
fn cars() -> [Car; 2] {
    let good = CarShape {
        radius_mm: 1_500,
        shortest_mm: 500,
        turn_step_urad: 30_000,
        speeds: 11,
        speed_step_mm: 200,
    };
    let tiny = CarShape { radius_mm: 6, shortest_mm: 2, speed_step_mm: 1, ..good };
    [good, tiny].map(|shape| Car::new(shape).expect("a car"))
}

#[test]
fn equals_exhaustive_search_anywhere_for_any_grid() {
    let states = AtomicU64::new(0);
    (0..cases(120, 4_000)).into_par_iter().for_each(|seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(seed));
        let Some((space, area, pose)) = anywhere(&mut rng) else { return };
        let weight = [0.0, 0.1, 0.5, 0.9, 0.999_999][rng.random_range(0..5)];
        let weight = EffortWeight::new(weight).expect("in [0, 1)");
        let context = format!("seed {seed}");
        // Coarse grids have more ties, and one whose last turn falls on a multiple of its step.
        let coarse = Unicycle::new(100_000, 0.5, 11, 200).expect("a grid");
        let round = Holonomic::new(72, 9, 250).expect("a grid");
        // On this one positions are rounded by more than any heading is sure.
        let tiny = Unicycle::new(100_000, 1.0, 5, 1).expect("a grid");
        // On this one they are rounded by much, and headings are dense.
        let fine = Unicycle::new(1_000, 0.5, 9, 4).expect("a grid");
        let mut count = check(&coarse, &space, area, weight, pose, &context).0;
        count += check(&round, &space, area, weight, pose, &context).0;
        count += check(&tiny, &space, area, weight, pose, &context).0;
        count += check(&fine, &space, area, weight, pose, &context).0;
        // Fewer rays the shorter the motion, of which the shortest are none, and ends that may leave no way on.
        for car in cars() {
            count += check(&car, &space, area, weight, pose, &context).0;
        }
        let boat = Boat::new(coarse).expect("a boat");
        count += check(&boat, &space, area, weight, pose, &context).0;
        // Where positions err, motions leave room.
        let inset = area.inset(1 << rng.random_range(0..18));
        if let Some(inset) = inset.filter(|inset| inset.contains(pose.site)) {
            for car in cars() {
                count += check(&car, &space, inset, weight, pose, &context).0;
            }
            count += check(&boat, &space, inset, weight, pose, &context).0;
        }
        if seed % 8 == 0 {
            count += check(&Unicycle::paper(), &space, area, weight, pose, &context).0;
        }
        if seed % 40 == 5 {
            // Rays 1 urad apart, but not as far to either side, so that all can be tried.
            let finest = Unicycle::new(1, 0.006, 21, 100).expect("a grid");
            count += check(&finest, &space, area, weight, pose, &context).0;
        }
        states.fetch_add(count, Relaxed);
    });
    let states = states.into_inner();
    assert!(states >= cases(600, 20_000), "{states}");
}

/// As many rays as there can be with a speed beside standing still: numbers of rays do not overflow.
#[test]
fn a_search_among_2_to_the_31_rays_comes_to_an_end() {
    let most = Holonomic::new(1 << 31, 2, 2_000).expect("a grid");
    for number in 0..40 {
        let mission = standard_field::standard(14, number, Algorithm::Cfc, 1);
        let space = mission.lines();
        let (lines, area) = (space.lines(), mission.config.area);
        let problem =
            Problem { lines, area, weight: EffortWeight::PAPER, rule: ArcRule::default() };
        let solution = problem.solve_within(LOOKS, &most, mission.start);
        let found = solution.best.map(|best| lines.certainty(best.target.site));
        assert!(found.is_none_or(|it| it == Certainty::Uncertain), "{number}: {solution:?}");
    }
}

/// Two parabolas that face each other, `gap` off the axis: a tangent at any of these points keeps clear
/// of the other, so all of them bound the line.
fn parabolas(reach: i32, step: i32, gap: i32) -> VersionSpace<CAPACITY> {
    let points = (-reach..=reach).flat_map(|n| [-1, 1].map(|up| (n, up)));
    let samples: Vec<_> = points
        .map(|(n, up)| Sample {
            site: Site::new(step * n, up * (gap + gap * n * n / (reach * reach)))
                .expect("on the lattice"),
            label: if up > 0 { Label::Positive } else { Label::Negative },
        })
        .collect();
    let space = VersionSpace::new(&samples).expect("they are apart");
    assert_eq!(space.cell().edges().len(), samples.len());
    space
}

fn square(half: i32) -> Area {
    let corner = |v| Site::new(v, v).expect("on the lattice");
    Area::new(corner(-half), corner(half)).expect("an area")
}

#[test]
fn equals_exhaustive_search_among_more_bounds_than_are_kept() {
    let coarse = Unicycle::new(100_000, 0.5, 11, 200).expect("a grid");
    let (mut quick, mut slow) = (0, 0);
    for (reach, step, gap) in [(5, 50_000, 65_536), (15, 20_000, 512), (16, 3_000, 40_000)] {
        let space = parabolas(reach, step, gap);
        for n in (-9..=9).step_by(3) {
            let site = Site::new(reach * step / 10 * n, gap * n / 5).expect("on the lattice");
            let pose = Pose { site, heading: Heading(n.unsigned_abs() << 28) };
            let context = "between parabolas";
            let area = square(400_000);
            let (states, examined) =
                check(&coarse, &space, area, EffortWeight::PAPER, pose, context);
            let (more, also) =
                check(&Unicycle::paper(), &space, area, EffortWeight::PAPER, pose, context);
            slow += states * coarse.grid().actions() + more * 6657;
            quick += examined + also;
        }
    }
    assert!(quick < slow / 100, "many bounds are no reason to look everywhere: {quick} of {slow}");
}

/// Motions of a few millimetres, where rounding hides what is certain from a search: the uncertain ground
/// is behind the agent, and there are more rays before it than a plan may look at.
#[test]
fn a_plan_has_so_many_looks_and_says_when_they_do_not_do() {
    let sample = |x, z, label| Sample { site: Site::new(x, z).expect("on the lattice"), label };
    let space = VersionSpace::<CAPACITY>::new(&[
        sample(-60_000, -100, Label::Negative),
        sample(60_000, -100, Label::Negative),
        sample(-60_000, 100, Label::Positive),
        sample(60_000, 100, Label::Positive),
    ]);
    let planner = |dynamics| {
        Cfc::new(square(400_000), dynamics, space.clone().expect("they are apart"))
            .expect("settings that agree")
    };
    let pose = |z, quarters: u32| Pose {
        site: Site::new(0, z).expect("on the lattice"),
        heading: Heading(quarters << 30),
    };
    let fine = Unicycle::new(100, 1.57, 20, 1).expect("a grid");
    assert!(fine.grid().actions() > 7 * u64::from(LOOKS));
    // Facing away from the strip it turns, as it finds by a few of them.
    let Plan::Move(motion) = planner(fine).plan(pose(700, 1)) else { panic!("it can turn") };
    assert!(motion.recovery == Some(Recovery::Reorient) && motion.examined <= LOOKS, "{motion:?}");
    // Beside it: what is found first asks for a sharp turn, and all that turns less has to be looked at.
    let beside = pose(-1_100, 0);
    let Plan::Move(motion) = planner(fine).plan(beside) else { panic!("there are motions") };
    assert!(motion.examined <= LOOKS, "{motion:?}");
    assert_eq!(space.as_ref().map(|it| it.certainty(motion.target.site)), Ok(Certainty::Uncertain));
    // More looks, never a worse action, and in the end the best.
    let problem = planner(fine);
    let problem = problem.problem();
    let best = problem.solve_exhaustively(&fine, beside).best;
    let mut before = None;
    for looks in [0, 1, 10, 100, 1_000, 10_000, 100_000] {
        let Solution { best: found, examined, proven } = problem.solve_within(looks, &fine, beside);
        let objective = found.map(|it| it.objective);
        assert!(examined <= looks && objective >= before, "{looks} looks: {found:?}");
        assert!(!proven || found == best, "{looks} looks: {found:?}");
        before = objective;
    }
    assert_eq!(before, best.map(|it| it.objective));
    // A coarser grid is looked at to the end.
    let coarse = Unicycle::new(100_000, 1.57, 20, 1).expect("a grid");
    let Plan::Move(motion) = planner(coarse).plan(pose(700, 1)) else { panic!("it can turn") };
    assert!(motion.proven && !motion.wants_label);
}
