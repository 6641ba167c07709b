//! The search for the best action, given what is known. It solves the paper's one-step problems exactly by looking at
//! only a few actions.
//!
//! A [`problem`] asks for the longest cheap motion that ends on uncertain ground in an allowed direction
//! ([`direction_rule`]). The positions of one speed lie on a circle around the agent. Lines bound the uncertain ground,
//! and their crossings with the circle show which rays can be skipped.
//!
//! If no action is feasible, a ladder of recoveries takes over. It leads round keep-outs if necessary (`detour`). A
//! vehicle that cannot turn on the spot makes a `manoeuvre`, of `motions`. Look-ahead searches the same circles for the places where
//! labels tell the most (`lookout`). An `errand` leads to a given place, and a `route` over an area of which
//! nothing is known. A `chord` is the part of an estimate that lies in
//! the area.

mod channel;
pub(crate) mod chord;
pub(crate) mod circles;
pub(crate) mod course;
pub(crate) mod crossing;
pub(crate) mod dead_end;
pub(crate) mod detour;
pub(crate) mod direction_rule;
pub(crate) mod errand;
pub(crate) mod lookout;
pub(crate) mod manoeuvre;
pub(crate) mod motions;
pub(crate) mod objective;
pub(crate) mod places;
pub(crate) mod problem;
pub(crate) mod recovery;
pub(crate) mod route;
pub(crate) mod view;
pub(crate) mod wander;
