//! A mission along a front, and what is measured of it.

use nalgebra::Point2;
use planner_core::dynamics::Dynamics;
use planner_core::{MapPlace, Plan, Planner, Pose, Track, Workspace};
use rand_chacha::ChaCha8Rng;

use crate::campaign::fronts::true_front::TrueFront;

/// The longest motion of a mission, metres.
pub const REACH: f64 = 2.0;

/// A robot further from the front than this has lost it, metres, if it stays there for more than [`AWAY`].
const NEAR: f64 = 3.0 * REACH;

/// In steps.
const AWAY: f64 = 10.0;

/// A planner that follows a front and maps it.
pub trait Follower: Planner {
    /// Places on the front that its last motion adds to the map.
    fn vertices(&self) -> Vec<Vertex>;

    /// Places that the map has more when the mission ends.
    fn rest(&self) -> Vec<Vertex> {
        Vec::new()
    }

    /// Whether the front is known although the map has no place yet.
    fn is_found(&self) -> bool {
        false
    }

    /// Whether it has gone along all of a closed front.
    fn is_closed(&self) -> bool;

    /// Whether it follows a front: it was crossed, and is not lost.
    fn is_begun(&self) -> bool {
        false
    }
}

/// A vertex of the map.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Where the front is said to be.
    pub at: Point2<f64>,
    /// The front lies within so many metres with a probability of 90 %. `None` if the planner states no width.
    pub half_width: Option<f64>,
    /// So many motions ago.
    pub age: f64,
}

impl<D: Dynamics, G: Workspace> Follower for Track<D, G> {
    fn vertices(&self) -> Vec<Vertex> {
        self.belief().mapped().iter().copied().map(Vertex::from).collect()
    }

    fn rest(&self) -> Vec<Vertex> {
        let mut rest: Vec<_> = self.belief().places().map(Vertex::from).collect();
        rest.reverse();
        rest
    }

    fn is_found(&self) -> bool {
        self.found().is_some()
    }

    fn is_closed(&self) -> bool {
        Self::is_closed(self)
    }

    fn is_begun(&self) -> bool {
        self.belief().is_begun()
    }
}

impl From<MapPlace> for Vertex {
    fn from(MapPlace { waist, age, .. }: MapPlace) -> Self {
        let half_width = Some(waist.half_width(0.9));
        Self { at: waist.site.into(), half_width, age: age.into() }
    }
}

/// A vertex of the map beside the front as it was then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Its distance from the front, metres.
    pub off: f64,
    /// Whether the stated width holds the front; `None` if none is stated.
    pub is_covered: Option<bool>,
}

/// How a mission went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Flown {
    /// The vertices of the map.
    pub vertices: Vec<Measured>,
    /// Metres driven since the first vertex.
    pub driven: f64,
    /// How far the last vertex lies from the first, metres along the front.
    pub followed: f64,
    /// Labels read.
    pub labels: u32,
    /// How often the planner began again.
    pub restarts: u32,
    /// Whether the robot was further than 6 m from the front for the last ten steps and more, stopped, or made no map.
    pub is_lost: bool,
    /// How much of a closed front had been followed when the planner said that it is closed, metres.
    pub closed_after: Option<f64>,
}

/// How long a mission is, and how often its labels are true.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// Motions.
    pub motions: u32,
    /// Steps that a motion takes.
    pub steps: f64,
    /// Labels are true with this probability.
    pub p: f64,
}

/// Follows a front from a pose. Each motion is shown to `look`, from where and to where, after it was observed.
///
/// # Panics
/// When the planner refuses a label.
pub fn follow<P: Follower>(
    front: &TrueFront,
    mut planner: P,
    (course, mut pose): (Course, Pose),
    rng: &mut ChaCha8Rng,
    mut look: impl FnMut(&P, Pose, Pose),
) -> Flown {
    let (mut flown, mut last, mut away) = (Flown::default(), None, 0.0);
    for motion in 1..=course.motions {
        let steps = f64::from(motion) * course.steps;
        let Plan::Move(next) = planner.plan(pose) else {
            flown.is_lost = true;
            break;
        };
        let before = pose;
        let from = Point2::<f64>::from(pose.site);
        pose = next.target;
        let at = Point2::<f64>::from(pose.site);
        let label = front.sensed(at, steps, course.p, rng);
        let reading = next.wants_label.then(|| label.into());
        let was_begun = planner.is_begun();
        planner.observe(pose, reading).expect("any label is taken in");
        look(&planner, before, pose);
        flown.labels += u32::from(reading.is_some());
        let is_alarmed = planner.alarm().is_some_and(|it| it.is_grave());
        flown.restarts += u32::from(is_alarmed || was_begun && !planner.is_begun());
        flown.driven += if last.is_some() || planner.is_found() { (at - from).norm() } else { 0.0 };
        let rest = if motion == course.motions { planner.rest() } else { Vec::new() };
        for vertex in planner.vertices().into_iter().chain(rest) {
            let then = steps - vertex.age * course.steps;
            let off = front.distance(vertex.at, then);
            let is_covered = vertex.half_width.map(|half| off <= half);
            flown.vertices.push(Measured { off, is_covered });
            let along = front.along(vertex.at, then);
            flown.followed += last.map_or(0.0, |last| front.way_between(last, along));
            last = Some(along);
        }
        if planner.is_closed() && flown.closed_after.is_none() {
            flown.closed_after = Some(flown.followed.abs());
        }
        away = if front.distance(at, steps) > NEAR { away + course.steps } else { 0.0 };
    }
    flown.followed = flown.followed.abs();
    flown.is_lost |= flown.vertices.is_empty() || away > AWAY;
    flown
}
