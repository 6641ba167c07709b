//! A board that QEMU emulates, with its firmware: its link, its log, and missions flown over the one.

use std::fs;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;
use defmt_decoder::{DecodeError, Table};
use host_sim::hil::cable::Cable;
use host_sim::hil::faults::Faults;
use host_sim::hil::flight;
use host_sim::hil::player::{Played, Player};
use host_sim::hil::qemu::Emulator;
use host_sim::mission::definition::Mission;
use planner_core::link::frame::Frame;
use planner_core::link::message::LabelSource;
use planner_core::{
    Area, Goal, Heading, Label, Lookahead, Plan, Planner as _, Pose, Reading, Sample, Unicycle,
    VersionSpace,
};
use tempfile::{NamedTempFile, TempPath};

use crate::debugger::{Debugger, free_port};
use crate::machines::{Kind, WHEELS};

/// For anything that a board does within five seconds of its own, where a busy machine gives it few.
pub(crate) const PATIENCE: Duration = Duration::from_mins(1);

/// A board that runs.
pub(crate) struct Board {
    _emulator: Emulator,
    pub(crate) link: TcpStream,
    elf: PathBuf,
    log: TempPath,
}

impl Board {
    /// Starts one, with further arguments for QEMU; `None` where that cannot be.
    pub(crate) fn start(kind: Kind, more: &[&str]) -> Option<Self> {
        let elf = kind.elf()?;
        let log = NamedTempFile::new().expect("a temporary file").into_temp_path();
        let started = Emulator::start(&elf, kind.machine, Some(&log), more);
        let (emulator, link) = started.expect("QEMU runs it");
        Some(Self { _emulator: emulator, link, elf, log })
    }

    /// As [`start`](Self::start), with a debugger, which has it halted.
    pub(crate) fn with_debugger(kind: Kind, more: &[&str]) -> Option<(Self, Debugger)> {
        let port = free_port();
        let gdb = format!("tcp:127.0.0.1:{port}");
        let board = Self::start(kind, &[more, &["-gdb", &gdb]].concat())?;
        Some((board, Debugger::connect(port)))
    }

    pub(crate) fn play(&self, player: &mut Player, faults: Faults, seed: u64) -> Result<()> {
        self.pass_over()?;
        let cable = Cable::new(self.link.try_clone()?, self.link.try_clone()?, faults, seed);
        flight::play(player, cable).map(drop)
    }

    /// Passes over what it has sent since the last mission: it asks for another ten times a second, and may have done so
    /// for long.
    fn pass_over(&self) -> Result<()> {
        let mut old = [0; 4096];
        self.link.set_nonblocking(true)?;
        while (&self.link).read(&mut old).is_ok_and(|count| count > 0) {}
        Ok(self.link.set_nonblocking(false)?)
    }

    /// Lets it fly a mission, over a link with faults.
    pub(crate) fn fly(&self, mission: &Mission, faults: Faults) -> Result<Played> {
        let mut player = player(mission, LabelSource::Vehicle);
        self.play(&mut player, faults, mission.seed)?;
        player.finish()
    }

    /// The log so far, each message after the chip's time of it in milliseconds, if it has a clock.
    pub(crate) fn log(&self) -> Vec<(u32, String)> {
        let elf = fs::read(&self.elf).expect("cargo left an ELF");
        let table = Table::parse(&elf).expect("the ELF is sound").expect("it logs");
        let mut decoder = table.new_stream_decoder();
        decoder.received(&fs::read(&self.log).expect("QEMU writes it"));
        let mut messages = Vec::new();
        loop {
            match decoder.decode() {
                Ok(frame) => {
                    // A program without a clock has no times.
                    let at = frame.display_timestamp().map_or(0, |time| {
                        let digits = time.to_string().replace('.', "");
                        digits.parse().expect("seconds, three decimals")
                    });
                    messages.push((at, frame.display_message().to_string()));
                }
                Err(DecodeError::UnexpectedEof) => return messages,
                Err(DecodeError::Malformed) => messages.push((0, "(malformed)".to_owned())),
            }
        }
    }

    /// The messages, without the times, up to the `n`-th that begins so.
    pub(crate) fn messages_until(&self, n: usize, beginning: &str) -> Vec<String> {
        let since = Instant::now();
        loop {
            let messages: Vec<_> = self.log().into_iter().map(|(_, message)| message).collect();
            if messages.iter().filter(|it| it.starts_with(beginning)).count() >= n {
                return messages;
            }
            assert!(since.elapsed() < PATIENCE, "no {beginning:?} in {messages:#?}");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// The world of a mission, for a board.
pub(crate) fn player(mission: &Mission, labels: LabelSource) -> Player {
    Player::new(mission, labels, flight::start_number()).expect("a mission for a chip")
}

/// The answer to what a board asks next.
pub(crate) fn answer(link: &mut TcpStream, player: &mut Player) -> Result<Frame> {
    loop {
        let mut byte = [0];
        link.read_exact(&mut byte)?;
        if let Some(frame) = player.hear(byte[0])? {
            return Ok(frame);
        }
    }
}

/// Answers a board until it has asked for so many motions.
pub(crate) fn play_until(motions: usize, link: &mut TcpStream, player: &mut Player) -> Result<()> {
    while player.motions() < motions {
        let mut byte = [0];
        link.read_exact(&mut byte)?;
        if let Some(frame) = player.hear(byte[0])? {
            link.write_all(frame.bytes())?;
        }
    }
    Ok(())
}

/// Arguments that have QEMU log writes to what it does not emulate.
pub(crate) fn writes_to(file: &Path) -> [&str; 4] {
    ["-d", "unimp", "-D", file.to_str().expect("the path is UTF-8")]
}

/// Planner and drive are on one chip, whose pin for the label is low wherever it goes. It finds the line that this machine
/// finds, after as many labels. Then it stands still.
#[test]
fn a_robot_on_two_wheels_finds_a_line_without_a_link() -> Result<()> {
    let Some(board) = Board::start(WHEELS, &[]) else { return Ok(()) };
    let given = [([2.0, 1.0], -1), ([2.0, 8.0], 1), ([18.0, 16.0], 1), ([18.0, 5.0], -1)];
    let label = |sign| if sign > 0 { Label::Positive } else { Label::Negative };
    let given = given.map(|(place, sign)| Sample::at(place, label(sign)).expect("on the lattice"));
    let area = Area::metres([0.0, 0.0], [20.0, 20.0])?;
    let mut planner = Lookahead::new(area, Unicycle::default(), VersionSpace::<32>::new(&given)?)?
        .until(Goal::slope_within_degrees(0.5)?.unaudited());
    let mut pose = Pose { site: given[0].site, heading: Heading(0) };
    let mut expected = Vec::new();
    while let Plan::Move(motion) = planner.plan(pose) {
        pose = motion.target;
        let reading = motion.wants_label.then_some(Reading::Side(Label::Negative));
        planner.observe(pose, reading)?;
        expected.push(format!("read {:?}", reading.map(Reading::sign)));
    }
    expected.push(format!("the line: {:?}", planner.estimate()));
    expected.push("stopped: Known".to_owned());
    assert_eq!(board.messages_until(1, "stopped"), expected);
    Ok(())
}
