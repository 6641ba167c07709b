//! A planner that goes along a front, told nothing of how it bends.
//!
//! It learns from a [`Curve`] and looks one motion ahead, at some distances along the front. At each it looks at two places:
//! on the median of the front, and on the robot's own line or near it, where a label still tells enough. A place is worth
//!
//! ```text
//! bits of its label + counts * progress - 0.5 (way - progress)
//! ```
//!
//! with way and progress in reaches. Progress counts in full where the front is known to a fifth of a reach, and less where
//! it is known worse. Where it is hardly known, progress counts against a place, so the robot stays and looks. Where the
//! last two labels were the same, it looks on the other side. Labels on one side alone do not show that a front bends away.
//!
//! The vehicle takes the motion that ends nearest to the best place. It is meant for one that turns on the spot.

use crate::belief::curve::{Curve, Sum as _};
use crate::belief::evidence::Alarm;
use crate::belief::front::limited;
use crate::belief::predictions::entropy;
use crate::belief::sample::Reading;
use crate::belief::tolerance::Tolerance;
use crate::belief::{Belief as _, ObservationError};
use crate::geometry::approximate::{cross, distance, sqrt};
use crate::geometry::lattice::{Site, UNITS_PER_METRE};
use crate::geometry::workspace::Workspace;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::front_state::FrontState;
use crate::planner::setup::{SetupError, aimed_for_by};
use crate::planner::silence::Silence;
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
use crate::search::course::Course;
use crate::search::motions::Leg;
use crate::search::objective::{Effort, LOOKS};
use crate::search::places::Places;
use crate::search::recovery::Found;

/// How far ahead it looks, reaches.
const WAYS: [f32; 11] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98, 1.0];

/// With true labels progress counts in full where the front is known to this, in reaches. With others it is more.
const FULL: f32 = 0.22;

/// The same where it does not count.
const NONE: f32 = 0.37;

/// What it counts where the front is hardly known.
const LOST: f32 = -2.0;

/// What a reach beside the progress costs, bits.
const BESIDES: f32 = 0.5;

/// It looks so many deviations from the median at most, and no further than this in reaches.
const ASIDE: f32 = 0.5;

/// A shorter way is none, reaches.
const STILL: f32 = 0.02;

/// Ends of motions that are looked at for the one nearest to a place, and how often beside the best.
const ENDS: u32 = 64;
const CLOSER: u32 = 6;

/// Of the cross product the sign alone counts. It is scaled to a share.
const SIDE: f32 = 1e-9;

/// A planner that goes along a front: `D` is the vehicle, `G` the area.
///
/// ```
/// # use planner_core::{
/// #     Area, Curve, Front, Heading, Label, Noise, Plan, Planner as _, Pose, Sample, Site, Trail, Unicycle,
/// # };
/// # use planner_core::nalgebra::Point2;
/// // The front is a circle of 40 m, and nobody says so.
/// let side = |at: Point2<f64>| {
///     if (at - Point2::new(100.0, 100.0)).norm() < 40.0 { Label::Positive } else { Label::Negative }
/// };
/// let sample = |z: f64| Ok::<_, Box<dyn std::error::Error>>(Sample {
///     site: Site::metres([100.0, z])?,
///     label: side(Point2::new(100.0, z)),
/// });
/// let given = [sample(58.0)?, sample(62.0)?];
/// let area = Area::metres([0.0, 0.0], [200.0, 200.0])?;
/// let mut pose = Pose::at([100.0, 58.0], Heading::default())?;
/// let curve = Curve::between(&given, pose.heading, 1.0, Front::STRAIGHT, Noise::new(0.95)?)?;
/// let mut planner = Trail::new(area, Unicycle::default(), curve)?;
/// for _ in 0..150 {
///     let Plan::Move(motion) = planner.plan(pose) else { break };
///     pose = motion.target;
///     planner.observe(pose, motion.wants_label.then_some(side(pose.site.into()).into()))?;
/// }
/// let waist = planner.belief().now();
/// let off = Point2::<f64>::from(waist.site) - Point2::new(100.0, 100.0);
/// assert!((off.norm() - 40.0).abs() < waist.half_width(0.999));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Trail<D, G> {
    area: G,
    dynamics: D,
    curve: Curve,
    silence: Silence,
}

/// The bits of a label where this share of the curves lies below.
fn bits(share: f32, errs: f32) -> f32 {
    entropy((1.0 - errs) * share + errs * (1.0 - share)) - entropy(errs)
}

impl<D: Dynamics, G: Workspace> Trail<D, G> {
    /// A planner with what is known so far.
    ///
    /// # Errors
    /// [`SetupError`].
    pub fn new(area: G, dynamics: D, curve: Curve) -> Result<Self, SetupError> {
        let area = aimed_for_by(area, &dynamics, &curve)?;
        Ok(Self { area, dynamics, curve, silence: Silence::NONE })
    }

    /// The best place to go to from a pose; `None` where there is none in the area.
    ///
    /// Cost: 11 times what all Gaussians come to at a place, and their median; some 250,000 instructions.
    fn best_place(&self, pose: Pose) -> Option<Site> {
        let (curve, errs) = (&self.curve, self.curve.error());
        let per_capacity = 1.0 / sqrt(1.0 - entropy(errs) + 1e-3);
        let (full, none) = (FULL * per_capacity, NONE * per_capacity);
        let per = 1.0 / (curve.reach() * UNITS_PER_METRE as f32);
        let [start, aside] = curve.see(pose.site);
        let side = curve.neglected();
        let mut best: Option<(Site, f32)> = None;
        for way in WAYS {
            let offsets = curve.ahead(start + way);
            let (median, deviation) = (offsets.quantile(0.5), offsets.deviation());
            let counts = (none - offsets.distance(median)) / (none - full);
            let counts =
                0.5 * (1.0 + LOST) + limited(counts - 0.5 * (1.0 + LOST), 0.5 * (1.0 - LOST));
            let beside = ASIDE * if deviation < 1.0 { deviation } else { 1.0 };
            let own = match aside - median {
                _ if side != 0.0 => side * beside,
                off if off > beside => beside,
                off if off < -beside => -beside,
                off => off,
            };
            for left in [median, median + own] {
                let site = curve.site_at(start + way, left);
                let long = distance(site - pose.site) * per;
                if long < STILL || !self.area.contains(site) {
                    continue;
                }
                let told = bits(offsets.below(left, 0.0), errs);
                let motions = if long > 1.0 { long } else { 1.0 };
                let besides = if long > way { long - way } else { 0.0 };
                let worth = (told + counts * way) / motions - BESIDES * besides;
                if best.is_none_or(|best| worth > best.1) {
                    best = Some((site, worth));
                }
            }
        }
        best.map(|best| best.0)
    }

    /// The motion that ends nearest to a place, and how many ends were looked at.
    fn towards(&self, pose: Pose, place: Site) -> Option<(Leg, u32)> {
        let (dynamics, area, way) = (&self.dynamics, &self.area, place - pose.site);
        let grid = dynamics.grid();
        let speed = (distance(way) / grid.step_units() + 0.5) as u16;
        let speed = speed.min(grid.speeds().saturating_sub(1)).max(1);
        let mut best: Option<(Leg, f32)> = None;
        let share = |end: Pose| 0.5 + SIDE * cross(way, end.site - pose.site);
        let find = |leg: Leg, _: f32| {
            let off = distance(place - leg.1.site);
            let is_better = best.is_none_or(|best| off < best.1);
            if is_better {
                best = Some((leg, off));
            }
            is_better
        };
        let mut places =
            Places { dynamics, area, pose, share, find, best: None, examined: 0, most: ENDS };
        for speed in [speed, speed.saturating_sub(1)].into_iter().filter(|it| *it > 0) {
            let _ = places.circle(speed);
        }
        let _ = places.beside_best(CLOSER);
        let examined = places.examined;
        best.map(|best| (best.0, examined))
    }
}

impl<D: Dynamics, G: Workspace> Planner for Trail<D, G> {
    type Belief = Curve;

    fn plan(&mut self, pose: Pose) -> Plan {
        let going = self.best_place(pose).and_then(|place| self.towards(pose, place));
        let Some((leg, examined)) = going else { return Plan::Stop(StopReason::Cornered) };
        let (found, effort) = (Found::of(None, leg), Effort { looks: LOOKS, examined });
        let motion = Motion::of(Some(Stage::Follow), pose, &found, &self.dynamics, effort);
        let motion = Motion { wants_label: true, ..motion };
        self.silence.keep(pose, motion, Course::NONE, &self.dynamics)
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if reading.is_some() && tolerance > self.curve.tolerance() {
            return Err(ObservationError::Tolerance(tolerance));
        }
        self.curve.moved(pose.site, 1.0);
        if let Some(reading) = reading {
            self.curve.observe_within(pose.site, reading, tolerance)?;
        }
        self.silence.observe(reading.is_some());
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.curve.observe_on_the_way(site, reading)?;
        if is_kept {
            self.silence.hear();
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &Curve {
        &self.curve
    }

    fn alarm(&self) -> Option<Alarm> {
        self.curve.evidence().alarm()
    }

    /// Where the map has one more place after the last motion.
    fn front(&self) -> Option<FrontState> {
        Some(FrontState { waist: self.curve.gone(), is_closed: false })
    }
}
