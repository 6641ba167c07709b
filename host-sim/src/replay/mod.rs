//! Recorded samples: the lines that agree with them, however many they are.

pub mod answer;
pub mod columns;
pub mod delimiter;
pub mod doubt;
pub mod facing;
mod figure;
pub mod frame;
pub mod geojson;
pub mod hull;
pub mod label_words;
pub mod line_posterior;
pub mod line_set;
pub mod patch;
pub mod record;
pub mod rows;
pub mod sample_file;
pub mod separation;
pub mod shortest_pairs;
pub mod tolerant;
pub mod trace_file;
mod words;
