//! draft
pub mod field;
pub mod mission;
pub mod polygon;
pub mod random_walk;
pub mod world;
