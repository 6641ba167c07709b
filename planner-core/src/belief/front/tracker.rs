//! The tracker: takes in labels and time, and says what is known of a front.

use crate::belief::estimate::Estimates;
use crate::belief::evidence::Evidence;
use crate::belief::front::grid::Grid;
use crate::belief::front::learnt::Learnt;
use crate::belief::front::settings::Front;
use crate::belief::goal::{Criterion, Goal};
use crate::belief::noise::{Noise, Reliability};
use crate::belief::predictions::{entropy, information};
use crate::belief::sample::{Label, Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::AnyReliability;
use crate::belief::{Belief, ObservationError};
use crate::geometry::approximate::{METRE, distance};
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::geometry::local_line::LocalLine;

/// Labels count as true no more often than this, so that one false label does not rule out the truth.
pub(super) const MOST: f32 = 0.98;

/// Where a front bends, evidence takes a label as so much likelier than the belief says. A few layers stand for all
/// curvatures, so the chance of a label is a little off. Small errors of one sign would add up to an alarm.
const MISFIT: f32 = 0.015;

/// Positions that err by a deviation widen the edge of a label by so many of them, either way.
const WIDER: f32 = 1.5;

/// A tolerance is so many deviations.
const TOLERANCE: f32 = 3.0;

/// A front is found where there is none with a probability of at most this.
pub(super) const ABSENT: f32 = 0.05;

/// A label says nothing of its reliability where that is nearer to a half than this, doubled.
const SHARP: f32 = 1e-3;

/// On the way, labels count where so much of the curves disagree.
const UNSURE: f32 = 1e-3;

/// The most bits that labels on the way may carry for each width of a cell. Closer labels would seem to part a cell, and
/// rule out the part that the front is in.
const DENSEST: f32 = 0.25;

/// What is known of a front: `K` directions, `M` offsets and `L` layers of curvature.
///
/// `L` is 1 for a straight front, whatever its [`radius`](Front::radius), and 3 or 5 for one that bends. 16 x 16 x 3
/// is good for fronts, 24 x 24 x 1 for lines. It takes `4 K M L + 8 K` bytes and some 150: 3.4 kB for 16 x 16 x 3.
///
/// ```
/// # use planner_core::{Area, Belief as _, Front, Label, Noise, Site, Tracker};
/// let area = Area::metres([0.0, 0.0], [40.0, 40.0])?;
/// let mut tracker = Tracker::<16, 16, 3>::new(area, Front::bending(50.0)?, Noise::new(0.9)?);
/// for k in 0..60 {
///     // A robot that goes to and fro across a front at z = 20.
///     let (x, z) = (f64::from(k) * 0.5, 20.0 + f64::from(k % 4) - 1.5);
///     let label = if z > 20.0 { Label::Positive } else { Label::Negative };
///     let site = Site::metres([x, z])?;
///     tracker.moved(site, 1.0);
///     tracker.observe(site, label.into())?;
/// }
/// let waist = tracker.waist();
/// assert!((f64::from(waist.site.z()) / 65_536.0 - 20.0).abs() < waist.half_width(0.99));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Tracker<const K: usize, const M: usize, const L: usize> {
    pub(super) front: Front,
    pub(super) noise: Noise<AnyReliability>,
    pub(super) grid: Grid<K, M, L>,
    /// Everywhere +1, everywhere -1.
    pub(super) nowhere: [f32; 2],
    /// What labels have said of a reliability that nobody knows.
    pub(super) learnt: Option<Learnt>,
    pub(super) evidence: Evidence,
    /// Where the cells were laid last, or where a later label on the way counted.
    pub(super) heard: Site,
    /// The logarithm to the base 2 of the measure of all curves at the start.
    pub(super) start: f32,
    /// Whether the robot [stays](Self::staying).
    pub(super) stays: bool,
    /// Whether it was told about where the front is.
    pub(super) is_near: bool,
    /// Whether a front was known, or sought near a place, since one was sought all over an area.
    pub(super) was_known: bool,
}

impl<const K: usize, const M: usize, const L: usize> Tracker<K, M, L> {
    /// Nothing is known but that a front may cross an area. With a probability of a tenth there is none: all of the
    /// area is +1, or all of it is -1.
    ///
    /// The noise has the reliability of labels, or a prior for it, and the tolerance: three standard deviations of a
    /// position. No ball is trusted.
    pub fn new(area: Area, front: Front, noise: impl Into<Noise<AnyReliability>>) -> Self {
        let mut tracker = Self::blank(front);
        tracker.begin(area, noise.into());
        tracker
    }

    /// Memory to [`restart`](Self::restart) in.
    pub(crate) const fn blank(front: Front) -> Self {
        const NO_NOISE: Noise<AnyReliability> = Noise {
            reliability: AnyReliability::Known(Reliability::CERTAIN),
            trusted_radius: 0,
            tolerance: Tolerance::NONE,
        };
        Self {
            front,
            noise: NO_NOISE,
            grid: Grid::NONE,
            nowhere: [0.0; 2],
            learnt: None,
            evidence: Evidence::NONE,
            heard: Site::ORIGIN,
            start: 0.0,
            stays: false,
            is_near: false,
            was_known: false,
        }
    }

    /// The same for a robot that does not go along the front, but stays with a stretch of it. It returns to places where
    /// the front bends as before, and where it has moved in the meantime. [`Guard`](crate::Guard) sets it by itself.
    #[must_use]
    pub fn staying(mut self) -> Self {
        self.stay();
        self
    }

    pub(crate) const fn stay(&mut self) {
        self.stays = true;
    }

    /// Begins again, where it is, as [`new`](Self::new) and [`given`](Self::given) do.
    pub(crate) fn restart(&mut self, area: Area, noise: Noise<AnyReliability>, given: &[Sample]) {
        self.begin(area, noise);
        self.give(given);
    }

    /// How often a label is true, as far as that is known.
    pub fn reliability(&self) -> f32 {
        match (self.learnt, self.noise.reliability) {
            (Some(learnt), _) => learnt.mean(),
            (None, AnyReliability::Known(known)) => known.single(),
            (None, AnyReliability::Unknown(_)) => 0.5, // it is learnt
        }
    }

    /// Whether all labels are true, as far as was told.
    pub(crate) fn is_certain(&self) -> bool {
        self.learnt.is_none() && self.reliability() >= 1.0
    }

    /// How often a label counts as true.
    pub(crate) fn counted(&self) -> f32 {
        self.reliability().clamp(1.0 - MOST, MOST)
    }

    /// By how much a position may err, metres.
    pub(super) fn blurred(&self) -> f32 {
        Self::blur(self.noise.tolerance)
    }

    fn blur(tolerance: Tolerance) -> f32 {
        WIDER / TOLERANCE * METRE * tolerance.units() as f32
    }

    /// The share of the curves that have a site on their +1 side.
    ///
    /// `O(K M L)`: some 10,000 instructions for 16 x 16 x 3.
    pub fn share_above(&self, site: Site) -> f32 {
        self.nowhere[0] + self.grid.above(site, Self::blur(self.noise.tolerance))
    }

    /// [`share_above`](Self::share_above) for several sites, into as many places. Each costs less than one alone.
    pub(crate) fn shares_above(&self, sites: &[Site], shares: &mut [f32]) {
        self.grid.above_each(sites, Self::blur(self.noise.tolerance), shares);
        for share in shares.iter_mut() {
            *share += self.nowhere[0];
        }
    }

    /// The probability that there is no front.
    pub fn share_nowhere(&self) -> f32 {
        self.nowhere[0] + self.nowhere[1]
    }

    /// Whether there may be no front: with more than 5 % there is none, and one may have any direction.
    pub fn may_be_nowhere(&self) -> bool {
        self.is_open() && self.share_nowhere() > ABSENT
    }

    fn misfit(&self) -> f32 {
        if self.grid.lay.bend > 0.0 { MISFIT } else { 0.0 }
    }

    fn take(&mut self, site: Site, label: Label, tolerance: Tolerance) {
        let p = self.counted();
        let may_be_nowhere = self.may_be_nowhere();
        let chance = self.weigh(site, label, p, Self::blur(tolerance));
        // Labels that are all the same do not tell a sensor that is stuck from an area without a front.
        if !may_be_nowhere {
            self.evidence.observe(label, chance + self.misfit());
        }
        if let Some(learnt) = &mut self.learnt {
            // The share of the curves that agree makes the label as likely as it was.
            let sharp = 2.0 * p - 1.0;
            let agree = (chance - (1.0 - p)) / sharp;
            learnt.count(if sharp.abs() > SHARP { agree.clamp(0.0, 1.0) } else { 0.5 });
        }
        self.heard = site;
    }

    /// Whether a site is so far from the last label that another one tells something new.
    fn is_apart(&self, site: Site) -> bool {
        let bits = 1.0 - entropy(self.counted());
        distance(site - self.heard) * METRE * DENSEST > bits * self.grid.lay.step
    }

    /// Weighs all by a label that is true with probability `p`. Returns how likely the label was.
    pub(super) fn weigh(&mut self, site: Site, label: Label, p: f32, blur: f32) -> f32 {
        let weights = if label == Label::Positive { [p, 1.0 - p] } else { [1.0 - p, p] };
        let left = self.grid.weigh(site, blur, weights);
        let [plus, minus] = self.nowhere;
        let [plus, minus] = [plus * weights[0], minus * weights[1]];
        let chance = left + plus + minus;
        let (each, even) = (1.0 / chance, self.spreads());
        self.nowhere = [plus * each, minus * each];
        let more = even * (1.0 - self.share_nowhere()) / (K * M * L) as f32;
        self.grid.scale(each * (1.0 - even), more);
        chance
    }

    /// The evidence of the labels against what was told of the front and of the sensor. Labels count unless
    /// there [may be no front](Self::may_be_nowhere).
    pub const fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// The expected information of a label at a place with this share of the curves above, as a share of the most that
    /// a label can carry.
    pub(crate) fn tells(&self, share: f32) -> f32 {
        let p = self.counted();
        information(share, p, (p, 1.0 - entropy(p)))
    }

    /// What was told of the front.
    pub const fn front(&self) -> Front {
        self.front
    }

    /// Whether it was told about where the front is: between given points, or near a place.
    pub(crate) const fn is_near(&self) -> bool {
        self.is_near
    }

    /// Whether the front may have any direction.
    pub fn is_open(&self) -> bool {
        self.grid.lay.is_whole::<K>()
    }
}

impl<const K: usize, const M: usize, const L: usize> Belief for Tracker<K, M, L> {
    fn is_full(&self) -> bool {
        false
    }

    /// The cells stay where they are up to the end of the motion: `O(K M L)`, some 35,000 instructions for 16 x 16 x 3. A
    /// label that lies close to the last one does not count, nor one that is certain.
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let Reading::Side(label) = reading else { return Ok(false) };
        let is_unsure = || (UNSURE..1.0 - UNSURE).contains(&self.share_above(site));
        let tells = self.is_apart(site) && is_unsure();
        if tells {
            self.take(site, label, self.noise.tolerance);
        }
        Ok(tells)
    }

    fn tolerance(&self) -> Tolerance {
        self.noise.tolerance
    }

    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if tolerance > self.noise.tolerance {
            return Err(ObservationError::Tolerance(tolerance));
        }
        // A reading on the boundary agrees with both sides.
        if let Reading::Side(label) = reading {
            self.take(site, label, tolerance);
        }
        self.settle(site);
        Ok(())
    }

    fn estimates(&self) -> Estimates {
        Estimates { bisector: None, centre: self.centre(), maximum_margin: None }
    }

    fn centre(&self) -> Option<LocalLine> {
        let waist = self.waist();
        let along = waist.heading.unit().scaled(1 << 24);
        let line = || LocalLine::new(waist.site, along, 0.0, 0.0);
        if self.is_open() { None } else { line() }
    }

    fn information(&self) -> f64 {
        let lay = self.grid.lay;
        let whole = 1.0 - self.share_nowhere();
        let cell = libm::log2f(lay.turn * lay.step / L as f32) - self.start;
        let each = 1.0 / whole;
        let masses = self.grid.mass.iter().flatten().flatten().filter(|it| **it > 0.0);
        let bits: f32 = masses.map(|it| it * each * (libm::log2f(it * each) - cell)).sum();
        // The lines of a front that has moved on may be as many as at the start.
        if bits < 0.0 { 0.0 } else { f64::from(bits) }
    }

    /// Never: a front goes on.
    fn meets<C: Criterion>(&self, _: Goal<C>, _: Area) -> bool {
        false
    }

    fn chance(&self, site: Site) -> f64 {
        let (above, p) = (f64::from(self.share_above(site)), f64::from(self.counted()));
        p * above + (1.0 - p) * (1.0 - above)
    }

    /// For evidence it is more by the misfit.
    fn chance_of(&self, site: Site, label: Label) -> f32 {
        let above = self.chance(site) as f32;
        self.misfit() + if label == Label::Positive { above } else { 1.0 - above }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::belief::evidence::Alarm;
    use crate::belief::observation_log::FromLog as _;

    pub(crate) fn at(x: f64, z: f64) -> Site {
        Site::metres([x, z]).unwrap()
    }

    pub(crate) fn area() -> Area {
        Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap()
    }

    /// Goes to and fro across `z = 10 + 0.1 x`.
    pub(crate) fn fly(tracker: &mut Tracker<16, 16, 3>, labels: u32) {
        for k in 0..labels {
            let (x, aside) = (0.3 * f64::from(k), 0.4 * f64::from(k % 5) - 0.7);
            let site = at(x, 10.0 + 0.1 * x + aside);
            tracker.moved(site, 1.0);
            let label = if aside > 0.0 { Label::Positive } else { Label::Negative };
            tracker.observe(site, label.into()).unwrap();
        }
    }

    #[test]
    fn it_holds_as_little_as_it_says() {
        assert!(size_of::<Tracker<16, 16, 3>>() <= 4 * 768 + 8 * 16 + 150);
        assert!(size_of::<Tracker<24, 24, 1>>() <= 4 * 576 + 8 * 24 + 150);
    }

    #[test]
    fn it_finds_a_front_and_says_how_well() {
        let front = Front::bending(60.0).unwrap();
        let mut tracker = Tracker::new(area(), front, Noise::new(0.9).unwrap());
        fly(&mut tracker, 60);
        let waist = tracker.waist();
        let [x, z] = [waist.site.x(), waist.site.z()].map(|it| f64::from(it) / 65_536.0);
        let off = (z - 10.0 - 0.1 * x).abs();
        assert!(off < waist.half_width(0.95) && waist.half_width(0.9) < 0.5, "{waist:?}: {off}");
        assert!((waist.heading.radians() - 0.0997).abs() < 0.1, "{waist:?}");
        assert!(tracker.information() > 3.0 && tracker.share_nowhere() < 1e-3);
        assert!(tracker.evidence().value() < Alarm::WARNING);
        assert!(tracker.centre().is_some());
    }

    #[test]
    fn all_of_one_label_says_that_there_is_no_front() {
        let mut tracker = Tracker::<16, 16, 1>::new(area(), Front::STRAIGHT, Noise::NONE);
        for k in 0..200 {
            let site = at(1.0 + f64::from(k % 10) * 2.0, 1.0 + f64::from(k / 10 % 10) * 2.0);
            tracker.observe(site, Label::Positive.into()).unwrap();
        }
        assert!(tracker.share_nowhere() > 0.5, "{}", tracker.share_nowhere());
        assert!(tracker.share_above(at(10.0, 10.0)) > 0.9);
        // Nor does it say that the sensor is stuck.
        assert_eq!(tracker.evidence().alarm(), None);
    }

    #[test]
    fn a_sensor_that_is_stuck_raises_an_alarm() {
        let front = Front::bending(60.0).unwrap();
        let mut tracker = Tracker::new(area(), front, Noise::new(0.9).unwrap());
        fly(&mut tracker, 40);
        for labels in 0..40 {
            let site = tracker.waist().site;
            tracker.moved(site, 1.0);
            tracker.observe(site, Label::Positive.into()).unwrap();
            if tracker.evidence().value() >= Alarm::ALARM {
                assert!(labels > 4, "{labels}");
                tracker.seek_near(site, 12.0);
                assert!(tracker.waist().deviation > 6.0 && tracker.evidence().value() < 2.0);
                return;
            }
        }
        panic!("no alarm");
    }

    #[test]
    fn a_reliability_that_nobody_knows_is_learnt() {
        let front = Front::bending(60.0).unwrap();
        let noise = Noise::beta(8.0, 2.0).unwrap();
        let mut tracker = Tracker::<16, 16, 3>::new(area(), front, noise);
        assert!((tracker.reliability() - 0.8).abs() < 1e-6);
        fly(&mut tracker, 40);
        // Far from the front all labels are known, and nine of ten are true.
        for k in 0..100 {
            let z = if k % 2 == 0 { 3.0 } else { 17.0 };
            let label = if (z > 10.0) == (k % 10 > 0) { Label::Positive } else { Label::Negative };
            tracker.observe(at(6.0, z), label.into()).unwrap();
        }
        assert!((tracker.reliability() - 0.9).abs() < 0.03, "{}", tracker.reliability());
    }

    #[test]
    fn a_position_may_not_be_worse_than_was_told() {
        let noise = Noise::NONE.with_tolerance(0.3).unwrap();
        let mut tracker = Tracker::<16, 16, 1>::new(area(), Front::STRAIGHT, noise);
        let (site, reading) = (at(10.0, 10.0), Label::Positive.into());
        let worse = Tolerance::new(0.4).unwrap();
        assert_eq!(
            tracker.observe_within(site, reading, worse),
            Err(ObservationError::Tolerance(worse))
        );
        let before = tracker.log().masses;
        tracker.observe(site, Reading::Boundary).unwrap();
        assert_eq!(tracker.log().masses, before);
        tracker.observe_within(site, reading, Tolerance::NONE).unwrap();
        assert_ne!(tracker.log().masses, before);
    }
}
