//! The firmware of the micro:bit under QEMU: what it has no room for it declines, a bad link changes nothing, and the
//! drive is enabled for as long as it may be. Asked for by `CORES=all`.

use std::fs;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use host_sim::campaign::standard_field;
use host_sim::hil::flight;
use host_sim::hil::player::Player;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::report::trace;
use planner_core::link::message::LabelSource;
use tests::budget::footprint::SEAM;
use tests::budget::workload::DOUBT;
use tests::debugger::{self, Debugger};
use tests::machines::{Machine, NRF51};
use tests::missions::of_any_vehicle;
use tests::program::image::Image;

/// For anything that the board does within five seconds of its own, where a busy machine gives it few.
const PATIENCE: Duration = Duration::from_mins(1);

/// The program counter among all registers, as hexadecimal digits.
const PC: std::ops::Range<usize> = 15 * 8..16 * 8;

/// The register of what GPIO puts out, and drive enable in it.
const OUT: u32 = 0x5000_0504;
const ENABLE: u8 = 1 << 2;

fn mission(number: u64) -> Mission {
    standard_field::standard(9, number, Algorithm::Lookahead, 8)
}

fn flies(machine: &mut Machine, mission: &Mission) {
    let played = machine.fly(mission).expect("it flies as here");
    let here = Recording::of(mission).expect("labels are true");
    assert_eq!(trace::lines(&played.recording.results), trace::lines(&here.results));
}

#[test]
fn what_it_has_no_room_for_it_declines_by_name() {
    let Some(mut machine) = Machine::start(NRF51, &[]) else { return };
    let noisy = Mission { noise: DOUBT, ..mission(0) };
    let priced = Asking { price: Some(5.0), ..Asking::USUAL };
    let priced = Mission { asking: priced, ..mission(0) };
    for (mission, why) in [(noisy, "algorithm"), (of_any_vehicle(6, 8), "area"), (priced, "price")]
    {
        let refusal = machine.fly(&mission).expect_err("it is declined").to_string();
        assert!(refusal.contains(why), "{why}: {refusal}");
    }
    // More labels than it has room for: those that no longer matter make room.
    flies(&mut machine, &Mission { steps: 70, ..mission(0) });
}

#[test]
fn a_bad_link_changes_nothing() {
    let Some(mut machine) = Machine::start(NRF51, &[]) else { return };
    let faults = "drop=0.1,cut=0.02,corrupt=0.05,duplicate=0.1,delay=20ms";
    for number in 0..3 {
        let mission = mission(number);
        let played = machine.fly_over(&mission, faults.parse().expect("faults"));
        let here = Recording::of(&mission).expect("labels are true");
        let there = trace::lines(&played.expect("it flies").recording.results);
        assert_eq!(there, trace::lines(&here.results), "mission {number}");
    }
}

/// A board that runs, its link, and a debugger.
fn with_debugger() -> Option<(Machine, TcpStream, Debugger)> {
    let port = debugger::free_port();
    let machine = Machine::start(NRF51, &["-gdb", &format!("tcp:127.0.0.1:{port}")])?;
    let Machine::Board { link, .. } = &machine else { panic!("it is a board") };
    let link = link.try_clone().expect("a socket");
    link.set_read_timeout(Some(PATIENCE)).expect("a socket");
    let mut debugger = Debugger::connect(port);
    debugger.say("c");
    Some((machine, link, debugger))
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

/// Answers a mission up to a motion.
fn answer_up_to(motion: usize, mission: &Mission, link: &mut TcpStream) -> anyhow::Result<()> {
    let mut player = Player::new(mission, LabelSource::Vehicle, flight::start_number())?;
    while player.motions() < motion {
        let mut byte = [0];
        link.read_exact(&mut byte)?;
        if let Some(frame) = player.hear(byte[0])? {
            link.write_all(frame.bytes())?;
        }
    }
    Ok(())
}

#[test]
fn the_drive_is_enabled_until_the_link_is_lost() {
    let Some((mut machine, mut link, mut debugger)) = with_debugger() else { return };
    debugger.halt();
    assert!(!is_enabled(&mut debugger));
    debugger.say("c");
    answer_up_to(3, &mission(1), &mut link).expect("it flies");
    debugger.halt();
    assert!(is_enabled(&mut debugger));
    debugger.say("c");
    wait_until_disabled(&mut debugger);
    flies(&mut machine, &mission(1));
    wait_until_disabled(&mut debugger);
}

#[test]
fn a_planner_that_hangs_loses_the_drive_and_starts_anew() {
    let Some((mut machine, mut link, mut debugger)) = with_debugger() else { return };
    let image = Image::read(&fs::read(NRF51.elf().expect("it runs")).expect("an ELF"));
    let is_plan = |name: &str| name.strip_prefix(SEAM) == Some("plan");
    let plans: Vec<u32> =
        image.functions().iter().filter(|it| is_plan(&it.name)).map(|it| it.address).collect();
    debugger.halt();
    for plan in &plans {
        assert_eq!(debugger.ask(&format!("Z0,{plan:x},2")), "OK");
    }
    debugger.say("c");
    let flight = thread::spawn(move || answer_up_to(1, &mission(2), &mut link));
    let halted = debugger.answer();
    assert!(halted.starts_with('T'), "{halted}");
    assert!(is_enabled(&mut debugger), "a mission is flown");
    for plan in &plans {
        assert_eq!(debugger.ask(&format!("z0,{plan:x},2")), "OK");
    }
    // b . in RAM that nothing uses
    let nowhere = 0x2000_0800_u32;
    assert_eq!(debugger.ask(&format!("M{nowhere:x},2:fee7")), "OK");
    let mut registers = debugger.ask("g");
    registers.replace_range(PC, &format!("{:08x}", nowhere.swap_bytes()));
    assert_eq!(debugger.ask(&format!("G{registers}")), "OK");
    debugger.say("c");
    let flown = flight.join().expect("it ends").expect_err("the planner hangs").to_string();
    assert!(flown.contains("the board restarted"), "{flown}");
    wait_until_disabled(&mut debugger);
    flies(&mut machine, &mission(2));
}
