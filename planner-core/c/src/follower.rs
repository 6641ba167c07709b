//! Planners that go along a front or watch a stretch of it, and the functions that are called of them.

use core::ffi::c_void;
use core::mem::{MaybeUninit, size_of};

use planner_core::{
    Beside, Front, FrontState, FrontStretch, Guard, Planner as _, Prior, Restart as _, Track,
    Unicycle, Waist,
};

use crate::area::Ground;
use crate::held::{self, Handle, Held, Kind, answer, ask, get, inputs, place};
use crate::mission::Mission;
use crate::parts::Parts;
use crate::status::Status;
use crate::types::{Motion, Point, Pose, Sample};
use crate::verdict::{Refusal, Verdict};

pub(crate) type Tracks = Track<Unicycle, Ground>;
pub(crate) type Guards = Guard<Unicycle, Ground>;

/// A planner that goes along a front or watches a stretch of it, in memory of the caller.
pub struct Follower(());

impl Handle for Follower {
    type One = Tracks;
    type Other = Guards;
}

/// How a front bends, how fast it moves, and what to do with it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FrontSettings {
    /// 0 for a straight line, and any radius from 0.1 m for a front that bends: only whether it bends counts.
    pub radius: f64,
    /// How far the front may move in the time of a motion, metres. If in doubt, name a higher speed.
    pub speed: f64,
    /// 0 to go along the front. Or so many metres of it, from 0.1 to 10000, about the place where the planner finds it. The
    /// planner stays with them, and learns where the front is all along.
    pub stretch: f64,
    /// 1 to end once the robot has gone along all of the front: back to where it found it, or to the border at both ends.
    /// 0 to go on. With a stretch it must be 0.
    pub until_closed: u8,
}

/// Where a front is known best.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FrontPlace {
    /// On the mean front. The heading is the front's direction; the side of +1 is to the left.
    pub pose: Pose,
    /// 1/m, positive where the front bends to the left.
    pub curvature: f64,
    /// The standard deviation of the front across its direction, metres.
    pub deviation: f64,
    /// The standard deviation of the direction, radians.
    pub turn_deviation: f64,
    /// Whether the robot has gone along all of a closed front.
    pub is_closed: bool,
}

impl FrontPlace {
    fn new(waist: Waist, is_closed: bool) -> Self {
        let Waist { site, heading, curvature, deviation, turn_deviation } = waist;
        Self {
            pose: planner_core::Pose { site, heading }.into(),
            curvature: curvature.into(),
            deviation: deviation.into(),
            turn_deviation: turn_deviation.into(),
            is_closed,
        }
    }
}

/// Where a front crosses the line through a place that is square to a heading.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FrontCrossing {
    /// How far to the left of the place, on average, metres.
    pub left: f64,
    /// The standard deviation, metres.
    pub deviation: f64,
}

/// How much memory a planner of fronts takes, bytes.
#[unsafe(export_name = "planner_follower_bytes")]
pub extern "C" fn follower_bytes() -> usize {
    size_of::<Held<Tracks>>().max(size_of::<Held<Guards>>())
}

/// The parts of a planner of fronts, the front, and the stretch to watch if there is one.
unsafe fn possible(
    (mission, given): (&Mission<'_>, &[Sample]),
    settings: FrontSettings,
) -> Result<(Parts, Front, Option<FrontStretch>), Refusal> {
    let refused = |what| Refusal::of(Status::Mission, what);
    // SAFETY: the caller promises it.
    let parts = unsafe { Parts::new(mission, given) }?;
    if mission.slopes != 0.0 {
        return Err(refused(c"slopes"));
    }
    if mission.level != 0.0 {
        return Err(refused(c"level"));
    }
    let FrontSettings { radius, speed, stretch, until_closed } = settings;
    let front = if radius == 0.0 { Ok(Front::STRAIGHT) } else { Front::bending(radius) };
    let front = front.map_err(|_| refused(c"radius"))?;
    let front = front.moving(speed).map_err(|_| refused(c"speed"))?;
    let stretch = (stretch != 0.0).then(|| FrontStretch::metres(stretch)).transpose();
    let stretch = stretch.map_err(|_| refused(c"stretch"))?;
    if until_closed > stretch.is_none().into() {
        return Err(refused(c"until_closed"));
    }
    Ok((parts, front, stretch))
}

/// What `planner_follow` will say of a mission, of front settings and of given samples, and which part of them that is
/// about. It needs no memory, and touches no planner.
///
/// # Safety
/// As for `planner_follow`.
#[unsafe(export_name = "planner_follower_check")]
pub unsafe extern "C" fn follower_check(
    mission: Option<&Mission<'_>>,
    front: FrontSettings,
    given: *const Sample,
    count: usize,
) -> Verdict {
    // SAFETY: the caller promises it.
    let inputs = unsafe { inputs(mission, (given, count)) };
    // SAFETY: the caller promises it.
    inputs.and_then(|inputs| unsafe { possible(inputs, front) }).map(drop).into()
}

/// Makes a planner of fronts in so many bytes of memory that is aligned to 8, from 0 to 16 given samples, and writes where
/// it is. It is that memory's beginning: there is nothing to free. Of the mission `slopes` and `level` must be 0. A call
/// that is refused writes nothing: a planner that is in that memory stays as it was.
///
/// # Safety
/// `memory` must be null or writable for so many bytes, and `given` null or readable for so many samples. The mission's area
/// must be null or readable. None of them may lie in that memory.
#[unsafe(export_name = "planner_follow")]
pub unsafe extern "C" fn follow(
    made: Option<&mut MaybeUninit<*mut Follower>>,
    memory: *mut c_void,
    bytes: usize,
    mission: Option<&Mission<'_>>,
    front: FrontSettings,
    given: *const Sample,
    count: usize,
) -> Status {
    // SAFETY: the caller promises it.
    answer(made, || unsafe { begin_in((memory, bytes), mission, front, (given, count)) })
}

/// # Safety
/// As for [`follow`].
unsafe fn begin_in(
    memory: (*mut c_void, usize),
    mission: Option<&Mission<'_>>,
    settings: FrontSettings,
    given: (*const Sample, usize),
) -> Result<*mut Follower, Status> {
    // SAFETY: the caller promises it.
    let inputs = unsafe { inputs(mission, given) }?;
    // SAFETY: the caller promises it.
    let (parts, front, stretch) = unsafe { possible(inputs, settings) }?;
    // SAFETY (of both): the caller promises it.
    let begun = match stretch {
        None => unsafe { begin_track(memory, &parts, (front, settings.until_closed == 1)) },
        Some(stretch) => unsafe { begin_guard(memory, &parts, (front, stretch)) },
    };
    begun.map(|()| memory.0.cast())
}

/// # Safety
/// As for [`follow`].
#[inline(never)] // a call needs the stack of one kind, not of both
unsafe fn begin_track(
    memory: (*mut c_void, usize),
    parts: &Parts,
    (front, ends): (Front, bool),
) -> Result<(), Status> {
    let place = place::<Tracks>(memory)?;
    // SAFETY: there is room, and it is aligned.
    let track = unsafe {
        let planner = Track::of((parts.ground, parts.unicycle), front, ends);
        place.write(Held { kind: Kind::One, planner });
        &mut (*place).planner
    };
    let begun = track.restart(parts.given(), Prior::Area, parts.noise);
    begun.map_err(|_| Status::ToleranceTooLarge)
}

/// # Safety
/// As for [`follow`].
#[inline(never)]
unsafe fn begin_guard(
    memory: (*mut c_void, usize),
    parts: &Parts,
    (front, stretch): (Front, FrontStretch),
) -> Result<(), Status> {
    let place = place::<Guards>(memory)?;
    // SAFETY: there is room, and it is aligned.
    let guard = unsafe {
        let planner = Guard::guard_of((parts.ground, parts.unicycle), front, stretch);
        place.write(Held { kind: Kind::Other, planner });
        &mut (*place).planner
    };
    let begun = guard.restart(parts.given(), Prior::Area, parts.noise);
    begun.map_err(|_| Status::ToleranceTooLarge)
}

/// Plans the next motion from where the robot is. `PLANNER_STATUS_OK`, or why the mission is over.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_follower_plan")]
pub unsafe extern "C" fn follower_plan(
    follower: *mut Follower,
    pose: Pose,
    motion: Option<&mut MaybeUninit<Motion>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(motion, || unsafe { held::plan(follower, pose) })
}

/// Takes in where a motion ended, and what was read there: one of `planner_reading`.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_follower_observe")]
pub unsafe extern "C" fn follower_observe(
    follower: *mut Follower,
    pose: Pose,
    reading: i32,
) -> Status {
    // SAFETY: the caller promises it.
    unsafe { held::observe(follower, pose, reading, None) }.into()
}

/// As `planner_follower_observe`, of a position that may be off by so many metres, at most by the mission's tolerance. The
/// less it may be off, the more the label tells.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_follower_observe_within")]
pub unsafe extern "C" fn follower_observe_within(
    follower: *mut Follower,
    pose: Pose,
    reading: i32,
    tolerance: f64,
) -> Status {
    // SAFETY: the caller promises it.
    unsafe { held::observe(follower, pose, reading, Some(tolerance)) }.into()
}

/// Takes in what was read at a place on the way, before the motion planned last has ended. The motion goes on. Tell
/// `planner_follower_observe` of its end as without this.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_follower_observe_on_the_way")]
pub unsafe extern "C" fn follower_observe_on_the_way(
    follower: *mut Follower,
    at: Point,
    reading: i32,
) -> Status {
    // SAFETY: the caller promises it.
    unsafe { held::observe_on_the_way(follower, at, reading) }.into()
}

/// The chance that a label read at a place is +1, errors of the sensor included; from 0 to 1. It is 1/2 everywhere as long
/// as nothing is known of the front, and it says little of places far from the robot.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_follower_chance")]
pub unsafe extern "C" fn follower_chance(
    follower: *const Follower,
    at: Point,
    chance: Option<&mut MaybeUninit<f64>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(chance, || unsafe { held::chance(follower, at) })
}

/// Where the front is known best. `PLANNER_STATUS_UNKNOWN` as long as it is not found, and where it is lost.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_front")]
pub unsafe extern "C" fn front(
    follower: *const Follower,
    front: Option<&mut MaybeUninit<FrontPlace>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(front, || {
        let state = ask!(unsafe { get(follower) }?, it => it.front());
        let Some(FrontState { waist: Some(waist), is_closed }) = state else {
            return Err(Status::Unknown);
        };
        Ok(FrontPlace::new(waist, is_closed))
    })
}

/// Where the front crosses the line through the pose that is square to its heading. Ask it of places all along a stretch
/// that is watched. `PLANNER_STATUS_UNKNOWN` as long as the front is not found, and where it is lost.
///
/// # Safety
/// `follower` must be null or from `planner_follow`.
#[unsafe(export_name = "planner_front_beside")]
pub unsafe extern "C" fn front_beside(
    follower: *const Follower,
    pose: Pose,
    beside: Option<&mut MaybeUninit<FrontCrossing>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(beside, || {
        let follower = unsafe { get(follower) }?;
        let planner_core::Pose { site, heading } = pose.read()?;
        let beside = ask!(follower, it => it.found().map(|_| it.beside(site, heading)));
        let Beside { left, deviation } = beside.ok_or(Status::Unknown)?;
        Ok(FrontCrossing { left: left.into(), deviation: deviation.into() })
    })
}

/// Writes what a planner of fronts has to remember over a sleep, and how many bytes that takes.
/// `PLANNER_FOLLOWER_SNAPSHOT_BYTES` are always enough. If there is not so much room, nothing is written: what was saved
/// there before stays.
///
/// # Safety
/// `follower` must be null or from `planner_follow`, `bytes` null or writable for so many bytes.
#[unsafe(export_name = "planner_follower_save")]
pub unsafe extern "C" fn follower_save(
    follower: *const Follower,
    bytes: *mut u8,
    room: usize,
    count: Option<&mut MaybeUninit<usize>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(count, || unsafe { held::save(follower, (bytes, room)) })
}

/// Lets a planner of fronts go on from where another was, that was begun with the same mission. A planner that refuses
/// the bytes stays as it was.
///
/// # Safety
/// `follower` must be null or from `planner_follow`, `bytes` null or readable for so many bytes.
#[unsafe(export_name = "planner_follower_restore")]
pub unsafe extern "C" fn follower_restore(
    follower: *mut Follower,
    bytes: *const u8,
    count: usize,
) -> Status {
    if bytes.is_null() {
        return Status::Memory;
    }
    // SAFETY: the caller promises so many bytes, and the planner.
    unsafe { held::restore(follower, core::slice::from_raw_parts(bytes, count)) }.into()
}
