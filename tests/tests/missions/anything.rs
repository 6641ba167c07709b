//! Missions with random settings satisfy every property that any mission must have.
//!
//! `cargo test` flies 100 of the first kind, a long run 20,000. A finding names its mission, which flies again by
//!
//! ```sh
//! FROM=17 COUNT=1 cargo test -p tests anything:: -- --nocapture
//! ```
//!
//! `SEED=3` draws others.

use std::panic::catch_unwind;

use host_sim::mission::definition::Mission;
use host_sim::mission::results::Ending;
use planner_core::dynamics::Dynamics as _;
use planner_core::{AnyVehicle, Holonomic, Policy, StopReason, Unicycle};
use rayon::prelude::*;
use tests::anything::asked_for;
use tests::anything::draw::draw;
use tests::anything::fields::{draw_coarse, draw_nothing, draw_vehicle};
use tests::anything::flight::{Finding, Flight, fly};
use tests::anything::fronts::draw_front;
use tests::anything::plain::Ground;
use tests::missions::of_any_vehicle;
use tests::{cases, seed};

const SEED: u64 = 21;

/// What a plan asks of its area at most, in corners of keep-outs. On a chip
/// `no_plan_of_any_mission_passes_the_bound` counts instructions.
const MOST_ASKED: u64 = 1_500_000;

/// Of 1,000 missions so many may end for a reason that a brute force refutes: it finds a way that the planner does not.
const FALSE_REASONS: usize = 15;

/// The same on coarse grids, where few sequences of motions lead anywhere.
const FALSE_ON_COARSE: usize = 40;

#[test]
fn random_missions_keep_every_invariant() {
    check(|number| drawn(seed(SEED), number), [100, 20_000], FALSE_REASONS);
}

/// No looks were left for a way or a drive drawn at random.
#[test]
fn ways_that_are_hard_to_find_are_found() {
    for number in [166, 484, 708, 716] {
        let (mission, _) = drawn(SEED, number);
        let Flight { findings, .. } = fly(&mission, mission.vehicle, MOST_ASKED);
        assert!(findings.is_empty(), "{number}: {findings:?}");
    }
}

/// Along fronts of every kind, also where there is none. A sixth of the vehicles can drive anywhere.
#[test]
fn random_missions_along_fronts_keep_every_invariant() {
    let draw = |number: u64| sixth_holonomic(draw_front(seed(SEED), number), number);
    check(draw, [50, 5_000], FALSE_REASONS);
}

/// The search from nothing comes to an end, and it lends labels that go together.
#[test]
fn random_searches_from_nothing_keep_every_invariant() {
    let draw = |number: u64| sixth_holonomic(draw_nothing(seed(SEED), number), number);
    let flown = check(draw, [40, 2_000], FALSE_REASONS);
    let is_settled =
        |ending| [StopReason::Known, StopReason::OneLabel].map(Ending::Stopped).contains(&ending);
    // Some cars and boats are cornered where they start.
    let open = flown.iter().filter(|it| it.1.motions > 0 && !is_settled(it.1.ending)).count();
    assert!(open <= 1 + flown.len() / 5, "{open} are not settled");
}

/// Robots that err, whatever they drive, read where they truly are.
#[test]
fn missions_with_readings_on_the_way_keep_every_invariant() {
    let draw = |number| (Mission { readings: 6, ..of_any_vehicle(number, 16) }, None);
    check(draw, [60, 2_000], FALSE_REASONS);
}

#[test]
fn vehicles_that_cannot_turn_on_the_spot_keep_every_invariant() {
    check(|number| (draw_vehicle(seed(SEED), number), None), [144, 24_000], 0);
}

/// Rays half a radian and more apart once made the recovery ladder turn left, right, left.
#[test]
fn missions_on_coarse_grids_keep_every_invariant() {
    check(|number| draw_coarse(seed(SEED), number), [150, 10_000], FALSE_ON_COARSE);
}

/// A mission of the first kind.
fn drawn(seed: u64, number: u64) -> (Mission, Option<Holonomic>) {
    let policies = [Policy::Joint, Policy::MixtureOfStart, Policy::MixtureOfOwn];
    let policy = policies[number as usize % 3];
    (Mission { policy, ..draw(seed, number) }, None)
}

/// Every sixth mission has a vehicle that drives anywhere, as far as the one that was drawn.
fn sixth_holonomic(mission: Mission, number: u64) -> (Mission, Option<Holonomic>) {
    let grid = mission.vehicle.grid();
    let step_mm = (50.0 * grid.reach_m(grid.speeds() - 1)) as u32;
    let vehicle = Holonomic::new(720, 21, step_mm.clamp(1, 99_999)).expect("a vehicle");
    if number % 6 != 5 {
        return (mission, None);
    }
    // Its ways are straight, as those of a unicycle.
    let unicycle = AnyVehicle::Unicycle(Unicycle::default());
    (Mission { vehicle: unicycle, ..mission }, Some(vehicle))
}

type Flown = (u64, Flight, Mission);

fn check(
    draw: impl Fn(u64) -> (Mission, Option<Holonomic>) + Sync,
    [few, many]: [u64; 2],
    false_reasons: usize,
) -> Vec<Flown> {
    let numbers = asked_for(cases(few, many));
    let flown: Vec<Flown> = numbers
        .into_par_iter()
        .map(|number| {
            let (mission, holonomic) = draw(number);
            let flight = catch_unwind(|| match holonomic {
                Some(vehicle) => fly(&mission, vehicle, MOST_ASKED),
                None => fly(&mission, mission.vehicle, MOST_ASKED),
            });
            (number, flight.unwrap_or_else(|_| panic!("mission {number} panics")), mission)
        })
        .collect();
    let mut findings = Vec::new();
    for (number, flight, mission) in &flown {
        for (finding, text) in &flight.findings {
            let Mission { algorithm, vehicle, config, .. } = mission;
            let ground = Ground::of(&config.area);
            println!("{number}: {finding:?}, {text}\n{algorithm:?}, {vehicle:?}, {ground:?}\n");
            findings.push((*finding, *number));
        }
    }
    let (refuted, broken): (Vec<_>, Vec<_>) =
        findings.into_iter().partition(|(finding, _)| *finding == Finding::FalseReason);
    assert!(broken.is_empty(), "{broken:?}");
    let share = (flown.len() * false_reasons) as f64 / 1_000.0;
    // A part of the long run may by chance have more than its share, by two standard deviations.
    let is_part = (few + 1..many).contains(&(flown.len() as u64));
    let most = (share + if is_part { 2.0 * share.sqrt() } else { 0.0 }).ceil() as usize;
    assert!(refuted.len() <= most, "{refuted:?}");
    flown
}
