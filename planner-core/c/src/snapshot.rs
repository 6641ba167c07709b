//! What outlives a planner's sleep, as bytes: the planner's snapshot in postcard's form, then a check sum of it.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use planner_core::error::RestoreError;
use planner_core::{Persist, SNAPSHOT_VERSION};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::status::Status;

/// Bytes that a snapshot can have: those of a planner that is full, as far from the origin as a position can be, fit in.
pub const SNAPSHOT_BYTES: usize = 1100;

/// Bytes that the snapshot of a planner of fronts can have.
pub const FOLLOWER_SNAPSHOT_BYTES: usize = 8800;

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
    /// Those of its bytes that belong to it.
    pub(crate) fn used(&self) -> Result<&[u8], Status> {
        let count = usize::try_from(self.count).ok();
        count.and_then(|count| self.bytes.get(..count)).ok_or(Status::SnapshotSpoilt)
    }
}

/// How many bytes [`write`] writes.
pub(crate) fn size(snapshot: &impl Serialize) -> Option<usize> {
    Some(postcard::experimental::serialized_size(snapshot).ok()? + SUM)
}

/// Writes what a planner has to remember, and a check sum, into as many bytes as these are.
pub(crate) fn write(snapshot: &impl Serialize, bytes: &mut [u8]) -> Option<()> {
    let (bytes, sum) = bytes.split_last_chunk_mut::<SUM>()?;
    let used = postcard::to_slice(snapshot, bytes).ok()?;
    *sum = CHECK.checksum(used).to_le_bytes();
    Some(())
}

/// Lets a planner go on from what [`write`] wrote. One that does not is as it was.
#[inline(never)] // a call needs the stack of one kind of planner, not of both
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
    let Ok(read) = postcard::from_bytes(bytes) else { return Err(Status::SnapshotMission) };
    go_on(planner, &read)
}

#[inline(never)] // so the earlier state is not on the stack while bytes are read
fn go_on<P: Persist>(planner: &mut P, from: &P::Snapshot) -> Result<(), Status> {
    let before = planner.snapshot();
    planner.restore(from).map_err(|refused| {
        if let RestoreError::Log(_) = refused {
            // The replay has begun. The planner made `before` itself, so it accepts it.
            let _ = planner.restore(&before);
        }
        refused.into()
    })
}

/// The bytes before the check sum, if that is right.
fn checked(all: &[u8]) -> Option<&[u8]> {
    let (bytes, sum) = all.split_last_chunk::<SUM>()?;
    let is_right = !bytes.is_empty() && CHECK.checksum(bytes) == u32::from_le_bytes(*sum);
    is_right.then_some(bytes)
}
