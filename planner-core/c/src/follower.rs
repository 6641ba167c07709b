//! A planner that goes along a front or watches a stretch of it, in the caller's memory.
//!
//! Unsafe code is here for the same reason as in `finder`: it reads and writes behind the pointers that C passes.

use core::ffi::c_void;
use core::mem::{MaybeUninit, align_of, size_of};

use planner_core::{
    Beside, Front, FrontState, FrontStretch, Guard, Noise, Plan, Planner as _, Prior, Restart as _,
    Site, Track, Unicycle, Waist,
};

use crate::area::Ground;
use crate::possible::MOST_GIVEN;
use crate::snapshot;
use crate::types::{Mission, Motion, Pose, Reading, Sample, Status};

type Tracks = Track<Unicycle, Ground>;
type Guards = Guard<Unicycle, Ground>;

/// A planner that goes along a front or watches a stretch of it, in memory of the caller.
#[repr(align(8))]
pub struct Follower {
    planner: Either,
}

/// What the planner does with the front.
#[expect(clippy::large_enum_variant, reason = "the caller has memory for either")]
enum Either {
    Track(Tracks),
    Guard(Guards),
}

/// Asks either planner the same.
macro_rules! ask {
    ($follower:expr, $planner:ident => $asked:expr) => {
        match &mut $follower.planner {
            Either::Track($planner) => $asked,
            Either::Guard($planner) => $asked,
        }
    };
}

/// How a front bends, and how fast it moves.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FrontSettings {
    /// 0 for a straight line, and any radius from 0.1 m for a front that bends: only whether it bends counts.
    pub radius: f64,
    /// How far the front may move in the time of a motion, metres. If in doubt, name a higher speed.
    pub speed: f64,
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
    size_of::<Follower>()
}

/// Makes a planner of fronts in so many bytes of memory that is aligned to 8, from 0 to 16 given samples, and writes where
/// it is. It is that memory's beginning: there is nothing to free. Of the mission `slopes` and `level` must be 0. A call
/// that is refused writes nothing.
///
/// # Safety
/// `memory` must be null or writable for so many bytes, `given` readable for so many samples or null if there are none,
/// the mission's area null or readable, and none of them in that memory.
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
    // SAFETY: the caller promises the same.
    unsafe { begin(made, (memory, bytes), mission, (front, None), (given, count)) }
}

/// As `planner_follow`, but the planner stays with so many metres of the front, from 0.1 to 10000, about the place where it
/// finds it. It learns where the front is all along them.
///
/// # Safety
/// As for `planner_follow`.
#[unsafe(export_name = "planner_watch")]
pub unsafe extern "C" fn watch(
    made: Option<&mut MaybeUninit<*mut Follower>>,
    memory: *mut c_void,
    bytes: usize,
    mission: Option<&Mission<'_>>,
    front: FrontSettings,
    stretch: f64,
    given: *const Sample,
    count: usize,
) -> Status {
    // SAFETY: the caller promises the same.
    unsafe { begin(made, (memory, bytes), mission, (front, Some(stretch)), (given, count)) }
}

/// Makes a planner of a front, and of a stretch to watch if there is one.
///
/// # Safety
/// As for [`follow`].
unsafe fn begin(
    made: Option<&mut MaybeUninit<*mut Follower>>,
    (memory, bytes): (*mut c_void, usize),
    mission: Option<&Mission<'_>>,
    (front, stretch): (FrontSettings, Option<f64>),
    (given, count): (*const Sample, usize),
) -> Status {
    let (Some(made), Some(mission)) = (made, mission) else { return Status::Memory };
    let is_room = bytes >= size_of::<Follower>() && memory.addr().is_multiple_of(8);
    let is_given = count == 0 || !given.is_null() && given.is_aligned();
    if memory.is_null() || !is_room || !is_given {
        return Status::Memory;
    }
    const { assert!(align_of::<Follower>() <= 8) };
    // SAFETY: the caller promises so many samples.
    let given = if count == 0 { &[] } else { unsafe { core::slice::from_raw_parts(given, count) } };
    let begun = prepared(mission, (front, stretch), given).and_then(|(planner, noise, samples)| {
        let place = memory.cast::<Follower>();
        // SAFETY: there is room, and it is aligned.
        let follower = unsafe {
            place.write(Follower { planner });
            &mut *place
        };
        let samples = samples.get(..given.len()).unwrap_or_default();
        let begun = ask!(follower, it => it.restart(samples, Prior::Area, noise));
        begun.map(|()| place).map_err(|_| Status::ToleranceTooLarge)
    });
    match begun {
        Ok(place) => {
            made.write(place);
            Status::Ok
        }
        Err(status) => status,
    }
}

type Parts = (Either, Noise, [planner_core::Sample; MOST_GIVEN]);

/// A planner of a mission, its noise and its given samples.
fn prepared(
    mission: &Mission<'_>,
    (FrontSettings { radius, speed }, stretch): (FrontSettings, Option<f64>),
    given: &[Sample],
) -> Result<Parts, Status> {
    let label = planner_core::Label::Negative;
    let mut samples = [planner_core::Sample { site: Site::ORIGIN, label }; MOST_GIVEN];
    let places = samples.get_mut(..given.len()).ok_or(Status::Given)?;
    for (place, sample) in places.iter_mut().zip(given) {
        *place = sample.read()?;
    }
    let front = if radius == 0.0 { Ok(Front::STRAIGHT) } else { Front::bending(radius) };
    let front = front.and_then(|it| it.moving(speed)).map_err(|_| Status::Mission)?;
    let status = |refusal: crate::verdict::Refusal| refusal.status;
    if mission.slopes != 0.0 || mission.level != 0.0 {
        return Err(Status::Mission);
    }
    let (ground, unicycle) =
        (mission.ground().map_err(status)?, mission.unicycle().map_err(status)?);
    let tolerance = mission.tolerance().map_err(status)?;
    let noise = mission.noise().map_err(status)?.unwrap_or(Noise { tolerance, ..Noise::NONE });
    let planner = match stretch {
        None => Track::new(ground, unicycle, front, noise).map(Either::Track),
        Some(metres) => {
            let stretch = FrontStretch::metres(metres).map_err(|_| Status::Mission)?;
            Guard::watching(ground, unicycle, (front, stretch), noise).map(Either::Guard)
        }
    };
    Ok((planner.map_err(|_| Status::ToleranceTooLarge)?, noise, samples))
}

/// Plans the next motion from where the robot is. `Ok`, or why there is none.
///
/// # Safety
/// `follower` must be null or from `planner_follow` or `planner_watch`.
#[unsafe(export_name = "planner_follower_plan")]
pub unsafe extern "C" fn follower_plan(
    follower: Option<&mut Follower>,
    pose: Pose,
    motion: Option<&mut MaybeUninit<Motion>>,
) -> Status {
    let (Some(follower), Some(place)) = (follower, motion) else { return Status::Memory };
    let pose = match pose.read() {
        Ok(pose) => pose,
        Err(status) => return status,
    };
    match ask!(follower, it => it.plan(pose)) {
        Plan::Move(motion) => {
            place.write(motion.into());
            Status::Ok
        }
        Plan::Stop(reason) => reason.into(),
    }
}

/// Takes in where a motion ended, and what was read there: one of `planner_reading`.
///
/// # Safety
/// `follower` must be null or from `planner_follow` or `planner_watch`.
#[unsafe(export_name = "planner_follower_observe")]
pub unsafe extern "C" fn follower_observe(
    follower: Option<&mut Follower>,
    pose: Pose,
    reading: i32,
) -> Status {
    let Some(follower) = follower else { return Status::Memory };
    match (pose.read(), Reading::read(reading)) {
        (Ok(pose), Ok(reading)) => {
            let observed = ask!(follower, it => it.observe(pose, reading));
            observed.map_or_else(Status::from, |()| Status::Ok)
        }
        (Err(status), _) | (_, Err(status)) => status,
    }
}

/// Where the front is known best. `PLANNER_STATUS_UNDECIDED` as long as it is not found, and where it is lost.
///
/// # Safety
/// `follower` must be null or from `planner_follow` or `planner_watch`.
#[unsafe(export_name = "planner_front")]
pub unsafe extern "C" fn front(
    follower: Option<&mut Follower>,
    front: Option<&mut MaybeUninit<FrontPlace>>,
) -> Status {
    let (Some(follower), Some(place)) = (follower, front) else { return Status::Memory };
    let Some(FrontState { waist: Some(waist), is_closed }) = ask!(follower, it => it.front())
    else {
        return Status::Undecided;
    };
    place.write(FrontPlace::new(waist, is_closed));
    Status::Ok
}

/// Where the front crosses the line through the pose that is square to its heading. Ask it of places all along a stretch
/// that is watched. `PLANNER_STATUS_UNDECIDED` as long as the front is not found, and where it is lost.
///
/// # Safety
/// `follower` must be null or from `planner_follow` or `planner_watch`.
#[unsafe(export_name = "planner_front_beside")]
pub unsafe extern "C" fn front_beside(
    follower: Option<&mut Follower>,
    pose: Pose,
    beside: Option<&mut MaybeUninit<FrontCrossing>>,
) -> Status {
    let (Some(follower), Some(place)) = (follower, beside) else { return Status::Memory };
    let planner_core::Pose { site, heading } = match pose.read() {
        Ok(pose) => pose,
        Err(status) => return status,
    };
    let beside = ask!(follower, it => it.found().map(|_| it.beside(site, heading)));
    let Some(Beside { left, deviation }) = beside else { return Status::Undecided };
    place.write(FrontCrossing { left: left.into(), deviation: deviation.into() });
    Status::Ok
}

/// Writes what a planner of fronts has to remember over a sleep. Returns how many bytes that takes; 0 if there is not so
/// much room, and then none is written. `planner_follower_bytes` are always enough.
///
/// # Safety
/// `follower` must be null or from `planner_follow` or `planner_watch`, `bytes` null or writable for so many bytes.
#[unsafe(export_name = "planner_follower_save")]
pub unsafe extern "C" fn follower_save(
    follower: Option<&mut Follower>,
    bytes: *mut u8,
    room: usize,
) -> usize {
    let Some(follower) = follower.filter(|_| !bytes.is_null()) else { return 0 };
    // An earlier snapshot stays until there is another.
    let Some(count) = ask!(follower, it => snapshot::size(it)).filter(|it| *it <= room) else {
        return 0;
    };
    // SAFETY: the caller promises more room than that.
    let bytes = unsafe {
        bytes.write_bytes(0, count);
        core::slice::from_raw_parts_mut(bytes, count)
    };
    ask!(follower, it => snapshot::write(it, bytes)).unwrap_or(0)
}

/// Lets a planner of fronts go on from where another was, that was begun with the same mission. A planner that refuses
/// the bytes stays as it was.
///
/// # Safety
/// `follower` must be null or from `planner_follow` or `planner_watch`, `bytes` null or readable for so many bytes.
#[unsafe(export_name = "planner_follower_restore")]
pub unsafe extern "C" fn follower_restore(
    follower: Option<&mut Follower>,
    bytes: *const u8,
    count: usize,
) -> Status {
    let Some(follower) = follower.filter(|_| !bytes.is_null()) else { return Status::Memory };
    // SAFETY: the caller promises so many bytes.
    let bytes = unsafe { core::slice::from_raw_parts(bytes, count) };
    ask!(follower, it => snapshot::wake(bytes, it)).err().unwrap_or(Status::Ok)
}
