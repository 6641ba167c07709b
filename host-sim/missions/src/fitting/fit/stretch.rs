//! A stretch of the file in which labels say something else than where they are: a sensor that was fouled, stuck or
//! turned round for a while.
//!
//! As for the other boundaries (`shapes`), the odds are bounds: over all stretches of the file, the
//! kinds of faults, and a grid of lines for the rest of the file.

use std::f64::consts::TAU;

use crate::fitting::fit::labels::{Evidence, Labels};
use crate::fitting::fit::sweep::{Directed, line, spread};

/// What labels say in a stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Either label, as a coin falls.
    Coin,
    /// The label of the other side.
    Inverted,
    /// The same label.
    Stuck(bool),
}

impl Fault {
    const ALL: [Self; 4] = [Self::Coin, Self::Inverted, Self::Stuck(true), Self::Stuck(false)];

    /// The chance of a label, of which `side` is the chance of being on its side.
    fn chance(self, is_positive: bool, side: f64) -> f64 {
        const TRUE: f64 = 0.97;
        match self {
            Self::Coin => 0.5,
            Self::Inverted => TRUE - (2.0 * TRUE - 1.0) * side,
            Self::Stuck(label) if label == is_positive => TRUE,
            Self::Stuck(_) => 1.0 - TRUE,
        }
    }
}

/// A stretch that explains the labels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub(crate) log_odds: f64,
    /// Its first label and its last.
    pub(crate) ends: [usize; 2],
    pub(crate) fault: Fault,
    /// How often labels outside of it are wrong.
    pub(crate) share: f64,
}

/// Most labels by which a line is fitted to the rest of the file.
const SOME: usize = 2_000;

/// The stretch with the greatest odds that is found.
pub(crate) fn stretch(
    labels: &Labels,
    best: Directed,
    share: f64,
    straight: f64,
) -> Option<Stretch> {
    let count = labels.count();
    let steps = 4.0 * count as f64;
    let windows = 0.5 * count as f64 * (count as f64 + 1.0);
    let price =
        2.0 * libm::log(steps + 1.0) + libm::log(windows) + libm::log(Fault::ALL.len() as f64);
    let mut found: Option<Stretch> = None;
    let try_with = |directed: Directed, found: &mut Option<Stretch>| {
        let directed = snapped(directed, labels, steps);
        let height = directed.heights(labels);
        let sides: Vec<_> = (0..count).map(|index| labels.side(index, height(index))).collect();
        for fault in Fault::ALL {
            let Some((log, ends, share)) = best_of(labels, &sides, fault, share) else { continue };
            let log_odds = log - price - straight;
            if found.is_none_or(|found| log_odds > found.log_odds) {
                *found = Some(Stretch { log_odds, ends, fault, share });
            }
        }
    };
    try_with(best, &mut found);
    // The stretch may have led the line astray: fit it to the rest.
    for _ in 0..2 {
        let [first, last] = found?.ends;
        let rest: Vec<_> = (0..first).chain(last + 1..count).collect();
        if rest.len() < 3 {
            break;
        }
        try_with(line(labels, &spread(&rest, SOME), None).0, &mut found);
    }
    found
}

fn snapped(line: Directed, labels: &Labels, steps: f64) -> Directed {
    let (turn, step) = (TAU / steps, 2.0 * labels.radius / steps);
    let snap = |value: f64, step: f64| (value / step).round() * step;
    Directed { angle: snap(line.angle.rem_euclid(TAU), turn), offset: snap(line.offset, step) }
}

/// The stretch of one fault with the greatest likelihood, its ends, and the share of wrong labels elsewhere. It is found
/// by the greatest partial sum (Kadane), for a share that is found anew some times.
fn best_of(
    labels: &Labels,
    sides: &[f64],
    fault: Fault,
    share: f64,
) -> Option<(f64, [usize; 2], f64)> {
    let mut best: Option<(f64, [usize; 2], f64)> = None;
    let mut share = share.max(0.001);
    let log = |is_positive: bool, side: f64| libm::log(fault.chance(is_positive, side));
    // Most positions are certainly on a side.
    let certain = [0.0, 1.0].map(|side| [false, true].map(|is_positive| log(is_positive, side)));
    let faulty = |index: usize| {
        let (is_positive, side) = (labels.is_positive[index], sides[index]);
        match side {
            0.0 => certain[0][usize::from(is_positive)],
            1.0 => certain[1][usize::from(is_positive)],
            side => log(is_positive, side),
        }
    };
    for _ in 0..4 {
        let usual = [libm::log(share), libm::log1p(-share)];
        let gain = |index: usize| {
            faulty(index)
                - match sides[index] {
                    0.0 => usual[0],
                    1.0 => usual[1],
                    side => libm::log(share + (1.0 - 2.0 * share) * side),
                }
        };
        let (mut most, mut ends) = (0.0, None);
        let (mut sum, mut first) = (0.0, 0);
        for index in 0..sides.len() {
            if sum <= 0.0 {
                (sum, first) = (0.0, index);
            }
            sum += gain(index);
            if sum > most {
                (most, ends) = (sum, Some([first, index]));
            }
        }
        let [first, last] = ends?;
        let within: f64 = (first..=last).map(faulty).sum();
        let outside = (0..first).chain(last + 1..sides.len());
        let (rest, found) = Evidence::of(outside.map(|index| sides[index])).mixed();
        if best.is_some_and(|(before, ..)| before >= within + rest) {
            break;
        }
        best = Some((within + rest, [first, last], found));
        share = found;
    }
    best
}
