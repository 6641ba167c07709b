//! How a sensor fails: wrappers around a simulated robot, one for each fault.

use nalgebra::Point2;
use planner_core::{Label, Motion, Pose, Reading, Site};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::world::World;
use crate::world::on_the_way::Way;
use crate::world::robot::{Glimpse, Robot};

/// A fault of the sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// What the sensor does.
    pub kind: FaultKind,
    /// The first label that the fault spoils, from 1.
    pub from: u32,
    /// The last one.
    pub to: u32,
}

/// What a sensor does that fails.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FaultKind {
    /// It reads nothing.
    Off,
    /// It reads the same label everywhere.
    Stuck(Label),
    /// It reads either label, each with probability 1/2.
    Garbage,
    /// It reads the opposite label.
    Inverted,
    /// It reads the label of the place so many metres before the end of the motion, on the straight way there.
    Slow(f64),
    /// It reports the reading that it had so many labels before; until then nothing.
    Delayed(u32),
    /// It reads nothing with this probability.
    Dropouts(f64),
}

impl Fault {
    /// Whether it can leave a label that was asked for without a reading.
    pub const fn reads_nothing(&self) -> bool {
        matches!(self.kind, FaultKind::Off | FaultKind::Delayed(_) | FaultKind::Dropouts(_))
    }

    /// Whether it comes before the noise. A slow sensor reads another place, and that label may be flipped.
    pub const fn precedes_noise(&self) -> bool {
        matches!(self.kind, FaultKind::Slow(_))
    }
}

/// A robot whose sensor fails: a wrapper around any other.
pub struct Failing {
    body: Box<dyn Robot>,
    sensor: FailingSensor,
}

/// Its sensor.
struct FailingSensor {
    fault: Fault,
    /// What the robot moves in.
    world: World,
    rng: ChaCha8Rng,
    /// The readings without the fault: one for each label.
    read: Vec<Option<Reading>>,
}

impl Failing {
    /// A robot with one fault more.
    pub fn new(body: Box<dyn Robot>, fault: Fault, world: World, rng: ChaCha8Rng) -> Self {
        Self { body, sensor: FailingSensor { fault, world, rng, read: Vec::new() } }
    }

    /// Where the robot truly is if it reports this pose.
    fn place(&self, reported: Pose) -> Point2<f64> {
        Point2::from(self.body.true_pose().unwrap_or(reported).site)
    }
}

impl FailingSensor {
    /// What it reports of one more label.
    fn reports(&mut self, reading: Option<Reading>, way: [Point2<f64>; 2]) -> Option<Reading> {
        self.read.push(reading);
        self.spoilt(reading, way)
    }

    /// What the sensor reports in place of `reading` at the end of a straight way.
    fn spoilt(&mut self, reading: Option<Reading>, way: [Point2<f64>; 2]) -> Option<Reading> {
        // Drawn whether it is used or not, so that a path's chances do not depend on when the fault begins.
        let drawn: f64 = self.rng.random_range(0.0..1.0);
        let number = self.read.len() as u32;
        if !(self.fault.from..=self.fault.to).contains(&number) {
            return reading;
        }
        match self.fault.kind {
            FaultKind::Off => None,
            FaultKind::Stuck(label) => Some(label.into()),
            FaultKind::Garbage if drawn < 0.5 => Some(Label::Positive.into()),
            FaultKind::Garbage => Some(Label::Negative.into()),
            FaultKind::Inverted => reading.map(|reading| match reading {
                Reading::Side(label) => Reading::Side(-label),
                on_it @ Reading::Boundary => on_it,
            }),
            FaultKind::Slow(metres) => reading.map(|_| self.world.reading(before(way, metres))),
            FaultKind::Delayed(labels) => {
                let before = number.checked_sub(labels + 1);
                before.and_then(|before| self.read[before as usize])
            }
            FaultKind::Dropouts(probability) => reading.filter(|_| drawn >= probability),
        }
    }
}

/// The site so many metres before the end of a straight way; its start if the way is shorter.
fn before([start, end]: [Point2<f64>; 2], metres: f64) -> Site {
    let way = start - end;
    let length = libm::hypot(way.x, way.y);
    let place = if length > metres { end + way * (metres / length) } else { start };
    Site::try_from(place).expect("it lies between two sites")
}

impl Robot for Failing {
    fn true_pose(&self) -> Option<Pose> {
        self.body.true_pose()
    }

    fn travel(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        way: Way,
        pass: &mut dyn FnMut(Glimpse),
    ) -> Option<Reading> {
        let start = self.place(*pose);
        let Self { body, sensor } = self;
        sensor.world.advance();
        let reading = body.travel(motion, pose, way, &mut |it| {
            let reading = sensor.reports(it.reading, [start, Point2::from(it.site)]);
            pass(Glimpse { reading, ..it });
        });
        if !motion.wants_label {
            return reading;
        }
        let end = self.place(*pose);
        self.sensor.reports(reading, [start, end])
    }
}

#[cfg(test)]
mod tests {
    use planner_core::dynamics::{Action, Control};
    use planner_core::{Heading, Line};
    use rand::SeedableRng as _;

    use super::*;
    use crate::world::robot::Ideal;

    /// The readings of a drive along the x axis, a metre a label, +1 beyond `x = 5.5`. Each third motion asks for none.
    fn drive(kind: FaultKind, from: u32, to: u32) -> Vec<Option<i8>> {
        let world = World::divided_by(Line::from_coefficients(1.0, 0.0, -5.5).unwrap());
        let body = Box::new(Ideal { world: world.clone() });
        let fault = Fault { kind, from, to };
        let mut robot = Failing::new(body, fault, world, ChaCha8Rng::seed_from_u64(5));
        let site = |x: u32| Site::try_from(Point2::new(f64::from(x), 0.0)).unwrap();
        let mut pose = Pose { site: site(0), heading: Heading::default() };
        let mut readings = Vec::new();
        for x in 1..=12 {
            let target = Pose { site: site(x), ..pose };
            let wants_label = x % 3 != 0;
            let control = Control { distance_m: 1.0, turn_rad: 0.0 };
            let motion = Motion {
                target,
                wants_label,
                control,
                action: Action(0),
                stage: None,
                recovery: None,
                examined: 0,
                proven: true,
            };
            let reading = robot.perform(&motion, &mut pose);
            if wants_label {
                readings.push(reading.map(Reading::sign));
            } else {
                assert_eq!(reading, None);
            }
        }
        readings
    }

    const END: u32 = u32::MAX;
    const N: Option<i8> = Some(-1);
    const P: Option<i8> = Some(1);

    #[test]
    fn each_fault_spoils_the_labels_that_it_names() {
        // Labels 1 to 8 at x = 1, 2, 4, 5, 7, 8, 10 and 11.
        let whole = [N, N, N, N, P, P, P, P];
        let stuck = FaultKind::Stuck(Label::Negative);
        assert_eq!(drive(stuck, 9, END), whole, "no fault yet");
        for (kind, from, to, expected) in [
            (FaultKind::Off, 3, 6, [N, N, None, None, None, None, P, P]),
            (stuck, 6, END, [N, N, N, N, P, N, N, N]),
            (FaultKind::Stuck(Label::Positive), 1, 2, [P, P, N, N, P, P, P, P]),
            (FaultKind::Inverted, 4, 5, [N, N, N, P, N, P, P, P]),
            (FaultKind::Delayed(1), 1, END, [None, N, N, N, N, P, P, P]),
            (FaultKind::Delayed(3), 2, 6, [N, None, None, N, N, N, P, P]),
            (FaultKind::Dropouts(0.0), 1, END, whole),
            (FaultKind::Dropouts(1.0), 2, 2, [N, None, N, N, P, P, P, P]),
            (FaultKind::Slow(0.0), 1, END, whole),
            // The way of a motion is a metre, so that its start is the furthest that a slow sensor reads.
            (FaultKind::Slow(9.0), 1, END, whole),
        ] {
            assert_eq!(drive(kind, from, to), expected, "{kind:?}, labels {from} to {to}");
        }
        // Chance comes of the stream alone, so that a later fault draws the same.
        let garbage = drive(FaultKind::Garbage, 1, END);
        assert!(garbage.contains(&N) && garbage.contains(&P), "{garbage:?}");
        assert_eq!(drive(FaultKind::Garbage, 4, END)[3..], garbage[3..]);
    }

    #[test]
    fn a_slow_sensor_reads_the_way_that_was_driven() {
        let at = |x, z| Point2::new(x, z);
        for (way, metres, place) in [
            ([at(0.0, 0.0), at(3.0, 4.0)], 1.0, at(2.4, 3.2)),
            ([at(0.0, 0.0), at(3.0, 4.0)], 5.0, at(0.0, 0.0)),
            ([at(0.0, 0.0), at(3.0, 4.0)], 9.0, at(0.0, 0.0)),
            ([at(1.0, 1.0), at(1.0, 1.0)], 1.0, at(1.0, 1.0)),
        ] {
            assert_eq!(before(way, metres), Site::try_from(place).unwrap(), "{way:?}, {metres}");
        }
    }

    #[test]
    fn chances_are_fair() {
        let mut world = ChaCha8Rng::seed_from_u64(1);
        let count = |kind, of: fn(Option<Reading>) -> bool, rng: &mut ChaCha8Rng| {
            let body = Box::new(Ideal { world: World::UNKNOWN });
            let fault = Fault { kind, from: 1, to: END };
            let rng = ChaCha8Rng::seed_from_u64(rng.random_range(0..u64::MAX));
            let mut robot = Failing::new(body, fault, World::UNKNOWN, rng);
            robot.sensor.read.push(None);
            let way = [Point2::origin(); 2];
            (0..10_000).filter(|_| of(robot.sensor.spoilt(Some(Reading::Boundary), way))).count()
        };
        let positive = |reading: Option<Reading>| reading.map(Reading::sign) == P;
        let heads = count(FaultKind::Garbage, positive, &mut world);
        assert!((4_800..=5_200).contains(&heads), "{heads}");
        let lost = count(FaultKind::Dropouts(0.3), |reading| reading.is_none(), &mut world);
        assert!((2_800..=3_200).contains(&lost), "{lost}");
    }
}
