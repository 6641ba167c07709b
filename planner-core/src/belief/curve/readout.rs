//! What a curve says of the front, and how it is asked as any belief is.

use crate::belief::curve::arc::Arc;
use crate::belief::curve::bank::Offsets;
use crate::belief::curve::follower::{BLUR, Curve, DRIFTS, MapPlace, Passed};
use crate::belief::estimate::Estimates;
use crate::belief::evidence::{Evidence, NO_EVIDENCE};
use crate::belief::front::{Beside, NINETY, Unit, Waist, angle, metres};
use crate::belief::goal::{Criterion, Goal};
use crate::belief::sample::{Label, Reading};
use crate::belief::tolerance::Tolerance;
use crate::belief::{Belief, ObservationError};
use crate::geometry::approximate::sqrt;
use crate::geometry::area::Area;
use crate::geometry::heading::Heading;
use crate::geometry::lattice::Site;
use crate::geometry::local_line::LocalLine;

/// For evidence a label is another one than it seems with this chance: a few Gaussians stand for all curves.
const MISFIT: f32 = 0.02;

/// Within so many reaches of the front labels are no evidence. Where a front bends alike all the way, a robot that reads often
/// knows it better than this, and all its labels are off by the same little.
const CLOSE: f32 = 2.0 * BLUR;

/// A front that a line crosses at a smaller angle than this, as a cosine, is taken to cross it at this.
const OBLIQUE: f32 = 0.2;

impl Curve {
    /// The front on an arc: what is known of its offset, its turn, and the deviation of that.
    fn waist(&self, arc: Arc, offsets: &Offsets, [turn, turns]: [f32; 2]) -> Waist {
        let middle = offsets.mean();
        let half = offsets.half_width(middle, 0.9) * self.reach / NINETY;
        let curvature = if self.is_flipped { -arc.bend } else { arc.bend };
        Waist {
            site: arc.site_at(0.0, middle * self.reach),
            heading: self.along(arc.heading.turned(angle(turn))),
            curvature,
            deviation: half,
            turn_deviation: turns,
        }
    }

    /// The front at a place behind, the last one first.
    pub(super) fn place(&self, number: usize) -> Option<MapPlace> {
        let MapPlace { waist, age, begins } = self.place_then(number)?;
        let moved = DRIFTS * self.pace * age;
        let deviation = sqrt(waist.deviation * waist.deviation + moved * moved);
        Some(MapPlace { waist: Waist { deviation, ..waist }, age, begins })
    }

    /// The same, but where the front was when the robot passed it.
    fn place_then(&self, number: usize) -> Option<MapPlace> {
        let Passed { arc, age, begins } = self.passed.iter().nth(number)?;
        let [_, _, turns] = self.bank.direction();
        let waist = self.waist(*arc, &self.bank.behind(number), [0.0, turns]);
        Some(MapPlace { waist, age: *age, begins: *begins })
    }

    /// The front beside the robot.
    pub fn now(&self) -> Waist {
        let [turn, _, turns] = self.bank.direction();
        self.waist(self.arc, &self.bank.ahead(0.0, 0.0), [turn, turns])
    }

    /// Places that the map has now: no label changes them any more. The oldest first, and the last few since they were
    /// [cleared](Self::clear_mapped).
    pub fn mapped(&self) -> &[MapPlace] {
        &self.mapped
    }

    /// Whether the front is followed, or may only seem to be there.
    pub const fn is_begun(&self) -> bool {
        self.is_begun
    }

    /// The front beside the robot, if there is one for sure, and it lies within so many metres with 90 %.
    pub fn found(&self, within: f32) -> Option<Waist> {
        let now = self.now();
        (self.is_sure() && now.ninety() <= within).then_some(now)
    }

    /// The places passed that may still change, and that are known well enough for a map; the last one first.
    pub fn places(&self) -> impl Iterator<Item = MapPlace> {
        let places = (0..self.passed.len()).filter_map(|number| self.place(number));
        places.filter(|it| self.counts(&it.waist))
    }

    /// The same, but where the front was when the robot passed them.
    pub(crate) fn places_then(&self) -> impl Iterator<Item = MapPlace> {
        (0..self.passed.len()).filter_map(|number| self.place_then(number))
    }

    /// Where the front crosses the line through a site that is square to a heading, on average, and how well that is
    /// known. Of no meaning before the front [is found](Self::found).
    pub fn beside(&self, site: Site, heading: Heading) -> Beside {
        let [along, _] = self.see(site);
        let offsets = self.bank.ahead(along, 0.0);
        let left = offsets.mean();
        let place = metres(self.site_at(along, left) - site);
        let [ahead, to_left] = Unit::of(heading).seen(place);
        let front = self.arc.heading_at(along * self.reach);
        let Unit { x: cos, z: sin } = Unit::of(Heading(front.since(heading).0));
        let size = if cos.abs() > OBLIQUE { cos.abs() } else { OBLIQUE };
        let slope = if cos < 0.0 { -sin } else { sin } / size;
        let deviation = offsets.deviation() * self.reach / size;
        Beside { left: to_left - ahead * slope, deviation }
    }

    /// The share of the curves that have a site on their +1 side.
    pub fn share_above(&self, site: Site) -> f32 {
        if !self.is_begun {
            return 0.5;
        }
        let (offsets, left) = self.offsets_at(site);
        let below = offsets.below(left);
        if self.is_flipped { 1.0 - below } else { below }
    }

    /// Where the front crosses the line through a site, as labels tell it, and where the site lies.
    fn offsets_at(&self, site: Site) -> (Offsets, f32) {
        let [along, left] = self.see(site);
        let blur = self.blur(self.noise.tolerance);
        (self.bank.ahead(along, blur * blur), left)
    }

    /// Whether the front most likely lies so near to a site that a label there says nothing of the model.
    fn is_close(&self, site: Site) -> bool {
        let (offsets, left) = self.offsets_at(site);
        offsets.below(left + CLOSE) - offsets.below(left - CLOSE) > 0.5
    }
}

impl Belief for Curve {
    fn is_full(&self) -> bool {
        false
    }

    /// As at the end of a motion, but the robot goes on, and evidence does not count it: labels close together may err
    /// together.
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let Reading::Side(label) = reading else { return Ok(false) };
        self.go_to(site);
        self.hear(site, label, self.blur(self.noise.tolerance));
        Ok(true)
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
        let Reading::Side(label) = reading else { return Ok(()) };
        if self.is_alarmed() {
            self.evidence = Evidence::NONE;
        }
        let is_close = self.is_close(site);
        let chance = self.hear(site, label, self.blur(tolerance));
        self.evidence.observe(label, if is_close { NO_EVIDENCE } else { for_evidence(chance) });
        let (last, run) = self.run;
        self.run = (Some(label), if last == Some(label) { run.saturating_add(1) } else { 1 });
        if self.is_alarmed() {
            self.begin_again();
        }
        Ok(())
    }

    fn estimates(&self) -> Estimates {
        Estimates { bisector: None, centre: self.centre(), maximum_margin: None }
    }

    fn centre(&self) -> Option<LocalLine> {
        let waist = self.now();
        LocalLine::new(waist.site, waist.heading.unit().scaled(1 << 24), 0.0, 0.0)
    }

    /// By how much the front beside the robot is known better than to a reach and a radian, bits.
    fn information(&self) -> f64 {
        let waist = self.now();
        let share = waist.deviation * waist.turn_deviation / self.reach;
        let bits = -libm::log2f(if share > 1e-12 { share } else { 1e-12 });
        if bits > 0.0 { f64::from(bits) } else { 0.0 }
    }

    /// Never: a front goes on.
    fn meets<C: Criterion>(&self, _: Goal<C>, _: Area) -> bool {
        false
    }

    fn chance(&self, site: Site) -> f64 {
        let (above, errs) = (f64::from(self.share_above(site)), f64::from(self.error()));
        (1.0 - errs) * above + errs * (1.0 - above)
    }

    fn chance_of(&self, site: Site, label: Label) -> f32 {
        if self.is_close(site) {
            return NO_EVIDENCE;
        }
        let above = self.chance(site) as f32;
        for_evidence(if label == Label::Positive { above } else { 1.0 - above })
    }
}

/// The chance of a label as it counts for evidence.
fn for_evidence(chance: f32) -> f32 {
    chance + MISFIT * (1.0 - 2.0 * chance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::front::Front;
    use crate::belief::noise::Noise;
    use crate::belief::sample::Sample;
    use crate::draws::Draws;

    #[test]
    fn it_holds_as_little_as_it_says() {
        assert!(size_of::<Curve>() <= 3_750, "{}", size_of::<Curve>());
    }

    fn label(is_plus: bool) -> Label {
        if is_plus { Label::Positive } else { Label::Negative }
    }

    /// A coin in place of the sensor. An agent asks after each label, once.
    #[test]
    fn an_alarm_is_there_until_the_next_label() {
        let mut draws = Draws::new(5);
        let at = |x: f64, z: f64| Site::metres([x, z]).unwrap();
        let of = |z: f64| Sample { site: at(0.0, z), label: label(z > 0.0) };
        let noise = Noise::new(0.98).unwrap();
        let given = [of(-1.0), of(1.0)];
        let mut curve = Curve::between(&given, Heading(0), 1.0, Front::STRAIGHT, noise).unwrap();
        let alarms = (0..60).filter(|step| {
            let site = at(0.2 * f64::from(*step), if step % 2 == 0 { 0.3 } else { -0.3 });
            curve.moved(site, 1.0);
            curve.observe(site, label(draws.unit() < 0.5).into()).unwrap();
            curve.evidence().alarm().is_some_and(|it| it.is_grave())
        });
        let alarms: heapless::Vec<u32, 60> = alarms.collect();
        let are_apart = alarms.windows(2).all(|it| it[1] > it[0] + 1);
        assert!(!alarms.is_empty() && are_apart, "{alarms:?}");
    }

    /// Labels at random, at places near and far, after short times and long ones.
    #[test]
    fn it_stays_definite_whatever_it_is_told() {
        for seed in 0..120 {
            let mut draws = Draws::new(seed);
            let mut unit = || draws.unit();
            let p = 0.5 + 0.5 * unit();
            let noise =
                Noise { tolerance: Tolerance::new(unit()).unwrap(), ..Noise::new(p).unwrap() };
            let speed = if seed % 3 == 0 { 10.0 * unit() } else { 0.0 };
            let front = Front::STRAIGHT.moving(speed).unwrap();
            let reach = [0.001, 0.1, 2.0, 50.0, 1_000.0][seed as usize % 5];
            let at = |x: f64, z: f64| Site::metres([x, z]).unwrap();
            let given = [
                Sample { site: at(0.0, reach * unit()), label: Label::Positive },
                Sample { site: at(0.0, -reach * unit()), label: Label::Negative },
            ];
            let mut curve = Curve::between(&given, Heading(1 << 31), reach, front, noise).unwrap();
            let far = [0.1, 1.0, 3.0][seed as usize % 3] * reach;
            let [mut x, mut z] = [0.0; 2];
            for k in 0..300 {
                let jump = if k % 97 == 96 { 2_000.0 } else { far };
                x = (x + jump * (unit() - 0.5)).clamp(-8e3, 8e3);
                z = (z + jump * (unit() - 0.5)).clamp(-8e3, 8e3);
                let time = if k % 11 == 0 { 1e4 * unit() } else { unit() };
                curve.moved(at(x, z), time as f32);
                curve.observe(at(x, z), label(unit() < 0.5).into()).unwrap();
                let waist = curve.now();
                let numbers = [waist.deviation, waist.turn_deviation, waist.curvature];
                let are_numbers = numbers.iter().all(|it| it.is_finite());
                let is_wide = waist.deviation > 0.0;
                let share = curve.share_above(at(x, z));
                let is_share = (-1e-4..=1.0001).contains(&share);
                assert!(are_numbers && is_wide && is_share, "{seed}, {k}: {waist:?} {share}");
            }
        }
    }
}
