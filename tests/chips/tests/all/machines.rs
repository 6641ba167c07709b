//! Machines that fly missions: bare cores in the tests' emulator; under QEMU two boards with their firmware, and a
//! RISC-V core with the planner alone.

use std::fs::{self, File};
use std::io::{Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::thread;

use anyhow::{Context as _, Result};
use chips::emulator::{self, Emulator};
use chips::program::{self, CHIP};
use host_sim::hil::faults::Faults;
use host_sim::hil::firmware::{MICROBIT, STM32F405};
use host_sim::hil::player::{Played, Player};
use host_sim::mission::definition::Mission;
use planner_core::link::message::LabelSource;
use tests::build::{has_tool, skip};

use crate::board::{Board, player};

/// What a machine is and runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kind {
    /// What people call it.
    pub(crate) name: &'static str,
    /// Its name in QEMU; empty if it is emulated here.
    pub(crate) machine: &'static str,
    qemu: &'static str,
    package: &'static str,
    target: &'static str,
    program: &'static str,
    core: emulator::Core,
}

/// The first board, with `firmware`.
pub(crate) const STM32: Kind = Kind {
    name: "STM32F405",
    machine: STM32F405.machine,
    qemu: "qemu-system-arm",
    package: "firmware",
    target: CHIP,
    program: "firmware",
    core: emulator::Core::M4F,
};

/// The same board on a robot with two wheels, which it drives itself.
pub(crate) const WHEELS: Kind = Kind { program: "wheels", ..STM32 };

/// The second, with `firmware/microbit`.
pub(crate) const NRF51: Kind = Kind {
    name: "nRF51822",
    machine: MICROBIT.machine,
    package: "microbit",
    target: "thumbv6m-none-eabi",
    program: "microbit",
    core: emulator::Core::M0,
    ..STM32
};

/// A RISC-V core, with a program of the package `bare-core`.
pub(crate) const fn riscv(program: &'static str) -> Kind {
    Kind {
        name: "RISC-V",
        machine: "virt",
        qemu: "qemu-system-riscv32",
        package: "bare-core",
        target: "riscv32imac-unknown-none-elf",
        program,
        ..STM32
    }
}

/// A bare core in the emulator, with such a program.
pub(crate) const fn bare(core: emulator::Core, program: &'static str) -> Kind {
    let (name, target) = (core.name(), core.target());
    Kind { name, machine: "", package: "bare-core", target, program, core, ..STM32 }
}

impl Kind {
    /// Its program, built; `None`, and a visible line, where that cannot be built or run.
    pub(crate) fn elf(&self) -> Option<PathBuf> {
        if !self.machine.is_empty() && !has_tool(self.qemu) {
            skip(&format!("{} under QEMU", self.name), &format!("{} is not on PATH", self.qemu));
            return None;
        }
        Some(program::folder(self.package, self.target, self.program)?.join(self.program))
    }

    /// Starts one; `None` where that cannot be.
    pub(crate) fn start(self) -> Option<Box<dyn Machine>> {
        Some(match (self.machine, self.package) {
            ("", _) => {
                let elf = fs::read(self.elf()?).expect("cargo left an ELF");
                Box::new(Emulator::load(&elf, self.core))
            }
            (_, "bare-core") => Box::new(Core::start(self, &[])?),
            _ => Box::new(Board::start(self, &[])?),
        })
    }
}

/// A machine that runs.
pub(crate) trait Machine {
    /// Lets it fly a mission.
    ///
    /// # Errors
    /// When it does not fly as this machine does.
    fn fly(&mut self, mission: &Mission) -> Result<Played>;
}

impl Machine for Emulator {
    fn fly(&mut self, mission: &Mission) -> Result<Played> {
        Self::fly(self, mission)
    }
}

impl Machine for Board {
    fn fly(&mut self, mission: &Mission) -> Result<Played> {
        Self::fly(self, mission, Faults::default())
    }
}

/// A core under QEMU, which ends with this value. Its link are the streams of its semihosting.
pub(crate) struct Core {
    qemu: Child,
    input: ChildStdin,
    output: ChildStdout,
}

impl Core {
    /// Starts one, with further arguments for QEMU; `None` where that cannot be.
    pub(crate) fn start(kind: Kind, more: &[&str]) -> Option<Self> {
        let mut qemu = Command::new(kind.qemu)
            .args(["-M", kind.machine, "-bios", "none", "-nographic", "-monitor", "none"])
            // A nanosecond an instruction: the core's own count of them is then right.
            .args(["-serial", "none", "-icount", "shift=0"])
            .args(["-semihosting-config", "enable=on,target=native"])
            .args(more)
            .arg("-kernel")
            .arg(kind.elf()?)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("QEMU starts");
        let input = qemu.stdin.take().expect("it is piped");
        let output = qemu.stdout.take().expect("it is piped");
        Some(Self { qemu, input, output })
    }

    /// Has it read zeros from now on, which are no frames. While it waits for input QEMU answers no debugger.
    pub(crate) fn keep_awake(&self) {
        let input = self.input.as_fd().try_clone_to_owned().expect("a descriptor");
        let mut input = File::from(input);
        // Ends with the core.
        thread::spawn(move || while input.write_all(&[0; 64]).is_ok() {});
    }

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

impl Machine for Core {
    fn fly(&mut self, mission: &Mission) -> Result<Played> {
        let mut player = player(mission, LabelSource::Vehicle);
        self.play(&mut player)?;
        player.finish()
    }
}

impl Drop for Core {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }
}
