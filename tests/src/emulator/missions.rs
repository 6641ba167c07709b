//! Missions that a program of the package `bare-core` flies in the emulator.

use anyhow::Result;
use host_sim::hil::player::{Played, Player};
use host_sim::mission::definition::Mission;
use planner_core::link::message::LabelSource;

use crate::emulator::{Core, Emulator, Event};
use crate::program::build;

/// A core, the target that it runs, and what people call it.
pub const CORES: [(Core, &str); 2] = [(Core::M4F, build::CHIP), (Core::M0, "thumbv6m-none-eabi")];

/// The programs for a target, as [`build::programs`] has them.
pub fn build(target: &str) -> Option<impl Fn(&str) -> Vec<u8> + use<>> {
    build::programs("bare-core", target)
}

/// Lets a program fly a mission, from where it asks for one.
///
/// # Errors
/// As [`Player::hear`] and [`Player::finish`].
///
/// # Panics
/// When the program ends.
pub fn fly(emulator: &mut Emulator, mission: &Mission) -> Result<Played> {
    fly_and_record(emulator, mission).map(|(played, _)| played)
}

/// As [`fly`], with all bytes that the program was sent.
///
/// # Errors
/// As [`fly`].
///
/// # Panics
/// As [`fly`].
pub fn fly_and_record(emulator: &mut Emulator, mission: &Mission) -> Result<(Played, Vec<u8>)> {
    let mut told = Vec::new();
    let mut player = Player::new(mission, LabelSource::Vehicle, 1)?;
    while !player.is_over() {
        match emulator.run() {
            Event::Write(bytes) => {
                for byte in bytes {
                    if let Some(frame) = player.hear(byte)? {
                        emulator.supply(frame.bytes());
                        told.extend(frame.bytes());
                    }
                }
            }
            Event::Read => panic!("the program waits for an answer that it has"),
            Event::Exit(status) => panic!("the program ended with status {status}"),
            Event::Halted => return Ok((player.break_off()?, told)),
        }
    }
    Ok((player.finish()?, told))
}
