//! Planners that find a line, and the functions that are called of them.

use core::ffi::c_void;
use core::mem::{MaybeUninit, size_of};

use planner_core::error::{GivenError, ObservationError};
use planner_core::{
    Belief as _, FromLog, Goal, Lookahead, Persist as _, Planner as _, PredictiveBelief,
    Reliability, SlopeWithin, Unicycle, VersionSpace,
};
#[cfg(feature = "noise")]
use planner_core::{CellPosterior, NoisyBelief, Prior, Restart as _};

use crate::area::Ground;
use crate::held::{self, Handle, Held, Kind, answer, ask, get, get_mut, inputs, place};
use crate::mission::Mission;
use crate::parts::{MOST_GIVEN, Parts};
use crate::snapshot::{SNAPSHOT_BYTES, Snapshot};
use crate::status::Status;
use crate::types::{Line, Motion, Point, Pose, Reading, Sample};
use crate::verdict::{Refusal, Verdict};

/// Samples that a planner of true labels has room for, the given ones included.
const TRUE_SAMPLES: usize = 68;
/// The same with labels that may be wrong, and all hypotheses that 32 of them can come to.
#[cfg(feature = "noise")]
const DOUBTFUL_SAMPLES: usize = 36;
#[cfg(feature = "noise")]
const HYPOTHESES: usize = 529;

type Of<B> = Lookahead<Unicycle, B, Ground, SlopeWithin>;
pub(crate) type True = Of<VersionSpace<TRUE_SAMPLES>>;
#[cfg(feature = "noise")]
pub(crate) type Doubtful = Of<NoisyBelief<DOUBTFUL_SAMPLES, HYPOTHESES>>;
/// There are none.
#[cfg(not(feature = "noise"))]
pub(crate) type Doubtful = True;

/// A planner, in memory of the caller.
pub struct Finder(());

impl Handle for Finder {
    type One = True;
    type Other = Doubtful;
}

/// A belief that can take in a label whose reliability differs from the mission's.
trait Believe: PredictiveBelief + FromLog {
    /// How reliable the labels of the mission are.
    fn usual(known: &Self::Belief) -> Reliability;

    /// Takes in a label of another reliability.
    fn take(
        &mut self,
        sample: planner_core::Sample,
        believed: Reliability,
    ) -> Result<(), ObservationError>;
}

/// Labels are always right.
impl<const N: usize> Believe for VersionSpace<N> {
    fn usual(_: &Self) -> Reliability {
        Reliability::CERTAIN
    }

    fn take(&mut self, _: planner_core::Sample, _: Reliability) -> Result<(), ObservationError> {
        Err(ObservationError::Reliability)
    }
}

#[cfg(feature = "noise")]
impl<const N: usize, const H: usize> Believe for NoisyBelief<N, H> {
    fn usual(known: &CellPosterior<N, H>) -> Reliability {
        known.noise().reliability
    }

    fn take(
        &mut self,
        sample: planner_core::Sample,
        believed: Reliability,
    ) -> Result<(), ObservationError> {
        Self::take(self, sample, believed)
    }
}

/// How much memory the planner of a mission takes, bytes; 0 if `p` or `tolerance` is refused. Nothing else is checked.
#[unsafe(export_name = "planner_bytes")]
pub extern "C" fn bytes(mission: Option<&Mission<'_>>) -> usize {
    match mission.map(|it| (it.noise(), it.is_true())) {
        Some((Ok(_), true)) => size_of::<Held<True>>(),
        Some((Ok(_), false)) if cfg!(feature = "noise") => size_of::<Held<Doubtful>>(),
        _ => 0,
    }
}

/// The parts of a planner, and its goal.
unsafe fn possible(
    (mission, given): (&Mission<'_>, &[Sample]),
) -> Result<(Parts, Option<Goal<SlopeWithin>>), Refusal> {
    // SAFETY: the caller promises it.
    let parts = unsafe { Parts::new(mission, given) }?;
    let goal = mission.goal()?;
    // With room for these samples alone.
    let found = if mission.is_true() {
        let space = VersionSpace::<MOST_GIVEN>::new(parts.given());
        space.and_then(|it| it.with_tolerance(parts.noise.tolerance)).map(drop)
    } else {
        #[cfg(not(feature = "noise"))]
        return Err(Refusal::of(Status::Mission, c"p"));
        #[cfg(feature = "noise")]
        CellPosterior::<MOST_GIVEN, 1>::new(parts.given(), Prior::Area, parts.noise).map(drop)
    };
    let refusal = Refusal::of(Status::Given, c"given");
    found.map_err(|why| match why {
        GivenError::NotSeparable(number) => refusal.about(number),
        _ => refusal,
    })?;
    Ok((parts, goal))
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
    // SAFETY: the caller promises it.
    let inputs = unsafe { inputs(mission, (given, count)) };
    // SAFETY: the caller promises it.
    inputs.and_then(|inputs| unsafe { possible(inputs) }).map(drop).into()
}

/// Makes a planner in so many bytes of memory that is aligned to 8, from 3 to 16 given samples of both labels, and
/// writes where it is. It is that memory's beginning: there is nothing to free. A call that is refused writes nothing:
/// a planner that is in that memory stays as it was.
///
/// # Safety
/// `memory` must be null or writable for so many bytes, and `given` null or readable for so many samples. The mission's area
/// must be null or readable, and so must its chart. The cells of the chart must be readable as long as the planner is used. None of
/// them may lie in that memory.
#[unsafe(export_name = "planner_begin")]
pub unsafe extern "C" fn begin(
    made: Option<&mut MaybeUninit<*mut Finder>>,
    memory: *mut c_void,
    bytes: usize,
    mission: Option<&Mission<'_>>,
    given: *const Sample,
    count: usize,
) -> Status {
    // SAFETY: the caller promises it.
    answer(made, || unsafe { begin_in((memory, bytes), mission, (given, count)) })
}

/// # Safety
/// As for [`begin`].
unsafe fn begin_in(
    memory: (*mut c_void, usize),
    mission: Option<&Mission<'_>>,
    given: (*const Sample, usize),
) -> Result<*mut Finder, Status> {
    // SAFETY: the caller promises it.
    let (mission, given) = unsafe { inputs(mission, given) }?;
    // SAFETY: the caller promises it.
    let (parts, goal) = unsafe { possible((mission, given)) }?;
    // SAFETY (of both): the caller promises it.
    let begun = if mission.is_true() {
        unsafe { begin_true(memory, &parts, goal) }
    } else {
        #[cfg(not(feature = "noise"))]
        return Err(Status::Mission);
        #[cfg(feature = "noise")]
        unsafe {
            begin_doubtful(memory, &parts, goal)
        }
    };
    begun.map(|()| memory.0.cast())
}

/// # Safety
/// As for [`begin`].
#[inline(never)] // a call needs the stack of one kind, not of both
unsafe fn begin_true(
    memory: (*mut c_void, usize),
    parts: &Parts,
    goal: Option<Goal<SlopeWithin>>,
) -> Result<(), Status> {
    let place = place::<True>(memory)?;
    let space = VersionSpace::new(parts.given());
    let space = space.and_then(|it| it.with_tolerance(parts.noise.tolerance));
    let space = space.map_err(|_| Status::Given)?;
    let planner = Lookahead::of((parts.ground, parts.unicycle), space, goal);
    // SAFETY: there is room, and it is aligned.
    unsafe { place.write(Held { kind: Kind::One, planner }) };
    Ok(())
}

/// # Safety
/// As for [`begin`].
#[cfg(feature = "noise")]
#[inline(never)]
unsafe fn begin_doubtful(
    memory: (*mut c_void, usize),
    parts: &Parts,
    goal: Option<Goal<SlopeWithin>>,
) -> Result<(), Status> {
    let place = place::<Doubtful>(memory)?;
    // SAFETY: there is room, and it is aligned.
    let planner = unsafe {
        (&raw mut (*place).kind).write(Kind::Other);
        let planner = Lookahead::of((parts.ground, parts.unicycle), NoisyBelief::NONE, goal);
        (&raw mut (*place).planner).write(planner);
        &mut (*place).planner
    };
    // In place: it is large.
    let begun = planner.restart(parts.given(), Prior::Area, parts.noise);
    begun.map_err(|_| Status::Given)
}

/// Plans the next motion from where the robot is. `PLANNER_STATUS_OK`, or why the mission is over.
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
    answer(motion, || unsafe { held::plan(finder, pose) })
}

/// Takes in where a motion ended, and what was read there: one of `planner_reading`.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_observe")]
pub unsafe extern "C" fn observe(finder: *mut Finder, pose: Pose, reading: i32) -> Status {
    // SAFETY: the caller promises it.
    unsafe { held::observe(finder, pose, reading, None) }.into()
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
    unsafe { held::observe(finder, pose, reading, Some(tolerance)) }.into()
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
    let finder = unsafe { get_mut(finder) };
    finder.and_then(|finder| ask!(finder, it => believed(it, pose, reading, p))).into()
}

fn believed<B: Believe>(
    planner: &mut Of<B>,
    pose: Pose,
    reading: i32,
    p: f64,
) -> Result<(), Status> {
    let (pose, reading) = (pose.read()?, Reading::read(reading)?);
    let believed = Reliability::new(p).map_err(|_| Status::Reliability)?;
    let label = match reading {
        Some(planner_core::Reading::Side(label)) if believed != B::usual(planner.belief()) => label,
        _ => return Ok(planner.observe(pose, reading)?),
    };
    let before = planner.snapshot();
    let sample = planner_core::Sample { site: pose.site, label };
    planner.belief_mut().take(sample, believed).map_err(|refused| {
        // `belief_mut` has reset the turns. The snapshot is this planner's own, so it is restored.
        let _ = planner.restore(&before);
        refused.into()
    })
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
    unsafe { held::observe_on_the_way(finder, at, reading) }.into()
}

/// The line as far as it is known: the mean of all lines that are left, or in noise of their distribution.
/// `PLANNER_STATUS_UNKNOWN` if they lie too close together for single precision.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_estimate")]
pub unsafe extern "C" fn estimate(
    finder: *const Finder,
    line: Option<&mut MaybeUninit<Line>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(line, || {
        let finder = unsafe { get(finder) }?;
        ask!(finder, it => it.estimate()).map(Line::from).ok_or(Status::Unknown)
    })
}

/// What labels have told of the line so far, bits; not a number without a planner.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_bits")]
pub unsafe extern "C" fn bits(finder: *const Finder) -> f64 {
    // SAFETY: the caller promises it.
    let finder = unsafe { get(finder) };
    finder.map_or(f64::NAN, |finder| ask!(finder, it => it.belief().information()))
}

/// The chance that a label read at a place is +1, errors of the sensor included; from 0 to 1.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_chance")]
pub unsafe extern "C" fn chance(
    finder: *const Finder,
    at: Point,
    chance: Option<&mut MaybeUninit<f64>>,
) -> Status {
    // SAFETY: the caller promises it.
    answer(chance, || unsafe { held::chance(finder, at) })
}

/// Writes what a planner has to remember over a sleep. Keep it, and the robot's pose.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_save")]
pub unsafe extern "C" fn save(
    finder: *const Finder,
    snapshot: Option<&mut MaybeUninit<Snapshot>>,
) -> Status {
    let Some(snapshot) = snapshot else { return Status::Memory };
    let snapshot = snapshot.as_mut_ptr();
    // SAFETY: the caller promises it of the planner. In the snapshot there is room for all its bytes, and for their count.
    let saved = unsafe {
        let bytes = (&raw mut (*snapshot).bytes).cast::<u8>();
        held::save(finder, (bytes, SNAPSHOT_BYTES)).map(|count| {
            bytes.add(count).write_bytes(0, SNAPSHOT_BYTES - count);
            (*snapshot).count = count as u32;
        })
    };
    saved.into()
}

/// Lets a planner go on from where another was, that was begun with the same mission. Begin it first as at the start: what
/// it was told since is forgotten, the given samples included. It takes as long as the labels took when they came. A
/// planner that refuses a snapshot stays as it was.
///
/// # Safety
/// `finder` must be null or from `planner_begin`.
#[unsafe(export_name = "planner_restore")]
pub unsafe extern "C" fn restore(finder: *mut Finder, snapshot: Option<&Snapshot>) -> Status {
    let bytes = snapshot.ok_or(Status::Memory).and_then(Snapshot::used);
    // SAFETY: the caller promises it.
    bytes.and_then(|bytes| unsafe { held::restore(finder, bytes) }).into()
}
