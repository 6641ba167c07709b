//! When a follower reads on certain ground: a label there tells a sensor that reads at random or the opposite.

use crate::belief::sample::{Label, Reading};

/// After so many labels one is read on certain ground, if that is near; after so many it may be far.
const NEARBY: u8 = 14;
const FAR: u8 = 22;
const AUDIT: u8 = FAR + 3;

/// After one that surprises, the next comes so much before the far one.
const SOON: u8 = 2;

/// Near and far are so many reaches beside the front.
const BESIDE: f32 = 0.5;
const ANYWHERE: f32 = 2.0;

/// Which label along the front is the next, of as many as there are from one on certain ground to the next but one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Turns(u8);

impl Turns {
    /// Whether there is such a turn.
    pub(crate) const fn is_possible(self) -> bool {
        self.0 < 2 * AUDIT
    }

    /// The side on which a label on certain ground is due, on either in turn, and how far from the front at most.
    pub(crate) fn due(self) -> Option<(f32, f32)> {
        let side = if self.0 < AUDIT { 1.0 } else { -1.0 };
        match self.0 % AUDIT {
            0..NEARBY => None,
            NEARBY..FAR => Some((side, BESIDE)),
            _ => Some((side, ANYWHERE)),
        }
    }

    /// Takes in a label. One was certain there, or none was.
    pub(crate) fn hear(&mut self, reading: Reading, certain: Option<Label>) {
        self.0 = match certain {
            Some(label) if self.due().is_some() => {
                let next = (self.0 / AUDIT + 1) % 2 * AUDIT;
                if reading == label.into() { next } else { next + FAR - SOON }
            }
            _ => (self.0 + 1) % (2 * AUDIT),
        };
    }
}
