//! What a page holds: chapters of missions that are shown side by side.

use serde::Serialize;

use crate::mission::recording::Recording;
use crate::report::page::scene::Flight;
use crate::report::page::words;

/// A page of missions.
#[derive(Debug, Serialize)]
pub struct Page {
    pub(super) title: String,
    pub(super) chapters: Vec<Chapter>,
}

/// Missions that are shown side by side, in step.
#[derive(Debug, Serialize)]
pub struct Chapter {
    pub(super) title: String,
    #[serde(skip)]
    pub(super) about: Vec<String>,
    pub(super) flights: Vec<Flight>,
}

impl Page {
    /// A page under a title.
    pub fn new(title: impl Into<String>, chapters: Vec<Chapter>) -> Self {
        Self { title: title.into(), chapters }
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

    /// The same with a note on how to read it.
    #[must_use]
    pub fn noting(mut self, note: Option<&str>) -> Self {
        self.about.extend(note.map(str::to_owned));
        self
    }
}
