//! A link by UDP that answers the vehicle, and nobody else.
//!
//! Anybody can send to a port. Only the address from which the vehicle's first heartbeat came is listened to and
//! answered. So a stranger's bytes, or a second vehicle, change nothing. A vehicle that was started anew may speak from
//! another address. That is accepted after a silence that no flight outlives.

use std::collections::VecDeque;
use std::net::{SocketAddr, ToSocketAddrs as _, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use mavlink::dialects::common::MavMessage;
use mavlink::error::MessageReadError;
use mavlink::{MavHeader, MavlinkReader, MavlinkVersion, write_versioned_msg};

use crate::fly::orders::AUTOPILOT;

/// After this silence the vehicle may speak from another address. A flight fails after 5 s of it, and stops 5 s later.
const FORGOTTEN: Duration = Duration::from_secs(15);

/// Addresses that are listened to until the vehicle has spoken.
const MOST_STRANGERS: usize = 8;

/// No datagram is longer.
const LONGEST: usize = 65_536;

/// The bytes of an address, in which messages may be cut anywhere.
pub(crate) type Bytes = MavlinkReader<VecDeque<u8>>;

/// The address that we speak to.
#[derive(Clone, Debug, Default)]
struct Peer(Arc<Mutex<Option<SocketAddr>>>);

impl Peer {
    fn get(&self) -> Option<SocketAddr> {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn set(&self, peer: SocketAddr) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(peer);
    }
}

/// The sending half.
pub(crate) struct Sender {
    socket: UdpSocket,
    peer: Peer,
    sequence: u8,
}

/// The receiving half.
pub(crate) struct Receiver {
    socket: UdpSocket,
    peer: Peer,
    /// Whether the address was given, and so never changes.
    is_fixed: bool,
    system: u8,
    heard: Instant,
    streams: VecDeque<(SocketAddr, Bytes)>,
}

/// Opens a port to listen at, or one to speak to an address from.
///
/// # Errors
/// When that cannot be done.
pub(crate) fn open(address: &str, listens: bool, system: u8) -> Result<(Sender, Receiver)> {
    let expected = || format!("{address}: expected an address that can be opened");
    let all: Vec<_> = address.to_socket_addrs().with_context(expected)?.collect();
    let found = all.iter().find(|it| it.is_ipv4()).or(all.first()).with_context(expected)?;
    let (peer, own) = (Peer::default(), if found.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" });
    let socket = if listens { UdpSocket::bind(found) } else { UdpSocket::bind(own) };
    let socket = socket.with_context(expected)?;
    if !listens {
        peer.set(*found);
    }
    let sender = Sender { socket: socket.try_clone()?, peer: peer.clone(), sequence: 0 };
    let (heard, streams) = (Instant::now(), VecDeque::new());
    Ok((sender, Receiver { socket, peer, is_fixed: !listens, system, heard, streams }))
}

impl Sender {
    /// Sends a message to the vehicle, if it has spoken. What the socket does not take is lost.
    pub(crate) fn send(&mut self, header: MavHeader, message: &MavMessage) {
        let Some(peer) = self.peer.get() else { return };
        let (header, mut bytes) = (MavHeader { sequence: self.sequence, ..header }, Vec::new());
        self.sequence = self.sequence.wrapping_add(1);
        if write_versioned_msg(&mut bytes, MavlinkVersion::V2, header, message).is_ok() {
            let _ = self.socket.send_to(&bytes, peer);
        }
    }
}

impl Receiver {
    /// The messages of the next datagram.
    ///
    /// # Errors
    /// When there is none.
    pub(crate) fn receive(&mut self) -> std::io::Result<Vec<(MavHeader, MavMessage)>> {
        let mut datagram = vec![0; LONGEST];
        let (length, from) = self.socket.recv_from(&mut datagram)?;
        let known = self.peer.get();
        let is_forgotten = !self.is_fixed && self.heard.elapsed() > FORGOTTEN;
        if known.is_some_and(|it| it != from) && !is_forgotten {
            return Ok(Vec::new());
        }
        let messages = messages(self.stream(from), &datagram[..length]);
        if messages.iter().any(|it| self.is_vehicle(it)) && known != Some(from) {
            self.peer.set(from);
            self.streams.retain(|it| it.0 == from);
        }
        if self.peer.get() != Some(from) {
            return Ok(Vec::new());
        }
        self.heard = Instant::now();
        Ok(messages)
    }

    fn stream(&mut self, from: SocketAddr) -> &mut Bytes {
        if let Some(number) = self.streams.iter().position(|it| it.0 == from) {
            self.streams.swap(0, number);
        } else {
            self.streams.truncate(MOST_STRANGERS - 1);
            self.streams.push_front((from, MavlinkReader::new(VecDeque::new())));
        }
        &mut self.streams[0].1
    }

    /// Whether that is a heartbeat of the system that is to be flown.
    fn is_vehicle(&self, (header, message): &(MavHeader, MavMessage)) -> bool {
        let is_it = (header.system_id, header.component_id) == (self.system.into(), AUTOPILOT);
        is_it && matches!(message, MavMessage::HEARTBEAT(_))
    }
}

/// The messages that end in these bytes.
pub(crate) fn messages(stream: &mut Bytes, bytes: &[u8]) -> Vec<(MavHeader, MavMessage)> {
    stream.get_mut().extend(bytes);
    let mut messages = Vec::new();
    loop {
        match stream.read_any_message() {
            Ok(message) => messages.push(message),
            // Messages that are not known are skipped.
            Err(MessageReadError::Parse(_)) => {}
            Err(_) => return messages,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fly::orders::heartbeat;

    /// Sends bytes, which the receiver takes in. Returns how many messages it hands on.
    fn say(from: &UdpSocket, to: &mut Receiver, bytes: &[u8]) -> usize {
        from.send(bytes).expect("it listens");
        to.receive().expect("a datagram").len()
    }

    fn beat(system_id: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        let header = MavHeader { system_id, component_id: AUTOPILOT, sequence: 0 };
        write_versioned_msg(&mut bytes, MavlinkVersion::V2, header, &heartbeat()).expect("it fits");
        bytes
    }

    /// Who is answered is the vehicle, whoever speaks last.
    #[test]
    fn strangers_do_not_take_a_vehicle_s_messages_away() {
        let (mut sender, mut receiver) = open("127.0.0.1:0", true, 7).expect("a port");
        let address = receiver.socket.local_addr().expect("bound");
        let [vehicle, stranger, second] = [0; 3].map(|_| {
            let socket = UdpSocket::bind("127.0.0.1:0").expect("a port");
            socket.connect(address).expect("it is local");
            socket.set_nonblocking(true).expect("a socket");
            socket
        });
        // Who hears a message of ours. On the loopback it is there when the call to send it returns.
        let mut heard = || {
            sender.send(MavHeader::default(), &heartbeat());
            [&vehicle, &stranger, &second].map(|socket| socket.recv(&mut [0; 300]).is_ok())
        };
        // A byte is no vehicle, and another system is not this one.
        assert_eq!(say(&stranger, &mut receiver, &[0xFD]), 0);
        assert_eq!(say(&second, &mut receiver, &beat(8)), 0);
        assert_eq!(heard(), [false; 3]);
        // A message may come in parts.
        assert_eq!(say(&vehicle, &mut receiver, &beat(7)[..5]), 0);
        assert_eq!(say(&stranger, &mut receiver, &[0xFD]), 0);
        assert_eq!(say(&vehicle, &mut receiver, &beat(7)[5..]), 1);
        assert_eq!(heard(), [true, false, false]);
        assert_eq!(say(&second, &mut receiver, &beat(7)), 0);
        assert_eq!(heard(), [true, false, false]);
        // After a long silence it may speak from elsewhere.
        receiver.heard = Instant::now().checked_sub(2 * FORGOTTEN).expect("this runs for long");
        assert_eq!(say(&second, &mut receiver, &[0xFD]), 0);
        assert_eq!(heard(), [true, false, false]);
        assert_eq!(say(&second, &mut receiver, &beat(7)), 1);
        assert_eq!(heard(), [false, false, true]);
    }
}
