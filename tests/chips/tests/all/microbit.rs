//! The firmware of the micro:bit under QEMU: what it has no room for it declines, a bad link changes nothing, and the
//! drive is enabled for as long as it may be.

use std::fs;
use std::thread;
use std::time::{Duration, Instant};

use chips::budget::footprint::SEAM;
use chips::budget::workload::DOUBT;
use chips::emulator::missions::trace_here;
use chips::program::image::Image;
use host_sim::campaign::standard_field;
use host_sim::hil::faults::Faults;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::definition::Mission;
use host_sim::mission::trace;
use planner_core::link::message::LabelSource;
use tests::fronts::following;
use tests::missions::{of_any_vehicle, reading};

use crate::board::{Board, PATIENCE, play_until, player};
use crate::debugger::Debugger;
use crate::machines::NRF51;

/// The register of what GPIO puts out, and drive enable in it.
const OUT: u32 = 0x5000_0504;
const ENABLE: u8 = 1 << 2;

fn mission(number: u64) -> Mission {
    standard_field::standard(9, number, Algorithm::Lookahead, 8)
}

fn flies(board: &Board, mission: &Mission, faults: Faults) {
    let played = board.fly(mission, faults).expect("it flies as here");
    assert_eq!(trace::lines(&played.recording.results), trace_here(mission), "{mission:?}");
}

#[test]
fn what_it_has_no_room_for_it_declines_by_name() {
    let Some(board) = Board::start(NRF51, &[]) else { return };
    let noisy = Mission { noise: DOUBT, ..mission(0) };
    let priced = Asking { price: Some(5.0), ..Asking::USUAL };
    let priced = Mission { asking: priced, ..mission(0) };
    for (mission, why) in [
        (noisy, "algorithm"),
        (of_any_vehicle(6, 8), "area"),
        (priced, "price"),
        (reading(mission(0)), "readings: declined"),
        (following(8, 0, 60), "algorithm: found track, declined"),
    ] {
        let refusal = board.fly(&mission, Faults::default()).expect_err("declined").to_string();
        assert!(refusal.contains(why), "{why}: {refusal}");
    }
    // More labels than it has room for: those that no longer matter make room.
    flies(&board, &Mission { steps: 70, ..mission(0) }, Faults::default());
}

#[test]
fn a_bad_link_changes_nothing() {
    let Some(board) = Board::start(NRF51, &[]) else { return };
    for number in 0..3 {
        let faults = "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms";
        flies(&board, &mission(number), faults.parse().expect("faults"));
    }
}

/// A board that runs, and a debugger.
fn with_debugger() -> Option<(Board, Debugger)> {
    let (board, mut debugger) = Board::with_debugger(NRF51, &[])?;
    board.link.set_read_timeout(Some(PATIENCE)).expect("a socket");
    debugger.say("c");
    Some((board, debugger))
}

/// Whether a chip that is halted has the drive enabled.
fn is_enabled(debugger: &mut Debugger) -> bool {
    debugger.memory(OUT, 4)[0] & ENABLE != 0
}

fn wait_until_disabled(debugger: &mut Debugger) {
    let since = Instant::now();
    loop {
        // While it is halted its clock stands.
        thread::sleep(Duration::from_millis(500));
        debugger.halt();
        let is_over = !is_enabled(debugger);
        debugger.say("c");
        if is_over {
            return;
        }
        assert!(since.elapsed() < PATIENCE, "the drive is still enabled");
    }
}

#[test]
fn the_drive_is_enabled_until_the_link_is_lost() {
    let Some((mut board, mut debugger)) = with_debugger() else { return };
    debugger.halt();
    assert!(!is_enabled(&mut debugger));
    debugger.say("c");
    let mut player = player(&mission(1), LabelSource::Vehicle);
    play_until(3, &mut board.link, &mut player).expect("it flies");
    debugger.halt();
    assert!(is_enabled(&mut debugger));
    debugger.say("c");
    wait_until_disabled(&mut debugger);
    flies(&board, &mission(1), Faults::default());
    wait_until_disabled(&mut debugger);
}

#[test]
fn a_planner_that_hangs_loses_the_drive_and_starts_anew() {
    let Some((board, mut debugger)) = with_debugger() else { return };
    let image = Image::read(&fs::read(NRF51.elf().expect("it runs")).expect("an ELF"));
    let is_plan = |name: &str| name.strip_prefix(SEAM) == Some("plan");
    let plans: Vec<u32> =
        image.functions().iter().filter(|it| is_plan(&it.name)).map(|it| it.address).collect();
    debugger.halt();
    for plan in &plans {
        assert_eq!(debugger.ask(&format!("Z0,{plan:x},2")), "OK");
    }
    debugger.say("c");
    let mut link = board.link.try_clone().expect("a socket");
    let flight = thread::spawn(move || {
        play_until(1, &mut link, &mut player(&mission(2), LabelSource::Vehicle))
    });
    let halted = debugger.answer();
    assert!(halted.starts_with('T'), "{halted}");
    assert!(is_enabled(&mut debugger), "a mission is flown");
    for plan in &plans {
        assert_eq!(debugger.ask(&format!("z0,{plan:x},2")), "OK");
    }
    // b . in RAM that nothing uses
    let nowhere = 0x2000_0800_u32;
    assert_eq!(debugger.ask(&format!("M{nowhere:x},2:fee7")), "OK");
    debugger.jump(nowhere);
    debugger.say("c");
    let flown = flight.join().expect("it ends").expect_err("the planner hangs").to_string();
    assert!(flown.contains("the board restarted"), "{flown}");
    wait_until_disabled(&mut debugger);
    flies(&board, &mission(2), Faults::default());
}
