//! A planner that finds a straight boundary from nothing, and then lends samples to the planner that goes on.
//!
//! All other planners of straight lines begin with given points of both labels. [`Seek`] begins with none, or with
//! points of one label. It drives along a route over the area. Once a line is close, it learns from a grid of [`Lines`],
//! and goes where a label is worth the most information for its price and the way there (`hunt.rs`). It ends by itself:
//!
//! | reason | what is true then |
//! | --- | --- |
//! | [`Known`](StopReason::Known) | the boundary is found, and [`given`](Seek::given) lends the samples |
//! | [`OneLabel`](StopReason::OneLabel) | no line is left that cuts off more than a piece at the border: see [`one_label`](Seek::one_label) |
//! | [`NoLine`](StopReason::NoLine) | labels are true, and no line separates them: the boundary bends |
//! | any other | as for other planners |
//!
//! # What it lends
//!
//! **Labels that are true.** The labels that were read, up to [`GIVEN`] of them. They make a [`VersionSpace`]. Where
//! positions err, make it by [`of_uncertain`](VersionSpace::of_uncertain).
//!
//! **Labels that may be wrong.** A label that was read is not certain. So it lends four places at which it is sure of
//! the label, two on either side. Each of the four labels is wrong with a probability of at most 1 in 3,000, as the
//! lines has it. A line that they rule out cannot be found any more. So a later interval is right less often. Of 2,000
//! missions with labels of 90 and 70 % it happened in one.

use heapless::Vec;

use crate::belief::evidence::Alarm;
use crate::belief::front::{Unit, Waist};
use crate::belief::lines::{Lines, LinesMemory};
use crate::belief::observation_log::{FromLog as _, ReplayError};
use crate::belief::sample::{Label, Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::{GivenError, VersionSpace};
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::approximate::METRE;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::far::Far;
use crate::planner::hunt::Hunt;
use crate::planner::one_label::OneLabel;
use crate::planner::quest::QuestMemory;
use crate::planner::scout::Scout;
use crate::planner::setup::SetupError;
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot};
use crate::planner::{Plan, Planner, StopReason};

/// Samples that it lends at most.
pub(crate) const GIVEN: usize = 15;

/// What a label costs, as a share of the mean of the area's sides.
const PRICE: f32 = 0.125;

/// A label is sure where the other one has at most this probability.
const SURE: f32 = 1.0 / 3_000.0;

/// A sure place is sought from so many deviations beside the boundary on, by steps that grow by a factor.
const NEAREST: f32 = 2.0;
const FARTHER: f32 = 1.2;
const STEPS: u32 = 24;

/// A planner that finds a straight boundary from nothing: `D` is the vehicle, `G` the area, and `K` and `M` are the
/// directions and offsets of its [`Lines`]. 16 x 16 is enough.
///
/// ```
/// # use planner_core::{
/// #     Area, Goal, Heading, Label, Lines, Lookahead, Noise, Plan, Planner as _, Pose, Seek, Site,
/// #     StopReason, Unicycle, VersionSpace,
/// # };
/// # use planner_core::nalgebra::Point2;
/// # let read = |site: Site| {
/// #     let at = Point2::<f64>::from(site);
/// #     if at.y > 0.3 * at.x + 9.0 { Label::Positive } else { Label::Negative }
/// # };
/// let area = Area::metres([0.0, 0.0], [20.0, 20.0])?;
/// let lines = Lines::<16, 16>::new(area, Noise::NONE);
/// let mut seek = Seek::new(area, Unicycle::default(), lines)?;
/// let mut pose = Pose::at([2.0, 1.0], Heading::default())?;
/// let why = loop {
///     match seek.plan(pose) {
///         Plan::Move(motion) => pose = motion.target,
///         Plan::Stop(why) => break why,
///     }
///     seek.observe(pose, Some(read(pose.site).into()))?;
/// };
/// assert_eq!(why, StopReason::Known);
/// let belief = VersionSpace::<32>::new(seek.given())?;
/// let planner = Lookahead::new(area, Unicycle::default(), belief)?; // it goes on from `pose`
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Seek<D, const K: usize, const M: usize, G = Area> {
    hunt: Hunt<D, K, M, G>,
    samples: Vec<Sample, GIVEN, u8>,
    is: State,
}

/// What is known of the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum State {
    Sought,
    Found,
    /// No line separates the labels.
    Bent,
}

/// What a [`Seek`] has to remember beside its lines.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SeekMemory {
    silence: Silence,
    quest: QuestMemory,
    samples: Vec<Sample, GIVEN, u8>,
    is: State,
}

impl<D: Dynamics, const K: usize, const M: usize, G: Workspace> Seek<D, K, M, G> {
    /// A planner with what is known so far. A label costs as much as to drive along an eighth of the
    /// mean of the area's sides.
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline] // it is made where it stays, as it may be large
    pub fn new(area: G, dynamics: D, lines: Lines<K, M>) -> Result<Self, SetupError> {
        let price = Far::part(&area, PRICE).price();
        let mut hunt = Hunt::new(area, dynamics, lines)?;
        hunt.scout.price = units(price as f32);
        Ok(Self { hunt, samples: Vec::new(), is: State::Sought })
    }

    /// The same at another price of a label, metres of driving. The higher it is, the fewer labels are read on the way,
    /// and the farther apart they lie.
    ///
    /// # Errors
    /// [`ValueError`] unless it is from 0 to 16,384 m.
    pub fn at_price(mut self, metres: f64) -> Result<Self, ValueError> {
        self.hunt.scout.price = units(Far::at_price(metres)?.price() as f32);
        Ok(self)
    }

    /// The same after some points whose labels are known for sure, of one label or of both. Call it before the first
    /// plan.
    #[must_use]
    pub fn knowing(mut self, points: &[Sample]) -> Self {
        self.hunt.know(points);
        for &point in points {
            self.keep(point);
        }
        self.judge();
        self
    }

    /// Samples for the belief of the planner that goes on. Empty as long as the boundary is not found.
    pub fn given(&self) -> &[Sample] {
        if self.is == State::Found { &self.samples } else { &[] }
    }

    /// The label that all of the area has, if it most likely has one; and what may be left of the other one.
    pub fn one_label(&self) -> Option<OneLabel> {
        self.hunt.scout.one_label()
    }

    /// Whether the labels that are kept make a version space: what it takes to go on, and no less.
    fn judge(&mut self) {
        let lines = &self.hunt.lines;
        if !lines.is_certain() {
            if let Some(sure) = self.hunt.found().and_then(|waist| self.sure(waist)) {
                self.samples = sure.into_iter().collect();
                self.is = State::Found;
            }
            return;
        }
        let has = |label| self.samples.iter().any(|it| it.label == label);
        if !has(Label::Positive) || !has(Label::Negative) {
            return;
        }
        let tolerance = lines.tolerance();
        let made = if tolerance == Tolerance::NONE {
            VersionSpace::<GIVEN>::new(&self.samples)
        } else {
            let samples: Vec<_, GIVEN, u8> =
                self.samples.iter().map(|it| (*it, tolerance)).collect();
            VersionSpace::of_uncertain(&samples).and_then(|it| it.with_tolerance(tolerance))
        };
        self.is = match made.map(|_| ()) {
            Ok(()) => State::Found,
            Err(GivenError::NotSeparable(_)) => State::Bent,
            Err(_) => State::Sought,
        };
    }

    /// Two places on each side of the boundary whose labels are sure. They lie as far along it as its direction matters.
    fn sure(&self, waist: Waist) -> Option<[Sample; 4]> {
        let (unit, reach) = (Unit::of(waist.heading), self.hunt.scout.reach() * METRE);
        let long = waist.deviation / waist.turn_deviation;
        let long = if long > reach { long } else { reach };
        let place = |ahead: f32, left: f32| {
            let [x, z] = [unit.x * ahead - unit.z * left, unit.z * ahead + unit.x * left];
            let by = Vector::new(units(x) as i32, units(z) as i32)?;
            waist.site.step(by).ok()
        };
        let mut samples = [Sample { site: waist.site, label: Label::Positive }; 4];
        let corners = [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0_f32)];
        for (sample, (end, side)) in samples.iter_mut().zip(corners) {
            let mut off = NEAREST * waist.deviation;
            *sample = (0..STEPS).find_map(|_| {
                off *= FARTHER;
                let site = place(end * long, side * off)?;
                let above = self.hunt.lines.share_above(site);
                let (label, other) = if side > 0.0 {
                    (Label::Positive, 1.0 - above)
                } else {
                    (Label::Negative, above)
                };
                (other < SURE).then_some(Sample { site, label })
            })?;
        }
        Some(samples)
    }

    /// Keeps a label, if need be in the place of one of its kind that lies near another. To leave out any is safe.
    fn keep(&mut self, new: Sample) {
        if self.samples.push(new).is_ok() {
            return;
        }
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

    /// Takes in a label that the lines has taken in.
    fn take(&mut self, site: Site, reading: Reading) {
        if let Reading::Side(label) = reading
            && self.is == State::Sought
        {
            if self.hunt.lines.is_certain() {
                self.keep(Sample { site, label });
            }
            self.judge();
        }
    }
}

/// Metres in lattice units.
fn units(metres: f32) -> f32 {
    metres * UNITS_PER_METRE as f32
}

impl<D: Dynamics, const K: usize, const M: usize, G: Workspace> Planner for Seek<D, K, M, G> {
    type Belief = Lines<K, M>;

    fn plan(&mut self, pose: Pose) -> Plan {
        match self.is {
            State::Sought => self.hunt.seek(pose),
            State::Found => Plan::Stop(StopReason::Known),
            State::Bent => Plan::Stop(StopReason::NoLine),
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.hunt.observe(pose, reading, tolerance)?;
        if let Some(reading) = reading {
            self.take(pose.site, reading);
        }
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.hunt.observe_on_the_way(site, reading)?;
        if is_kept {
            self.take(site, reading);
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &Lines<K, M> {
        &self.hunt.lines
    }

    fn alarm(&self) -> Option<Alarm> {
        self.hunt.lines.evidence().alarm()
    }
}

impl<D: Dynamics, const K: usize, const M: usize, G: Workspace> Persist for Seek<D, K, M, G> {
    type Snapshot = Snapshot<LinesMemory<K, M>, SeekMemory>;

    fn snapshot(&self) -> Self::Snapshot {
        let Self { hunt: Hunt { lines, scout }, samples, is } = self;
        let Scout { silence, quest, .. } = scout;
        let (silence, quest) = (*silence, quest.memory());
        let memory = SeekMemory { silence, quest, samples: samples.clone(), is: *is };
        Snapshot::new(self.hunt.mark(Kind::Seek), lines.log(), memory)
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let (log, memory) = snapshot.open(self.hunt.mark(Kind::Seek))?;
        if !self.hunt.scout.quest.recall(&memory.quest) {
            return Err(ReplayError::Spoilt.into());
        }
        self.hunt.lines.replay(log)?;
        self.hunt.scout.silence = memory.silence;
        (self.samples, self.is) = (memory.samples.clone(), memory.is);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::noise::Noise;
    use crate::geometry::heading::Heading;
    use crate::motion::unicycle::Unicycle;

    fn seek() -> Seek<Unicycle, 16, 16> {
        let area = Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap();
        let lines = Lines::new(area, Noise::NONE);
        Seek::new(area, Unicycle::default(), lines).unwrap()
    }

    fn after(labels: &[(f64, f64, Label)]) -> Seek<Unicycle, 16, 16> {
        let mut seek = seek();
        for &(x, z, label) in labels {
            let pose = Pose::at([x, z], Heading::default()).unwrap();
            seek.observe(pose, Some(label.into())).unwrap();
        }
        seek
    }

    #[test]
    fn a_label_amid_those_of_the_other_kind_leaves_no_line() {
        use Label::{Negative, Positive};
        let corners = [(1.0, 1.0, Positive), (19.0, 1.0, Positive), (10.0, 19.0, Positive)];
        let amid = after(&[&corners[..], &[(10.0, 8.0, Negative)]].concat());
        let beside = after(&[&corners[..], &[(1.0, 19.0, Negative)]].concat());
        assert_eq!((amid.is, beside.is), (State::Bent, State::Found));
        assert!(amid.given().is_empty() && beside.given().len() == 4);
        // Labels in a row say nothing of the direction.
        let row = after(&[(1.0, 1.0, Positive), (2.0, 2.0, Positive), (3.0, 3.0, Negative)]);
        assert_eq!(row.is, State::Sought);
    }

    #[test]
    fn of_many_labels_those_far_apart_are_kept() {
        let mut labels = [(0.0, 0.0, Label::Positive); 62];
        labels[1].0 = 20.0;
        for (label, k) in labels.iter_mut().skip(2).zip(0..) {
            *label = (10.0, 0.1 * f64::from(k), Label::Positive);
        }
        let seek = after(&labels);
        assert_eq!(seek.samples.len(), GIVEN);
        let has = |x, z| seek.samples.iter().any(|it| it.site == Site::metres([x, z]).unwrap());
        assert!(has(0.0, 0.0) && has(20.0, 0.0) && has(10.0, 5.9), "{:?}", seek.samples);
    }

    #[test]
    fn the_only_label_of_its_kind_is_kept() {
        let mut labels = [(0.0, 1.0, Label::Negative); 20];
        for (label, k) in labels.iter_mut().skip(1).zip(1..) {
            *label = (f64::from(k), 1.0, Label::Positive);
        }
        let seek = after(&labels);
        assert_eq!((seek.is, seek.samples.len()), (State::Sought, GIVEN));
        assert!(seek.samples.iter().any(|it| it.label == Label::Negative));
    }
}
