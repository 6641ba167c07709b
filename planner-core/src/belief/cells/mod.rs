//! The lines that agree with some labels: a *cell*, stored as a cyclic list of sample indices, and what can be read off
//! it. A version space is one cell, and each hypothesis is one.

mod cell_view;
mod constraint;
mod dual_cell;
mod moments;
mod trapezoids;

pub use cell_view::{CellView, Certainty};
pub(crate) use cell_view::{Kept, intercepts, run_length};
pub use constraint::Constraint;
pub use dual_cell::{Cut, CutError, DualCell};
pub(crate) use moments::Moments;
pub(crate) use trapezoids::{Trapezoid, Trapezoids, measure};
