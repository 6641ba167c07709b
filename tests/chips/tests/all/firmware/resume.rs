//! Missions that a restart cuts off, with the firmware in QEMU: they go on, and the trace is that without.

use std::fs;

use chips::emulator::missions::trace_here;
use host_sim::hil::faults::Faults;
use host_sim::hil::player::Player;
use host_sim::mission::definition::Mission;
use host_sim::mission::trace;
use planner_core::link::message::LabelSource;
use rayon::prelude::*;

use crate::board::{self, Board};
use crate::firmware::{random, random_reading, start};

fn player(mission: &Mission, labels: LabelSource) -> Player {
    board::player(mission, labels).resuming()
}

/// Answers a chip until it has asked for so many motions.
fn play_until(motions: usize, chip: &mut Board, player: &mut Player) {
    board::play_until(motions, &mut chip.link, player).expect("it flies");
}

#[test]
fn a_chip_that_loses_its_power_goes_on() {
    (0..6).into_par_iter().for_each(|number| {
        let mission = if number < 3 { random(number) } else { random_reading(number) };
        let Some(mut chip) = start(&[]) else { return };
        let mut player = player(&mission, LabelSource::Vehicle);
        for motions in [2, 5] {
            play_until(motions, &mut chip, &mut player);
            drop(chip);
            chip = start(&[]).expect("it started before");
        }
        chip.play(&mut player, Faults::default(), 1).expect("it flies");
        let played = player.finish().expect("it ends");
        assert_eq!(
            trace::lines(&played.recording.results),
            trace_here(&mission),
            "mission {number}"
        );
    });
}

/// The chip goes on running and learns that its vehicle has started anew.
#[test]
fn a_host_that_restarts_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    (0..6).into_par_iter().for_each(|number| {
        let mission = if number < 3 { random(number) } else { random_reading(number) };
        let Some(mut chip) = start(&[]) else { return };
        let place = folder.path().join(format!("{number}.jsonl"));
        let start =
            || player(&mission, LabelSource::Vehicle).keeping(&place).expect("its own steps");
        let mut first = start();
        play_until(4, &mut chip, &mut first);
        drop(first);
        let mut second = start();
        assert_eq!(second.steps(), 3);
        chip.play(&mut second, Faults::default(), 1).expect("it flies");
        let played = second.finish().expect("it ends");
        let logbook = played.logbook.expect("it was to be kept");
        logbook.complete(&played.recording.results.end).expect("it takes its place");
        assert_eq!(fs::read_to_string(&place).expect("a trace"), trace_here(&mission));
    });
}

/// The pin is low, and reads as -1; what it read before the restart is told.
#[test]
fn labels_of_the_chips_own_are_told_again() {
    [random(1), random_reading(1)].into_par_iter().for_each(|mission| {
        let Some(mut chip) = start(&[]) else { return };
        let flown =
            |player: Player| trace::lines(&player.finish().expect("it ends").recording.results);
        let mut whole = player(&mission, LabelSource::Chip);
        chip.play(&mut whole, Faults::default(), 1).expect("it flies");
        let mut cut = player(&mission, LabelSource::Chip);
        play_until(4, &mut chip, &mut cut);
        drop(chip);
        let chip = start(&[]).expect("it started before");
        chip.play(&mut cut, Faults::default(), 1).expect("it flies");
        assert_eq!(flown(cut), flown(whole));
    });
}
