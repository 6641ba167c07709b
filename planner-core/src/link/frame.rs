//! Frames: how a message goes over the wire, and how the receiver finds it in a stream of bytes.
//!
//! A frame contains one message: its direction, its session, its number, the message itself in postcard's form, and a
//! CRC-32 of these. COBS removes zeros, and a zero stands before and after. So a frame that was cut spoils only itself.

use core::ops::{Index, IndexMut};

use crc::{CRC_32_ISO_HDLC, Crc};
use heapless::Vec;
use postcard::Deserializer;
use postcard::ser_flavors::crc::CrcModifier;
use postcard::ser_flavors::{Cobs, Flavor};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// Bytes of the longest frame, its two zeros included.
pub const FRAME: usize = 320;

/// What goes one way over the link.
pub trait Message: Serialize + DeserializeOwned {
    /// Tells the two ways apart, so that an echo of one's own frames is not taken for an answer.
    const WAY: u8;
}

/// A message with the session it belongs to and the number of its exchange, which request and reply
/// share.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Envelope<M> {
    way: u8,
    /// The session: 0 with a hello, which asks for one.
    pub session: u32,
    /// The number.
    pub number: u32,
    /// The message.
    pub message: M,
}

impl<M: Message> Envelope<M> {
    /// A message with its session and number.
    pub const fn new(session: u32, number: u32, message: M) -> Self {
        Self { way: M::WAY, session, number, message }
    }
}

pub(super) static CHECK: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A message as it goes over the wire.
#[derive(Clone, Debug, Default)]
pub struct Frame(Vec<u8, FRAME, u16>);

impl Frame {
    /// The frame of an envelope.
    pub fn of<M: Message>(envelope: &Envelope<M>) -> Self {
        let mut frame = Vec::new();
        // Every message fits, as a test over the longest of each shows.
        let _ = frame.resize(FRAME, 0);
        let written = encode(envelope, frame.get_mut(1..).unwrap_or(&mut [])).unwrap_or(0);
        frame.truncate(1 + written);
        Self(frame)
    }

    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.0
    }
}

fn encode<M: Message>(envelope: &Envelope<M>, into: &mut [u8]) -> postcard::Result<usize> {
    let stuffed = Cobs::try_new(Content { bytes: into, written: 0, nowhere: 0 })?;
    let checked = CrcModifier::new(stuffed, CHECK.digest());
    postcard::serialize_with_flavor(envelope, Once(checked))
}

/// A writer of bytes that is compiled once. Otherwise every field of every message would have a copy of it.
struct Once<F>(F);

impl<F: Flavor> Flavor for Once<F> {
    type Output = F::Output;

    #[inline(never)]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.0.try_push(byte)
    }

    fn finalize(self) -> postcard::Result<F::Output> {
        self.0.finalize()
    }
}

/// Takes the bytes of a frame. COBS writes again to places that it has written before. Postcard's own slice panics at
/// places out of range, so it would put a panic into every program.
struct Content<'a> {
    bytes: &'a mut [u8],
    written: usize,
    /// Dummy byte for out-of-range indices; avoids a panic.
    nowhere: u8,
}

impl Flavor for Content<'_> {
    type Output = usize;

    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        let next = self.bytes.get_mut(self.written);
        *next.ok_or(postcard::Error::SerializeBufferFull)? = byte;
        self.written += 1;
        Ok(())
    }

    fn finalize(self) -> postcard::Result<usize> {
        Ok(self.written)
    }
}

impl Index<usize> for Content<'_> {
    type Output = u8;

    fn index(&self, at: usize) -> &u8 {
        self.bytes.get(at).unwrap_or(&self.nowhere)
    }
}

impl IndexMut<usize> for Content<'_> {
    fn index_mut(&mut self, at: usize) -> &mut u8 {
        self.bytes.get_mut(at).unwrap_or(&mut self.nowhere)
    }
}

/// Finds frames in a stream of bytes, and skips what is none.
#[derive(Debug, Default)]
pub struct Decoder {
    state: cobs::DecoderState,
    /// What the frame holds so far.
    content: Vec<u8, FRAME, u16>,
    /// More came than a frame holds.
    overlong: bool,
    unreadable: u32,
}

impl Decoder {
    /// Frames that arrived whole, by their check sum, and held no message: the other end speaks another
    /// version of the protocol, or has an error.
    pub const fn unreadable(&self) -> u32 {
        self.unreadable
    }

    /// Takes in a byte; the envelope of the frame that it completes, if that is whole and goes `M`'s
    /// way.
    pub fn feed<M: Message>(&mut self, byte: u8) -> Option<Envelope<M>> {
        match self.state.feed(byte) {
            Ok(cobs::DecodeResult::DataContinue(content)) => {
                self.overlong |= self.content.push(content).is_err();
                None
            }
            Ok(cobs::DecodeResult::NoData) => None,
            Ok(cobs::DecodeResult::DataComplete) => {
                let content = if self.overlong { None } else { checked(&self.content) };
                let of_this_way = content.filter(|it| it.first() == Some(&M::WAY));
                let envelope = of_this_way.and_then(open);
                if of_this_way.is_some() && envelope.is_none() {
                    self.unreadable = self.unreadable.saturating_add(1);
                }
                self.restart();
                envelope
            }
            Ok(cobs::DecodeResult::DataStart) | Err(_) => {
                self.restart();
                None
            }
        }
    }

    fn restart(&mut self) {
        self.content.clear();
        self.overlong = false;
    }
}

/// What a frame's check sum stands for, if it is right.
fn checked(content: &[u8]) -> Option<&[u8]> {
    let (content, sum) = content.split_last_chunk()?;
    (CHECK.checksum(content) == u32::from_le_bytes(*sum)).then_some(content)
}

fn open<M: Message>(content: &[u8]) -> Option<Envelope<M>> {
    let mut reader = Deserializer::from_flavor(Unread(content));
    let envelope = Envelope::deserialize(&mut reader).ok()?;
    reader.finalize().ok()?.is_empty().then_some(envelope)
}

/// A reader of bytes that is compiled once. Otherwise every field of every message would have a copy of it.
struct Unread<'a>(&'a [u8]);

impl<'a> postcard::de_flavors::Flavor<'a> for Unread<'a> {
    type Remainder = &'a [u8];
    type Source = &'a [u8];

    #[inline(never)]
    fn pop(&mut self) -> postcard::Result<u8> {
        let (first, rest) =
            self.0.split_first().ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        self.0 = rest;
        Ok(*first)
    }

    #[inline(never)]
    fn try_take_n(&mut self, count: usize) -> postcard::Result<&'a [u8]> {
        let (taken, rest) =
            self.0.split_at_checked(count).ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        self.0 = rest;
        Ok(taken)
    }

    fn finalize(self) -> postcard::Result<&'a [u8]> {
        Ok(self.0)
    }
}
