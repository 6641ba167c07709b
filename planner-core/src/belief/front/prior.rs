//! What a tracker knows before it takes in labels: at the start, and where it begins again.
//!
//! A front may be anywhere in an area, between given points, or near a place where it was lost.

use crate::belief::Belief as _;
use crate::belief::evidence::{Alarm, Evidence};
use crate::belief::front::lay::Lay;
use crate::belief::front::learnt::Learnt;
use crate::belief::front::moments::Moments;
use crate::belief::front::tracker::{ABSENT, MOST, Tracker};
use crate::belief::noise::Noise;
use crate::belief::sample::{Label, Sample};
use crate::belief::trust::{AnyReliability, Trust as _};
use crate::geometry::approximate::{METRE, sqrt};
use crate::geometry::area::Area;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;

/// What there is besides a front: everywhere +1, and everywhere -1. Their share at the start, together.
const NOWHERE: f32 = 0.1;

/// The outer layers bend so many times as tightly as was told. At their edge, a front that bends as told would look
/// unlikely.
const OUTER: f32 = 1.035;

/// A front that was known is elsewhere where "there is none" has more than this probability. Labels tell little then.
const ELSEWHERE: f32 = 0.97;

/// With this probability there is none for sure.
const ALL: f32 = 0.9999;

/// Given points are weighed so many times, each time among fewer curves.
const GIVEN_ROUNDS: u32 = 4;

/// A front may turn out to bend so many times as tightly as was told.
const TIGHTEST: f32 = 8.0;

impl<const K: usize, const M: usize, const L: usize> Tracker<K, M, L> {
    pub(super) fn begin(&mut self, area: Area, noise: Noise<AnyReliability>) {
        let prior = noise.reliability.unknown();
        self.learnt = prior.map(|it| Learnt::prior(it.parameters().map(|it| it as f32)));
        self.noise = noise;
        self.start = self.fill_within(area);
    }

    /// Spreads the mass evenly over the lines that cross a rectangle. Returns the logarithm of their measure to the base 2.
    fn fill_within(&mut self, area: Area) -> f32 {
        (self.evidence, self.was_known, self.is_near) = (Evidence::NONE, false, false);
        self.nowhere = [0.5 * NOWHERE; 2];
        let [x, z] = area.half_sides().map(|it| it as f32 * METRE);
        let far = sqrt(x * x + z * z);
        self.grid.set(Lay {
            pivot: area.middle(),
            heading: Heading(0),
            turn: core::f32::consts::TAU / K as f32,
            low: -far,
            step: 2.0 * far / M as f32,
            bend: if L > 1 { OUTER * self.front.bend() } else { 0.0 },
        });
        let lay = self.grid.lay;
        for layer in &mut self.grid.mass {
            for (column, along) in layer.iter_mut().zip(&self.grid.along) {
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
        }
        let whole: f32 = self.grid.cells().map(|it| *it).sum();
        self.grid.scale((1.0 - NOWHERE) / whole, 0.0);
        libm::log2f(whole * lay.turn / L as f32)
    }

    /// The same after some points whose labels are known: of the curves those that agree with them. If they have both
    /// labels, the front lies between them. Call it before anything else. The order of the points counts little, and the
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
        // Points of one label do not bound the front, and count once.
        for round in 0..if is_between { GIVEN_ROUNDS } else { 1 } {
            if round > 0 {
                let each = (1.0 - self.share_nowhere()) / (K * M * L) as f32;
                self.grid.cells().for_each(|mass| *mass = each);
            }
            for &Sample { site, label } in given {
                self.weigh(site, label, MOST, 0.0);
            }
            self.grid.lay_around(None, 0.0);
        }
        self.start -= self.information() as f32;
    }

    /// Begins again in a square, with labels that were read there. The front crosses it, but for a probability of
    /// `nowhere`. That counts these labels already.
    ///
    /// Cost: a label each, but for the laying of cells.
    pub(crate) fn close_in(
        &mut self,
        square: Area,
        labels: impl Iterator<Item = Sample>,
        nowhere: f32,
    ) {
        self.start = self.fill_within(square);
        let (p, blur) = (self.counted(), self.blurred());
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
        self.grid.lay_around(None, 0.0);
        self.is_near = true;
    }

    /// Begins again near a site: the front lies within so many metres of it, and its direction has changed by less
    /// than a quarter turn. It bends up to twice as tightly as was told so far.
    pub fn seek_near(&mut self, site: Site, metres: f32) {
        let (lay, heading) = (self.grid.lay, Moments::of(&self.grid).heading(&self.grid));
        let tightest = TIGHTEST * self.front.bend();
        let bend = if 2.0 * lay.bend < tightest { 2.0 * lay.bend } else { tightest };
        self.grid.set(Lay {
            pivot: site,
            heading,
            turn: core::f32::consts::PI / K as f32,
            low: -metres,
            step: 2.0 * metres / M as f32,
            bend: if L > 1 { bend } else { 0.0 },
        });
        let each = (1.0 - NOWHERE) / (K * M * L) as f32;
        self.grid.cells().for_each(|mass| *mass = each);
        self.nowhere = [0.5 * NOWHERE; 2];
        (self.evidence, self.was_known) = (Evidence::NONE, true);
    }

    /// Begins again where labels speak against what is known, and says so. After an alarm the front is sought
    /// [near](Self::seek_near) a site, within so many metres. A front that was known may most likely not be where it was.
    /// Then one is sought all over an area, as at the start.
    pub fn seek_anew(&mut self, (site, metres): (Site, f32), area: Area) -> bool {
        let absent = self.share_nowhere();
        self.was_known |= !self.is_open() && absent <= ABSENT;
        let is_alarmed = self.evidence.value() >= Alarm::ALARM;
        let is_elsewhere = self.was_known && absent > ELSEWHERE;
        if is_alarmed {
            self.seek_near(site, metres);
        } else if is_elsewhere {
            self.fill_within(area);
        }
        is_alarmed || is_elsewhere
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::front::settings::Front;

    fn at(x: f64, z: f64) -> Site {
        Site::metres([x, z]).unwrap()
    }

    fn area() -> Area {
        Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap()
    }

    #[test]
    fn at_the_start_any_line_of_the_area_is_as_likely() {
        let tracker = Tracker::<16, 16, 1>::new(area(), Front::STRAIGHT, Noise::NONE);
        assert!(tracker.is_open() && tracker.centre().is_none());
        // The cells at the corners are not full.
        assert!(tracker.information().abs() < 0.1, "{}", tracker.information());
        for (x, z) in [(10.0, 10.0), (2.0, 3.0), (18.0, 1.0)] {
            assert!((tracker.share_above(at(x, z)) - 0.5).abs() < 0.01);
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
            let tracker =
                Tracker::<16, 16, 3>::new(area(), Front::STRAIGHT, Noise::NONE).given(labels);
            for Sample { site, label } in labels {
                let above = tracker.share_above(*site);
                let agree = if *label == Label::Positive { above } else { 1.0 - above };
                assert!(agree > 0.9, "{agree}");
            }
            let is_known = labels.len() > 2;
            assert_eq!(tracker.is_open(), !is_known);
            assert!(!is_known || tracker.waist().turn_deviation < 0.6);
        }
    }

    /// A front is known, and then all ground has one label. There may be one elsewhere, once; then there is none.
    #[test]
    fn a_front_that_is_not_where_it_was_is_sought_all_over() {
        let front = Front::bending(60.0).unwrap();
        let mut tracker = Tracker::<16, 16, 3>::new(area(), front, Noise::new(0.9).unwrap());
        let near = (at(10.0, 10.0), 6.0);
        tracker.seek_near(near.0, near.1);
        assert!(!tracker.is_open());
        let mut sought = 0;
        for k in 0..400 {
            let site = at(1.0 + f64::from(k % 10) * 2.0, 1.0 + f64::from(k / 10 % 10) * 2.0);
            tracker.observe(site, Label::Positive.into()).unwrap();
            if tracker.seek_anew(near, area()) {
                sought += 1;
                assert!(tracker.is_open() && (tracker.share_nowhere() - NOWHERE).abs() < 1e-3);
            }
        }
        assert_eq!(sought, 1);
        assert!(tracker.share_nowhere() > 0.5, "{}", tracker.share_nowhere());
    }
}
