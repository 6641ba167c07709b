//! A stretch of a front that a robot goes along to and fro, and where the front is all along it.
//!
//! The stretch lies about the place where the front is found, and goes across its own direction as the front moves. Each of
//! its parts keeps where the front was when the robot passed it last, and on the way before. All pairs together say how the
//! front moves: its velocity is the same all along, and is found by least squares. So a place that was passed some time ago
//! is known where the front has moved to since.

use crate::belief::front::{Beside, Unit, Waist, metres};
use crate::geometry::approximate::{METRE, distance, sqrt};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::motion::dynamics::Pose;

/// Parts of a stretch that is watched.
pub(crate) const PARTS: usize = 16;

/// The deviation of the front's velocity along either axis, as a share of the most.
const MOVES: f32 = 0.7;

/// Errors of places near each other are alike: together they tell as much as this share of them.
const TELLS: f32 = 0.3;

/// Errors on two ways are alike in part: the variance of both together is so many times what it would be.
const ALIKE: f32 = 1.5;

/// A velocity changes: so much of its most, as a deviation, is never known.
const CHANGES: f32 = 0.05;

/// A front that crosses a line at a smaller angle than this, as a cosine, is taken to cross it at this.
const OBLIQUE: f32 = 0.2;

/// Times that the place where it crosses is computed anew.
const CLOSER: u32 = 3;

/// Where the front was so long ago.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct FormerFront {
    pub(crate) waist: Waist,
    pub(crate) age: f32,
}

/// A part of the stretch: where the front was when it was passed last, and on the way before.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct StretchPart {
    last: Option<FormerFront>,
    before: Option<FormerFront>,
}

/// A stretch in so many parts. One of none is not watched.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct WatchedStretch<const N: usize> {
    /// Metres.
    length: f32,
    /// Its middle, and the front's direction there when it was found.
    middle: Option<Pose>,
    /// Where the robot is: a place, and how far along the front from the middle, metres.
    at: (Site, f32),
    /// So much time has passed since it turned.
    turned: f32,
    parts: heapless::Vec<StretchPart, N, u8>,
}

/// How the front moves, metres in a unit of time, and the covariance of that.
#[derive(Clone, Copy, Debug)]
struct Velocity {
    mean: [f32; 2],
    covariance: [f32; 3],
}

impl Velocity {
    /// Where the front is at a part, at the time of the last one, by both.
    fn both(&self, StretchPart { last, before }: StretchPart) -> Option<FormerFront> {
        let (Some(last), Some(before)) = (last, before) else { return last };
        let then = self.now(FormerFront { age: before.age - last.age, ..before });
        let [a, b] = [last.waist, then].map(|it| it.deviation_beside(last.waist.site));
        let share = a * a / (a * a + b * b);
        let off = -share * then.aside(last.waist.site);
        let (site, deviation) = (aside(pose(last.waist), off), b * sqrt(ALIKE * share));
        Some(FormerFront { waist: Waist { site, deviation, ..last.waist }, ..last })
    }

    /// Where the front is now that was somewhere.
    fn now(&self, FormerFront { waist, age }: FormerFront) -> Waist {
        let Unit { x, z } = Unit::of(waist.heading);
        let [xx, xz, zz] = self.covariance;
        let moved = age * age * (z * z * xx - 2.0 * x * z * xz + x * x * zz);
        let deviation = sqrt(waist.deviation * waist.deviation + moved);
        Waist { site: stepped(waist.site, self.mean.map(|it| it * age)), deviation, ..waist }
    }
}

impl<const N: usize> WatchedStretch<N> {
    /// Nothing is known of it yet.
    pub(crate) const fn new(length: f32) -> Self {
        let parts = heapless::Vec::new();
        Self { length, middle: None, at: (Site::ORIGIN, 0.0), turned: 0.0, parts }
    }

    /// Its length, metres.
    pub(crate) const fn length(&self) -> f32 {
        self.length
    }

    /// Its middle and direction.
    pub(crate) const fn middle(&self) -> Option<Pose> {
        self.middle
    }

    /// Whether a mission can have made it.
    pub(crate) fn is_possible(&self) -> bool {
        let is_known = |it: &FormerFront| (0.0..1e9).contains(&it.age) && it.waist.deviation >= 0.0;
        let known = self.parts.iter().flat_map(|it| [it.last, it.before]).flatten();
        self.at.1.abs() < 1e6 && known.into_iter().all(|it| is_known(&it))
    }

    /// The robot goes the other way along it.
    pub(crate) const fn turn(&mut self) {
        self.turned = 0.0;
    }

    /// Takes in that the robot has come to a site, where the front is beside it if it is found, and where it was at the
    /// places that it has passed since it turned, the last one first. Whether a robot that goes the front's own way, or the
    /// other one, is at the end.
    pub(crate) fn observe(
        &mut self,
        site: Site,
        (found, passed): (Option<Waist>, impl Iterator<Item = FormerFront>),
        (is_along, reach, pace): (bool, f32, f32),
    ) -> bool {
        self.turned += 1.0;
        for known in self.parts.iter_mut().flat_map(|it| [&mut it.last, &mut it.before]).flatten() {
            known.age += 1.0;
        }
        let Some(waist) = found else { return false };
        self.go(site, waist, reach);
        let velocity = self.velocity(pace);
        let sign = if is_along { 1.0 } else { -1.0 };
        let (mut along, mut from) = (self.at.1, waist.site);
        for it in passed {
            along -= sign * METRE * distance(it.waist.site - from);
            from = it.waist.site;
            self.keep(along, it, &velocity);
        }
        self.keep(self.at.1, FormerFront { waist, age: 0.0 }, &velocity);
        sign * self.at.1 > 0.5 * self.length
    }

    /// Goes on to beside a site. The middle goes with the front. Where that is further away than the stretch is long, the
    /// front has left, and the stretch lies here now.
    fn go(&mut self, site: Site, waist: Waist, reach: f32) {
        let Pose { site: place, heading } = pose(waist);
        let most = self.length * UNITS_PER_METRE as f32;
        let middle = self.middle.filter(|it| distance(place - it.site) <= most);
        let along = if let Some(middle) = middle {
            let [ahead, left] = Unit::of(middle.heading).seen(metres(place - middle.site));
            if ahead.abs() <= 0.5 * reach && heading.agrees(middle.heading) {
                self.middle = Some(Pose { site: aside(middle, left), ..middle });
                ahead
            } else {
                let [gone, _] = Unit::of(heading).seen(metres(site - self.at.0));
                self.at.1 + gone
            }
        } else {
            self.middle = Some(pose(waist));
            self.parts.clear();
            while self.parts.push(StretchPart::default()).is_ok() {}
            0.0
        };
        self.at = (site, along);
    }

    /// Keeps where the front was, so far along from the middle.
    fn keep(&mut self, along: f32, known: FormerFront, velocity: &Velocity) {
        let number = (along / self.length + 0.5) * N as f32;
        let number = (number as usize).min(N.saturating_sub(1)); // what is negative becomes 0
        let Some(part) = self.parts.get_mut(number) else { return };
        if part.last.is_some_and(|it| it.age > self.turned) {
            part.before = velocity.both(*part);
        }
        part.last = Some(known);
    }

    /// How the front moves, by all that is known of it, if it moves by no more than this.
    fn velocity(&self, pace: f32) -> Velocity {
        if pace <= 0.0 {
            return Velocity { mean: [0.0; 2], covariance: [0.0; 3] };
        }
        let prior = 1.0 / (MOVES * MOVES * pace * pace);
        let ([mut xx, mut xz, mut zz], mut sum) = ([prior, 0.0, prior], [0.0; 2]);
        for StretchPart { last, before } in &self.parts {
            let (Some(last), Some(before)) = (last, before) else { continue };
            let time = before.age - last.age;
            let [a, b] = [last, before].map(|it| it.waist.deviation_beside(last.waist.site));
            let tells = TELLS * time / (a * a + b * b);
            let Unit { x, z } = Unit::of(before.waist.heading);
            let off = before.waist.aside(last.waist.site);
            xx += tells * time * z * z;
            xz -= tells * time * x * z;
            zz += tells * time * x * x;
            sum = [sum[0] - tells * off * z, sum[1] + tells * off * x];
        }
        let each = 1.0 / (xx * zz - xz * xz);
        let [a, b, c] = [zz * each, -xz * each, xx * each];
        let changes = CHANGES * CHANGES * pace * pace;
        let mean = [a * sum[0] + b * sum[1], b * sum[0] + c * sum[1]];
        Velocity { mean, covariance: [a + changes, b, c + changes] }
    }

    /// Where the front crosses the line through a site that is square to a heading, if it moves by no more than this.
    /// `None` as long as nothing is known of the stretch.
    pub(crate) fn beside(&self, site: Site, heading: Heading, pace: f32) -> Option<Beside> {
        let (velocity, unit) = (self.velocity(pace), Unit::of(heading));
        let mut nearest: [Option<(f32, Waist)>; 2] = [None; 2];
        for known in self.parts.iter().filter_map(|it| velocity.both(*it)) {
            let waist = velocity.now(known);
            let [ahead, _] = unit.seen(metres(waist.site - site));
            let [behind, before] = &mut nearest;
            let side = if ahead < 0.0 { behind } else { before };
            if side.is_none_or(|it| ahead.abs() < it.0) {
                *side = Some((ahead.abs(), waist));
            }
        }
        let of = |(_, waist): (f32, Waist)| {
            let [_, mut left] = unit.seen(metres(waist.site - site));
            let (mut at, mut size) = (site, 1.0);
            for _ in 0..CLOSER {
                at = aside(Pose { site, heading }, left);
                let front = waist.heading_at(waist.ahead(at));
                let cos = Unit::of(Heading(front.since(heading).0)).x;
                size = if cos.abs() > OBLIQUE { cos.abs() } else { OBLIQUE };
                left -= if cos < 0.0 { -waist.aside(at) } else { waist.aside(at) } / size;
            }
            Beside { left, deviation: waist.deviation_beside(at) / size }
        };
        match nearest {
            [Some(a), Some(b)] => {
                let share = if a.0 + b.0 > 0.0 { a.0 / (a.0 + b.0) } else { 0.5 };
                let [a, b] = [of(a), of(b)];
                let left = a.left + share * (b.left - a.left);
                Some(Beside { left, deviation: a.deviation + share * (b.deviation - a.deviation) })
            }
            [one, other] => one.or(other).map(of),
        }
    }
}

/// Where a front is, and its direction.
const fn pose(Waist { site, heading, .. }: Waist) -> Pose {
    Pose { site, heading }
}

/// The site so many metres away.
fn stepped(site: Site, by: [f32; 2]) -> Site {
    let [x, z] = by.map(|it| (it * UNITS_PER_METRE as f32) as i32);
    Vector::new(x, z).and_then(|by| site.step(by).ok()).unwrap_or(site)
}

/// The site so many metres to the left of a pose.
fn aside(Pose { site, heading }: Pose, left: f32) -> Site {
    let Unit { x, z } = Unit::of(heading);
    stepped(site, [-z * left, x * left])
}

#[cfg(test)]
mod tests {
    use super::*;

    const REACH: f32 = 2.0;
    const STEP: f64 = 1.5;

    fn at(x: f64, z: f64) -> Site {
        Site::metres([x, z]).unwrap()
    }

    /// Where a circle about (0, 40) that moves is at an angle.
    fn circle(angle: f64, [x, z]: [f64; 2], deviation: f32) -> Waist {
        let (sin, cos) = libm::sincos(angle);
        Waist {
            site: at(x + 40.0 * sin, z + 40.0 - 40.0 * cos),
            heading: Heading::from_radians(angle).unwrap(),
            curvature: 1.0 / 40.0,
            deviation,
            turn_deviation: 0.01,
        }
    }

    /// A robot that goes to and fro knows where all of a stretch of 30 m is, after some ways.
    #[test]
    fn a_front_that_moves_is_known_where_the_robot_is_not() {
        let velocity = [0.02, 0.03];
        for (pace, most) in [(0.0, 0.05), (0.05, 0.11)] {
            let moved = |time: f64| velocity.map(|it| if pace > 0.0 { it * time } else { 0.0 });
            let mut stretch = WatchedStretch::<PARTS>::new(30.0);
            let (mut along, mut way, mut turns) = (-STEP, STEP, 0);
            let mut time = 0.0;
            while turns < 5 {
                time += 1.0;
                along += way;
                let found = circle(along / 40.0, moved(time), 0.05);
                let with = (way > 0.0, REACH, pace);
                if stretch.observe(found.site, (Some(found), core::iter::empty()), with) {
                    // The stretch does not go with the front along it.
                    let off = (along + moved(time)[0]).abs() - 15.0;
                    assert!((0.0..1.4 * STEP).contains(&off), "{along}");
                    (way, turns) = (-way, turns + 1);
                    stretch.turn();
                }
            }
            let [x, z] = moved(time);
            for k in -5..=5 {
                // The line through this place that is square to the axis.
                let ahead = 2.5 * f64::from(k);
                let height = 40.0 - libm::sqrt(40.0 * 40.0 - ahead * ahead);
                let got = stretch.beside(at(x + ahead, 0.0), Heading(0), pace).unwrap();
                let off = f64::from(got.left) - (z + height);
                let is_so = off.abs() < 0.02 && f64::from(got.deviation) < most;
                assert!(is_so && got.deviation > 0.02, "{pace}, {ahead}: {off}, {got:?}");
            }
            let middle = stretch.middle().unwrap();
            let [ahead, left] = metres(middle.site - at(0.0, 0.0)).map(f64::from);
            assert!(ahead.abs() < 1.6 && (left - z).abs() < 1.0, "{ahead}, {left}");
        }
    }

    #[test]
    fn where_the_front_has_left_the_stretch_lies_anew() {
        let mut stretch = WatchedStretch::<PARTS>::new(30.0);
        assert!(stretch.beside(at(0.0, 0.0), Heading(0), 0.0).is_none());
        for by in [0.0, 100.0] {
            let found = circle(0.0, [by, 0.0], 0.05);
            let with = (true, REACH, 0.0);
            stretch.observe(found.site, (Some(found), core::iter::empty()), with);
            assert_eq!(stretch.middle(), Some(pose(found)));
            let beside = stretch.beside(found.site, Heading(0), 0.0).unwrap();
            assert!(beside.left.abs() < 1e-3 && (beside.deviation - 0.05).abs() < 1e-3);
        }
    }
}
