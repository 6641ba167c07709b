//! The best action for what is known: the paper's one-step problems, solved exactly by looking at a few
//! of the actions.
//!
//! A [`problem`] asks for the longest cheap motion that ends on uncertain ground in an allowed direction
//! ([`direction_rule`]). The positions of one speed lie on a circle around the agent; where a line that
//! bounds the uncertain ground crosses that circle says which rays can be passed over. Where no action
//! is feasible a ladder of recoveries leads on, round keep-outs if need be (`detour`), or for a vehicle that
//! cannot turn on the spot a `manoeuvre`. Look-ahead searches the same circles for the places where labels tell the
//! most (`lookout`).

pub(crate) mod circles;
pub(crate) mod course;
pub(crate) mod crossing;
pub(crate) mod dead_end;
mod detour;
pub mod direction_rule;
pub(crate) mod lookout;
pub(crate) mod manoeuvre;
pub mod objective;
pub mod problem;
pub mod recovery;
pub(crate) mod view;
pub(crate) mod wander;
