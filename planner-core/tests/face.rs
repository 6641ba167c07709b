//! Whoever knows the published names alone makes and names each vehicle, area, belief, planner and error.

use std::error::Error;

use planner_core::error::{
    GivenError, GridError, HullError, LatticeError, PolygonAreaError, SetupError, ValueError,
};
use planner_core::{
    AnyReliability, AnyVehicle, Area, Boat, Car, CarShape, CellPosterior, CellView, Certainty, Cfc,
    Far, Front, FrontStretch, Goal, Guard, Heading, Holonomic, Hull, KeepOut, Label, Lines,
    Lookahead, Motion, Noise, NoisyBelief, Plan, Planner, PolygonArea, Pose, Prior, Recovery,
    Reliability, Sample, Scc, Seek, Site, SlopeArc, Tolerance, Track, Unicycle, UnicycleShape,
    UnknownReliability, VehicleShape, VersionSpace, Workspace,
};

type Result<T = (), E = Box<dyn Error>> = std::result::Result<T, E>;
type Lake = PolygonArea<4, 1>;

/// What a program keeps beside its planner: each type has a name.
struct Kept<'a> {
    motion: Motion,
    recovery: Option<Recovery>,
    slopes: SlopeArc,
    lines: CellView<'a>,
}

fn car(radius_mm: u32) -> Result<Car, GridError> {
    let [shortest_mm, speed_step_mm] = [100; 2];
    Car::new(CarShape { radius_mm, shortest_mm, turn_step_urad: 10_000, speeds: 21, speed_step_mm })
}

fn lake() -> Result<Lake, PolygonAreaError> {
    let island = KeepOut { hull: Hull::metres(&[[10.0, 2.0]])?, radius: 1 << 16 };
    Lake::metres(&[[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]], &[island])
}

fn given() -> Result<[Sample; 4], LatticeError> {
    Ok([
        Sample::at([2.0, 1.0], Label::Negative)?,
        Sample::at([2.0, 8.0], Label::Positive)?,
        Sample::at([18.0, 16.0], Label::Positive)?,
        Sample::at([18.0, 5.0], Label::Negative)?,
    ])
}

fn flies(mut planner: impl Planner) -> Result<Motion> {
    let mut pose = Pose::at([2.0, 1.0], Heading::default())?;
    let Plan::Move(motion) = planner.plan(pose) else { return Err("it stops".into()) };
    pose = motion.target;
    planner.observe(pose, motion.wants_label.then_some(Label::Negative.into()))?;
    Ok(motion)
}

#[test]
fn vehicles() -> Result {
    let (unicycle, car) = (Unicycle::new(10_000, 1.5, 21, 100)?, car(1_000)?);
    let shapes: (UnicycleShape, CarShape) = (unicycle.shape(), car.shape());
    let [boat, again] = [VehicleShape::Boat(shapes.0), VehicleShape::Car(shapes.1)];
    assert_eq!(AnyVehicle::try_from(again), Ok(AnyVehicle::Car(car)));
    assert_eq!(AnyVehicle::try_from(boat), Ok(AnyVehicle::Boat(Boat::new(unicycle)?)));
    Ok(())
}

#[test]
fn areas_beliefs_and_planners_with_any_vehicle() -> Result {
    let (given, noise, clear) = (given()?, Noise::new(0.9)?, lake()?.with_clearance(0.5)?);
    let space = VersionSpace::<16>::new(&given)?.with_tolerance(Tolerance::new(0.01)?)?;
    let motion = flies(Cfc::new(clear, car(1_000)?, space.clone())?)?;
    let kept =
        Kept { motion, recovery: motion.recovery, slopes: space.slope_arc(), lines: space.lines() };
    assert!(kept.motion.recovery == kept.recovery && kept.slopes.width_deg() > 0.0);
    assert!(kept.lines.certainty(Site::metres([2.0, 0.5])?) == Certainty::Certain(Label::Negative));
    let table = CellPosterior::<16, 137>::new(&given, Prior::Area, noise)?;
    flies(Scc::new(clear, Boat::new(Unicycle::default())?, table)?)?;
    let goal = Goal::slope_within_degrees(1.0)?;
    let far = Far::at_price(5.0)?;
    flies(Lookahead::new(clear, Holonomic::new(360, 21, 100)?, space)?.until(goal).seeing(far))?;
    let doubtful = NoisyBelief::<16, 137, UnknownReliability>::new(&given, Noise::beta(9.0, 1.0)?)?;
    flies(Lookahead::new(lake()?, Unicycle::paper(), doubtful)?)?;
    let (area, front) = (Area::metres([0.0; 2], [20.0; 2])?, Front::bending(10.0)?);
    let known: Noise<AnyReliability> = Noise::from(noise);
    flies(Seek::new(area, Unicycle::default(), Lines::<16, 16>::new(area, known))?)?;
    flies(Track::new(area, Unicycle::default(), front, known)?)?;
    let told = (front, FrontStretch::metres(10.0)?);
    flies(Guard::watching(area, Unicycle::default(), told, known)?)?;
    Ok(())
}

#[test]
fn errors() -> Result {
    let straight = Lake::metres(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], &[]);
    assert_eq!(straight, Err(PolygonAreaError::Area(HullError::NotConvex)));
    assert_eq!(car(0), Err(GridError::Circle));
    assert_eq!(VersionSpace::<16>::new(&given()?[..1]).err(), Some(GivenError::Collinear));
    let text: ValueError = Reliability::new(2.0).err().ok_or("taken")?;
    assert!(text.to_string().contains("probability"));
    let tiny = Area::metres([0.0; 2], [20.0; 2])?;
    let space = VersionSpace::<16>::new(&given()?)?.with_tolerance(15.0);
    let refused: Option<SetupError> =
        space.ok().and_then(|it| Cfc::new(tiny, Unicycle::default(), it).err());
    assert!(refused.is_some());
    Ok(())
}
