//! Missions that a program of the package `bare-core` flies in the emulator.

use anyhow::Result;
use host_sim::hil::player::{Played, Player};
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::trace;
use planner_core::link::message::LabelSource;

use super::{Emulator, Event};

impl Emulator {
    /// Lets the program fly a mission, from where it asks for one.
    ///
    /// # Errors
    /// As [`Player::hear`] and [`Player::finish`].
    ///
    /// # Panics
    /// When the program ends.
    pub fn fly(&mut self, mission: &Mission) -> Result<Played> {
        let mut player = Player::new(mission, LabelSource::Vehicle, 1)?;
        while !player.is_over() {
            match self.run() {
                Event::Write(bytes) => {
                    for byte in bytes {
                        if let Some(frame) = player.hear(byte)? {
                            self.supply(frame.bytes());
                        }
                    }
                }
                Event::Read => panic!("the program waits for an answer that it has"),
                Event::Exit(status) => panic!("the program ended with status {status}"),
                Event::Halted => return player.break_off(),
            }
        }
        player.finish()
    }
}

/// The trace of a mission that this machine flies.
///
/// # Panics
/// When a label contradicts another.
pub fn trace_here(mission: &Mission) -> String {
    trace::lines(&Recording::of(mission).expect("labels that are certain are true").results)
}
