//! The entries of the planner. They stay separate functions in an optimised program. So its size, stack and
//! instructions can be measured apart from those of the link.

use crate::belief::ObservationError;
use crate::belief::doubtful_labels::CellPosterior;
use crate::belief::estimate::Estimates;
use crate::belief::front::{Front, FrontStretch};
use crate::belief::goal::{Accuracy, Criterion, Goal};
use crate::belief::noise::Noise;
use crate::belief::predictions::NoisyBelief;
use crate::belief::sample::Reading;
use crate::belief::true_labels::{GivenError, VersionSpace};
use crate::belief::weight::Prior;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::link::message::{Capacity, DeclinedError, PROTOCOL, Setup};
use crate::link::station::terms::{KnownDynamics, PlannerSetup};
use crate::motion::any_vehicle::ShapeError;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::cfc::Cfc;
use crate::planner::lookahead::Lookahead;
use crate::planner::scc::{Policy, Scc};
use crate::planner::setup::{Restart, SetupError, aimed_for};
use crate::planner::sight::{AnySight, Sight};
use crate::planner::track::{Guard, Track};
use crate::planner::{Plan, Planner};
use crate::robot::Hearing;

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
pub(super) fn observe_on_the_way<L: Planner>(
    hearing: &mut Hearing<'_, L>,
    site: Site,
    reading: Reading,
) {
    hearing.hear(site, reading);
}

#[inline(never)]
pub(super) fn estimates<L: Planner>(
    planner: &L,
    estimates: impl Fn(&L::Belief) -> Estimates,
) -> Estimates {
    estimates(planner.belief())
}

/// Look-ahead for labels that are true.
type OfTrueLabels<D, G, C, S, const N: usize> = Lookahead<D, VersionSpace<N>, G, C, S>;

/// A planner that was made for a setup.
#[derive(Clone, Debug)]
pub struct Prepared<L> {
    pub(super) planner: L,
    pub(super) capacity: Capacity,
}

impl<L> Prepared<L> {
    /// The planner.
    pub const fn planner_mut(&mut self) -> &mut L {
        &mut self.planner
    }

    /// The planner, as another planner that is made of it.
    pub(super) fn wrapped<'a, M>(&'a mut self, wrap: impl FnOnce(&'a mut L) -> M) -> Prepared<M> {
        Prepared { planner: wrap(&mut self.planner), capacity: self.capacity }
    }
}

impl Setup {
    /// What to plan with, of the vehicles that the chip has, in an area: see
    /// [`Station::terms`](crate::link::station::Station::terms).
    ///
    /// # Errors
    /// [`DeclinedError`].
    pub fn terms<D: KnownDynamics, G: Workspace>(
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
    #[inline(never)]
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
    #[inline(never)]
    pub fn lookahead<D: Dynamics, G: Workspace, C: Criterion, S: Sight, const N: usize>(
        &self,
        PlannerSetup { dynamics, area, options }: PlannerSetup<D, G>,
        (evaluations, sight): (u32, AnySight),
        goal: Option<Goal>,
    ) -> Result<Prepared<OfTrueLabels<D, G, C, S, N>>, DeclinedError> {
        let sight = S::of(sight).ok_or(DeclinedError::Price)?;
        let goal = goal.map(|goal| Goal::of(goal).ok_or(DeclinedError::Goal)).transpose()?;
        let capacity = Capacity { samples: N as u16, hypotheses: 1 };
        self.check(capacity)?;
        let space = self.space()?;
        let price = options.weight.into();
        let planner = Lookahead::with_all((area, dynamics), space, price, evaluations, goal);
        let planner = planner.seeing(sight);
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
    pub fn lookahead_in_noise<
        D: Dynamics,
        G: Workspace,
        S: Sight,
        const N: usize,
        const H: usize,
    >(
        &self,
        PlannerSetup { dynamics, area, options }: PlannerSetup<D, G>,
        evaluations: u32,
        goal: Option<Goal>,
        sight: S,
    ) -> Lookahead<D, NoisyBelief<N, H>, G, Accuracy, S> {
        let price = options.weight.into();
        let of = (area, dynamics);
        Lookahead::with_all(of, NoisyBelief::NONE, price, evaluations, goal).seeing(sight)
    }

    /// The follower of fronts for this mission, with none of its samples yet: the memory for
    /// [`prepare`](Self::prepare).
    pub fn track<D: Dynamics, G: Workspace>(
        &self,
        PlannerSetup { dynamics, area, .. }: PlannerSetup<D, G>,
        front: Front,
        ends: bool,
    ) -> Track<D, G> {
        Track::of((area, dynamics), front, ends)
    }

    /// The guard of a stretch of a front for this mission, with none of its samples yet: the memory for
    /// [`prepare`](Self::prepare).
    pub fn guard<D: Dynamics, G: Workspace>(
        &self,
        PlannerSetup { dynamics, area, .. }: PlannerSetup<D, G>,
        front: Front,
        stretch: FrontStretch,
    ) -> Guard<D, G> {
        Guard::guard_of((area, dynamics), front, stretch)
    }

    /// Begins the mission in this memory, so that there is never a second planner beside it.
    ///
    /// # Errors
    /// [`DeclinedError`].
    #[inline(never)]
    pub fn prepare<'a, R: Restart>(
        &self,
        planner: &'a mut R,
        prior: Prior,
        noise: Noise,
    ) -> Result<Prepared<&'a mut R>, DeclinedError> {
        let [samples, hypotheses] = R::ROOM.map(|most| most as u16);
        let capacity = Capacity { samples, hypotheses };
        self.check(capacity)?;
        planner.restart(&self.given, prior, noise).map_err(declined)?;
        Ok(Prepared { planner, capacity })
    }
}

/// Why a setup is declined if no planner can be made of it.
fn declined(error: SetupError) -> DeclinedError {
    match error {
        SetupError::Tolerance(_) => DeclinedError::Tolerance,
        SetupError::Room(none) => DeclinedError::Vehicle(ShapeError::Room(none)),
        SetupError::Given(why) => DeclinedError::Given(why),
        SetupError::Full | SetupError::Patch { .. } => DeclinedError::Given(GivenError::TooMany),
    }
}
