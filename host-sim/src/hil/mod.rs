//! Hardware in the loop: a chip plans at the other end of a link, and the simulator is its vehicle.

pub mod cable;
pub mod faults;
pub mod firmware;
pub mod flight;
pub mod logbook;
pub mod player;
pub mod qemu;
pub mod setup;
