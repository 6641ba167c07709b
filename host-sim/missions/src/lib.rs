//! Missions in simulated worlds, and what campaigns measure over many of them: the part of `host-sim` that computes.
//!
//! It is a crate of its own because a build need optimise no more than this.

#![forbid(unsafe_code)]
#![cfg_attr(
    target_family = "wasm",
    allow(dead_code, clippy::zero_sized_map_values, reason = "some is not for a browser")
)]

pub mod campaign;
pub mod fitting;
pub mod mission;
pub mod output;
pub mod reference;
pub mod world;
