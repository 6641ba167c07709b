//! What labels cost, what they are to bring, and how many there may be: `price`, `labels` and `ask` of scenario files.

use std::str::FromStr;

use anyhow::{Result, bail};
use planner_core::dynamics::Dynamics as _;
use planner_core::link::message::MissionArea;
use planner_core::{AnySight, AnyVehicle, Far};
use serde::{Deserialize, Serialize};

use crate::mission::algorithm::Algorithm;
use crate::mission::strict::wrong;

/// How a mission asks for labels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asking {
    /// What a label costs, metres driven. `None`: labels are sought within one motion (look-ahead).
    pub price: Option<f64>,
    /// Labels at most.
    pub labels: Option<u32>,
    /// Bits that a label must be expected to carry (look-ahead).
    pub worth: f64,
}

/// What a file or flags ask for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Asked {
    /// `price`.
    pub price: Option<Price>,
    /// `labels`.
    pub labels: Option<u32>,
    /// Bits that it must be expected to carry.
    pub worth: Option<f64>,
}

/// `price` of a scenario file and a flag.
///
/// Read from a value, as `results::PTold` is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, try_from = "serde_json::Value")]
pub enum Price {
    /// Metres driven.
    Metres(f64),
    /// Labels are sought within one motion, however large the area is.
    Word(NoPrice),
}

/// The word for no price.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NoPrice {
    /// Near sight.
    None,
}

impl TryFrom<serde_json::Value> for Price {
    type Error = &'static str;

    fn try_from(price: serde_json::Value) -> Result<Self, Self::Error> {
        let none = || (price.as_str()? == "none").then_some(Self::Word(NoPrice::None));
        let metres = price.as_f64().map(Self::Metres);
        metres.or_else(none).ok_or("expected metres driven, or \"none\"")
    }
}

impl FromStr for Price {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        match (text, text.parse()) {
            ("none", _) => Ok(Self::Word(NoPrice::None)),
            (_, Ok(metres)) => Ok(Self::Metres(metres)),
            _ => bail!("found {text}, expected metres driven, or none"),
        }
    }
}

/// `ask` of a scenario file.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AskTable {
    /// Bits that a label must be expected to carry, or it is not read [default: 0]
    worth: Option<f64>,
}

/// The price of a label that fits a mission of so many steps and labels. `None` where look-ahead within one motion is
/// better.
///
/// With the usual price, a fifth of the mean side, the robot drives about once across the area. Where the motions without
/// a label lead less far, the price falls with the square of that. Some are lost: a drive ends beside a place, and a
/// vehicle that goes round to turn needs several to each place.
fn fitting_price(
    area: &MissionArea,
    vehicle: &AnyVehicle,
    (steps, labels): (u32, u32),
) -> Option<f64> {
    let turns = matches!(vehicle, AnyVehicle::Unicycle(_));
    let lost = if turns { 4.0 } else { 5.0 * f64::from(labels) };
    let usual = Far::across(area).price();
    let grid = vehicle.grid();
    let per_motion = f64::from(grid.reach_m(grid.speeds() - 1)) / (5.0 * usual);
    let across = |motions: f64| (motions * per_motion).clamp(0.0, 1.0);
    let led = across(f64::from(steps) - f64::from(labels) - lost);
    // One motion to each label may lead across by itself: then far sight needs half of the way.
    (led > 0.0 && led >= 0.5 * across(labels.into())).then(|| (usual * led * led).max(1e-3))
}

impl Asking {
    /// Labels are sought within one motion, and there may be as many as there is room for.
    pub const USUAL: Self = Self { price: None, labels: None, worth: 0.0 };

    /// What a file or flags ask of a mission of so many `steps`. `names` are those of price, limit and worth. There is room
    /// for `most` labels, of which each carries so many `bits` at most.
    ///
    /// Fewer labels than steps have a price without being given one, which fits the motions.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub fn of(
        [price_name, labels_name, worth_name]: [&str; 3],
        Asked { price, labels, worth }: Asked,
        (algorithm, area, vehicle): (Algorithm, &MissionArea, &AnyVehicle),
        (steps, most, bits): (u32, u32, f64),
    ) -> Result<Self> {
        let looks_ahead = algorithm == Algorithm::Lookahead;
        let fitting = |labels: u32| fitting_price(area, vehicle, (steps, labels));
        let sought = match price {
            Some(Price::Metres(metres)) if metres != 0.0 => Some(metres),
            None if looks_ahead => labels.and_then(fitting),
            _ => None,
        };
        let of_lookahead = [(price_name, price.is_some()), (worth_name, worth.is_some())];
        for (name, is_given) in of_lookahead {
            if is_given && !looks_ahead {
                let found = format!("with algorithm {}", algorithm.name());
                return wrong(name, found, "with algorithm lookahead");
            }
        }
        if let Some(price) = sought
            && Far::at_price(price).is_err()
        {
            return wrong(price_name, price, "metres driven, 0.001 to 16384, or none");
        }
        if let Some(labels) = labels
            && !(1..=most).contains(&labels)
        {
            return wrong(labels_name, labels, format!("1 to {most}, for which there is room"));
        }
        let worth = worth.unwrap_or(0.0);
        if !(0.0..=bits).contains(&worth) {
            let expected = format!("0 to {bits:.3} bits, as many as a label can carry");
            return wrong(worth_name, worth, expected);
        }
        Ok(Self { price: sought, labels, worth })
    }

    /// Whether labels are limited by themselves, so that a mission may have more steps than there is room for labels.
    pub fn is_apart(&self) -> bool {
        self.price.is_some() || self.labels.is_some() || self.worth > 0.0
    }

    /// Whether so many labels are as many as there may be.
    pub fn is_enough(&self, labels: u32) -> bool {
        self.labels.is_some_and(|most| labels >= most)
    }

    /// The sight of look-ahead.
    ///
    /// # Panics
    /// When price or worth is out of range. Reading scenario files and flags refuses such ones.
    pub fn sight(&self) -> AnySight {
        let far = |price| Far::at_price(price).expect("prices out of range were refused");
        let labels = self.labels.map_or(0, |labels| labels.try_into().unwrap_or(u16::MAX));
        let far = self.price.map(|price| far(price).with_labels(labels));
        let sight = AnySight::from(far).with_least_bits(self.worth);
        sight.expect("worths out of range were refused")
    }
}

impl AskTable {
    /// All that a file asks for, with its price and its limit of labels.
    pub fn with(&self, price: Option<Price>, labels: Option<u32>) -> Asked {
        Asked { price, labels, worth: self.worth }
    }
}
