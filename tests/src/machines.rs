//! Machines of QEMU's that fly missions: boards with their firmware, and a RISC-V core with the planner alone.

use std::fs::File;
use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::os::fd::AsFd as _;
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::thread;

use anyhow::{Context as _, Result};
use host_sim::hil::cable::Cable;
use host_sim::hil::faults::Faults;
use host_sim::hil::firmware::{MICROBIT, STM32F405};
use host_sim::hil::flight;
use host_sim::hil::player::{Played, Player};
use host_sim::hil::qemu::Emulator;
use host_sim::mission::definition::Mission;
use planner_core::link::message::LabelSource;

use crate::program::build;

/// What a machine is and runs.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// What people call it.
    pub name: &'static str,
    /// Its name in QEMU.
    machine: &'static str,
    qemu: &'static str,
    package: &'static str,
    target: &'static str,
    program: &'static str,
}

/// The first board, with `firmware`.
pub const STM32: Kind = Kind {
    name: "STM32F405",
    machine: STM32F405.machine,
    qemu: "qemu-system-arm",
    package: "firmware",
    target: build::CHIP,
    program: "firmware",
};

/// The second, with `firmware/microbit`.
pub const NRF51: Kind = Kind {
    name: "nRF51822",
    machine: MICROBIT.machine,
    package: "microbit",
    target: "thumbv6m-none-eabi",
    program: "microbit",
    ..STM32
};

/// A RISC-V core, with a program of the package `bare-core`.
pub const fn riscv(program: &'static str) -> Kind {
    Kind {
        name: "RISC-V",
        machine: "virt",
        qemu: "qemu-system-riscv32",
        package: "bare-core",
        target: "riscv32imac-unknown-none-elf",
        program,
    }
}

impl Kind {
    /// Its program, built; `None`, and a visible line, where that cannot be built or run.
    ///
    /// # Panics
    /// As [`build::folder`], or with `CI` set where it cannot be run.
    pub fn elf(&self) -> Option<PathBuf> {
        if !build::has_tool(self.qemu) {
            let what = format!("{} under QEMU", self.name);
            build::skip(&what, &format!("{} is not on PATH", self.qemu));
            return None;
        }
        Some(build::folder(self.package, self.target)?.join(self.program))
    }
}

/// A machine that runs.
#[derive(Debug)]
pub enum Machine {
    /// A board, at its serial link.
    Board {
        /// Ends with this value.
        emulator: Emulator,
        /// The link.
        link: TcpStream,
    },
    /// A core, at the streams of its semihosting.
    Core(Core),
}

/// A core under QEMU, which ends with this value.
#[derive(Debug)]
pub struct Core {
    qemu: Child,
    input: ChildStdin,
    output: ChildStdout,
}

impl Machine {
    /// Starts one, with further arguments for QEMU; `None` where that cannot be.
    ///
    /// # Panics
    /// As [`Kind::elf`], or when QEMU does not come up.
    pub fn start(kind: Kind, more: &[&str]) -> Option<Self> {
        let elf = kind.elf()?;
        if kind.package != "bare-core" {
            let started = Emulator::start(&elf, kind.machine, None, more);
            let (emulator, link) = started.expect("QEMU runs it");
            return Some(Self::Board { emulator, link });
        }
        let mut qemu = Command::new(kind.qemu)
            .args(["-M", kind.machine, "-bios", "none", "-nographic", "-monitor", "none"])
            // A nanosecond an instruction: the core's own count of them is then right.
            .args(["-serial", "none", "-icount", "shift=0"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(more)
            .arg("-kernel")
            .arg(elf)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("QEMU starts");
        let input = qemu.stdin.take().expect("it is piped");
        let output = qemu.stdout.take().expect("it is piped");
        Some(Self::Core(Core { qemu, input, output }))
    }

    /// Has a core read zeros from now on, which are no frames. While it waits for input QEMU answers no debugger.
    ///
    /// # Panics
    /// When there are no file descriptors left.
    pub fn keep_awake(&self) {
        if let Self::Core(core) = self {
            let input = core.input.as_fd().try_clone_to_owned().expect("a descriptor");
            let mut input = File::from(input);
            // Ends with the core.
            thread::spawn(move || while input.write_all(&[0; 64]).is_ok() {});
        }
    }

    /// Lets it fly a mission.
    ///
    /// # Errors
    /// When it does not fly as this machine does.
    pub fn fly(&mut self, mission: &Mission) -> Result<Played> {
        self.fly_over(mission, Faults::default())
    }

    /// As [`fly`](Self::fly), over a board's link with faults.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn fly_over(&mut self, mission: &Mission, faults: Faults) -> Result<Played> {
        let mut player = Player::new(mission, LabelSource::Vehicle, flight::start_number())?;
        match self {
            Self::Board { link, .. } => {
                let cable = Cable::new(link.try_clone()?, link.try_clone()?, faults, mission.seed);
                flight::play(&mut player, cable)?;
            }
            Self::Core(core) => core.play(&mut player)?,
        }
        player.finish()
    }
}

impl Core {
    fn play(&mut self, player: &mut Player) -> Result<()> {
        let mut byte = [0];
        while !player.is_over() {
            self.output.read_exact(&mut byte).context("the core has ended")?;
            if let Some(frame) = player.hear(byte[0])? {
                self.input.write_all(frame.bytes())?;
            }
        }
        Ok(())
    }
}

impl Drop for Core {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }
}
