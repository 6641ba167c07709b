//! A lawnmower: the survey that a user drives who has no planner. A baseline, blind to the labels it reads.
//!
//! Its tracks are parallel to the area's longer side, evenly spaced, and driven to and fro. As many labels as the mission
//! may read are spread evenly over the tracks, so that they lie in cells as near to squares as possible. If such a survey
//! takes more motions than the mission has, it has fewer tracks. It begins at the corner that is nearest to the start.
//! Labels of a track are at least one of the longest motions apart. So are the tracks.
//!
//! A mission without a limit on labels reads one after each motion. Where a survey ends before the mission, the vehicle
//! drives the same tracks back.

use anyhow::Result;
use nalgebra::Point2;
use planner_core::dynamics::{Action, Dynamics, Side};
use planner_core::error::ObservationError;
use planner_core::link::message::MissionArea;
use planner_core::{
    Belief, Heading, Motion, Plan, Planner, Pose, Reading, Site, StopReason, Tolerance,
    Workspace as _,
};

use crate::mission::baseline::{motion, take_in};
use crate::mission::strict::wrong;

/// Drives parallel tracks over a rectangle.
pub struct Lawnmower<D, B> {
    dynamics: D,
    area: MissionArea,
    belief: B,
    /// Where labels are read, in order.
    places: Vec<Site>,
    /// Which of them is next.
    next: usize,
    /// Whether the motion that was planned last ends there.
    arrives: bool,
    /// Whether it also reads labels on its way to them.
    always_reads: bool,
}

/// Whether an area is one that it can survey: tracks are straight and equally long.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub fn check_area(area: &MissionArea) -> Result<()> {
    let expected = "none with algorithm lawnmower, whose tracks go straight across";
    if area.sides().next().is_some() {
        return wrong("area", "a border that is not along an axis", expected);
    }
    match area.keep_outs().count() {
        0 => Ok(()),
        1 => wrong("keep_out", "a keep-out", expected),
        some => wrong("keep_out", format!("{some} keep-outs"), expected),
    }
}

impl<D: Dynamics, B: Belief> Lawnmower<D, B> {
    /// One that begins at a pose, for a mission of so many motions and labels at most.
    pub fn new(
        (area, dynamics, belief): (MissionArea, D, B),
        start: Pose,
        motions: u32,
        labels: Option<u32>,
    ) -> Self {
        let places = survey(&area, &dynamics, start, motions, labels.unwrap_or(motions));
        let always_reads = labels.is_none();
        Self { dynamics, area, belief, places, next: 0, arrives: false, always_reads }
    }
}

/// The places of the survey with the most tracks, up to square cells, that takes so many motions from its start at most.
/// If none does, the one with a single track.
fn survey(
    area: &MissionArea,
    dynamics: &impl Dynamics,
    start: Pose,
    motions: u32,
    labels: u32,
) -> Vec<Site> {
    let ground = Ground::of(area);
    let grid = dynamics.grid();
    let reach = f64::from(grid.reach_m(grid.speeds() - 1));
    // So many fit beside each other, one longest motion apart.
    let fit = |length: f64| (libm::floor(length / reach) as u32).clamp(1, labels);
    let square = libm::round(libm::sqrt(f64::from(labels) * ground.short / ground.long)) as u32;
    let nearest = |tracks: u32| {
        let corners = [[false, false], [true, false], [false, true], [true, true]];
        let surveys = corners.map(|corner| {
            let track = |track: u32| {
                // Of labels that cannot be shared out evenly, the first tracks have one more.
                let count = ((labels + tracks - 1 - track) / tracks).min(fit(ground.long));
                let place = move |k| ground.place(corner, [track, tracks], [k, count]);
                (0..count).filter_map(place)
            };
            (0..tracks).flat_map(track).collect::<Vec<_>>()
        });
        let way = |survey: &Vec<Site>| {
            let way = survey.first().map(|&first| first - start.site);
            way.map_or(0, |way| way.dot(way))
        };
        surveys.into_iter().min_by_key(way).unwrap_or_default()
    };
    let most = square.clamp(1, fit(ground.short));
    let fits = |survey: &Vec<Site>| takes(dynamics, start, survey, motions).is_some();
    (1..=most).rev().map(nearest).find(fits).unwrap_or_else(|| nearest(1))
}

/// The rectangle that is surveyed, metres.
#[derive(Clone, Copy)]
struct Ground {
    min: Point2<f64>,
    /// Whether its longer side is along x.
    is_wide: bool,
    long: f64,
    short: f64,
}

impl Ground {
    fn of(area: &MissionArea) -> Self {
        let [min, max] = [area.bounds().min(), area.bounds().max()].map(Point2::<f64>::from);
        let [x, z] = (max - min).into();
        Self { min, is_wide: x >= z, long: x.max(z), short: x.min(z) }
    }

    /// The `k`-th of `count` places on one of `tracks`, with the survey mirrored along its tracks, or across them.
    fn place(
        &self,
        [along, across]: [bool; 2],
        [track, tracks]: [u32; 2],
        [k, count]: [u32; 2],
    ) -> Option<Site> {
        let share = |k: u32, of: u32, is_mirrored: bool| {
            let share = (f64::from(k) + 0.5) / f64::from(of);
            if is_mirrored { 1.0 - share } else { share }
        };
        let along = self.long * share(k, count, along != (track % 2 == 1));
        let across = self.short * share(track, tracks, across);
        let [x, z] = if self.is_wide { [along, across] } else { [across, along] };
        Site::try_from(Point2::new(self.min.x + x, self.min.y + z)).ok()
    }
}

/// The motions of a way to places; `None` if they are more than `most`.
fn takes(dynamics: &impl Dynamics, mut pose: Pose, places: &[Site], most: u32) -> Option<u32> {
    let (mut made, mut left) = (0, places.iter());
    let mut place = left.next();
    while let Some(&site) = place {
        let leg = toward(dynamics, pose, site)?;
        (pose, made) = (leg.target, made + 1);
        if made > most {
            return None;
        }
        if leg.arrives {
            place = left.next();
        }
    }
    Some(made)
}

/// A motion towards a place.
struct Leg {
    action: Action,
    target: Pose,
    /// Whether it ends at the place, as nearly as the steps of the vehicle allow.
    arrives: bool,
}

/// The motion from a pose towards a place: straight there, or a turn on the spot if that is not in the fan.
fn toward(dynamics: &impl Dynamics, pose: Pose, place: Site) -> Option<Leg> {
    let (grid, fan) = (dynamics.grid(), dynamics.fan());
    let way = Point2::<f64>::from(place) - Point2::from(pose.site);
    let heading = Heading::from_radians(libm::atan2(way.y, way.x)).ok()?;
    let turn = heading.since(pose.heading).0.cast_signed();
    let (side, rays) = if turn < 0 { (Side::Right, fan.right) } else { (Side::Left, fan.left - 1) };
    let spacing = fan.spacing.0.max(1);
    let number = (turn.unsigned_abs() + spacing / 2) / spacing;
    if number > rays {
        let (action, target) = dynamics.turn_in_place(pose, side)?;
        return Some(Leg { action, target, arrives: false });
    }
    let last = grid.speeds() - 1;
    let steps = libm::floor(way.norm() * 1e3 / f64::from(grid.speed_step_mm()));
    // A motion is never of length 0.
    let speed = steps.clamp(1.0, f64::from(last)) as u16;
    let action = grid.action(dynamics.ray(pose, side, number).index, speed);
    let target = dynamics.target(pose, action)?;
    Some(Leg { action, target, arrives: steps <= f64::from(last) })
}

impl<D: Dynamics, B: Belief> Planner for Lawnmower<D, B> {
    type Belief = B;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.belief.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        let is_inside = |site| self.area.contains(site);
        let place = self.places.get(self.next);
        let leg = place.and_then(|&place| toward(&self.dynamics, pose, place));
        let Some(Leg { action, target, arrives }) =
            leg.filter(|leg| is_inside(leg.target.site) || !is_inside(pose.site))
        else {
            return Plan::Stop(StopReason::Cornered);
        };
        self.arrives = arrives;
        let wants_label = (arrives || self.always_reads) && is_inside(target.site);
        let motion = motion(&self.dynamics, pose, action, target);
        Plan::Move(Motion { wants_label, ..motion })
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if self.arrives {
            self.next += 1;
            if self.next == self.places.len() {
                self.places.reverse();
                // It is at the first of them.
                self.next = usize::from(self.places.len() > 1);
            }
        }
        take_in(&mut self.belief, pose, reading, tolerance)
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        self.belief.observe_on_the_way(site, reading)
    }

    fn belief(&self) -> &B {
        &self.belief
    }
}
