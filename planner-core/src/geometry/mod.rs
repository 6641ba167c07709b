//! Points, directions and lines in the plane, in integers: what everything else is decided by.
//!
//! A position is a site of a lattice, a heading a binary angle, a displacement two integers; one predicate,
//! [`lattice::orient`], says on which side of a line a site lies, exactly. Approximations in single
//! precision only propose, with their errors stated.

pub(crate) mod angle;
pub(crate) mod approximate;
pub mod arc;
pub mod area;
pub mod heading;
pub mod hull;
pub mod lattice;
pub mod line;
pub mod local_line;
pub mod region;
pub mod terrain;
