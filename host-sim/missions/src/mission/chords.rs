//! Two bisected chords: what somebody does who has no planner, but knows that two far places determine a line. A baseline
//! that any planner has to beat.
//!
//! A chord leads from a given point of the one label to one of the other, so the line crosses it. Of all pairs of chords
//! it takes the two whose middles lie the farthest apart. It reads half of the labels on the nearer chord and half on the
//! other, each in the middle of what is left of the chord. Where labels may be wrong, the middle is the median of the
//! crossing's distribution: probabilistic bisection.
//!
//! It stops exactly where it wants, whatever the vehicle's steps are. It turns on the spot and drives straight, at most the
//! longest motion at once. It knows no keep-outs, no boats and no cars.
//!
//! A mission without a limit on labels reads one after each motion. It drives to the other chord after half of them.

use anyhow::Result;
use nalgebra::Point2;
use planner_core::dynamics::{Control, Dynamics};
use planner_core::{
    Heading, Label, Motion, Pose, Reading, Sample, Site, StopReason, Workspace as _,
};

use crate::mission::baseline::{Ground, Strategy, motion};
use crate::mission::strict::wrong;
use crate::mission::terrain::Terrain;

/// Bisects two chords, one after the other.
pub struct Chords {
    pair: [Chord; 2],
    /// How often a label is true.
    p: f64,
    /// After so many labels or motions it drives to the other chord.
    half: u32,
    /// Whether these are labels. If not, they are motions.
    counts_labels: bool,
    /// Labels or motions so far.
    done: u32,
    /// Whether the motion that was planned last ends at its place.
    arrives: bool,
}

/// Whether it knows its way in an area.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub fn check_area(area: &Terrain) -> Result<()> {
    if area.chart().is_some() {
        return wrong("area", "a map", "none with algorithm chords, which drives straight");
    }
    match area.keep_outs().count() {
        0 => Ok(()),
        _ => wrong("keep_out", "some", "none with algorithm chords, which drives straight"),
    }
}

/// The ends of two chords of given points, each from -1 to +1.
///
/// # Errors
/// Names the oracle: two chords need three points at least.
pub fn ends(given: &[Sample]) -> Result<[[Site; 2]; 2]> {
    let of = |label| given.iter().filter(move |it| it.label == label).map(|it| it.site);
    let chords: Vec<_> = of(Label::Negative)
        .flat_map(|minus| of(Label::Positive).map(move |plus| [minus, plus]))
        .collect();
    let pairs = chords.iter().enumerate().flat_map(|(k, &one)| {
        chords[k + 1..]
            .iter()
            .map(move |&other| ((middle(one) - middle(other)).norm(), [one, other]))
    });
    match pairs.max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((apart, chords)) if apart > 0.0 => Ok(chords),
        _ => wrong(
            "oracle",
            format!("{} points", given.len()),
            "three or more with algorithm chords, of both labels",
        ),
    }
}

fn middle([a, b]: [Site; 2]) -> Point2<f64> {
    nalgebra::center(&a.into(), &b.into())
}

/// What is left of a chord.
struct Chord {
    /// Sites along it, each with the weight of a crossing between it and the next one.
    parts: Vec<(Site, f64)>,
}

impl Chord {
    fn new([minus, plus]: [Site; 2]) -> Self {
        Self { parts: vec![(minus, 1.0), (plus, 0.0)] }
    }

    /// The place that is as likely on the one side of the line as on the other.
    fn median(&self) -> Point2<f64> {
        let mut left = 0.5 * self.parts.iter().map(|part| part.1).sum::<f64>();
        for pair in self.parts.windows(2) {
            let [(from, weight), (to, _)] = [pair[0], pair[1]];
            if left <= weight {
                let [from, to] = [from, to].map(Point2::<f64>::from);
                return from + (to - from) * (left / weight);
            }
            left -= weight;
        }
        middle([self.parts[0].0, self.parts[self.parts.len() - 1].0])
    }

    /// Takes in a label at its median, true with probability `p`.
    fn observe(&mut self, site: Site, label: Label, p: f64) {
        if p >= 1.0 {
            let end = usize::from(label == Label::Positive);
            self.parts[end].0 = site;
            return;
        }
        let [first, .., last] = self.parts[..] else { return };
        let all = Point2::<f64>::from(last.0) - Point2::from(first.0);
        let along = |site: Site| all.dot(&Point2::<f64>::from(site).coords);
        let at = along(site);
        let is_in = |it: &[(Site, f64)]| along(it[0].0) < at && at < along(it[1].0);
        let Some(k) = self.parts.windows(2).position(is_in) else { return };
        let [(from, weight), (to, _)] = [self.parts[k], self.parts[k + 1]];
        let share = (at - along(from)) / (along(to) - along(from));
        self.parts[k].1 = weight * share;
        self.parts.insert(k + 1, (site, weight * (1.0 - share)));
        // A label +1 says that the crossing lies before it.
        let before = if label == Label::Positive { p } else { 1.0 - p };
        for (part, (_, weight)) in self.parts.iter_mut().enumerate() {
            *weight *= if part <= k { before } else { 1.0 - before };
        }
        let all: f64 = self.parts.iter().map(|part| part.1).sum();
        self.parts.iter_mut().for_each(|part| part.1 /= all);
    }
}

impl Chords {
    /// One that begins at a place, on chords with these ends, for a mission of so many motions, and labels at most, which are
    /// true with probability `p`.
    pub fn new(
        mut ends: [[Site; 2]; 2],
        p: f64,
        start: Site,
        (motions, labels): (u32, Option<u32>),
    ) -> Self {
        let way = |ends| (middle(ends) - Point2::<f64>::from(start)).norm();
        ends.sort_by(|a, b| way(*a).total_cmp(&way(*b)));
        let (half, counts_labels) = (labels.unwrap_or(motions).div_ceil(2), labels.is_some());
        let pair = ends.map(Chord::new);
        Self { pair, p, half, counts_labels, done: 0, arrives: false }
    }

    fn chord(&self) -> usize {
        usize::from(self.done >= self.half)
    }
}

impl<D: Dynamics> Strategy<D> for Chords {
    fn choose(&mut self, ground: &Ground<D>, pose: Pose) -> Result<Motion, StopReason> {
        let (place, dynamics) = (self.pair[self.chord()].median(), &ground.dynamics);
        let (grid, from) = (dynamics.grid(), Point2::<f64>::from(pose.site));
        let (way, longest) = (place - from, f64::from(grid.reach_m(grid.speeds() - 1)));
        self.arrives = way.norm() <= longest;
        let share = if self.arrives { 1.0 } else { longest / way.norm() };
        let heading = Heading::from_radians(libm::atan2(way.y, way.x)).unwrap_or(pose.heading);
        let site = Site::try_from(from + way * share).map_err(|_| StopReason::Cornered)?;
        let [ray, _] = dynamics.around(pose, heading);
        let steps = share * way.norm() / f64::from(grid.reach_m(1));
        let action = grid.action(ray.index, (steps.round() as u16).clamp(1, grid.speeds() - 1));
        let turn = f64::from(heading.since(pose.heading).0.cast_signed()) * std::f64::consts::PI
            / f64::from(1_u32 << 31);
        let control = Control { distance_m: (share * way.norm()) as f32, turn_rad: turn as f32 };
        let wants_label = self.arrives || !self.counts_labels;
        let motion = motion(dynamics, pose, action, Pose { site, heading });
        Ok(Motion { control, wants_label, ..motion })
    }

    fn arrive(&mut self, _: &Ground<D>, pose: Pose, reading: Option<Reading>) {
        if let (true, Some(Reading::Side(label))) = (self.arrives, reading) {
            let chord = self.chord();
            self.pair[chord].observe(pose.site, label, self.p);
        }
        self.done += u32::from(self.arrives || !self.counts_labels);
    }
}
