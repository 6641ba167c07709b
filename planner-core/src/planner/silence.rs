//! What a planner remembers of the motions since the last label, so that every mission ends.
//!
//! A plan is a search of bounded cost. From one pose it may find a way to the left, and after that motion a way to the
//! right. So a planner follows a way that was hard to find (`Course`), and keeps four rules, whatever its search finds:
//!
//! - a planner that turned on the spot and read no label continues to turn to the same side, until it drives;
//! - it does not turn on the spot to a heading where it has been before;
//! - it stops after four full turns, of all kinds of motions together, without a label. Straight ways may be of any
//!   length;
//! - look-ahead stops after sixteen labels in a row that were not expected to tell much: where positions err, or where
//!   a user asks for a least worth. In the second case it does not read them.
//!
//! Without these rules, five of 20,000 random missions went round or undid a turn. In 17 a label came after more than
//! four full turns; they now end there.

use crate::geometry::heading::Angle;
use crate::geometry::lattice::Site;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::planner::{Motion, Plan, StopReason};
use crate::search::course::Course;

/// A full turn, in the units of [`Silence::turned`].
const FULL_TURN: u32 = 1 << 24;

/// So much turning without a label is too much.
const MOST: u32 = 4 * FULL_TURN;

/// A motion that turns by more than this counts as at least [`LEAST`], so that wide circles end as well.
const SLIGHT: u32 = FULL_TURN / 128;

/// See [`SLIGHT`].
const LEAST: u32 = FULL_TURN / 32;

/// So many dull labels in a row are enough.
const MOST_DULL: u8 = 16;

/// A heading so near to another is the same.
const NEAR: u32 = Angle::of_radians(0.001).0;

/// A change of heading, counter-clockwise, in 2^-32 turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum LastTurn {
    /// There was no motion yet, or a label came.
    #[default]
    None,
    /// On the way.
    Driving(i32),
    /// On the spot.
    InPlace(i32),
}

/// How a vehicle has turned since the last label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Silence {
    /// All turns together, to either side.
    turned: u32,
    /// Those on the spot since the last drive, less full turns.
    on_the_spot: i32,
    /// Where it was before the last of them.
    spot: Option<Site>,
    /// The motion before, and the one that was planned last.
    last: LastTurn,
    next: LastTurn,
    /// The way that the motion before was part of, and the same of the one that was planned last.
    course: Course,
    next_course: Course,
    /// Labels in a row that were not expected to tell much.
    dull: u8,
    /// Whether the next one is such.
    next_is_dull: bool,
}

impl Silence {
    /// A label has just come.
    pub(crate) const NONE: Self = Self {
        turned: 0,
        on_the_spot: 0,
        spot: None,
        last: LastTurn::None,
        next: LastTurn::None,
        course: Course::NONE,
        next_course: Course::NONE,
        dull: 0,
        next_is_dull: false,
    };

    /// The way of several motions that is under way.
    pub(crate) const fn course(&self) -> Course {
        self.course
    }

    /// Records whether the next label is not expected to tell much. Returns whether the motion may be made all the same.
    pub(crate) const fn bears(&mut self, is_dull: bool) -> bool {
        self.next_is_dull = is_dull;
        !is_dull || self.dull < MOST_DULL
    }

    /// Whether the vehicle has turned all round since the last label.
    pub(crate) const fn is_long(&self) -> bool {
        self.turned > FULL_TURN
    }

    /// Whether the vehicle has turned half round since the last label.
    pub(crate) const fn is_back(&self) -> bool {
        self.turned > FULL_TURN / 2
    }

    /// Whether the last label, or the next one, is not expected to tell much.
    pub(crate) const fn is_dull(&self) -> bool {
        self.dull > 0 || self.next_is_dull
    }

    /// The plan of a planner that has found this motion from a pose, and the course that the motion is part of.
    pub(crate) fn keep<D: Dynamics>(
        &mut self,
        pose: Pose,
        found: Motion,
        course: Course,
        dynamics: &D,
    ) -> Plan {
        (self.next, self.next_course) = (LastTurn::None, course);
        if found.wants_label {
            return Plan::Move(found);
        }
        let motion = self.steady(pose, found, dynamics);
        if motion.action != found.action {
            self.next_course.give_up_way();
        }
        let by = motion.target.heading.since(pose.heading).0 as i32;
        let is_drive = motion.target.site != pose.site;
        if self.spot.replace(pose.site) != Some(pose.site) {
            // Its position errs: from here there may be more.
            self.on_the_spot = 0;
        }
        self.next = if is_drive { LastTurn::Driving(by) } else { LastTurn::InPlace(by) };
        let after = self.after(self.next);
        let has_been_here = !is_drive && after.on_the_spot.unsigned_abs() < NEAR;
        if has_been_here || after.turned > MOST {
            return Plan::Stop(StopReason::Undecided);
        }
        Plan::Move(motion)
    }

    /// The same motion, or the turn to the other side if it would undo the turn before.
    fn steady<D: Dynamics>(&self, pose: Pose, found: Motion, dynamics: &D) -> Motion {
        let by = found.target.heading.since(pose.heading).0 as i32;
        let side = match self.last {
            LastTurn::InPlace(last) if last > 0 && by < 0 => Side::Left,
            LastTurn::InPlace(last) if last < 0 && by > 0 => Side::Right,
            _ => return found,
        };
        let is_drive = found.target.site != pose.site;
        let onwards = if is_drive { None } else { dynamics.turn_in_place(pose, side) };
        onwards.map_or(found, |(action, target)| Motion {
            action,
            target,
            control: dynamics.control(pose, action),
            ..found
        })
    }

    /// Records that the motion was made, and whether a label was read.
    pub(crate) fn observe(&mut self, has_label: bool) {
        let dull = self.dull.saturating_add(u8::from(self.next_is_dull));
        *self = match has_label {
            true if self.next_is_dull => Self { dull, ..Self::NONE },
            true => Self::NONE,
            false => Self { dull, ..self.after(self.next) },
        };
    }

    /// Records that a label was read on the way of the motion that was planned last.
    pub(crate) const fn hear(&mut self) {
        let Self { dull, next_is_dull, .. } = *self;
        *self = Self { dull, next_is_dull, ..Self::NONE };
    }

    fn after(self, turn: LastTurn) -> Self {
        let (by, on_the_spot) = match turn {
            LastTurn::None => return Self { dull: self.dull, ..Self::NONE },
            LastTurn::Driving(by) => (by, 0),
            LastTurn::InPlace(by) => (by, self.on_the_spot.wrapping_add(by)),
        };
        let by = by.unsigned_abs() >> 8;
        let by = if by > SLIGHT { by.max(LEAST) } else { by };
        let turned = self.turned.saturating_add(by);
        let (course, next_course) = (self.next_course, Course::NONE);
        Self { turned, on_the_spot, last: turn, next: LastTurn::None, course, next_course, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::heading::Heading;
    use crate::motion::unicycle::Unicycle;

    fn start() -> Pose {
        Pose { site: Site::new(0, 0).unwrap(), heading: Heading(0) }
    }

    /// The sharpest turn in place to a side.
    fn turn(pose: Pose, side: Side) -> Motion {
        let dynamics = Unicycle::paper();
        let (action, target) = dynamics.turn_in_place(pose, side).unwrap();
        Motion {
            stage: None,
            recovery: None,
            action,
            control: dynamics.control(pose, action),
            target,
            wants_label: false,
            examined: 0,
            proven: true,
        }
    }

    #[test]
    fn a_turn_is_not_undone_and_ends_before_a_full_turn() {
        let (mut silence, mut pose) = (Silence::default(), start());
        for n in 0..3 {
            let side = if n == 0 { Side::Left } else { Side::Right };
            // Asked twice it says the same.
            let plan = silence.keep(pose, turn(pose, side), Course::NONE, &Unicycle::paper());
            assert_eq!(
                silence.keep(pose, turn(pose, side), Course::NONE, &Unicycle::paper()),
                plan
            );
            assert_eq!(plan, Plan::Move(turn(pose, Side::Left)), "{n}");
            silence.observe(false);
            pose = turn(pose, Side::Left).target;
        }
        let plan = silence.keep(pose, turn(pose, Side::Left), Course::NONE, &Unicycle::paper());
        assert_eq!(plan, Plan::Stop(StopReason::Undecided));
        // A label makes it new.
        silence.observe(true);
        let plan = silence.keep(pose, turn(pose, Side::Right), Course::NONE, &Unicycle::paper());
        assert_eq!(plan, Plan::Move(turn(pose, Side::Right)));
    }

    #[test]
    fn drives_that_turn_round_and_round_end_and_straight_ones_do_not() {
        let away = Site::new(1 << 16, 0).unwrap();
        for (by, most) in [(1_u32 << 30, Some(16)), (0, None)] {
            let (mut silence, mut pose, mut motions) = (Silence::default(), start(), 0);
            let ended = (0..1_000).find_map(|_| {
                let site = if pose.site == away { start().site } else { away };
                let target = Pose { site, heading: Heading(pose.heading.0.wrapping_add(by)) };
                let motion = Motion { target, ..turn(pose, Side::Left) };
                let plan = silence.keep(pose, motion, Course::NONE, &Unicycle::paper());
                if let Plan::Stop(_) = plan {
                    return Some(motions);
                }
                silence.observe(false);
                (pose, motions) = (target, motions + 1);
                None
            });
            assert_eq!(ended, most);
        }
    }
}
