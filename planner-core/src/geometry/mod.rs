//! Points, directions and lines in the plane, in integers. Every decision in the crate rests on them.
//!
//! A position is a site of a lattice, a heading is a binary angle, and a displacement is two integers. One predicate,
//! [`lattice::orient`], computes exactly on which side of a line a site lies. Approximations in single precision only
//! propose, and state their errors.

pub(crate) mod angle;
pub(crate) mod approximate;
pub(crate) mod arc;
pub(crate) mod area;
pub(crate) mod chart;
pub(crate) mod charted;
pub(crate) mod heading;
pub(crate) mod hull;
pub(crate) mod lattice;
pub(crate) mod line;
pub(crate) mod local_line;
pub(crate) mod mark;
pub(crate) mod polygon_area;
pub(crate) mod span;
pub(crate) mod value;
pub(crate) mod walk;
pub(crate) mod workspace;
