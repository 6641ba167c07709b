//! The dearest plans of random missions: of any vehicle, by any algorithm, in any area, with any labels.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use host_sim::mission::definition::Mission;
use rayon::prelude::*;
use tests::anything::draw::draw;
use tests::anything::flight;
use tests::anything::{asked_for, kind};
use tests::lakes;
use tests::{cases, is_long};

use super::timing::{Flight, fly};
use crate::emulator::Core;

/// The bound of every plan, whoever plans, whatever drives and wherever: instructions of a Cortex-M4.
pub const BOUND: u64 = 20_000_000;

/// Labels of a random mission at most, and what the program `vehicles` has room for, the given samples included.
const LABELS: u32 = 32;
const SAMPLES: u32 = 36;

/// The missions of which a long run found the dearest plans.
const HARDEST: [u64; 4] = [339, 5550, 7052, 8678];

/// Those in lakes.
const IN_LAKES: [u64; 2] = [10, 44];

/// The dearest plans of random missions: what they take, which mission each is of, and what flies and plans there. A long
/// run seeks them among 20,000 missions by what their plans ask of the area, and flies 100 of these.
pub fn dearest(elf: &[u8]) -> Vec<(u64, u64, String)> {
    let numbers: Vec<u64> = if is_long() {
        asking(cases(8, 20_000), cases(8, 100) as usize)
    } else {
        asked_for(8).chain(HARDEST).collect()
    };
    let mut plans = Vec::new();
    for Flight { number, plans: made, .. } in fly(Core::M4F, elf, &numbers, random, None) {
        let Mission { algorithm, vehicle, noise, asking, .. } = random(number);
        let labels = if noise.is_some() { "doubtful" } else { "true" };
        let price = asking.price.map_or("", |_| ", a price");
        let of = format!("{} by {algorithm:?}, {labels} labels{price}", kind(&vehicle));
        plans.extend(made.iter().map(|it| (it.instructions, number, of.clone())));
    }
    plans.sort_unstable_by_key(|it| (Reverse(it.0), it.1));
    plans
}

/// The dearest plans on 128 x 128 cells, as [`dearest`] says them: in lakes from maps, and on charts that are made up.
pub fn in_lakes(elf: &[u8]) -> Vec<(u64, u64, String)> {
    let numbers: Vec<u64> =
        IN_LAKES.into_iter().chain((0..cases(6, 720)).map(|it| 7 * it)).collect();
    let mission = |number| match number % 2 {
        0 => lakes::for_a_chip(number / 2, 128, 24),
        _ => lakes::made_up(number / 2, 128, 10),
    };
    let mut plans = Vec::new();
    for Flight { number, plans: made, .. } in fly(Core::M4F, elf, &numbers, mission, None) {
        let Mission { algorithm, vehicle, noise, .. } = mission(number);
        let labels = if noise.is_some() { "doubtful" } else { "true" };
        let of = format!("{} by {algorithm:?}, {labels} labels", kind(&vehicle));
        plans.extend(made.iter().map(|it| (it.instructions, number, of.clone())));
    }
    plans.sort_unstable_by_key(|it| (Reverse(it.0), it.1));
    plans
}

/// The most of each kind.
pub fn by_kind(plans: &[(u64, u64, String)]) -> BTreeMap<&str, (u64, u64)> {
    let mut most = BTreeMap::new();
    for (instructions, number, of) in plans {
        let most = most.entry(&**of).or_insert((*instructions, *number));
        *most = (*most).max((*instructions, *number));
    }
    most
}

/// A random mission as the program `vehicles` has room for it: it has no code for labels on the way.
fn random(number: u64) -> Mission {
    const SEED: u64 = 21;
    let mission = draw(SEED, number);
    let steps = LABELS.min(SAMPLES - mission.given.samples().len() as u32);
    Mission { steps, readings: 1, ..mission }
}

/// The missions whose plans ask their area the most, among so many that are flown here.
fn asking(among: u64, count: usize) -> Vec<u64> {
    let asked = |number| {
        let mission = random(number);
        (flight::fly(&mission, mission.vehicle, u64::MAX).asked, number)
    };
    let mut ranked: Vec<_> = asked_for(among).into_par_iter().map(asked).collect();
    ranked.sort_unstable_by_key(|it| (Reverse(it.0), it.1));
    ranked.into_iter().take(count).map(|it| it.1).collect()
}
