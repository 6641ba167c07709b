//! The harness's own geometry: paths as points in metres, and how far they leave an area. It shares no code with the
//! planner.

use host_sim::mission::definition::Mission;
use nalgebra::Point2;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::link::message::MissionArea;
use planner_core::{Pose, Site};

/// A point in metres.
pub type Point = Point2<f64>;

/// A site in metres.
pub fn metres(site: Site) -> Point {
    Point::new(site.x().into(), site.z().into()) / f64::from(UNITS_PER_METRE)
}

/// An area in metres.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Its corners, counter-clockwise.
    pub border: Vec<Point>,
    /// Keep-outs: all within a radius of a hull.
    pub keep_outs: Vec<(Vec<Point>, f64)>,
    /// The shores of a lake, if it is one: a point is in the water if an odd number of sides lies beyond it.
    pub shores: Vec<Vec<Point>>,
}

impl Ground {
    /// The ground of a mission.
    pub fn of_mission(mission: &Mission) -> Self {
        let rings = mission.lake.iter().flat_map(|it| it.polygons.iter().flatten());
        Self { shores: rings.cloned().collect(), ..Self::of(&mission.config.area) }
    }

    /// The ground of an area.
    pub fn of(area: &MissionArea) -> Self {
        let points = |sites: &[Site]| sites.iter().map(|site| metres(*site)).collect::<Vec<_>>();
        let keep_out = |it: &planner_core::KeepOut<_>| {
            (points(it.hull.corners()), f64::from(it.radius) / f64::from(UNITS_PER_METRE))
        };
        Self {
            border: points(area.corners()),
            keep_outs: area.hulls().map(keep_out).collect(),
            shores: Vec::new(),
        }
    }

    /// How far inside the border a point lies; negative outside.
    pub fn depth(&self, p: Point) -> f64 {
        edges(&self.border)
            .map(|(a, b)| (b - a).perp(&(p - a)) / (b - a).norm())
            .fold(f64::INFINITY, f64::min)
    }

    /// The distance from the nearest keep-out; negative within one.
    pub fn clearance(&self, p: Point) -> f64 {
        let from = |(hull, radius): &(Vec<Point>, f64)| distance_to_hull(p, hull) - radius;
        self.keep_outs.iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// How far a point is from where the robot must not be; negative there.
    pub fn margin(&self, p: Point) -> f64 {
        self.depth(p).min(self.clearance(p)).min(self.off_shore(p))
    }

    /// How far from the shore a point lies; negative on land.
    fn off_shore(&self, p: Point) -> f64 {
        let sides = || self.shores.iter().flat_map(|ring| edges(ring));
        let is_beyond = |(a, b): &(Point, Point)| {
            (a[1] > p[1]) != (b[1] > p[1])
                && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        };
        let is_water = sides().filter(is_beyond).count() % 2 == 1;
        let off = sides().map(|side| distance_to_edge(p, side)).fold(f64::INFINITY, f64::min);
        if is_water || self.shores.is_empty() { off } else { -off }
    }
}

/// Points along a motion, close enough to each other to notice what lies between.
pub fn path(
    from: Pose,
    to: Pose,
    [length, turn]: [f64; 2],
    is_car: bool,
    points: u32,
) -> Vec<Point> {
    let (start, end) = (metres(from.site), metres(to.site));
    (0..=points)
        .map(|k| {
            let share = f64::from(k) / f64::from(points);
            if !is_car || k == points {
                return start + (end - start) * share;
            }
            let half = 0.5 * turn * share;
            let chord = length * share * if half == 0.0 { 1.0 } else { half.sin() / half };
            let (sin, cos) = (from.heading.radians() + half).sin_cos();
            Point::new(start.x + chord * cos, start.y + chord * sin)
        })
        .collect()
}

fn edges(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn distance_to_hull(p: Point, hull: &[Point]) -> f64 {
    if hull.len() > 2 && edges(hull).all(|(a, b)| (b - a).perp(&(p - a)) >= 0.0) {
        return 0.0;
    }
    edges(hull).map(|edge| distance_to_edge(p, edge)).fold(f64::INFINITY, f64::min)
}

fn distance_to_edge(p: Point, (a, b): (Point, Point)) -> f64 {
    let along = b - a;
    let t = (p - a).dot(&along) / along.norm_squared().max(1e-30);
    (p - (a + along * t.clamp(0.0, 1.0))).norm()
}
