//! A curve in arc length: takes in motions and labels, and says where the front is.

use crate::belief::curve::arc::Arc;
use crate::belief::curve::bank::{Bank, FrontLabel, Offsets};
use crate::belief::curve::gaussian::PLACES;
use crate::belief::curve::start::{FrontStart, nearest_pair};
use crate::belief::evidence::Evidence;
use crate::belief::front::{Front, Learnt, Waist, angle, limited};
use crate::belief::noise::Noise;
use crate::belief::predictions::{entropy, information};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::{AnyReliability, Trust as _};
use crate::geometry::approximate::{METRE, sqrt};
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::Site;
use crate::geometry::value::ValueError;

/// A label is false with this chance at least, so that one false label does not rule out the truth.
const LEAST: f32 = 0.003;

/// The place of a label is blurred by this share of a reach at least.
pub(super) const BLUR: f32 = 0.005;

/// A tolerance is so many deviations.
const TOLERANCE: f32 = 3.0;

/// Places behind are so far apart, reaches.
const APART: f32 = 0.5;

/// The arc bends no more than so much in a reach.
const MOST_BEND: f32 = 0.8;

/// It is turned by no more than this at once, radians.
const MOST_TURN: f32 = 1.0;

/// So many places leave at once at most: those that a motion passes, and all where the robot turns at its end.
const LEFT_AT_ONCE: usize = PLACES + 4;

/// A way is taken in pieces of a reach at most, and in so many of them.
const PIECES: u32 = 8;

/// A shorter way is none, reaches.
const STILL: f32 = 1e-5;

/// The deviation of the way of a front in a unit of time since a place was passed, as a share of the most that it moves.
pub(super) const DRIFTS: f32 = 0.8;

/// The same beside the robot, where labels follow it.
const BESIDE: f32 = 0.3;

/// A place is as good as it gets when that is more than this share of its deviation.
const STALE: f32 = 0.3;

/// Where a front is begun that was known before, its deviations are no less than this, in reaches and radians.
const AGAIN: f32 = 0.02;

/// Beside a front that is known, there is none with this probability at least, for either label: it may be lost.
const LEFT: f32 = 1e-4;

/// There is a front for sure where there is none with less than this.
const ABSENT: f32 = 0.01;

/// After an alarm the front has these deviations of offset, in reaches, and of direction, in radians.
const ANEW: [f32; 2] = [0.5, 0.6];

/// A place of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MapPlace {
    /// Where the front is there.
    pub waist: Waist,
    /// The robot passed it so many units of time ago.
    pub age: f32,
    /// Whether a piece of the map begins with it: the robot did not come here along the front.
    pub begins: bool,
}

/// A place that was passed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Passed {
    pub(super) arc: Arc,
    pub(super) age: f32,
    pub(super) begins: bool,
}

/// What is known of a front beside a robot that goes along it. Nothing is told of how it bends.
///
/// It takes 3.7 kB. A label and a motion take time that does not depend on how many there were.
///
/// ```
/// # use planner_core::{
/// #     Belief as _, Curve, Front, Heading, Label, Noise, Sample, Site,
/// # };
/// let side = |z: f64| if z > 20.0 { Label::Positive } else { Label::Negative };
/// let sample = |z: f64| Ok::<_, Box<dyn std::error::Error>>(Sample { site: Site::metres([0.0, z])?, label: side(z) });
/// let given = [sample(18.0)?, sample(22.0)?];
/// let mut curve = Curve::between(&given, Heading::default(), 1.0, Front::STRAIGHT, Noise::new(0.9)?)?;
/// for k in 1..40 {
///     // A robot that goes to and fro across a front at z = 20.
///     let (x, z) = (f64::from(k) * 0.5, 20.0 + 0.2 * f64::from(k % 4) - 0.3);
///     let site = Site::metres([x, z])?;
///     curve.moved(site, 1.0);
///     curve.observe(site, side(z).into())?;
/// }
/// let waist = curve.now();
/// assert!((f64::from(waist.site.z()) / 65_536.0 - 20.0).abs() < waist.half_width(0.99));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Curve {
    /// Metres in a reach.
    pub(super) reach: f32,
    /// Metres in a unit of time.
    pub(super) pace: f32,
    /// Places of the map lie between these corners, and are known to within so many metres.
    map: ([Site; 2], f32),
    pub(super) noise: Noise<AnyReliability>,
    /// What labels have said of a reliability that nobody knows.
    pub(super) learnt: Option<Learnt>,
    /// The robot's way along the front, from beside it on.
    pub(super) arc: Arc,
    /// Whether the front's +1 side is to the right of this way.
    pub(super) is_flipped: bool,
    pub(super) bank: Bank,
    pub(super) passed: heapless::Deque<Passed, PLACES>,
    /// How far the arc has gone since the last of these, reaches.
    pub(super) since: f32,
    pub(super) evidence: Evidence,
    /// The last label, and how many were the same.
    pub(super) run: (Option<Label>, u8),
    /// Places that have left the window since the last plan, the oldest first.
    pub(super) mapped: heapless::Vec<MapPlace, LEFT_AT_ONCE, u8>,
    /// The probability that there is no front here, and all of the ground is +1, or is -1.
    pub(super) nowhere: [f32; 2],
    /// How often labels spoke against it since the last place that was passed.
    pub(super) doubts: u8,
    pub(super) is_begun: bool,
    /// Whether no place was passed since it began.
    pub(super) is_fresh: bool,
}

impl Curve {
    /// A front between those two given samples that differ and are the nearest to each other. The robot goes along it the
    /// way that it faces, in motions of `reach` metres at most. Of `front` the speed counts alone.
    ///
    /// # Errors
    /// [`ValueError`] if all samples have one label, and for a reach that is not from 0.001 to 1,000 m.
    pub fn between(
        given: &[Sample],
        facing: Heading,
        reach: f64,
        front: Front,
        noise: impl Into<Noise<AnyReliability>>,
    ) -> Result<Self, ValueError> {
        const ONE_LABEL: ValueError = ValueError("a front lies between two samples that differ");
        const REACH: ValueError = ValueError("the longest motion is from 0.001 to 1000 m");
        if !(1e-3..=1e3).contains(&reach) {
            return Err(REACH);
        }
        let mut curve = Self::NONE;
        curve.restart((reach as f32, front), (Site::CORNERS, f32::INFINITY), noise.into());
        let pair = nearest_pair(given).ok_or(ONE_LABEL)?;
        curve.begin(pair, given);
        curve.face(facing);
        Ok(curve)
    }

    /// Nothing is known yet.
    pub(crate) const NONE: Self = {
        const NO_NOISE: Noise<AnyReliability> = Noise {
            reliability: AnyReliability::Known(Reliability::CERTAIN),
            trusted_radius: 0,
            tolerance: Tolerance::NONE,
        };
        Self {
            reach: 1.0,
            pace: 0.0,
            map: (Site::CORNERS, f32::INFINITY),
            noise: NO_NOISE,
            learnt: None,
            arc: Arc { site: Site::ORIGIN, heading: Heading(0), bend: 0.0 },
            is_flipped: false,
            bank: Bank::NONE,
            passed: heapless::Deque::new(),
            since: 0.0,
            evidence: Evidence::NONE,
            run: (None, 0),
            mapped: heapless::Vec::new(),
            nowhere: [0.0; 2],
            doubts: 0,
            is_begun: false,
            is_fresh: true,
        }
    };

    /// Forgets all, where it is: it is large. The longest motion has so many metres. The map lies between two
    /// corners, and its places are known to within so many metres.
    pub(crate) fn restart(
        &mut self,
        (reach, front): (f32, Front),
        map: ([Site; 2], f32),
        noise: Noise<AnyReliability>,
    ) {
        self.map = map;
        let prior = noise.reliability.unknown();
        self.learnt = prior.map(|it| Learnt::prior(it.parameters().map(|it| it as f32)));
        (self.reach, self.pace, self.noise) = (reach, front.pace(), noise);
        self.passed.clear();
        self.mapped.clear();
        self.bank.forget();
        (self.evidence, self.doubts, self.is_begun) = (Evidence::NONE, 0, false);
        (self.nowhere, self.is_fresh) = ([0.0; 2], true);
    }

    /// Begins across the way between two sites, where some labels changed. The robot goes along the front's own direction.
    pub(crate) fn begin(&mut self, between: [Site; 2], labels: &[Sample]) {
        let FrontStart { site, heading, deviation } =
            FrontStart::across(between, labels, LEAST, self.reach);
        self.leave();
        self.is_flipped = false;
        self.set(Arc { site, heading, bend: 0.0 }, deviation);
    }

    /// The robot goes along the front the way that it faces. Just after the beginning, when both ways look the same.
    pub(crate) fn face(&mut self, facing: Heading) {
        if !facing.agrees(self.arc.heading) {
            self.is_flipped = !self.is_flipped;
            self.arc.heading = self.arc.heading.turned(Angle::HALF_TURN);
        }
    }

    /// Begins where the front was known before, in one of the two directions. It has moved on for so long since.
    pub(crate) fn begin_at(&mut self, waist: Waist, (is_flipped, age): (bool, f32)) {
        self.leave(); // as it goes now
        self.is_flipped = is_flipped;
        let heading = self.along(waist.heading);
        let bend = if is_flipped { -waist.curvature } else { waist.curvature };
        let moved = DRIFTS * self.pace * age;
        let offset = sqrt(waist.deviation * waist.deviation + moved * moved) / self.reach;
        let turn = waist.turn_deviation;
        let deviations = [offset, turn].map(|it| if it > AGAIN { it } else { AGAIN });
        self.set(Arc { site: waist.site, heading, bend }, deviations);
    }

    /// The robot turns round, and goes back along the front. A steady motion shows as a turn to the other side from now on.
    pub(crate) fn turn_round(&mut self) {
        self.drop_all();
        self.is_flipped = !self.is_flipped;
        let Arc { site, heading, bend } = self.arc;
        self.arc = Arc { site, heading: heading.turned(Angle::HALF_TURN), bend: -bend };
        let turns = 2.0 * DRIFTS * self.pace / self.reach;
        self.bank.turn_round(turns * turns);
        (self.since, self.is_fresh) = (0.0, true);
    }

    fn set(&mut self, arc: Arc, deviations: [f32; 2]) {
        self.arc = arc;
        self.bank.begin(deviations);
        (self.since, self.run) = (0.0, (None, 0));
        (self.doubts, self.is_begun, self.nowhere) = (0, true, [0.0; 2]);
        self.is_fresh = true;
    }

    /// There may be no front with a probability.
    pub(crate) fn doubt(&mut self, nowhere: f32) {
        self.nowhere = [0.5 * nowhere; 2];
    }

    /// The robot leaves the front. What it has passed is on the map.
    pub(crate) fn leave(&mut self) {
        self.drop_all();
        self.is_begun = false;
    }

    fn drop_all(&mut self) {
        while !self.passed.is_empty() {
            self.drop_last();
        }
    }

    /// There is no such front: the last places are not on the map.
    pub(crate) fn lose(&mut self) {
        self.passed.clear();
        if !self.is_alarmed() {
            self.evidence = Evidence::NONE;
        }
        self.leave();
    }

    /// The robot's direction along the front, of the front's own; and the other way round.
    pub(super) const fn along(&self, heading: Heading) -> Heading {
        if self.is_flipped { heading.turned(Angle::HALF_TURN) } else { heading }
    }

    /// The chance that a label is false, as far as that is known.
    pub(crate) fn error(&self) -> f32 {
        let p = match (self.learnt, self.noise.reliability) {
            (Some(learnt), _) => learnt.mean(),
            (None, AnyReliability::Known(known)) => known.single(),
            (None, AnyReliability::Unknown(_)) => 0.5, // it is learnt
        };
        0.5 + limited(0.5 - p, 0.5 - LEAST)
    }

    /// How often a label is true, as far as that is known.
    pub fn reliability(&self) -> f32 {
        1.0 - self.error()
    }

    /// The deviation of where a label is read, reaches.
    pub(super) fn blur(&self, tolerance: Tolerance) -> f32 {
        let told = tolerance.units() as f32 * METRE / (TOLERANCE * self.reach);
        if told > BLUR { told } else { BLUR }
    }

    /// The robot has come to a site, in so many units of time.
    pub fn moved(&mut self, site: Site, time: f32) {
        self.go_to(site);
        let grown = BESIDE * self.pace * time / self.reach;
        if grown > 0.0 {
            self.bank.widen(grown * grown);
        }
        for it in &mut self.passed {
            it.age += time;
        }
        self.let_go();
    }

    /// Goes on along the arc to beside a site.
    pub(super) fn go_to(&mut self, site: Site) {
        let mut gone = 0.0;
        for _ in 0..PIECES {
            let way = self.arc.see(site).along / self.reach;
            let piece = limited(way, 1.0);
            self.go(piece);
            gone += piece.abs();
            if way.abs() <= 1.0 {
                break;
            }
        }
        if gone > STILL {
            if self.pace == 0.0 {
                self.bank.learn(gone);
            }
            self.bank.mix(gone);
        }
    }

    /// Goes on along the arc, back if the way is negative. Places are passed on the way.
    fn go(&mut self, way: f32) {
        let mut left = way;
        while self.since + left >= APART {
            let piece = APART - self.since;
            self.advance(piece);
            self.pass();
            left -= piece;
        }
        self.advance(left);
    }

    fn advance(&mut self, way: f32) {
        if way.abs() > STILL {
            self.bank.advance(way, self.arc.bend * self.reach);
            self.arc = self.arc.from(way * self.reach);
        }
        self.since += way;
        if self.passed.is_empty() && self.since < 0.0 {
            // It begins behind where the front was told: the map does so too.
            self.since = 0.0;
        }
    }

    fn pass(&mut self) {
        if self.passed.is_full() {
            self.drop_last();
        }
        self.bank.pass();
        (self.since, self.doubts) = (0.0, 0);
        let begins = core::mem::replace(&mut self.is_fresh, false);
        let _ = self.passed.push_front(Passed { arc: self.arc, age: 0.0, begins }); // there is room
    }

    /// The last place is done with: it is on the map if it counts. If not, a piece of the map begins with the next.
    fn drop_last(&mut self) {
        let gone = self.place(self.passed.len().saturating_sub(1));
        let _ = self.passed.pop_back();
        let Some(gone) = gone else { return };
        if self.counts(&gone.waist) {
            if self.mapped.is_full() {
                let first = self.mapped.remove(0); // the robot was carried here
                if let Some(next) = self.mapped.first_mut() {
                    next.begins |= first.begins;
                }
            }
            let _ = self.mapped.push(gone); // there is room
        } else {
            match self.passed.back_mut() {
                Some(next) => next.begins = true,
                None => self.is_fresh = true,
            }
        }
    }

    /// Whether a place is known well enough for the map, and lies in its area.
    pub(super) fn counts(&self, waist: &Waist) -> bool {
        let (([min, max], within), site) = (self.map, waist.site);
        let is_in =
            (min.x()..=max.x()).contains(&site.x()) && (min.z()..=max.z()).contains(&site.z());
        is_in && waist.ninety() <= within
    }

    /// A front that moves leaves the places behind. They are done with when that widens them by more than labels narrow them.
    fn let_go(&mut self) {
        while let Some(Passed { age, .. }) = self.passed.back() {
            let moved = DRIFTS * self.pace * age;
            let last = self.passed.len().saturating_sub(1);
            if moved <= STALE * self.bank.behind(last).deviation() * self.reach {
                break;
            }
            self.drop_last();
        }
    }

    /// Takes in a label. Returns how likely it was.
    pub(super) fn hear(&mut self, site: Site, label: Label, blur: f32) -> f32 {
        let left = self.arc.see(site).left / self.reach;
        let is_left = (label == Label::Positive) != self.is_flipped;
        let (sign, errs) = (if is_left { 1.0 } else { -1.0 }, self.error());
        let chance = self.bank.hear(FrontLabel { sign, left, errs, blur: blur * blur });
        let [plus, minus] = self.nowhere;
        let agrees = if label == Label::Positive { [1.0 - errs, errs] } else { [errs, 1.0 - errs] };
        let [plus, minus] = [plus * agrees[0], minus * agrees[1]];
        let whole = (1.0 - self.share_nowhere()) * chance + plus + minus;
        let share = |it: f32| if it > LEFT * whole { it / whole } else { LEFT };
        self.nowhere = [share(plus), share(minus)];
        if let Some(learnt) = &mut self.learnt {
            let sharp = 1.0 - 2.0 * errs;
            let agree = (chance - errs) / sharp;
            learnt.count(if sharp.abs() > LEAST { 0.5 + limited(agree - 0.5, 0.5) } else { 0.5 });
        }
        self.centre();
        chance
    }

    /// Moves the arc onto the mean front.
    fn centre(&mut self) {
        let offset = self.bank.ahead(0.0, 0.0).mean();
        let [turn, bend, _] = self.bank.direction();
        let turn = limited(turn, MOST_TURN);
        let before = self.arc.bend * self.reach;
        let after = limited(before + bend, MOST_BEND);
        self.arc = Arc {
            site: self.arc.site_at(0.0, offset * self.reach),
            heading: self.arc.heading.turned(angle(turn)),
            bend: after / self.reach,
        };
        self.bank.shift([offset, turn, after - before]);
    }

    /// Labels speak against what is known: the front is sought where it was known last, in any direction near that it had.
    pub(super) fn begin_again(&mut self) {
        if let Some(Passed { arc, .. }) = self.passed.back() {
            self.arc = Arc { bend: 0.0, ..*arc };
        }
        self.passed.clear(); // labels speak against these
        let doubts = self.doubts.saturating_add(1);
        self.set(self.arc, ANEW);
        self.doubts = doubts;
    }

    /// Whether an alarm was raised by the last label. The evidence is kept until the next one, for whoever asks.
    pub(super) fn is_alarmed(&self) -> bool {
        self.evidence.alarm().is_some_and(|it| it.is_grave())
    }

    /// How often labels have spoken against it since a place was passed.
    pub(crate) const fn doubts(&self) -> u8 {
        self.doubts
    }

    /// The probability that there is no front here.
    pub(crate) fn share_nowhere(&self) -> f32 {
        self.nowhere.iter().sum()
    }

    /// Whether there is a front for sure.
    pub(crate) fn is_sure(&self) -> bool {
        self.is_begun && self.share_nowhere() < ABSENT
    }

    /// Whether the robot goes against the front's own direction.
    pub(crate) const fn is_flipped(&self) -> bool {
        self.is_flipped
    }

    /// The expected information of a label at a place with this share of the curves above, as a share of the most that a
    /// label can carry.
    pub(crate) fn tells(&self, share: f32) -> f32 {
        let errs = self.error();
        information(share, 1.0 - errs, (1.0 - errs, 1.0 - entropy(errs)))
    }

    /// The side of the robot's way on which the last labels were not: 1 to the left, -1 to the right. 0 where they differ.
    pub(crate) fn neglected(&self) -> f32 {
        match self.run {
            (Some(label), 2..) if (label == Label::Positive) != self.is_flipped => -1.0,
            (Some(_), 2..) => 1.0,
            _ => 0.0,
        }
    }

    /// Where a site lies along the arc and to its left, reaches.
    pub(crate) fn see(&self, site: Site) -> [f32; 2] {
        let seen = self.arc.see(site);
        [seen.along / self.reach, seen.left / self.reach]
    }

    /// Where the front lies so far ahead.
    pub(crate) fn ahead(&self, way: f32) -> Offsets {
        self.bank.ahead(way, 0.0)
    }

    pub(crate) fn site_at(&self, along: f32, left: f32) -> Site {
        self.arc.site_at(along * self.reach, left * self.reach)
    }

    /// Metres in a reach.
    pub(crate) const fn reach(&self) -> f32 {
        self.reach
    }

    /// Forgets the places that [have left](Self::mapped) so far.
    pub fn clear_mapped(&mut self) {
        self.mapped.clear();
    }

    /// The evidence of the labels against what is known. After an alarm it is counted anew from the next label on.
    pub const fn evidence(&self) -> &Evidence {
        &self.evidence
    }
}
