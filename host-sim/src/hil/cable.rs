//! The link's bytes in time: a port behind a thread that reads it, and faults on the way.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read, Write};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, anyhow};

use crate::hil::faults::{Faults, Spoiler};

/// Which way a frame goes.
#[derive(Clone, Copy)]
enum Way {
    In,
    Out,
}

/// A cable to a chip.
pub struct Cable {
    port: Box<dyn Write>,
    arriving: Receiver<Vec<u8>>,
    /// What has arrived of a frame.
    partial: Vec<u8>,
    spoil_in: Spoiler,
    spoil_out: Spoiler,
    /// What is on its way, by when it arrives and in the order in which it left.
    under_way: BTreeMap<(Instant, u64), (Way, Vec<u8>)>,
    sent: u64,
}

impl Cable {
    /// A cable at a port, spoiled as asked. The reader's reads may time out.
    pub fn new(
        mut reader: impl Read + Send + 'static,
        port: impl Write + 'static,
        faults: Faults,
        seed: u64,
    ) -> Self {
        let (sender, arriving) = mpsc::channel();
        // Ends with the port, or when nobody listens any more.
        thread::spawn(move || {
            let mut buffer = [0; 512];
            loop {
                match reader.read(&mut buffer) {
                    Ok(0) => return,
                    Ok(n) => {
                        if sender.send(buffer[..n].to_vec()).is_err() {
                            return;
                        }
                    }
                    Err(e) if matches!(e.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock) => {}
                    Err(e) if e.kind() == ErrorKind::Interrupted => {}
                    Err(_) => return,
                }
            }
        });
        Self {
            port: Box::new(port),
            arriving,
            partial: Vec::new(),
            spoil_in: Spoiler::new(faults, seed, 0),
            spoil_out: Spoiler::new(faults, seed, 1),
            under_way: BTreeMap::new(),
            sent: 0,
        }
    }

    /// Sends a frame.
    ///
    /// # Errors
    /// When the port does not take it.
    pub fn send(&mut self, frame: &[u8]) -> Result<()> {
        let arriving = self.spoil_out.spoil(frame);
        self.launch(Way::Out, arriving);
        self.deliver(Instant::now()).map(drop)
    }

    /// The next bytes that arrive by a time; `None` when none do.
    ///
    /// # Errors
    /// When the port is closed or does not take what is due.
    pub fn receive(&mut self, until: Instant) -> Result<Option<Vec<u8>>> {
        loop {
            let now = Instant::now();
            if let Some(bytes) = self.deliver(now)? {
                return Ok(Some(bytes));
            }
            if now >= until {
                return Ok(None);
            }
            let due = self.under_way.first_key_value().map_or(until, |((due, _), _)| *due);
            match self.arriving.recv_timeout(due.min(until) - now) {
                Ok(bytes) => self.split(&bytes),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(anyhow!("the port was closed at its other end"));
                }
            }
        }
    }

    /// Frames end in a zero, and may begin with some.
    fn split(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.partial.push(byte);
            if byte == 0 && self.partial.iter().any(|byte| *byte != 0) {
                let frame = std::mem::take(&mut self.partial);
                let arriving = self.spoil_in.spoil(&frame);
                self.launch(Way::In, arriving);
            }
        }
    }

    fn launch(&mut self, way: Way, arriving: Vec<(Duration, Vec<u8>)>) {
        let now = Instant::now();
        for (late, bytes) in arriving {
            self.sent += 1;
            self.under_way.insert((now + late, self.sent), (way, bytes));
        }
    }

    /// Sends what is due on its way out, and returns what is due on its way in.
    fn deliver(&mut self, now: Instant) -> Result<Option<Vec<u8>>> {
        while let Some(first) = self.under_way.first_entry() {
            if first.key().0 > now {
                break;
            }
            match first.remove() {
                (Way::In, bytes) => return Ok(Some(bytes)),
                (Way::Out, bytes) => {
                    self.port.write_all(&bytes).context("the port takes no bytes")?;
                    self.port.flush().context("the port takes no bytes")?;
                }
            }
        }
        Ok(None)
    }
}
