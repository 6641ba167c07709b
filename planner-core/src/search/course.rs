//! A way of several motions that a plan begins when it finds nothing better. The next plans follow it to its end.
//!
//! If they did not follow it, each would begin another way, as the best way depends on where the robot is.

use crate::geometry::lattice::Site;
use crate::motion::action::Action;

/// Motions after the first of a way.
pub(crate) const REST: usize = 5;

/// What is left of such a way. A label ends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Course {
    /// Its motions in reverse order: the next one is at index `left - 1`. A label is read after the one at index 0.
    rest: [Action; REST],
    /// The number of motions left.
    left: u8,
    /// The number of motions made so far to try from elsewhere.
    pub(crate) tries: u8,
    pub(crate) far: Excursion,
}

/// A drive to open ground beyond reach. At most one is made between two labels, so that the robot does not drive back
/// and forth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Excursion {
    /// There was none.
    #[default]
    Not,
    /// On the way to here.
    To(Site),
    /// It is over.
    Over,
}

impl Course {
    /// Nothing was begun since the last label.
    pub(crate) const NONE: Self =
        Self { rest: [Action(0); REST], left: 0, tries: 0, far: Excursion::Not };

    /// Begins another way.
    pub(crate) fn begin_way(&mut self, motions: impl DoubleEndedIterator<Item = Action>) {
        self.give_up_way();
        for (place, motion) in self.rest.iter_mut().zip(motions.rev()) {
            *place = motion;
            self.left += 1;
        }
    }

    /// Takes the next motion, and says whether it is the last.
    pub(crate) fn next(&mut self) -> Option<(Action, bool)> {
        self.left = self.left.checked_sub(1)?;
        let motion = self.rest.get_mut(usize::from(self.left))?;
        Some((core::mem::replace(motion, Action(0)), self.left == 0))
    }

    /// Gives up its way.
    pub(crate) fn give_up_way(&mut self) {
        if self.left > 0 {
            (self.rest, self.left) = (Self::NONE.rest, 0);
        }
    }
}

impl Default for Course {
    fn default() -> Self {
        Self::NONE
    }
}
