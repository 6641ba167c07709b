//! A mission that begins from nothing: it first seeks the boundary, then the planner that was asked for goes on.

use planner_core::dynamics::Dynamics;
use planner_core::error::ObservationError;
use planner_core::watch::Alarm;
use planner_core::{
    Belief as _, FrontState, Lines, OneLabel, Plan, Planner, Pose, Reading, Sample, Seek, Site,
    StopReason, Tolerance, VersionSpace, Workspace as _, aimed_for,
};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::{Mission, SoughtLine};
use crate::mission::read_out::{AnyPlanner, ReadOut};
use crate::mission::terrain::Terrain;

/// Seeks the boundary, and hands over to the planner that a mission asks for.
pub(crate) struct FromNothing<D> {
    mission: Mission,
    seek: Seek<D, 16, 16, Terrain>,
    /// The planner that goes on, of a mission with the points that were found.
    on: fn(&Mission) -> AnyPlanner,
    next: Option<AnyPlanner>,
}

impl Mission {
    /// Whether the given points do not bound the line that is sought: there are none, or they have one label.
    pub fn begins_from_nothing(&self) -> bool {
        self.algorithm.seeks_line() && self.given.lines().is_none()
    }

    /// What is known of a line that is sought from nothing, before the first label.
    pub fn sought(&self) -> SoughtLine {
        let bounds = self.terrain().bounds();
        Lines::new(bounds, self.noise_told()).given(self.given.samples())
    }

    /// What labels all over its area say, if it most likely has one label.
    pub fn one_label(&self, labels: &[Sample]) -> Option<OneLabel> {
        let area = aimed_for(self.terrain(), &self.vehicle, self.config.tolerance).ok()?;
        let patches = !self.algorithm.seeks_line() && self.front.radius().is_some();
        let noise = self.noise_told().reliability;
        OneLabel::of(&area, (self.seeking, patches), noise, (self.given.samples(), labels))
    }

    /// The planner that seeks the line.
    ///
    /// # Panics
    /// When settings contradict each other.
    pub fn seek<D: Dynamics>(&self, dynamics: D) -> Seek<D, 16, 16, Terrain> {
        let bounds = self.terrain().bounds();
        let lines = Lines::new(bounds, self.noise_told());
        let seek = Seek::new(self.terrain(), dynamics, lines).expect("room for the vehicle");
        let seek = match self.asking.price {
            Some(price) => seek.at_price(price).expect("a price that was checked"),
            None => seek,
        };
        seek.knowing(self.given.samples())
    }
}

impl<D: Dynamics + 'static> FromNothing<D> {
    pub(crate) fn new(mission: &Mission, dynamics: D, on: fn(&Mission) -> AnyPlanner) -> Self {
        let seek = mission.seek(dynamics);
        let mut mission = mission.clone();
        // What others read does not count as the mission's own.
        let before = mission.read_before.len() as u32;
        mission.asking.labels = mission.asking.labels.map(|it| it + before);
        Self { mission, seek, on, next: None }
    }

    /// Hands over, if the boundary is found.
    fn go_on(&mut self) {
        let given = self.seek.given();
        if given.is_empty() || self.next.is_some() {
            return;
        }
        let tolerance = self.seek.belief().tolerance();
        let lines = if self.mission.noise.is_none() && tolerance != Tolerance::NONE {
            let given: Vec<_> = given.iter().map(|it| (*it, tolerance)).collect();
            VersionSpace::of_uncertain(&given)
        } else {
            VersionSpace::new(given)
        };
        let lines = lines.and_then(|it| it.clone().with_tolerance(tolerance).map(|_| it));
        if let Ok(lines) = lines {
            self.mission.given = lines.into();
            self.next = Some((self.on)(&self.mission));
        }
    }
}

impl<D: Dynamics + 'static> Planner for FromNothing<D> {
    type Belief = dyn ReadOut;

    fn plan(&mut self, pose: Pose) -> Plan {
        match &mut self.next {
            Some(next) => next.plan(pose),
            None => match self.seek.plan(pose) {
                // The samples that were found leave lines of too many directions for positions that err so much.
                Plan::Stop(StopReason::Known) => Plan::Stop(StopReason::Tolerance),
                plan => plan,
            },
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if let Some(next) = &mut self.next {
            return next.observe_within(pose, reading, tolerance);
        }
        self.seek.observe_within(pose, reading, tolerance)?;
        // The planner that goes on has as many labels less.
        if let (Some(left), Some(_)) = (&mut self.mission.asking.labels, reading) {
            *left = left.saturating_sub(1);
        }
        self.go_on();
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        match &mut self.next {
            Some(next) => next.observe_on_the_way(site, reading),
            // It hands over at the end of a motion.
            None => self.seek.observe_on_the_way(site, reading),
        }
    }

    fn belief(&self) -> &(dyn ReadOut + 'static) {
        self.next.as_ref().map_or(self.seek.belief(), |next| next.belief())
    }

    fn alarm(&self) -> Option<Alarm> {
        self.next.as_ref().map_or(self.seek.alarm(), |next| next.alarm())
    }

    fn front(&self) -> Option<FrontState> {
        self.next.as_ref().map_or(self.seek.front(), |next| next.front())
    }
}

/// What seeking the boundary from nothing came to.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeekRecord {
    /// The step after which the boundary was found, if it was.
    pub found: Option<usize>,
    /// Labels that were read until then, or until the end.
    pub labels: usize,
    /// Metres that were driven for them.
    pub metres: f64,
    /// The label that all of the area most likely has, where the boundary was not found.
    pub label: Option<i8>,
    /// Patches that hold a disc of this radius were sought, metres.
    pub radius: Option<f32>,
    /// The probability that such a patch is left, if every second area has one; absent if no patch was sought.
    pub patch: Option<f32>,
    /// The same of a boundary that crosses the area.
    pub coast: Option<f32>,
}

impl SeekRecord {
    /// Of a mission that began from nothing: the labels and the metres so far after each of its steps, and what was known
    /// then. Also of one that looked for a front and found that all has one label, as `is_one` says.
    pub(crate) fn of(
        mission: &Mission,
        steps: &[(usize, f64)],
        after: &[&dyn ReadOut],
        (labels_read, is_one): (&[Sample], bool),
    ) -> Option<Self> {
        let hands_over = mission.begins_from_nothing() && mission.algorithm != Algorithm::Lawnmower;
        if !hands_over && !is_one {
            return None;
        }
        let is_found = |it: &&dyn ReadOut| it.sought().is_none() && it.front().is_none();
        let found = after.iter().position(is_found).map(|k| k + 1);
        let (labels, metres) =
            steps[..found.unwrap_or(steps.len())].last().copied().unwrap_or_default();
        let one = is_one.then(|| mission.one_label(labels_read)).flatten();
        Some(Self {
            found,
            labels,
            metres,
            label: one.map(|it| it.label.sign()),
            radius: one.map(|it| it.radius),
            patch: one.and_then(|it| it.left.patch),
            coast: one.map(|it| it.left.coast),
        })
    }
}
