//! Delivery: requests that are answered exactly once over a link that loses, cuts, spoils, doubles and
//! delays frames, between ends that may restart at any time.
//!
//! Stop and wait. The chip numbers its requests and sends each until its reply comes or a bound is reached ([`Link`]);
//! the vehicle acts on a number once and answers it again from memory ([`Responder`]). Within a session numbers only
//! grow, so a late message is old and is ignored. No motion is made twice and no sample is counted twice, whichever way
//! a frame is lost.
//!
//! **A session** is the time between two restarts of either end. A hello belongs to no session. Its reply offers the
//! session after the running one, and the first request in the offered session begins it. Until then the old session
//! continues: a late hello offers a session that nobody takes up. So the chip need not distinguish its starts. The
//! vehicle distinguishes its own by the number with which its [`Responder`] begins. A request of any other session, or
//! older than the last, is answered with [`Reply::Stale`]: whoever still waits for its reply has missed a restart.
//!
//! ```text
//!  chip                     vehicle, session 7 before
//!   | -- 0, 1: Hello ----------> |
//!   | <---------- 8, 1: Setup -- |  offers session 8
//!   | -- 8, 2: Ready ----------> |  session 8 begins
//!   | <---------- 8, 2: Noted -- |
//! ```

use crate::link::frame::{Decoder, Envelope, Frame};
use crate::link::message::{Reply, Request, Setup};

/// Where frames leave and bytes arrive: a serial port, for one.
pub trait Port {
    /// Sends a frame and begins to wait for its answer.
    fn send(&mut self, frame: &[u8]);

    /// The next byte that has arrived; `None` once the wait is over. A wait has an end even when
    /// bytes keep arriving.
    fn receive(&mut self) -> Option<u8>;

    /// A frame arrived whole that held no message, see [`Decoder::unreadable`]: for the log.
    fn unreadable(&mut self) {}
}

/// Why a request has no reply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LinkError {
    /// It was sent [`Link::ATTEMPTS`] times, and none came.
    Silent,
    /// The vehicle knows nothing of the session: it has restarted, or this end has, unnoticed.
    Stale,
}

impl core::fmt::Display for LinkError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Silent => "the link is lost: no reply to a request and its repetitions",
            Self::Stale => "the vehicle knows nothing of this mission: it has restarted",
        })
    }
}

impl core::error::Error for LinkError {}

/// The session of a hello: none.
const NO_SESSION: u32 = 0;

/// The chip's end.
#[derive(Debug)]
pub struct Link<P> {
    port: P,
    decoder: Decoder,
    session: u32,
    number: u32,
}

impl<P: Port> Link<P> {
    /// How often a request is sent. With a port that waits for 100 ms a link counts as lost after
    /// 1.6 s.
    pub const ATTEMPTS: u8 = 16;

    /// The end of a link at a port.
    pub fn new(port: P) -> Self {
        Self { port, decoder: Decoder::default(), session: NO_SESSION, number: 0 }
    }

    /// Sends a request until its reply arrives. A [`Request::Hello`] leaves the session and enters the
    /// one that is offered with the setup.
    ///
    /// # Errors
    /// [`LinkError::Silent`] after the wait for the last of [`ATTEMPTS`](Self::ATTEMPTS), which are
    /// counted anew whenever the vehicle says that it is busy; [`LinkError::Stale`] at once.
    pub fn ask(&mut self, request: Request) -> Result<Reply, LinkError> {
        let hello = matches!(request, Request::Hello { .. });
        if hello {
            self.session = NO_SESSION;
        }
        self.number = self.number.wrapping_add(1);
        let frame = Frame::of(&Envelope::new(self.session, self.number, request));
        let mut left = Self::ATTEMPTS;
        while left > 0 {
            left -= 1;
            self.port.send(frame.bytes());
            while let Some(Envelope { session, number, message, .. }) = self.hear() {
                if number != self.number || session != self.session && !hello {
                    continue;
                }
                match message {
                    Reply::Busy => left = Self::ATTEMPTS,
                    Reply::Stale => return Err(LinkError::Stale),
                    reply if hello && !matches!(reply, Reply::Setup(_)) => {}
                    reply => {
                        self.session = session;
                        return Ok(reply);
                    }
                }
            }
        }
        Err(LinkError::Silent)
    }

    /// The next message that arrives before the wait is over.
    fn hear(&mut self) -> Option<Envelope<Reply>> {
        loop {
            let byte = self.port.receive()?;
            let before = self.decoder.unreadable();
            let envelope = self.decoder.feed(byte);
            if self.decoder.unreadable() != before {
                self.port.unreadable();
            }
            if envelope.is_some() {
                return envelope;
            }
        }
    }
}

/// What the vehicle's end heard.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one at a time, and no heap")]
pub enum Heard {
    /// A chip asks for a mission: [`offer`](Responder::offer) it one.
    Hello(Hello),
    /// A request that is new: act on it, then [`answer`](Responder::answer).
    New(Request),
    /// The last request again, or one of no session that runs: send this, and do nothing else.
    Old(Frame),
}

/// A chip asks for a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello {
    /// The version of the protocol that it speaks.
    pub protocol: u16,
    /// It asked later than all that this session has heard. If not, the chip has restarted, or this
    /// comes late.
    pub is_later: bool,
    number: u32,
}

/// The vehicle's end: bytes in, frames out.
#[derive(Debug)]
pub struct Responder {
    decoder: Decoder,
    /// The session that runs; the one after it is on offer.
    session: u32,
    /// Of this session, the number of the last request and what answers it.
    last: Option<(u32, Frame)>,
}

impl Responder {
    /// An end that has heard nothing. `seed` tells its starts apart, so it should be another at each:
    /// a counter that outlives a restart, or a random number.
    pub fn new(seed: u32) -> Self {
        Self { decoder: Decoder::default(), session: seed, last: None }
    }

    /// Frames that arrived whole and held no message, see [`Decoder::unreadable`].
    pub const fn unreadable(&self) -> u32 {
        self.decoder.unreadable()
    }

    const fn on_offer(&self) -> u32 {
        let next = self.session.wrapping_add(1);
        if next == NO_SESSION { next + 1 } else { next }
    }

    /// Takes in a byte; what is to be done when it completes a request.
    pub fn hear(&mut self, byte: u8) -> Option<Heard> {
        let Envelope { session, number, message, .. } = self.decoder.feed(byte)?;
        if let Request::Hello { protocol } = message {
            let is_later = self.last.as_ref().is_none_or(|(last, _)| number > *last);
            return Some(Heard::Hello(Hello { protocol, is_later, number }));
        }
        if session == self.on_offer() {
            (self.session, self.last) = (session, None);
        } else if session != self.session || self.last.is_none() {
            return Some(Heard::Old(stale(session, number)));
        }
        let heard = match &self.last {
            Some((last, _)) if number < *last => Heard::Old(stale(session, number)),
            Some((last, reply)) if number == *last => Heard::Old(reply.clone()),
            _ => {
                let busy = Frame::of(&Envelope::new(session, number, Reply::Busy));
                self.last = Some((number, busy));
                Heard::New(message)
            }
        };
        Some(heard)
    }

    /// The frame that offers a mission, in a session of its own.
    pub fn offer(&self, hello: Hello, setup: Setup) -> Frame {
        Frame::of(&Envelope::new(self.on_offer(), hello.number, Reply::Setup(setup)))
    }

    /// The frame that answers the last request. Until then its repetitions are told that the vehicle
    /// is busy with it.
    pub fn answer(&mut self, reply: Reply) -> &Frame {
        let (number, frame) = self.last.get_or_insert_default();
        *frame = Frame::of(&Envelope::new(self.session, *number, reply));
        frame
    }
}

fn stale(session: u32, number: u32) -> Frame {
    Frame::of(&Envelope::new(session, number, Reply::Stale))
}
