//! What labels cost, what they are to bring, and how many there may be: `price`, `labels` and `ask` of scenario files.

use std::str::FromStr;

use anyhow::{Result, bail};
use planner_core::link::message::MissionArea;
use planner_core::{AnyVehicle, Far, Seeks};
use serde::{Deserialize, Serialize};

use crate::mission::algorithm::Algorithm;
use crate::mission::names::SeeksName;
use crate::mission::strict::wrong;

/// How a mission asks for labels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Asking {
    /// What a label costs, metres driven. `None`: labels are sought within one motion (look-ahead).
    pub price: Option<f64>,
    /// What a label is to bring (look-ahead with a price).
    pub seeks: Seeks,
    /// Labels at most.
    pub labels: Option<u32>,
}

/// `price` of a scenario file and a flag.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected metres driven, or \"none\"")]
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
    seek: Option<SeeksName>,
}

impl Asking {
    /// Labels are sought within one motion, and there may be as many as there is room for.
    pub const USUAL: Self = Self { price: None, seeks: Seeks::Accuracy, labels: None };

    /// What a file or flags ask for. Without a price labels have the usual one where the area is large for the vehicle.
    /// `names` are those of price, limit and choice; there is room for `most` labels.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub fn of(
        [price_name, labels_name, seek_name]: [&str; 3],
        (price, labels, seek): (Option<Price>, Option<u32>, Option<SeeksName>),
        (algorithm, area, vehicle): (Algorithm, &MissionArea, &AnyVehicle),
        most: u32,
    ) -> Result<Self> {
        let looks_ahead = algorithm == Algorithm::Lookahead;
        let usual = if looks_ahead { Far::usual(area, vehicle).map(Far::price) } else { None };
        let sought = match price {
            Some(Price::Metres(metres)) => Some(metres),
            Some(Price::Word(NoPrice::None)) => None,
            None => usual,
        };
        for (name, is_given) in [(price_name, price.is_some()), (seek_name, seek.is_some())] {
            if is_given && !looks_ahead {
                let found = format!("with algorithm {}", algorithm.name());
                return wrong(name, found, "with algorithm lookahead");
            }
        }
        if let Some(Price::Metres(price)) = price
            && Far::at_price(price).is_err()
        {
            return wrong(price_name, price, "metres driven, 0 to 16384, or none");
        }
        if seek.is_some() && sought.is_none() {
            let expected =
                format!("with a {price_name}: a label within one motion is to bring bits");
            return wrong(seek_name, "one", expected);
        }
        if let Some(labels) = labels
            && !(1..=most).contains(&labels)
        {
            return wrong(labels_name, labels, format!("1 to {most}, for which there is room"));
        }
        Ok(Self { price: sought, seeks: seek.unwrap_or_default().into(), labels })
    }

    /// Whether labels are limited by themselves, so that a mission may have more steps than there is room for labels.
    pub fn is_apart(&self) -> bool {
        self.price.is_some() || self.labels.is_some()
    }

    /// Whether so many labels are as many as there may be.
    pub fn is_enough(&self, labels: u32) -> bool {
        self.labels.is_some_and(|most| labels >= most)
    }

    /// The sight of look-ahead, if labels have a price.
    ///
    /// # Panics
    /// When the price is out of range. Reading scenario files and flags refuses such prices.
    pub fn sight(&self) -> Option<Far> {
        let price = self.price?;
        Some(Far::at_price(price).expect("prices out of range were refused").seeking(self.seeks))
    }
}

impl AskTable {
    /// What a label is to bring.
    pub fn seek(&self) -> Option<SeeksName> {
        self.seek
    }
}
