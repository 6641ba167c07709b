//! Output: files that appear whole or not at all, whatever interrupts the program, and messages beside them.

pub mod ending;
pub mod file;
pub mod interruption;
pub mod kind;
pub mod notes;
pub mod partial;
pub mod place;
pub mod plain;
