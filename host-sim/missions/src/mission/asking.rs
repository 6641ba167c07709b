//! What labels cost, what they are to bring, and how many there may be.

use planner_core::{Far, Seeks};

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

impl Asking {
    /// Labels are sought within one motion, and there may be as many as there is room for.
    pub const USUAL: Self = Self { price: None, seeks: Seeks::Accuracy, labels: None };

    /// The sight of look-ahead, if labels have a price.
    ///
    /// # Panics
    /// When the price is out of range. Reading scenario files and flags refuses such prices.
    pub fn sight(&self) -> Option<Far> {
        let price = self.price?;
        Some(Far::at_price(price).expect("prices out of range were refused").seeking(self.seeks))
    }
}
