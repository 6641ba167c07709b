//! The chip's side of a mission: a mission comes over a link, is planned here, and is driven elsewhere.

use heapless::Vec;

use crate::belief::ObservationError;
use crate::belief::doubtful_labels::CellPosterior;
use crate::belief::estimate::Estimates;
use crate::belief::goal::{Accuracy, Criterion, Goal};
use crate::belief::noise::Noise;
use crate::belief::predictions::NoisyBelief;
use crate::belief::sample::{Reading, Sample};
use crate::belief::true_labels::{GivenError, VersionSpace};
use crate::belief::weight::Prior;
use crate::geometry::area::Area;
use crate::geometry::polygon_area::KeepOut;
use crate::geometry::workspace::Workspace;
use crate::link::delivery::{Link, LinkError, Port};
use crate::link::message::{
    Accepted, Capacity, ClockRate, DeclinedError, EndReason, LabelSource, MOST_CORNERS,
    MOST_KEEP_OUTS, MissionArea, MissionEnd, Move, PROTOCOL, Reply, Request, Setup, Took,
};
use crate::motion::any_vehicle::{Shape, ShapeError};
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::cfc::Cfc;
use crate::planner::lookahead::Lookahead;
use crate::planner::options::Options;
use crate::planner::scc::{Policy, Scc};
use crate::planner::setup::{SetupError, aimed_for};
use crate::planner::{Motion, Plan, Planner};
use crate::robot::Body;
use crate::robot::LabelSensor;
use crate::robot::Step;

/// A planner that was made for a setup.
#[derive(Clone, Debug)]
pub struct Prepared<L> {
    planner: L,
    capacity: Capacity,
}

impl<L> Prepared<L> {
    /// The planner.
    pub const fn planner_mut(&mut self) -> &mut L {
        &mut self.planner
    }

    /// The planner, as another planner that is made of it.
    pub fn wrapped<'a, M>(&'a mut self, wrap: impl FnOnce(&'a mut L) -> M) -> Prepared<M> {
        Prepared { planner: wrap(&mut self.planner), capacity: self.capacity }
    }
}

impl Setup {
    /// What to plan with, of the vehicles that the chip has, in an area: see [`Station::terms`].
    ///
    /// # Errors
    /// [`DeclinedError`].
    pub fn terms<D: Known, G: Workspace>(
        &self,
        area: G,
    ) -> Result<PlannerSetup<D, G>, DeclinedError> {
        if self.protocol != PROTOCOL {
            return Err(DeclinedError::Protocol(PROTOCOL));
        }
        let dynamics = D::try_from(self.vehicle).map_err(DeclinedError::Vehicle)?;
        let area = aimed_for(area, &dynamics, self.config.tolerance).map_err(declined)?;
        Ok(PlannerSetup { dynamics, area, options: self.config.options() })
    }

    /// Whether this much will do for the mission.
    fn check(&self, capacity: Capacity) -> Result<(), DeclinedError> {
        if capacity.samples < self.capacity.samples
            || capacity.hypotheses < self.capacity.hypotheses
        {
            return Err(DeclinedError::Capacity(capacity));
        }
        Ok(())
    }

    /// What its given samples leave.
    fn space<const N: usize>(&self) -> Result<VersionSpace<N>, DeclinedError> {
        let space = VersionSpace::new(&self.given);
        let tolerance = self.config.tolerance;
        space.and_then(|space| space.with_tolerance(tolerance)).map_err(DeclinedError::Given)
    }

    /// Algorithm 1 for this mission.
    ///
    /// # Errors
    /// [`DeclinedError`].
    #[inline(never)] // it is the planner's, see `seam`
    pub fn cfc<D: Dynamics, G: Workspace, const N: usize>(
        &self,
        PlannerSetup { dynamics, area, options }: PlannerSetup<D, G>,
    ) -> Result<Prepared<Cfc<D, N, G>>, DeclinedError> {
        let capacity = Capacity { samples: N as u16, hypotheses: 1 };
        self.check(capacity)?;
        let space = self.space()?;
        Ok(Prepared { planner: Cfc::of((area, dynamics), space, options), capacity })
    }

    /// Look-ahead for this mission, with labels that are true, and for goals of a criterion: those that the chip has
    /// the code of.
    ///
    /// # Errors
    /// [`DeclinedError`].
    #[inline(never)] // it is the planner's, see `seam`
    pub fn lookahead<D: Dynamics, G: Workspace, C: Criterion, const N: usize>(
        &self,
        PlannerSetup { dynamics, area, options }: PlannerSetup<D, G>,
        evaluations: u32,
        goal: Option<Goal>,
    ) -> Result<Prepared<Lookahead<D, VersionSpace<N>, G, C>>, DeclinedError> {
        let goal = goal.map(|goal| Goal::of(goal).ok_or(DeclinedError::Goal)).transpose()?;
        let capacity = Capacity { samples: N as u16, hypotheses: 1 };
        self.check(capacity)?;
        let space = self.space()?;
        let price = options.weight.into();
        let planner = Lookahead::of((area, dynamics), space, price, evaluations, goal);
        Ok(Prepared { planner, capacity })
    }

    /// Algorithm 2 for this mission, with none of its samples yet: the memory for [`prepare`](Self::prepare).
    pub fn scc<D: Dynamics, G: Workspace, const N: usize, const H: usize>(
        &self,
        PlannerSetup { dynamics, area, options }: PlannerSetup<D, G>,
        policy: Policy,
    ) -> Scc<D, N, H, G> {
        Scc::of((area, dynamics), CellPosterior::NONE, options, policy)
    }

    /// Look-ahead with labels that may be wrong, with none of its samples yet: the memory for
    /// [`prepare`](Self::prepare).
    pub fn lookahead_in_noise<D: Dynamics, G: Workspace, const N: usize, const H: usize>(
        &self,
        PlannerSetup { dynamics, area, options }: PlannerSetup<D, G>,
        evaluations: u32,
        goal: Option<Goal>,
    ) -> Lookahead<D, NoisyBelief<N, H>, G, Accuracy> {
        Lookahead::of((area, dynamics), NoisyBelief::NONE, options.weight.into(), evaluations, goal)
    }

    /// Begins the mission in this memory, so that there is never a second planner beside it.
    ///
    /// # Errors
    /// [`DeclinedError`].
    #[inline(never)] // it is the planner's, see `seam`
    pub fn prepare<'a, R: Restart>(
        &self,
        planner: &'a mut R,
        prior: Prior,
        noise: Noise,
    ) -> Result<Prepared<&'a mut R>, DeclinedError> {
        let capacity = R::CAPACITY;
        self.check(capacity)?;
        planner.restart(&self.given, prior, noise).map_err(declined)?;
        Ok(Prepared { planner, capacity })
    }
}

/// What to plan with, and where.
#[derive(Clone, Copy, Debug)]
pub struct PlannerSetup<D, G> {
    /// How the vehicle moves.
    pub dynamics: D,
    /// The part of the area that motions aim for: all but the margin of the tolerance.
    pub area: G,
    /// What Algorithms 1 and 2 leave open. Its weight is look-ahead's price.
    pub options: Options,
}

/// Why a setup is declined if no planner can be made of it.
fn declined(error: SetupError) -> DeclinedError {
    match error {
        SetupError::Tolerance(_) => DeclinedError::Tolerance,
        SetupError::Room(none) => DeclinedError::Vehicle(ShapeError::Room(none)),
        SetupError::Given(why) => DeclinedError::Given(why),
        SetupError::Full => DeclinedError::Given(GivenError::TooMany),
    }
}

/// Why there is no [`PlannerSetup`] for a mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NoTerms {
    /// The setup is not accepted.
    Declined(DeclinedError),
    /// There was no reply.
    Lost(LinkError),
}

impl From<LinkError> for NoTerms {
    fn from(lost: LinkError) -> Self {
        Self::Lost(lost)
    }
}

impl From<DeclinedError> for NoTerms {
    fn from(declined: DeclinedError) -> Self {
        Self::Declined(declined)
    }
}

/// Areas that a chip can plan in, of all that a setup can ask for.
pub trait FromOutlines: Workspace {
    /// The area of a setup, whose outlines can be asked for.
    ///
    /// # Errors
    /// [`NoTerms`].
    fn of<P: Port>(setup: &Setup, link: &mut Link<P>) -> Result<Self, NoTerms>;
}

impl FromOutlines for Area {
    fn of<P: Port>(setup: &Setup, _: &mut Link<P>) -> Result<Self, NoTerms> {
        let is_plain = setup.keep_outs.is_none();
        if is_plain { Ok(setup.config.area) } else { Err(DeclinedError::Area.into()) }
    }
}

impl FromOutlines for MissionArea {
    fn of<P: Port>(setup: &Setup, link: &mut Link<P>) -> Result<Self, NoTerms> {
        let Some(count) = setup.keep_outs else { return Ok(setup.config.area.into()) };
        let mut ask = |number| match link.ask(Request::Outline(number))? {
            Reply::Outline(outline) => {
                KeepOut::try_from(outline).map_err(|_| DeclinedError::Area.into())
            }
            _ => Err(NoTerms::from(DeclinedError::Area)),
        };
        let border = ask(0)?;
        let mut keep_outs: Vec<KeepOut<MOST_CORNERS>, MOST_KEEP_OUTS, u8> = Vec::new();
        for number in 1..=count {
            keep_outs.push(ask(number)?).map_err(|_| DeclinedError::Area)?;
        }
        let area = Self::new(border.hull, &keep_outs).map_err(|_| DeclinedError::Area)?;
        let is_it = area.bounds() == setup.config.area && border.radius == 0;
        if is_it { Ok(area) } else { Err(DeclinedError::Area.into()) }
    }
}

/// Dynamics that a chip has, of all that a setup can ask for.
pub trait Known: Dynamics + TryFrom<Shape, Error = ShapeError> {}

impl<D: Dynamics + TryFrom<Shape, Error = ShapeError>> Known for D {}

/// A planner that is too large to be made elsewhere and moved. It begins a mission in the memory where it is.
pub trait Restart: Planner {
    /// What it has room for.
    const CAPACITY: Capacity;

    /// Begins again with what given samples leave.
    ///
    /// # Errors
    /// [`SetupError`], with the planner as it was.
    fn restart(&mut self, given: &[Sample], prior: Prior, noise: Noise) -> Result<(), SetupError>;
}

impl<D: Dynamics, G: Workspace, const N: usize, const H: usize> Restart for Scc<D, N, H, G> {
    const CAPACITY: Capacity = Capacity { samples: N as u16, hypotheses: H as u16 };

    fn restart(&mut self, given: &[Sample], prior: Prior, noise: Noise) -> Result<(), SetupError> {
        self.restart(given, prior, noise)
    }
}

impl<D: Dynamics, G: Workspace, C: Criterion, const N: usize, const H: usize> Restart
    for Lookahead<D, NoisyBelief<N, H>, G, C>
{
    const CAPACITY: Capacity = Capacity { samples: N as u16, hypotheses: H as u16 };

    fn restart(&mut self, given: &[Sample], prior: Prior, noise: Noise) -> Result<(), SetupError> {
        self.restart(given, prior, noise)
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
    /// [`Unicycle`](crate::motion::unicycle::Unicycle) alone, in a [`MissionArea`] or in an [`Area`] alone. If this
    /// refuses a setup, no planner exists for it, so pass the refusal to [`give_up`](Self::give_up).
    ///
    /// # Errors
    /// [`NoTerms`].
    pub fn terms<D: Known, G: FromOutlines>(
        &mut self,
        setup: &Setup,
    ) -> Result<PlannerSetup<D, G>, NoTerms> {
        let area = G::of(setup, &mut self.link)?;
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
    /// `watch` sees every step.
    ///
    /// # Errors
    /// [`LinkError`]. The chip has sent no request since, and sends no more.
    pub fn fly<L: Planner>(
        &mut self,
        setup: &Setup,
        prepared: &mut Result<Prepared<L>, DeclinedError>,
        watch: impl FnMut(&Step),
    ) -> Result<Flown, LinkError> {
        let blind = setup.labels == LabelSource::Chip && self.sensor.is_none();
        let Prepared { planner, capacity } = match prepared {
            Ok(prepared) if !blind => prepared,
            declined => {
                return self
                    .decline(declined.as_ref().err().copied().unwrap_or(DeclinedError::Labels));
            }
        };
        self.link.ask(Request::Ready(Accepted { capacity: *capacity, clock: self.clock }))?;
        let chip = self.sensor.as_mut().filter(|_| setup.labels == LabelSource::Chip);
        let mut vehicle =
            RemoteVehicle { link: &mut self.link, chip, last: None, took: Took::default() };
        let reason = mission(planner, &mut vehicle, setup, self.ticks, watch)?;
        let RemoteVehicle { last, mut took, .. } = vehicle;
        let estimates = timed(self.ticks, &mut took.estimate, || seam::estimates(planner));
        let end = MissionEnd { reason, last, took, estimates };
        self.link.ask(Request::End(end.clone()))?;
        Ok(Flown::Ended(end))
    }
}

/// As [`Agent`](crate::robot::Agent), against the clock: the vehicle is told what each call took.
fn mission<L: Planner, P: Port, S: LabelSensor>(
    planner: &mut L,
    vehicle: &mut RemoteVehicle<'_, P, S>,
    setup: &Setup,
    ticks: fn() -> u32,
    mut watch: impl FnMut(&Step),
) -> Result<EndReason, LinkError> {
    let mut pose = setup.start;
    for _ in 0..setup.steps {
        let motion = match timed(ticks, &mut vehicle.took.plan, || seam::plan(planner, pose)) {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => return Ok(EndReason::Stopped(reason)),
        };
        let reading = match vehicle.perform(&motion, &mut pose) {
            Ok(reading) => reading,
            Err(NoArrival::Lost(lost)) => return Err(lost),
            Err(NoArrival::Failed) => return Ok(EndReason::Vehicle),
            Err(NoArrival::NoLabel) => return Ok(EndReason::Sensor),
        };
        let observe = || seam::observe(planner, pose, reading);
        if let Err(refused) = timed(ticks, &mut vehicle.took.observe, observe) {
            return Ok(EndReason::Refused(refused));
        }
        watch(&Step { motion, pose, reading });
    }
    Ok(EndReason::Steps)
}

/// Does something, and takes down the ticks that it took.
fn timed<T>(ticks: fn() -> u32, took: &mut u32, does: impl FnOnce() -> T) -> T {
    let before = ticks();
    let done = does();
    *took = ticks().wrapping_sub(before);
    done
}

/// The entries of the planner. They stay separate functions in an optimised program. So its size, stack and
/// instructions can be measured apart from those of the link.
mod seam {
    use super::{Estimates, ObservationError, Plan, Planner, Pose, Reading};

    #[inline(never)]
    pub(super) fn plan<L: Planner>(planner: &mut L, pose: Pose) -> Plan {
        planner.plan(pose)
    }

    #[inline(never)]
    pub(super) fn observe<L: Planner>(
        planner: &mut L,
        pose: Pose,
        reading: Option<Reading>,
    ) -> Result<(), ObservationError> {
        planner.observe(pose, reading)
    }

    #[inline(never)]
    pub(super) fn estimates<L: Planner>(planner: &L) -> Estimates {
        planner.estimates()
    }
}

/// The vehicle at the other end of the link.
struct RemoteVehicle<'a, P, S> {
    link: &'a mut Link<P>,
    /// The chip's own sensor, if labels come from there.
    chip: Option<&'a mut S>,
    /// The last reading, if the last motion wanted one.
    last: Option<Reading>,
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

impl<P: Port, S: LabelSensor> Body for RemoteVehicle<'_, P, S> {
    type Error = NoArrival;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, NoArrival> {
        let Self { last, took, .. } = *self;
        let reading = match self.link.ask(Request::Move(Move { motion: *motion, last, took })) {
            Ok(Reply::Arrived { pose: arrived, reading }) => {
                *pose = arrived;
                reading
            }
            Ok(_) => return Err(NoArrival::Failed),
            Err(lost) => return Err(NoArrival::Lost(lost)),
        };
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
