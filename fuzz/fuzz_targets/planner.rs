#![no_main]
//! The planner's calls in any order, on any grid that the constructors take, with labels of a line or of
//! none. Nothing overflows, positions stay in the area, true labels are never refused, and certain labels are true.
//! The search finds what trying every action finds. Look-ahead repeats itself, asks on uncertain ground alone and
//! promises no more than is known.

use arbitrary::{Arbitrary, Unstructured};
use libfuzzer_sys::fuzz_target;
use planner_core::dynamics::{Dynamics, check};
use planner_core::error::ObservationError;
use planner_core::lattice::orient;
use planner_core::parts::{EVALUATIONS, LOOKS};
use planner_core::{Accuracy, Angle, Area, Belief, CellPosterior, Certainty, Cfc, Crossing, EffortWeight, Following, Goal, Heading, Holonomic, Label, Lookahead, Motion, Noise, NoisyBelief, Options, Plan, Planner, Policy, Pose, PosteriorView, PredictiveBelief, Prior, Reading, Reliability, Sample, Scc, Site, Stage, StopReason, Tolerance, Unicycle, VersionSpace};

/// Actions that are tried one by one, at most.
const FEW: u64 = 3_000;

/// Why a constructor refuses nothing.
const AGREE: &str = "an area, a vehicle and a belief that agree";

#[derive(Arbitrary, Debug)]
struct Case {
    holonomic: bool,
    turn_step: u16,
    sharpest: u16,
    speeds: u8,
    speed_step: u16,
    /// Two points of the true line, and how far they are off the grid of all others.
    line: [(i16, i16, i8, i8); 2],
    scale: u8,
    oracle: Vec<(i16, i16)>,
    start: (i16, i16, u32),
    varrho: u32,
    crossing: u8,
    follows_bisector: bool,
    p: u16,
    trusted_radius: u32,
    steps: Vec<Step>,
}

#[derive(Arbitrary, Debug)]
enum Step {
    /// Plan, move, and read: the truth, or the opposite.
    Fly { lies: bool },
    /// Move and read nothing.
    Pass,
    /// Read at some other place.
    Jump { x: i16, z: i16, heading: u32 },
}

struct World {
    line: [Site; 2],
    scale: i32,
}

impl World {
    fn site(&self, x: i32, z: i32) -> Option<Site> {
        Site::new(x.checked_mul(self.scale)?, z.checked_mul(self.scale)?).ok()
    }

    fn reading(&self, site: Site) -> Reading {
        match orient(self.line[0], self.line[1], site) {
            0 => Reading::Boundary,
            side if side > 0 => Label::Positive.into(),
            _ => Label::Negative.into(),
        }
    }
}

fn run<D: Dynamics + Copy>(case: &Case, dynamics: D, world: &World) -> Option<()> {
    check(&dynamics).expect("what the constructors take keeps the contract");
    let oracle: Vec<_> = case
        .oracle
        .iter()
        .take(9)
        .filter_map(|&(x, z)| {
            let site = world.site(x.into(), z.into())?;
            let Reading::Side(label) = world.reading(site) else { return None };
            Some(Sample { site, label })
        })
        .collect();
    let space = VersionSpace::<16>::new(&oracle).ok()?;
    let half = 40_000;
    let corner = |v: i32| world.site(v, v).unwrap_or(Site::ORIGIN);
    let area = Area::new(corner(-half), corner(half)).ok()?;
    let options = Options {
        weight: EffortWeight::new(f64::from(case.varrho % 1_000_000) / 1e6).ok()?,
        crossing: [Crossing::Unrestricted, Crossing::AlongOracle, Crossing::AcrossBisector]
            [usize::from(case.crossing % 3)],
        following: if case.follows_bisector {
            Following::AlongBisector
        } else {
            Following::Unrestricted
        },
    };
    let (x, z, heading) = case.start;
    let start = Pose { site: world.site(x.into(), z.into())?, heading: Heading(heading) };
    let cfc = Cfc::new(area, dynamics, space.clone()).expect(AGREE).with(options);
    fly_true(case, cfc, world, start, area, |planner, pose| {
        let few = dynamics.grid().actions() <= FEW && area.contains(pose.site);
        let slow = few.then(|| planner.problem().solve_exhaustively(&dynamics, pose).best);
        let quick = few.then(|| planner.problem().solve(&dynamics, pose).best);
        assert_eq!(quick, slow, "from {pose:?}");
        let plan = planner.plan(pose);
        assert!(!matches!(plan, Plan::Move(motion) if motion.examined > LOOKS));
        plan
    });
    // Bytes that mean something else as well, so that there are no more of them.
    let accuracy = if case.follows_bisector {
        Accuracy::SlopeArc(Angle(case.varrho % (1 << 30)))
    } else {
        Accuracy::Misclassified(case.varrho % 1_000_000)
    };
    let goal = Goal { accuracy, level: 500_000 + case.start.2 % 500_000 };
    for (goal, audits) in [(None, true), (Some(goal), false), (Some(goal), true)] {
        let planner = Lookahead::new(area, dynamics, space.clone()).expect(AGREE).until(goal);
        let planner = if audits { planner } else { planner.without_audit() };
        fly_true(case, planner, world, start, area, |planner, pose| {
            let plan = look_ahead_truly(planner, pose);
            let known = plan == Plan::Stop(StopReason::Known);
            let is_met = goal.is_some_and(|it| planner.belief().meets(it, area));
            assert!(if audits { is_met || !known } else { is_met == known });
            assert_ne!(plan, Plan::Stop(StopReason::NoLine), "a true line is accused");
            if let (true, Accuracy::SlopeArc(most)) = (known, accuracy) {
                let width = planner.belief().slope_arc().width_deg();
                assert!(width <= most.radians().to_degrees(), "{width} of {most:?}");
            }
            plan
        });
    }
    let reliability = Reliability::new(f64::from(case.p) / f64::from(u16::MAX)).ok()?;
    for (policy, prior) in [
        (Policy::Joint, Prior::Area),
        (Policy::MixtureOfStart, Prior::Sequences),
        (Policy::MixtureOfOwn, Prior::Area),
    ] {
        let noise =
            Noise { reliability, trusted_radius: case.trusted_radius, tolerance: Tolerance::NONE };
        let table = CellPosterior::<16, 24>::new(&oracle, prior, noise).ok()?;
        let scc = Scc::new(area, dynamics, table).expect(AGREE).with(options).voting(policy);
        fly_any(case, scc, world, start, area, |planner, pose| planner.plan(pose));
        let mut noisy = NoisyBelief::<16, 24>::NONE;
        noisy.restart(&oracle, prior, noise).ok()?;
        let planner = Lookahead::new(area, dynamics, noisy).expect(AGREE).until(goal);
        fly_any(case, planner, world, start, area, look_ahead);
    }
    Some(())
}

/// A plan of look-ahead with true labels: an audit asks for them on certain ground.
fn look_ahead_truly<D: Dynamics + Clone>(
    planner: &mut Lookahead<D, VersionSpace<16>, Area, Accuracy>,
    pose: Pose,
) -> Plan {
    let plan = look_ahead(planner, pose);
    if let Plan::Move(Motion { stage: Some(Stage::Audit), target, wants_label: true, .. }) = plan {
        assert_ne!(planner.belief().lines().certainty(target.site), Certainty::Uncertain);
    }
    plan
}

/// A plan of look-ahead: the same each time, and if a label is wanted, on uncertain ground or of an audit.
fn look_ahead<D: Dynamics + Clone, B: PredictiveBelief + Clone>(
    planner: &mut Lookahead<D, B, Area, Accuracy>,
    pose: Pose,
) -> Plan {
    let plan = planner.plan(pose);
    assert_eq!(plan, planner.plan(pose), "from {pose:?}");
    if let Plan::Move(Motion { stage, recovery, target, wants_label, examined, .. }) = plan {
        // Of a copy, as the planner itself would forget its turns.
        let certainty = planner.clone().belief_mut().ground().certainty(target.site);
        let is_open = certainty == Certainty::Uncertain;
        assert!(!wants_label || is_open || stage == Some(Stage::Audit), "to {target:?}");
        // The ladder looks further.
        assert!(examined <= if recovery.is_some() { LOOKS } else { EVALUATIONS });
    }
    plan
}

/// A planner whose labels are true.
fn fly_true<P: Planner<Belief = VersionSpace<16>>>(
    case: &Case,
    mut planner: P,
    world: &World,
    mut pose: Pose,
    area: Area,
    mut plan: impl FnMut(&mut P, Pose) -> Plan,
) {
    for step in &case.steps {
        let reading = match step {
            Step::Fly { .. } | Step::Pass => {
                let Plan::Move(motion) = plan(&mut planner, pose) else { return };
                assert!(area.contains(motion.target.site));
                pose = motion.target;
                let reads = motion.wants_label && !matches!(step, Step::Pass);
                reads.then(|| world.reading(pose.site))
            }
            Step::Jump { x, z, heading } => {
                let Some(site) = world.site((*x).into(), (*z).into()) else { return };
                pose = Pose { site, heading: Heading(*heading) };
                Some(world.reading(site))
            }
        };
        if let (Certainty::Certain(label), Reading::Side(truth)) =
            (planner.belief().certainty(pose.site), world.reading(pose.site))
        {
            assert_eq!(label, truth, "certain of what is false at {pose:?}");
        }
        match planner.observe(pose, reading) {
            Ok(()) => {}
            Err(ObservationError::Full(_)) => return,
            Err(refused) => panic!("a true reading was refused: {refused:?}"),
        }
    }
    let _ = planner.estimates();
}

/// A planner whose labels are of any kind.
fn fly_any<P: Planner<Belief = CellPosterior<16, 24>>>(
    case: &Case,
    mut planner: P,
    world: &World,
    mut pose: Pose,
    area: Area,
    mut plan: impl FnMut(&mut P, Pose) -> Plan,
) {
    for step in &case.steps {
        let reading = match step {
            Step::Fly { .. } | Step::Pass => {
                let Plan::Move(motion) = plan(&mut planner, pose) else { return };
                assert!(area.contains(motion.target.site));
                pose = motion.target;
                let lies = matches!(step, Step::Fly { lies: true });
                let flip = |reading| match reading {
                    Reading::Side(label) if lies => Reading::Side(-label),
                    reading => reading,
                };
                (!matches!(step, Step::Pass)).then(|| flip(world.reading(pose.site)))
            }
            Step::Jump { x, z, heading } => {
                let Some(site) = world.site((*x).into(), (*z).into()) else { return };
                pose = Pose { site, heading: Heading(*heading) };
                Some(world.reading(site))
            }
        };
        if planner.observe(pose, reading).is_err() {
            return;
        }
        let posterior = PosteriorView::new(planner.belief());
        let all: f64 = planner.belief().iter().map(|it| posterior.probability(it)).sum();
        assert!((all - 1.0).abs() < 1e-6, "probabilities sum to {all}");
        assert!((0.0..=1.0).contains(&posterior.pruned_mass()));
    }
    let _ = planner.estimates();
}

fuzz_target!(|bytes: &[u8]| {
    let Ok(case) = Case::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    let scale = 1 << (case.scale % 14);
    let point = |(x, z, dx, dz): (i16, i16, i8, i8)| {
        let at = |v: i16, off: i8| i32::from(v) * scale + i32::from(off);
        Site::new(at(x, dx), at(z, dz)).expect("on the lattice")
    };
    let line = case.line.map(point);
    if line[0] == line[1] {
        return;
    }
    let world = World { line, scale };
    // What the constructors take, mostly.
    let speeds = 1 + u16::from(case.speeds % 64);
    let step = u32::from(case.speed_step) % (100_000 / u32::from(speeds));
    let _ = if case.holonomic {
        Holonomic::new(u32::from(case.turn_step) % 512, speeds, step)
            .ok()
            .and_then(|it| run(&case, it, &world))
    } else {
        let sharpest = f64::from(case.sharpest % 31_416) / 10_000.0;
        let turn_step = 1_000 * (u32::from(case.turn_step) % 3_142);
        let unicycle = Unicycle::new(turn_step, sharpest, speeds, step);
        unicycle.ok().and_then(|it| run(&case, it, &world))
    };
});
