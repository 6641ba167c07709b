//! The predictions of look-ahead against slow twins: pictures against the exact shares of version spaces, doubtful labels
//! against their table and entropies in double precision.

use std::f64::consts::TAU;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::Lines;
use nalgebra::{Point2, Vector2};
use planner_core::parts::{Prediction as _, Predictor as _};
use planner_core::{
    AnyReliability, Belief as _, Certainty, FromLog as _, Label, Line, Noise, NoisyBelief,
    PosteriorView, PredictiveBelief as _, Prior, Reliability, Sample, Site,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::known::spaces;

/// A site within reach whose label is uncertain, if one of some comes up: by the sides of a line that is left.
fn uncertain_site(space: &Lines, from: Site, rng: &mut ChaCha8Rng) -> Option<Site> {
    let bounds: Vec<_> = space.bounds().collect();
    (0..200).find_map(|_| {
        let [a, b] = [0, 1].map(|_| Line::from(bounds[rng.random_range(0..bounds.len())]));
        let t = rng.random_range(0.0..1.0);
        let [p, q] = [a.coefficients(), b.coefficients()];
        let [x, z, c] = [0, 1, 2].map(|k| p[k] + t * (q[k] - p[k]));
        let line = Line::from_coefficients(x, z, c)?;
        // Its point nearest to the agent, and up to 2 m along it.
        let here = Point2::<f64>::from(from);
        let off = line.distance(here);
        let along = rng.random_range(-2.0..2.0);
        let norm = x.hypot(z);
        let (nx, nz) = (x / norm, z / norm);
        let site = Point2::new(here.x - off * nx - along * nz, here.y - off * nz + along * nx);
        let site = Site::try_from(site).ok()?;
        (space.certainty(site) == Certainty::Uncertain).then_some(site)
    })
}

#[test]
fn pictures_are_those_of_the_version_space() {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(11));
    let mut asked = 0;
    for steps in [0, 1, 3, 6, 10, 15, 20, 25, 30] {
        for (number, space, from) in spaces(steps).take(cases(12, 250) as usize) {
            let picture = space.predictor(from);
            for _ in 0..4 {
                let Some(site) = uncertain_site(&space, from, &mut rng) else { continue };
                let (share, exact) = (picture.share_above(site), space.chance(site));
                let off = (f64::from(share) - exact).abs();
                assert!(off < 5e-6, "field {number}, {steps} steps: {share}, {exact}");
                asked += 1;
                // Of a label that is next to certain not to come, hardly a digit is left.
                let labels = [Label::Positive, Label::Negative];
                for label in labels.into_iter().filter(|_| (0.02..0.98).contains(&exact)) {
                    let mut known = space.clone();
                    known.insert(Sample { site, label }).expect("uncertain ground");
                    let Some(next) = uncertain_site(&known, site, &mut rng) else { continue };
                    let share = picture.after(site, label).share_above(next);
                    let exact = known.chance(next);
                    let off = (f64::from(share) - exact).abs();
                    assert!(off < 2e-5, "field {number}, {steps} steps: {share}, {exact}");
                }
            }
            for _ in 0..50 {
                let site = within_reach(&mut rng, from);
                let share = picture.share_above(site);
                let agrees = match space.certainty(site) {
                    Certainty::Certain(Label::Positive) => share >= 1.0 - 1e-3,
                    Certainty::Certain(Label::Negative) => share <= 1e-3,
                    Certainty::Uncertain => (-1e-3..=1.0 + 1e-3).contains(&share),
                };
                assert!(agrees, "field {number}, {steps} steps: {share}");
            }
        }
    }
    assert!(asked > 200);
}

/// A site of the area within reach of another.
fn within_reach(rng: &mut ChaCha8Rng, of: Site) -> Site {
    let area = standard_field::area();
    loop {
        let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
        let by = Vector2::new(cos, sin) * rng.random_range(0.0..2.0);
        let site = Site::try_from(Point2::<f64>::from(of) + by).expect("near");
        if area.contains(site) {
            return site;
        }
    }
}

/// A site of the area.
fn anywhere(rng: &mut ChaCha8Rng) -> Site {
    let place = [0, 1].map(|_| rng.random_range(0.0..standard_field::SIDE_M));
    Site::metres(place).expect("near")
}

type Doubtful = NoisyBelief<36, 529, AnyReliability>;

/// A site within reach of another where the share of the lines above is in a range; sought at random and then between two
/// sites on either side, however narrow the strip. `None` if there seems to be none.
fn undecided(rng: &mut ChaCha8Rng, belief: &Doubtful, of: Site, range: [f64; 2]) -> Option<Site> {
    let posterior = PosteriorView::new(belief.belief());
    let (mut low, mut high) = (None::<Site>, None::<Site>);
    for attempt in 0..70 {
        let site = match (low, high) {
            (Some(a), Some(b)) => {
                let part = rng.random_range(0.25..0.75);
                let at = |a: i32, b: i32| a + (f64::from(b - a) * part) as i32;
                Site::new(at(a.x(), b.x()), at(a.z(), b.z())).expect("between sites")
            }
            _ if attempt < 40 => within_reach(rng, of),
            _ => return None,
        };
        let share = posterior.share_above(site);
        if share < range[0] {
            low = Some(site);
        } else if share > range[1] {
            high = Some(site);
        } else {
            return Some(site);
        }
    }
    None
}

/// How often labels are true.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Truth {
    Always(f64),
    /// Another probability for each label, certain ones included.
    Mixed,
    /// One that nobody knows, by its prior.
    Unknown(f64, f64),
}

const TRUTHS: [Truth; 11] = [
    Truth::Always(0.6),
    Truth::Always(0.7),
    Truth::Always(0.8),
    Truth::Always(0.9),
    Truth::Always(0.99),
    Truth::Always(0.9999),
    Truth::Mixed,
    Truth::Unknown(8.0, 2.0),
    Truth::Unknown(2.0, 1.0),
    Truth::Unknown(1.5, 0.5),
    Truth::Unknown(40.25, 7.5),
];

impl Truth {
    /// Beside the given samples labels are certain, every other time.
    fn noise(self, number: u64) -> Noise<AnyReliability> {
        let p = match self {
            Self::Unknown(a, b) => return Noise::beta(a, b).expect("a prior").into(),
            Self::Always(p) => p,
            Self::Mixed => 0.8,
        };
        let trusted_radius = if number.is_multiple_of(2) { 1 << 15 } else { 0 };
        Noise { trusted_radius, ..Noise::new(p).expect("a probability") }.into()
    }
}

/// Numbers of labels after which predictions are compared.
const MARKS: [usize; 4] = [5, 10, 20, 30];

/// How far off predictions are: shares of lines, chances of labels, and shares after one more label.
type Off = [f64; 3];

/// Compares a belief with its table, at places within reach whose share is from 0.1 to 0.9: where an agent is to be guided.
fn compare(belief: &Doubtful, rng: &mut ChaCha8Rng, at: Site, label: Label) -> Vec<Off> {
    let (table, posterior) = (belief.belief(), PosteriorView::new(belief.belief()));
    let predictor = belief.predictor(at);
    let places = (0..8).filter_map(|_| undecided(rng, belief, at, [0.1, 0.9]));
    let places: Vec<_> = places.collect();
    let Some(&first) = places.first() else { return Vec::new() };
    let after = predictor.after(first, label);
    let mut next = table.clone();
    next.take(Sample { site: first, label }, table.reliability(first)).expect("room");
    let next = PosteriorView::new(&next);
    let compare = |site: &Site| {
        let off = |got: f32, is: f64| (f64::from(got) - is).abs();
        let share = predictor.share_above(*site);
        [
            off(share, posterior.share_above(*site)),
            off(predictor.chance(*site, share), table.chance(*site)),
            off(after.share_above(*site), next.share_above(*site)),
        ]
    };
    places.iter().map(compare).collect()
}

/// What a label tells: the entropy of its chance beyond that of the sensor's errors, of that of most labels.
fn informs(belief: &Doubtful, p: f64, site: Site, label: Label) {
    let term = |p: f64| if p > 0.0 { -p * p.log2() } else { 0.0 };
    let coin = |p: f64| term(p) + term(1.0 - p);
    let predictor = belief.predictor(site);
    let is_trusted = belief.belief().reliability(site) == Reliability::CERTAIN;
    let p_here = if is_trusted { 1.0 } else { p };
    let share = predictor.share_above(site);
    let chance = p_here * f64::from(share) + (1.0 - p_here) * (1.0 - f64::from(share));
    let context = format!("p {p}, trusted {is_trusted}, share {share}");
    assert!((f64::from(predictor.chance(site, share)) - chance).abs() < 1e-6, "{context}");
    let told = (coin(chance) - coin(p_here)) / (1.0 - coin(p));
    for got in
        [predictor.information(site, share), predictor.after(site, label).information(site, share)]
    {
        // Two entropies to 10^-3 bits, near one half to as much of what they lack of a bit.
        let bound = if p_here < 0.75 { 0.01 } else { 2e-3 / (1.0 - coin(p)) };
        assert!((f64::from(got) - told).abs() < bound, "{context}: {got} for {told}");
    }
}

/// Takes in 30 labels, and compares on the way; how far off predictions are, by the number of labels. Labels are read
/// within reach, or where the chance is about even, so that what is known narrows as fast as it can. Those that are true
/// with an unknown probability are read anywhere.
fn fly(number: u64, truth: Truth) -> Vec<(usize, Off)> {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
    let mission = standard_field::standard(21, number, Algorithm::Lookahead, 1);
    let (given, noise) = (mission.given.samples(), truth.noise(number));
    let mut belief = Doubtful::new(given, noise).expect("an oracle");
    let (mut at, mut compared) = (mission.start.site, Vec::new());
    for labels in 1..=30 {
        at = match truth {
            Truth::Unknown(..) => anywhere(&mut rng),
            _ if number % 4 < 2 => undecided(&mut rng, &belief, at, [0.4, 0.6])
                .unwrap_or_else(|| within_reach(&mut rng, at)),
            _ => within_reach(&mut rng, at),
        };
        let own = [0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0][rng.random_range(0..7)];
        let (p, reliability) = match (belief.belief().reliability(at), truth) {
            (Reliability::CERTAIN, _) => (1.0, Reliability::CERTAIN),
            (_, Truth::Mixed) => (own, Reliability::new(own).expect("a probability")),
            (here, Truth::Always(p)) => (p, here),
            (here, Truth::Unknown(a, b)) => (a / (a + b), here),
        };
        let is_above = (mission.world.distance(at) > 0.0) == rng.random_bool(p);
        let label = if is_above { Label::Positive } else { Label::Negative };
        belief.take(Sample { site: at, label }, reliability).expect("room, and a possible label");
        assert_eq!(belief.ground().certainty(at), mission.lines().certainty(at));
        if MARKS.contains(&labels) {
            belief.prepare();
            let all = compare(&belief, &mut rng, at, label);
            compared.extend(all.into_iter().map(|off| (labels, off)));
            if let Truth::Always(p) = truth {
                // Far from what is known, and in the ball about a given point.
                let [far, near] = [given[0].site, given[labels % 4].site];
                let beside = Site::new(near.x() + 5_000, near.z() - 9_000).expect("near");
                for site in [at, within_reach(&mut rng, at), within_reach(&mut rng, far), beside] {
                    informs(&belief, p, site, label);
                }
            }
        }
    }
    // It begins again in place, and its log restores it.
    let mut again = belief.clone();
    again.restart(&given[..2], Prior::Area, noise).expect_err("two points");
    again.restart(given, Prior::Area, noise).expect("an oracle");
    again.replay(&belief.log()).expect("its own log");
    assert_eq!(format!("{:?}", again.belief()), format!("{:?}", belief.belief()));
    again.prepare();
    let [again, belief] = [&again, &belief].map(|it| it.predictor(at));
    for site in (0..20).map(|_| within_reach(&mut rng, at)) {
        assert_eq!(again.share_above(site).to_bits(), belief.share_above(site).to_bits());
    }
    compared
}

#[test]
fn predictions_of_doubtful_labels_are_those_of_their_table() {
    let mut all = Vec::new();
    for truth in TRUTHS {
        let flown = (0..cases(40, 180)).into_par_iter().flat_map_iter(|number| fly(number, truth));
        let flown: Vec<_> = flown.collect();
        let is_known = !matches!(truth, Truth::Unknown(..));
        for labels in MARKS.into_iter().filter(|_| is_known) {
            let some: Vec<_> = flown.iter().filter(|it| it.0 == labels).map(|it| it.1).collect();
            let mean =
                [0, 1, 2].map(|k| some.iter().map(|it| it[k]).sum::<f64>() / some.len() as f64);
            let is_near = mean[0] < 0.016 && mean[1] < 0.018 && mean[2] < 0.018;
            assert!(!some.is_empty() && is_near, "{truth:?}, {labels} labels: {mean:?}");
        }
        // Of few labels that are true with an unknown probability, chances are not so near.
        let flown = flown.into_iter().filter(|it| is_known || it.0 > 5);
        all.extend(flown.map(|it| (is_known, it.1)));
    }
    assert!(all.len() > cases(5_000, 25_000) as usize, "{}", all.len());
    for (is_known, bounds) in [
        (true, [[0.009, 0.1], [0.009, 0.1], [0.009, 0.13]]),
        (false, [[0.016, 0.12], [0.025, 0.15], [0.025, 0.15]]),
    ] {
        for (k, [mean, most]) in bounds.into_iter().enumerate() {
            let off = || all.iter().filter(|it| it.0 == is_known).map(|it| it.1[k]);
            let got = [off().sum::<f64>() / off().count() as f64, off().fold(0.0, f64::max)];
            assert!(got[0] < mean && got[1] < most, "known {is_known}, {k}: {got:?}");
        }
    }
}
