//! What a follower of fronts knows of its front, in few bytes: for a map, and for the other end of a link.

use crate::belief::front::Waist;

/// Where a front is known best after a motion, and whether it is closed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrontState {
    /// Where the front is known best. `None` as long as it is not found, and where it is lost.
    pub waist: Option<Waist>,
    /// Whether the robot has gone along all of a closed front.
    pub is_closed: bool,
}
