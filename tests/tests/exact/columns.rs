//! The columns' chances, by which one looks ahead, against the exact table's.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::{Mission, Table};
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::Point2;
use planner_core::belief::predictions::Columns;
use planner_core::{Label, PosteriorView, Reliability, Sample, Site};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

/// How often labels are true.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Truth {
    Always(f64),
    /// Another probability for each label, certain ones included.
    Mixed,
}

const TRUTHS: [Truth; 7] = [
    Truth::Always(0.6),
    Truth::Always(0.7),
    Truth::Always(0.8),
    Truth::Always(0.9),
    Truth::Always(0.99),
    Truth::Always(0.9999),
    Truth::Mixed,
];

/// Who chooses the sites.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Walk {
    By(Algorithm),
    /// To a place at hand where the chance is about even, so that what is known narrows as fast as it can.
    ToEvenChance,
}

const WALKS: [Walk; 3] =
    [Walk::By(Algorithm::Scc), Walk::By(Algorithm::Random), Walk::ToEvenChance];

/// Numbers of labels after which chances are compared.
const MARKS: [usize; 4] = [5, 10, 20, 30];

/// How far an agent goes in a step.
const REACH_M: f64 = 2.0;

/// A site of the area within reach of another.
fn within_reach(rng: &mut ChaCha8Rng, of: Site) -> Site {
    let (area, of) = (standard_field::area(), Point2::<f64>::from(of));
    loop {
        let mut off = || rng.random_range(-REACH_M..REACH_M);
        let (x, z) = (off(), off());
        let site = Site::try_from(Point2::new(of.x + x, of.y + z)).expect("near");
        if x.hypot(z) < REACH_M && area.contains(site) {
            return site;
        }
    }
}

/// A site within reach of another where the share of the lines above is in a range, with that share; sought at
/// random and then between two sites on either side, however narrow the strip. `None` if there seems to be none.
fn undecided(
    rng: &mut ChaCha8Rng,
    table: &Table,
    of: Site,
    range: [f64; 2],
) -> Option<(Site, f64)> {
    let posterior = PosteriorView::new(table);
    let (mut low, mut high) = (None, None);
    for attempt in 0..70 {
        let site = match (low, high) {
            (Some(a), Some(b)) => between(a, b, rng.random_range(0.25..0.75)),
            _ if attempt < 40 => within_reach(rng, of),
            _ => return None,
        };
        let share = posterior.share_above(site);
        if share < range[0] {
            low = Some(site);
        } else if share > range[1] {
            high = Some(site);
        } else {
            return Some((site, share));
        }
    }
    None
}

fn between(a: Site, b: Site, part: f64) -> Site {
    let at = |a: i32, b: i32| a + (f64::from(b - a) * part) as i32;
    Site::new(at(a.x(), b.x()), at(a.z(), b.z())).expect("between sites")
}

/// A share of lines by the columns, and by the table.
#[derive(Clone, Copy, Debug)]
struct Compared {
    truth: Truth,
    labels: usize,
    /// Now, for 16, 24 and 32 directions.
    now: [f64; 3],
    /// After one more label, for 16.
    after: f64,
}

/// Columns of several numbers of directions beside a table.
struct Told {
    table: Table,
    believed: Vec<Reliability>,
    columns: (Columns<16>, Columns<24>, Columns<32>),
}

impl Told {
    fn take(&mut self, sample: Sample, reliability: Reliability) {
        self.table.take(sample, reliability).expect("room, and a possible label");
        self.believed.push(reliability);
    }

    fn lay(&mut self) {
        self.columns.0.lay(&self.table, &self.believed);
        self.columns.1.lay(&self.table, &self.believed);
        self.columns.2.lay(&self.table, &self.believed);
    }

    fn compare(
        &self,
        rng: &mut ChaCha8Rng,
        truth: Truth,
        labels: usize,
        at: Site,
    ) -> Vec<Compared> {
        let places = (0..8).filter_map(|_| undecided(rng, &self.table, at, [0.1, 0.9]));
        let places: Vec<_> = places.collect();
        let Some(&(first, _)) = places.first() else { return Vec::new() };
        // One more label of the first place, and what it comes to.
        let label = if labels.is_multiple_of(2) { Label::Positive } else { Label::Negative };
        let after = self.columns.0.after(self.columns.0.heights(first), label, 0.8);
        let mut next = self.table.clone();
        let reliability = Reliability::new(0.8).expect("a probability");
        next.take(Sample { site: first, label }, reliability).expect("room");
        let next = PosteriorView::new(&next);
        let compare = |&(site, exact): &(Site, f64)| {
            let off = |share: f32| (f64::from(share) - exact).abs();
            let (a, b, c) = &self.columns;
            let now = [a.share_above(site), b.share_above(site), c.share_above(site)].map(off);
            let after = (f64::from(after.share_above(site)) - next.share_above(site)).abs();
            Compared { truth, labels, now, after }
        };
        places.iter().map(compare).collect()
    }
}

/// Flies a mission of 30 labels and compares on the way.
fn fly(number: u64, truth: Truth, walk: Walk) -> Vec<Compared> {
    let mut rng = ChaCha8Rng::seed_from_u64(number);
    let mission = mission(number, truth, walk);
    let mut sites = Vec::new();
    if walk != Walk::ToEvenChance {
        let flown = mission.fly(|step, _| sites.extend(step.reading.map(|_| step.pose.site)));
        assert!(flown.is_ok());
    }
    let columns = (Columns::NONE, Columns::NONE, Columns::NONE);
    let mut told = Told { table: mission.table(), believed: Vec::new(), columns };
    let (mut at, mut compared) = (mission.start.site, Vec::new());
    for labels in 1..=30 {
        at = match walk {
            Walk::By(_) => match sites.get(labels - 1) {
                Some(site) => *site,
                None => break,
            },
            Walk::ToEvenChance => undecided(&mut rng, &told.table, at, [0.4, 0.6])
                .map_or_else(|| within_reach(&mut rng, at), |(site, _)| site),
        };
        let p = match truth {
            Truth::Always(p) => p,
            Truth::Mixed => [0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0][rng.random_range(0..7)],
        };
        let is_above = (mission.world.distance(at) > 0.0) == rng.random_bool(p);
        let label = if is_above { Label::Positive } else { Label::Negative };
        told.take(Sample { site: at, label }, Reliability::new(p).expect("a probability"));
        if MARKS.contains(&labels) {
            told.lay();
            compared.extend(told.compare(&mut rng, truth, labels, at));
        }
    }
    compared
}

fn mission(number: u64, truth: Truth, walk: Walk) -> Mission {
    let algorithm = match walk {
        Walk::By(algorithm) => algorithm,
        Walk::ToEvenChance => Algorithm::Random,
    };
    let p = match truth {
        Truth::Always(p) => p,
        Truth::Mixed => 0.8,
    };
    let mut mission = standard_field::standard(21, number, algorithm, 60);
    mission.noise = Some(NoiseModel { p, extent: Extent::OutsideBalls(0.0) });
    mission
}

/// Mean and largest of some differences.
fn summary(differences: impl Iterator<Item = f64> + Clone) -> [f64; 2] {
    let count = differences.clone().count().max(1) as f64;
    [differences.clone().sum::<f64>() / count, differences.fold(0.0, f64::max)]
}

/// At places within reach whose share is from 0.1 to 0.9: where an agent is to be guided.
#[test]
fn chances_are_those_of_the_table() {
    let missions: Vec<_> = TRUTHS
        .into_iter()
        .flat_map(|truth| WALKS.map(|walk| (truth, walk)))
        .flat_map(|(truth, walk)| (0..cases(12, 60)).map(move |number| (number, truth, walk)))
        .collect();
    let compared: Vec<Compared> = missions
        .into_par_iter()
        .flat_map_iter(|(number, truth, walk)| fly(number, truth, walk))
        .collect();
    println!(
        "labels true, seen: mean and largest difference for 16, 24, 32 directions; after one more"
    );
    for truth in TRUTHS {
        for labels in MARKS {
            let some = compared.iter().filter(|it| (it.truth, it.labels) == (truth, labels));
            let now = [0, 1, 2].map(|k| summary(some.clone().map(|it| it.now[k])));
            let after = summary(some.clone().map(|it| it.after));
            println!("{truth:?} {labels:2}: {now:.4?} {after:.4?}");
            assert!(now[0][0] < 0.016 && after[0] < 0.018, "{truth:?}, {labels} labels");
        }
    }
    let all = [0, 1, 2].map(|k| summary(compared.iter().map(|it| it.now[k])));
    let after = summary(compared.iter().map(|it| it.after));
    println!("all {}: {all:.4?} {after:.4?}", compared.len());
    assert!(compared.len() > 3_000);
    let most = [[0.009, 0.1], [0.007, 0.08], [0.005, 0.06], [0.009, 0.13]];
    for (got, most) in all.into_iter().chain([after]).zip(most) {
        assert!(got[0] < most[0] && got[1] < most[1], "{got:?}");
    }
}
