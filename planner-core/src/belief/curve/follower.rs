//! A curve in arc length: takes in motions and labels, and says where the front is.

use crate::belief::curve::arc::Arc;
use crate::belief::curve::bank::{Bank, Heard, Offsets, Sum as _};
use crate::belief::curve::gaussian::PLACES;
use crate::belief::curve::start::Start;
use crate::belief::evidence::Evidence;
use crate::belief::front::{Front, Learnt, Waist, angle, limited};
use crate::belief::noise::Noise;
use crate::belief::sample::{Label, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::{AnyReliability, Trust as _};
use crate::geometry::approximate::METRE;
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::Site;
use crate::geometry::value::ValueError;

/// A label is false with this chance at least, so that one false label does not rule out the truth.
const LEAST: f32 = 0.003;

/// The place of a label is blurred by this share of a reach at least.
const BLUR: f32 = 0.005;

/// A tolerance is so many deviations.
const TOLERANCE: f32 = 3.0;

/// Places behind are so far apart, reaches.
const APART: f32 = 0.5;

/// The arc bends no more than so much in a reach.
const MOST_BEND: f32 = 0.8;

/// It is turned by no more than this at once, radians.
const MOST_TURN: f32 = 1.0;

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

/// After an alarm the front has these deviations of offset, in reaches, and of direction, in radians.
const ANEW: [f32; 2] = [0.5, 0.6];

/// A place that was passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passed {
    pub(super) arc: Arc,
    pub(super) age: f32,
}

/// What is known of a front beside a robot that goes along it. Nothing is told of how it bends.
///
/// It takes 3.4 kB. A label and a motion take time that does not depend on how many there were.
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
    pub(super) noise: Noise<AnyReliability>,
    /// What labels have said of a reliability that nobody knows.
    learnt: Option<Learnt>,
    /// The robot's way along the front, from beside it on.
    pub(super) arc: Arc,
    /// Whether the front's +1 side is to the right of this way.
    pub(super) is_flipped: bool,
    pub(super) bank: Bank,
    pub(super) passed: heapless::Deque<Passed, PLACES>,
    /// How far the arc has gone since the last of these, reaches.
    since: f32,
    pub(super) evidence: Evidence,
    /// The last label, and how many were the same.
    pub(super) run: (Option<Label>, u32),
    /// The last place that has left the window at this motion.
    pub(super) gone: Option<Waist>,
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
        const REACH: ValueError = ValueError("the longest motion is from 0.001 to 1000 m");
        const ONE_LABEL: ValueError = ValueError("a front lies between two samples that differ");
        if !(1e-3..=1e3).contains(&reach) {
            return Err(REACH);
        }
        let noise = noise.into();
        let prior = noise.reliability.unknown();
        let learnt = prior.map(|it| Learnt::prior(it.parameters().map(|it| it as f32)));
        let mut curve = Self {
            reach: reach as f32,
            pace: front.pace(),
            noise,
            learnt,
            arc: Arc { site: Site::ORIGIN, heading: Heading(0), bend: 0.0 },
            is_flipped: false,
            bank: Bank::about([1.0; 2]),
            passed: heapless::Deque::new(),
            since: 0.0,
            evidence: Evidence::NONE,
            run: (None, 0),
            gone: None,
        };
        let start = Start::of(given, LEAST, curve.reach).ok_or(ONE_LABEL)?;
        curve.is_flipped = !facing.agrees(start.heading);
        curve.arc = Arc { site: start.site, heading: curve.along(start.heading), bend: 0.0 };
        curve.bank = Bank::about(start.deviation);
        Ok(curve)
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

    /// The deviation of where a label is read, reaches.
    pub(super) fn blur(&self, tolerance: Tolerance) -> f32 {
        let told = tolerance.units() as f32 * METRE / (TOLERANCE * self.reach);
        if told > BLUR { told } else { BLUR }
    }

    /// The robot has come to a site, in so many units of time.
    pub fn moved(&mut self, site: Site, time: f32) {
        self.gone = None;
        for _ in 0..PIECES {
            let way = self.arc.see(site).along / self.reach;
            self.go(limited(way, 1.0));
            if way.abs() <= 1.0 {
                break;
            }
        }
        let grown = BESIDE * self.pace * time / self.reach;
        if grown > 0.0 {
            self.bank.widen(grown * grown);
        }
        for it in &mut self.passed {
            it.age += time;
        }
        self.let_go();
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
    }

    fn pass(&mut self) {
        if self.passed.is_full() {
            self.drop_last();
        }
        self.bank.pass();
        self.since = 0.0;
        let _ = self.passed.push_front(Passed { arc: self.arc, age: 0.0 }); // there is room
    }

    fn drop_last(&mut self) {
        self.gone = self.place(self.passed.len().saturating_sub(1)).or(self.gone);
        let _ = self.passed.pop_back();
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
        let chance = self.bank.hear(Heard { sign, left, errs, blur: blur * blur });
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
        let offset = self.bank.ahead(0.0).mean();
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
        self.bank = Bank::about(ANEW);
        self.passed.clear();
        (self.since, self.evidence, self.run) = (0.0, Evidence::NONE, (None, 0));
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
        self.bank.ahead(way)
    }

    pub(crate) fn site_at(&self, along: f32, left: f32) -> Site {
        self.arc.site_at(along * self.reach, left * self.reach)
    }

    /// Metres in a reach.
    pub(crate) const fn reach(&self) -> f32 {
        self.reach
    }

    /// The evidence of the labels against what is known, since it began again.
    pub const fn evidence(&self) -> &Evidence {
        &self.evidence
    }
}
