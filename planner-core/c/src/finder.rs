//! The planner in the caller's memory, and the functions that are called.
//!
//! The only unsafe code is here: what is read and written behind pointers that C hands over. A null pointer is
//! refused; that others are as the header asks for is the caller's promise.

use core::ffi::c_void;
use core::mem::{MaybeUninit, align_of, size_of};

use planner_core::belief::outlook::Foresight;
use planner_core::{
    Belief as _, Forecast, Hypotheses, Lookahead, Plan, Planner as _, Prior, Refused, Unicycle,
    VersionSpace,
};

use crate::types::{Line, Mission, Motion, Pose, Reading, Sample, Status};

/// Samples that a planner of true labels has room for, the given ones included.
const TRUE_SAMPLES: usize = 68;
/// The same with labels that may be wrong, and all hypotheses that 32 of them can come to.
const DOUBTFUL_SAMPLES: usize = 36;
const HYPOTHESES: usize = 529;
/// Given samples at most.
const MOST_GIVEN: usize = 16;

type True = Lookahead<Unicycle, VersionSpace<TRUE_SAMPLES>>;
type Doubtful = Lookahead<Unicycle, Forecast<DOUBTFUL_SAMPLES, HYPOTHESES>>;

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

/// What is asked of either planner.
trait Asked {
    fn plan(&mut self, pose: planner_core::Pose) -> Plan;
    fn observe(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
    ) -> Result<(), Refused>;
    fn centre(&self) -> Option<Line>;
    fn bits(&self) -> f64;
}

impl<B: Foresight> Asked for Lookahead<Unicycle, B> {
    fn plan(&mut self, pose: planner_core::Pose) -> Plan {
        planner_core::Planner::plan(self, pose)
    }

    fn observe(
        &mut self,
        pose: planner_core::Pose,
        reading: Option<planner_core::Reading>,
    ) -> Result<(), Refused> {
        planner_core::Planner::observe(self, pose, reading)
    }

    fn centre(&self) -> Option<Line> {
        self.estimates().centre.map(|it| planner_core::Line::from(it).into())
    }

    fn bits(&self) -> f64 {
        self.belief().information()
    }
}

/// What a pointer leads to; `None` if it is null.
///
/// # Safety
/// It must be null or what [`begin`] wrote, and nobody else may use that meanwhile.
unsafe fn asked<'a>(finder: *mut Finder) -> Option<&'a mut dyn Asked> {
    if finder.is_null() {
        return None;
    }
    // SAFETY: only `begin` makes a finder, and it writes after it the planner of its kind.
    unsafe {
        Some(match (*finder).kind {
            Kind::True => &mut (*finder.cast::<Held<True>>()).planner,
            Kind::Doubtful => &mut (*finder.cast::<Held<Doubtful>>()).planner,
        })
    }
}

/// How much memory the planner of a mission takes, bytes; 0 if there is no such mission.
#[unsafe(export_name = "planner_bytes")]
pub extern "C" fn bytes(mission: Option<&Mission>) -> usize {
    match mission.map(Mission::noise) {
        Some(Ok(None)) => size_of::<Held<True>>(),
        Some(Ok(Some(_))) => size_of::<Held<Doubtful>>(),
        _ => 0,
    }
}

/// Makes a planner in so many bytes of memory that is aligned to 8, from 3 to 16 given samples of both labels, and
/// writes where it is. It is that memory's beginning: there is nothing to free. A call that is refused writes nothing:
/// a planner that is in that memory stays as it was.
///
/// # Safety
/// `memory` must be null or writable for so many bytes, `given` null or readable for so many samples, and none of them
/// in that memory.
#[unsafe(export_name = "planner_begin")]
pub unsafe extern "C" fn begin(
    made: Option<&mut MaybeUninit<*mut Finder>>,
    memory: *mut c_void,
    bytes: usize,
    mission: Option<&Mission>,
    given: *const Sample,
    count: usize,
) -> Status {
    let (Some(made), Some(mission)) = (made, mission) else { return Status::Memory };
    if given.is_null() || !given.is_aligned() {
        return Status::Memory;
    }
    if count > MOST_GIVEN {
        return Status::Given;
    }
    // SAFETY: the caller promises so many samples.
    let given = unsafe { core::slice::from_raw_parts(given, count) };
    // SAFETY: the caller promises so much memory.
    match unsafe { begin_in(memory, bytes, mission, given) } {
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
    mission: &Mission,
    given: &[Sample],
) -> Result<*mut Finder, Status> {
    let mut samples = [planner_core::Sample {
        site: planner_core::Site::ORIGIN,
        label: planner_core::Label::Negative,
    }; MOST_GIVEN];
    for (place, sample) in samples.iter_mut().zip(given) {
        *place = sample.read()?;
    }
    let samples = samples.get(..given.len()).ok_or(Status::Given)?;
    let (config, unicycle, goal) = (mission.config()?, mission.unicycle()?, mission.goal()?);
    let noise = mission.noise()?;
    let needed =
        if noise.is_none() { size_of::<Held<True>>() } else { size_of::<Held<Doubtful>>() };
    let is_room = !memory.is_null() && bytes >= needed && memory.addr().is_multiple_of(8);
    if !is_room {
        return Err(Status::Memory);
    }
    const { assert!(align_of::<Held<True>>() <= 8 && align_of::<Held<Doubtful>>() <= 8) };
    // SAFETY (of both writes): there is room, and it is aligned.
    if let Some(noise) = noise {
        // What is in that memory stays if the samples are refused: a table with room for them alone tells.
        let table = Hypotheses::<MOST_GIVEN, 1>::new(samples, Prior::Area, noise);
        table.map_err(|_| Status::Given)?;
        let planner = Lookahead::new(config, unicycle, Forecast::NONE);
        let planner = planner.map_err(|_| Status::ToleranceTooLarge)?.until(goal);
        let held = Held { finder: Finder { kind: Kind::Doubtful }, planner };
        let place = memory.cast::<Held<Doubtful>>();
        unsafe { place.write(held) };
        // In place: it is large. SAFETY: it has just been written.
        let forecast = unsafe { &mut *place }.planner.foresight();
        forecast.restart(samples, Prior::Area, noise).map_err(|_| Status::Given)?;
    } else {
        let space = VersionSpace::new(samples).and_then(|it| it.within(config.tolerance));
        let space = space.map_err(|_| Status::Given)?;
        let planner = Lookahead::new(config, unicycle, space);
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
    match finder.plan(pose) {
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
    let Some(finder) = (unsafe { asked(finder) }) else { return Status::Memory };
    let (pose, reading) = match (pose.read(), Reading::read(reading)) {
        (Ok(pose), Ok(reading)) => (pose, reading),
        (Err(status), _) | (_, Err(status)) => return status,
    };
    match finder.observe(pose, reading) {
        Ok(()) => Status::Ok,
        Err(Refused::Full(_)) => Status::Full,
        Err(_) => Status::Contradiction,
    }
}

/// The line as far as it is known: the mean of all lines that are left, or in noise of their distribution.
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
    let Some(centre) = finder.centre() else { return Status::Resolution };
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
    unsafe { asked(finder) }.map_or(f64::NAN, |finder| finder.bits())
}
