//! A lawnmower: the survey that a user drives who has no planner. A baseline, blind to the labels it reads.
//!
//! Its tracks are parallel to a side of the area, evenly spaced, and driven to and fro. As many labels as the mission may
//! read are spread evenly over them. The mission's motions allow some of these surveys. It drives the one whose labels
//! lie in the squarest cells. It begins at the corner that is nearest to the start. Labels of a track are at least one of
//! the longest motions apart. So are the tracks.
//!
//! A mission without a limit on labels reads one after each motion. Where a survey ends before the mission, the vehicle
//! drives the same tracks back.

use anyhow::Result;
use nalgebra::Point2;
use planner_core::dynamics::{Action, Dynamics, Side};
use planner_core::{Heading, Motion, Pose, Reading, Site, StopReason, Workspace as _};

use crate::mission::baseline::{Ground, Strategy, motion};
use crate::mission::strict::wrong;
use crate::mission::terrain::Terrain;

/// Drives parallel tracks over a rectangle.
pub struct Lawnmower {
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
pub fn check_area(area: &Terrain) -> Result<()> {
    let expected = "none with algorithm lawnmower, whose tracks go straight across";
    if area.sides().next().is_some() {
        return wrong("area", "a border that is not along an axis", expected);
    }
    if area.chart().is_some() {
        return wrong("area", "a map", expected);
    }
    match area.keep_outs().count() {
        0 => Ok(()),
        1 => wrong("keep_out", "a keep-out", expected),
        some => wrong("keep_out", format!("{some} keep-outs"), expected),
    }
}

impl Lawnmower {
    /// One that begins at a pose, for a mission of so many motions and labels at most.
    pub fn new(
        (area, dynamics): (&Terrain, &impl Dynamics),
        start: Pose,
        motions: u32,
        labels: Option<u32>,
    ) -> Self {
        let places = survey(area, dynamics, start, motions, labels.unwrap_or(motions));
        let always_reads = labels.is_none();
        Self { places, next: 0, arrives: false, always_reads }
    }
}

/// The places of a survey, in order: of all that take so many motions at most, the one with the squarest cells. If none
/// does, a single track.
fn survey(
    area: &Terrain,
    dynamics: &impl Dynamics,
    start: Pose,
    motions: u32,
    labels: u32,
) -> Vec<Site> {
    let grid = dynamics.grid();
    let apart = f64::from(grid.reach_m(grid.speeds() - 1));
    let mut patterns: Vec<_> = [true, false]
        .into_iter()
        .flat_map(|is_along_x| {
            let pattern = move |tracks| Pattern::new(area, is_along_x, (tracks, labels), apart);
            // With more tracks than in square cells, a survey is only longer.
            let square = pattern(1).square();
            (1..=square).map(pattern)
        })
        .collect();
    patterns.sort_by(|a, b| a.elongation().total_cmp(&b.elongation()));
    let mut surveys = patterns.iter().map(|pattern| pattern.nearest(start.site));
    let fits = |survey: &Vec<Site>| takes(dynamics, start, survey, motions).is_some();
    let single = || patterns.iter().find(|it| it.tracks == 1).map(|it| it.nearest(start.site));
    surveys.find(fits).or_else(single).unwrap_or_default()
}

/// How tracks lie in a rectangle; metres.
#[derive(Clone, Copy)]
struct Pattern {
    min: Point2<f64>,
    is_along_x: bool,
    /// Of a track, and of all tracks side by side.
    length: f64,
    breadth: f64,
    tracks: u32,
    labels: u32,
    /// Tracks, and labels of a track, are so far apart at least.
    apart: f64,
}

impl Pattern {
    fn new(area: &Terrain, is_along_x: bool, (tracks, labels): (u32, u32), apart: f64) -> Self {
        let [min, max] = [area.bounds().min(), area.bounds().max()].map(Point2::<f64>::from);
        let [x, z] = (max - min).into();
        let (length, breadth) = if is_along_x { (x, z) } else { (z, x) };
        Self { min, is_along_x, length, breadth, tracks, labels, apart }
    }

    /// How many fit on a length.
    fn fit(&self, length: f64) -> u32 {
        (libm::floor(length / self.apart) as u32).clamp(1, self.labels)
    }

    /// With so many tracks labels lie in squares, or nearly.
    fn square(&self) -> u32 {
        let tracks = libm::sqrt(f64::from(self.labels) * self.breadth / self.length);
        (libm::round(tracks) as u32).clamp(1, self.fit(self.breadth))
    }

    /// How many times as long as broad the cell of a label is, or as broad as long.
    fn elongation(&self) -> f64 {
        let tracks = f64::from(self.tracks);
        let ratio = self.length * tracks * tracks / (f64::from(self.labels) * self.breadth);
        ratio.max(1.0 / ratio)
    }

    /// The places from the corner that is nearest to a site.
    fn nearest(&self, site: Site) -> Vec<Site> {
        let corners = [[false, false], [true, false], [false, true], [true, true]];
        let surveys = corners.map(|corner| self.places(corner));
        let way = |survey: &Vec<Site>| {
            let way = survey.first().map(|&first| first - site);
            way.map_or(0, |way| way.dot(way))
        };
        surveys.into_iter().min_by_key(way).unwrap_or_default()
    }

    /// The places of all tracks, mirrored along them, or across.
    fn places(&self, [is_back, is_aside]: [bool; 2]) -> Vec<Site> {
        let share = |k: u32, of: u32, is_mirrored: bool| {
            let share = (f64::from(k) + 0.5) / f64::from(of);
            if is_mirrored { 1.0 - share } else { share }
        };
        let track = |track: u32| {
            // Of labels that cannot be shared out evenly, the first tracks have one more.
            let count = (self.labels + self.tracks - 1 - track) / self.tracks;
            let count = count.min(self.fit(self.length));
            let across = self.breadth * share(track, self.tracks, is_aside);
            (0..count).filter_map(move |k| {
                let along = self.length * share(k, count, is_back != (track % 2 == 1));
                let [x, z] = if self.is_along_x { [along, across] } else { [across, along] };
                Site::try_from(Point2::new(self.min.x + x, self.min.y + z)).ok()
            })
        };
        (0..self.tracks).flat_map(track).collect()
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

impl<D: Dynamics> Strategy<D> for Lawnmower {
    fn choose(&mut self, ground: &Ground<D>, pose: Pose) -> Result<Motion, StopReason> {
        let is_inside = |site| ground.area.contains(site);
        let place = self.places.get(self.next);
        let leg = place.and_then(|&place| toward(&ground.dynamics, pose, place));
        let leg = leg.filter(|leg| is_inside(leg.target.site) || !is_inside(pose.site));
        let Leg { action, target, arrives } = leg.ok_or(StopReason::Cornered)?;
        self.arrives = arrives;
        let wants_label = (arrives || self.always_reads) && is_inside(target.site);
        Ok(Motion { wants_label, ..motion(&ground.dynamics, pose, action, target) })
    }

    fn arrive(&mut self, _: &Ground<D>, _: Pose, _: Option<Reading>) {
        if self.arrives {
            self.next += 1;
            if self.next == self.places.len() {
                self.places.reverse();
                // It is at the first of them.
                self.next = usize::from(self.places.len() > 1);
            }
        }
    }
}
