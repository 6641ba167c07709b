//! A report in one file: a page that shows missions step by step, side by side where there are several.
//!
//! All of it is in the file, and it may load nothing. A script draws what the scenes hold; without scripts
//! there are the last pictures and the tables of steps.

mod contents;
mod markup;
pub(crate) mod scene;
mod words;

pub use contents::{Chapter, Page};
