//! The planners that a chip has, and which of them flies a mission.
//!
//! A program carries the planners that it names, and no others:
//!
//! ```text
//! loop {
//!     let _ = station.mission::<TrueLabels<68>, AnyVehicle, Area>(&mut ());
//! }
//! ```

use core::marker::PhantomData;

use crate::belief::Belief as _;
use crate::belief::estimate::Estimates;
use crate::belief::goal::{Accuracy, Criterion};
use crate::belief::weight::Prior;
use crate::geometry::workspace::Workspace;
use crate::link::delivery::{LinkError, Port};
use crate::link::message::{Algorithm, DeclinedError, Setup};
use crate::link::station::flight::{Flown, Station, Watch};
use crate::link::station::seam::Prepared;
use crate::link::station::terms::{FromOutlines, KnownDynamics, PlannerSetup};
use crate::motion::dynamics::Dynamics;
use crate::planner::Planner;
use crate::planner::sight::{Near, Sight};
use crate::planner::watched::Watched;
use crate::robot::LabelSensor;

/// The planners that a chip has.
pub trait Planners {
    /// Flies a mission with the planner that its setup names, or declines it.
    ///
    /// # Errors
    /// [`LinkError`].
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError>;
}

/// Algorithm 1, with room for `N` samples. Of the estimates it has the centre alone.
#[derive(Debug)]
pub enum CfcAlone<const N: usize> {}

/// Algorithm 1 and look-ahead for labels that are true, with room for `N` samples. Look-ahead takes goals of a
/// criterion, and declines others. So it does with prices of labels, by its [`Sight`].
#[derive(Debug)]
pub struct TrueLabels<const N: usize, C = Accuracy, S = Near>(PhantomData<(C, S)>);

/// All algorithms: with room for `T` samples whose labels are true, or for `N` samples whose labels may be wrong and
/// `H` hypotheses. Look-ahead has a [`Sight`]: [`AnySight`](crate::AnySight) takes all that a setup asks for.
#[derive(Debug)]
pub struct AllLabels<const T: usize, const N: usize, const H: usize, S = Near>(PhantomData<S>);

/// The follower of fronts, and the planners of `A`: by default none.
#[derive(Debug)]
pub struct Tracks<A = NoOthers>(PhantomData<A>);

/// The guard of a stretch of a front, and the planners of `A`: by default none.
#[derive(Debug)]
pub struct Guards<A = NoOthers>(PhantomData<A>);

/// No planner.
#[derive(Debug)]
pub enum NoOthers {}

/// A mission that was set up.
#[derive(Debug)]
pub struct Mission<'a, P, S, W> {
    station: &'a mut Station<P, S>,
    setup: &'a Setup,
    watch: &'a mut W,
}

impl<P: Port, S: LabelSensor> Station<P, S> {
    /// Asks for a mission until someone sets it up, and flies it with one of some planners.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn mission<A: Planners, D: KnownDynamics, G: FromOutlines>(
        &mut self,
        watch: &mut impl Watch,
    ) -> Result<Flown, LinkError> {
        let setup = self.await_setup();
        self.fly_with::<A, D, G>(&setup, watch)
    }

    /// Flies the mission of a setup with one of some planners.
    ///
    /// # Errors
    /// As [`fly`](Self::fly).
    pub fn fly_with<A: Planners, D: KnownDynamics, G: FromOutlines>(
        &mut self,
        setup: &Setup,
        watch: &mut impl Watch,
    ) -> Result<Flown, LinkError> {
        let mut room = G::EMPTY;
        watch.set_up(setup);
        let flown = match self.terms::<D, G>(setup, &mut room) {
            Ok(terms) => A::fly(Mission { station: self, setup, watch }, terms),
            Err(none) => self.give_up(none),
        };
        watch.over(&flown);
        flown
    }
}

impl<P: Port, S: LabelSensor, W: Watch> Mission<'_, P, S, W> {
    fn fly<L: Planner>(
        self,
        planner: &mut Result<Prepared<L>, DeclinedError>,
    ) -> Result<Flown, LinkError> {
        self.fly_estimating(planner, L::Belief::estimates)
    }

    fn fly_estimating<L: Planner>(
        self,
        planner: &mut Result<Prepared<L>, DeclinedError>,
        estimates: impl Fn(&L::Belief) -> Estimates,
    ) -> Result<Flown, LinkError> {
        let Self { station, setup, watch } = self;
        if !W::ALARMS {
            return station.fly_estimating(setup, planner, watch, estimates);
        }
        let watched = planner.as_mut().map(|it| it.wrapped(Watched::new));
        station.fly_estimating(setup, &mut watched.map_err(|declined| *declined), watch, estimates)
    }
}

impl<const N: usize> Planners for CfcAlone<N> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let setup = mission.setup;
        match setup.algorithm {
            Algorithm::Cfc => mission.fly_estimating(&mut setup.cfc::<_, _, N>(terms), |lines| {
                Estimates { bisector: None, centre: lines.centre(), maximum_margin: None }
            }),
            _ => mission.station.decline(DeclinedError::Algorithm),
        }
    }
}

impl<const N: usize, C: Criterion, V: Sight> Planners for TrueLabels<N, C, V> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let setup = mission.setup;
        match setup.algorithm {
            Algorithm::Lookahead { evaluations, goal, noise: None, sight } => {
                let asked = (evaluations, sight);
                mission.fly(&mut setup.lookahead::<_, _, C, V, N>(terms, asked, goal))
            }
            Algorithm::Cfc => mission.fly(&mut setup.cfc::<_, _, N>(terms)),
            _ => mission.station.decline(DeclinedError::Algorithm),
        }
    }
}

impl<const T: usize, const N: usize, const H: usize, V: Sight> Planners for AllLabels<T, N, H, V> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let setup = mission.setup;
        match setup.algorithm {
            Algorithm::Lookahead { evaluations, goal, noise: Some((noise, prior)), sight } => {
                let Some(sight) = V::of(sight) else {
                    return mission.station.decline(DeclinedError::Price);
                };
                let mut planner =
                    setup.lookahead_in_noise::<_, _, V, N, H>(terms, evaluations, goal, sight);
                mission.fly(&mut setup.prepare(&mut planner, prior, noise))
            }
            Algorithm::Scc { noise, policy, prior } => {
                let mut planner = setup.scc::<_, _, N, H>(terms, policy);
                mission.fly(&mut setup.prepare(&mut planner, prior, noise))
            }
            _ => TrueLabels::<T, Accuracy, V>::fly(mission, terms),
        }
    }
}

impl<A: Planners> Planners for Tracks<A> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let Mission { station, setup, watch } = mission;
        match setup.algorithm {
            Algorithm::Track { front, noise, ends } => {
                // It watches its labels itself: they speak of a front, not of a line.
                let mut planner = setup.track(terms, front, ends);
                station.fly(setup, &mut setup.prepare(&mut planner, Prior::Area, noise), watch)
            }
            _ => A::fly(Mission { station, setup, watch }, terms),
        }
    }
}

impl<A: Planners> Planners for Guards<A> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let Mission { station, setup, watch } = mission;
        match setup.algorithm {
            Algorithm::Watch { front, noise, stretch } => {
                let mut planner = setup.guard(terms, front, stretch);
                station.fly(setup, &mut setup.prepare(&mut planner, Prior::Area, noise), watch)
            }
            _ => A::fly(Mission { station, setup, watch }, terms),
        }
    }
}

impl Planners for NoOthers {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        _: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        mission.station.decline(DeclinedError::Algorithm)
    }
}
