//! Recorded samples: the lines that agree with them, however many they are.

pub mod facing;
pub mod hull;
pub mod record;
pub mod sample_file;
pub mod separation;
pub mod shortest_pairs;
