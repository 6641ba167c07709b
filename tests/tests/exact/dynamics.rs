//! Dynamics: accepted parameters keep the contract, refused ones are named, and a broken promise is found.

use nalgebra::Point2;
use planner_core::dynamics::{
    Action, ActionGrid, Control, Dynamics, Ray, RayFan, Side, TurningCircle,
};
use planner_core::error::{ContractError, GridError, LatticeError};
use planner_core::geometry::lattice::Vector;
use planner_core::motion::car::Shape;
use planner_core::motion::contract::{self};
use planner_core::{Angle, Area, Boat, Car, Heading, Holonomic, Pose, Site, Unicycle};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;

use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn what_the_constructors_take_keeps_the_contract() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut taken = 0;
    for _ in 0..400 {
        let speeds = [1, 2, 21, 200][rng.random_range(0..4)];
        let step_mm = [1, 100, 99_999][rng.random_range(0..3)];
        if let Ok(it) = Holonomic::new(rng.random_range(1..400), speeds, step_mm) {
            assert_eq!(contract::check(&it), Ok(()), "{it:?}");
            taken += 1;
        }
        let sharpest = [1e-3, 0.3, FRAC_PI_2, 1.1, 3.0, PI][rng.random_range(0..6)];
        let step = [1, 10, 100, 785, 3_141, rng.random_range(1..3_141)][rng.random_range(0..6)];
        if let Ok(it) = Unicycle::new(1_000 * step, sharpest, speeds, step_mm) {
            assert_eq!(contract::check(&it), Ok(()), "{it:?}");
            taken += 1;
        }
    }
    assert!(taken > 200, "{taken}");
    assert_eq!(contract::check(&Unicycle::paper()), Ok(()));
    assert_eq!(Unicycle::new(10_000, FRAC_PI_2, 21, 100), Ok(Unicycle::paper()));
    assert_eq!(contract::check(&Holonomic::new(65_535, 1, 1).expect("a grid")), Ok(()));
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
    let mut rng = ChaCha8Rng::seed_from_u64(2);
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

/// A unicycle that breaks one promise.
#[derive(Clone, Copy)]
enum Breaks {
    Nothing,
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
    MovesInPlace,
    TurnsTheOtherWay,
    TurnsBeyond,
}

struct Faulty(Unicycle, Breaks);

impl Dynamics for Faulty {
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

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        let (action, after) = self.0.turn_in_place(pose, side)?;
        let opposite = if side == Side::Left { Side::Right } else { Side::Left };
        match self.1 {
            Breaks::MovesInPlace => self.target(pose, Action(action.0 + 1)).map(|it| (action, it)),
            Breaks::TurnsTheOtherWay => self.0.turn_in_place(pose, opposite),
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
        let ahead = self.0.fan().right;
        self.0.ray_of(pose, action).map(|ray| {
            let side = if ray.index < ahead { Side::Right } else { Side::Left };
            self.ray(pose, side, ray.index.abs_diff(ahead))
        })
    }
}

#[test]
fn each_broken_promise_is_named() {
    // Eleven rays, 700 mrad apart and at last 200: right 5 to 1, ahead, left 1 to 5.
    let unicycle = Unicycle::new(700_000, 3.0, 5, 1_000).expect("a grid");
    assert_eq!(unicycle.fan(), RayFan { left: 6, right: 5, ..unicycle.fan() });
    let check = |breaks| contract::check(&Faulty(unicycle, breaks));
    assert_eq!(check(Breaks::Nothing), Ok(()));
    for (breaks, broken) in [
        (Breaks::Count, ContractError::Count),
        (Breaks::NoLeft, ContractError::Count),
        (Breaks::Spacing, ContractError::Spacing(Side::Left, 1)),
        (Breaks::TurnsBack, ContractError::Spacing(Side::Left, 3)),
        (Breaks::Effort, ContractError::Effort(Side::Left, 4)),
        (Breaks::StepLength, ContractError::Step(Side::Left, 2)),
        (Breaks::StepHeading, ContractError::Step(Side::Left, 2)),
        (Breaks::Index, ContractError::Index(Side::Left, 1)),
        (Breaks::Twice, ContractError::Index(Side::Left, 1)),
        (Breaks::MovesInPlace, ContractError::TurnInPlace(Side::Left)),
        (Breaks::TurnsTheOtherWay, ContractError::TurnInPlace(Side::Left)),
        (Breaks::TurnsBeyond, ContractError::TurnInPlace(Side::Left)),
    ] {
        assert_eq!(check(breaks), Err(broken));
    }
    assert!(matches!(check(Breaks::Overlap), Err(ContractError::Spacing(Side::Right, 5))));
    // Also of rays that are too many to look at them all.
    let check = |breaks| contract::check(&Faulty(Unicycle::fine(), breaks));
    assert_eq!(check(Breaks::Nothing), Ok(()));
    assert_eq!(check(Breaks::Spacing), Err(ContractError::Spacing(Side::Left, 1)));
    assert_eq!(check(Breaks::Twice), Err(ContractError::Index(Side::Left, 1)));
}

/// A car that breaks one promise of those that the unicycle does not make.
#[derive(Clone, Copy, Debug)]
enum CarBreaks {
    Nothing,
    MoreWhenSlower,
    NotAllWhenFastest,
    KnowsTooMany,
    KnowsTooFew,
    EndsElsewhere,
    EndsStraight,
    CornerTooFar,
    OneOrbit,
    TurnsTheOtherWay,
    DoesNotTurn,
    LeavesItsRadius,
    LeavesItsCentre,
}

struct FaultyCar(Car, CarBreaks);

impl Dynamics for FaultyCar {
    fn grid(&self) -> ActionGrid {
        self.0.grid()
    }

    fn fan(&self) -> RayFan {
        self.0.fan()
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        self.0.heading(pose, side, n)
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        self.0.ray(pose, side, n)
    }

    fn rays_at(&self, speed: u16) -> Option<[u32; 2]> {
        let fastest = self.0.grid().speeds() - 1;
        let at = |speed| self.0.rays_at(speed);
        match self.1 {
            CarBreaks::MoreWhenSlower if speed == 9 => at(fastest),
            CarBreaks::NotAllWhenFastest if speed == fastest => at(fastest / 2),
            _ => at(speed),
        }
    }

    fn arrive(&self, pose: Pose, ray: &Ray, speed: u16) -> Result<Pose, LatticeError> {
        let end = self.0.arrive(pose, ray, speed)?;
        Ok(match self.1 {
            CarBreaks::EndsElsewhere => self.0.arrive(pose, ray, speed - 1)?,
            CarBreaks::EndsStraight => Pose { heading: ray.heading, ..end },
            _ => end,
        })
    }

    fn tangent_intersection(&self, from: Pose, to: Pose) -> Option<Vector> {
        let corner = self.0.tangent_intersection(from, to)?;
        let twice = || Vector::new(2 * corner.x(), 2 * corner.z()).expect("near");
        Some(if matches!(self.1, CarBreaks::CornerTooFar) { twice() } else { corner })
    }

    fn turning_circle(&self, pose: Pose, side: Side) -> Option<TurningCircle> {
        let orbit = self.0.turning_circle(pose, side)?;
        let other = if side == Side::Left { Side::Right } else { Side::Left };
        match self.1 {
            CarBreaks::OneOrbit if side == Side::Right => None,
            CarBreaks::TurnsTheOtherWay => {
                let TurningCircle { action, .. } = self.0.turning_circle(pose, other)?;
                Some(TurningCircle { action, ..orbit })
            }
            CarBreaks::DoesNotTurn => {
                let action = self.0.grid().action(self.0.fan().right, 10);
                Some(TurningCircle { action, ..orbit })
            }
            CarBreaks::LeavesItsRadius => Some(TurningCircle { radius: orbit.radius / 2, ..orbit }),
            CarBreaks::LeavesItsCentre => {
                Some(TurningCircle { centre: self.0.turning_circle(pose, other)?.centre, ..orbit })
            }
            _ => Some(orbit),
        }
    }

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        self.0.turn_in_place(pose, side)
    }

    fn control(&self, pose: Pose, action: Action) -> Control {
        self.0.control(pose, action)
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        let (index, speed) = self.0.grid().split(action);
        match self.1 {
            CarBreaks::KnowsTooMany if speed == 9 => {
                self.0.ray_of(pose, self.0.grid().action(index, self.0.grid().speeds() - 1))
            }
            CarBreaks::KnowsTooFew if speed == 9 => None,
            _ => self.0.ray_of(pose, action),
        }
    }
}

#[test]
fn each_broken_promise_of_a_car_is_named() {
    let (speeds, speed_step_mm) = (21, 100);
    let (radius_mm, shortest_mm, turn_step_urad) = (3_000, 500, 50_000);
    let shape = Shape { radius_mm, shortest_mm, turn_step_urad, speeds, speed_step_mm };
    let car = Car::new(shape).expect("a car");
    let check = |breaks| contract::check(&FaultyCar(car, breaks));
    assert_eq!(check(CarBreaks::Nothing), Ok(()));
    for (breaks, broken) in [
        (CarBreaks::MoreWhenSlower, ContractError::Speeds(9)),
        (CarBreaks::NotAllWhenFastest, ContractError::Speeds(20)),
        (CarBreaks::KnowsTooMany, ContractError::Speeds(9)),
        (CarBreaks::KnowsTooFew, ContractError::Speeds(9)),
        (CarBreaks::EndsElsewhere, ContractError::Arrival(Side::Left, 0)),
        (CarBreaks::EndsStraight, ContractError::Arrival(Side::Left, 1)),
        (CarBreaks::CornerTooFar, ContractError::Arrival(Side::Left, 1)),
        (CarBreaks::OneOrbit, ContractError::TurningCircle(Side::Right)),
        (CarBreaks::TurnsTheOtherWay, ContractError::TurningCircle(Side::Left)),
        (CarBreaks::DoesNotTurn, ContractError::TurningCircle(Side::Left)),
        (CarBreaks::LeavesItsRadius, ContractError::TurningCircle(Side::Left)),
        (CarBreaks::LeavesItsCentre, ContractError::TurningCircle(Side::Left)),
    ] {
        assert_eq!(check(breaks), Err(broken), "{breaks:?}");
    }
}

#[test]
fn rays_are_as_many_as_a_grid_can_have() {
    let many = Holonomic::new(65_537, 1, 1).expect("a grid");
    assert_eq!(many.rays(pose(0)).count(), 65_537);
    for (bearings, speeds) in [(u32::MAX, 1), (1 << 31, 2), (3 << 29, 2)] {
        let most = Holonomic::new(bearings, speeds, 1).expect("a grid");
        assert_eq!(contract::check(&most), Ok(()), "{bearings}");
        let [nearest, _] = most.around(pose(0), Heading(123_456_789));
        assert!(apart(nearest.heading, Heading(123_456_789)) < 2, "{bearings}: {nearest:?}");
    }
}

/// Beyond 65,536 rays the contract looks at some of them: here are all that lie side by side in places.
#[test]
fn the_fine_fan_keeps_the_contract_and_its_rays_differ() {
    let fine = Unicycle::fine();
    let grid = fine.grid();
    assert_eq!((grid.rays(), grid.actions()), (3_141_595, 65_973_495));
    assert_eq!(contract::check(&fine), Ok(()));
    let turns = fine.fan().right;
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for start in [0, 1, 1_000_000, turns - 2_000] {
        let (pose, side) = (pose(rng.random()), if start == 1 { Side::Right } else { Side::Left });
        for n in start..start + 2_000 {
            let (ray, next) = (fine.ray(pose, side, n), fine.ray(pose, side, n + 1));
            assert!(ray.heading != next.heading && ray.step != next.step, "{ray:?} {next:?}");
            // 1 urad, or what is left of it before the last, is 683 units of a heading.
            let apart = apart(ray.heading, next.heading);
            assert!(apart.abs_diff(684) <= 1 || n + 1 == turns && apart > 0, "{n}: {apart}");
            let mrad = f64::from(n) / 1_000.0;
            assert!((f64::from(ray.turn_cost) - mrad * mrad).abs() < 0.61, "{n}: {ray:?}");
        }
    }
}

#[test]
fn the_index_of_an_action_leads_back_to_its_ray_and_speed() {
    let (fine, pose) = (Unicycle::fine(), pose(7));
    let last = (fine.grid().actions() - 1) as u32;
    for index in (0..=last).step_by(9_999).chain(last - 50..=last) {
        let (ray, speed) = fine.grid().split(Action(index));
        assert_eq!(fine.grid().action(ray, speed), Action(index));
        assert_eq!(fine.ray_of(pose, Action(index)).map(|it| it.index), Some(ray));
    }
    let Control { distance_m: v, turn_rad: w } = fine.control(pose, Action(last));
    assert_eq!((v.to_bits(), w.to_bits()), (2.0_f32.to_bits(), (FRAC_PI_2 as f32).to_bits()));
    for beyond in [last + 1, u32::MAX] {
        assert_eq!(fine.ray_of(pose, Action(beyond)), None);
        assert_eq!(fine.target(pose, Action(beyond)), None);
    }
    let _ = Unicycle::paper().control(pose, Action(u32::MAX)); // it does not overflow
}

/// The paper's turns and their squares as they always were.
#[test]
fn the_papers_turns_are_multiples_of_10_mrad() {
    let paper = Unicycle::paper();
    for n in 0..158 {
        let exact = f64::from(n) / 100.0;
        let ray = paper.ray(pose(0), Side::Left, n);
        assert_eq!(Ok(ray.heading), Heading::from_radians(exact), "{n}");
        assert_eq!((ray.index, ray.turn_cost), (158 + n, 100 * n * n));
        let Control { turn_rad: w, .. } = paper.control(pose(0), paper.grid().action(ray.index, 3));
        assert_eq!(w.to_bits(), (exact as f32).to_bits());
    }
    assert_eq!(paper.ray(pose(0), Side::Right, 158).heading, Heading(3 << 30));
    assert_eq!(paper.ray(pose(0), Side::Right, 158).turn_cost, 2_467_401);
    assert_eq!(paper.fan().spacing, Angle(6_835_653));
}

/// Turns whose last multiple lies next to the sharpest turn, or on it but for rounding.
#[test]
fn a_sharpest_turn_next_to_a_multiple_keeps_the_contract() {
    for step in [10, 70, 1_000, 333_333] {
        for steps in [1, 2, 9, 40] {
            let multiple = f64::from(step * steps) * 1e-6;
            for off in [-2e-9, -1e-9, -1e-12, 0.0, 1e-12, 7e-10, 1e-9, 2e-9] {
                if let Ok(it) = Unicycle::new(step, multiple + off, 3, 100) {
                    assert_eq!(contract::check(&it), Ok(()), "{step} {steps} {off}");
                }
            }
        }
    }
}

/// Any car that the constructor takes, from a model's to a ship's.
fn any_car(rng: &mut ChaCha8Rng) -> Result<Car, GridError> {
    Car::new(Shape {
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
fn cars_and_boats_keep_the_contract() {
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut cars, mut boats) = (0, 0);
    for _ in 0..cases(400, 20_000) {
        if let Ok(car) = any_car(&mut rng) {
            assert_eq!(contract::check(&car), Ok(()), "{car:?}");
            cars += 1;
        }
        let sharpest = [1e-3, 0.349_066, FRAC_PI_2, 3.0, PI][rng.random_range(0..5)];
        let speeds = [1, 2, 21][rng.random_range(0..3)];
        let (turn, step) = (rng.random_range(1_000..200_000), rng.random_range(1..4_000));
        let steps = Unicycle::new(turn, sharpest, speeds, step);
        if let Ok(boat) = steps.and_then(Boat::new) {
            assert_eq!(contract::check(&boat), Ok(()), "{boat:?}");
            boats += 1;
        }
    }
    println!("{cars} cars, {boats} boats");
    assert!(cars > 100 && boats > 100);
}

#[test]
fn what_cannot_go_round_is_no_car() {
    let good = Shape {
        radius_mm: 3_000,
        shortest_mm: 500,
        turn_step_urad: 10_000,
        speeds: 21,
        speed_step_mm: 100,
    };
    assert!(Car::new(good).is_ok());
    for (bad, why) in [
        (Shape { radius_mm: 0, ..good }, GridError::Circle),
        (Shape { radius_mm: Car::WIDEST_MM, ..good }, GridError::Circle),
        (Shape { shortest_mm: 2_001, ..good }, GridError::Circle),
        (Shape { speeds: 1, ..good }, GridError::Circle),
        // 0.34 rad is the sharpest chord of 2 m.
        (Shape { turn_step_urad: 350_000, ..good }, GridError::Circle),
        (Shape { turn_step_urad: 0, ..good }, GridError::Turn),
        (Shape { turn_step_urad: 785_399, ..good }, GridError::Turn),
        (Shape { speed_step_mm: 0, ..good }, GridError::Reach),
        (Shape { speeds: 601, speed_step_mm: 5_000, ..good }, GridError::Reach),
        (Shape { speeds: 0, ..good }, GridError::Actions),
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
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let (mut arcs, mut tight, mut bulges) = (0, 0, 0);
    while arcs < cases(4_000, 200_000) {
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
    println!("{arcs} arcs, {tight} of them tight; {bulges} points within their triangles");
    assert!(tight > 50 && bulges > 100_000);
}

/// How many poses are not safe, and how many are; a circle from each of these lies inside.
fn compare<D: Dynamics>(it: &D, area: Area, rng: &mut ChaCha8Rng) -> [u32; 2] {
    let mut count = [0; 2];
    for _ in 0..cases(300, 20_000) {
        let mut any = || rng.random_range(0..=20 << 16);
        let site = Site::new(any(), any()).expect("near");
        let from = Pose { site, heading: Heading(rng.random()) };
        let goes_round = |side| {
            let (mut pose, mut turned, mut inside) = (from, 0.0, true);
            while turned < 2.0 * std::f64::consts::TAU {
                let TurningCircle { action, .. } =
                    it.turning_circle(pose, side).expect("it has one");
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
    let mut rng = ChaCha8Rng::seed_from_u64(6);
    for radius_mm in [300, 1_000, 3_000, 5_000] {
        let car = Car::new(Shape {
            radius_mm,
            shortest_mm: 500,
            turn_step_urad: 10_000,
            speeds: 21,
            speed_step_mm: 100,
        });
        println!("{radius_mm} mm: {:?}", compare(&car.expect("a car"), area, &mut rng));
    }
    for step_mm in [100, 800] {
        let steps = Unicycle::new(10_000, 20f64.to_radians(), 3, step_mm).expect("a grid");
        let boat = Boat::new(steps).expect("a boat");
        println!("boat of {step_mm} mm: {:?}", compare(&boat, area, &mut rng));
    }
}
