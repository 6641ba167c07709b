//! Dynamics: accepted parameters keep the contract, refused ones are named, and a broken promise is found.

use nalgebra::Point2;
use planner_core::dynamics::{
    Action, ActionGrid, Control, Dynamics, Ray, RayFan, Side, TurningCircle, check,
};
use planner_core::error::{ContractError, GridError, LatticeError};
use planner_core::{
    Angle, Area, Boat, Car, CarShape, Heading, Holonomic, Pose, Site, Unicycle, Vector,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::{cases, vehicles};

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Debug;

/// Grids of bearings, unicycles, cars and boats; the sharpest turn of some lies next to a multiple of the step, or on it
/// but for rounding.
#[test]
fn what_the_constructors_take_keeps_the_contract() {
    fn keeps<D: Dynamics + Debug>(it: &D) -> u32 {
        assert_eq!(check(it), Ok(()), "{it:?}");
        1
    }
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(1));
    let mut taken = [0; 4];
    for _ in 0..cases(45, 20_000) {
        let speeds = [1, 2, 3, 21, 200][rng.random_range(0..5)];
        let step_mm = [1, 100, 99_999, rng.random_range(1..4_000)][rng.random_range(0..4)];
        let bearings = Holonomic::new(rng.random_range(1..400), speeds, step_mm);
        let step = [1, 10, 70, 785, 3_141, rng.random_range(1..3_141)][rng.random_range(0..6)];
        let multiple = f64::from(1_000 * step * [1, 2, 9, 40][rng.random_range(0..4)]) * 1e-6;
        let off = [-2e-9, -1e-9, -1e-12, 0.0, 1e-12, 7e-10, 1e-9, 2e-9][rng.random_range(0..8)];
        let sharpest = [1e-3, 0.3, FRAC_PI_2, 1.1, 3.0, PI, multiple + off, multiple + off]
            [rng.random_range(0..8)];
        let unicycle = Unicycle::new(1_000 * step, sharpest, speeds, step_mm);
        let boat = unicycle.and_then(Boat::new);
        taken[0] += bearings.map_or(0, |it| keeps(&it));
        taken[1] += unicycle.map_or(0, |it| keeps(&it));
        taken[2] += boat.map_or(0, |it| keeps(&it));
        taken[3] += any_car(&mut rng).map_or(0, |it| keeps(&it));
    }
    assert!(taken.iter().all(|count| *count > 4), "{taken:?}");
    assert_eq!(Unicycle::new(10_000, FRAC_PI_2, 21, 100), Ok(Unicycle::paper()));
    keeps(&Unicycle::paper());
    keeps(&Holonomic::new(65_535, 1, 1).expect("a grid"));
}

#[test]
fn what_is_no_grid_is_refused_by_what_is_wrong_with_it() {
    // A turn of nothing, a step of more than a half turn, and steps of none.
    for (step, sharpest) in
        [(10, 1e-10), (7_000_000, 3.0), (3_141_593, PI), (0, 1.0), (10, 0.0), (10, -1.0), (10, 3.2)]
    {
        assert_eq!(
            Unicycle::new(step, sharpest, 21, 100),
            Err(GridError::Turn),
            "{step} {sharpest}"
        );
    }
    for sharpest in [f64::NAN, f64::INFINITY] {
        assert_eq!(Unicycle::new(10, sharpest, 21, 100), Err(GridError::Turn), "{sharpest}");
    }
    // 6,283,187 rays.
    assert_eq!(Unicycle::new(1, PI, 684, 100), Err(GridError::Actions));
    assert!(Unicycle::new(1, PI, 683, 100).is_ok());
    assert_eq!(Unicycle::new(u32::MAX, 1.0, u16::MAX, u32::MAX), Err(GridError::Turn));
    for (rays, speeds) in [(0, 21), (5, 0), (u32::MAX, 2), (65_538, u16::MAX)] {
        assert_eq!(ActionGrid::new(rays, speeds, 100), Err(GridError::Actions), "{rays} {speeds}");
    }
    for (speeds, step_mm) in [(21, 0), (61, 50_000), (1, 100_000), (2, u32::MAX), (1, u32::MAX)] {
        assert_eq!(
            ActionGrid::new(5, speeds, step_mm),
            Err(GridError::Reach),
            "{speeds} {step_mm}"
        );
    }
    let longest = ActionGrid::new(1, 2, 99_999).expect("a grid");
    assert_eq!(longest.reach_mm(1), 99_999);
    let _ = longest.reach_mm(u16::MAX); // it does not overflow
    let most = ActionGrid::new(1 << 31, 2, 1).expect("a grid");
    assert_eq!((most.actions(), most.split(Action(u32::MAX))), (1 << 32, (u32::MAX >> 1, 1)));
    assert!(Holonomic::new(0, 21, 100).is_err());
}

fn pose(heading: u32) -> Pose {
    Pose { site: Site::new(1_000, -2_000).expect("on the lattice"), heading: Heading(heading) }
}

/// How far a heading lies from another, either way.
fn apart(a: Heading, b: Heading) -> u32 {
    (a.0.wrapping_sub(b.0) as i32).unsigned_abs()
}

#[test]
fn the_rays_around_a_heading_are_the_nearest_to_either_side() {
    fn compare<D: Dynamics>(dynamics: &D, rng: &mut ChaCha8Rng) {
        for _ in 0..200 {
            let (pose, heading) = (pose(rng.random()), Heading(rng.random()));
            let [nearest, other] = dynamics.around(pose, heading);
            let off = |ray: Ray| heading.0.wrapping_sub(ray.heading.0) as i32;
            let least = dynamics.rays(pose).map(|ray| apart(ray.heading, heading)).min();
            assert_eq!(Some(apart(nearest.heading, heading)), least);
            let across = |it: &i32| (*it >= 0) != (off(nearest) >= 0);
            let beyond = dynamics.rays(pose).map(off).filter(across);
            let least = beyond.map(i32::unsigned_abs).min();
            assert_eq!(
                apart(other.heading, heading),
                least.unwrap_or(apart(nearest.heading, heading))
            );
        }
    }
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(2));
    // 350 degrees: the nearest of four bearings is the first.
    let four = Holonomic::new(4, 21, 100).expect("a grid");
    let steep = Heading::from_radians(350f64.to_radians()).expect("an angle");
    assert_eq!(four.around(pose(0), steep)[0].index, 0);
    for bearings in [1, 2, 3, 4, 7, 72, 1_000] {
        compare(&Holonomic::new(bearings, 21, 100).expect("a grid"), &mut rng);
    }
    for (step, sharpest) in [
        (10_000, FRAC_PI_2),
        (785_000, 1.6),
        (100_000, 0.35),
        (3_000_000, 3.0),
        (500_000, PI),
        (70, 0.002),
    ] {
        compare(&Unicycle::new(step, sharpest, 21, 100).expect("a grid"), &mut rng);
    }
}

/// What a vehicle does otherwise than it promised.
#[derive(Clone, Copy, Debug)]
enum Breaks {
    Nothing,
    // The fan and its rays.
    Count,
    NoLeft,
    Spacing,
    TurnsBack,
    Overlap,
    Effort,
    StepLength,
    StepHeading,
    Index,
    Twice,
    // Turns on the spot.
    MovesInPlace,
    TurnsTheOtherWay,
    TurnsBeyond,
    // Speeds and ends of arcs.
    MoreWhenSlower,
    MoreToOneSide,
    NotAllWhenFastest,
    KnowsTooMany,
    KnowsTooFew,
    EndsElsewhere,
    EndsStraight,
    CornerTooFar,
    // Turning circles.
    OrbitsTheOtherWay,
    DoesNotTurn,
    LeavesItsRadius,
    LeavesItsCentre,
}

struct Faulty<D>(D, Breaks);

impl<D: Dynamics> Dynamics for Faulty<D> {
    fn grid(&self) -> ActionGrid {
        self.0.grid()
    }

    fn fan(&self) -> RayFan {
        let fan = self.0.fan();
        match self.1 {
            Breaks::Count => RayFan { left: fan.left + 1, ..fan },
            Breaks::NoLeft => RayFan { left: 0, right: fan.left + fan.right, ..fan },
            Breaks::Spacing => RayFan { spacing: Angle(fan.spacing.0 - 4), ..fan },
            _ => fan,
        }
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        let heading = self.0.heading(pose, side, n);
        match self.1 {
            Breaks::TurnsBack if n == 3 => self.0.heading(pose, side, 1),
            Breaks::Overlap if n == 5 && side == Side::Right => {
                self.0.heading(pose, Side::Left, 5).turned(Angle(77).mirrored())
            }
            _ => heading,
        }
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        let ray = self.0.ray(pose, side, n);
        let heading = self.heading(pose, side, n);
        match self.1 {
            Breaks::Effort if n == 4 => Ray { turn_cost: 1, ..ray },
            Breaks::StepLength if n == 2 => {
                let step = Vector::new(ray.step.x() / 2, ray.step.z() / 2).expect("small");
                Ray { step, ..ray }
            }
            Breaks::StepHeading if n == 2 => Ray { step: ray.step.left(), ..ray },
            Breaks::Index if n == 1 => Ray { index: 11, ..ray },
            Breaks::Twice if n == 1 => Ray { index: 5, ..ray },
            Breaks::TurnsBack | Breaks::Overlap => {
                let step = heading.unit().scaled(ray.step.dot(ray.step).isqrt() as i32);
                Ray { heading, step, ..ray }
            }
            _ => ray,
        }
    }

    fn rays_at(&self, speed: u16) -> Option<[u32; 2]> {
        let fastest = self.0.grid().speeds() - 1;
        match self.1 {
            Breaks::MoreWhenSlower if speed == 9 => self.0.rays_at(fastest),
            Breaks::MoreToOneSide if speed == 9 => {
                let [left, _] = self.0.rays_at(fastest)?;
                self.0.rays_at(speed).map(|[_, right]| [left, right])
            }
            Breaks::NotAllWhenFastest if speed == fastest => self.0.rays_at(fastest / 2),
            _ => self.0.rays_at(speed),
        }
    }

    fn arrive(&self, pose: Pose, ray: &Ray, speed: u16) -> Result<Pose, LatticeError> {
        let end = self.0.arrive(pose, ray, speed)?;
        Ok(match self.1 {
            Breaks::EndsElsewhere => self.0.arrive(pose, ray, speed - 1)?,
            Breaks::EndsStraight => Pose { heading: ray.heading, ..end },
            _ => end,
        })
    }

    fn tangent_intersection(&self, from: Pose, to: Pose) -> Option<Vector> {
        let corner = self.0.tangent_intersection(from, to)?;
        let twice = || Vector::new(2 * corner.x(), 2 * corner.z()).expect("near");
        Some(if matches!(self.1, Breaks::CornerTooFar) { twice() } else { corner })
    }

    fn turning_circles(&self, pose: Pose) -> Option<[TurningCircle; 2]> {
        let [left, right] = self.0.turning_circles(pose)?;
        let breaks = |orbit: TurningCircle, other: TurningCircle| match self.1 {
            Breaks::OrbitsTheOtherWay => TurningCircle { action: other.action, ..orbit },
            Breaks::DoesNotTurn => {
                let action = self.0.grid().action(self.0.fan().right, 10);
                TurningCircle { action, ..orbit }
            }
            Breaks::LeavesItsRadius => TurningCircle { radius: orbit.radius / 2, ..orbit },
            Breaks::LeavesItsCentre => TurningCircle { centre: other.centre, ..orbit },
            _ => orbit,
        };
        Some([breaks(left, right), breaks(right, left)])
    }

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        let (action, after) = self.0.turn_in_place(pose, side)?;
        match self.1 {
            Breaks::MovesInPlace => self.target(pose, Action(action.0 + 1)).map(|it| (action, it)),
            Breaks::TurnsTheOtherWay => self.0.turn_in_place(pose, opposite(side)),
            Breaks::TurnsBeyond => {
                let heading = after.heading.turned(Angle(after.heading.0));
                Some((action, Pose { heading, ..after }))
            }
            _ => Some((action, after)),
        }
    }

    fn control(&self, pose: Pose, action: Action) -> Control {
        self.0.control(pose, action)
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (index, speed) = self.0.grid().split(action);
        let ahead = self.0.fan().right;
        let action = match self.1 {
            // What it says of its rays is true of its actions.
            Breaks::MoreToOneSide if speed == 9 && index >= ahead => {
                self.0.grid().action(index, self.0.grid().speeds() - 1)
            }
            Breaks::KnowsTooMany if speed == 9 => {
                self.0.grid().action(index, self.0.grid().speeds() - 1)
            }
            Breaks::KnowsTooFew if speed == 9 => return None,
            _ => action,
        };
        self.0.ray_of(pose, action).map(|ray| {
            let side = if ray.index < ahead { Side::Right } else { Side::Left };
            self.ray(pose, side, ray.index.abs_diff(ahead))
        })
    }
}

fn opposite(side: Side) -> Side {
    if side == Side::Left { Side::Right } else { Side::Left }
}

#[test]
fn each_broken_promise_is_named() {
    use ContractError as Error;
    let left = Side::Left;
    // Eleven rays, 700 mrad apart and at last 200: right 5 to 1, ahead, left 1 to 5.
    let unicycle = Unicycle::new(700_000, 3.0, 5, 1_000).expect("a grid");
    assert_eq!(unicycle.fan(), RayFan { left: 6, right: 5, ..unicycle.fan() });
    for (breaks, broken) in [
        (Breaks::Nothing, Ok(())),
        (Breaks::Count, Err(Error::Count)),
        (Breaks::NoLeft, Err(Error::Count)),
        (Breaks::Spacing, Err(Error::Spacing(left, 1))),
        (Breaks::TurnsBack, Err(Error::Spacing(left, 3))),
        (Breaks::Overlap, Err(Error::Spacing(Side::Right, 5))),
        (Breaks::Effort, Err(Error::Effort(left, 4))),
        (Breaks::StepLength, Err(Error::Step(left, 2))),
        (Breaks::StepHeading, Err(Error::Step(left, 2))),
        (Breaks::Index, Err(Error::Index(left, 1))),
        (Breaks::Twice, Err(Error::Index(left, 1))),
        (Breaks::MovesInPlace, Err(Error::TurnInPlace(left))),
        (Breaks::TurnsTheOtherWay, Err(Error::TurnInPlace(left))),
        (Breaks::TurnsBeyond, Err(Error::TurnInPlace(left))),
    ] {
        assert_eq!(check(&Faulty(unicycle, breaks)), broken, "{breaks:?}");
    }
    // Also of rays that are too many to look at them all.
    for (breaks, broken) in [
        (Breaks::Nothing, Ok(())),
        (Breaks::Spacing, Err(Error::Spacing(left, 1))),
        (Breaks::Twice, Err(Error::Index(left, 1))),
    ] {
        assert_eq!(check(&Faulty(Unicycle::fine(), breaks)), broken, "{breaks:?}");
    }
    let car = vehicles::car(50_000, 3_000, 2_000);
    for (breaks, broken) in [
        (Breaks::Nothing, Ok(())),
        (Breaks::MoreWhenSlower, Err(Error::Speeds(9))),
        (Breaks::MoreToOneSide, Err(Error::Speeds(9))),
        (Breaks::NotAllWhenFastest, Err(Error::Speeds(20))),
        (Breaks::KnowsTooMany, Err(Error::Speeds(9))),
        (Breaks::KnowsTooFew, Err(Error::Speeds(9))),
        (Breaks::EndsElsewhere, Err(Error::Arrival(left, 0))),
        (Breaks::EndsStraight, Err(Error::Arrival(left, 1))),
        (Breaks::CornerTooFar, Err(Error::Arrival(left, 1))),
        (Breaks::OrbitsTheOtherWay, Err(Error::TurningCircle(left))),
        (Breaks::DoesNotTurn, Err(Error::TurningCircle(left))),
        (Breaks::LeavesItsRadius, Err(Error::TurningCircle(left))),
        (Breaks::LeavesItsCentre, Err(Error::TurningCircle(left))),
    ] {
        assert_eq!(check(&Faulty(car, breaks)), broken, "{breaks:?}");
    }
}

/// As many rays as a grid can have. Beyond 65,536 the contract looks at some of them; of the fine fan here are all that lie
/// side by side in places. The index of an action leads back to its ray and speed.
#[test]
fn numbers_of_rays_and_actions_do_not_overflow() {
    for (bearings, speeds) in [(65_537, 1), (u32::MAX, 1), (1 << 31, 2), (3 << 29, 2)] {
        let most = Holonomic::new(bearings, speeds, 1).expect("a grid");
        assert_eq!(check(&most), Ok(()), "{bearings}");
        let [nearest, _] = most.around(pose(0), Heading(123_456_789));
        let spacing = u32::MAX / bearings + 1;
        assert!(apart(nearest.heading, Heading(123_456_789)) <= spacing, "{bearings}: {nearest:?}");
    }
    let (fine, facing) = (Unicycle::fine(), pose(7));
    let grid = fine.grid();
    assert_eq!((grid.rays(), grid.actions()), (3_141_595, 65_973_495));
    assert_eq!(check(&fine), Ok(()));
    let turns = fine.fan().right;
    for (start, side) in [(0, Side::Left), (1, Side::Right), (turns - 2_000, Side::Left)] {
        for n in start..start + 2_000 {
            let (ray, next) = (fine.ray(facing, side, n), fine.ray(facing, side, n + 1));
            assert!(ray.heading != next.heading && ray.step != next.step, "{ray:?} {next:?}");
            // 1 urad, or what is left of it before the last, is 683 units of a heading.
            let apart = apart(ray.heading, next.heading);
            assert!(apart.abs_diff(684) <= 1 || n + 1 == turns && apart > 0, "{n}: {apart}");
            let mrad = f64::from(n) / 1_000.0;
            assert!((f64::from(ray.turn_cost) - mrad * mrad).abs() < 0.61, "{n}: {ray:?}");
        }
    }
    let last = (grid.actions() - 1) as u32;
    for index in (0..=last).step_by(9_999).chain(last - 50..=last) {
        let (ray, speed) = grid.split(Action(index));
        assert_eq!(grid.action(ray, speed), Action(index));
        assert_eq!(fine.ray_of(facing, Action(index)).map(|it| it.index), Some(ray));
    }
    let Control { distance_m: v, turn_rad: w } = fine.control(facing, Action(last));
    assert_eq!((v.to_bits(), w.to_bits()), (2.0_f32.to_bits(), (FRAC_PI_2 as f32).to_bits()));
    for beyond in [last + 1, u32::MAX] {
        assert_eq!(fine.ray_of(facing, Action(beyond)), None);
        assert_eq!(fine.target(facing, Action(beyond)), None);
    }
    let _ = Unicycle::paper().control(facing, Action(u32::MAX)); // it does not overflow
}

/// The paper's turns are multiples of 10 mrad, and their squares what they always were. They come cheapest first, and
/// motions end where a unicycle's do.
#[test]
fn the_papers_motions_are_those_of_a_unicycle() {
    let paper = Unicycle::paper();
    let grid = paper.grid();
    assert_eq!((grid.actions(), grid.rays(), grid.speeds()), (6657, 317, 21));
    let turn = |index| paper.control(pose(0), grid.action(index, 3)).turn_rad.to_bits();
    for n in 0..158 {
        let exact = f64::from(n) / 100.0;
        let ray = paper.ray(pose(0), Side::Left, n);
        assert_eq!(Ok(ray.heading), Heading::from_radians(exact), "{n}");
        assert_eq!((ray.index, ray.turn_cost), (158 + n, 100 * n * n));
        assert_eq!(turn(ray.index), (exact as f32).to_bits());
    }
    let quarter = std::f32::consts::FRAC_PI_2;
    assert_eq!([316, 1, 0].map(turn), [quarter, -1.57, -quarter].map(f32::to_bits));
    assert_eq!(paper.ray(pose(0), Side::Right, 158).heading, Heading(3 << 30));
    assert_eq!(paper.ray(pose(0), Side::Right, 158).turn_cost, 2_467_401);
    assert_eq!(paper.fan().spacing, Angle(6_835_653));
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(5));
    for _ in 0..30 {
        let from = Site::new(rng.random_range(-1_000_000..1_000_000), 77).expect("near");
        let pose = Pose { site: from, heading: Heading(rng.random()) };
        let costs: Vec<_> = paper.rays(pose).map(|ray| ray.turn_cost).collect();
        assert!(costs.len() == 317 && costs.is_sorted(), "{costs:?}");
        for (ray, speed) in paper.rays(pose).flat_map(|ray| [0, 1, 7, 20].map(|it| (ray, it))) {
            let control = paper.control(pose, grid.action(ray.index, speed));
            let angle = pose.heading.radians() + f64::from(control.turn_rad);
            let (sin, cos) = angle.sin_cos();
            let reach = f64::from(control.distance_m) * 65_536.0;
            let end = paper.arrive(pose, &ray, speed).expect("near");
            let off = |got: i32, start: i32, exact: f64| (f64::from(got - start) - exact).abs();
            let off =
                [off(end.site.x(), from.x(), reach * cos), off(end.site.z(), 77, reach * sin)];
            assert!(off.iter().all(|it| *it < 0.6), "{control:?}: {off:?}");
            assert!((end.heading.radians() - angle).sin().abs() < 1e-6, "{control:?}");
            let mrad = f64::from(control.turn_rad) * 1000.0;
            assert!((f64::from(ray.turn_cost) - mrad * mrad).abs() < 2.0);
        }
    }
}

/// Any car that the constructor takes, from a model's to a ship's.
fn any_car(rng: &mut ChaCha8Rng) -> Result<Car, GridError> {
    Car::new(CarShape {
        radius_mm: [50, 1_000, 3_000, 5_000, 40_000, 2_000_000, rng.random_range(1..20_000)]
            [rng.random_range(0..7)],
        shortest_mm: [0, 1, 500, rng.random_range(0..3_000)][rng.random_range(0..4)],
        turn_step_urad: [1, 1_000, 10_000, 20_000, rng.random_range(1..90_000)]
            [rng.random_range(0..5)],
        speeds: [2, 5, 21, 200][rng.random_range(0..4)],
        speed_step_mm: [1, 100, 1_000, rng.random_range(1..5_000)][rng.random_range(0..4)],
    })
}

#[test]
fn what_cannot_go_round_is_no_car() {
    let good = CarShape {
        radius_mm: 3_000,
        shortest_mm: 500,
        turn_step_urad: 10_000,
        speeds: 21,
        speed_step_mm: 100,
    };
    assert!(Car::new(good).is_ok());
    for (bad, why) in [
        (CarShape { radius_mm: 0, ..good }, GridError::Circle),
        (CarShape { radius_mm: Car::WIDEST_MM, ..good }, GridError::Circle),
        (CarShape { shortest_mm: 2_001, ..good }, GridError::Circle),
        (CarShape { speeds: 1, ..good }, GridError::Circle),
        // 0.34 rad is the sharpest chord of 2 m.
        (CarShape { turn_step_urad: 350_000, ..good }, GridError::Circle),
        (CarShape { turn_step_urad: 0, ..good }, GridError::Turn),
        (CarShape { turn_step_urad: 785_399, ..good }, GridError::Turn),
        (CarShape { speed_step_mm: 0, ..good }, GridError::Reach),
        (CarShape { speeds: 601, speed_step_mm: 5_000, ..good }, GridError::Reach),
        (CarShape { speeds: 0, ..good }, GridError::Actions),
    ] {
        assert_eq!(Car::new(bad).map(|_| ()), Err(why), "{bad:?}");
    }
    let still = Unicycle::new(10_000, 0.35, 1, 100).expect("a grid");
    assert_eq!(Boat::new(still), Err(GridError::Circle));
    let ship = Unicycle::new(1_000, 0.001, 2, 90_000).expect("a grid");
    assert_eq!(Boat::new(ship), Err(GridError::Circle));
}

/// Points of an arc in metres: integrated by the midpoint rule from the control that is asked of the vehicle.
fn drive(from: Pose, control: Control) -> (Vec<Point2<f64>>, f64) {
    const PARTS: u32 = 400;
    let (mut at, mut heading) = (Point2::<f64>::from(from.site), from.heading.radians());
    let part = f64::from(PARTS);
    let (v, w) = (f64::from(control.distance_m) / part, f64::from(control.turn_rad) / part);
    let mut points = vec![at];
    for _ in 0..PARTS {
        let (sin, cos) = (heading + w / 2.0).sin_cos();
        at += nalgebra::Vector2::new(v * cos, v * sin);
        heading += w;
        points.push(at);
    }
    (points, heading)
}

/// Every motion of a car is the arc that its control makes; of a curvature that it can drive; it is inside an area
/// that has its corner; and no ray beyond the last of a speed would be.
#[test]
fn a_cars_motions_are_arcs_that_it_can_drive() {
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(5));
    let (mut arcs, mut tight, mut bulges) = (0, 0, 0);
    while arcs < cases(400, 200_000) {
        let Ok(car) = any_car(&mut rng) else { continue };
        let (grid, shape) = (car.grid(), car.shape());
        let pose = pose(rng.random());
        let ray = rng.random_range(0..grid.rays());
        let speed = rng.random_range(0..grid.speeds());
        let side = if ray < car.fan().right { Side::Right } else { Side::Left };
        let n = ray.abs_diff(car.fan().right);
        let action = grid.action(ray, speed);
        let chord = f64::from(grid.reach_mm(speed)) / 1000.0;
        let radius = f64::from(shape.radius_mm) / 1000.0;
        let phi = f64::from(n) * f64::from(shape.turn_step_urad) * 1e-6;
        // By the curvature alone, but for an angle within 30 nrad of the limit.
        let curvature = 2.0 * phi.sin() / chord;
        let can = chord * 1000.0 > f64::from(shape.shortest_mm) - 0.5
            && speed > 0
            && curvature * radius <= 1.0
            && phi <= PI / 4.0;
        let is_on_the_limit = (phi.sin() - chord / 2.0 / radius).abs() < 3e-8;
        let Some(target) = car.target(pose, action) else {
            assert!(!can || is_on_the_limit, "{car:?} {n} {speed}: {curvature}");
            continue;
        };
        assert!(can, "{car:?} {n} {speed}: {curvature}");
        tight += u32::from(curvature * radius > 0.9);
        let control = car.control(pose, action);
        let (points, heading) = drive(pose, control);
        let end = Point2::<f64>::from(target.site);
        let off = (points[points.len() - 1] - end).norm();
        let rounding = 3e-5 * (1.0 + f64::from(speed) / 256.0) + 1e-6 * chord;
        assert!(off < rounding + 2e-6 * chord, "{car:?}, {control:?}: off by {off} m");
        assert!((heading - target.heading.radians()).sin().abs() < 1e-6);
        assert_eq!(control.turn_rad < 0.0, side == Side::Right);
        let length: f64 = points.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
        if control.turn_rad != 0.0 {
            assert!(f64::from(control.turn_rad).abs() / length * radius <= 1.0 + 1e-6);
        }
        // Of a triangle with both ends and the corner each point lies on the inner side of each edge.
        let corner = car.tangent_intersection(pose, target);
        assert_eq!(corner.is_some(), n > 0);
        let corner = corner.unwrap_or(Vector::new(0, 0).expect("small"));
        let metres =
            |v: Vector| nalgebra::Vector2::new(f64::from(v.x()), f64::from(v.z())) / 65_536.0;
        let corner = Point2::from(pose.site) + metres(corner);
        if n > 0 {
            let start = Point2::<f64>::from(pose.site);
            let sign = if side == Side::Left { 1.0 } else { -1.0 };
            for [a, b] in [[start, corner], [corner, end], [end, start]] {
                for p in &points {
                    let (along, to) = (b - a, p - a);
                    let inner = sign * (along.x * to.y - along.y * to.x) / along.norm().max(1e-9);
                    assert!(inner > -2.0 * rounding - 4e-6 * chord, "{car:?} {n} {speed}: {inner}");
                    bulges += 1;
                }
            }
        }
        arcs += 1;
    }
    assert!(tight > 8 && bulges > 20_000, "{tight} {bulges}");
}

/// How many poses are not safe, and how many are; a circle from each of these lies inside.
fn compare<D: Dynamics>(it: &D, area: Area, rng: &mut ChaCha8Rng) -> [u32; 2] {
    let mut count = [0; 2];
    for _ in 0..cases(25, 20_000) {
        let mut any = || rng.random_range(0..=20 << 16);
        let site = Site::new(any(), any()).expect("near");
        let from = Pose { site, heading: Heading(rng.random()) };
        let goes_round = |side| {
            let (mut pose, mut turned, mut inside) = (from, 0.0, true);
            while turned < 2.0 * std::f64::consts::TAU {
                let [left, right] = it.turning_circles(pose).expect("it has two");
                let action = if side == Side::Left { left.action } else { right.action };
                let after = it.target(pose, action).expect("an action");
                let (points, _) = drive(pose, it.control(pose, action));
                // A boat turns before it drives.
                let points =
                    if it.tangent_intersection(pose, after).is_some() { points } else { vec![] };
                let mut within = |p: Point2<f64>| {
                    inside &= (0.0..=20.0).contains(&p.x) && (0.0..=20.0).contains(&p.y);
                };
                points.into_iter().for_each(&mut within);
                within(after.site.into());
                turned += (after.heading.radians() - pose.heading.radians()).sin().abs();
                pose = after;
            }
            inside
        };
        let stays = [Side::Left, Side::Right].map(goes_round);
        let is_safe = it.keeps_inside(from, from, &area, 0);
        assert!(!is_safe || stays.contains(&true), "{from:?}");
        assert!(!is_safe || it.is_safe(from, &area));
        count[usize::from(is_safe)] += 1;
    }
    count
}

/// Whoever is safe stays inside for ever, round and round, and whoever is not leaves the area on both circles.
#[test]
fn who_is_safe_can_go_round() {
    let corner = |x, z| Site::new(x << 16, z << 16).expect("near");
    let area = Area::new(corner(0, 0), corner(20, 20)).expect("an area");
    let mut counts = Vec::new();
    let mut rng = ChaCha8Rng::seed_from_u64(tests::seed(6));
    for radius_mm in [300, 1_000, 3_000, 5_000] {
        counts.push(compare(&vehicles::car(10_000, radius_mm, 2_000), area, &mut rng));
    }
    for step_mm in [100, 800] {
        let steps = Unicycle::new(10_000, 20f64.to_radians(), 3, step_mm).expect("a grid");
        let boat = Boat::new(steps).expect("a boat");
        counts.push(compare(&boat, area, &mut rng));
    }
    let not_safe: u32 = counts.iter().map(|it| it[0]).sum();
    assert!(not_safe > 8 && counts.iter().all(|it| it[1] > 0), "{counts:?}");
}
