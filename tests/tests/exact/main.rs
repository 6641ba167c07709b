//! What the planner computes, beside slow twins and exact arithmetic.

mod construction;
mod dynamics;
mod estimates;
mod exact_geometry;
mod goals;
mod hypotheses;
mod lines;
mod own_tolerances;
mod predictor;
mod reference;
mod room;
mod scc;
mod search;
mod spread;
mod tolerance;
mod version_space;
