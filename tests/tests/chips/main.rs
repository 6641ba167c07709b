//! The planner on chips: what it takes, and that it decides there as it does here.

mod anything_on_a_chip;
mod budgets;
mod c_interface;
mod cores;
mod emulator;
mod firmware;
mod machines;
mod microbit;
mod tolerance_cost;
