//! How far look-ahead looks for labels: one motion ([`Near`]), or all of the area ([`Far`]).
//!
//! Where the area is large for the reach of one motion, the labels that tell the most lie far apart. [`Far`] sight
//! considers places all over the area beside the ends of one motion: some along the estimate, some anywhere. A place is
//! worth
//!
//! ```text
//! what its label is expected to bring / (price of a label + way to get there)
//! ```
//!
//! and the planner goes to the one that is worth the most, by several motions without a label. It plans the way anew after
//! each of them. It asks on the way where that has become worth more, and goes on to the place after a label only if it
//! is still the best.
//!
//! The price is the one number that says what a user wants: few labels, or little driving.

use crate::belief::Belief as _;
use crate::belief::predictions::{Prediction as _, PredictiveBelief, Spread as _};
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
use crate::search::objective::Effort;

/// Places along the estimate, and others all over the area.
const ALONG: u16 = 17;
const PLACES: u32 = 36;

/// Places along the estimate begin and end at this share of it.
const END: f32 = 0.01;

/// Places to which a plan seeks a way.
const TRIES: usize = 3;

/// The looks of these ways together.
const LOOKS: u32 = 2_048;

/// Motions to a place at most: so many more than a way seems to take at its beginning. What needs more goes round about
/// the place. Where keep-outs lie between, twice as many as lead straight there, and so many more.
const MORE: u16 = 2;
const MORE_ROUND: u16 = 16;

/// The usual price of a label, as a share of the mean of the area's sides.
const USUAL: f64 = 0.125;

/// An area is large if its mean side is longer than so many of the longest motions.
const LARGE: f32 = 16.0;

/// How far look-ahead looks for labels: [`Near`] or [`Far`].
pub trait Sight: Copy {
    /// Looks that it takes of a plan, beside those at ends of one motion.
    #[doc(hidden)]
    fn looks(self) -> u32 {
        0
    }

    /// The sight that a price asks for, or that none does, if this is one.
    #[doc(hidden)]
    fn of(far: Option<Far>) -> Option<Self>;

    /// What is remembered since the last label.
    #[doc(hidden)]
    type Journey: Copy + core::fmt::Debug + Default + PartialEq;

    /// What to do next; `None` if no label is in sight.
    #[doc(hidden)]
    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Self::Journey,
    ) -> Option<Decision>;

    /// Records that the motion was made, and whether a label was read.
    #[doc(hidden)]
    fn observe(journey: &mut Self::Journey, has_label: bool);
}

/// As far as one motion leads, two labels deep.
#[derive(Clone, Copy, Debug)]
pub struct Near;

impl Sight for Near {
    type Journey = ();

    fn of(far: Option<Far>) -> Option<Self> {
        far.is_none().then_some(Self)
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        (): &mut (),
    ) -> Option<Decision> {
        Decision::of(belief, lookout, pose)
    }

    fn observe((): &mut (), _: bool) {}
}

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
    /// Lines that lie closer together over the area: little misclassified ground after few labels. It counts the expected
    /// information times the share of the lines' variance that the label is expected to remove.
    #[default]
    Accuracy,
    /// Information alone: much of it for little driving.
    Bits,
}

impl Far {
    /// A label costs as much as a drive of so many metres, to the nearest millimetre. With a high price the planner
    /// drives far for each label, with 0 it asks at the next good place.
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
        let sides = area.bounds().half_sides().map(f64::from).into_iter().sum::<f64>();
        let price_mm = (USUAL * 1e3 / f64::from(UNITS_PER_METRE) * sides) as u32;
        Self { price_mm, seeks: Seeks::Accuracy }
    }

    /// At the usual price where an area is so large for the longest motion that far sight pays: its mean side is more
    /// than sixteen such motions. `None` elsewhere.
    pub fn usual(area: &impl Workspace, dynamics: &impl Dynamics) -> Option<Self> {
        let sides = area.bounds().half_sides().map(|half| half as f32).into_iter().sum::<f32>();
        (sides > LARGE * reach(dynamics)).then(|| Self::across(area))
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

/// The way to a place, since the last label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Journey {
    now: Stretch,
    /// The same after the motion that was planned last.
    next: Stretch,
}

/// What is left of a way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum Stretch {
    /// None was begun.
    #[default]
    None,
    /// It leads here, in so many motions at most.
    To(Site, u16),
    /// It ended without a label. No other is begun before the next one.
    Over,
}

impl Sight for Far {
    type Journey = Journey;

    fn of(far: Option<Far>) -> Option<Self> {
        far
    }

    fn looks(self) -> u32 {
        LOOKS
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Journey,
    ) -> Option<Decision> {
        let chord = Chord::of(belief.belief().centre()?, lookout.area.bounds())?;
        let predictor = belief.predictor(pose.site);
        let spread = match self.seeks {
            Seeks::Accuracy => chord.stretch().map(|over| belief.spread(&over)),
            Seeks::Bits => None,
        };
        let price = self.price_mm as f32 * (1e-3 * UNITS_PER_METRE as f32) + 1.0;
        let worth = |site: Site, share: f32| {
            let told = predictor.information(site, share);
            let brings = spread.as_ref().map_or(1.0, |spread| spread.reduction(site)) * told;
            brings / (price + distance(site - pose.site))
        };
        let mut best = None;
        for it in prospects(&predictor, belief.ground(), lookout, pose).as_slice() {
            let (action, target, worth) = (it.action, it.target, worth(it.target.site, it.share));
            Decision { action, target, worth, wants_label: true, is_far: false }.beat(&mut best);
        }
        let most = best.as_ref().map_or(0.0, |best| best.worth);
        let mut places = Places::NONE;
        let of = |site: Site| Place { site, worth: worth(site, predictor.share_above(site)) };
        match journey.now {
            Stretch::None => {
                let along = |k: u16| {
                    let share = END + (1.0 - 2.0 * END) * f32::from(k) / f32::from(ALONG - 1);
                    chord.site(share, 0.0)
                };
                let anywhere = (0..PLACES).map(|k| place(&lookout.area, k));
                for site in (0..ALONG).map(along).chain(anywhere).flatten() {
                    if tells(belief, &predictor, lookout, site) {
                        places.add(of(site));
                    }
                }
            }
            Stretch::To(site, _) => places.add(of(site)),
            Stretch::Over => {}
        }
        let mut effort = Effort::of(LOOKS);
        journey.next = journey.now;
        for Place { site, worth } in places.list.into_iter().take_while(|it| it.worth > most) {
            let with = (lookout.dynamics, &lookout.area);
            let near = nearness(lookout.dynamics);
            let way = errand(with, pose, (site, near), &mut effort);
            if let Some(Errand { leg: (action, target), arrives, motions }) = way {
                let seems = (motions != UNKNOWN).then_some(u16::from(motions));
                let left = match (journey.now, seems) {
                    (Stretch::To(_, left), _) => left,
                    (_, Some(motions)) => motions.saturating_add(MORE),
                    (_, None) => {
                        let straight = motions_to(lookout.dynamics, pose, site);
                        (2.0 * straight) as u16 + MORE_ROUND
                    }
                };
                if let Some(after) = left.checked_sub(1)
                    && seems.is_none_or(|motions| motions <= left)
                {
                    // What can be reached of the place may lie on certain ground.
                    let wants_label = arrives && belief.ground().may_tell(target.site);
                    let is_over = arrives && !wants_label;
                    journey.next = if is_over { Stretch::Over } else { Stretch::To(site, after) };
                    return Some(Decision { action, target, worth, wants_label, is_far: true });
                }
            }
            journey.next = Stretch::Over;
        }
        best
    }

    fn observe(journey: &mut Journey, has_label: bool) {
        journey.now = if has_label { Stretch::None } else { journey.next };
        journey.next = journey.now;
    }
}

/// [`Near`], or [`Far`] where there is a price: for programs that are told at run time.
impl Sight for Option<Far> {
    type Journey = Journey;

    fn of(far: Option<Far>) -> Option<Self> {
        Some(far)
    }

    fn decide<B: PredictiveBelief, D: Dynamics, G: Workspace>(
        self,
        belief: &B,
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        journey: &mut Journey,
    ) -> Option<Decision> {
        match self {
            None => Near.decide(belief, lookout, pose, &mut ()),
            Some(far) => far.decide(belief, lookout, pose, journey),
        }
    }

    fn observe(journey: &mut Journey, has_label: bool) {
        Far::observe(journey, has_label);
    }

    fn looks(self) -> u32 {
        self.map_or(0, Sight::looks)
    }
}

/// Whether a label at a place is to be considered.
fn tells<B: PredictiveBelief, D: Dynamics, G: Workspace>(
    belief: &B,
    predictor: &B::Predictor<'_>,
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

/// How near to a place a way ends, lattice units: an eighth of the longest motion, and a step at least.
fn nearness<D: Dynamics>(dynamics: &D) -> f32 {
    let (eighth, step) = (0.125 * reach(dynamics), dynamics.grid().step_units());
    if eighth > step { eighth } else { step }
}

/// The longest motion, lattice units.
fn reach(dynamics: &impl Dynamics) -> f32 {
    let grid = dynamics.grid();
    f32::from(grid.speeds().saturating_sub(1)) * grid.step_units()
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
