//! A report in one file: a page that shows missions step by step, side by side where there are several.
//!
//! All of it is in the file, and it may load nothing. A script draws what the [scenes](scene) hold; without scripts
//! there are the last pictures and the tables of steps.

use serde::Serialize;

use crate::mission::recording::Recording;
use crate::report::page::scene::Flight;

mod markup;
mod scene;
mod words;

/// A page of missions.
#[derive(Debug, Serialize)]
pub struct Page {
    title: String,
    chapters: Vec<Chapter>,
}

/// Missions that are shown side by side, in step.
#[derive(Debug, Serialize)]
pub struct Chapter {
    title: String,
    #[serde(skip)]
    about: Vec<String>,
    flights: Vec<Flight>,
}

impl Page {
    /// A page under a title.
    pub fn new(title: impl Into<String>, chapters: Vec<Chapter>) -> Self {
        Self { title: title.into(), chapters }
    }

    /// The page as an HTML document.
    pub fn html(&self) -> String {
        markup::document(self)
    }
}

impl Chapter {
    /// Missions in the same world, each with the name of who planned it.
    pub fn new<'a>(
        title: impl Into<String>,
        flights: impl IntoIterator<Item = (&'a str, &'a Recording)>,
    ) -> Self {
        let flights: Vec<_> = flights.into_iter().collect();
        let about = flights.first().map_or(Vec::new(), |(_, first)| words::about(first));
        let shown = flights.into_iter().map(|(name, recording)| Flight::of(name, recording));
        Self { title: title.into(), about, flights: shown.collect() }
    }
}
