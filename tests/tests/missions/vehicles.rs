//! Vehicles that cannot turn on the spot: whole missions, each of which must end for a true reason.

use std::collections::{BTreeMap, HashSet, VecDeque};
use std::f64::consts::{PI, TAU};
use std::fmt::Debug;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::CAPACITY;
use host_sim::mission::results::Ending;
use host_sim::world::noise::{Extent, NoiseModel};
use host_sim::world::reading;
use nalgebra::{Point2, Vector2};
use planner_core::dynamics::Dynamics;
use planner_core::motion::car::Shape;
use planner_core::motion::contract;
use planner_core::{
    AnyVehicle, Area, Boat, Car, Certainty, Cfc, Heading, Label, Line, Lookahead, Plan, Planner,
    Pose, Reading, Sample, Site, StopReason, Unicycle, VersionSpace, Workspace as _,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

/// Labels beside the four given, at most.
const LABELS: usize = 24;

/// Where a mission is flown.
struct Field {
    area: Area,
    /// Breadth and height, metres.
    size: [f64; 2],
    start: Pose,
    given: VersionSpace<CAPACITY>,
    truth: Line,
}

fn site(p: Point2<f64>) -> Site {
    Site::try_from(p).expect("near")
}

/// The standard field with this number.
fn pool(number: u64) -> Field {
    let mission = standard_field::standard(31, number, Algorithm::Cfc, 1);
    let truth = *mission.world.line().expect("a line");
    let (area, start, given) = (mission.config.area.bounds(), mission.start, mission.lines());
    Field { area, size: [standard_field::SIDE_M; 2], start, given, truth }
}

/// A field of 800 m x 500 m, drawn as the standard ones are.
fn lake(number: u64) -> Field {
    let mut rng = ChaCha8Rng::seed_from_u64(32);
    rng.set_stream(number);
    let size = [800.0, 500.0];
    let area = Area::new(Site::ORIGIN, site(Point2::from(size))).expect("an area");
    let inside = |p: &Point2<f64>| (0.0..=800.0).contains(&p.x) && (0.0..=500.0).contains(&p.y);
    loop {
        let middle = Point2::new(rng.random_range(240.0..560.0), rng.random_range(150.0..350.0));
        let unit = |angle: f64| Vector2::new(angle.cos(), angle.sin());
        let along = unit(rng.random_range(0.0..TAU));
        let left = Vector2::new(-along.y, along.x);
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(end, side)| {
            let (run, off) = (rng.random_range(75.0..200.0), rng.random_range(37.0..125.0));
            (middle + along * (end * run) + left * (side * off), side > 0.0)
        });
        let oracle = corners.map(|(p, above)| {
            let label = if above { Label::Positive } else { Label::Negative };
            Sample { site: site(p), label }
        });
        let heading = Heading(rng.random());
        if !corners.iter().all(|(p, _)| inside(p)) {
            continue;
        }
        let agrees =
            |line: &Line| oracle.iter().all(|s| reading(line, s.site) == Reading::Side(s.label));
        let truth = (0..100_000).find_map(|_| {
            let normal = unit(rng.random_range(0.0..TAU));
            let point = Point2::new(400.0, 250.0) + normal * rng.random_range(-475.0..475.0);
            Line::through(point, normal).filter(agrees)
        });
        if let (Some(truth), Ok(given)) = (truth, VersionSpace::new(&oracle)) {
            return Field {
                area,
                size,
                start: Pose { site: oracle[0].site, heading },
                given,
                truth,
            };
        }
    }
}

/// How a mission went.
struct Flown {
    end: Option<StopReason>,
    labels: usize,
    motions: u32,
    error_deg: f64,
    is_false: bool,
}

fn slope_error(line: &Line, truth: &Line) -> f64 {
    let off = (line.angle_deg() - truth.angle_deg()).rem_euclid(180.0);
    off.min(180.0 - off)
}

fn fly<D: Dynamics + Copy + Debug>(
    field: &Field,
    dynamics: D,
    radius_m: f64,
    algorithm: Algorithm,
) -> Flown {
    let (area, given) = (field.area, field.given.clone());
    if algorithm == Algorithm::Cfc {
        let planner = Cfc::new(area, dynamics, given);
        fly_by(field, dynamics, radius_m, planner.expect("settings that agree"))
    } else {
        let planner = Lookahead::new(area, dynamics, given);
        fly_by(field, dynamics, radius_m, planner.expect("settings that agree"))
    }
}

fn fly_by<D: Dynamics + Copy + Debug>(
    field: &Field,
    dynamics: D,
    radius_m: f64,
    mut planner: impl Planner<Belief = VersionSpace<CAPACITY>>,
) -> Flown {
    let (mut pose, mut motions, mut labels, mut been) = (field.start, 0, 0, HashSet::new());
    let was_safe = |pose| dynamics.is_safe(pose, &field.area);
    let end = loop {
        if labels == LABELS {
            break None;
        }
        let motion = match planner.plan(pose) {
            Plan::Stop(reason) => break Some(reason),
            Plan::Move(motion) => motion,
        };
        assert!(been.insert((pose.site, pose.heading.0)), "it moves for ever, from {pose:?}");
        assert_eq!(dynamics.target(pose, motion.action), Some(motion.target));
        assert!(stays_inside(&dynamics, field.size, pose, motion.target), "{pose:?}: {motion:?}");
        assert!(was_safe(motion.target) || !was_safe(pose), "it gives up where it is safe");
        pose = motion.target;
        motions += 1;
        let label = motion.wants_label.then(|| reading(&field.truth, pose.site));
        if label.is_some() {
            (labels, been) = (labels + 1, HashSet::new());
        }
        planner.observe(pose, label).expect("labels are true");
    };
    let is_false = end.is_some_and(|reason| {
        contradicts(&dynamics, field, planner.belief(), radius_m, pose, reason)
    });
    let centre = planner.estimates().centre.map(Line::from);
    let error_deg = centre.map_or(90.0, |line| slope_error(&line, &field.truth));
    Flown { end, labels, motions, error_deg, is_false }
}

/// Whether all of a motion is inside the area: an arc about the centre that its ends have, point by point.
fn stays_inside<D: Dynamics>(dynamics: &D, size: [f64; 2], from: Pose, to: Pose) -> bool {
    let [a, b] = [from, to].map(|pose| Point2::<f64>::from(pose.site));
    let inside = |p: Point2<f64>| {
        [p.x, p.y].into_iter().zip(size).all(|(at, most)| (-1e-4..=most + 1e-4).contains(&at))
    };
    let turn = f64::from(to.heading.0.wrapping_sub(from.heading.0) as i32) / 2f64.powi(32) * TAU;
    if turn == 0.0 || dynamics.tangent_intersection(from, to).is_none() {
        return inside(b);
    }
    let radius = (b - a).norm() / (2.0 * (turn / 2.0).sin());
    let heading = from.heading.radians();
    (1..=16).all(|k| {
        let at = heading + turn * f64::from(k) / 16.0;
        inside(a + Vector2::new(at.sin() - heading.sin(), heading.cos() - at.cos()) * radius)
    })
}

/// Whether a vehicle could go on after all, found by trying. The test drives from the end of the mission to every pose
/// within some motions, by a share of all actions. Of poses that are alike (a small square and few degrees) it keeps
/// one. From each pose it tries every action. It looks for labels that can be asked in a pose that is safe with a
/// circle of 1.1 times the turning radius. One such label contradicts "cornered" and "undecided", and more than a few
/// contradict "resolution".
fn contradicts<D: Dynamics>(
    dynamics: &D,
    field: &Field,
    belief: &VersionSpace<CAPACITY>,
    radius_m: f64,
    from: Pose,
    reason: StopReason,
) -> bool {
    const POSES: usize = 4_000;
    let is_hemmed_in = matches!(reason, StopReason::Cornered | StopReason::Undecided);
    if !is_hemmed_in && reason != StopReason::Resolution {
        return true;
    }
    let grid = dynamics.grid();
    let side = f64::max(radius_m, f64::from(grid.reach_m(grid.speeds() - 1))) / 4.0;
    let alike = |pose: Pose| {
        let p = Point2::<f64>::from(pose.site);
        let turn = pose.heading.radians() / TAU * 48.0;
        [p.x / side, p.y / side, turn].map(|at| at.floor() as i64)
    };
    let is_safe = |pose: Pose| {
        let p = Point2::<f64>::from(pose.site);
        let (sin, cos) = pose.heading.radians().sin_cos();
        [1.0, -1.0].into_iter().any(|left| {
            let centre = p + Vector2::new(-sin, cos) * (left * radius_m * 1.1);
            let room = [centre.x, centre.y].into_iter().zip(field.size);
            room.into_iter().all(|(at, most)| at.min(most - at) >= 1.1 * radius_m)
        })
    };
    let (mut seen, mut queue) = (HashSet::from([alike(from)]), VecDeque::from([from]));
    let (mut asked, mut hits) = (0_u64, 0_u64);
    while let Some(pose) = queue.pop_front() {
        for ray in dynamics.rays(pose).step_by(dynamics.grid().rays() as usize / 40 + 1) {
            for speed in 1..grid.speeds() {
                let Some(target) = dynamics.target(pose, grid.action(ray.index, speed)) else {
                    continue;
                };
                // As the vehicle may: the triangle about an arc stays inside, not the arc alone.
                if !field.area.contains(target.site)
                    || !dynamics.stays_inside(pose, target, &field.area)
                {
                    continue;
                }
                asked += 1;
                let is_uncertain = belief.lines().certainty(target.site) == Certainty::Uncertain;
                hits += u64::from(is_uncertain && is_safe(target));
                // Standing safe is a way on too where it was not.
                if is_hemmed_in && hits > 0 {
                    return true;
                }
                if seen.len() < POSES && seen.insert(alike(target)) {
                    queue.push_back(target);
                }
            }
        }
    }
    // What is thinner than the grid can hit is hit by chance if one tries hundreds of thousands of times.
    reason == StopReason::Resolution && hits > asked / 1_000
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Flies missions on one kind of field; what they came to in a line, and the number of those that ended by a reason
/// that is not true.
fn campaign<D: Dynamics + Copy + Debug + Sync>(
    name: &str,
    field: fn(u64) -> Field,
    dynamics: D,
    radius_m: f64,
) -> usize {
    contract::check(&dynamics).expect("a vehicle of ours");
    let mut all_false = 0;
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        let flown: Vec<_> = (0..cases(100, 1_000))
            .into_par_iter()
            .map(|number| (number, fly(&field(number), dynamics, radius_m, algorithm)))
            .collect();
        let mut ends = BTreeMap::new();
        for (number, it) in &flown {
            let at_once = if it.motions == 0 { " at the start" } else { "" };
            let end = it.end.map_or("Labels".into(), |end| format!("{end:?}{at_once}"));
            *ends.entry(end).or_insert(0) += 1;
            if it.is_false {
                println!(
                    "  {name}, {algorithm:?}, field {number}: {:?} is false, after {} labels",
                    it.end, it.labels
                );
            }
        }
        let went_on: Vec<_> = flown.iter().filter(|(_, it)| it.labels > 0).collect();
        let motions: u32 = went_on.iter().map(|(_, it)| it.motions).sum();
        let labels: usize = went_on.iter().map(|(_, it)| it.labels).sum();
        let error = median(went_on.iter().map(|(_, it)| it.error_deg).collect());
        let wrong = flown.iter().filter(|(_, it)| it.is_false).count();
        println!(
            "{name}, {algorithm:?}: {ends:?}, {wrong} false; slope error {error:.4} deg; {:.2} motions a label",
            f64::from(motions) / labels as f64
        );
        all_false += wrong;
    }
    all_false
}

/// A car of this radius with rays 10 mrad apart.
fn car(radius_mm: u32, reach_mm: u32) -> Car {
    let (speeds, speed_step_mm) = (21, reach_mm / 20);
    let shape =
        Shape { radius_mm, shortest_mm: 500, turn_step_urad: 10_000, speeds, speed_step_mm };
    Car::new(shape).expect("a car")
}

fn unicycle(reach_mm: u32) -> Unicycle {
    Unicycle::new(10_000, PI / 2.0, 21, reach_mm / 20).expect("a grid")
}

fn boat(reach_mm: u32) -> Boat {
    let steps = Unicycle::new(10_000, 20f64.to_radians(), 21, reach_mm / 20).expect("a grid");
    Boat::new(steps).expect("a boat")
}

#[test]
fn no_mission_in_a_pool_ends_by_a_false_reason() {
    campaign("pool, unicycle", pool, unicycle(2_000), 0.0);
    let mut wrong = 0;
    for radius_mm in [1_000, 3_000, 5_000] {
        let name = format!("pool, car of {radius_mm} mm");
        let radius_m = f64::from(radius_mm) / 1000.0;
        wrong += campaign(&name, pool, car(radius_mm, 2_000), radius_m);
    }
    wrong += campaign("pool, boat", pool, boat(2_000), 0.3);
    assert_eq!(wrong, 0);
}

#[test]
fn no_mission_on_a_lake_ends_by_a_false_reason() {
    let mut wrong = 0;
    for reach_mm in [20_000, 80_000] {
        campaign(&format!("lake, unicycle, {reach_mm} mm"), lake, unicycle(reach_mm), 0.0);
        for radius_mm in [1_000, 3_000, 5_000] {
            let name = format!("lake, car of {radius_mm} mm, {reach_mm} mm");
            let radius_m = f64::from(radius_mm) / 1000.0;
            wrong += campaign(&name, lake, car(radius_mm, reach_mm), radius_m);
        }
        let name = format!("lake, boat, {reach_mm} mm");
        wrong += campaign(&name, lake, boat(reach_mm), f64::from(reach_mm) / 20_000.0 * 2.9);
    }
    assert_eq!(wrong, 0);
}

/// Rays 1 urad apart, and Algorithm 2 and look-ahead in noise: no motion leaves the area, each ends where the vehicle
/// can go on, and none ends but at the start, where it could not.
#[test]
fn every_algorithm_keeps_a_vehicle_inside_with_the_fine_fan_too() {
    let missions = (0..cases(32, 400)).into_par_iter().map(|number| {
        let (is_fine, is_car) = (number % 2 == 0, number / 2 % 2 == 0);
        let (algorithm, is_noisy) = [
            (Algorithm::Cfc, false),
            (Algorithm::Scc, true),
            (Algorithm::Lookahead, false),
            (Algorithm::Lookahead, true),
        ][number as usize / 4 % 4];
        let mut mission = standard_field::standard(33, number, algorithm, 12);
        let turn_step_urad = if is_fine { 1 } else { 10_000 };
        mission.vehicle = if is_car {
            let shape = Shape { turn_step_urad, ..car(2_000, 2_000).shape() };
            AnyVehicle::Car(Car::new(shape).expect("a car"))
        } else {
            let steps = Unicycle::new(turn_step_urad, 20f64.to_radians(), 21, 100);
            AnyVehicle::Boat(steps.and_then(Boat::new).expect("a boat"))
        };
        if is_noisy {
            mission.noise = Some(NoiseModel { p: 0.8, extent: Extent::OutsideBalls(0.5) });
        }
        let (vehicle, area) = (mission.vehicle, mission.config.area);
        let (mut pose, mut steps) = (mission.start, 0);
        let flown = mission.fly(|step, _| {
            assert!(stays_inside(&vehicle, [standard_field::SIDE_M; 2], pose, step.pose));
            assert!(vehicle.is_safe(step.pose, &area) || !vehicle.is_safe(pose, &area));
            (pose, steps) = (step.pose, steps + 1);
        });
        let ending = flown.expect("labels that are certain are true").ending;
        assert!(ending == Ending::Steps || steps == 0, "mission {number}: {ending:?}");
        steps
    });
    let flown = missions.filter(|steps| *steps == 12).count() as u64;
    println!("{flown} of {} missions made all their steps", cases(32, 400));
    assert!(flown > cases(32, 400) * 9 / 10);
}
