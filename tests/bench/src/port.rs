//! The link to the host: semihosting, which an emulator or a debugger answers.

use planner_core::link::Port;
use semihosting::io::{Read, Stdin, Stdout, Write, stdin, stdout};
use semihosting::process::exit;
use semihosting::sys::arm_compat::sys_elapsed;

/// Standard output and standard input of the host. At the end of the input the program ends.
pub(crate) struct Semihosting {
    input: Stdin,
    output: Stdout,
    /// A call of the host costs an exception, so input is taken in by the chunk.
    chunk: [u8; 64],
    /// What of the chunk has not been handed on.
    unread: core::ops::Range<usize>,
}

impl Semihosting {
    /// Opens both streams; `None` if the host has none.
    pub(crate) fn open() -> Option<Self> {
        let (input, output) = (stdin().ok()?, stdout().ok()?);
        Some(Self { input, output, chunk: [0; 64], unread: 0..0 })
    }
}

impl Port for Semihosting {
    fn send(&mut self, mut frame: &[u8]) {
        while !frame.is_empty() {
            match self.output.write(frame) {
                Ok(n @ 1..) => frame = frame.get(n..).unwrap_or(&[]),
                _ => exit(2), // nobody listens
            }
        }
    }

    /// The stream is never silent: it has bytes, or it is at its end.
    fn receive(&mut self) -> Option<u8> {
        if self.unread.is_empty() {
            match self.input.read(&mut self.chunk) {
                Ok(n @ 1..) => self.unread = 0..n,
                _ => exit(0),
            }
        }
        let at = self.unread.next()?;
        self.chunk.get(at).copied()
    }
}

/// The host's tick counter, its low word: instructions in the tests' emulator. Zero where there is
/// none.
pub(crate) fn ticks() -> u32 {
    sys_elapsed().map_or(0, |ticks| ticks as u32)
}
