//! The planner on chips: what it takes of them, and that it decides there as it does here.
//!
//! - [`program`]: programs for a chip: how they are built, what their ELF holds, who calls whom in it.
//! - [`emulator`]: an Arm core in this process.
//! - [`budget`]: what programs take of a core, measured, beside what they may take.
//!
//! `cargo test` checks one program on one core. `cargo test -p chips --features all` checks all programs on three cores,
//! both boards under QEMU, and the interface for C.

pub mod budget;
pub mod emulator;
pub mod program;
