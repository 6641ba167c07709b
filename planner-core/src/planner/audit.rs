//! The audit before a goal's promise: labels on ground that is certain, close to either side of the estimate, at both
//! ends and in the middle of its chord.
//!
//! A planner that asks only where it is uncertain cannot contradict itself. A boundary that bends or moves, or a sensor
//! that fails, leaves a narrow set of lines all the same. So once the goal is met, the planner visits six places where
//! the belief is sure of the label.
//!
//! - *Labels that are true*: all lines left agree there. If each label is the one that they have, the line is known. If
//!   one is not, no line explains the labels. With true labels of a straight, still line that cannot happen.
//! - *Labels that may be wrong*: all but 0.03 % of the distribution agrees there. Sequential tests ask for as many labels
//!   as the goal's level needs (`belief/predictions/verdicts.rs`). A place on the other side passes with a probability of `(1 - level) / level`
//!   at most. On the model one audit in 100 refutes at most.
//!
//! Where labels may be wrong, each label of the mission also counts as [evidence](crate::belief::evidence) against the model.
//! What amounts to an alarm refutes it: a promise and an alarm exclude each other.
//!
//! A place lies as near to the lines left as the vehicle can aim. Where
//! the border, a keep-out or the vehicle is in the way, a place nearer to the middle of the chord takes its turn. So it does
//! where a motion brings the vehicle no nearer: a car may circle about a place at which it cannot arrive. A place that
//! cannot be visited is left out.

use crate::belief::predictions::{AuditLabel, PLACES, PredictiveBelief, Verdict, Verdicts};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Reading, Sample};
use crate::geometry::approximate::distance;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, UNITS_PER_METRE};
use crate::geometry::local_line::LocalLine;
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::search::chord::Chord;
use crate::search::errand::{Errand, UNKNOWN, errand, motions_to};
use crate::search::objective::Effort;
use crate::search::wander::stays;

/// Where on the chord places lie, as shares of it: the first is best, the others take its turn. Places are numbered by
/// twos, at one end of the chord, in its middle, and at the other end. The first of the two is on the +1 side.
const ALONG: [[f32; 5]; 3] =
    [[0.03, 0.08, 0.14, 0.21, 0.29], [0.5, 0.46, 0.54, 0.4, 0.6], [0.97, 0.92, 0.86, 0.79, 0.71]];

/// How near a place lies to uncertain ground, as a share of the mean of the area's sides: 12.5 cm of 20 m. It lies no
/// farther than 12.5 cm, unless the vehicle cannot aim so well: no nearer than the shortest motion.
const NEAR: f32 = 1.0 / 160.0;

/// A vehicle that goes round a circle to turn is led no nearer to a place than this share of the circle's radius.
const NEAR_CIRCLE: f32 = 0.25;

/// How far from the estimate a place lies at most, as a share of the chord.
const MOST_ASIDE: f32 = 0.25;

/// Motions to a place at most: twice as many as a straight drive along the chord takes, and so many for turns.
const TURNS: u16 = 16;

/// The next place takes its turn when more motions are left to one than before its last motion, by more than this.
const STRAYS: u8 = 2;

/// An audit ends when so many places in a row were out of reach.
const MISSES: u8 = 3;

/// The most labels of one audit: beyond, labels are so often wrong that no test ends.
const LABELS: u16 = 480;

/// An audit that is under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Audit<V> {
    /// Labels as the belief has them, and others.
    agreed: u16,
    disagreed: u16,
    /// What the labels come to.
    verdicts: V,
    /// The label that refuted the model.
    refuted: Option<Sample>,
    now: AuditCourse,
    /// The course with the motion that was planned last, and whether that ends at its place.
    next: AuditCourse,
    arrives: bool,
}

/// Which places are settled, and which one motions lead to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct AuditCourse {
    /// A bit for each place.
    settled: u8,
    /// The place, and which of its [`ALONG`].
    to: Option<(u8, u8)>,
    /// Motions on the way there so far.
    motions: u16,
    /// About how many were left when the last one was planned, with it; or [`UNKNOWN`].
    left: u8,
    /// Places given up since the last label.
    missed: u8,
}

impl AuditCourse {
    const NONE: Self = Self { settled: 0, to: None, motions: 0, left: UNKNOWN, missed: 0 };

    /// The same with its place left.
    fn leave(self) -> Self {
        Self { to: None, motions: 0, left: UNKNOWN, ..self }
    }

    /// Whether the last motion led away from the place: so many are left now.
    fn strays(self, motions: u8) -> bool {
        motions < UNKNOWN && motions > self.left.saturating_add(STRAYS)
    }

    /// Whether an audit can have it: places that there are, and not more motions than a mission has.
    fn is_possible(self) -> bool {
        let is_place = self.to.is_none_or(|(place, _)| usize::from(place) < PLACES);
        is_place && self.motions < u16::MAX / 2
    }

    /// The same with its place settled.
    fn settle(self) -> Self {
        let settled = self.to.map_or(0, |(place, _)| 1 << place);
        Self { settled: self.settled | settled, ..self.leave() }
    }
}

impl<V: Verdicts> Audit<V> {
    /// Nothing has been seen.
    pub(crate) const NONE: Self = Self {
        agreed: 0,
        disagreed: 0,
        verdicts: V::NONE,
        refuted: None,
        now: AuditCourse::NONE,
        next: AuditCourse::NONE,
        arrives: false,
    };

    /// Whether it can come of an audit, and not only of bytes.
    pub(crate) fn is_possible(&self) -> bool {
        self.agreed <= LABELS
            && self.disagreed <= LABELS
            && self.now.is_possible()
            && self.next.is_possible()
    }

    /// Labels that were read where the belief is sure, and are what it is sure of.
    pub const fn agreed(&self) -> u16 {
        self.agreed
    }

    /// Labels that were read where the belief is sure of the other label.
    pub const fn disagreed(&self) -> u16 {
        self.disagreed
    }

    /// The label that refuted the model: no line that is likely enough explains the labels.
    pub const fn refuted(&self) -> Option<Sample> {
        self.refuted
    }

    /// The next motion of the audit. `None` if it is over.
    ///
    /// Places are visited in the order of their distance. Cost: the looks of the effort at most.
    pub(crate) fn plan<D: Dynamics, G: Workspace, B: PredictiveBelief>(
        &mut self,
        (dynamics, area): (&D, &G),
        (belief, estimate): (&B, LocalLine),
        pose: Pose,
        effort: &mut Effort,
    ) -> Option<Errand> {
        let grid = dynamics.grid();
        let circle = dynamics.turning_circles(pose).map_or(0, |[left, _]| left.radius);
        let least = grid.step_units().max(NEAR_CIRCLE * circle as f32);
        let places = AuditPlaces::of(estimate, area.bounds(), least)?;
        let reach = grid.longest_units();
        let most = TURNS.saturating_add((2.0 * places.chord.length() / reach) as u16);
        let mut course = self.now;
        while course.missed < MISSES && self.agreed + self.disagreed < LABELS {
            let (place, first) = match course.to {
                Some(_) if course.motions >= most => {
                    course = AuditCourse { missed: course.missed + 1, ..course.settle() };
                    continue;
                }
                Some(to) => to,
                None => (places.nearest(dynamics, pose, course.settled)?, 0),
            };
            for turn in first..ALONG[0].len() as u8 {
                let site = places.place(place, turn, belief, effort);
                let to = site.map(|site| (site, places.near));
                let way = to.and_then(|to| self.way_to(place, (dynamics, area), pose, to, effort));
                if let Some(found) = way.filter(|it| turn > first || !course.strays(it.motions)) {
                    let (to, motions) = (Some((place, turn)), course.motions + 1);
                    self.next = AuditCourse { to, motions, left: found.motions, ..course };
                    self.arrives = found.arrives;
                    return Some(found);
                }
            }
            let missed = course.missed + u8::from(course.motions > 0);
            course = AuditCourse { to: Some((place, 0)), missed, ..course }.settle();
        }
        None
    }

    /// The next motion to a place's site: a turn on the spot, where one label does not decide and the vehicle is there.
    fn way_to<D: Dynamics, G: Workspace>(
        &self,
        place: u8,
        (dynamics, area): (&D, &G),
        pose: Pose,
        (site, near): (Site, f32),
        effort: &mut Effort,
    ) -> Option<Errand> {
        if !area.contains_disc(site, near as i32) {
            return None;
        }
        if self.verdicts.is_open(place.into())
            && let Some(leg) = dynamics.turn_in_place(pose, Side::Left)
            && distance(site - pose.site) <= near
            && stays(dynamics, area, effort, [pose, leg.1])
        {
            return Some(Errand { leg, arrives: true, motions: 1 });
        }
        errand((dynamics, area), pose, (site, near), effort)
    }

    /// Whether the motion that was planned last ends where the audit asks for a label.
    pub(crate) const fn arrives(&self) -> bool {
        self.arrives
    }

    /// Records a label of the mission, and how likely it was before it was read.
    pub(crate) fn hear(&mut self, sample: Sample, chance: f32) {
        if self.verdicts.hear(sample.label, chance) {
            self.refuted = self.refuted.or(Some(sample));
        }
    }

    /// Records the motion that was planned last, without a label.
    pub(crate) fn pass(&mut self) {
        self.now = self.next;
        if core::mem::take(&mut self.arrives) {
            self.now = AuditCourse { missed: 0, ..self.now.settle() };
            self.next = self.now;
        }
    }

    /// Records the motion that was planned last, and what was read at its end, if the belief is sure of the label there:
    /// that label, how often it is read there, and the reading. `level` is that of the goal, in millionths.
    pub(crate) fn observe(
        &mut self,
        site: Site,
        seen: Option<(Label, Reliability, Reading)>,
        level: u32,
    ) {
        let place = self.next.to.map_or(0, |(place, _)| usize::from(place));
        let left = AuditCourse { missed: 0, ..self.next.leave() };
        self.pass();
        if let Some((label, reliability, reading)) = seen {
            let agrees = reading == Reading::Side(label);
            let is_last = self.now.settled == (1 << PLACES) - 1;
            if agrees {
                self.agreed += 1;
            } else {
                self.disagreed += 1;
            }
            match self.verdicts.observe(AuditLabel { place, is_last, agrees, reliability, level }) {
                Verdict::Agrees => {}
                Verdict::Open => self.now = left,
                Verdict::Refutes => self.refuted = Some(Sample { site, label: -label }),
            }
        }
        self.next = self.now;
    }
}

/// The chord of the estimate, and how near to it an audit goes.
struct AuditPlaces {
    chord: Chord,
    /// How near places are to uncertain ground, and motions end to them; lattice units.
    near: f32,
}

impl AuditPlaces {
    /// The places by an estimate, no nearer than `least`.
    fn of(estimate: LocalLine, area: Area, least: f32) -> Option<Self> {
        let usual = NEAR * area.mean_side();
        let eighth = UNITS_PER_METRE as f32 / 8.0;
        let near = if usual < eighth { usual } else { eighth };
        let near = if near > least { near } else { least };
        Some(Self { chord: Chord::of(estimate, area)?, near })
    }

    /// The place to which the fewest motions lead, of those that are not settled.
    fn nearest<D: Dynamics>(&self, dynamics: &D, pose: Pose, settled: u8) -> Option<u8> {
        let mut nearest = None;
        for place in (0..PLACES as u8).filter(|place| settled >> place & 1 == 0) {
            let site = self
                .chord
                .site(ALONG.get(usize::from(place / 2))?[0], 2.0 * side(place) * self.near);
            let off = site.map_or(f32::INFINITY, |site| motions_to(dynamics, pose, site));
            if nearest.is_none_or(|(least, _)| off < least) {
                nearest = Some((off, place));
            }
        }
        nearest.map(|(_, place)| place)
    }

    /// Where a place lies: nearest to the chord of all where the belief is sure far enough around.
    fn place<B: PredictiveBelief>(
        &self,
        place: u8,
        turn: u8,
        belief: &B,
        effort: &mut Effort,
    ) -> Option<Site> {
        let along = *ALONG.get(usize::from(place / 2))?.get(usize::from(turn))?;
        let due = self.near + belief.margin();
        let mut aside = due;
        while aside < MOST_ASIDE * self.chord.length() && effort.take(1) {
            let site = self.chord.site(along, side(place) * aside)?;
            let inner = self.chord.site(along, side(place) * (aside - due))?;
            let lacks = belief.lacks(site, inner, due);
            if lacks <= 0.0 {
                return Some(site);
            }
            let least = 0.125 * aside;
            aside += if lacks > least { lacks } else { least };
        }
        None
    }
}

/// Even places lie on the +1 side.
const fn side(place: u8) -> f32 {
    if place.is_multiple_of(2) { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::predictions::Decisive;

    #[test]
    fn bytes_of_no_audit_are_told_from_one() {
        let of = |course: AuditCourse, agreed: u16| Audit {
            now: course,
            agreed,
            ..Audit::<Decisive>::NONE
        };
        assert!(of(AuditCourse { to: Some((5, 4)), ..AuditCourse::NONE }, LABELS).is_possible());
        for to in [(6, 0), (200, 1)] {
            assert!(!of(AuditCourse { to: Some(to), ..AuditCourse::NONE }, 0).is_possible());
        }
        assert!(!of(AuditCourse { motions: u16::MAX, ..AuditCourse::NONE }, 0).is_possible());
        assert!(!of(AuditCourse::NONE, LABELS + 1).is_possible());
    }
}
