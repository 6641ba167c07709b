//! Calls of the host: the operation in r0, its block of parameters at r1, the answer in r0.

use armagnac::core::{Processor, RunError};

use super::Event;

/// The breakpoint that makes a call.
pub(super) const BREAKPOINT: u8 = 0xab;

const OPEN: u32 = 0x01;
const CLOSE: u32 = 0x02;
const WRITE: u32 = 0x05;
const READ: u32 = 0x06;
const EXIT: u32 = 0x18;
const EXIT_EXTENDED: u32 = 0x20;
const ELAPSED: u32 = 0x30;

/// The only file there is.
const CONSOLE: &[u8] = b":tt";

const INPUT: u32 = 1;
const OUTPUT: u32 = 2;

/// The reason of a normal exit.
const APPLICATION_EXIT: u32 = 0x2_0026;

/// The world as the program sees it.
#[derive(Default)]
pub(super) struct Host {
    /// All that was supplied, and how much of it the program has read.
    pub(super) input: Vec<u8>,
    read: usize,
    /// The address and the length of a read that found no input.
    wanted: Option<(u32, u32)>,
}

impl Host {
    /// Answers the call that the processor has just made; an error says what is wrong with it.
    pub(super) fn call(&mut self, processor: &mut Processor) -> Result<Option<Event>, String> {
        let (operation, block) = (processor.registers.r0, processor.registers.r1);
        let mut read = |n: u32| processor.read_u32_aligned(block + 4 * n).map_err(debug);
        let (answer, event) = match operation {
            OPEN => {
                let (name, mode, length) = (read(0)?, read(1)?, read(2)?);
                let name = processor.read_bytes_iface(name, length).map_err(debug)?;
                match mode {
                    0..4 if name == CONSOLE => (INPUT, None),
                    4..8 if name == CONSOLE => (OUTPUT, None),
                    _ => return Err(format!("opens {name:?} in mode {mode}")),
                }
            }
            CLOSE => (0, None),
            WRITE if read(0)? == OUTPUT => {
                let (from, length) = (read(1)?, read(2)?);
                let bytes = processor.read_bytes_iface(from, length).map_err(debug)?;
                (0, Some(Event::Write(bytes)))
            }
            READ if read(0)? == INPUT => {
                let (to, length) = (read(1)?, read(2)?);
                if self.read == self.input.len() {
                    self.wanted = Some((to, length));
                    return Ok(Some(Event::Read));
                }
                (self.deliver(processor, to, length).map_err(debug)?, None)
            }
            EXIT => (0, Some(exit(block, 0))),
            EXIT_EXTENDED => (0, Some(exit(read(0)?, read(1)?))),
            ELAPSED => {
                let count = processor.cycles;
                for (n, word) in [count as u32, (count >> 32) as u32].into_iter().enumerate() {
                    processor.write_u32_aligned(block + 4 * n as u32, word).map_err(debug)?;
                }
                (0, None)
            }
            _ => return Err(format!("calls the host for operation {operation:#x}")),
        };
        processor.registers.r0 = answer;
        Ok(event)
    }

    /// Completes a read that found no input. If there is still none, the input is at an end.
    pub(super) fn resume(&mut self, processor: &mut Processor) -> Result<(), String> {
        if let Some((to, length)) = self.wanted.take() {
            processor.registers.r0 = self.deliver(processor, to, length).map_err(debug)?;
        }
        Ok(())
    }

    /// Moves input into memory and returns how many bytes of the wish are left unfulfilled.
    fn deliver(
        &mut self,
        processor: &mut Processor,
        to: u32,
        length: u32,
    ) -> Result<u32, RunError> {
        let rest = &self.input[self.read..];
        let count = rest.len().min(length as usize);
        processor.write_bytes_iface(to, &rest[..count])?;
        self.read += count;
        Ok(length - count as u32)
    }
}

fn exit(reason: u32, status: u32) -> Event {
    Event::Exit(if reason == APPLICATION_EXIT { status.cast_signed() } else { 1 })
}

fn debug(error: RunError) -> String {
    format!("a call of the host: {error:?}")
}
