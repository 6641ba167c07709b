//! Points, directions and lines in the plane, in integers: what everything else is decided by.
//!
//! A position is a site of a lattice, a heading a binary angle, a displacement two integers; one predicate,
//! [`lattice::orient`], says on which side of a line a site lies, exactly. Approximations in single
//! precision only propose, with their errors stated.

pub(crate) mod approximate;
pub mod area;
pub mod direction;
pub mod lattice;
pub mod line;
