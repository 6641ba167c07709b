//! Programs for a chip: how they are built, what their ELF holds, who calls whom in it.

mod body;
pub mod build;
pub mod graph;
pub mod image;
mod thumb;
