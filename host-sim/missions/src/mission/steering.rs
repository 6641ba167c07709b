//! Planners that follow a front by steering, without a belief: baselines for planners that follow fronts.
//!
//! Each reads a label after every motion. The label read last says to which side the front lies. A *zigzag* goes
//! straight on and turns when the label changes. A *bang-bang* turns towards the front in every motion, so it goes in
//! circles. Their map is where the label changes: see [`Crossings`].

use std::f64::consts::PI;

use planner_core::dynamics::Dynamics;
use planner_core::{Heading, Label, Motion, Pose, Reading, StopReason, Workspace};

use crate::mission::baseline::{Baseline, Ground, Strategy, motion};
use crate::mission::crossings::Crossings;

/// When the robot turns towards the front, and by what angle, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steering {
    /// When the label changes, so that it goes to either side of its mean course by half the angle. If the label stays
    /// the same for [`PATIENCE`], the front bends away or is lost, and it turns again: after as much more each time, so
    /// that it searches in a spiral.
    Zigzag(f64),
    /// In every motion.
    BangBang(f64),
}

/// Metres that a zigzag goes on without a change of the label.
pub const PATIENCE: f64 = 4.0;

/// A zigzag that turns by 45 degrees.
pub const ZIGZAG: Steering = Steering::Zigzag(PI / 4.0);

/// A bang-bang that turns by 10 degrees a motion: with motions of 1 m a circle has a radius of 5.7 m. Larger angles
/// were tried, up to 45 degrees. They make longer detours and lose more fronts.
pub const BANG_BANG: Steering = Steering::BangBang(PI / 18.0);

/// Steers by the labels. It begins along the front, as the given points have it, in the direction nearer to its heading.
#[derive(Clone, Debug)]
pub struct Steered {
    steering: Steering,
    /// The speed of all motions, in steps of the grid, and their length, metres.
    speed: u16,
    metres: f64,
    /// Whither it goes; `None` before the first motion.
    course: Option<Course>,
}

/// Whither it goes.
#[derive(Clone, Copy, Debug)]
struct Course {
    /// Radians.
    angle: f64,
    /// 1 if the front's +1 side is to the left, else -1.
    sense: f64,
    /// Metres since the last turn.
    since: f64,
    /// Turns since the label changed last.
    turns: f64,
}

impl Course {
    /// By so much towards the front, seen from the side of a label.
    fn turned(self, by: f64, from: Label) -> Self {
        let side = if from == Label::Positive { -1.0 } else { 1.0 };
        Self { angle: self.angle + self.sense * side * by, since: 0.0, ..self }
    }
}

impl Steered {
    /// A planner with motions of about so many metres.
    pub fn planner<D: Dynamics, G: Workspace>(
        (area, dynamics): (G, D),
        crossings: Crossings,
        steering: Steering,
        metres: f64,
    ) -> Baseline<Self, D, Crossings, G> {
        let grid = dynamics.grid();
        let steps = libm::round(metres * 1e3 / f64::from(grid.speed_step_mm()));
        let speed = (steps as u16).clamp(1, grid.speeds().saturating_sub(1));
        let strategy = Self { steering, speed, metres: grid.reach_m(speed).into(), course: None };
        Baseline { strategy, ground: Ground { dynamics, area, belief: Box::new(crossings) } }
    }

    /// The course after a label, with the one before.
    fn after(&self, course: Course, before: Option<Label>, label: Label) -> Course {
        let course = Course { since: course.since + self.metres, ..course };
        match (self.steering, before) {
            (Steering::BangBang(turn), _) => course.turned(turn, label),
            (Steering::Zigzag(turn), None) => course.turned(0.5 * turn, label),
            (Steering::Zigzag(turn), Some(before)) if before != label => {
                Course { turns: 0.0, ..course.turned(turn, label) }
            }
            (Steering::Zigzag(turn), _)
                if course.since > PATIENCE * (course.turns + 1.0) - 1e-6 =>
            {
                Course { turns: course.turns + 1.0, ..course.turned(turn, label) }
            }
            (Steering::Zigzag(_), _) => course,
        }
    }
}

impl<D: Dynamics, G: Workspace> Strategy<D, Crossings, G> for Steered {
    fn choose(
        &mut self,
        ground: &Ground<D, Crossings, G>,
        pose: Pose,
    ) -> Result<Motion, StopReason> {
        let Ground { dynamics, area, belief } = ground;
        let begun = || {
            let (angle, is_left) = belief.ahead(pose.heading.radians());
            Course { angle, sense: if is_left { 1.0 } else { -1.0 }, since: 0.0, turns: 0.0 }
        };
        let course = self.course.unwrap_or_else(begun);
        self.course = Some(course);
        let leg = Heading::from_radians(course.angle).ok().and_then(|heading| {
            let [ray, _] = dynamics.around(pose, heading);
            let action = dynamics.grid().action(ray.index, self.speed);
            Some((action, dynamics.target(pose, action)?))
        });
        let leg = leg.filter(|(_, target)| area.contains(target.site));
        let (action, target) = leg.ok_or(StopReason::Cornered)?;
        Ok(motion(dynamics, pose, action, target))
    }

    fn arrive(&mut self, ground: &Ground<D, Crossings, G>, _: Pose, reading: Option<Reading>) {
        if let (Some(Reading::Side(label)), Some(course)) = (reading, self.course) {
            self.course = Some(self.after(course, ground.belief.label(), label));
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;
    use planner_core::{Area, Plan, Planner as _, Sample, Unicycle};

    use super::*;

    /// The places after so many motions from (0, 2) along the x axis, whose +1 side is above it, and the crossings.
    fn places(
        steering: Steering,
        motions: u32,
        label: impl Fn(Point2<f64>) -> Label,
    ) -> Vec<Point2<f64>> {
        let given = [([0.0, 3.0], Label::Positive), ([0.0, -3.0], Label::Negative)];
        let given = given.map(|(at, label)| Sample::at(at, label).expect("a sample"));
        let area = Area::metres([-500.0, -500.0], [500.0, 500.0]).expect("an area");
        let vehicle = Unicycle::new(1_000, 1.6, 11, 100).expect("a vehicle");
        let crossings = Crossings::given(&given);
        let mut planner = Steered::planner((area, vehicle), crossings, steering, 1.0);
        let mut pose =
            Pose::at([0.0, 2.0], Heading::from_radians(0.3).expect("an angle")).expect("a pose");
        let mut places = Vec::new();
        for _ in 0..motions {
            let Plan::Move(next) = planner.plan(pose) else { panic!("a motion") };
            pose = next.target;
            let at = Point2::from(pose.site);
            planner.observe(pose, Some(label(at).into())).expect("any label");
            if let Some(crossing) = planner.belief().crossing {
                assert!(crossing.y.abs() <= 0.5, "{crossing}");
            }
            places.push(at);
        }
        places
    }

    fn side(at: Point2<f64>) -> Label {
        if at.y > 0.0 { Label::Positive } else { Label::Negative }
    }

    #[test]
    fn a_zigzag_keeps_to_a_straight_front() {
        let places = places(ZIGZAG, 100, side);
        assert!(places[20..].iter().all(|at| at.y.abs() < 0.8), "{places:?}");
        // Legs go to either side of the front by 22.5 degrees, or nearly.
        assert!(places[99].x > 88.0, "{}", places[99]);
    }

    #[test]
    fn a_zigzag_without_a_change_goes_in_a_spiral() {
        let places = places(ZIGZAG, 300, |_| Label::Positive);
        let far =
            |k: usize| places[..k].iter().map(|at| (at - places[0]).norm()).fold(0.0, f64::max);
        // Legs of 4, 8, 12, 16 and 20 m, each turned by 45 degrees, lead 36 m away.
        assert!((far(60) - 36.0).abs() < 1.0 && far(300) > 60.0, "{} {}", far(60), far(300));
    }

    #[test]
    fn a_bang_bang_goes_in_circles_towards_the_front() {
        let along = places(BANG_BANG, 100, side);
        assert!(along[10..].iter().all(|at| at.y.abs() < 4.0) && along[99].x > 60.0, "{along:?}");
        // 36 motions of 10 degrees are a circle.
        let round = places(BANG_BANG, 37, |_| Label::Positive);
        assert!((round[36] - round[0]).norm() < 0.05, "{round:?}");
    }
}
