//! The recovery ladder to its end: whatever the grid, a mission goes on to a sample or stops.

use std::collections::{BTreeMap, HashMap};
use std::sync::Mutex;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::CAPACITY;
use nalgebra::Point2;
use planner_core::dynamics::Dynamics;
use planner_core::motion::contract;
use planner_core::{
    Area, Cfc, Heading, Holonomic, Label, Plan, Planner as _, Pose, Reading, Sample, Site,
    StopReason, Unicycle, VersionSpace, Workspace,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

fn at(x: f64, z: f64) -> Site {
    Site::try_from(Point2::new(x, z)).expect("near")
}

/// A pose came back twice before anything was learnt: the mission would go on for ever. Once it may, as a planner remembers
/// that it has driven far, and then takes another way back.
#[derive(Debug)]
struct Endless;

/// Follows the plans from a pose, learning nothing, up to the first that takes a sample: where that
/// is, or why there is none. And the motions made.
fn chase<D: Dynamics, G: Workspace>(
    planner: &mut Cfc<D, CAPACITY, G>,
    mut pose: Pose,
) -> Result<(Result<Pose, StopReason>, usize), Endless> {
    let (mut been, mut motions) = (HashMap::new(), 0);
    loop {
        motions += 1;
        let times = been.entry((pose.site, pose.heading.0)).or_insert(0);
        *times += 1;
        if *times > 2 {
            return Err(Endless);
        }
        match planner.plan(pose) {
            Plan::Stop(reason) => return Ok((Err(reason), motions)),
            Plan::Move(motion) if motion.wants_label => return Ok((Ok(motion.target), motions)),
            Plan::Move(motion) => {
                pose = motion.target;
                planner.observe(pose, None).expect("nothing was read");
            }
        }
    }
}

/// Rays half a radian and more apart once made the ladder turn left, right, left.
#[test]
fn a_coarse_fan_does_not_turn_on_the_spot_for_ever() {
    let sample = |x, z, label| Sample { site: at(x, z), label };
    let oracle = [
        sample(2.0, 4.0, Label::Negative),
        sample(2.0, 5.6, Label::Positive),
        sample(18.0, 12.0, Label::Positive),
        sample(18.0, 10.0, Label::Negative),
    ];
    let area = Area::metres([0.0, 0.0], [20.0, 20.0]).expect("an area");
    let space = VersionSpace::new(&oracle).expect("they are apart");
    let coarse = Unicycle::new(785_000, core::f64::consts::FRAC_PI_2, 11, 200).expect("a grid");
    let starts = (0..20).flat_map(|i| (0..20).flat_map(move |j| (0..16).map(move |k| (i, j, k))));
    let starts: Vec<_> = starts.collect();
    starts.par_iter().for_each(|&(i, j, k)| {
        let site = at(0.5 + f64::from(i), 0.5 + f64::from(j));
        let pose = Pose { site, heading: Heading(k << 28) };
        let mut planner = Cfc::new(area, coarse, space.clone()).expect("settings that agree");
        let (end, motions) = chase(&mut planner, pose).expect("it comes to an end");
        assert!(end.is_ok() && motions < 24, "from {pose:?}: {end:?} after {motions} motions");
    });
}

/// Any grid that the constructors take: coarse and fine, slow and quick to turn, centimetres to metres.
enum Any {
    Turning(Unicycle),
    Free(Holonomic),
}

fn any(rng: &mut ChaCha8Rng) -> Any {
    loop {
        let speeds = [2, 3, 5, 11, 21][rng.random_range(0..5)];
        let step_mm = [20, 100, 200, 1_000, 3_000][rng.random_range(0..5)];
        if rng.random_range(0..4) == 0 {
            if let Ok(it) = Holonomic::new(rng.random_range(1..40), speeds, step_mm) {
                return Any::Free(it);
            }
            continue;
        }
        let sharpest = match rng.random_range(0..4) {
            0 => rng.random_range(0.05..0.4),
            1 => core::f64::consts::FRAC_PI_2,
            2 => core::f64::consts::PI,
            _ => rng.random_range(0.05..core::f64::consts::PI),
        };
        let turn_step = rng.random_range(1..=(1000.0 * sharpest) as u32).max(10);
        if let Ok(it) = Unicycle::new(1_000 * turn_step, sharpest, speeds, step_mm) {
            return Any::Turning(it);
        }
    }
}

/// Flies a mission on some grid until it ends, at the latest when the buffer is full; why it ended.
fn fly<D: Dynamics>(dynamics: D, number: u64, rng: &mut ChaCha8Rng) -> StopReason {
    contract::check(&dynamics).expect("a grid of ours");
    let mission = standard_field::standard(21, number, Algorithm::Cfc, 1);
    let mut planner = mission.cfc(mission.config.area, dynamics);
    let mut pose = Pose { heading: Heading(rng.random_range(0..=u32::MAX)), ..mission.start };
    loop {
        let (end, _) = chase(&mut planner, pose).unwrap_or_else(|Endless| {
            panic!("mission {number}: it moves for ever, from {pose:?}");
        });
        pose = match end {
            Ok(pose) => pose,
            Err(reason) => return reason,
        };
        let label = mission.world.reading(pose.site);
        assert!(label != Reading::Boundary, "a line that goes through no site");
        planner.observe(pose, Some(label)).expect("labels are true");
    }
}

#[test]
fn missions_on_any_grid_come_to_an_end() {
    let ends = Mutex::new(BTreeMap::new());
    (0..cases(400, 10_000)).into_par_iter().for_each(|number| {
        let mut rng = ChaCha8Rng::seed_from_u64(number);
        let reason = match any(&mut rng) {
            Any::Turning(unicycle) => fly(unicycle, number, &mut rng),
            Any::Free(holonomic) => fly(holonomic, number, &mut rng),
        };
        *ends.lock().expect("no panic").entry(format!("{reason:?}")).or_insert(0) += 1;
    });
    println!("{:?}", ends.into_inner().expect("no panic"));
}
