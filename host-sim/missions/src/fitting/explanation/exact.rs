//! Of labels that are said to be true, and that no straight, still line explains.
//!
//! Each cause is a family of worlds or of sensors, and most families have lines as members that are moved, bent or read
//! otherwise. The share of a family that agrees with all labels is the chance which it gave them beforehand. These
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

use std::collections::BTreeMap;

use nalgebra::{Point2, Vector2};
use planner_core::{Belief as _, Reading, Sample, Site, Tolerance, VersionSpace};

use crate::fitting::explanation::{Cause, Explanation, Question};
use crate::world::extent::around;

/// Samples at most: as many as a belief holds.
const MOST: usize = 128;

/// A family is the cause if it has at least this share.
const SURE: f64 = 0.85;

/// With what probability a tolerance is to cover a bend or a drift.
const COVERING: f64 = 0.9;

/// How far a bend or a drift may reach, as shares of the ground's size: the least and the greatest.
const REACHES: [f64; 2] = [0.001, 0.3];

/// Two neighbouring reaches have this ratio.
const RATIO: f64 = 1.04;

/// The fewest labels at the end that a fault of the sensor spoils.
const RUN: usize = 3;

/// Labels come so many samples late at most.
const LATE: usize = 3;

impl Question<'_> {
    /// What explains labels that are true.
    pub(super) fn exact(&self) -> Explanation {
        let (bends, drifts) = (self.bends(), self.drifts());
        let total = |of: &[(f64, f64)]| of.iter().map(|(_, share)| share).sum::<f64>();
        let samples: Vec<_> = self.read.iter().map(|(sample, _)| *sample).collect();
        let mut shares = BTreeMap::from([
            (Cause::Line, self.share(self.given, samples.iter().copied())),
            (Cause::Bend, total(&bends)),
            (Cause::Drift, total(&drifts)),
        ]);
        shares.extend(self.faults(&samples));
        let all: f64 = shares.values().sum();
        if all > 0.0 {
            for share in shares.values_mut() {
                *share /= all;
            }
        }
        let sure = shares.iter().find(|(_, share)| **share >= SURE);
        let cause = match sure {
            Some((cause, _)) => *cause,
            None if shares[&Cause::Stuck] + shares[&Cause::Inverted] >= SURE => {
                Cause::StuckOrInverted
            }
            None => Cause::Unclear,
        };
        // How far the boundary is from a straight, still line, with its chance.
        let mut off = [bends, drifts].concat();
        off.sort_by(|p, q| p.0.total_cmp(&q.0));
        let mut missing = COVERING * total(&off);
        let covering = off.iter().find(|(_, share)| {
            missing -= share;
            missing <= 0.0
        });
        let tolerance = covering.filter(|_| total(&off) > 0.0).map(|(metres, _)| *metres);
        Explanation { cause, shares, tolerance, ..Explanation::agreeing(samples.len()) }
    }

    /// The chance that each fault of the sensor gave the labels beforehand.
    fn faults(&self, samples: &[Sample]) -> [(Cause, f64); 4] {
        let count = samples.len();
        // A fault that spoils fewer labels than this at the end shows no pattern.
        let runs = 0..(count + 1).saturating_sub(RUN);
        let mean =
            |weights: &mut dyn Iterator<Item = f64>| weights.sum::<f64>() / count.max(1) as f64;
        let before = |from: usize| self.share(self.given, samples[..from].iter().copied());
        let turned = |is_turned: &dyn Fn(usize) -> bool| {
            let read = samples.iter().enumerate();
            let read = read.map(|(k, it)| Sample {
                label: if is_turned(k) { -it.label } else { it.label },
                ..*it
            });
            self.share(self.given, read)
        };
        let stuck = mean(&mut runs.clone().map(|from| {
            let is_one = samples[from..].iter().all(|it| it.label == samples[from].label);
            if is_one { 0.5 * before(from) } else { 0.0 }
        }));
        let inverted = mean(&mut runs.clone().map(|from| turned(&|k| k >= from)));
        let late = (1..=LATE.min(count)).map(|by| {
            let places = samples.iter().zip(&samples[by..]);
            let seen = places.map(|(at, said)| Sample { site: at.site, label: said.label });
            libm::exp2(-(by as f64)) * self.share(self.given, seen)
        });
        let random =
            mean(&mut runs.map(|from| libm::exp2(-((count - from) as f64)) * before(from)));
        let one = mean(&mut (0..count).map(|wrong| turned(&|k| k == wrong)));
        [
            (Cause::Stuck, stuck),
            (Cause::Inverted, inverted),
            (Cause::Late, late.sum::<f64>() / LATE as f64),
            (Cause::Random, 0.5 * (random + one)),
        ]
    }

    /// The share of the lines that agree with the given samples which agree with others too.
    fn share(&self, given: &[Sample], read: impl IntoIterator<Item = Sample>) -> f64 {
        let share = || {
            let tolerance = Tolerance::new(self.tolerance).ok()?;
            let space = VersionSpace::<MOST>::new(given).ok()?;
            let mut space = space.with_tolerance(tolerance).ok()?;
            for sample in read {
                space.observe(sample.site, Reading::Side(sample.label)).ok()?;
            }
            Some(libm::exp2(-space.information()))
        };
        share().unwrap_or(0.0)
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
        let [a, b, _] = self.line.coefficients();
        let normal = Vector2::new(a, b);
        let places = self.given.iter().chain(self.read.iter().map(|(sample, _)| sample));
        let places = places.map(|it| Point2::<f64>::from(it.site));
        let Some([low, high]) = around(places) else { return Vec::new() };
        let (middle, size) = (nalgebra::center(&low, &high), (high - low).norm());
        let middle = middle - normal * self.line.distance(middle);
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
