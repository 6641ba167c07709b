//! A mission that is planned here and driven elsewhere.

use crate::belief::estimate::Estimates;
use crate::belief::evidence::Alarm;
use crate::belief::sample::Reading;
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::lattice::Site;
use crate::link::delivery::{Link, LinkError, Port};
use crate::link::message::{
    Accepted, ClockRate, DeclinedError, EndReason, LabelSource, MissionEnd, Move, PROTOCOL, Reply,
    Request, Setup, Took,
};
use crate::link::station::seam::{self, Prepared};
use crate::link::station::terms::{FromOutlines, KnownDynamics, NoTerms, PlannerSetup};
use crate::motion::dynamics::Pose;
use crate::planner::{Motion, Plan, Planner};
use crate::robot::{Body, Hearing, LabelSensor, Step};

/// A chip at a link: what a mission needs beside its planner.
#[derive(Debug)]
pub struct Station<P, S> {
    /// The link to the vehicle.
    pub link: Link<P>,
    /// The chip's own label sensor, if it has one.
    pub sensor: Option<S>,
    /// Ticks that run freely and wrap.
    pub ticks: fn() -> u32,
    /// What these are.
    pub clock: ClockRate,
}

/// What a chip does beside planning: it enables its drive, or writes a log. It may do nothing: `()`.
pub trait Watch {
    /// Whether steps report what speaks against a straight, still line ([`Step::alarm`]). Planners are then
    /// [`Watched`](crate::watch::Watched), which takes some 2 KB of flash on a core with single-precision instructions.
    const ALARMS: bool = false;

    /// Whether labels that a vehicle reads on the way are taken in. A chip without this has no code for them: its mission
    /// ends with [`EndReason::Vehicle`] at the first.
    const READINGS: bool = false;

    /// A mission was set up.
    fn set_up(&mut self, _: &Setup) {}

    /// It begins: from now on the drive is needed.
    fn begins(&mut self) {}

    /// A step of it was made.
    fn stepped(&mut self, _: &Step) {}

    /// It is over, or was never flown: the drive is not needed.
    fn over(&mut self, _: &Result<Flown, LinkError>) {}
}

impl Watch for () {}

/// What became of a setup.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Flown {
    /// It was declined.
    Declined(DeclinedError),
    /// A mission was flown.
    Ended(MissionEnd),
}

impl<P: Port, S: LabelSensor> Station<P, S> {
    /// Asks for a mission until someone sets it up. Without a bound: the chip has nothing else to do
    /// and moves nothing.
    pub fn await_setup(&mut self) -> Setup {
        loop {
            if let Ok(Reply::Setup(setup)) = self.link.ask(Request::Hello { protocol: PROTOCOL }) {
                return setup;
            }
        }
    }

    /// What to plan with and where, of what the chip has: [`AnyVehicle`](crate::motion::any_vehicle::AnyVehicle) or the
    /// [`Unicycle`](crate::motion::unicycle::Unicycle) alone, in a [`MissionArea`](crate::link::message::MissionArea) or in
    /// an [`Area`](crate::geometry::area::Area) alone, or in `Charts`, whose cells come
    /// into the room. If this refuses a setup, no planner exists for it, so pass the refusal to [`give_up`](Self::give_up).
    ///
    /// # Errors
    /// [`NoTerms`].
    pub fn terms<'a, D: KnownDynamics, G: FromOutlines>(
        &mut self,
        setup: &Setup,
        room: &'a mut G::Room,
    ) -> Result<PlannerSetup<D, G::Ground<'a>>, NoTerms> {
        let area = G::of(setup, &mut self.link, room)?;
        Ok(setup.terms(area)?)
    }

    /// Asks for another setup, unless the link is lost.
    ///
    /// # Errors
    /// [`LinkError`].
    pub fn give_up(&mut self, none: NoTerms) -> Result<Flown, LinkError> {
        match none {
            NoTerms::Declined(declined) => self.decline(declined),
            NoTerms::Lost(lost) => Err(lost),
        }
    }

    /// Asks for another setup.
    ///
    /// # Errors
    /// [`LinkError`].
    pub fn decline(&mut self, declined: DeclinedError) -> Result<Flown, LinkError> {
        self.link.ask(Request::Declined(declined))?;
        Ok(Flown::Declined(declined))
    }

    /// Flies the mission of a setup with the planner that was made for it, in place: planners are large.
    /// `watch` sees the beginning and every step.
    ///
    /// # Errors
    /// [`LinkError`]. The chip has sent no request since, and sends no more.
    pub fn fly<L: Planner>(
        &mut self,
        setup: &Setup,
        prepared: &mut Result<Prepared<L>, DeclinedError>,
        watch: &mut impl Watch,
    ) -> Result<Flown, LinkError> {
        self.fly_estimating(setup, prepared, watch, L::Belief::estimates)
    }

    /// The same with other estimates at the end: a program carries the code of these alone.
    pub(super) fn fly_estimating<L: Planner>(
        &mut self,
        setup: &Setup,
        prepared: &mut Result<Prepared<L>, DeclinedError>,
        watch: &mut impl Watch,
        estimates: impl Fn(&L::Belief) -> Estimates,
    ) -> Result<Flown, LinkError> {
        let blind = setup.labels == LabelSource::Chip && self.sensor.is_none();
        let Prepared { planner, capacity } = match prepared {
            Ok(prepared) if !blind => prepared,
            declined => {
                return self
                    .decline(declined.as_ref().err().copied().unwrap_or(DeclinedError::Labels));
            }
        };
        watch.begins();
        self.link.ask(Request::Ready(Accepted { capacity: *capacity, clock: self.clock }))?;
        let chip = self.sensor.as_mut().filter(|_| setup.labels == LabelSource::Chip);
        let mut vehicle = RemoteVehicle {
            link: &mut self.link,
            chip,
            last: None,
            passed: None,
            is_blind: false,
            took: Took::default(),
        };
        let reason = mission(planner, &mut vehicle, setup, self.ticks, watch)?;
        let RemoteVehicle { last, mut took, .. } = vehicle;
        let estimates =
            timed(self.ticks, &mut took.estimate, || seam::estimates(planner, estimates));
        let end = MissionEnd { reason, last, took, estimates };
        self.link.ask(Request::End(end.clone()))?;
        Ok(Flown::Ended(end))
    }
}

/// As [`Agent`](crate::robot::Agent), against the clock: the vehicle is told what each call took.
fn mission<L: Planner, P: Port, S: LabelSensor, W: Watch>(
    planner: &mut L,
    vehicle: &mut RemoteVehicle<'_, P, S>,
    setup: &Setup,
    ticks: fn() -> u32,
    watch: &mut W,
) -> Result<EndReason, LinkError> {
    let (mut pose, mut labels) = (setup.start, 0);
    for _ in 0..setup.steps {
        if setup.most_labels.is_some_and(|most| labels >= most) {
            return Ok(EndReason::Labels);
        }
        let motion = match timed(ticks, &mut vehicle.took.plan, || seam::plan(planner, pose)) {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => return Ok(EndReason::Stopped(reason)),
        };
        let before = planner.alarm();
        let (performed, refused) = perform::<W, _, _, _>(planner, vehicle, &motion, &mut pose);
        let reading = match performed {
            Ok(reading) => reading,
            Err(NoArrival::Lost(lost)) => return Err(lost),
            Err(NoArrival::Failed) => return Ok(EndReason::Vehicle),
            Err(NoArrival::NoLabel) => return Ok(EndReason::Sensor),
        };
        if let Some(refused) = refused {
            return Ok(EndReason::Refused(refused));
        }
        labels += u16::from(reading.is_some());
        let observe = || seam::observe(planner, pose, reading);
        if let Err(refused) = timed(ticks, &mut vehicle.took.observe, observe) {
            return Ok(EndReason::Refused(refused));
        }
        let alarm = Alarm::risen(before, planner.alarm());
        watch.stepped(&Step { motion, pose, reading, alarm });
        if let Some(front) = planner.front() {
            vehicle.link.ask(Request::Front(front))?;
        }
    }
    Ok(EndReason::Steps)
}

/// Has the vehicle make a motion. Returns what was sensed at its end, and why a label on its way was refused, if one was.
#[inline]
fn perform<W: Watch, L: Planner, P: Port, S: LabelSensor>(
    planner: &mut L,
    vehicle: &mut RemoteVehicle<'_, P, S>,
    motion: &Motion,
    pose: &mut Pose,
) -> (Result<Option<Reading>, NoArrival>, Option<ObservationError>) {
    if !W::READINGS {
        return (vehicle.perform(motion, pose), None);
    }
    let mut hearing = Hearing::of(planner);
    let mut is_under_way = false;
    let performed = loop {
        match vehicle.advance(motion, pose, is_under_way) {
            Ok(Advance::OnTheWay(site, reading)) => {
                if let Some(reading) = reading {
                    seam::observe_on_the_way(&mut hearing, site, reading);
                }
                is_under_way = true;
            }
            Ok(Advance::Ended(reading)) => break Ok(reading),
            Err(none) => break Err(none),
        }
    };
    (performed, hearing.refused)
}

/// Does something, and takes down the ticks that it took.
fn timed<T>(ticks: fn() -> u32, took: &mut u32, does: impl FnOnce() -> T) -> T {
    let before = ticks();
    let done = does();
    *took = ticks().wrapping_sub(before);
    done
}

/// The vehicle at the other end of the link.
struct RemoteVehicle<'a, P, S> {
    link: &'a mut Link<P>,
    /// The chip's own sensor, if labels come from there.
    chip: Option<&'a mut S>,
    /// The last reading, if the last motion wanted one.
    last: Option<Reading>,
    /// What was read last on the way of the motion.
    passed: Option<Reading>,
    /// Whether the chip's own sensor has failed there.
    is_blind: bool,
    /// What the last plan and the last observation took.
    took: Took,
}

/// Why a motion has no end that is known.
enum NoArrival {
    Lost(LinkError),
    /// The vehicle says so, or answers something that is no answer.
    Failed,
    /// It was made, and nothing was sensed.
    NoLabel,
}

/// How far a motion has come.
enum Advance {
    /// To a place on its way, and what was read there, if anything was.
    OnTheWay(Site, Option<Reading>),
    /// To its end.
    Ended(Option<Reading>),
}

/// What the vehicle says of a motion: where it is, and what it has read there.
enum Answer {
    OnTheWay(Site, Option<Reading>),
    Arrived(Pose, Option<Reading>),
}

impl<P: Port, S: LabelSensor> Body for RemoteVehicle<'_, P, S> {
    type Error = NoArrival;

    #[inline]
    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, NoArrival> {
        let answer = self.begin(motion)?;
        self.end(motion, pose, &answer)
    }
}

impl<P: Port, S: LabelSensor> RemoteVehicle<'_, P, S> {
    /// Makes the next part of a motion: up to a label on its way, or up to its end. If a sensor of the chip's fails on the
    /// way, the mission ends when the motion has ended.
    ///
    /// Labels go to the planner without a function pointer, so that tools can bound the stack.
    #[inline(never)]
    fn advance(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        is_under_way: bool,
    ) -> Result<Advance, NoArrival> {
        let answer = if is_under_way {
            self.ask(Request::Onward { last: self.passed })?
        } else {
            self.begin(motion)?
        };
        match (answer, &mut self.chip) {
            (Answer::OnTheWay(site, told), chip) => {
                self.passed = match (told, chip) {
                    (None, Some(sensor)) => {
                        let read = sensor.read().ok();
                        self.is_blind |= read.is_none();
                        read
                    }
                    _ => told,
                };
                Ok(Advance::OnTheWay(site, self.passed))
            }
            (Answer::Arrived(..), _) if self.is_blind => Err(NoArrival::NoLabel),
            (answer, _) => self.end(motion, pose, &answer).map(Advance::Ended),
        }
    }

    fn ask(&mut self, request: Request) -> Result<Answer, NoArrival> {
        match self.link.ask(request) {
            Ok(Reply::Arrived { pose, reading }) => Ok(Answer::Arrived(pose, reading)),
            Ok(Reply::OnTheWay { site, reading }) => Ok(Answer::OnTheWay(site, reading)),
            Ok(_) => Err(NoArrival::Failed),
            Err(lost) => Err(NoArrival::Lost(lost)),
        }
    }

    /// Asks for a motion.
    fn begin(&mut self, motion: &Motion) -> Result<Answer, NoArrival> {
        let took = self.took;
        // What comes of this motion takes its place: nothing, if it has no end or no label.
        let last = self.last.take();
        self.ask(Request::Move(Move { motion: *motion, last, took }))
    }

    /// What an answer says of a motion's end.
    fn end(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        answer: &Answer,
    ) -> Result<Option<Reading>, NoArrival> {
        let &Answer::Arrived(arrived, reading) = answer else { return Err(NoArrival::Failed) };
        *pose = arrived;
        let label = match (reading, &mut self.chip) {
            _ if !motion.wants_label => None,
            // Of a motion that is told again this is what the chip's own sensor read then.
            (Some(reading), _) => Some(reading),
            (None, Some(sensor)) => Some(sensor.read().map_err(|_| NoArrival::NoLabel)?),
            (None, None) => return Err(NoArrival::NoLabel),
        };
        self.last = label;
        Ok(label)
    }
}
