//! Missions with random settings satisfy every property that any mission must have.
//!
//! `cargo test` flies 400 of them, a long run 20,000. A finding names its mission, which flies again by
//!
//! ```sh
//! FROM=17 COUNT=1 cargo test -p tests anything:: -- --nocapture
//! ```

use std::collections::BTreeMap;
use std::panic::catch_unwind;

use host_sim::mission::definition::Mission;
use rayon::prelude::*;
use tests::anything::draw::draw;
use tests::anything::flight::{Finding, Flight, fly};
use tests::anything::fronts::draw_front;
use tests::anything::plain::Ground;
use tests::anything::{asked_for, kind};
use tests::cases;

const SEED: u64 = 21;

/// What a plan asks of its area at most, in corners of keep-outs. On a chip `anything_on_a_chip` counts instructions.
const MOST_ASKED: u64 = 1_500_000;

/// Of 1,000 missions so many may end for a reason that a brute force refutes: it finds a way that the planner does not.
const FALSE_REASONS: usize = 15;

#[test]
fn random_missions_keep_every_invariant() {
    check(draw, [400, 20_000]);
}

/// Along fronts of every kind, also where there is none.
#[test]
fn random_missions_along_fronts_keep_every_invariant() {
    check(draw_front, [100, 5_000]);
}

fn check(draw: impl Fn(u64, u64) -> Mission + Sync, [few, many]: [u64; 2]) {
    let numbers = asked_for(cases(few, many));
    let flown: Vec<_> = numbers
        .into_par_iter()
        .map(|number| {
            let mission = draw(SEED, number);
            let flight = catch_unwind(|| fly(&mission, MOST_ASKED));
            (number, flight.unwrap_or_else(|_| panic!("mission {number} panics")), mission)
        })
        .collect();
    let mut endings = BTreeMap::<_, u32>::new();
    for (_, flight, mission) in &flown {
        let ending = format!("{}: {:?}", kind(&mission.vehicle), flight.ending);
        *endings.entry(ending).or_default() += 1;
    }
    println!("{endings:#?}");
    let sum = |of: fn(&Flight) -> u32| flown.iter().map(|(_, flight, _)| of(flight)).sum::<u32>();
    let asked = flown.iter().map(|(number, flight, _)| (flight.asked, *number)).max();
    println!(
        "{} motions, {} labels; most asked: {asked:?}",
        sum(|it| it.motions),
        sum(|it| it.labels)
    );
    let mut findings = Vec::new();
    for (number, flight, mission) in &flown {
        for (finding, text) in &flight.findings {
            println!("{}{finding:?}: {text}\n", about(*number, mission));
            findings.push((*finding, *number));
        }
    }
    let (refuted, broken): (Vec<_>, Vec<_>) =
        findings.into_iter().partition(|(finding, _)| *finding == Finding::FalseReason);
    assert!(broken.is_empty(), "{broken:?}");
    let share = (flown.len() * FALSE_REASONS) as f64 / 1_000.0;
    // A part of the long run may by chance have more than its share, by two standard deviations.
    let is_part = (few + 1..many).contains(&(flown.len() as u64));
    let most = (share + if is_part { 2.0 * share.sqrt() } else { 0.0 }).ceil() as usize;
    println!("{} of {} end for a reason that is refuted", refuted.len(), flown.len());
    assert!(refuted.len() <= most, "{refuted:?}");
}

/// What a mission is, for one who looks into a finding.
fn about(number: u64, mission: &Mission) -> String {
    let Mission { algorithm, vehicle, errors, noise, goal, start, asking, .. } = mission;
    let tolerance = mission.config.tolerance.metres();
    format!(
        "mission {number}: {algorithm:?}, {vehicle:?}\n{:?}\nstart {start:?}, tolerance {tolerance}, {errors:?}, \
         {noise:?}, {goal:?}, {asking:?}\n",
        Ground::of(&mission.config.area)
    )
}
