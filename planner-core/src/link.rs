//! Delivery: requests that are answered exactly once over a link that loses, cuts, spoils, doubles and
//! delays frames.
//!
//! Stop and wait. The chip numbers its requests and sends each until its reply comes or a bound is
//! reached ([`Link`]); the vehicle acts on a number once and answers it again from memory
//! ([`Responder`]). Numbers only grow, so what comes late is old and is passed over: no motion is
//! made twice, no sample counted twice, whichever way a frame is lost.

use crate::wire::{Decoder, Envelope, Frame, Reply, Request};

/// Where frames leave and bytes arrive: a serial port, for one.
pub trait Port {
    /// Sends a frame and begins to wait for its answer.
    fn send(&mut self, frame: &[u8]);

    /// The next byte that has arrived; `None` once the wait is over. A wait has an end even when
    /// bytes keep arriving.
    fn receive(&mut self) -> Option<u8>;
}

/// A request was sent [`Link::ATTEMPTS`] times, and no reply came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LinkLost;

impl core::fmt::Display for LinkLost {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the link is lost: no reply to a request and its repetitions")
    }
}

impl core::error::Error for LinkLost {}

/// The chip's end.
#[derive(Debug)]
pub struct Link<P> {
    port: P,
    decoder: Decoder,
    number: u32,
}

impl<P: Port> Link<P> {
    /// How often a request is sent. With a port that waits for 100 ms a link counts as lost after
    /// 1.6 s.
    pub const ATTEMPTS: u8 = 16;

    /// The end of a link at a port.
    pub fn new(port: P) -> Self {
        Self { port, decoder: Decoder::default(), number: 0 }
    }

    /// Sends a request until its reply arrives.
    ///
    /// # Errors
    /// [`LinkLost`] after the wait for the last of [`ATTEMPTS`](Self::ATTEMPTS). They are counted
    /// anew whenever the vehicle says that it is busy.
    pub fn ask(&mut self, request: Request) -> Result<Reply, LinkLost> {
        self.number = self.number.wrapping_add(1);
        let frame = Frame::of(&Envelope::new(self.number, request));
        let mut left = Self::ATTEMPTS;
        while left > 0 {
            left -= 1;
            self.port.send(frame.bytes());
            while let Some(byte) = self.port.receive() {
                match self.decoder.feed(byte) {
                    Some(Envelope { number, message, .. }) if number == self.number => {
                        match message {
                            Reply::Busy => left = Self::ATTEMPTS,
                            reply => return Ok(reply),
                        }
                    }
                    _ => {}
                }
            }
        }
        Err(LinkLost)
    }
}

/// What the vehicle's end heard.
#[derive(Debug)]
pub enum Heard<'a> {
    /// A request that is new: act on it, then [`answer`](Responder::answer).
    New(Request),
    /// The last request again: send this, and do nothing else.
    Again(&'a Frame),
}

/// The vehicle's end: bytes in, frames out.
#[derive(Debug, Default)]
pub struct Responder {
    decoder: Decoder,
    /// The number of the last request, and what answers it.
    last: Option<(u32, Frame)>,
}

impl Responder {
    /// Takes in a byte; what is to be done when it completes a request.
    pub fn hear(&mut self, byte: u8) -> Option<Heard<'_>> {
        let Envelope { number, message, .. } = self.decoder.feed(byte)?;
        let ahead = self.last.as_ref().map_or(1, |(last, _)| number.wrapping_sub(*last) as i32);
        if ahead > 0 {
            let busy = Frame::of(&Envelope::new(number, Reply::Busy));
            self.last = Some((number, busy));
            return Some(Heard::New(message));
        }
        let (_, reply) = self.last.as_ref()?;
        (ahead == 0).then_some(Heard::Again(reply))
    }

    /// The frame that answers the last request. Until then its repetitions are told that the vehicle
    /// is busy with it.
    pub fn answer(&mut self, reply: Reply) -> &Frame {
        let (number, frame) = self.last.get_or_insert_default();
        *frame = Frame::of(&Envelope::new(*number, reply));
        frame
    }
}
