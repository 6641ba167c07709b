//! Convex areas with keep-outs: the exact predicates and whole missions, against a geometry library that is not ours.

use std::collections::BTreeMap;

use geo::{Contains, Coord, Distance, Euclidean, LineString, Point};
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Lines;
use host_sim::mission::results::Ending;
use host_sim::world::World;
use host_sim::world::noise::{Extent, NoiseModel};
use nalgebra::Point2;
use planner_core::error::HullError;
use planner_core::geometry::hull::are_apart;
use planner_core::geometry::lattice::{LIMIT, UNITS_PER_METRE};
use planner_core::link::message::MissionArea;
use planner_core::motion::car::Shape;
use planner_core::{
    AnyVehicle, Boat, Car, Heading, Hull, KeepOut, Label, Line, Pose, Sample, Site, Tolerance,
    Unicycle, Workspace as _,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::terrain::{around, on_circle};

fn coord(site: Site) -> Coord {
    let at = Point2::<f64>::from(site);
    Coord { x: at.x, y: at.y }
}

/// A hull as the library has it.
fn shape(corners: &[Site]) -> geo::Geometry {
    match corners {
        [point] => Point::from(coord(*point)).into(),
        [a, b] => geo::Line::new(coord(*a), coord(*b)).into(),
        _ => polygon(corners).into(),
    }
}

fn polygon(corners: &[Site]) -> geo::Polygon {
    geo::Polygon::new(corners.iter().map(|at| coord(*at)).collect(), vec![])
}

#[test]
fn hulls_are_apart_as_the_library_says() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let (mut meeting, mut tight) = (0, 0);
    for case in 0..cases(20_000, 400_000) {
        let mut any = || {
            let middle = [rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0)];
            let (size, count) = (rng.random_range(0.001..3.0), rng.random_range(1..=8));
            on_circle(&mut rng, middle, size, count)
        };
        let (a, b) = (any(), any());
        let distance = Euclidean.distance(&shape(&a), &shape(&b));
        let units = distance * f64::from(UNITS_PER_METRE);
        // As near as the library's rounding lets us.
        for by in [units - 1e-3, units + 1e-3, 0.5 * units, 2.0 * units] {
            let whole = by.floor();
            if whole < 0.0 || (units - whole).abs() < 1e-4 {
                continue;
            }
            let apart = are_apart(&a, &b, whole as u32);
            assert_eq!(apart, units > whole, "case {case}: {a:?} and {b:?}, {units} and {whole}");
            assert_eq!(apart, are_apart(&b, &a, whole as u32), "case {case}");
            tight += 1;
        }
        meeting += usize::from(distance == 0.0);
    }
    assert!(meeting > 500 && tight > 10_000, "{meeting} {tight}");
}

#[test]
fn distances_are_exact_at_the_ends_of_the_lattice() {
    let site = |x: i64, z: i64| Site::new(x as i32, z as i32).expect("on the lattice");
    let far = i64::from(LIMIT) - 1;
    let corner = site(far, far);
    let diagonal = [site(-far, -far + 1), site(far - 1, far)];
    // The corner is a unit from the nearer end, and as far from the line as half a unit's diagonal.
    assert!(are_apart(&[corner], &diagonal, 0) && !are_apart(&[corner], &diagonal, 1));
    let across = [site(-far, far), site(far, -far)];
    assert!(!are_apart(&diagonal, &across, 0));
    assert!(!are_apart(&[site(far, 0)], &[site(-far, 0)], 2 * far as u32));
    assert!(are_apart(&[site(far, 0)], &[site(-far, 0)], 2 * far as u32 - 1));
}

#[test]
fn corners_of_no_convex_polygon_are_refused() {
    let site = |(x, z)| Site::new(x, z).expect("near");
    let hull = |corners: &[(i32, i32)]| {
        Hull::<5>::new(&corners.iter().copied().map(site).collect::<Vec<_>>()).map(drop)
    };
    assert_eq!(hull(&[]), Err(HullError::Empty));
    assert_eq!(hull(&[(0, 0)]), Ok(()));
    assert_eq!(hull(&[(0, 0), (0, 0)]), Err(HullError::NotConvex));
    assert_eq!(hull(&[(0, 0), (5, 0), (9, 0)]), Err(HullError::NotConvex), "in line");
    assert_eq!(hull(&[(0, 0), (9, 0), (2, 2), (0, 9)]), Err(HullError::NotConvex), "a dent");
    assert_eq!(hull(&[(0, 0), (9, 9), (9, 0), (0, 9)]), Err(HullError::NotConvex), "a bow");
    let star = [(0, 10), (6, -8), (-10, 3), (10, 3), (-6, -8)];
    assert_eq!(hull(&star), Err(HullError::NotConvex), "a star");
    assert_eq!(hull(&[(0, 0), (9, 0), (9, 0), (0, 9)]), Err(HullError::NotConvex), "one twice");
    let square = [(0, 0), (9, 0), (9, 9), (0, 9)];
    assert_eq!(hull(&square), Ok(()));
    let back: Vec<_> = square.into_iter().rev().collect();
    assert_eq!(hull(&back), Ok(()));
    assert_eq!(
        hull(&[(0, 0), (9, 0), (12, 5), (9, 9), (0, 9), (-3, 5)]),
        Err(HullError::TooMany(5))
    );
}

/// Where a motion goes along.
fn swept(from: Pose, to: Pose, control: [f64; 2], is_car: bool) -> LineString {
    let (start, end) = (coord(from.site), coord(to.site));
    if !is_car {
        return LineString::from(vec![start, end]);
    }
    let [length, turn] = control;
    let at = |k: u32| {
        let share = f64::from(k) / 64.0;
        let half = 0.5 * turn * share;
        let chord = if half == 0.0 { length * share } else { length * share * half.sin() / half };
        let (sin, cos) = (from.heading.radians() + half).sin_cos();
        Coord { x: start.x + chord * cos, y: start.y + chord * sin }
    };
    (0..=64).map(at).collect()
}

fn vehicles() -> [(&'static str, AnyVehicle); 3] {
    let steps = Unicycle::new(10_000, 20f64.to_radians(), 21, 100).expect("a grid");
    let car = Car::new(Shape {
        radius_mm: 1_000,
        shortest_mm: 300,
        turn_step_urad: 10_000,
        speeds: 21,
        speed_step_mm: 100,
    });
    [
        ("unicycle", AnyVehicle::Unicycle(Unicycle::paper())),
        ("boat", AnyVehicle::Boat(Boat::new(steps).expect("a boat"))),
        ("car", AnyVehicle::Car(car.expect("a car"))),
    ]
}

/// Flies a mission; how it ended, its motions, and what was wrong with one if something was.
fn fly(mission: &Mission) -> (Ending, usize, Option<String>) {
    let area = mission.config.area;
    let border = polygon(area.corners());
    let aimed_for = area.inset(mission.config.tolerance.units()).expect("a narrow margin");
    let is_car = matches!(mission.vehicle, AnyVehicle::Car(_));
    let pivots_not = !matches!(mission.vehicle, AnyVehicle::Unicycle(_));
    // The library's rounding, and that of an arc's end to the lattice.
    let slack = if is_car { 1e-4 } else { 1e-9 };
    let (mut from, mut motions, mut wrong) = (mission.start, 0, None);
    let flown = mission.fly(|step, _| {
        motions += 1;
        let control = [step.motion.control.distance_m, step.motion.control.turn_rad].map(f64::from);
        let way = swept(from, step.pose, control, is_car);
        for keep_out in area.hulls() {
            let radius = f64::from(keep_out.radius) / f64::from(UNITS_PER_METRE);
            let hull = shape(keep_out.hull.corners());
            let distance = Euclidean.distance(&geo::Geometry::from(way.clone()), &hull);
            if distance < radius - slack || (distance == 0.0 && radius == 0.0 && !is_car) {
                wrong = Some(format!("motion {motions} is {distance} m from {keep_out:?}"));
            }
        }
        let inside = |at: &Coord| {
            border.contains(&Point::from(*at))
                || Euclidean.distance(&Point::from(*at), border.exterior()) < slack
        };
        // Within the margin of the tolerance who cannot pivot may have to swing out in order to come back.
        let swings_out = pivots_not && !aimed_for.contains(from.site);
        if !swings_out && !way.0.iter().all(inside) {
            wrong = Some(format!("motion {motions} leaves the area: {way:?}"));
        }
        from = step.pose;
    });
    let flown = flown.unwrap_or_else(|refused| panic!("{refused}"));
    (flown.ending, motions, wrong)
}

#[test]
fn no_motion_crosses_a_keep_out_or_the_border() {
    const ALGORITHMS: [Algorithm; 3] = [Algorithm::Cfc, Algorithm::Lookahead, Algorithm::Scc];
    let all: Vec<_> = (0..cases(600, 10_000))
        .into_par_iter()
        .map(|number| {
            let mut rng = ChaCha8Rng::seed_from_u64(77);
            rng.set_stream(number);
            let algorithm = ALGORITHMS[number as usize % 3];
            let (name, vehicle) = vehicles()[number as usize / 3 % 3];
            let mut mission = standard_field::standard(5, number, algorithm, 20);
            mission.vehicle = vehicle;
            mission.config.area = around(&mission, &mut rng);
            if algorithm == Algorithm::Scc {
                mission.noise = Some(NoiseModel { p: 0.85, extent: Extent::OutsideBalls(0.0) });
            }
            if number % 2 == 1 {
                mission.config.tolerance = Tolerance::new(0.05).expect("a distance");
            }
            let (ending, motions, wrong) = fly(&mission);
            assert_eq!(wrong, None, "mission {number}, {name}, {algorithm:?}");
            if ending != Ending::Steps {
                println!("early {number} {name} {algorithm:?} {ending:?} {motions}");
            }
            (name, format!("{algorithm:?}"), format!("{ending:?}"), motions)
        })
        .collect();
    let mut endings = BTreeMap::new();
    for (name, algorithm, ending, _) in &all {
        *endings.entry((name, algorithm, ending)).or_insert(0) += 1;
    }
    for ((name, algorithm, ending), count) in &endings {
        println!("{name}, {algorithm}: {count} {ending}");
    }
    let motions: usize = all.iter().map(|(.., motions)| motions).sum();
    println!("{motions} motions");
    assert!(motions as u64 > 15 * all.len() as u64);
}

/// A wall between the robot and all that is uncertain: it goes round, and asks there.
#[test]
fn it_goes_round_what_is_in_the_way() {
    let at = |x: f64, z: f64| Site::try_from(Point2::new(x, z)).expect("near");
    for (name, vehicle) in vehicles() {
        for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
            let mut mission = standard_field::standard(5, 1, algorithm, 40);
            let labels = [(3.0, 8.0, -1), (3.0, 12.0, 1), (17.0, 12.5, 1), (17.0, 8.5, -1)];
            let given = labels.map(|(x, z, sign)| Sample {
                site: at(x, z),
                label: if sign > 0 { Label::Positive } else { Label::Negative },
            });
            mission.given = Lines::new(&given).expect("lines are left").into();
            let truth = Line::from_slope(0.02, 9.9).expect("a line");
            (mission.world, mission.vehicle) = (World::divided_by(truth), vehicle);
            let wall = Hull::new(&[at(2.5, 5.0), at(17.0, 5.2)]).expect("a wall");
            let pillar = Hull::new(&[at(18.3, 4.0)]).expect("a point");
            let keep_outs =
                [(wall, 0), (pillar, 80_000)].map(|(hull, radius)| KeepOut { hull, radius });
            let border = Hull::of(standard_field::area());
            mission.config.area = MissionArea::new(border, &keep_outs).expect("an area");
            mission.start = Pose { site: at(12.0, 2.5), heading: Heading(0) };
            let mut labels = 0;
            let flown = mission.fly(|step, _| labels += u32::from(step.reading.is_some()));
            let flown = flown.expect("labels are true");
            assert_eq!(flown.ending, Ending::Steps, "{name}, {algorithm:?}");
            assert!(labels >= 12, "{name}, {algorithm:?}: {labels} labels");
            let (_, _, wrong) = fly(&mission);
            assert_eq!(wrong, None, "{name}, {algorithm:?}");
            println!("{name}, {algorithm:?}: {labels} labels in 40 motions");
        }
    }
}
