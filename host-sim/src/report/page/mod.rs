//! A report in one file: a page that shows missions step by step, side by side if there are several.
//!
//! The file contains everything, and the page may load nothing. A script draws the scenes. Without scripts the page
//! shows the last pictures and the tables of steps.

mod contents;
mod markup;
pub(crate) mod scene;
mod words;

pub use contents::{Chapter, Page};
