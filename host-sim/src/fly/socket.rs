//! A link to a real vehicle: an address, a thread that reads, a clock.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use mavlink::dialects::common::MavMessage;
use mavlink::error::MessageReadError;
use mavlink::{Connection, MavConnection as _, MavHeader, connect};

use crate::fly::link::Link;
use crate::fly::orders::{OWN_COMPONENT, OWN_SYSTEM};

/// What an address begins with, and what the library calls that. Of these `udp` is what other ground stations mean by
/// it: to listen, and to answer whoever speaks.
const FORMS: [(&str, &str); 6] = [
    ("udp", "udpin"),
    ("udpin", "udpin"),
    ("udpout", "udpout"),
    ("tcp", "tcpout"),
    ("tcpout", "tcpout"),
    ("serial", "serial"),
];

/// A link by UDP, TCP or a serial line.
pub struct Socket {
    connection: Arc<Connection<MavMessage>>,
    arriving: Receiver<(MavHeader, MavMessage)>,
    opened: Instant,
}

impl Socket {
    /// Opens an address.
    ///
    /// # Errors
    /// When it is none, or cannot be opened.
    pub fn open(address: &str) -> Result<Self> {
        let form = address
            .split_once(':')
            .and_then(|(form, rest)| Some((FORMS.iter().find(|it| it.0 == form)?.1, rest)));
        let Some((form, rest)) = form.filter(|(_, rest)| rest.contains(':')) else {
            bail!(
                "found {address:?}, expected udp:HOST:PORT (listens), udpout:HOST:PORT, \
                 tcp:HOST:PORT or serial:DEVICE:BAUD"
            );
        };
        let connection = connect::<MavMessage>(&format!("{form}:{rest}"))
            .with_context(|| format!("{address}: expected an address that can be opened"))?;
        let connection = Arc::new(connection);
        let reader = Arc::clone(&connection);
        let (sender, arriving) = mpsc::channel();
        // Ends with the connection, or when nobody listens any more.
        thread::spawn(move || {
            loop {
                match reader.recv() {
                    Ok(arrived) => {
                        if sender.send(arrived).is_err() {
                            return;
                        }
                    }
                    // What is no message that is known is passed over.
                    Err(MessageReadError::Parse(_)) => {}
                    Err(MessageReadError::Io(_)) if form.starts_with("udp") => {
                        // Nobody listens at the other end yet.
                        thread::sleep(Duration::from_millis(10));
                    }
                    Err(_) => return,
                }
            }
        });
        Ok(Self { connection, arriving, opened: Instant::now() })
    }
}

impl Link for Socket {
    fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    fn send(&mut self, message: &MavMessage) {
        let header = MavHeader { system_id: OWN_SYSTEM, component_id: OWN_COMPONENT, sequence: 0 };
        // The connection counts; what it does not take is lost.
        let _ = self.connection.send(&header, message);
    }

    fn receive(&mut self, until: Duration) -> Result<Option<(MavHeader, MavMessage)>> {
        match self.arriving.recv_timeout(until.saturating_sub(self.now())) {
            Ok(arrived) => Ok(Some(arrived)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => bail!("it was closed at its other end"),
        }
    }
}
