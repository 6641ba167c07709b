//! Robots that watch a stretch of a front: how well they know all of it at all times.
//!
//! A mission has 150 motions of up to 2 m with a label at the end of each. It begins where the front has just been found, on a
//! stretch of 30 m about that place. No planner is told how the front bends. After each of the last 120 motions the front that is
//! stated is compared with the true one at seven places of the stretch.

use host_sim::campaign::fronts::flight::{sea, vehicle};
use host_sim::campaign::fronts::following::REACH;
use host_sim::campaign::fronts::true_front::{TrueFront, site};
use nalgebra::{Point2, Vector2};
use planner_core::parts::LOOKED_AT;
use planner_core::{
    Front, FrontStretch, Guard, Label, Noise, Persist as _, Plan, Planner as _, Pose, Unicycle,
};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use tests::ensemble::{self, expect, mean, median};
use tests::{cases, is_long};

const SEED: u64 = 51;
const MOTIONS: u32 = 150;
/// The first motions are not counted.
const SETTLED: u32 = 30;
/// The length of the stretch, metres.
const STRETCH: f64 = 30.0;

type Watcher = Guard<Unicycle>;

#[derive(Clone, Copy, Debug)]
struct World {
    is_circle: bool,
    speed: f64,
    p: f64,
}

impl World {
    fn draw(self, rng: &mut ChaCha8Rng) -> TrueFront {
        // A sine this low is a line.
        let front = if self.is_circle {
            TrueFront::circle(100.0, rng)
        } else {
            TrueFront::sine(1e-6, 100.0, rng)
        };
        front.moving(self.speed, rng)
    }
}

/// The place so far along a stretch and to its left.
fn place(middle: Pose, ahead: f64, left: f64) -> Point2<f64> {
    let (sin, cos) = libm::sincos(middle.heading.radians());
    Point2::<f64>::from(middle.site)
        + Vector2::new(cos * ahead - sin * left, sin * ahead + cos * left)
}

/// How far to the left of a place of the stretch the front really is.
fn truth(front: &TrueFront, middle: Pose, ahead: f64, motion: f64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let [mut low, mut high] = [-30.0, 30.0];
    for _ in 0..30 {
        let left = 0.5 * (low + high);
        let label = front.sensed(place(middle, ahead, left), motion, 1.0, &mut rng);
        if label == Label::Positive { high = left } else { low = left }
    }
    0.5 * (low + high)
}

/// How far what is stated is off at seven places, metres, and whether the stated width covers that.
fn measure(front: &TrueFront, planner: &Watcher, middle: Pose, motion: u32) -> [(f64, bool); 7] {
    [-3, -2, -1, 0, 1, 2, 3].map(|k| {
        let ahead = f64::from(k) * STRETCH / 6.0;
        let stated = planner.beside(site(place(middle, ahead, 0.0)), middle.heading);
        let off = (f64::from(stated.left) - truth(front, middle, ahead, motion.into())).abs();
        (off, off <= 1.645 * f64::from(stated.deviation))
    })
}

/// A planner that watches from when the front has just been found, with its pose and the place that was found.
struct Watching {
    front: TrueFront,
    p: f64,
    planner: Watcher,
    pose: Pose,
    middle: Pose,
    motion: u32,
    rng: ChaCha8Rng,
}

/// Four points are given.
fn guard(front: &TrueFront, world: World, stretch: FrontStretch) -> Watcher {
    let told = Front::STRAIGHT.moving(world.speed).expect("a front");
    let (sea, unicycle) = (sea().expect("an area"), vehicle(REACH).expect("a vehicle"));
    let noise = Noise::new(world.p).expect("p");
    let guard = Guard::watching(sea, unicycle, (told, stretch), noise).expect("room");
    guard.knowing(&front.given())
}

impl Watching {
    fn begin(seed: u64, number: u64, world: World, metres: f64) -> Self {
        let mut rng = ensemble::rng(seed, number);
        let front = world.draw(&mut rng);
        let stretch = FrontStretch::metres(metres).expect("a length");
        let mut planner = guard(&front, world, stretch);
        let mut pose = front.start(&mut rng);
        for motion in 1.. {
            let Plan::Move(next) = planner.plan(pose) else { panic!("a motion") };
            pose = next.target;
            let label = front.sensed(pose.site.into(), motion.into(), world.p, &mut rng);
            planner.observe(pose, next.wants_label.then(|| label.into())).expect("any label");
            if let Some(waist) = planner.found() {
                let middle = Pose { site: waist.site, heading: waist.heading };
                return Self { front, p: world.p, planner, pose, middle, motion, rng };
            }
        }
        unreachable!()
    }

    /// Makes a motion. Whether it asked for a label.
    fn go(&mut self) -> bool {
        let plan = self.planner.plan(self.pose);
        let Plan::Move(next) = plan else { panic!("it stops: {plan:?}") };
        (self.pose, self.motion) = (next.target, self.motion + 1);
        let at = self.pose.site.into();
        let label = self.front.sensed(at, self.motion.into(), self.p, &mut self.rng);
        let reading = next.wants_label.then(|| label.into());
        self.planner.observe(self.pose, reading).expect("any label");
        next.wants_label
    }
}

/// Whether the front is a circle, its speed, how often labels are true; and the most that the median of the mean deviation
/// may be, metres. A grid of curves that was told the circle's radius had 0.102, 0.218, 0.088, 0.192, 0.037, 0.102, 0.030 and
/// 0.084.
const WORLDS: [(bool, f64, f64, f64); 8] = [
    (false, 0.05, 1.0, 0.052),
    (false, 0.05, 0.9, 0.17),
    (true, 0.05, 1.0, 0.067),
    (true, 0.05, 0.9, 0.195),
    (false, 0.0, 1.0, 0.0107),
    (false, 0.0, 0.9, 0.076),
    (true, 0.0, 1.0, 0.0116),
    (true, 0.0, 0.9, 0.084),
];

/// In every world the median of the mean deviation is small, and the stated widths hold. A quick run flies half of the
/// worlds.
#[test]
fn a_watched_stretch_is_known_all_along() {
    let worlds =
        if is_long() { &WORLDS[..] } else { &[WORLDS[1], WORLDS[3], WORLDS[4], WORLDS[6]] };
    let slack = if is_long() { 1.0 } else { 1.1 };
    for &(is_circle, speed, p, most) in worlds {
        let world = World { is_circle, speed, p };
        let of_each = ensemble::fly(cases(50, 200), |number| {
            let mut it = Watching::begin(SEED, number, world, STRETCH);
            let (begun, mut measured) = (it.motion, Vec::new());
            while it.motion < begun + MOTIONS {
                it.go();
                if it.motion > begun + SETTLED {
                    measured.extend(measure(&it.front, &it.planner, it.middle, it.motion));
                }
            }
            let covered = mean(measured.iter().map(|it| f64::from(u8::from(it.1))));
            (mean(measured.iter().map(|it| it.0)), covered)
        });
        expect(format!("{world:?}, off"), median(of_each.iter().map(|it| it.0)), ..=slack * most);
        expect(format!("{world:?}, covered"), mean(of_each.iter().map(|it| it.1)), 0.9..);
    }
}

/// The robot leaves the stretch by no more than a reach, but where it lost the front; a plan is the same after a sleep;
/// and a plan looks at as few places as it says.
#[test]
fn a_robot_that_watches_stays_and_sleeps() {
    ensemble::fly(cases(6, 60), |number| {
        let world = World { is_circle: number % 2 == 0, speed: 0.03, p: 0.9 };
        let mut it = Watching::begin(SEED + 1, number, world, 12.0);
        let (mut woken, mut labels) = (it.planner.clone(), 0);
        for motion in 0..MOTIONS {
            let plan = it.planner.plan(it.pose);
            woken.restore(&it.planner.snapshot()).expect("its own snapshot");
            let kept = (woken.plan(it.pose), woken.stretch());
            assert_eq!((plan, it.planner.stretch()), kept, "{number}");
            let was_found = it.planner.found().is_some();
            labels += u32::from(it.go());
            if let (Some(middle), Plan::Move(next)) = (it.planner.stretch(), plan)
                && was_found
            {
                assert!(next.examined <= LOOKED_AT, "{number}: {}", next.examined);
                let off = Point2::<f64>::from(it.pose.site) - Point2::<f64>::from(middle.site);
                let (sin, cos) = libm::sincos(middle.heading.radians());
                let ahead = (off.x * cos + off.y * sin).abs();
                // An errand may swing out.
                assert!(ahead < 6.0 + 2.0 * REACH, "{number}: {ahead} m at motion {motion}");
            }
        }
        assert!(labels > MOTIONS / 2, "{number}: {labels} labels");
    });
}
