//! Far sight: labels are sought all over the area, at a price.
//!
//! Where the area is large for the longest motion, the labels that tell the most lie far apart. So a plan considers some
//! places along the estimate and some anywhere, beside the ends of one motion. A place is worth
//!
//! ```text
//! what its label is expected to bring / (price of a label + way to get there)
//! ```
//!
//! The planner goes to the place that is worth the most, by several motions without a label. It plans the way anew after
//! each of them. Where an end of the next motion has become worth more, it asks there.
//!
//! The price is the one number that says what a user wants: few labels, or little driving.

use crate::belief::Belief as _;
use crate::belief::predictions::{Prediction, PredictiveBelief, Spread as _};
use crate::geometry::approximate::distance;
use crate::geometry::lattice::{Site, UNITS_PER_METRE};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::decision::{Decision, prospects};
use crate::search::chord::Chord;
use crate::search::dead_end::place;
use crate::search::errand::{Errand, UNKNOWN, errand, motions_to};
use crate::search::lookout::Lookout;
use crate::search::motions::Leg;
use crate::search::objective::Effort;

/// Places along the estimate, and others all over the area.
const ALONG: u16 = 17;
const PLACES: u32 = 36;

/// Places along the estimate begin and end at this share of it.
const END: f32 = 0.01;

/// Places to which a plan seeks a way.
const TRIES: usize = 3;

/// The looks of these ways together.
pub(crate) const LOOKS: u32 = 2_048;

/// A way may take so many motions more than it seems to at its beginning. One that needs more goes round about its place.
const MORE: u16 = 2;

/// Where keep-outs lie between, a way may take twice as many motions as lead straight there, and so many more.
const MORE_ROUND: u16 = 16;

/// The usual price of a label, as a share of the mean of the area's sides.
const USUAL: f32 = 0.125;

/// An area is large if the mean of its sides is longer than so many of the longest motions.
const LARGE: f32 = 16.0;

/// All of the area, one label deep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Far {
    /// What a label costs, millimetres of driving.
    price_mm: u32,
    seeks: Seeks,
}

/// What a label is to bring.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Seeks {
    /// Little misclassified ground after few labels. It counts the expected information, times the share of the variance
    /// of the lines over the area that the label is expected to remove.
    #[default]
    Accuracy,
    /// Much information for little driving. It counts the expected information alone.
    Bits,
}

impl Far {
    /// A label costs as much as a drive of so many metres, to the nearest millimetre. With a high price the planner
    /// drives far for each label. With 0 it weighs what a label brings against the way alone.
    ///
    /// # Errors
    /// [`ValueError`] unless it is from 0 to 16,384 m.
    pub fn at_price(metres: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError =
            ValueError("the price of a label is from 0 to 16384 m of driving");
        let price_mm = libm::round(metres * 1e3) as u32;
        let is_price = (0.0..=16_384.0).contains(&metres);
        is_price.then_some(Self { price_mm, seeks: Seeks::Accuracy }).ok_or(RANGE)
    }

    /// At the usual price: an eighth of the mean of the sides of the rectangle around an area.
    pub fn across(area: &impl Workspace) -> Self {
        let price = f64::from(USUAL * area.bounds().mean_side());
        let price_mm = libm::round(price * 1e3 / f64::from(UNITS_PER_METRE)) as u32;
        Self { price_mm, seeks: Seeks::Accuracy }
    }

    /// At the usual price where the area is so large that far sight pays: the mean of its sides is more than sixteen of the
    /// vehicle's longest motions. `None` elsewhere.
    pub fn usual(area: &impl Workspace, dynamics: &impl Dynamics) -> Option<Self> {
        let is_large = area.bounds().mean_side() > LARGE * dynamics.grid().longest_units();
        is_large.then(|| Self::across(area))
    }

    /// The same, for labels that are to bring something else.
    #[must_use]
    pub const fn seeking(self, seeks: Seeks) -> Self {
        Self { seeks, ..self }
    }

    /// What a label costs, metres of driving.
    pub fn price(self) -> f64 {
        f64::from(self.price_mm) * 1e-3
    }
}

impl Far {
    /// What to do next; `None` if no label is in sight.
    pub(crate) fn decide<B: PredictiveBelief, P: Prediction, D: Dynamics, G: Workspace>(
        self,
        (belief, predictor): (&B, &P),
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Journey,
    ) -> Option<Decision> {
        let chord = Chord::of(belief.belief().centre()?, lookout.area.bounds())?;
        let spread = match self.seeks {
            Seeks::Accuracy => chord.stretch().map(|over| belief.spread(&over)),
            Seeks::Bits => None,
        };
        // A unit more, so that nothing is divided by 0.
        let price = self.price_mm as f32 * (1e-3 * UNITS_PER_METRE as f32) + 1.0;
        let worth = |site: Site, share: f32| {
            let told = predictor.brings(site, share, predictor.information(site, share));
            let brings = spread.as_ref().map_or(1.0, |spread| spread.reduction(site)) * told;
            brings / (price + distance(site - pose.site))
        };
        let mut best = None;
        for it in prospects(predictor, belief.ground(), lookout, pose).as_slice() {
            let (action, target, worth) = (it.action, it.target, worth(it.target.site, it.share));
            Decision { action, target, worth, wants_label: true, is_far: false }.beat(&mut best);
        }
        let most = best.as_ref().map_or(0.0, |best| best.worth);
        let mut places = Places::NONE;
        let mut consider = |site: Site| {
            places.add(Place { site, worth: worth(site, predictor.share_above(site)) });
        };
        match journey.now {
            Rest::None => sites(&chord, lookout)
                .filter(|site| tells(belief, predictor, lookout, *site))
                .for_each(consider),
            Rest::To(site, _) => consider(site),
            Rest::Over => {}
        }
        journey.next = journey.now;
        let mut effort = Effort::within(&lookout.area, LOOKS);
        for Place { site, worth } in places.list.into_iter().take_while(|it| it.worth > most) {
            let tells = |site| tells(belief, predictor, lookout, site);
            let leg = journey.go((lookout.dynamics, &lookout.area), pose, site, tells, &mut effort);
            if let Some(((action, target), wants_label)) = leg {
                return Some(Decision { action, target, worth, wants_label, is_far: true });
            }
        }
        best
    }
}

/// Sites along the estimate, and others all over the area.
fn sites<D: Dynamics, G: Workspace>(
    chord: &Chord,
    lookout: &Lookout<'_, D, G>,
) -> impl Iterator<Item = Site> {
    let along = |k: u16| {
        let share = END + (1.0 - 2.0 * END) * f32::from(k) / f32::from(ALONG - 1);
        chord.site(share, 0.0)
    };
    (0..ALONG).map(along).chain((0..PLACES).map(|k| place(&lookout.area, k))).flatten()
}

/// Whether a label at a site is to be considered.
fn tells<B: PredictiveBelief, P: Prediction, D: Dynamics, G: Workspace>(
    belief: &B,
    predictor: &P,
    lookout: &Lookout<'_, D, G>,
    site: Site,
) -> bool {
    let share = predictor.share_above(site);
    share > 0.0
        && share < 1.0
        && predictor.information(site, share) >= lookout.least
        && lookout.area.contains(site)
        && belief.ground().may_tell(site)
}

/// A place beyond the ends of one motion, and what it is worth.
#[derive(Clone, Copy)]
struct Place {
    site: Site,
    worth: f32,
}

/// The best places, the best first.
struct Places {
    list: [Place; TRIES],
}

impl Places {
    const NONE: Self = Self { list: [Place { site: Site::ORIGIN, worth: 0.0 }; TRIES] };

    fn add(&mut self, mut new: Place) {
        for place in &mut self.list {
            if new.worth > place.worth {
                core::mem::swap(place, &mut new);
            }
        }
    }
}

/// The way to a place, since the last label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Journey {
    now: Rest,
    /// The same after the motion that was planned last.
    next: Rest,
}

/// What is left of a way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Rest {
    /// None was begun.
    #[default]
    None,
    /// It leads here, in so many motions at most.
    To(Site, u16),
    /// It ended without a label. No other is begun before the next one.
    Over,
}

impl Journey {
    /// Records that the motion was made, and whether a label was read.
    pub(crate) fn observe(&mut self, has_label: bool) {
        self.now = if has_label { Rest::None } else { self.next };
        self.next = self.now;
    }

    /// The next motion of the way to a site, and whether a label is to be read at its end. `None` if there is no way, or
    /// if it takes more motions than it may: then the journey is over.
    fn go<D: Dynamics, G: Workspace>(
        &mut self,
        (dynamics, area): (&D, &G),
        pose: Pose,
        site: Site,
        tells: impl Fn(Site) -> bool,
        effort: &mut Effort,
    ) -> Option<(Leg, bool)> {
        self.next = Rest::Over;
        let near = nearness(dynamics);
        let Errand { leg, arrives, motions } =
            errand((dynamics, area), pose, (site, near), effort)?;
        let seems = (motions != UNKNOWN).then_some(u16::from(motions));
        let left = match (self.now, seems) {
            (Rest::To(_, left), _) => left,
            (_, Some(motions)) => motions.saturating_add(MORE),
            (_, None) => {
                let straight = motions_to(dynamics, pose, site);
                ((2.0 * straight) as u16).saturating_add(MORE_ROUND)
            }
        };
        let after = left.checked_sub(1)?;
        if seems.is_some_and(|motions| motions > left) {
            return None;
        }
        // A label where the way ends may tell less than at the place itself.
        let wants_label = arrives && tells(leg.1.site);
        let is_vain = arrives && !wants_label;
        if is_vain && self.now == Rest::None {
            return None;
        }
        if !is_vain {
            self.next = Rest::To(site, after);
        }
        Some((leg, wants_label))
    }
}

/// How near to a place a way ends, lattice units: an eighth of the longest motion, and a step at least.
fn nearness<D: Dynamics>(dynamics: &D) -> f32 {
    let (eighth, step) = (0.125 * dynamics.grid().longest_units(), dynamics.grid().step_units());
    if eighth > step { eighth } else { step }
}
