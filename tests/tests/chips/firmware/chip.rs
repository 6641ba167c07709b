//! The firmware on a chip that QEMU emulates: its link, its log, and missions flown over the one.

use std::fs;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use defmt_decoder::{DecodeError, Table};
use host_sim::hil::cable::Cable;
use host_sim::hil::faults::Faults;
use host_sim::hil::firmware::STM32F405;
use host_sim::hil::flight;
use host_sim::hil::player::{Played, Player};
use host_sim::hil::qemu::Emulator;
use host_sim::mission::definition::Mission;
use planner_core::link::message::LabelSource;
use tempfile::{NamedTempFile, TempPath};
use tests::machines::STM32;

/// For anything that the chip does within two seconds of its own, where a busy machine gives it few.
const PATIENCE: Duration = Duration::from_mins(1);

/// A chip that runs.
pub(crate) struct Chip {
    _emulator: Emulator,
    pub(crate) link: TcpStream,
    log: TempPath,
}

impl Chip {
    /// Starts the firmware, with further arguments for QEMU; `None` where that cannot be.
    pub(crate) fn start(more: &[&str]) -> Option<Self> {
        let elf = firmware()?;
        let log = NamedTempFile::new().expect("a temporary file").into_temp_path();
        let (emulator, link) =
            Emulator::start(elf, STM32F405.machine, Some(&log), more).expect("QEMU runs it");
        Some(Self { _emulator: emulator, link, log })
    }

    pub(crate) fn play(
        &self,
        player: &mut Player,
        faults: Faults,
        seed: u64,
    ) -> anyhow::Result<()> {
        let [reader, port] = [(); 2].map(|()| self.link.try_clone().expect("a socket"));
        flight::play(player, Cable::new(reader, port, faults, seed)).map(drop)
    }

    pub(crate) fn fly(&self, mission: &Mission, faults: Faults) -> anyhow::Result<Played> {
        let mut player = Player::new(mission, LabelSource::Vehicle, flight::start_number())?;
        self.play(&mut player, faults, mission.seed)?;
        player.finish()
    }

    /// The log so far, each message after the chip's time of it in milliseconds.
    pub(crate) fn log(&self) -> Vec<(u32, String)> {
        let elf = fs::read(firmware().expect("it runs")).expect("cargo left an ELF");
        let table = Table::parse(&elf).expect("the ELF is sound").expect("it logs");
        let mut decoder = table.new_stream_decoder();
        decoder.received(&fs::read(&self.log).expect("QEMU writes it"));
        let mut messages = Vec::new();
        loop {
            match decoder.decode() {
                Ok(frame) => {
                    let time = frame.display_timestamp().expect("all have one").to_string();
                    let at = time.replace('.', "").parse().expect("seconds, three decimals");
                    messages.push((at, frame.display_message().to_string()));
                }
                Err(DecodeError::UnexpectedEof) => return messages,
                Err(DecodeError::Malformed) => messages.push((0, "(malformed)".to_owned())),
            }
        }
    }

    /// What it logs, without the times.
    pub(crate) fn messages(&self) -> Vec<String> {
        self.log().into_iter().map(|(_, message)| message).collect()
    }

    /// The messages up to the `n`-th that begins so.
    pub(crate) fn messages_until(&self, n: usize, beginning: &str) -> Vec<String> {
        let since = Instant::now();
        loop {
            let messages = self.messages();
            if messages.iter().filter(|it| it.starts_with(beginning)).count() >= n {
                return messages;
            }
            assert!(since.elapsed() < PATIENCE, "no {beginning:?} in {messages:#?}");
            thread::sleep(Duration::from_millis(10));
        }
    }
}

/// The firmware, built once; `None`, and a visible line, where it cannot be built or run.
pub(crate) fn firmware() -> Option<&'static Path> {
    static ELF: OnceLock<Option<PathBuf>> = OnceLock::new();
    ELF.get_or_init(|| STM32.elf()).as_deref()
}
