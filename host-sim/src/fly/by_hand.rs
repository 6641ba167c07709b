//! Labels before the flight, while an operator drives the vehicle: one at each place where it rests.

use planner_core::Label;

use crate::fly::frame::Ned;
use crate::fly::label::Told;
use crate::fly::limits::{SETTLED_MS, WOBBLES};
use crate::fly::slide::Slide;
use crate::fly::stage::Rest;
use crate::fly::vehicle::{Fix, RESTART_MS};

/// What is new.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ByHandNews {
    /// A label, and where it was read.
    Label(Ned, Label),
    /// Positions count from elsewhere now: labels from before lie at other places than they said.
    Moved,
}

/// An operator drives. Times are the vehicle's.
#[derive(Clone, Debug)]
pub(crate) struct ByHand {
    /// Two labels in a row are at least so far apart, metres.
    apart: f64,
    /// How far positions may be off, metres.
    tolerance: f64,
    slide: Slide,
    last: Option<Fix>,
    /// Where the last label was read.
    read: Option<Ned>,
    rest: Option<Rest>,
    /// Since when it counts as at rest.
    rests: Option<u32>,
    told: Option<Told>,
}

impl ByHand {
    /// Nothing was read yet.
    pub(crate) fn new(apart: f64, tolerance: f64) -> Self {
        let (slide, told) = (Slide::default(), None);
        Self { apart, tolerance, slide, last: None, read: None, rest: None, rests: None, told }
    }

    /// Takes in a label. One from before the vehicle came to rest does not count.
    pub(crate) fn hear(&mut self, told: Told) {
        self.told = Some(told);
    }

    /// Positions count from elsewhere now.
    pub(crate) fn moved(&mut self) -> Option<ByHandNews> {
        let has_read = self.read.is_some();
        *self = Self::new(self.apart, self.tolerance);
        has_read.then_some(ByHandNews::Moved)
    }

    /// Takes in a position.
    pub(crate) fn locate(&mut self, fix: Fix) -> Option<ByHandNews> {
        let is_anew = self.last.is_some_and(|last| fix.at_ms + RESTART_MS < last.at_ms);
        if is_anew || self.slide.take(fix, self.tolerance).is_some() {
            return self.moved();
        }
        self.last = Some(fix);
        let rest = Rest::by(self.rest, fix, WOBBLES);
        self.rest = Some(rest);
        let rests = rest.is_calm(fix, SETTLED_MS) || rest.is_long(fix);
        self.rests = self.rests.or(Some(fix.at_ms)).filter(|_| rests);
        // It was there before the label, and is there after it.
        let since = self.rests?;
        let told = self.told.filter(|told| (since..=fix.at_ms).contains(&told.at_ms))?;
        if self.read.is_some_and(|it| it.distance(fix.at) < self.apart) {
            return None;
        }
        self.read = Some(fix.at);
        Some(ByHandNews::Label(fix.at, told.label))
    }
}
