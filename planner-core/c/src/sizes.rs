//! How much memory planners take, for C programs that declare it beforehand. The compiler checks the numbers: with
//! pointers of 32 bits a planner is up to 8 bytes smaller, and up to 16 with a chart's cells.

use core::mem::{align_of, size_of};

use planner_core::Persist;

use crate::finder::{Doubtful, True};
use crate::follower::{Guards, Tracks};
use crate::held::Held;
use crate::snapshot::FOLLOWER_SNAPSHOT_BYTES;

/// Memory of a planner is aligned to so many bytes.
pub const ALIGNMENT: usize = 8;

/// Bytes of a planner whose labels are always right.
#[cfg(feature = "charts")]
pub const BYTES: usize = 2320;
/// Bytes of a planner whose labels are always right.
#[cfg(all(feature = "polygons", not(feature = "charts")))]
pub const BYTES: usize = 2272;
/// Bytes of a planner whose labels are always right.
#[cfg(not(feature = "polygons"))]
pub const BYTES: usize = 1184;

/// Bytes of a planner whose labels may be wrong.
#[cfg(feature = "charts")]
pub const DOUBTFUL_BYTES: usize = 17224;
/// Bytes of a planner whose labels may be wrong.
#[cfg(all(feature = "polygons", not(feature = "charts")))]
pub const DOUBTFUL_BYTES: usize = 17176;
/// Bytes of a planner whose labels may be wrong.
#[cfg(not(feature = "polygons"))]
pub const DOUBTFUL_BYTES: usize = 16096;

/// Bytes of a planner of fronts.
#[cfg(feature = "charts")]
pub const FOLLOWER_BYTES: usize = 9768;
/// Bytes of a planner of fronts.
#[cfg(all(feature = "polygons", not(feature = "charts")))]
pub const FOLLOWER_BYTES: usize = 9720;
/// Bytes of a planner of fronts.
#[cfg(not(feature = "polygons"))]
pub const FOLLOWER_BYTES: usize = 8640;

const _: () = {
    assert!(is_size::<True>(BYTES));
    assert!(!cfg!(feature = "noise") || is_size::<Doubtful>(DOUBTFUL_BYTES));
    assert!(is_size::<Guards>(FOLLOWER_BYTES));
    assert!(size_of::<Held<Tracks>>() <= FOLLOWER_BYTES);
    // Written out, some whole numbers take a byte more than in memory.
    assert!(size_of::<<Guards as Persist>::Snapshot>() * 9 / 8 <= FOLLOWER_SNAPSHOT_BYTES);
};

/// What pointers of 64 bits take more than those of 32 bits, at most.
const POINTERS: usize = if cfg!(feature = "charts") { 16 } else { 8 };

const fn is_size<P>(bytes: usize) -> bool {
    let held = size_of::<Held<P>>();
    align_of::<Held<P>>() == ALIGNMENT && held <= bytes && bytes - held <= POINTERS
}
