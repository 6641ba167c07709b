//! What is told of a front, and what is known of it at a place.

mod learnt;
mod plane;
mod settings;
mod waist;

pub(crate) use learnt::Learnt;
pub(crate) use plane::{Unit, angle, limited, metres, radians};
pub use settings::{Front, FrontStretch};
pub(crate) use waist::NINETY;
pub use waist::{Beside, Waist};
