//! The integers that positions are made of, and the two predicates that decide on them.
//!
//! A [`Site`](crate::Site) is a point of the lattice. A [`Workspace`](crate::Workspace) of your own decides with these,
//! so that no rounding lets a motion out.

pub use crate::geometry::hull::are_apart;
pub use crate::geometry::lattice::{LIMIT, UNITS_PER_METRE, orient};
