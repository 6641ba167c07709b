//! The full-horizon problems against brute force: every sequence of motions, one after the other.
//!
//! The twin shares no code with the solver but the vehicle's motions, which have twins of their own. The least slope is
//! that of a linear program, by its vertices; the greatest margin that of the directions in which two samples lie from
//! each other, or across.

#![allow(clippy::float_cmp)] // sides are exactly 1 and -1, and costs of standing still whole numbers

use std::f64::consts::FRAC_PI_2;

use host_sim::campaign::standard_field::standard;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::reference::instance::Instance;
use host_sim::reference::objective::LineCost;
use host_sim::reference::optimum::solve;
use host_sim::reference::solution::Solution;
use host_sim::world::noise::{Extent, NoiseModel};
use planner_core::dynamics::{Action, Dynamics as _, room_for_errors};
use planner_core::{AnyVehicle, Boat, Car, CarShape, Pose, Unicycle, Workspace as _};
use tests::{cases, is_long};

/// A sample: where, and on which side.
type Dot = (f64, f64, f64);

/// The least `slope^2 / 2` of lines that have each sample so far above or below; infinite if there is none. `up` is +1
/// if the label +1 is above.
fn least_slope(dots: &[Dot], up: f64, off: f64) -> f64 {
    // Where an intercept meets its end: at z - off - slope x.
    let ends: Vec<_> = dots.iter().map(|&(x, z, y)| (x, z - y * up * off, y * up)).collect();
    let fits = |slope: f64| {
        let of = |side: f64| {
            ends.iter().filter(move |end| end.2 == side).map(move |(x, z, _)| z - slope * x)
        };
        let (top, bottom) = (of(1.0).fold(f64::MAX, f64::min), of(-1.0).fold(f64::MIN, f64::max));
        bottom <= top + 1e-9
    };
    let mut slopes = vec![0.0];
    for (i, a) in ends.iter().enumerate() {
        slopes.extend(ends[..i].iter().filter(|b| a.0 != b.0).map(|b| (a.1 - b.1) / (a.0 - b.0)));
    }
    let least = slopes.into_iter().filter(|slope| fits(*slope)).map(f64::abs);
    least.fold(f64::INFINITY, f64::min).powi(2) / 2.0
}

/// `1 / (2 margin^2)` of the line furthest from the samples.
fn least_margin_cost(dots: &[Dot]) -> f64 {
    let mut best = 0.0_f64;
    for (i, a) in dots.iter().enumerate() {
        for b in &dots[..i] {
            let (x, z) = (a.0 - b.0, a.1 - b.1);
            let length = x.hypot(z);
            if length == 0.0 {
                continue; // it stood still
            }
            let across =
                if a.2 == b.2 { (-z / length, x / length) } else { (x / length, z / length) };
            for sign in [1.0, -1.0] {
                let of = |side: f64| {
                    dots.iter()
                        .filter(move |dot| dot.2 == side)
                        .map(move |dot| sign * (across.0 * dot.0 + across.1 * dot.1))
                };
                let gap = of(1.0).fold(f64::MAX, f64::min) - of(-1.0).fold(f64::MIN, f64::max);
                best = if gap > best { gap } else { best };
            }
        }
    }
    2.0 / best.powi(2)
}

/// What a sequence costs by Section II-A, from its ends; infinite if a constraint is broken.
fn cost_of(mission: &Mission, ends: &[(f64, f64)], control: f64, line: LineCost) -> f64 {
    let [a, b, c] = mission.world.line().expect("a line").coefficients();
    let label = |x: f64, z: f64| (a * x + b * z + c).signum();
    let metres = |it: i32| f64::from(it) / 65_536.0;
    let site = mission.start.site;
    let mut sum = label(metres(site.x()), metres(site.z()));
    let given = mission.given.samples().iter();
    let mut dots: Vec<Dot> = given
        .map(|it| (metres(it.site.x()), metres(it.site.z()), f64::from(it.label.sign())))
        .collect();
    for &(x, z) in ends {
        let y = label(x, z);
        sum += y;
        dots.push((x, z, y));
    }
    if sum.abs() > 1.0 {
        return f64::INFINITY;
    }
    control
        + match line {
            LineCost::Slope => least_slope(&dots, b.signum(), 1.0),
            LineCost::Margin => least_margin_cost(&dots),
        }
}

fn instance(mission: &Mission, horizon: u32, line: Option<LineCost>) -> Instance {
    Instance::new(mission.clone(), horizon, line).expect("a good instance")
}

/// The cheapest sequence of all, and of those that cost the same to 10^-9 the first, by the dynamics' own positions.
fn first_of_all(
    mission: &Mission,
    cost: impl Fn(&[Pose], &[Action]) -> f64,
) -> Option<(f64, Vec<Action>)> {
    let (vehicle, area) = (mission.vehicle, mission.config.area);
    let actions = vehicle.grid().actions() as u32;
    let mut sequences = vec![(Vec::new(), Vec::new())];
    for _ in 0..mission.steps {
        let mut longer = Vec::new();
        for (poses, taken) in &sequences {
            let from = poses.last().copied().unwrap_or(mission.start);
            for action in (0..actions).map(Action) {
                if let Some(to) = vehicle.target(from, action)
                    && area.contains(to.site)
                    && vehicle.keeps_inside(from, to, &area, room_for_errors(&area))
                {
                    longer.push((
                        [poses.as_slice(), &[to]].concat(),
                        [taken.as_slice(), &[action]].concat(),
                    ));
                }
            }
        }
        sequences = longer;
    }
    let costs: Vec<_> = sequences.iter().map(|(poses, taken)| cost(poses, taken)).collect();
    let least = costs.iter().copied().fold(f64::INFINITY, f64::min);
    let first =
        costs.iter().position(|cost| *cost <= least + 1e-9).filter(|_| least.is_finite())?;
    Some((least, sequences[first].1.clone()))
}

fn control(mission: &Mission, actions: &[Action]) -> f64 {
    let squares = actions.iter().map(|action| {
        let control = mission.vehicle.control(mission.start, *action);
        f64::from(control.distance_m).powi(2) + f64::from(control.turn_rad).powi(2)
    });
    squares.sum()
}

fn ends(poses: &[Pose]) -> Vec<(f64, f64)> {
    let metres = |it: i32| f64::from(it) / 65_536.0;
    poses.iter().map(|pose| (metres(pose.site.x()), metres(pose.site.z()))).collect()
}

/// Unicycles, of which the first can turn by quarters, a boat and a car.
fn vehicles() -> [AnyVehicle; 4] {
    let steps = |turn_urad, sharpest, reach_mm| {
        Unicycle::new(turn_urad, sharpest, 3, reach_mm).expect("a grid")
    };
    let shape = CarShape {
        radius_mm: 1200,
        shortest_mm: 1000,
        turn_step_urad: 250_000,
        speeds: 3,
        speed_step_mm: 1000,
    };
    [
        AnyVehicle::Unicycle(steps(600_000, FRAC_PI_2, 1000)),
        AnyVehicle::Unicycle(steps(500_000, 1.2, 1200)),
        AnyVehicle::Boat(Boat::new(steps(500_000, 0.8, 1200)).expect("a boat")),
        AnyVehicle::Car(Car::new(shape).expect("a car")),
    ]
}

/// The paper's example and standard fields: the optimum is the first of the cheapest.
#[test]
fn of_equals_the_first_is_found_with_any_vehicle() {
    let paper = scenario::parse("", scenario::PAPER_NOISELESS, Overrides::default()).expect("good");
    for vehicle in vehicles() {
        let mut found = 0;
        for number in 0..cases(8, 40) {
            let horizon = if number % 4 == 0 { 4 } else { 3 };
            let line = if number % 3 == 0 { LineCost::Margin } else { LineCost::Slope };
            let field =
                if number == 1 { paper.clone() } else { standard(2, number, Algorithm::Cfc, 1) };
            let field = Mission { vehicle, steps: horizon, ..field };
            if vehicle.grid().actions().pow(horizon) > cases(20_000, 100_000) {
                continue;
            }
            let expected = first_of_all(&field, |poses, actions| {
                cost_of(&field, &ends(poses), control(&field, actions), line)
            });
            let solved = solve(&instance(&field, horizon, Some(line))).expect("it ends");
            let solved = solved.map(|it| (it.cost, it.actions));
            let context = format!("{vehicle:?}, field {number}: {solved:?}, expected {expected:?}");
            found += u32::from(expected.is_some());
            assert_eq!(solved.is_some(), expected.is_some(), "{context}");
            if let Some(((cost, actions), (own, taken))) = expected.zip(solved) {
                assert!((cost - own).abs() < 1e-5 && taken == actions, "{context}");
            }
        }
        assert!(found >= cases(1, 5) as u32, "{vehicle:?}: {found} fields have an optimum");
    }
}

#[test]
fn labels_that_may_be_wrong_are_best_left_alone() {
    for (k, vehicle) in vehicles().into_iter().enumerate() {
        for number in 0..6 {
            let noise = NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.0) };
            let field = standard(3, number, Algorithm::Scc, 2);
            let field = Mission { vehicle, noise: Some(noise), ..field };
            let [a, b, c] = field.world.line().expect("a line").coefficients();
            let expected = first_of_all(&field, |poses, actions| {
                let at = ends(&[&[field.start], poses].concat());
                let agreeing = at.iter().filter(|(x, z)| a * x + b * z + c != 0.0).count();
                control(&field, actions) - agreeing as f64
            });
            let (cost, actions) = expected.expect("it can go somewhere");
            let solved = solve(&instance(&field, 2, None)).expect("it ends").expect("as before");
            assert!((solved.cost - cost).abs() < 1e-5, "{vehicle:?}: {}, {cost}", solved.cost);
            assert_eq!(solved.actions, actions, "{vehicle:?}");
            // A unicycle can stand still.
            assert_eq!(solved.cost == -3.0, k < 2, "{vehicle:?}: {}", solved.cost);
        }
    }
}

#[test]
fn the_optimum_does_not_depend_on_how_work_is_shared_out() {
    let paper = scenario::parse("", scenario::PAPER_NOISELESS, Overrides::default()).expect("good");
    let paper = instance(&Mission { vehicle: vehicles()[0], ..paper }, 5, None);
    let [alone, shared] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| solve(&paper)).expect("it ends")
    });
    assert!(alone.is_some() && alone == shared);
}

/// No planner that keeps the constraints pays less than the optimum. Where there is none, none keeps them.
#[test]
fn no_planner_pays_less_than_the_optimum() {
    let vehicle = AnyVehicle::Unicycle(Unicycle::new(300_000, FRAC_PI_2, 5, 500).expect("a grid"));
    for line in [LineCost::Slope, LineCost::Margin] {
        for horizon in 3..=(if is_long() { 5 } else { 4 }) {
            let (mut solved, mut kept) = (0, 0);
            for number in 0..cases(4, 100) {
                let field = standard(1, number, Algorithm::Cfc, horizon);
                let field = instance(&Mission { vehicle, ..field }, horizon, Some(line));
                let solution = Solution::of(field).expect("it ends");
                let is_solved = solution.optimum.is_some();
                for account in &solution.accounts {
                    let keeps = account.broken.is_empty();
                    assert!(!keeps || is_solved, "field {number}: {account:?}");
                    assert!(
                        account.above.unwrap_or_default() >= 0.0,
                        "field {number}: {account:?}"
                    );
                    kept += u32::from(account.above.is_some());
                }
                solved += u32::from(is_solved);
            }
            assert!(kept > solved, "{line:?}, {horizon}: nothing was compared");
        }
    }
}
