//! Every program, core and board: what they take, and that they decide as this machine does; and the interface for C.

mod board;
mod c_interface;
mod debugger;
mod firmware;
mod footprint;
mod machines;
mod microbit;
mod traces;
