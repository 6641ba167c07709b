//! A live page: the page of a report, served while its mission is flown.
//!
//! `GET /` is the page with the first scene. `GET /scenes` is a stream of server-sent events: every scene so far, then each
//! one as it is made, then the end. The scenes and the rows of the table are those of a report, byte for byte.
//!
//! Viewers read from one list that only grows, each on a thread of its own. So the mission appends and never waits.

mod address;
mod feed;
mod request;
mod server;
#[cfg(test)]
mod tests;

use std::fmt::Display;
use std::hash::{BuildHasher as _, Hasher as _, RandomState};

use anyhow::Result;

pub use crate::report::live::address::Address;
pub(crate) use crate::report::live::address::USUAL;

use crate::mission::definition::Mission;
use crate::mission::recording::{Recorder, Recording};
use crate::output::notes::announce;
use crate::report::live::server::Server;
use crate::report::page::scene::Scenes;
use crate::report::page::{Chapter, End, Page};

/// A mission that viewers see while it is flown. When it is dropped, it waits until they have all of it, ten seconds at most.
#[derive(Debug)]
pub struct Live {
    server: Server,
    title: String,
    scenes: Scenes,
    /// The number of the next scene.
    number: usize,
    has_ended: bool,
}

impl Live {
    /// Serves a mission that is about to begin, and announces the page's link.
    ///
    /// # Errors
    /// When nothing can be served at the address.
    pub fn open(address: &Address, title: &str, mission: &Mission) -> Result<Self> {
        let server = Server::open(address)?;
        announce(format_args!("live: {}", server.link()));
        let (title, scenes) = (title.to_owned(), Scenes::new(mission));
        let mut live = Self { server, title, scenes, number: 0, has_ended: false };
        live.begin(mission);
        Ok(live)
    }

    /// Begins with the mission's start. If it had begun before, viewers begin again too.
    pub fn begin(&mut self, mission: &Mission) {
        self.scenes = Scenes::new(mission);
        let scene = self.scenes.scene(mission, None, &*mission.belief());
        let row = scene.row(0, !mission.algorithm.seeks_line());
        let json = scene.json();
        let token = token();
        let title = format!("Flown by {}", mission.algorithm.title());
        let chapter = Chapter::begun(title, mission, scene);
        self.server.feed().begin(&token, Page::live(&self.title, chapter, &token).html());
        self.number = 0;
        self.tell(&json, &row);
    }

    /// Where the page is.
    pub fn link(&self) -> String {
        self.server.link()
    }

    /// Shows the step that was recorded last.
    pub fn step(&mut self, recorder: &Recorder) {
        let Some(taken) = recorder.steps().last().zip(recorder.last()) else { return };
        let mission = recorder.mission();
        let scene = self.scenes.scene(mission, Some(taken), recorder.belief());
        let row = scene.row(self.number, !mission.algorithm.seeks_line());
        self.tell(&scene.json(), &row);
    }

    /// Shows what the vehicle or the board waits for, or what became of it, until something else is to be shown.
    pub fn say(&self, what: impl Display) {
        self.server.feed().say(&what.to_string());
    }

    /// The mission is over.
    pub fn end(&mut self, recording: &Recording) {
        self.finish(&End::of(recording, &self.scenes));
    }

    /// The mission is over, and came to nothing.
    pub fn break_off(&mut self, why: impl Display) {
        self.finish(&End::broken_off(&why.to_string()));
    }

    fn tell(&mut self, scene: &str, row: &str) {
        self.server.feed().push("scene", &[scene, row]);
        self.number += 1;
    }

    fn finish(&mut self, end: &End) {
        if !std::mem::replace(&mut self.has_ended, true) {
            self.server.feed().push("end", &[&end.json()]);
            self.server.feed().close();
        }
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.break_off("The program ended");
        self.server.feed().settle();
    }
}

/// A random word, which tells a mission from one that was served at the same address before.
fn token() -> String {
    format!("{:x}", RandomState::new().build_hasher().finish())
}
