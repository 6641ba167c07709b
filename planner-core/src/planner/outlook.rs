//! What a place costs at which a label may be read: the way there, and the error that is left after the next labels.
//!
//! A label where +1 and -1 are equally likely halves the lines that are left, wherever along the estimate it is read. So
//! bits that are read near one place leave the slope open. A good place is one after which the next labels leave little
//! error. They are taken to be read all at one place of the estimate, so many levers `s` from the middle of its chord.
//! Let `S` be the covariance of the lines over the chord, and `h = (1, s)`. Then `t` labels of `I` bits leave of the
//! squared error
//!
//! ```text
//! tr S_t = tr S - (1 - 4^(-I t)) |S h|^2 / (h' S h)
//! ```
//!
//! Where somebody knows how many labels are to come, the error after the last one counts. A goal says that too: labels come
//! until lines that lie evenly are as close as it asks. Else the mean of the logarithms
//! over eight labels counts, so the robot reads about as many before it drives to another place. `halving` is the metres
//! that half of the error is worth. A place costs
//!
//! ```text
//! way + min over s of (way to s + halving * mean of half log2(tr S_t))
//! ```

use crate::belief::Belief as _;
use crate::belief::goal::{Criterion, Goal};
use crate::belief::predictions::{Covariance, PredictiveBelief, Spread, Stretch};
use crate::belief::weight::LogWeight;
use crate::geometry::approximate::{distance, sqrt};
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::search::chord::Chord;

/// Labels that are looked ahead where nobody knows how many there will be.
const AHEAD: u16 = 8;

/// Labels that are looked ahead at most. They leave nothing of what one place can tell.
const MOST: u16 = 64;

/// Labels at one place leave the squared error at most so many times that of the same labels spread evenly. A plan knows one
/// place only for all labels to come, and another drive can mend more than this.
const UNEVEN: f32 = 100.0;

/// Places along the chord at which the next labels may be read, from one end to the other.
const PLACES: u16 = 9;

/// Half the chord, levers.
const HALF: f32 = 1.732_050_8;

/// How the lines lie over the estimate's chord, and what errors are worth.
pub(crate) struct Outlook<S> {
    spread: S,
    to_go: ToGo,
}

/// What is left to do, whatever the belief.
struct ToGo {
    chord: Stretch,
    /// The squared error of now.
    whole: f32,
    /// What half of the error is worth, lattice units of driving.
    halving: f32,
    /// The share of the variance at a place that a label there leaves.
    quarter: f32,
    /// Labels to come, if somebody knows or a goal says.
    labels: Option<u16>,
}

impl<'a, S: Spread + 'a> Outlook<S> {
    /// `worth` is the price of a label, lattice units, and what it can tell with those on the way to it, bits. `labels` are
    /// read after the next one, if somebody knows, or fewer if they meet the goal. `None` if the estimate does not cross the
    /// area.
    pub(crate) fn of<B: PredictiveBelief<Spread<'a> = S>, C: Criterion>(
        belief: &'a B,
        area: Area,
        worth: (f32, f32),
        labels: Option<u16>,
        goal: Option<Goal<C>>,
    ) -> Option<Self> {
        let chord = Chord::of(belief.belief().centre()?, area)?.stretch()?;
        let spread = belief.spread(&chord);
        let wanted = goal.map(|goal| {
            goal.accuracy.deviation(chord.length, area) / chord.lever() * spread.lever()
        });
        let to_go = ToGo::new(chord, spread.covariance(), worth, (labels, wanted));
        (to_go.whole > 0.0).then_some(Self { spread, to_go })
    }

    /// How far lines lie from the estimate, lattice units.
    pub(crate) fn deviation(&self) -> f32 {
        sqrt(self.to_go.whole) * self.to_go.chord.lever() / self.spread.lever()
    }

    /// What it costs to read the next label at one site, coming from another; lattice units.
    pub(crate) fn cost(&self, site: Site, from: Site) -> f32 {
        distance(site - from) + self.to_go.cost(self.spread.after(site), site)
    }
}

impl ToGo {
    #[inline(never)] // one for all beliefs, as all of this
    fn new(
        chord: Stretch,
        now: Covariance,
        (price, bits): (f32, f32),
        (labels, wanted): (Option<u16>, Option<f32>),
    ) -> Self {
        let logarithm = LogWeight::from_log(-2.0 * f64::from(bits) * core::f64::consts::LN_2);
        // A label takes `bits`, and two bits are half of the error.
        let halving = 2.0 * price / bits;
        let quarter = logarithm.exp_single();
        let known = labels.map_or(u16::MAX, |labels| labels.min(MOST));
        let needed = wanted.map_or(u16::MAX, |wanted| needed(now, quarter, wanted));
        let labels = if needed < known { needed } else { known };
        let labels = (labels < u16::MAX).then_some(labels);
        Self { chord, whole: now.trace(), halving, quarter, labels }
    }

    /// From a site, when this covariance is left.
    #[inline(never)]
    fn cost(&self, left: Covariance, site: Site) -> f32 {
        let (lever, [along, aside]) = (self.chord.lever(), self.chord.sees(site));
        let at = along / lever;
        let mut least = f32::INFINITY;
        for k in 0..=PLACES {
            let place = HALF * (2.0 * f32::from(k) / f32::from(PLACES - 1) - 1.0);
            // The last is where the robot is.
            let place = if k < PLACES { place } else { at };
            let ahead = (place - at) * lever;
            let cost = sqrt(ahead * ahead + aside * aside) + self.halving * self.error(left, place);
            least = if cost < least { cost } else { least };
        }
        least
    }

    /// The logarithm of the error, halvings, after the next labels at a place of the chord.
    #[inline(never)]
    fn error(&self, left: Covariance, place: f32) -> f32 {
        let after = |labels: u16| left.trace_after(place, power(self.quarter, labels)) / self.whole;
        let Some(labels) = self.labels else {
            let product: f32 = (0..=AHEAD).map(after).product();
            return 0.5 * log2(product) / f32::from(AHEAD + 1);
        };
        let even = sqrt(left.determinant()) / self.whole * power(sqrt(self.quarter), labels);
        let (last, most) = (after(labels), UNEVEN * even);
        0.5 * log2(if last < most { last } else { most })
    }
}

/// Labels after the next one until lines that lie evenly have this standard deviation.
fn needed(now: Covariance, quarter: f32, wanted: f32) -> u16 {
    let (half, mut variance, mut labels) = (sqrt(quarter), sqrt(now.determinant()), 0);
    while variance * half > wanted * wanted && labels < MOST {
        (variance, labels) = (variance * half, labels + 1);
    }
    labels
}

/// A power of a number.
fn power(base: f32, exponent: u16) -> f32 {
    (0..exponent).fold(1.0, |power, _| power * base)
}

/// The logarithm to base 2.
fn log2(x: f32) -> f32 {
    LogWeight::of(x) * core::f32::consts::LOG2_E
}
