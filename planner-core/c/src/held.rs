//! A planner of one of two kinds in the caller's memory, and the calls that planners of lines and of fronts share.
//!
//! Unsafe code is here and in the functions that C calls. It reads and writes behind the pointers that C passes. A null pointer
//! is refused. The caller promises that all other pointers are as the header requires.

use core::ffi::c_void;
use core::mem::{MaybeUninit, size_of};

use planner_core::{Belief as _, Persist, Plan, Planner, Tolerance};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::mission::Mission;
use crate::parts::MOST_GIVEN;
use crate::snapshot;
use crate::status::Status;
use crate::types::{Motion, Point, Pose, Reading, Sample};
use crate::verdict::Refusal;

/// An opaque type of C. A pointer to it is a pointer to a [`Held`] planner of one of two kinds.
pub(crate) trait Handle {
    type One: Asked;
    type Other: Asked;
}

/// A planner that can sleep.
pub(crate) trait Asked: Planner + Persist<Snapshot: Serialize + DeserializeOwned> {}

impl<P: Planner + Persist<Snapshot: Serialize + DeserializeOwned>> Asked for P {}

/// Which of the two planners follows in memory.
#[derive(Clone, Copy)]
pub(crate) enum Kind {
    One,
    Other,
}

/// A planner with its kind before it.
#[repr(C, align(8))]
pub(crate) struct Held<P> {
    pub(crate) kind: Kind,
    pub(crate) planner: P,
}

/// A planner of one kind or of the other.
pub(crate) enum Either<A, B> {
    One(A),
    Other(B),
}

/// Evaluates an expression for a planner of either kind. There is no table of methods, so the linker can drop methods that a
/// program does not call.
macro_rules! ask {
    ($either:expr, $planner:ident => $asked:expr) => {
        match $either {
            $crate::held::Either::One($planner) => $asked,
            $crate::held::Either::Other($planner) => $asked,
        }
    };
}
pub(crate) use ask;

/// The planner behind a pointer, to read it.
///
/// # Safety
/// The pointer must be null, or it must point to a planner of this handle that was written to its [`place`]. Nobody may change
/// that planner meanwhile.
pub(crate) unsafe fn get<'a, H: Handle + 'a>(
    handle: *const H,
) -> Result<Either<&'a H::One, &'a H::Other>, Status> {
    if handle.is_null() {
        return Err(Status::Memory);
    }
    // SAFETY: a planner of its kind follows each kind in memory.
    unsafe {
        Ok(match *handle.cast::<Kind>() {
            Kind::One => Either::One(&(*handle.cast::<Held<H::One>>()).planner),
            Kind::Other => Either::Other(&(*handle.cast::<Held<H::Other>>()).planner),
        })
    }
}

/// The planner behind a pointer, to change it.
///
/// # Safety
/// As for [`get`], and nobody else may use the planner meanwhile.
pub(crate) unsafe fn get_mut<'a, H: Handle + 'a>(
    handle: *mut H,
) -> Result<Either<&'a mut H::One, &'a mut H::Other>, Status> {
    if handle.is_null() {
        return Err(Status::Memory);
    }
    // SAFETY: as in `get`.
    unsafe {
        Ok(match *handle.cast::<Kind>() {
            Kind::One => Either::One(&mut (*handle.cast::<Held<H::One>>()).planner),
            Kind::Other => Either::Other(&mut (*handle.cast::<Held<H::Other>>()).planner),
        })
    }
}

/// The place of a planner in memory that is large enough and aligned.
pub(crate) fn place<P>((memory, bytes): (*mut c_void, usize)) -> Result<*mut Held<P>, Status> {
    let place = memory.cast::<Held<P>>();
    let is_room = !place.is_null() && place.is_aligned() && bytes >= size_of::<Held<P>>();
    is_room.then_some(place).ok_or(Status::Memory)
}

/// A mission, and its given samples.
///
/// # Safety
/// `given` must be null or readable for so many samples.
pub(crate) unsafe fn inputs<'a, 'b>(
    mission: Option<&'a Mission<'b>>,
    (given, count): (*const Sample, usize),
) -> Result<(&'a Mission<'b>, &'a [Sample]), Refusal> {
    let none = Refusal::of(Status::Memory, c"");
    let mission = mission.ok_or(none)?;
    if count == 0 {
        return Ok((mission, &[]));
    }
    if given.is_null() || !given.is_aligned() {
        return Err(none);
    }
    if count > MOST_GIVEN {
        return Err(Refusal::of(Status::Given, c"given"));
    }
    // SAFETY: the caller promises so many samples.
    Ok((mission, unsafe { core::slice::from_raw_parts(given, count) }))
}

/// Writes an answer into its place. A call that is refused writes nothing.
pub(crate) fn answer<T>(
    place: Option<&mut MaybeUninit<T>>,
    answer: impl FnOnce() -> Result<T, Status>,
) -> Status {
    let Some(place) = place else { return Status::Memory };
    match answer() {
        Ok(answer) => {
            place.write(answer);
            Status::Ok
        }
        Err(status) => status,
    }
}

/// The next motion.
///
/// # Safety
/// As for [`get_mut`].
pub(crate) unsafe fn plan<H: Handle>(handle: *mut H, pose: Pose) -> Result<Motion, Status> {
    // SAFETY: the caller promises it.
    let planner = unsafe { get_mut(handle) }?;
    let pose = pose.read()?;
    match ask!(planner, it => it.plan(pose)) {
        Plan::Move(motion) => Ok(motion.into()),
        Plan::Stop(reason) => Err(reason.into()),
    }
}

/// Takes in the end of a motion. The position may be off by a tolerance of its own.
///
/// # Safety
/// As for [`get_mut`].
pub(crate) unsafe fn observe<H: Handle>(
    handle: *mut H,
    pose: Pose,
    reading: i32,
    within: Option<f64>,
) -> Result<(), Status> {
    // SAFETY: the caller promises it.
    let planner = unsafe { get_mut(handle) }?;
    let (pose, reading) = (pose.read()?, Reading::read(reading)?);
    let within = within.map(Tolerance::new).transpose().map_err(|_| Status::Tolerance)?;
    Ok(ask!(planner, it => {
        let within = within.unwrap_or(it.belief().tolerance());
        it.observe_within(pose, reading, within)
    })?)
}

/// Takes in what was read on the way of a motion.
///
/// # Safety
/// As for [`get_mut`].
pub(crate) unsafe fn observe_on_the_way<H: Handle>(
    handle: *mut H,
    at: Point,
    reading: i32,
) -> Result<(), Status> {
    // SAFETY: the caller promises it.
    let planner = unsafe { get_mut(handle) }?;
    let (site, reading) = (at.read()?, Reading::read(reading)?);
    if let Some(reading) = reading {
        ask!(planner, it => it.observe_on_the_way(site, reading))?;
    }
    Ok(())
}

/// The chance that a label at a place is +1.
///
/// # Safety
/// As for [`get`].
pub(crate) unsafe fn chance<H: Handle>(handle: *const H, at: Point) -> Result<f64, Status> {
    // SAFETY: the caller promises it.
    let planner = unsafe { get(handle) }?;
    let site = at.read()?;
    Ok(ask!(planner, it => it.belief().chance(site)))
}

/// Writes what a planner has to remember, and returns how many bytes that takes. If there is not so much room, nothing
/// is written.
///
/// # Safety
/// As for [`get`], and `bytes` must be null or writable for so many bytes.
pub(crate) unsafe fn save<H: Handle>(
    handle: *const H,
    (bytes, room): (*mut u8, usize),
) -> Result<usize, Status> {
    // SAFETY: the caller promises it.
    unsafe { ask!(get(handle)?, it => write(it, (bytes, room))) }
}

/// # Safety
/// As for [`save`].
#[inline(never)] // a call needs the stack of one kind, not of both
unsafe fn write<P: Asked>(planner: &P, (bytes, room): (*mut u8, usize)) -> Result<usize, Status> {
    let snapshot = planner.snapshot();
    let count = snapshot::size(&snapshot).filter(|it| *it <= room && !bytes.is_null());
    let count = count.ok_or(Status::Memory)?;
    // SAFETY: the caller promises more room than that.
    let bytes = unsafe {
        bytes.write_bytes(0, count);
        core::slice::from_raw_parts_mut(bytes, count)
    };
    snapshot::write(&snapshot, bytes).map(|()| count).ok_or(Status::Memory)
}

/// Lets a planner go on from what was saved.
///
/// # Safety
/// As for [`get_mut`].
pub(crate) unsafe fn restore<H: Handle>(handle: *mut H, bytes: &[u8]) -> Result<(), Status> {
    // SAFETY: the caller promises it.
    ask!(unsafe { get_mut(handle) }?, it => snapshot::wake(bytes, it))
}
