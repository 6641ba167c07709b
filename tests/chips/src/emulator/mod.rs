//! An Arm core in this process: it runs a program linked for `memory.x` and answers its semihosting.
//!
//! The interpreter is the crate `armagnac`; the modules below add the parts of a Cortex-M4F that it lacks. There are no
//! peripherals and no exceptions. An unknown instruction, address or host call ends the test with the program counter
//! and the opcode.
//!
//! | module | adds |
//! | --- | --- |
//! | `decoder` | joins the instructions, and caches decoded ones |
//! | `dsp` | extends, packing and multiplies |
//! | `missing_instructions` | cases that the interpreter has but leaves undefined |
//! | `vfp`, `single` | the floating-point unit: its registers, its arithmetic |
//! | `semihosting` | calls of the host |
//! | `cycles`, `profile` | the cost: cycles by a table; calls of functions that are watched |

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;

use armagnac::core::{Config, Emulator as _, Event as Happening, Processor};
use armagnac::memory::RamMemory;
use armagnac::registers::Mode;
use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};

use crate::program::CHIP;
use decoder::Decoder;
pub use profile::Call;
use profile::{Place, Profile};
use semihosting::Host;

mod cycles;
mod decoder;
mod dsp;
mod missing_instructions;
pub mod missions;
mod profile;
mod semihosting;
mod single;
mod vfp;

const FLASH: u32 = 0x0800_0000;
const FLASH_BYTES: usize = 1024 * 1024;
const RAM: u32 = 0x2000_0000;
const RAM_BYTES: u32 = 128 * 1024;

/// Where the stack begins.
pub const RAM_END: u32 = RAM + RAM_BYTES;

/// Where the vectors are.
const VTOR: u32 = 0xe000_ed08;

/// The configuration and control register, and its bit that makes unaligned accesses a fault.
const CCR: u32 = 0xe000_ed14;
const UNALIGN_TRP: u32 = 1 << 3;

/// A program without output for this many instructions hangs: they take this emulator more than a minute.
const PATIENCE: u64 = 1_000_000_000;

/// A core to run a program on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Core {
    /// Cortex-M0: Armv6-M, without a floating-point unit.
    M0,
    /// Cortex-M4F: Armv7E-M with single precision.
    M4F,
}

impl Core {
    /// What `footprint.toml` calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::M0 => "cortex-m0",
            Self::M4F => "cortex-m4f",
        }
    }

    /// Its target.
    pub const fn target(self) -> &'static str {
        match self {
            Self::M0 => "thumbv6m-none-eabi",
            Self::M4F => CHIP,
        }
    }
}

/// What the program wants of the world.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// It writes to its standard output.
    Write(Vec<u8>),
    /// It waits for input. If nothing was supplied when it runs on, its input is at an end.
    Read,
    /// It ended with this status.
    Exit(i32),
    /// The last call that was to be watched has returned.
    Halted,
}

/// A core with a program in its flash.
pub struct Emulator {
    processor: Processor,
    host: Host,
    lowest_stack: u32,
    profile: Profile,
    /// Calls to be watched before it halts.
    calls: Option<usize>,
}

/// The program did something that is not known here.
struct Failure {
    pc: u32,
    reason: String,
}

impl Emulator {
    /// The core as a reset leaves it, with the program in flash.
    ///
    /// # Panics
    /// If that is no 32-bit ELF whose segments load into flash.
    pub fn load(elf: &[u8], core: Core) -> Self {
        let mut flash = vec![0xff; FLASH_BYTES];
        for (address, bytes) in segments(elf).expect("a 32-bit ELF") {
            let start = address.checked_sub(FLASH).expect("loads into flash") as usize;
            flash[start..start + bytes.len()].copy_from_slice(bytes);
        }
        Self::reset(&flash, core)
    }

    fn reset(flash: &[u8], core: Core) -> Self {
        let profile = Profile::new(flash);
        let flash = RamMemory::new_from_slice(flash).read_only();
        let mut processor = Processor::new(match core {
            Core::M0 => Config::v6m(),
            Core::M4F => Config::v7em(),
        });
        processor.instruction_decoder = Box::new(Decoder::new(core));
        processor.map_iface(FLASH, Rc::new(RefCell::new(flash))).expect("an empty map");
        processor.map_ram(RAM, RAM_BYTES).expect("apart from flash");
        processor.write_u32le_iface(VTOR, FLASH).expect("a register");
        if core == Core::M0 {
            // It has no accesses off their alignment, which the interpreter would make.
            processor.write_u32le_iface(CCR, UNALIGN_TRP).expect("a register");
        }
        let (host, lowest_stack) = (Host::default(), u32::MAX);
        let mut emulator = Self { processor, host, lowest_stack, profile, calls: None };
        emulator.restart();
        emulator
    }

    /// Begins anew as after a reset, with what is in RAM left there. What was decoded is kept, so this is
    /// quicker than another emulator.
    ///
    /// # Panics
    /// If there are no vectors.
    pub fn restart(&mut self) {
        let [stack, reset] =
            [0, 4].map(|n| self.processor.read_u32le_iface(FLASH + n).expect("a vector in flash"));
        self.processor.set_sp(stack);
        self.processor.set_lr(u32::MAX);
        self.processor.set_pc(reset & !1);
        self.host = Host::default();
        self.profile.calls.clear();
        self.calls = None;
    }

    /// Runs until the program wants something of the world, or it halts.
    ///
    /// # Panics
    /// If the program does what is not known here, takes an exception or hangs.
    pub fn run(&mut self) -> Event {
        if let Err(reason) = self.host.resume(&mut self.processor) {
            self.fail(&Failure { pc: self.processor.pc(), reason });
        }
        let mut pc = 0;
        // The interpreter panics where it is unfinished, and does not say at which instruction.
        let executed = catch_unwind(AssertUnwindSafe(|| self.execute(&mut pc)));
        let event = executed.unwrap_or_else(|_| {
            let reason = "armagnac panics".to_owned();
            Err(Failure { pc, reason })
        });
        event.unwrap_or_else(|failure| self.fail(&failure))
    }

    fn execute(&mut self, pc: &mut u32) -> Result<Event, Failure> {
        let limit = self.instructions() + PATIENCE;
        while self.instructions() < limit {
            *pc = self.processor.pc();
            let failure = |reason| Failure { pc: *pc, reason };
            let happening = self.processor.next_event().map_err(|it| failure(format!("{it:?}")))?;
            let to = self.place();
            self.lowest_stack = self.lowest_stack.min(to.sp);
            let returned = self.profile.executed(*pc, to);
            if self.processor.registers.mode == Mode::Handler {
                return Err(failure("an exception".to_owned()));
            }
            if returned && self.calls == Some(self.profile.calls.len()) {
                return Ok(Event::Halted);
            }
            let answer = match happening {
                Happening::Instruction { .. } => continue,
                Happening::Break(semihosting::BREAKPOINT) => self.host.call(&mut self.processor),
                _ => Err("a breakpoint or a reset".into()),
            };
            if let Some(event) = answer.map_err(failure)? {
                return Ok(event);
            }
        }
        let reason = format!("nothing in {PATIENCE} instructions");
        Err(Failure { pc: self.processor.pc(), reason })
    }

    /// Appends to the program's standard input.
    pub fn supply(&mut self, bytes: &[u8]) {
        self.host.input.extend(bytes);
    }

    /// All that was supplied since a restart.
    pub fn supplied(&self) -> &[u8] {
        &self.host.input
    }

    /// Instructions executed since the reset.
    pub fn instructions(&self) -> u64 {
        self.processor.cycles
    }

    /// The lowest stack pointer since the reset.
    pub fn lowest_stack(&self) -> u32 {
        self.lowest_stack
    }

    /// Records every call of the function at an address, except within a call of another watched function.
    pub fn watch(&mut self, function: u32) {
        self.profile.watch(function);
    }

    /// Makes it halt when this many calls of watched functions have returned since a restart.
    pub fn halt_after(&mut self, calls: usize) {
        self.calls = Some(calls);
    }

    /// The calls of watched functions since a restart or the last time.
    pub fn calls(&mut self) -> Vec<Call> {
        std::mem::take(&mut self.profile.calls)
    }

    fn place(&self) -> Place {
        let (pc, sp, lr) = (self.processor.pc(), self.processor.sp(), self.processor.lr());
        Place { pc, sp, lr, instructions: self.instructions() }
    }

    fn fail(&mut self, Failure { pc, reason }: &Failure) -> ! {
        let [first, second] = [*pc, pc.wrapping_add(2)]
            .map(|at| self.processor.read_u16le_iface(at).map_or("----".into(), hexadecimal));
        let count = self.instructions();
        panic!("at pc {pc:#010x}, opcode {first} {second}, after {count} instructions: {reason}");
    }
}

fn hexadecimal(halfword: u16) -> String {
    format!("{halfword:04x}")
}

/// What is to be loaded, and where: the addresses are those in flash, also of initialised data.
fn segments(elf: &[u8]) -> Option<Vec<(u32, &[u8])>> {
    let header = FileHeader32::<Endianness>::parse(elf).ok()?;
    let endian = header.endian().ok()?;
    let segments = header.program_headers(endian, elf).ok()?.iter();
    segments
        .filter(|it| it.p_type(endian) == PT_LOAD && it.p_filesz(endian) != 0)
        .map(|it| Some((it.p_paddr(endian), it.data(endian, elf).ok()?)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A core with a program right behind its vectors, at `0x0800_0008`.
    fn emulator(program: &[u16], core: Core) -> Emulator {
        let vectors = [0x0000, 0x2002, 0x0009, 0x0800];
        let halfwords = vectors.iter().chain(program);
        let mut flash: Vec<u8> = halfwords.flat_map(|it| it.to_le_bytes()).collect();
        flash.resize(FLASH_BYTES, 0xff);
        Emulator::reset(&flash, core)
    }

    /// movs r0, #0x20; lsls r0, r0, #24; adds r0, #1; ldr r1, [r0]; udf #0
    const UNALIGNED: [u16; 5] = [0x2020, 0x0600, 0x3001, 0x6801, 0xde00];

    #[test]
    #[should_panic(expected = "at pc 0x08000010, opcode de00")]
    fn what_is_unknown_fails_with_its_place() {
        emulator(&UNALIGNED, Core::M4F).run();
    }

    #[test]
    #[should_panic(
        expected = "at pc 0x0800000e, opcode 6801 de00, after 4 instructions: an exception"
    )]
    fn an_m0_faults_off_alignment() {
        emulator(&UNALIGNED, Core::M0).run();
    }
}
