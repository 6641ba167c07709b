//! A debugger for the chip in QEMU, by the remote protocol of gdb.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::ops::Range;
use std::thread;
use std::time::{Duration, Instant};

/// How long to wait for anything that QEMU does at once.
const PATIENCE: Duration = Duration::from_secs(20);

/// The program counter among all registers, as hexadecimal digits.
const PC: Range<usize> = 15 * 8..16 * 8;

/// Bytes of memory that an answer has room for.
const MOST: u32 = 1024;

/// A debugger at QEMU's stub: commands out, answers in.
#[derive(Debug)]
pub(crate) struct Debugger {
    out: TcpStream,
    answers: BufReader<TcpStream>,
}

impl Debugger {
    /// Connecting halts the chip.
    ///
    /// # Panics
    /// When nobody listens, as all functions below when QEMU does not answer.
    pub(crate) fn connect(port: u16) -> Self {
        // QEMU does not listen from its first moment on.
        let since = Instant::now();
        let out = loop {
            match TcpStream::connect(("127.0.0.1", port)) {
                Ok(out) => break out,
                Err(error) => assert!(since.elapsed() < PATIENCE, "QEMU listens: {error}"),
            }
            thread::sleep(Duration::from_millis(5));
        };
        out.set_read_timeout(Some(PATIENCE)).expect("a socket");
        let answers = BufReader::new(out.try_clone().expect("a socket"));
        let mut debugger = Self { out, answers };
        assert!(debugger.answer().starts_with('T'), "it says that it has halted");
        debugger
    }

    /// Sends a command.
    pub(crate) fn say(&mut self, command: &str) {
        let sum = command.bytes().fold(0, u8::wrapping_add);
        write!(self.out, "${command}#{sum:02x}").expect("QEMU listens");
    }

    /// Sends a command and returns its answer.
    pub(crate) fn ask(&mut self, command: &str) -> String {
        self.say(command);
        self.answer()
    }

    /// The next answer: the text between `$` and `#`, without the checksum after it.
    pub(crate) fn answer(&mut self) -> String {
        let mut answer = Vec::new();
        self.answers.read_until(b'#', &mut answer).expect("QEMU answers");
        self.answers.read_exact(&mut [0; 2]).expect("a checksum");
        write!(self.out, "+").expect("QEMU listens");
        let answer = String::from_utf8_lossy(&answer).into_owned();
        answer.trim_start_matches('+').trim_matches(['$', '#']).to_owned()
    }

    /// Halts a chip that runs.
    pub(crate) fn halt(&mut self) {
        self.out.write_all(&[3]).expect("QEMU listens");
        assert!(self.answer().starts_with('T'), "it says that it has halted");
    }

    /// Has a chip that is halted go on elsewhere.
    pub(crate) fn jump(&mut self, address: u32) {
        let mut registers = self.ask("g");
        registers.replace_range(PC, &format!("{:08x}", address.swap_bytes()));
        assert_eq!(self.ask(&format!("G{registers}")), "OK");
    }

    /// What is in memory.
    pub(crate) fn memory(&mut self, address: u32, bytes: u32) -> Vec<u8> {
        let mut memory = Vec::new();
        while memory.len() < bytes as usize {
            let (at, left) = (address + memory.len() as u32, bytes - memory.len() as u32);
            let answer = self.ask(&format!("m{at:x},{:x}", left.min(MOST)));
            let byte = |digits| u8::from_str_radix(digits, 16).expect("memory, in digits");
            memory.extend((0..answer.len()).step_by(2).map(|n| byte(&answer[n..n + 2])));
        }
        memory
    }
}

/// A free port for QEMU to listen at.
pub(crate) fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    listener.local_addr().expect("it is bound").port()
}
