//! The planner in the caller's memory, and the functions that are called.
//!
//! The only unsafe code is here: it reads and writes behind the pointers that C passes. A null pointer is refused. The
//! caller promises that all others are as the header requires.

use core::ffi::c_void;
use core::mem::{MaybeUninit, align_of, size_of};

use planner_core::{
    Lookahead, NoisyBelief, Plan, Planner as _, Prior, Reliability, Restart as _, SlopeWithin,
    Tolerance, Unicycle, VersionSpace,
};

use crate::area::Ground;
use crate::asked::Asked;
use crate::possible::{MOST_GIVEN, Possible};
use crate::snapshot::Snapshot;
use crate::types::{Line, Mission, Motion, Point, Pose, Reading, Sample, Status};
use crate::verdict::{Refusal, Verdict};

/// Samples that a planner of true labels has room for, the given ones included.
const TRUE_SAMPLES: usize = 68;
/// The same with labels that may be wrong, and all hypotheses that 32 of them can come to.
const DOUBTFUL_SAMPLES: usize = 36;
const HYPOTHESES: usize = 529;

type True = Lookahead<Unicycle, VersionSpace<TRUE_SAMPLES>, Ground, SlopeWithin>;
type Doubtful = Lookahead<Unicycle, NoisyBelief<DOUBTFUL_SAMPLES, HYPOTHESES>, Ground, SlopeWithin>;

/// A planner, in memory of the caller.
#[repr(align(8))]
pub struct Finder {
    kind: Kind,
}

/// Which planner follows in memory.
#[derive(Clone, Copy)]
enum Kind {
    True,
    Doubtful,
}

/// A planner with its kind before it.
#[repr(C)]
struct Held<P> {
    finder: Finder,
    planner: P,
}

/// What a pointer leads to.
enum Either<'a> {
    True(&'a mut True),
    Doubtful(&'a mut Doubtful),
}

/// What a pointer leads to; `None` if it is null.
///
/// # Safety
/// It must be null or what [`begin`] wrote, and nobody else may use that meanwhile.
unsafe fn asked<'a>(finder: *mut Finder) -> Option<Either<'a>> {
    if finder.is_null() {
        return None;
    }
    // SAFETY: only `begin` makes a finder, and it writes after it the planner of its kind.
    unsafe {
        Some(match (*finder).kind {
            Kind::True => Either::True(&mut (*finder.cast::<Held<True>>()).planner),
            Kind::Doubtful => Either::Doubtful(&mut (*finder.cast::<Held<Doubtful>>()).planner),
        })
    }
}

/// Asks either planner the same. No table of methods: a program carries only those that it calls.
macro_rules! ask {
    ($either:expr, $planner:ident => $asked:expr) => {
        match $either {
            Either::True($planner) => $asked,
            Either::Doubtful($planner) => $asked,
        }
    };
}

/// How much memory the planner of a mission takes, bytes; 0 if `p` or `tolerance` is refused. Nothing else is checked.
#[unsafe(export_name = "planner_bytes")]
pub extern "C" fn bytes(mission: Option<&Mission<'_>>) -> usize {
    match mission.map(Mission::noise) {
        Some(Ok(None)) => size_of::<Held<True>>(),
        Some(Ok(Some(_))) => size_of::<Held<Doubtful>>(),
        _ => 0,
    }
}

/// The given samples.
///
/// # Safety
/// `given` must be null or readable for so many samples.
unsafe fn samples<'a>(given: *const Sample, count: usize) -> Result<&'a [Sample], Refusal> {
    if given.is_null() || !given.is_aligned() {
        return Err(Refusal::of(Status::Memory, c""));
    }
    if count > MOST_GIVEN {
        return Err(Refusal::of(Status::Given, c"given"));
    }
    // SAFETY: the caller promises so many samples.
    Ok(unsafe { core::slice::from_raw_parts(given, count) })
}

/// What `planner_begin` will say of a mission and its given samples, and which part of them that is about. It needs no
/// memory, and touches no planner.
///
/// # Safety
/// As for `planner_begin`.
#[unsafe(export_name = "planner_check")]
pub unsafe extern "C" fn check(
    mission: Option<&Mission<'_>>,
    given: *const Sample,
    count: usize,
) -> Verdict {
    let Some(mission) = mission else { return Err(Refusal::of(Status::Memory, c"")).into() };
    // SAFETY: the caller promises it.
    let given = unsafe { samples(given, count) };
    given.and_then(|given| Possible::new(mission, given)).map(drop).into()
}

/// Makes a planner in so many bytes of memory that is aligned to 8, from 3 to 16 given samples of both labels, and
/// writes where it is. It is that memory's beginning: there is nothing to free. A call that is refused writes nothing:
/// a planner that is in that memory stays as it was.
///
/// # Safety
/// `memory` must be null or writable for so many bytes, `given` null or readable for so many samples, the mission's area
/// null or readable, and none of them in that memory.
#[unsafe(export_name = "planner_begin")]
pub unsafe extern "C" fn begin(
    made: Option<&mut MaybeUninit<*mut Finder>>,
    memory: *mut c_void,
    bytes: usize,
    mission: Option<&Mission<'_>>,
    given: *const Sample,
    count: usize,
) -> Status {
    let (Some(made), Some(mission)) = (made, mission) else { return Status::Memory };
    // SAFETY: the caller promises so many samples.
    let given = unsafe { samples(given, count) };
    let possible = match given.and_then(|given| Possible::new(mission, given)) {
        Ok(possible) => possible,
        Err(refusal) => return refusal.status,
    };
    // SAFETY: the caller promises so much memory.
    match unsafe { begin_in(memory, bytes, &possible) } {
        Ok(finder) => {
            made.write(finder);
            Status::Ok
        }
        Err(status) => status,
    }
}

/// # Safety
/// `memory` must be null or writable for so many bytes.
unsafe fn begin_in(
    memory: *mut c_void,
    bytes: usize,
    possible: &Possible,
) -> Result<*mut Finder, Status> {
    let &Possible { area, tolerance, unicycle, goal, noise, .. } = possible;
    let needed =
        if noise.is_none() { size_of::<Held<True>>() } else { size_of::<Held<Doubtful>>() };
    let is_room = !memory.is_null() && bytes >= needed && memory.addr().is_multiple_of(8);
    if !is_room {
        return Err(Status::Memory);
    }
    const { assert!(align_of::<Held<True>>() <= 8 && align_of::<Held<Doubtful>>() <= 8) };
    // SAFETY (of both writes): there is room, and it is aligned.
    if let Some(noise) = noise {
        let planner = Lookahead::new(area, unicycle, NoisyBelief::NONE);
        let planner = planner.map_err(|_| Status::ToleranceTooLarge)?.until(goal);
        let held = Held { finder: Finder { kind: Kind::Doubtful }, planner };
        let place = memory.cast::<Held<Doubtful>>();
        unsafe { place.write(held) };
        // In place: it is large. SAFETY: it has just been written.
        let planner = unsafe { &mut (*place).planner };
        planner.restart(possible.given(), Prior::Area, noise).map_err(|_| Status::Given)?;
    } else {
        let space = VersionSpace::new(possible.given());
        let space = space.and_then(|it| it.with_tolerance(tolerance));
        let space = space.map_err(|_| Status::Given)?;
        let planner = Lookahead::new(area, unicycle, space);
        let planner = planner.map_err(|_| Status::ToleranceTooLarge)?.until(goal);
        let held = Held { finder: Finder { kind: Kind::True }, planner };
        unsafe { memory.cast::<Held<True>>().write(held) };
    }
    Ok(memory.cast())
}

/// Plans the next motion from where the robot is. `Ok`, or why the mission is over.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_plan")]
pub unsafe extern "C" fn plan(
    finder: *mut Finder,
    pose: Pose,
    motion: Option<&mut MaybeUninit<Motion>>,
) -> Status {
    // SAFETY: the caller promises it.
    let (Some(finder), Some(place)) = (unsafe { asked(finder) }, motion) else {
        return Status::Memory;
    };
    let pose = match pose.read() {
        Ok(pose) => pose,
        Err(status) => return status,
    };
    match ask!(finder, it => it.plan(pose)) {
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
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_observe")]
pub unsafe extern "C" fn observe(finder: *mut Finder, pose: Pose, reading: i32) -> Status {
    // SAFETY: the caller promises it.
    unsafe {
        take_in(
            finder,
            pose,
            reading,
            |finder, pose, reading| ask!(finder, it => Asked::observe(it, pose, reading)),
        )
    }
}

/// As `planner_observe`, of a position that may be off by so many metres, at most by the mission's tolerance. The less it
/// may be off, the more the label tells.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_observe_within")]
pub unsafe extern "C" fn observe_within(
    finder: *mut Finder,
    pose: Pose,
    reading: i32,
    tolerance: f64,
) -> Status {
    // SAFETY: the caller promises it.
    unsafe {
        take_in(finder, pose, reading, |finder, pose, reading| {
            let tolerance = Tolerance::new(tolerance).map_err(|_| Status::Tolerance)?;
            ask!(finder, it => Asked::observe_within(it, pose, reading, tolerance))
        })
    }
}

/// As `planner_observe`, of a label that is right with probability `p`, from 0 to 1. Below 1/2 it rather says the other
/// side.
///
/// A mission takes other values than its own `p` if that is below 1 and its tolerance is 0. Where positions err, every
/// label counts by the mission's `p`.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_observe_believed")]
pub unsafe extern "C" fn observe_believed(
    finder: *mut Finder,
    pose: Pose,
    reading: i32,
    p: f64,
) -> Status {
    // SAFETY: the caller promises it.
    unsafe {
        take_in(finder, pose, reading, |finder, pose, reading| {
            let believed = Reliability::new(p).map_err(|_| Status::Reliability)?;
            ask!(finder, it => it.observe_believed(pose, reading, believed))
        })
    }
}

/// Takes in what was read at a place on the way, before the motion planned last has ended. The planner keeps a true label
/// only if it rules out lines, and leaves the last room for the label at the end. The motion goes on. Tell
/// `planner_observe` of its end as without this.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_observe_on_the_way")]
pub unsafe extern "C" fn observe_on_the_way(
    finder: *mut Finder,
    at: Point,
    reading: i32,
) -> Status {
    // SAFETY: the caller promises it.
    let Some(finder) = (unsafe { asked(finder) }) else { return Status::Memory };
    let observed = match (at.read(), Reading::read(reading)) {
        (Ok(_), Ok(None)) => Ok(()),
        (Ok(site), Ok(Some(reading))) => {
            ask!(finder, it => Asked::observe_on_the_way(it, site, reading))
        }
        (Err(status), _) | (_, Err(status)) => Err(status),
    };
    observed.err().unwrap_or(Status::Ok)
}

/// Takes in what was read at a pose, each of which is checked.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
unsafe fn take_in(
    finder: *mut Finder,
    pose: Pose,
    reading: i32,
    observe: impl FnOnce(
        Either<'_>,
        planner_core::Pose,
        Option<planner_core::Reading>,
    ) -> Result<(), Status>,
) -> Status {
    // SAFETY: the caller promises it.
    let Some(finder) = (unsafe { asked(finder) }) else { return Status::Memory };
    match (pose.read(), Reading::read(reading)) {
        (Ok(pose), Ok(reading)) => observe(finder, pose, reading).err().unwrap_or(Status::Ok),
        (Err(status), _) | (_, Err(status)) => status,
    }
}

/// The line as far as it is known: the mean of all lines that are left, or in noise of their distribution.
/// `PLANNER_STATUS_RESOLUTION` if they lie too close together for single precision.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_estimate")]
pub unsafe extern "C" fn estimate(
    finder: *mut Finder,
    line: Option<&mut MaybeUninit<Line>>,
) -> Status {
    // SAFETY: the caller promises it.
    let (Some(finder), Some(place)) = (unsafe { asked(finder) }, line) else {
        return Status::Memory;
    };
    let Some(centre) = ask!(finder, it => it.centre()) else { return Status::Resolution };
    place.write(centre);
    Status::Ok
}

/// What labels have told of the line so far, bits; not a number without a planner.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_bits")]
pub unsafe extern "C" fn bits(finder: *mut Finder) -> f64 {
    // SAFETY: the caller promises it.
    unsafe { asked(finder) }.map_or(f64::NAN, |finder| ask!(finder, it => it.bits()))
}

/// The chance that a label read at a place is +1, errors of the sensor included; from 0 to 1.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_chance")]
pub unsafe extern "C" fn chance(
    finder: *mut Finder,
    at: Point,
    chance: Option<&mut MaybeUninit<f64>>,
) -> Status {
    // SAFETY: the caller promises it.
    let (Some(finder), Some(place)) = (unsafe { asked(finder) }, chance) else {
        return Status::Memory;
    };
    match at.read() {
        Ok(site) => place.write(ask!(finder, it => it.chance(site))),
        Err(status) => return status,
    };
    Status::Ok
}

/// Writes what a planner has to remember over a sleep. Keep it, and the robot's pose.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_save")]
pub unsafe extern "C" fn save(
    finder: *mut Finder,
    snapshot: Option<&mut MaybeUninit<Snapshot>>,
) -> Status {
    // SAFETY: the caller promises it.
    let (Some(finder), Some(place)) = (unsafe { asked(finder) }, snapshot) else {
        return Status::Memory;
    };
    let Some(saved) = ask!(finder, it => it.save()) else { return Status::Memory };
    place.write(saved);
    Status::Ok
}

/// Lets a planner go on from where another was, that was begun with the same mission. Begin it first as at the start: what
/// it was told since is forgotten, the given samples included. It takes as long as the labels took when they came. A
/// planner that refuses a snapshot stays as it was.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_restore")]
pub unsafe extern "C" fn restore(finder: *mut Finder, snapshot: Option<&Snapshot>) -> Status {
    // SAFETY: the caller promises it.
    let (Some(finder), Some(snapshot)) = (unsafe { asked(finder) }, snapshot) else {
        return Status::Memory;
    };
    ask!(finder, it => Asked::restore(it, snapshot)).err().unwrap_or(Status::Ok)
}
