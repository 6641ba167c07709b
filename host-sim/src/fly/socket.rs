//! A link to a real vehicle: an address, a thread that reads, a clock.

use std::io::ErrorKind;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail};
use mavlink::dialects::common::MavMessage;
use mavlink::error::MessageReadError;
use mavlink::{Connectable as _, Connection, ConnectionAddress, MavConnection as _, MavHeader};

use crate::fly::link::Link;
use crate::fly::orders::{OWN_COMPONENT, OWN_SYSTEM};
use crate::fly::udp;

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

/// How long a read of a serial line waits. By default the library asks a thousand times a second.
const SERIAL_PAUSE: Duration = Duration::from_millis(100);

/// What carries messages.
enum Way {
    Udp(udp::Sender),
    /// TCP, or a serial line.
    Stream(Arc<Connection<MavMessage>>),
}

/// A link by UDP, TCP or a serial line.
pub struct Socket {
    way: Way,
    arriving: Receiver<(MavHeader, MavMessage)>,
    opened: Instant,
}

impl Socket {
    /// Opens an address, to speak to the vehicle of a system id.
    ///
    /// # Errors
    /// When it is no address, or cannot be opened.
    pub fn open(address: &str, system: u8) -> Result<Self> {
        let form = address
            .split_once(':')
            .and_then(|(form, rest)| Some((FORMS.iter().find(|it| it.0 == form)?.1, rest)));
        let Some((form, rest)) = form.filter(|(_, rest)| rest.contains(':')) else {
            bail!(
                "found {address:?}, expected udp:HOST:PORT (listens), udpout:HOST:PORT, \
                 tcp:HOST:PORT or serial:DEVICE:BAUD"
            );
        };
        let (to, arriving) = mpsc::channel();
        let expected = || format!("{address}: expected an address that can be opened");
        let way = if form.starts_with("udp") {
            let opened = udp::open(rest, form == "udpin", system).with_context(expected)?;
            let (sender, mut reader) = opened;
            listen(to, move || reader.receive().map_err(|error| error.kind()));
            Way::Udp(sender)
        } else {
            let address = ConnectionAddress::parse_address(&format!("{form}:{rest}"));
            let connection = match address.with_context(expected)? {
                ConnectionAddress::Serial(line) => line.timeout(SERIAL_PAUSE).connect(),
                other => other.connect(),
            };
            let connection = Arc::new(connection.with_context(expected)?);
            let reader = Arc::clone(&connection);
            listen(to, move || match reader.recv() {
                Ok(arrived) => Ok(vec![arrived]),
                Err(MessageReadError::Io(error)) => Err(error.kind()),
                // Messages that are not known are skipped.
                Err(MessageReadError::Parse(_)) => Ok(Vec::new()),
            });
            Way::Stream(connection)
        };
        Ok(Self { way, arriving, opened: Instant::now() })
    }
}

/// Hands on what arrives, until the link breaks or nobody listens any more.
fn listen(
    to: Sender<(MavHeader, MavMessage)>,
    mut receive: impl FnMut() -> Result<Vec<(MavHeader, MavMessage)>, ErrorKind> + Send + 'static,
) {
    thread::spawn(move || {
        loop {
            match receive() {
                Ok(arrived) => {
                    if arrived.into_iter().any(|it| to.send(it).is_err()) {
                        return;
                    }
                }
                // By UDP: nobody listens at the other end yet.
                Err(ErrorKind::ConnectionRefused) => thread::sleep(Duration::from_millis(10)),
                // A pause: the library reads TCP with a time-out of 100 ms.
                Err(kind) if is_pause(kind) => {}
                Err(_) => return,
            }
        }
    });
}

/// Whether nothing arrived yet. Other errors are for good.
const fn is_pause(error: ErrorKind) -> bool {
    matches!(error, ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

impl Link for Socket {
    fn now(&self) -> Duration {
        self.opened.elapsed()
    }

    fn send(&mut self, message: &MavMessage) {
        let header = MavHeader { system_id: OWN_SYSTEM, component_id: OWN_COMPONENT, sequence: 0 };
        match &mut self.way {
            Way::Udp(sender) => sender.send(header, message),
            // The connection numbers messages. One that it does not take is lost.
            Way::Stream(connection) => drop(connection.send(&header, message)),
        }
    }

    fn receive(&mut self, until: Duration) -> Result<Option<(MavHeader, MavMessage)>> {
        match self.arriving.recv_timeout(until.saturating_sub(self.now())) {
            Ok(arrived) => Ok(Some(arrived)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => bail!("it was closed at its other end"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::net::TcpListener;

    use mavlink::{MavlinkVersion, write_versioned_msg};

    use super::*;
    use crate::fly::orders::heartbeat;

    #[test]
    fn a_tcp_link_outlives_pauses_and_ends_with_its_other_end() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("bound");
        let mut link = Socket::open(&format!("tcp:{address}"), 1).expect("it listens");
        let (mut vehicle, _) = listener.accept().expect("a connection");
        // Silent for much longer than the library's time-out, twice.
        for _ in 0..2 {
            let until = link.now() + Duration::from_millis(350);
            assert!(link.receive(until).expect("a pause is no end").is_none());
            let mut bytes = Vec::new();
            write_versioned_msg(&mut bytes, MavlinkVersion::V2, MavHeader::default(), &heartbeat())
                .expect("it fits");
            vehicle.write_all(&bytes).expect("it is connected");
            let until = link.now() + Duration::from_secs(10);
            assert!(link.receive(until).expect("it is open").is_some());
        }
        drop(vehicle);
        let until = link.now() + Duration::from_secs(10);
        let error = link.receive(until).expect_err("it was closed").to_string();
        assert_eq!(error, "it was closed at its other end");
    }
}
