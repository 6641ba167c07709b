//! The link to the host: semihosting, which an emulator or a debugger answers.

use planner_core::link::delivery::Port;
use semihosting::fd::{AsFd, BorrowedFd};
use semihosting::io::{Stdin, Stdout, stdin, stdout};
use semihosting::process::exit;
#[cfg(target_arch = "arm")]
use semihosting::sys::arm_compat::sys_elapsed;
use semihosting::sys::arm_compat::{sys_read_orig, sys_write_orig};

/// Standard input and standard output of the host.
pub(crate) struct Streams(Stdin, Stdout);

impl Streams {
    /// Opens both; `None` if the host has none.
    pub(crate) fn open() -> Option<Self> {
        Some(Self(stdin().ok()?, stdout().ok()?))
    }
}

/// The link over the host's streams. At the end of the input the program ends.
pub(crate) struct Semihosting<'a> {
    // Borrowed once: each time the crate asserts that the stream is one, which is a panic.
    input: BorrowedFd<'a>,
    output: BorrowedFd<'a>,
    /// A call of the host costs an exception, so input is taken in by the chunk.
    chunk: [u8; 64],
    /// What of the chunk has not been handed on.
    unread: core::ops::Range<usize>,
}

impl<'a> Semihosting<'a> {
    pub(crate) fn new(Streams(input, output): &'a Streams) -> Self {
        Self { input: input.as_fd(), output: output.as_fd(), chunk: [0; 64], unread: 0..0 }
    }
}

impl Port for Semihosting<'_> {
    fn send(&mut self, mut frame: &[u8]) {
        while !frame.is_empty() {
            match sys_write_orig(self.output, frame) {
                Ok(left) if left < frame.len() => {
                    frame = frame.get(frame.len() - left..).unwrap_or(&[]);
                }
                _ => exit(2), // nobody listens
            }
        }
    }

    /// The stream is never silent: it has bytes, or it is at its end.
    fn receive(&mut self) -> Option<u8> {
        if self.unread.is_empty() {
            let room = self.chunk.len();
            match sys_read_orig(self.input, &mut self.chunk) {
                Ok(left) if left < room => self.unread = 0..room - left,
                _ => exit(0),
            }
        }
        let at = self.unread.next()?;
        self.chunk.get(at).copied()
    }
}

/// The host's tick counter, its low word: instructions in the tests' emulator. Zero where there is
/// none.
#[cfg(target_arch = "arm")]
pub(crate) fn ticks() -> u32 {
    sys_elapsed().map_or(0, |ticks| ticks as u32)
}

/// Instructions that the core has retired, the low word. QEMU counts them with `-icount shift=0`.
#[cfg(target_arch = "riscv32")]
pub(crate) fn ticks() -> u32 {
    riscv::register::minstret::read() as u32
}
