//! A stretch of the labels that say something else than where they are: a sensor that was fouled, stuck or turned round
//! for a while.

use crate::fitting::explanation::labels::{Directed, Evidence, Labels};
use crate::fitting::explanation::{Fault, Found};

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

/// A stretch, with the logarithm of the likelihood of all labels.
struct Stretch {
    log: f64,
    /// Its first label and its last.
    ends: [usize; 2],
    fault: Fault,
    /// How often labels outside of it are wrong.
    share: f64,
}

/// The stretch that makes the labels the likeliest, with the logarithm of that.
pub(super) fn stretch(labels: &Labels, best: Directed, share: f64) -> Option<(f64, Found)> {
    let mut found: Option<Stretch> = None;
    let mut with = best;
    // The stretch may have led the line astray: then it is fitted to the rest.
    for _ in 0..3 {
        let sides: Vec<_> = labels.sides(with.heights(labels)).collect();
        for stretch in Fault::ALL.into_iter().filter_map(|it| of(labels, &sides, it, share)) {
            if found.as_ref().is_none_or(|found| stretch.log > found.log) {
                found = Some(stretch);
            }
        }
        let [first, last] = found.as_ref()?.ends;
        let rest: Vec<_> = (0..first).chain(last + 1..labels.count()).collect();
        if rest.len() < 3 {
            break;
        }
        with = labels.line(&rest);
    }
    let Stretch { log, ends: [first, last], fault, share } = found?;
    let height = best.heights(labels);
    let against =
        (first..=last).filter(|index| (height(*index) > 0.0) != labels.is_positive[*index]);
    let counts = [last - first + 1, against.count()];
    let times = [first, last].map(|end| labels.times[end]);
    Some((log, Found::Stretch { times, fault, counts, p: 1.0 - share }))
}

/// The stretch of one fault that makes the labels the likeliest. It is found by the greatest partial sum (Kadane), for a
/// share of wrong labels elsewhere that is found anew some times.
fn of(labels: &Labels, sides: &[f64], fault: Fault, share: f64) -> Option<Stretch> {
    let faulty = |index: usize| libm::log(fault.chance(labels.is_positive[index], sides[index]));
    let mut best: Option<Stretch> = None;
    let mut share = share.max(0.001);
    for _ in 0..4 {
        let (mut most, mut ends) = (0.0, None);
        let (mut sum, mut first) = (0.0, 0);
        for (index, side) in sides.iter().enumerate() {
            if sum <= 0.0 {
                (sum, first) = (0.0, index);
            }
            sum += faulty(index) - libm::log(share + (1.0 - 2.0 * share) * side);
            if sum > most {
                (most, ends) = (sum, Some([first, index]));
            }
        }
        let [first, last] = ends?;
        let within: f64 = (first..=last).map(faulty).sum();
        let outside = sides[..first].iter().chain(&sides[last + 1..]);
        let (rest, found) = Evidence::of(outside.copied()).greatest();
        let log = within + rest;
        if best.as_ref().is_some_and(|before| before.log >= log) {
            break;
        }
        // Of no wrong label elsewhere any disagreeing one would be in a stretch.
        share = found.max(0.001);
        best = Some(Stretch { log, ends: [first, last], fault, share: found });
    }
    best
}
