//! Far sight: labels are sought all along the estimate, at a price.
//!
//! The labels that tell the most of a line lie far apart. So a plan considers places along the estimate, beside the ends
//! of one motion. Each costs (`outlook.rs`) the way there, and the error that is left after the next labels.
//!
//! The planner goes to the place that costs the least, by several motions without a label. It plans the way anew after
//! each of them. Where an end of the next motion costs less by then, it asks there.
//!
//! The price is the one number that says what a user wants: few labels, or little driving. With the number of labels
//! that a mission has, the planner reads most of them near two far places, and drives between them once or twice.

use crate::belief::Belief as _;
use crate::belief::goal::{Criterion, Goal};
use crate::belief::predictions::{Prediction, PredictiveBelief};
use crate::geometry::lattice::{Site, UNITS_PER_METRE};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::decision::Decision;
use crate::planner::outlook::Outlook;
use crate::search::chord::Chord;
use crate::search::errand::{Errand, UNKNOWN, errand, motions_to};
use crate::search::lookout::{Lookout, many};
use crate::search::motions::Leg;
use crate::search::objective::Effort;

/// Places along the estimate.
const ALONG: u16 = 9;

/// A label where a way ends is read if it is expected to tell so much, as a share of the most that one can. Else the next
/// plan finds a better place in reach. An end of a motion has to tell this share of what the best end does: a label that
/// hardly any line doubts shrinks the variance by much, but seldom.
const WORTHWHILE: f32 = 0.9;

/// Places along the estimate are moved across it until the chance that a line is above differs from one half by less.
const LEVEL: f32 = 0.05;

/// Shares of lines that this takes at most for each place.
const ASKS: usize = 12;

/// Places along the estimate begin and end at this share of it.
const END: f32 = 0.01;

/// Places to which a plan seeks a way.
const TRIES: usize = 3;

/// The looks of these ways together.
pub(crate) const FAR_LOOKS: u32 = 2_048;

/// A way may take so many motions more than it seems to at its beginning. One that needs more goes round about its place.
const MORE: u16 = 2;

/// Where keep-outs lie between, a way may take twice as many motions as lead straight there, and so many more.
const MORE_ROUND: u16 = 16;

/// The usual price of a label, as a share of the mean of the area's sides.
const USUAL: f32 = 0.2;

/// All of the area, one label deep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Far {
    /// What a label costs, millimetres of driving.
    price_mm: u32,
    /// The labels of the mission at ends of motions; 0 if nobody knows.
    labels: u16,
}

impl Far {
    /// A label costs as much as a drive of so many metres, to the nearest millimetre. The higher the price, the farther
    /// the planner drives for each label. A label that costs nothing needs no far sight.
    ///
    /// # Errors
    /// [`ValueError`] unless it is above 0, and 16,384 m at most.
    pub fn at_price(metres: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError =
            ValueError("the price of a label is above 0 and at most 16384 m of driving");
        let price_mm = libm::round(metres * 1e3) as u32;
        let is_price = price_mm > 0 && metres <= 16_384.0;
        is_price.then_some(Self { price_mm, labels: 0 }).ok_or(RANGE)
    }

    /// At the usual price: a fifth of the mean of the sides of the rectangle around an area.
    pub fn across(area: &impl Workspace) -> Self {
        Self::part(area, USUAL)
    }

    /// At so large a share of the mean of these sides.
    pub(crate) fn part(area: &impl Workspace, share: f32) -> Self {
        let price = f64::from(share * area.bounds().mean_side());
        let price_mm = libm::round(price * 1e3 / f64::from(UNITS_PER_METRE)) as u32;
        Self { price_mm: price_mm.max(1), labels: 0 }
    }

    /// The same for a mission of so many labels in all, at ends of motions. The planner drives little, and knows the line
    /// well after the last of them. With 0, as without, it aims to know the line well after each.
    #[must_use]
    pub const fn with_labels(self, labels: u16) -> Self {
        Self { labels, ..self }
    }

    /// What a label costs, metres of driving.
    pub fn price(self) -> f64 {
        f64::from(self.price_mm) * 1e-3
    }
}

impl Far {
    /// What to do next; `None` if no label is in sight.
    pub(crate) fn decide<B, P, D, G, C>(
        self,
        (belief, predictor): (&B, &P),
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
        (goal, journey): (Option<Goal<C>>, &mut Journey),
    ) -> Option<Decision>
    where
        B: PredictiveBelief,
        P: Prediction,
        D: Dynamics,
        G: Workspace,
        C: Criterion,
    {
        let bounds = lookout.area.bounds();
        let chord = Chord::of(belief.belief().centre()?, bounds)?;
        let price = self.price_mm as f32 * (1e-3 * UNITS_PER_METRE as f32);
        let to_come = journey.to_come(self.labels);
        let bits = belief.capacity() * predictor.most();
        let outlook = Outlook::of(belief, bounds, (price, bits), to_come, goal)?;
        let worth = |site: Site| -outlook.cost(site, pose.site);
        let best = best_end((belief, predictor), lookout, pose, worth);
        let most = best.as_ref().map_or(f32::NEG_INFINITY, |best| best.worth);
        let mut places = FarPlaces::NONE;
        let mut consider = |site| places.add(FarPlace { site, worth: worth(site) });
        match journey.now {
            Rest::None => sites(predictor, &chord, outlook.deviation())
                .filter(|site| tells(belief, predictor, lookout, *site, 0.0))
                .for_each(consider),
            Rest::To(site, _) => consider(site),
            Rest::Over => {}
        }
        journey.next = journey.now;
        let mut effort = Effort::within(&lookout.area, FAR_LOOKS);
        for FarPlace { site, worth } in places.list.into_iter().take_while(|it| it.worth > most) {
            let tells = |site| tells(belief, predictor, lookout, site, WORTHWHILE);
            let to = (site, nearness(lookout));
            let leg = journey.go((lookout.dynamics, &lookout.area), pose, to, tells, &mut effort);
            if let Some(((action, target), wants_label)) = leg {
                return Some(Decision { action, target, worth, wants_label, is_far: true });
            }
        }
        best
    }
}

/// The best of the ends of the next motion whose labels tell about as much as any.
fn best_end<B: PredictiveBelief, P: Prediction, D: Dynamics, G: Workspace>(
    (belief, predictor): (&B, &P),
    lookout: &mut Lookout<'_, D, G>,
    pose: Pose,
    worth: impl Fn(Site) -> f32,
) -> Option<Decision> {
    let ends = many(predictor, belief.ground(), lookout, pose);
    let least = ends.first().map_or(0.0, |most| WORTHWHILE * most.worth);
    let mut best = None;
    for it in ends.iter().filter(|it| it.worth >= least) {
        let (action, target, worth) = (it.action, it.target, worth(it.target.site));
        Decision { action, target, worth, wants_label: true, is_far: false }.beat(&mut best);
    }
    best
}

/// Sites along the estimate, where lines deviate from it by so many lattice units. A few unlikely lines far off draw the
/// estimate, as it is their mean, away from where both labels are as likely. So each site lies there.
fn sites<P: Prediction>(
    predictor: &P,
    chord: &Chord,
    deviation: f32,
) -> impl Iterator<Item = Site> {
    (0..ALONG).filter_map(move |k| {
        let along = END + (1.0 - 2.0 * END) * f32::from(k) / f32::from(ALONG - 1);
        let mut site = chord.site(along, 0.0)?;
        let (mut aside, mut step) = (0.0, 0.125 * deviation);
        let (mut was_right, mut has_crossed) = (None, false);
        for _ in 0..ASKS {
            let off = predictor.share_above(site) - 0.5;
            if off.abs() < LEVEL {
                break;
            }
            // The farther to the left a place lies, the more lines have it on their +1 side.
            let is_right = off < 0.0;
            has_crossed |= was_right.is_some_and(|was| was != is_right);
            was_right = Some(is_right);
            step *= if has_crossed { 0.5 } else { 2.0 };
            aside += if is_right { step } else { -step };
            site = chord.site(along, aside)?;
        }
        Some(site)
    })
}

/// Whether a label at a site is expected to tell so much, and may be read.
fn tells<B: PredictiveBelief, P: Prediction, D: Dynamics, G: Workspace>(
    belief: &B,
    predictor: &P,
    lookout: &Lookout<'_, D, G>,
    site: Site,
    least: f32,
) -> bool {
    let share = predictor.share_above(site);
    let information = predictor.information(site, share);
    share > 0.0
        && share < 1.0
        && information >= lookout.least
        && information >= least
        && lookout.area.contains(site)
        && belief.ground().may_tell(site)
}

/// A place beyond the ends of one motion, and what it is worth.
#[derive(Clone, Copy)]
struct FarPlace {
    site: Site,
    worth: f32,
}

/// The best places, the best first.
struct FarPlaces {
    list: [FarPlace; TRIES],
}

impl FarPlaces {
    const NONE: Self =
        Self { list: [FarPlace { site: Site::ORIGIN, worth: f32::NEG_INFINITY }; TRIES] };

    fn add(&mut self, mut new: FarPlace) {
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
    /// Labels that were read at ends of motions since the mission began.
    labels: u16,
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
        self.labels = self.labels.saturating_add(has_label.into());
    }

    /// Labels that come after the next one, of so many in all; `None` if nobody knows.
    fn to_come(self, all: u16) -> Option<u16> {
        (all > 0).then(|| all.saturating_sub(self.labels).saturating_sub(1))
    }

    /// Forgets the way.
    pub(crate) fn forget(&mut self) {
        (self.now, self.next) = (Rest::None, Rest::None);
    }

    /// The next motion of the way to a site, and whether a label is to be read at its end. `None` if there is no way, or
    /// if it takes more motions than it may: then the journey is over.
    fn go<D: Dynamics, G: Workspace>(
        &mut self,
        (dynamics, area): (&D, &G),
        pose: Pose,
        (site, near): (Site, f32),
        tells: impl Fn(Site) -> bool,
        effort: &mut Effort,
    ) -> Option<(Leg, bool)> {
        self.next = Rest::Over;
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
        if wants_label || !arrives {
            self.next = Rest::To(site, after);
        }
        Some((leg, wants_label))
    }
}

/// How near to a place a way ends, lattice units: an eighth of the longest motion that is usual, and a step at least.
fn nearness<D: Dynamics, G: Workspace>(lookout: &Lookout<'_, D, G>) -> f32 {
    let step = lookout.dynamics.grid().step_units();
    let eighth = 0.125 * f32::from(lookout.usual) * step;
    if eighth > step { eighth } else { step }
}

#[cfg(test)]
mod tests {
    use super::Journey;

    #[test]
    fn labels_to_come_are_never_below_none() {
        let read = |labels| Journey { labels, ..Journey::default() };
        assert_eq!(read(3).to_come(10), Some(6));
        assert_eq!(read(3).to_come(0), None);
        for labels in [9, 10, 11, u16::MAX] {
            let mut journey = read(labels);
            journey.observe(true);
            assert_eq!(journey.to_come(10), Some(0));
        }
    }
}
