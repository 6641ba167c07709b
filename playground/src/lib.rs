//! The simulator as a WebAssembly module: a scenario in, its trace and its scenes out.
//!
//! Texts go in and out through one buffer. The page asks for `room`, writes there and calls `hand` or `run`.
//! `text` puts an answer into the buffer. The module imports nothing.

#![cfg(target_family = "wasm")]

use std::iter;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context as _, Result};
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use host_sim::mission::trace;
use host_sim::report::page::Chapter;
use host_sim::report::text;
use host_sim::world::files;

/// What messages call the scenario.
const NAME: &str = "scenario.toml";

/// The buffer.
static ROOM: Mutex<Vec<u8>> = Mutex::new(Vec::new());

/// The last mission.
static FLOWN: Mutex<Option<Answer>> = Mutex::new(None);

/// A mission, or why there is none.
type Answer = Result<Flown, String>;

struct Flown {
    recording: Recording,
    /// What it came to, and what else there is to say of it: a line each.
    notes: Vec<String>,
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Makes room for so many bytes, and says where.
#[unsafe(no_mangle)]
pub extern "C" fn room(bytes: usize) -> *mut u8 {
    let mut room = lock(&ROOM);
    room.clear();
    room.resize(bytes, 0);
    room.as_mut_ptr()
}

/// How much is in the room.
#[unsafe(no_mangle)]
pub extern "C" fn length() -> usize {
    lock(&ROOM).len()
}

/// Takes a file that scenarios may name: so many bytes of its name, and then its content.
#[unsafe(no_mangle)]
pub extern "C" fn hand(name: usize) {
    let mut path = std::mem::take(&mut *lock(&ROOM));
    let content = path.split_off(name.min(path.len()));
    files::hand(PathBuf::from(String::from_utf8_lossy(&path).into_owned()), content);
}

/// Flies the mission of the scenario in the room. Returns whether there is one.
#[unsafe(no_mangle)]
pub extern "C" fn run() -> bool {
    let text = std::mem::take(&mut *lock(&ROOM));
    let flown = fly(&text).map_err(|why| format!("{why:#}"));
    let is_flown = flown.is_ok();
    *lock(&FLOWN) = Some(flown);
    is_flown
}

/// Puts into the room what is to be said of the last mission, or why there is none.
#[unsafe(no_mangle)]
pub extern "C" fn said() -> *const u8 {
    answer(|it| it.as_ref().map_or_else(Clone::clone, |it| it.notes.join("\n")))
}

/// Puts the trace of the last mission into the room.
#[unsafe(no_mangle)]
pub extern "C" fn text() -> *const u8 {
    flown(|it| trace::lines(&it.recording.results))
}

/// Puts the scenes of the last mission into the room: a chapter of a report, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn scenes() -> *const u8 {
    flown(|it| {
        let planner = it.recording.mission.algorithm.title();
        let chapter = Chapter::new("What the robot knows", [(planner, &it.recording)]);
        serde_json::to_string(&chapter).unwrap_or_default()
    })
}

fn flown(of: impl Fn(&Flown) -> String) -> *const u8 {
    answer(|it| it.as_ref().map(of).unwrap_or_default())
}

fn answer(of: impl FnOnce(&Answer) -> String) -> *const u8 {
    let answer = lock(&FLOWN).as_ref().map(of).unwrap_or_default();
    let mut room = lock(&ROOM);
    *room = answer.into_bytes();
    room.as_ptr()
}

fn fly(text: &[u8]) -> Result<Flown> {
    let text = str::from_utf8(text).context(NAME)?;
    let mission = scenario::parse(NAME, text, Overrides::default())?;
    let (recording, refusal) = Recording::until_refusal(&mission);
    let doubts = mission.doubts.iter().cloned();
    let refusal = refusal.map(|it| format!("{it:#}"));
    let outcome = text::plainly(&recording.results);
    let notes = iter::once(outcome).chain(doubts).chain(refusal).collect();
    Ok(Flown { recording, notes })
}
