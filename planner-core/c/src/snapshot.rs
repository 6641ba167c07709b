//! What outlives a planner's sleep, as bytes: the planner's snapshot in postcard's form, then a check sum of it.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use planner_core::error::RestoreError;
use planner_core::{Persist, SNAPSHOT_VERSION};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::types::Status;

/// Bytes that a snapshot can have: those of a planner that is full, as far from the origin as a position can be, fit in.
pub const SNAPSHOT_BYTES: usize = 1100;

/// What a planner has to remember over a sleep. It may be kept as it is, or as its first `count` bytes alone.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Snapshot {
    /// How many of the bytes belong to it; the others are zeros.
    pub count: u32,
    /// The same on every machine.
    pub bytes: [u8; SNAPSHOT_BYTES],
}

static CHECK: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// Bytes of the check sum.
const SUM: usize = 4;

impl Snapshot {
    /// What a planner has to remember. `None` if it does not fit; [`SNAPSHOT_BYTES`] is large enough.
    pub(crate) fn of<P: Persist<Snapshot: Serialize>>(planner: &P) -> Option<Self> {
        let mut bytes = [0; SNAPSHOT_BYTES];
        let count = write(planner, &mut bytes)? as u32;
        Some(Self { count, bytes })
    }

    /// Lets a planner go on from it. One that does not is as it was.
    pub(crate) fn wake<P>(&self, planner: &mut P) -> Result<(), Status>
    where
        P: Persist<Snapshot: DeserializeOwned>,
    {
        let count = usize::try_from(self.count).map_err(|_| Status::SnapshotSpoilt)?;
        wake(self.bytes.get(..count).ok_or(Status::SnapshotSpoilt)?, planner)
    }
}

/// How many bytes [`write`] writes.
pub(crate) fn size<P: Persist<Snapshot: Serialize>>(planner: &P) -> Option<usize> {
    Some(postcard::experimental::serialized_size(&planner.snapshot()).ok()? + SUM)
}

/// Writes what a planner has to remember, and a check sum; how many bytes these are. `None` if they do not fit.
pub(crate) fn write<P: Persist<Snapshot: Serialize>>(
    planner: &P,
    bytes: &mut [u8],
) -> Option<usize> {
    let room = bytes.len().checked_sub(SUM)?;
    let used = postcard::to_slice(&planner.snapshot(), bytes.get_mut(..room)?).ok()?.len();
    let sum = CHECK.checksum(bytes.get(..used)?).to_le_bytes();
    bytes.get_mut(used..used + SUM)?.copy_from_slice(&sum);
    Some(used + SUM)
}

/// Lets a planner go on from what [`write`] wrote. One that does not is as it was.
pub(crate) fn wake<P>(bytes: &[u8], planner: &mut P) -> Result<(), Status>
where
    P: Persist<Snapshot: DeserializeOwned>,
{
    let bytes = checked(bytes).ok_or(Status::SnapshotSpoilt)?;
    let (version, _) =
        postcard::take_from_bytes::<u16>(bytes).map_err(|_| Status::SnapshotSpoilt)?;
    if version != SNAPSHOT_VERSION {
        return Err(Status::SnapshotVersion);
    }
    let read: P::Snapshot = postcard::from_bytes(bytes).map_err(|_| Status::SnapshotMission)?;
    let before = planner.snapshot();
    planner.restore(&read).map_err(|refused| {
        // It made this one itself.
        let _ = planner.restore(&before);
        match refused {
            RestoreError::Version(_) => Status::SnapshotVersion,
            _ => Status::SnapshotMission,
        }
    })
}

/// The bytes before the check sum, if that is right.
fn checked(all: &[u8]) -> Option<&[u8]> {
    let (bytes, sum) = all.split_last_chunk::<SUM>()?;
    let is_right = !bytes.is_empty() && CHECK.checksum(bytes) == u32::from_le_bytes(*sum);
    is_right.then_some(bytes)
}
