//! Points, directions and lines in the plane, in integers. Every decision in the crate rests on them.
//!
//! A position is a site of a lattice, a heading is a binary angle, and a displacement is two integers. One predicate,
//! [`lattice::orient`], computes exactly on which side of a line a site lies. Approximations in single precision only
//! propose, and state their errors.

pub(crate) mod angle;
pub(crate) mod approximate;
pub mod arc;
pub mod area;
pub mod chart;
pub mod charted;
pub mod heading;
pub mod hull;
pub mod lattice;
pub mod line;
pub mod local_line;
pub mod mark;
pub mod polygon_area;
pub(crate) mod span;
pub mod value;
pub mod workspace;
