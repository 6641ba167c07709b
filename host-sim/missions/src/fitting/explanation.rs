//! What explains labels best that are said to be true, and that no straight, still line explains.
//!
//! Each explanation is a family of worlds or of sensors, and most families have lines as members that are moved, bent or
//! read otherwise. The share of a family that agrees with all labels is the chance which it gave them beforehand. These
//! shares are compared (Bayes, each family as likely as any other). They are exact measures of lines:
//!
//! - *Bend*: a circle turns into a line when each place is moved along the line's normal by half the curvature times the
//!   square of its distance from the middle. *Drift*: a line that moves stands still when each place is moved back by as
//!   much. So each curvature, and each speed, is a version space of moved places.
//! - *Stuck*, *inverted*, *at random*: from some label on. Also a single wrong label counts as one *at random*. *Late*:
//!   each label is that of a place before. Each is a version space of other labels.
//!
//! The planner asked where it was uncertain, and each label halved its lines. So a family of which labels of chance can
//! hardly come has little share, and few labels suffice.

use nalgebra::{Point2, Vector2};
use planner_core::{Belief as _, Line, Reading, Sample, Site, Tolerance, VersionSpace};
use serde::{Deserialize, Serialize};

/// Samples at most: as many as a belief holds.
const MOST: usize = 128;

/// A family counts as the explanation if it has at least this share.
const SURE: f64 = 0.85;

/// How far a bend or a drift may reach, as shares of the ground's size: the least and the greatest.
const REACHES: [f64; 2] = [0.001, 0.3];

/// Two neighbouring reaches have this ratio.
const RATIO: f64 = 1.04;

/// The fewest labels at the end that a fault of the sensor spoils.
const RUN: usize = 3;

/// Labels come so many samples late at most.
const LATE: usize = 3;

/// A way in which labels come about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A straight, still line.
    Line,
    /// A boundary that bends.
    Bend,
    /// A line that moves.
    Drift,
    /// A sensor that repeats a label.
    Stuck,
    /// A sensor that reads the other label.
    Inverted,
    /// Labels that come some samples late.
    Late,
    /// Labels at random from one on, or a single one that is wrong.
    Random,
}

impl Family {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Line,
        Self::Bend,
        Self::Drift,
        Self::Stuck,
        Self::Inverted,
        Self::Late,
        Self::Random,
    ];
}

/// What explains labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Cause {
    /// A straight, still line does.
    #[serde(rename = "line")]
    Line,
    /// The boundary bends.
    #[serde(rename = "bend")]
    Bend,
    /// The boundary moves.
    #[serde(rename = "drift")]
    Drift,
    /// The sensor repeats a label.
    #[serde(rename = "stuck")]
    Stuck,
    /// The sensor reads the other label.
    #[serde(rename = "inverted")]
    Inverted,
    /// One of the two: the labels are the same.
    #[serde(rename = "stuck or inverted")]
    StuckOrInverted,
    /// Labels come some samples late.
    #[serde(rename = "late")]
    Late,
    /// Labels are wrong at random.
    #[serde(rename = "random")]
    Random,
    /// The labels do not tell.
    #[default]
    #[serde(rename = "cannot tell")]
    Unclear,
}

/// What explains labels.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// Each family with its share of the chance, the greatest first.
    shares: Vec<(Family, f64)>,
    /// Boundaries that bend or move: how far each is from a straight, still line, metres, and its chance. By distance.
    off: Vec<(f64, f64)>,
}

/// Labels of a mission.
#[derive(Clone, Copy, Debug)]
pub struct Told<'a> {
    /// The samples that were given at the start.
    pub given: &'a [Sample],
    /// The samples that were read, each with the number of motions made by then.
    pub read: &'a [(Sample, u32)],
    /// How far off their positions may be.
    pub tolerance: Tolerance,
    /// A line near to the boundary.
    pub near: &'a Line,
}

impl Explanation {
    /// What explains labels.
    pub fn of(told: &Told) -> Self {
        let (bends, drifts) = (told.bends(), told.drifts());
        let mut weights = Family::ALL.map(|family| {
            let weight = match family {
                Family::Bend => total(&bends),
                Family::Drift => total(&drifts),
                other => told.weight(other),
            };
            (family, weight)
        });
        let all: f64 = weights.iter().map(|(_, weight)| weight).sum();
        if all > 0.0 {
            for (_, weight) in &mut weights {
                *weight /= all;
            }
        }
        weights.sort_by(|p, q| q.1.total_cmp(&p.1));
        let mut off = [bends, drifts].concat();
        off.sort_by(|p, q| p.0.total_cmp(&q.0));
        Self { shares: weights.to_vec(), off }
    }

    /// The share of a family.
    pub fn share(&self, of: Family) -> f64 {
        self.shares.iter().find(|(family, _)| *family == of).map_or(0.0, |(_, share)| *share)
    }

    /// The tolerance that covers a bend or a drift with a probability, if it is one of them, metres. `None` where neither
    /// explains the labels.
    pub fn covering(&self, probability: f64) -> Option<f64> {
        let most = probability * total(&self.off);
        let mut so_far = 0.0;
        let reached = self.off.iter().find(|(_, share)| {
            so_far += share;
            most > 0.0 && so_far >= most
        });
        reached.map(|(metres, _)| *metres)
    }

    /// The cause, if one is clearly better than all others.
    pub fn cause(&self) -> Cause {
        let sure = self.shares.first().filter(|(_, share)| *share >= SURE);
        match sure.map(|(family, _)| *family) {
            Some(Family::Line) => Cause::Line,
            Some(Family::Bend) => Cause::Bend,
            Some(Family::Drift) => Cause::Drift,
            Some(Family::Stuck) => Cause::Stuck,
            Some(Family::Inverted) => Cause::Inverted,
            Some(Family::Late) => Cause::Late,
            Some(Family::Random) => Cause::Random,
            None if self.share(Family::Stuck) + self.share(Family::Inverted) >= SURE => {
                Cause::StuckOrInverted
            }
            None => Cause::Unclear,
        }
    }
}

impl Told<'_> {
    /// The chance that a family gave the labels beforehand, but for bends and drifts.
    fn weight(&self, family: Family) -> f64 {
        let samples: Vec<_> = self.read.iter().map(|(sample, _)| *sample).collect();
        let count = samples.len();
        // A fault that spoils fewer labels than this at the end shows no pattern.
        let runs = (count + 1).saturating_sub(RUN);
        let mean =
            |weights: &mut dyn Iterator<Item = f64>| weights.sum::<f64>() / count.max(1) as f64;
        match family {
            Family::Line => self.share(self.given, samples),
            Family::Bend | Family::Drift => 0.0,
            Family::Stuck => mean(&mut (0..runs).map(|from| {
                let (before, stuck) = samples.split_at(from);
                let is_one = stuck.iter().all(|it| it.label == stuck[0].label);
                if is_one { 0.5 * self.share(self.given, before.iter().copied()) } else { 0.0 }
            })),
            Family::Inverted => mean(&mut (0..runs).map(|from| {
                let read = samples.iter().enumerate();
                self.share(self.given, read.map(|(k, it)| if k >= from { other(*it) } else { *it }))
            })),
            Family::Late => {
                let late = (1..=LATE.min(count)).map(|by| {
                    let places = samples.iter().zip(&samples[by..]);
                    let seen = places.map(|(at, said)| Sample { site: at.site, label: said.label });
                    libm::exp2(-(by as f64)) * self.share(self.given, seen)
                });
                late.sum::<f64>() / LATE as f64
            }
            Family::Random => {
                let from_one_on = mean(&mut (0..runs).map(|from| {
                    let by_chance = libm::exp2(-((count - from) as f64));
                    by_chance * self.share(self.given, samples[..from].iter().copied())
                }));
                let one = mean(&mut (0..count).map(|wrong| {
                    let read = samples.iter().enumerate();
                    let read = read.map(|(k, it)| if k == wrong { other(*it) } else { *it });
                    self.share(self.given, read)
                }));
                0.5 * (from_one_on + one)
            }
        }
    }

    /// The share of the lines that agree with the given samples which agree with others too.
    fn share(&self, given: &[Sample], read: impl IntoIterator<Item = Sample>) -> f64 {
        let space = VersionSpace::<MOST>::new(given).ok();
        let Some(mut space) = space.and_then(|it| it.with_tolerance(self.tolerance).ok()) else {
            return 0.0;
        };
        for sample in read {
            if space.observe(sample.site, Reading::Side(sample.label)).is_err() {
                return 0.0;
            }
        }
        libm::exp2(-space.information())
    }

    /// Boundaries that bend: how far each is from a straight line, and its share.
    fn bends(&self) -> Vec<(f64, f64)> {
        let arcs = self.moved(0.5, |[up, along], _| up * up + along * along);
        // It bends one way and the other: it meets its chord at both ends and in the middle.
        let double = self.moved(1.0, |[_, along], _| 2.6 * along * (1.0 - along * along));
        arcs.into_iter().chain(double).map(|(metres, share)| (metres, 0.5 * share)).collect()
    }

    /// Lines that move: how far each is from one that stays in the middle, and its share.
    fn drifts(&self) -> Vec<(f64, f64)> {
        self.moved(0.5, |_, time| time)
    }

    /// The share for each reach, where each place is moved along the normal of the line. `by` says how far, as a share of
    /// the reach, by its place from the middle of the ground (across and along the line, in shares of half its size) and
    /// its time from 0 to 1. Beside it the metres that the boundary is off a straight, still line at most, `off` of its
    /// reach.
    fn moved(&self, off: f64, by: impl Fn([f64; 2], f64) -> f64) -> Vec<(f64, f64)> {
        let [a, b, _] = self.near.coefficients();
        let normal = Vector2::new(a, b);
        let places = self.given.iter().chain(self.read.iter().map(|(sample, _)| sample));
        let places = places.map(|it| Point2::<f64>::from(it.site));
        let Some([low, high]) = crate::world::extent::around(places) else { return Vec::new() };
        let (middle, size) = (nalgebra::center(&low, &high), (high - low).norm());
        let middle = middle - normal * self.near.distance(middle);
        let last = self.read.iter().map(|(_, time)| *time).max().unwrap_or(1).max(1);
        let moved = |sample: &Sample, time: u32, reach: f64| {
            let at = Point2::<f64>::from(sample.site);
            let place = (at - middle) / (0.5 * size);
            let place = [normal.dot(&place), normal.perp(&place)];
            let to = at - normal * by(place, f64::from(time) / f64::from(last)) * reach;
            Some(Sample { site: Site::metres(to).ok()?, label: sample.label })
        };
        let mut found = Vec::new();
        let mut reach = REACHES[0] * size;
        while reach < REACHES[1] * size {
            for reach in [-reach, reach] {
                let given = self.given.iter().map(|it| moved(it, 0, reach));
                let read = self.read.iter().map(|(it, time)| moved(it, *time, reach));
                let all = given.collect::<Option<Vec<_>>>().zip(read.collect::<Option<Vec<_>>>());
                let share = all.map_or(0.0, |(given, read)| self.share(&given, read));
                found.push((off * reach.abs(), share));
            }
            reach *= RATIO;
        }
        let count = found.len() as f64;
        found.into_iter().map(|(metres, share)| (metres, share / count)).collect()
    }
}

/// The sum of some chances.
fn total(shares: &[(f64, f64)]) -> f64 {
    shares.iter().map(|(_, share)| share).sum()
}

/// The same with the other label.
fn other(sample: Sample) -> Sample {
    Sample { label: -sample.label, ..sample }
}
