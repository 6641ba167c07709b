//! The lines: takes in labels, and says what is known.

use crate::belief::estimate::Estimates;
use crate::belief::evidence::Evidence;
use crate::belief::front::{Learnt, Waist};
use crate::belief::goal::{Criterion, Goal};
use crate::belief::lines::grid::{Grid, Lay};
use crate::belief::noise::Noise;
use crate::belief::predictions::{entropy, information};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::{AnyReliability, Trust as _};
use crate::belief::{Belief, ObservationError};
use crate::geometry::approximate::{METRE, distance, sqrt};
use crate::geometry::area::Area;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;
use crate::geometry::local_line::LocalLine;

/// Labels count as true no more often than this, so that one false label does not rule out the truth.
const MOST: f32 = 0.98;

/// Positions that err by a deviation widen the edge of a label by so many of them, either way.
const WIDER: f32 = 1.5;

/// A tolerance is so many deviations.
const TOLERANCE: f32 = 3.0;

/// A line is found where there is none with a probability of at most this.
const ABSENT: f32 = 0.05;

/// And where its direction has a deviation below this, radians.
const DIRECTED: f32 = 0.5;

/// A label says nothing of its reliability where that is nearer to a half than this, doubled.
const SHARP: f32 = 1e-3;

/// On the way, labels count where so much of the lines disagree.
const UNSURE: f32 = 1e-3;

/// The most bits that labels on the way may carry for each width of a cell. Closer labels would seem to part a cell, and
/// rule out the part that the line is in.
const DENSEST: f32 = 0.25;

/// What there is besides a line: everywhere +1, and everywhere -1. Their share at the start, together.
const NOWHERE: f32 = 0.1;

/// With this probability there is none for sure.
const ALL: f32 = 0.9999;

/// Given points are weighed so many times, each time among fewer lines.
const GIVEN_ROUNDS: u32 = 4;

/// What is known of a line: `K` directions and `M` offsets, 16 x 16 or more. It takes `4 K M + 8 K` bytes and some 150.
///
/// ```
/// # use planner_core::{Area, Belief as _, Label, Lines, Noise, Site};
/// let area = Area::metres([0.0, 0.0], [40.0, 40.0])?;
/// let mut lines = Lines::<16, 16>::new(area, Noise::new(0.9)?);
/// for k in 0..60 {
///     // A robot that goes to and fro across a boundary at z = 20.
///     let (x, z) = (f64::from(k) * 0.5, 20.0 + f64::from(k % 4) - 1.5);
///     let label = if z > 20.0 { Label::Positive } else { Label::Negative };
///     lines.observe(Site::metres([x, z])?, label.into())?;
/// }
/// let waist = lines.waist();
/// assert!((f64::from(waist.site.z()) / 65_536.0 - 20.0).abs() < waist.half_width(0.99));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lines<const K: usize, const M: usize> {
    pub(super) noise: Noise<AnyReliability>,
    pub(super) grid: Grid<K, M>,
    /// Everywhere +1, everywhere -1.
    pub(super) nowhere: [f32; 2],
    /// What labels have said of a reliability that nobody knows.
    pub(super) learnt: Option<Learnt>,
    pub(super) evidence: Evidence,
    /// Where a label counted last.
    pub(super) heard: Site,
    /// The logarithm to the base 2 of the measure of all lines at the start.
    pub(super) start: f32,
    /// Whether it was told about where the line is.
    pub(super) is_near: bool,
}

impl<const K: usize, const M: usize> Lines<K, M> {
    /// Nothing is known but that a line may cross an area. With a probability of a tenth there is none: all of the area is
    /// +1, or all of it is -1.
    ///
    /// The noise has the reliability of labels, or a prior for it, and the tolerance: three standard deviations of a
    /// position. No ball is trusted.
    pub fn new(area: Area, noise: impl Into<Noise<AnyReliability>>) -> Self {
        let mut lines = Self::blank();
        lines.restart(area, noise.into(), &[]);
        lines
    }

    /// Memory to [`restart`](Self::restart) in.
    pub(crate) const fn blank() -> Self {
        const NO_NOISE: Noise<AnyReliability> = Noise {
            reliability: AnyReliability::Known(Reliability::CERTAIN),
            trusted_radius: 0,
            tolerance: Tolerance::NONE,
        };
        Self {
            noise: NO_NOISE,
            grid: Grid::NONE,
            nowhere: [0.0; 2],
            learnt: None,
            evidence: Evidence::NONE,
            heard: Site::ORIGIN,
            start: 0.0,
            is_near: false,
        }
    }

    /// Begins again, where it is, as [`new`](Self::new) and [`given`](Self::given) do.
    pub(crate) fn restart(&mut self, area: Area, noise: Noise<AnyReliability>, given: &[Sample]) {
        let prior = noise.reliability.unknown();
        self.learnt = prior.map(|it| Learnt::prior(it.parameters().map(|it| it as f32)));
        self.noise = noise;
        self.start = self.fill_within(area);
        self.give(given);
    }

    /// Spreads the mass evenly over the lines that cross a rectangle. Returns the logarithm of their measure to the base 2.
    fn fill_within(&mut self, area: Area) -> f32 {
        (self.evidence, self.is_near) = (Evidence::NONE, false);
        self.nowhere = [0.5 * NOWHERE; 2];
        let [x, z] = area.half_sides().map(|it| it as f32 * METRE);
        let far = sqrt(x * x + z * z);
        let lay = Lay {
            pivot: area.middle(),
            heading: Heading(0),
            turn: core::f32::consts::TAU / K as f32,
            low: -far,
            step: 2.0 * far / M as f32,
        };
        self.grid.set(lay);
        for (column, along) in self.grid.mass.iter_mut().zip(&self.grid.along) {
            let reach = along.z.abs() * x + along.x.abs() * z;
            let mut low = lay.low;
            for mass in column {
                let from = if low > -reach { low } else { -reach };
                let until = low + lay.step;
                let until = if until < reach { until } else { reach };
                *mass = if until > from { until - from } else { 0.0 };
                low += lay.step;
            }
        }
        let whole: f32 = self.grid.cells().map(|it| *it).sum();
        self.grid.scale((1.0 - NOWHERE) / whole, 0.0);
        libm::log2f(whole * lay.turn)
    }

    /// The same after some points whose labels are known: of the lines those that agree with them. If they have both
    /// labels, the line lies between them. Call it before anything else. The order of the points counts little, and the
    /// information is measured from here.
    #[must_use]
    pub fn given(mut self, given: &[Sample]) -> Self {
        self.give(given);
        self
    }

    /// The same, where it is.
    pub(crate) fn give(&mut self, given: &[Sample]) {
        let has = |label| given.iter().any(|it| it.label == label);
        let is_between = has(Label::Positive) && has(Label::Negative);
        if let Some(between) = Area::around(given.iter().map(|it| it.site)).filter(|_| is_between) {
            self.start = self.fill_within(between);
            self.is_near = true;
        }
        // Points of one label do not bound the line, and count once.
        for round in 0..if is_between { GIVEN_ROUNDS } else { 1 } {
            if round > 0 {
                let each = (1.0 - self.share_nowhere()) / (K * M) as f32;
                self.grid.cells().for_each(|mass| *mass = each);
            }
            for &Sample { site, label } in given {
                self.weigh(site, label, MOST, 0.0);
            }
            self.grid.settle();
        }
        self.start -= self.information() as f32;
    }

    /// Begins again in a square, with labels that were read there. A line crosses it, but for a probability of `nowhere`.
    /// That counts these labels already.
    pub(crate) fn close_in(
        &mut self,
        square: Area,
        labels: impl Iterator<Item = Sample>,
        nowhere: f32,
    ) {
        self.start = self.fill_within(square);
        let (p, blur) = (self.counted(), Self::blur(self.noise.tolerance));
        for Sample { site, label } in labels {
            self.weigh(site, label, p, blur);
        }
        let absent = self.share_nowhere();
        // All of them agree that there is none: the odds stay as they are.
        if absent < ALL {
            let [plus, minus] = self.nowhere;
            let share = if absent > 0.0 { nowhere / absent } else { 0.0 };
            self.nowhere = [plus * share, minus * share];
            self.grid.scale((1.0 - self.share_nowhere()) / (1.0 - absent), 0.0);
        }
        self.grid.settle();
        self.is_near = true;
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
    fn blur(tolerance: Tolerance) -> f32 {
        WIDER / TOLERANCE * METRE * tolerance.units() as f32
    }

    /// The share of the lines that have a site on their +1 side.
    pub fn share_above(&self, site: Site) -> f32 {
        self.nowhere[0] + self.grid.above(site, Self::blur(self.noise.tolerance))
    }

    /// The probability that there is no line.
    pub fn share_nowhere(&self) -> f32 {
        self.nowhere[0] + self.nowhere[1]
    }

    /// Whether there may be no line: with more than 5 % there is none, and one may have any direction.
    pub fn may_be_nowhere(&self) -> bool {
        self.is_open() && self.share_nowhere() > ABSENT
    }

    fn take(&mut self, site: Site, label: Label, tolerance: Tolerance) {
        let p = self.counted();
        let may_be_nowhere = self.may_be_nowhere();
        let chance = self.weigh(site, label, p, Self::blur(tolerance));
        // Labels that are all the same do not tell a sensor that is stuck from an area without a line.
        if !may_be_nowhere {
            self.evidence.observe(label, chance);
        }
        if let Some(learnt) = &mut self.learnt {
            // The share of the lines that agree makes the label as likely as it was.
            let sharp = 2.0 * p - 1.0;
            let agree = (chance - (1.0 - p)) / sharp;
            learnt.count(if sharp.abs() > SHARP { agree.clamp(0.0, 1.0) } else { 0.5 });
        }
        self.heard = site;
    }

    /// Weighs all by a label that is true with probability `p`. Returns how likely the label was.
    fn weigh(&mut self, site: Site, label: Label, p: f32, blur: f32) -> f32 {
        let weights = if label == Label::Positive { [p, 1.0 - p] } else { [1.0 - p, p] };
        let left = self.grid.weigh(site, blur, weights);
        let [plus, minus] = self.nowhere;
        let [plus, minus] = [plus * weights[0], minus * weights[1]];
        let chance = left + plus + minus;
        let each = 1.0 / chance;
        self.nowhere = [plus * each, minus * each];
        self.grid.scale(each, 0.0);
        chance
    }

    /// The evidence of the labels against what was told of the sensor, and against a line. Labels count unless there
    /// [may be none](Self::may_be_nowhere).
    pub const fn evidence(&self) -> &Evidence {
        &self.evidence
    }

    /// The expected information of a label at a place with this share of the lines above, as a share of the most that
    /// a label can carry.
    pub(crate) fn tells(&self, share: f32) -> f32 {
        let p = self.counted();
        information(share, p, (p, 1.0 - entropy(p)))
    }

    /// Whether it was told about where the line is: between given points, or near a place.
    pub(crate) const fn is_near(&self) -> bool {
        self.is_near
    }

    /// Whether the line may have any direction.
    pub fn is_open(&self) -> bool {
        self.grid.lay.is_whole::<K>()
    }

    /// Where the line is known best. Of no meaning before it is found.
    pub fn waist(&self) -> Waist {
        let (moments, lay) = (self.grid.moments(), self.grid.lay);
        let [turns, offsets] = moments.variance;
        let variance = offsets - moments.covariance * moments.covariance / turns;
        Waist {
            site: self.grid.waist(&moments),
            heading: self.grid.heading(&moments),
            curvature: 0.0,
            deviation: lay.step * sqrt(variance),
            turn_deviation: lay.turn * sqrt(turns),
        }
    }

    /// Where the line is known best, if it is found. There it lies within so many metres with 90 %, and its direction
    /// has a deviation below half a radian. With 95 % there is one.
    pub fn found(&self, within: f32) -> Option<Waist> {
        if self.is_open() || self.share_nowhere() > ABSENT {
            return None;
        }
        let waist = self.waist();
        let is_near = waist.ninety() <= within;
        (is_near && waist.turn_deviation < DIRECTED).then_some(waist)
    }
}

impl<const K: usize, const M: usize> Belief for Lines<K, M> {
    fn is_full(&self) -> bool {
        false
    }

    /// The cells stay where they are up to the end of the motion. A label that lies close to the last one does not count,
    /// nor one that is certain.
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let Reading::Side(label) = reading else { return Ok(false) };
        let bits = 1.0 - entropy(self.counted());
        let apart = distance(site - self.heard) * METRE;
        let tells = apart * DENSEST > bits * self.grid.lay.step
            && (UNSURE..1.0 - UNSURE).contains(&self.share_above(site));
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
        self.grid.settle();
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
        let cell = libm::log2f(lay.turn * lay.step) - self.start;
        let each = 1.0 / whole;
        let masses = self.grid.mass.iter().flatten().filter(|it| **it > 0.0);
        let bits: f32 = masses.map(|it| it * each * (libm::log2f(it * each) - cell)).sum();
        if bits < 0.0 { 0.0 } else { f64::from(bits) }
    }

    /// Never: nobody asks.
    fn meets<C: Criterion>(&self, _: Goal<C>, _: Area) -> bool {
        false
    }

    fn chance(&self, site: Site) -> f64 {
        let (above, p) = (f64::from(self.share_above(site)), f64::from(self.counted()));
        p * above + (1.0 - p) * (1.0 - above)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn at(x: f64, z: f64) -> Site {
        Site::metres([x, z]).unwrap()
    }

    pub(crate) fn area() -> Area {
        Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap()
    }

    /// Goes to and fro across `z = 10 + 0.1 x`.
    pub(crate) fn fly(lines: &mut Lines<16, 16>, labels: u32) {
        for k in 0..labels {
            let (x, aside) = (0.3 * f64::from(k), 0.4 * f64::from(k % 5) - 0.7);
            let label = if aside > 0.0 { Label::Positive } else { Label::Negative };
            lines.observe(at(x, 10.0 + 0.1 * x + aside), label.into()).unwrap();
        }
    }

    #[test]
    fn it_holds_as_little_as_it_says() {
        assert!(size_of::<Lines<16, 16>>() <= 4 * 256 + 8 * 16 + 150);
    }

    #[test]
    fn at_the_start_any_line_of_the_area_is_as_likely() {
        let lines = Lines::<16, 16>::new(area(), Noise::NONE);
        assert!(lines.is_open() && lines.centre().is_none());
        // The cells at the corners are not full.
        assert!(lines.information().abs() < 0.1, "{}", lines.information());
        for (x, z) in [(10.0, 10.0), (2.0, 3.0), (18.0, 1.0)] {
            assert!((lines.share_above(at(x, z)) - 0.5).abs() < 0.01);
        }
    }

    #[test]
    fn given_points_say_where_to_begin() {
        let places = [(4.0, 6.0), (15.0, 8.0), (5.0, 13.0), (16.0, 15.0)];
        let given = places.map(|(x, z)| {
            let label = if z > 10.0 { Label::Positive } else { Label::Negative };
            Sample { site: at(x, z), label }
        });
        for labels in [&given[..], &given[..2]] {
            let lines = Lines::<16, 16>::new(area(), Noise::NONE).given(labels);
            for Sample { site, label } in labels {
                let above = lines.share_above(*site);
                let agree = if *label == Label::Positive { above } else { 1.0 - above };
                assert!(agree > 0.9, "{agree}");
            }
            let is_known = labels.len() > 2;
            assert_eq!(lines.is_open(), !is_known);
            assert!(!is_known || lines.waist().turn_deviation < 0.6);
        }
    }

    #[test]
    fn it_finds_a_line_and_says_how_well() {
        let mut lines = Lines::new(area(), Noise::new(0.9).unwrap());
        fly(&mut lines, 60);
        let waist = lines.waist();
        let [x, z] = [waist.site.x(), waist.site.z()].map(|it| f64::from(it) / 65_536.0);
        let off = (z - 10.0 - 0.1 * x).abs();
        assert!(off < waist.half_width(0.95) && waist.half_width(0.9) < 0.5, "{waist:?}: {off}");
        assert!((waist.heading.radians() - 0.0997).abs() < 0.1, "{waist:?}");
        assert!(lines.information() > 3.0 && lines.share_nowhere() < 1e-3);
        assert!(lines.evidence().alarm().is_none() && lines.centre().is_some());
    }

    #[test]
    fn all_of_one_label_says_that_there_is_no_line() {
        let mut lines = Lines::<16, 16>::new(area(), Noise::NONE);
        for k in 0..200 {
            let site = at(1.0 + f64::from(k % 10) * 2.0, 1.0 + f64::from(k / 10 % 10) * 2.0);
            lines.observe(site, Label::Positive.into()).unwrap();
        }
        assert!(lines.share_nowhere() > 0.5, "{}", lines.share_nowhere());
        assert!(lines.share_above(at(10.0, 10.0)) > 0.9);
        // Nor does it say that the sensor is stuck.
        assert_eq!(lines.evidence().alarm(), None);
    }

    #[test]
    fn a_reliability_that_nobody_knows_is_learnt() {
        let mut lines = Lines::new(area(), Noise::beta(8.0, 2.0).unwrap());
        assert!((lines.reliability() - 0.8).abs() < 1e-6);
        fly(&mut lines, 40);
        // Far from the line all labels are known, and nine of ten are true.
        for k in 0..100 {
            let z = if k % 2 == 0 { 3.0 } else { 17.0 };
            let label = if (z > 10.0) == (k % 10 > 0) { Label::Positive } else { Label::Negative };
            lines.observe(at(6.0, z), label.into()).unwrap();
        }
        assert!((lines.reliability() - 0.9).abs() < 0.03, "{}", lines.reliability());
    }

    #[test]
    fn a_position_may_not_be_worse_than_was_told() {
        let noise = Noise::NONE.with_tolerance(0.3).unwrap();
        let mut lines = Lines::<16, 16>::new(area(), noise);
        let (site, reading) = (at(10.0, 10.0), Label::Positive.into());
        let worse = Tolerance::new(0.4).unwrap();
        let refused = Err(ObservationError::Tolerance(worse));
        assert_eq!(lines.observe_within(site, reading, worse), refused);
        let before = lines.grid.mass;
        lines.observe(site, Reading::Boundary).unwrap();
        assert_eq!(lines.grid.mass, before);
        lines.observe_within(site, reading, Tolerance::NONE).unwrap();
        assert_ne!(lines.grid.mass, before);
    }
}
