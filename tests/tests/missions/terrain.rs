//! Convex areas with keep-outs: the exact predicates, against a geometry library that is not ours, and a way round a wall.

use geo::{Coord, Distance, Euclidean, Point};
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::given::Lines;
use host_sim::mission::results::Ending;
use host_sim::world::World;
use nalgebra::Point2;
use planner_core::error::HullError;
use planner_core::lattice::{LIMIT, UNITS_PER_METRE, are_apart};
use planner_core::link::message::MissionArea;
use planner_core::{AnyVehicle, Heading, Hull, KeepOut, Label, Line, Pose, Sample, Site, Unicycle};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::anything::flight::fly;
use tests::cases;
use tests::terrain::on_circle;
use tests::vehicles::{boat, car};

fn coord(site: Site) -> Coord {
    let at = Point2::<f64>::from(site);
    Coord { x: at.x, y: at.y }
}

/// A hull as the library has it.
fn shape(corners: &[Site]) -> geo::Geometry {
    match corners {
        [point] => Point::from(coord(*point)).into(),
        [a, b] => geo::Line::new(coord(*a), coord(*b)).into(),
        _ => {
            let border = corners.iter().map(|at| coord(*at)).collect();
            geo::Polygon::new(border, vec![]).into()
        }
    }
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
    let not_convex: [&[(i32, i32)]; 6] = [
        &[(0, 0), (0, 0)],
        // In line, a dent, a bow, a star, one twice.
        &[(0, 0), (5, 0), (9, 0)],
        &[(0, 0), (9, 0), (2, 2), (0, 9)],
        &[(0, 0), (9, 9), (9, 0), (0, 9)],
        &[(0, 10), (6, -8), (-10, 3), (10, 3), (-6, -8)],
        &[(0, 0), (9, 0), (9, 0), (0, 9)],
    ];
    for corners in not_convex {
        assert_eq!(hull(corners), Err(HullError::NotConvex), "{corners:?}");
    }
    let mut square = [(0, 0), (9, 0), (9, 9), (0, 9)];
    assert_eq!([hull(&square[..1]), hull(&square)], [Ok(()); 2]);
    square.reverse();
    assert_eq!(hull(&square), Ok(()));
    let six = [(0, 0), (9, 0), (12, 5), (9, 9), (0, 9), (-3, 5)];
    assert_eq!(hull(&six), Err(HullError::TooMany(5)));
}

/// A wall between the robot and all that is uncertain: it goes round, and asks there.
#[test]
fn it_goes_round_what_is_in_the_way() {
    let at = |x: f64, z: f64| Site::try_from(Point2::new(x, z)).expect("near");
    let vehicles = [
        AnyVehicle::Unicycle(Unicycle::paper()),
        AnyVehicle::Boat(boat(10_000, 20_f64.to_radians(), 2_000)),
        AnyVehicle::Car(car(10_000, 1_000, 2_000)),
    ];
    for vehicle in vehicles {
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
            let flight = fly(&mission, vehicle, u64::MAX);
            assert!(flight.ending == Ending::Steps && flight.labels >= 12, "{flight:?}");
            assert!(flight.findings.is_empty(), "{vehicle:?}, {algorithm:?}: {flight:?}");
        }
    }
}
