//! A version space that makes room, beside a twin that keeps every sample.

use planner_core::estimate::{area, bisector, centre, maximum_margin};
use planner_core::parts::{Bound, Constraint};
use planner_core::{
    Belief as _, CellView, Certainty, FromLog as _, Label, LocalLine, Reading, Sample, Site,
    Vector, VersionSpace,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::{cases, clamped, sign};

/// Readings of a mission.
const READINGS: u32 = 1_000;

/// Keeps all samples, and those that bound the lines left in cyclic order, the last that cut at the end.
struct Twin {
    all: Vec<Sample>,
    support: Vec<Sample>,
}

impl Twin {
    fn of<const N: usize>(space: &VersionSpace<N>) -> Self {
        Self { all: space.samples().to_vec(), support: space.support().collect() }
    }

    fn corners(&self) -> Vec<Bound> {
        let next = self.support.iter().cycle().skip(1);
        let bound = |(p, q): (&Sample, &Sample)| {
            let along = if p.label == q.label { q.site - p.site } else { p.site - q.site };
            Bound { through: p.site, along }
        };
        self.support.iter().zip(next).map(bound).collect()
    }

    fn certainty(&self, site: Site) -> Certainty {
        let values: Vec<i64> = self.corners().iter().map(|it| it.at(site)).collect();
        match (values.iter().any(|it| *it < 0), values.iter().any(|it| *it > 0)) {
            (true, true) => Certainty::Uncertain,
            (true, false) => Certainty::Certain(Label::Negative),
            (false, _) => Certainty::Certain(Label::Positive),
        }
    }

    /// Keeps a sample, and the corners that agree with it.
    fn keep(&mut self, sample: Sample) {
        let agrees: Vec<bool> = (self.corners().iter())
            .map(|it| it.at(sample.site) * i64::from(sample.label.sign()) > 0)
            .collect();
        let cuts = self.certainty(sample.site) == Certainty::Uncertain;
        self.all.push(sample);
        if !cuts {
            return;
        }
        // An edge stays if the corner at one of its ends does. Start at the first edge after the cut.
        let n = self.support.len();
        let first = (0..n).find(|&k| agrees[k] && !agrees[(k + n - 1) % n]).expect("some stay");
        let kept =
            (0..n).map(|k| (first + k) % n).take_while(|&k| agrees[k] || agrees[(k + n - 1) % n]);
        self.support = kept.map(|k| self.support[k]).chain([sample]).collect();
    }

    /// What is read off the lines left: arc, intercepts, measure, centre and maximum margin.
    fn read_out(&self) -> ReadOut {
        let edges: Vec<_> =
            (0..).zip(&self.support).map(|(k, s)| Constraint::new(k, s.label)).collect();
        let (samples, shift) = (&self.support[..], Vector::default());
        read_out(CellView { edges: &edges, samples, shift, is_loose: false })
    }
}

type ReadOut = (String, Option<[f64; 2]>, u32, [Option<LocalLine>; 2]);

fn read_out(lines: CellView<'_>) -> ReadOut {
    let estimates = [centre(lines), maximum_margin(lines)];
    (format!("{:?}", lines.slope_arc()), lines.intercepts(), area(lines).to_bits(), estimates)
}

/// A line through the middle of 20 m, and what a perfect sensor reads of it.
#[derive(Clone, Copy)]
struct Field([i64; 3]);

impl Field {
    fn drawn(rng: &mut ChaCha8Rng) -> Self {
        let (a, b) = (rng.random_range(-999..=999_i64), rng.random_range(-999..=999));
        let about: [i64; 2] = [0; 2].map(|_| rng.random_range(-(3 << 16)..=3 << 16));
        Self([a, b.max(1 - a.abs()), -(a * about[0] + b.max(1 - a.abs()) * about[1])])
    }

    fn value(self, site: Site) -> i64 {
        let Self([a, b, c]) = self;
        a * i64::from(site.x()) + b * i64::from(site.z()) + c
    }

    fn reading(self, site: Site) -> Reading {
        match self.value(site).signum() {
            0 => Reading::Boundary,
            side => Reading::Side(if side > 0 { Label::Positive } else { Label::Negative }),
        }
    }

    /// A site so many lattice units from the line, about.
    fn near(self, rng: &mut ChaCha8Rng, off: f64) -> Site {
        let [a, b, c] = self.0.map(|it| it as f64);
        let norm = a.hypot(b);
        let along = rng.random_range(-10.0..10.0) * 65_536.0;
        let off = off - c / norm;
        clamped(
            ((-b * along + a * off) / norm).round() as i64,
            ((a * along + b * off) / norm).round() as i64,
        )
    }
}

/// How a mission reads.
#[derive(Clone, Copy, Debug)]
enum Ways {
    /// Along straight drives from anywhere to anywhere.
    Drives,
    /// Near the line, ever nearer.
    Closing,
    /// On a coarse grid, so that sites repeat and lie on one line.
    Grid,
}

/// The sites of a mission.
fn sites(rng: &mut ChaCha8Rng, field: Field, ways: Ways) -> Vec<Site> {
    let anywhere =
        |rng: &mut ChaCha8Rng| [0; 2].map(|_| rng.random_range(-(10 << 16)..=10_i64 << 16));
    let mut sites = Vec::new();
    let mut from = anywhere(rng);
    while sites.len() < READINGS as usize {
        match ways {
            Ways::Drives => {
                let to = anywhere(rng);
                let n = rng.random_range(1..=10);
                for k in 1..=n {
                    let on = |i: usize| from[i] + (to[i] - from[i]) * k / n;
                    sites.push(clamped(on(0), on(1)));
                }
                from = to;
            }
            Ways::Closing => {
                let size = (10.0 * 65_536.0) * 0.5_f64.powf(rng.random_range(0.0..20.0));
                let off = size * rng.random_range(-1.0..1.0);
                sites.push(field.near(rng, off));
            }
            Ways::Grid => {
                let [x, z] = anywhere(rng).map(|it| it >> 15 << 15);
                sites.push(clamped(x, z));
            }
        }
    }
    sites.truncate(READINGS as usize);
    sites
}

/// How a mission came out.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    /// Samples that are kept in the end.
    kept: usize,
    /// Bisectors that have to agree.
    due: usize,
}

/// The distance within which all lines give a place the same label, lattice units.
fn depth(twin: &Twin, site: Site) -> f64 {
    let distance = |it: &Bound| (it.at(site) as f64).abs() / (it.along.dot(it.along) as f64).sqrt();
    twin.corners().iter().map(distance).fold(f64::INFINITY, f64::min)
}

/// The length of the second of the two shortest pairs of opposite labels that share no place, lattice units.
fn second_pair(samples: &[Sample]) -> f64 {
    let mut pairs = Vec::new();
    for n in samples.iter().filter(|it| it.label == Label::Negative) {
        for p in samples.iter().filter(|it| it.label == Label::Positive) {
            let apart = p.site - n.site;
            pairs.push((apart.dot(apart), [n.site, p.site]));
        }
    }
    pairs.sort_by_key(|(length, _)| *length);
    let first = pairs.first().map(|(_, ends)| *ends);
    let is_apart =
        |ends: &[Site; 2]| first.is_some_and(|it| !ends.iter().any(|end| it.contains(end)));
    let second = pairs.iter().find(|(_, ends)| is_apart(ends));
    second.map_or(f64::INFINITY, |(length, _)| (*length as f64).sqrt())
}

/// Flies a mission in the memory of `N` samples. Of every three readings, two are read on the way.
fn fly<const N: usize>(number: u64, ways: Ways) -> Tally {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(number));
    let field = Field::drawn(&mut rng);
    let mut given = Vec::new();
    let space = loop {
        let site = sites(&mut rng, field, Ways::Drives)[0];
        if let Reading::Side(label) = field.reading(site) {
            given.push(Sample { site, label });
        }
        if let Ok(space) = VersionSpace::<N>::new(&given) {
            break space;
        }
        if given.len() > 8 {
            given.clear();
        }
    };
    let (mut space, mut twin, mut tally) = (space.clone(), Twin::of(&space), Tally::default());
    let start = area(space.lines());
    let mut is_due = true;
    for (k, site) in (0..).zip(sites(&mut rng, field, ways)) {
        let at = || format!("mission {number}, {ways:?}, reading {k}");
        let (reading, certainty) = (field.reading(site), twin.certainty(site));
        assert_eq!(space.certainty(site), certainty, "{}", at());
        let cuts = certainty == Certainty::Uncertain;
        let before = space.samples().to_vec();
        if k % 3 > 0 {
            let kept = space.observe_on_the_way(site, reading);
            assert_eq!(kept, Ok(cuts), "{}", at());
            if !cuts {
                continue;
            }
        } else {
            space.observe(site, reading).expect("there is room");
        }
        let label = match (reading, certainty) {
            (Reading::Side(label), _) => label,
            (Reading::Boundary, Certainty::Uncertain) => Label::Positive,
            (Reading::Boundary, Certainty::Certain(_)) => continue,
        };
        // The bisector has to agree as long as what goes lies deep enough.
        let new = Sample { site, label };
        let all: Vec<_> = before.iter().copied().chain([new]).collect();
        if space.samples() != all {
            let gone: Vec<_> = all.iter().filter(|it| !space.samples().contains(it)).collect();
            assert!(gone.len() <= 1, "{}: {gone:?}", at());
            let second = second_pair(&all);
            is_due &= gone.iter().all(|it| depth(&twin, it.site) > second + 4.0);
        }
        twin.keep(new);
        if k % 25 != 0 {
            continue;
        }
        let read = read_out(space.lines());
        assert_eq!(read, twin.read_out(), "{}", at());
        let bits = f64::from(start) / f64::from(area(space.lines()));
        assert_eq!(space.information().to_bits(), libm::log2(bits).to_bits(), "{}", at());
        // Every corner of the lines left agrees with every sample, so these are all lines that do.
        for bound in space.bounds() {
            let agrees = |s: &Sample| i128::from(bound.at(s.site)) * sign(s.label) >= 0;
            assert!(twin.all.iter().all(agrees), "{}", at());
        }
        let differs = space.estimates().bisector != bisector(&twin.all);
        assert!(!differs || !is_due, "{}", at());
        tally.due += usize::from(is_due);
        // Asleep and woken, it is the same.
        let mut woken = VersionSpace::<N>::new(&given).expect("the same");
        woken.replay(&space.log()).expect("its own");
        assert_eq!(format!("{woken:?}"), format!("{space:?}"), "{}", at());
    }
    assert_eq!(space.given(), given, "mission {number}");
    tally.kept = space.samples().len();
    tally
}

/// No certainty, arc, intercept, centre or maximum margin of a mission of 1,000 readings differs from that of a twin that
/// keeps all, in the memory of 32 samples. Nor does the paper's bisector, as long as no sample goes to which a later one can
/// come nearer than its second pair is long. A smaller memory does as well, down to what bounds the lines.
#[test]
fn thousands_of_readings_run_in_the_memory_of_32() {
    for ways in [Ways::Drives, Ways::Closing, Ways::Grid] {
        let missions = || (0..cases(6, 1_000)).into_par_iter();
        let tallies: Vec<_> = missions().map(|number| fly::<32>(number, ways)).collect();
        let due: usize = tallies.iter().map(|it| it.due).sum();
        assert!(tallies.iter().all(|it| it.kept == 32), "{ways:?}");
        assert!(due > 0, "{ways:?}: no bisector has to agree");
        missions().for_each(|number| {
            let _ = fly::<20>(number, ways);
        });
    }
}

#[test]
fn samples_of_the_shortest_pairs_go_last() {
    let sample = |(x, z)| {
        let label = if z > 5.0 { Label::Positive } else { Label::Negative };
        Sample::at([x, z], label).expect("near")
    };
    let given = [(0.0, 0.0), (0.0, 10.0), (10.0, 10.0), (10.0, 0.0)].map(sample);
    let mut space = VersionSpace::<9>::new(&given).expect("they are apart");
    // The first one lies deeper in certain ground, but ends the shortest pair.
    let [paired, other] = [(5.0, 3.0), (9.5, 4.0)].map(sample);
    let bounds = [(5.0, 5.1), (1.0, 4.95), (9.0, 4.95)].map(sample);
    let newest = sample((5.0, 5.05));
    for it in [paired, other].into_iter().chain(bounds).chain([newest]) {
        space.insert(it).expect("there is room");
    }
    assert_eq!(space.samples(), [&given[..], &[paired], &bounds, &[newest]].concat());
}
