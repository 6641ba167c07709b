//! Files that appear whole or not at all, whatever interrupts the program.

pub mod file;
pub mod interruption;
pub mod partial;
pub mod place;
