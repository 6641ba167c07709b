//! The planners that a chip has, and which of them flies a mission.
//!
//! A program carries the planners that it names, and no others:
//!
//! ```text
//! loop {
//!     let _ = station.mission::<TrueLabels<68>, AnyVehicle, Area>(&mut ());
//! }
//! ```

use crate::geometry::workspace::Workspace;
use crate::link::delivery::{LinkError, Port};
use crate::link::message::{Algorithm, DeclinedError, Setup};
use crate::link::station::flight::{Flown, Station, Watch};
use crate::link::station::seam::Prepared;
use crate::link::station::terms::{FromOutlines, Known, PlannerSetup};
use crate::motion::dynamics::Dynamics;
use crate::planner::Planner;
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

/// Algorithm 1, with room for `N` samples.
#[derive(Debug)]
pub enum CfcAlone<const N: usize> {}

/// Algorithm 1 and look-ahead for labels that are true, with room for `N` samples.
#[derive(Debug)]
pub enum TrueLabels<const N: usize> {}

/// All algorithms: with room for `T` samples whose labels are true, or for `N` samples whose labels may be wrong and
/// `H` hypotheses.
#[derive(Debug)]
pub enum AllLabels<const T: usize, const N: usize, const H: usize> {}

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
    pub fn mission<A: Planners, D: Known, G: FromOutlines>(
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
    pub fn fly_with<A: Planners, D: Known, G: FromOutlines>(
        &mut self,
        setup: &Setup,
        watch: &mut impl Watch,
    ) -> Result<Flown, LinkError> {
        watch.set_up(setup);
        let flown = match self.terms::<D, G>(setup) {
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
        self.station.fly(self.setup, planner, self.watch)
    }
}

impl<const N: usize> Planners for CfcAlone<N> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let setup = mission.setup;
        match setup.algorithm {
            Algorithm::Cfc => mission.fly(&mut setup.cfc::<_, _, N>(terms)),
            _ => mission.station.decline(DeclinedError::Algorithm),
        }
    }
}

impl<const N: usize> Planners for TrueLabels<N> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let setup = mission.setup;
        match setup.algorithm {
            Algorithm::Lookahead { evaluations, goal, noise: None } => {
                mission.fly(&mut setup.lookahead::<_, _, N>(terms, evaluations, goal))
            }
            _ => CfcAlone::<N>::fly(mission, terms),
        }
    }
}

impl<const T: usize, const N: usize, const H: usize> Planners for AllLabels<T, N, H> {
    fn fly<P: Port, S: LabelSensor, D: Dynamics, G: Workspace, W: Watch>(
        mission: Mission<'_, P, S, W>,
        terms: PlannerSetup<D, G>,
    ) -> Result<Flown, LinkError> {
        let setup = mission.setup;
        match setup.algorithm {
            Algorithm::Lookahead { evaluations, goal, noise: Some((noise, prior)) } => {
                let mut planner = setup.lookahead_in_noise::<_, _, N, H>(terms, evaluations, goal);
                mission.fly(&mut setup.prepare(&mut planner, prior, noise))
            }
            Algorithm::Scc { noise, policy, prior } => {
                let mut planner = setup.scc::<_, _, N, H>(terms, policy);
                mission.fly(&mut setup.prepare(&mut planner, prior, noise))
            }
            _ => TrueLabels::<T>::fly(mission, terms),
        }
    }
}
