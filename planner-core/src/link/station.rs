//! The chip's side of a mission: it is asked for over a link, planned here, and driven elsewhere.

use core::cell::Cell;

use crate::belief::estimate::Estimates;
use crate::belief::hypotheses::{Hypotheses, Prior};
use crate::belief::sample::Reading;
use crate::belief::version_space::{Refused, VersionSpace};
use crate::link::delivery::{Link, LinkLost, Port};
use crate::link::message::{
    Accepted, ClockRate, Declined, End, EndReason, LabelSource, Move, PROTOCOL, Reply, Request,
    Room, Setup, Took,
};
use crate::motion::dynamics::Pose;
use crate::motion::unicycle::Unicycle;
use crate::planner::cfc::Cfc;
use crate::planner::scc::{Noise, Policy, Scc};
use crate::planner::{Motion, Plan, Planner};
use crate::robot::agent::{Agent, AgentError, Event, Step};
use crate::robot::hal::{Drive, LabelSensor};

/// A planner that was made for a setup.
#[derive(Clone, Debug)]
pub struct Prepared<L> {
    planner: L,
    room: Room,
}

impl<L> Prepared<L> {
    /// The planner.
    pub const fn planner(&mut self) -> &mut L {
        &mut self.planner
    }
}

impl Setup {
    /// Whether this much room will do for the mission, in the protocol spoken here.
    fn check(&self, room: Room) -> Result<(), Declined> {
        if self.protocol != PROTOCOL {
            return Err(Declined::Protocol(PROTOCOL));
        }
        if room.samples < self.room.samples || room.hypotheses < self.room.hypotheses {
            return Err(Declined::Room(room));
        }
        Ok(())
    }

    /// Algorithm 1 for this mission, with the paper's unicycle.
    ///
    /// # Errors
    /// [`Declined`].
    #[inline(never)] // it is the planner's, see `seam`
    pub fn cfc<const N: usize>(&self) -> Result<Prepared<Cfc<Unicycle, N>>, Declined> {
        let room = Room { samples: N as u16, hypotheses: 1 };
        self.check(room)?;
        let space = VersionSpace::new(&self.given).map_err(Declined::Given)?;
        Ok(Prepared { planner: Cfc::new(self.config, Unicycle::paper(), space), room })
    }

    /// Algorithm 2 for this mission, with the paper's unicycle and none of its samples yet: the memory
    /// for [`prepare`](Self::prepare).
    pub fn scc<const N: usize, const H: usize>(
        &self,
        noise: Noise,
        policy: Policy,
    ) -> Scc<Unicycle, N, H> {
        Scc::new(self.config, noise, policy, Unicycle::paper(), Hypotheses::NONE)
    }

    /// Begins the mission in this memory, so that there is never a second planner beside it.
    ///
    /// # Errors
    /// [`Declined`].
    #[inline(never)] // it is the planner's, see `seam`
    pub fn prepare<'a, const N: usize, const H: usize>(
        &self,
        planner: &'a mut Scc<Unicycle, N, H>,
        prior: Prior,
    ) -> Result<Prepared<&'a mut Scc<Unicycle, N, H>>, Declined> {
        let room = Room { samples: N as u16, hypotheses: H as u16 };
        self.check(room)?;
        planner.restart(&self.given, prior).map_err(Declined::Given)?;
        Ok(Prepared { planner, room })
    }
}

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

/// What became of a setup.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Flown {
    /// It was declined.
    Declined(Declined),
    /// A mission was flown.
    Ended(End),
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

    /// Flies the mission of a setup with the planner that was made for it, in place: planners are large.
    /// `watch` sees every step.
    ///
    /// # Errors
    /// [`LinkLost`]: the vehicle has been asked for nothing since, and is asked for nothing more.
    pub fn fly<L: Planner>(
        &mut self,
        setup: &Setup,
        prepared: &mut Result<Prepared<L>, Declined>,
        watch: impl FnMut(&Step),
    ) -> Result<Flown, LinkLost> {
        let blind = setup.labels == LabelSource::Chip && self.sensor.is_none();
        let Prepared { planner, room } = match prepared {
            Ok(prepared) if !blind => prepared,
            declined => {
                let declined = declined.as_ref().err().copied().unwrap_or(Declined::Labels);
                self.link.ask(Request::Declined(declined))?;
                return Ok(Flown::Declined(declined));
            }
        };
        self.link.ask(Request::Ready(Accepted { room: *room, clock: self.clock }))?;
        let memo = Memo::default();
        let planner = Timed { planner, ticks: self.ticks, memo: &memo };
        let chip = self.sensor.as_mut().filter(|_| setup.labels == LabelSource::Chip);
        let sensor = Labels { chip, memo: &memo };
        let vehicle = Vehicle { link: &mut self.link, memo: &memo };
        let mut agent = Agent::new(planner, sensor, vehicle, setup.start);
        let reason = mission(&mut agent, setup.steps, watch)?;
        let estimates = agent.planner.estimates();
        let (last, took) = (memo.taken.get(), memo.took.get());
        let end = End { reason, last, took, estimates };
        self.link.ask(Request::End(end.clone()))?;
        Ok(Flown::Ended(end))
    }
}

fn mission<L: Planner, S: LabelSensor, P: Port>(
    agent: &mut Agent<L, Labels<'_, S>, Vehicle<'_, P>>,
    steps: u16,
    mut watch: impl FnMut(&Step),
) -> Result<EndReason, LinkLost> {
    for _ in 0..steps {
        match agent.step() {
            Ok(Event::Step(step)) => watch(&step),
            Ok(Event::Stopped(reason)) => return Ok(EndReason::Stopped(reason)),
            Err(AgentError::Refused(refused)) => return Ok(EndReason::Refused(refused)),
            Err(AgentError::Sensor(NoLabel)) => return Ok(EndReason::Sensor),
            Err(AgentError::Drive(NoMotion::Lost(lost))) => return Err(lost),
            Err(AgentError::Drive(NoMotion::Failed)) => return Ok(EndReason::Vehicle),
        }
    }
    Ok(EndReason::Steps)
}

/// What planner, sensor and vehicle leave for each other.
#[derive(Default)]
struct Memo {
    /// The reading that came with the vehicle's last reply.
    arrived: Cell<Option<Reading>>,
    /// The reading that the planner was last given.
    taken: Cell<Option<Reading>>,
    took: Cell<Took>,
}

/// A planner against the clock.
struct Timed<'a, L> {
    planner: &'a mut L,
    ticks: fn() -> u32,
    memo: &'a Memo,
}

impl<L: Planner> Planner for Timed<'_, L> {
    fn plan(&mut self, pose: Pose) -> Plan {
        let before = (self.ticks)();
        let plan = seam::plan(self.planner, pose);
        let took = (self.ticks)().wrapping_sub(before);
        self.memo.took.set(Took { plan: took, ..self.memo.took.get() });
        plan
    }

    fn observe(&mut self, pose: Pose, reading: Option<Reading>) -> Result<(), Refused> {
        self.memo.taken.set(reading);
        let before = (self.ticks)();
        let observed = seam::observe(self.planner, pose, reading);
        let took = (self.ticks)().wrapping_sub(before);
        self.memo.took.set(Took { observe: took, ..self.memo.took.get() });
        observed
    }

    fn estimates(&self) -> Estimates {
        let before = (self.ticks)();
        let estimates = seam::estimates(self.planner);
        let took = (self.ticks)().wrapping_sub(before);
        self.memo.took.set(Took { estimate: took, ..self.memo.took.get() });
        estimates
    }
}

/// Where the planner begins. Functions of their own also in an optimised program, so that its size, its
/// stack and its instructions can be told from those of the link.
mod seam {
    use super::{Estimates, Plan, Planner, Pose, Reading, Refused};

    #[inline(never)]
    pub(super) fn plan<L: Planner>(planner: &mut L, pose: Pose) -> Plan {
        planner.plan(pose)
    }

    #[inline(never)]
    pub(super) fn observe<L: Planner>(
        planner: &mut L,
        pose: Pose,
        reading: Option<Reading>,
    ) -> Result<(), Refused> {
        planner.observe(pose, reading)
    }

    #[inline(never)]
    pub(super) fn estimates<L: Planner>(planner: &L) -> Estimates {
        planner.estimates()
    }
}

/// The vehicle at the other end of the link.
struct Vehicle<'a, P> {
    link: &'a mut Link<P>,
    memo: &'a Memo,
}

#[derive(Debug)]
enum NoMotion {
    Lost(LinkLost),
    /// The vehicle says so, or answers something that is no answer.
    Failed,
}

impl<P: Port> Drive for Vehicle<'_, P> {
    type Error = NoMotion;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, NoMotion> {
        let (last, took) = (self.memo.taken.get(), self.memo.took.get());
        match self.link.ask(Request::Move(Move { motion: *motion, last, took })) {
            Ok(Reply::Arrived { pose, reading }) => {
                self.memo.arrived.set(reading);
                Ok(pose)
            }
            Ok(_) => Err(NoMotion::Failed),
            Err(lost) => Err(NoMotion::Lost(lost)),
        }
    }
}

/// Labels from the chip's sensor, or else from the vehicle's reply.
struct Labels<'a, S> {
    chip: Option<&'a mut S>,
    memo: &'a Memo,
}

#[derive(Debug)]
struct NoLabel;

impl<S: LabelSensor> LabelSensor for Labels<'_, S> {
    type Error = NoLabel;

    fn read(&mut self) -> Result<Reading, NoLabel> {
        match &mut self.chip {
            Some(sensor) => sensor.read().map_err(|_| NoLabel),
            None => self.memo.arrived.get().ok_or(NoLabel),
        }
    }
}
