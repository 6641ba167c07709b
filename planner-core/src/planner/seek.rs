//! A planner that finds a straight boundary from nothing, for another planner to go on.

use heapless::Vec;

use crate::belief::ObservationError;
use crate::belief::front::{Tracker, Unit};
use crate::belief::sample::{Label, Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::geometry::area::Area;
use crate::geometry::approximate::METRE;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector, orient};
use crate::planner::far::Far;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::scout::Scout;
use crate::planner::setup::SetupError;
use crate::planner::{Plan, Planner, StopReason};

/// Samples that the next planner is given at most: a hypothesis has room for as many.
pub const GIVEN: usize = 15;

#[derive(Clone, Debug)]
pub struct Seek<D, const K: usize, const M: usize, G = Area> {
    scout: Scout<D, K, M, 1, G>,
    samples: Vec<Sample, GIVEN>,
    how: u8,
}

impl<D: Dynamics, const K: usize, const M: usize, G: Workspace> Seek<D, K, M, G> {
    #[inline] // it is made where it stays, as it may be large
    pub fn new(
        area: G,
        dynamics: D,
        tracker: Tracker<K, M, 1>,
        how: u8,
    ) -> Result<Self, SetupError> {
        let far = Far::usual(&area, &dynamics);
        let mut scout = Scout::new(area, dynamics, tracker)?;
        if let Some(far) = far {
            scout.price = far.price() as f32 * UNITS_PER_METRE as f32;
        }
        Ok(Self { scout, samples: Vec::new(), how })
    }

    pub fn at_price(mut self, metres: f64) -> Self {
        self.scout.price = metres as f32 * UNITS_PER_METRE as f32;
        self
    }

    /// Two places on each side of the boundary whose labels are sure.
    pub fn sure(&self) -> Option<[Sample; 4]> {
        let Scout { tracker, .. } = &self.scout;
        let waist = self.scout.found()?;
        let unit = Unit::of(waist.heading);
        let long = waist.deviation / waist.turn_deviation;
        let reach = self.scout.reach() * METRE;
        let long = if long > reach { long } else { reach };
        let mut samples = [Sample { site: waist.site, label: Label::Positive }; 4];
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0_f32)];
        for (sample, (end, side)) in samples.iter_mut().zip(corners) {
            let mut off = 2.0 * waist.deviation;
            *sample = (0..24).find_map(|_| {
                let (ahead, left) = (end * long, side * off);
                off *= 1.2;
                let [x, z] = [unit.x * ahead - unit.z * left, unit.z * ahead + unit.x * left];
                let by = Vector::new((x * UNITS_PER_METRE as f32) as i32, (z * UNITS_PER_METRE as f32) as i32)?;
                let site = waist.site.step(by).ok()?;
                let above = tracker.share_above(site);
                let (other, label) = if side > 0.0 { (1.0 - above, Label::Positive) } else { (above, Label::Negative) };
                (other < 1e-3).then_some(Sample { site, label })
            })?;
        }
        Some(samples)
    }

    pub fn given(&self) -> Option<&[Sample]> {
        self.is_found().then_some(&self.samples)
    }

    pub fn tracker(&self) -> &Tracker<K, M, 1> {
        &self.scout.tracker
    }

    fn is_found(&self) -> bool {
        if self.how == 1 && self.scout.found().is_none() {
            return false;
        }
        if self.how == 2 {
            return false;
        }
        if self.how == 3 {
            return self.sure().is_some();
        }
        let [a, b, rest @ ..] = self.samples.as_slice() else { return false };
        let mut beside = rest.iter().filter(|it| orient(a.site, b.site, it.site) != 0);
        let labels = |label| self.samples.iter().any(|it| it.label == label);
        beside.next().is_some() && labels(Label::Positive) && labels(Label::Negative)
    }

    fn keep(&mut self, new: Sample) {
        let Err(_) = self.samples.push(new) else { return };
        // One of the two of this label that are the nearest to each other goes.
        let mut least: Option<(i64, usize)> = None;
        for (k, a) in self.samples.iter().enumerate() {
            for b in self.samples.iter().skip(k + 1).chain([&new]) {
                let way = a.site - b.site;
                let square = way.dot(way);
                if a.label == b.label && least.is_none_or(|(it, _)| square < it) {
                    least = Some((square, k));
                }
            }
        }
        if let Some(place) = least.and_then(|(_, k)| self.samples.get_mut(k)) {
            *place = new;
        }
    }
}

impl<D: Dynamics, const K: usize, const M: usize, G: Workspace> Planner for Seek<D, K, M, G> {
    type Belief = Tracker<K, M, 1>;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.is_found() { Plan::Stop(StopReason::Known) } else { self.scout.seek(pose) }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.scout.observe(pose, reading, tolerance)?;
        if let Some(Reading::Side(label)) = reading {
            self.keep(Sample { site: pose.site, label });
        }
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.scout.observe_on_the_way(site, reading)?;
        if let Reading::Side(label) = reading
            && is_kept
        {
            self.keep(Sample { site, label });
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &Tracker<K, M, 1> {
        &self.scout.tracker
    }
}
