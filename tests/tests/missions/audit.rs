//! The audit before a goal's promise: what it refutes, what it never refutes, and its price.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use nalgebra::{Point2, Vector2};
use planner_core::dynamics::Dynamics;
use planner_core::error::ObservationError;
use planner_core::link::message::MissionArea;
use planner_core::motion::car::Shape;
use planner_core::planner::Stage;
use planner_core::{
    AnyVehicle, Boat, Car, Goal, Label, Line, Plan, Planner as _, Sample, Site, StopReason,
    Unicycle, VersionSpace, Workspace as _,
};
use rayon::prelude::*;
use tests::cases;

/// Motions of a mission at most.
const MOTIONS: u32 = 600;

/// A boundary: how far it lies from the true line at some metres along that, at a motion.
type Bend = dyn Fn(f64, u32) -> f64 + Sync;

/// How a mission ended, and what its audit cost.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ended {
    Known,
    NoLine,
    Contradiction,
    Otherwise(Option<StopReason>),
}

#[derive(Clone, Copy, Debug)]
struct Flown {
    ended: Ended,
    agreed: u8,
    motions: u32,
    metres: f64,
}

/// A field whose boundary is bent; `None` if its given samples no longer tell a line.
struct Field<'a> {
    mission: Mission,
    line: Line,
    bend: &'a Bend,
}

impl<'a> Field<'a> {
    fn new(number: u64, degrees: f64, bend: &'a Bend) -> Option<Self> {
        let mut mission = standard_field::standard(41, number, Algorithm::Lookahead, 1);
        let line = *mission.world.line()?;
        mission.goal = Some(Goal::slope_within_degrees(degrees).ok()?.into());
        let mut field = Self { mission, line, bend };
        let samples: Vec<_> = field.mission.given.samples().to_vec();
        let seen = samples.iter().map(|it| Sample { label: field.label(it.site, 0), ..*it });
        field.mission.given = VersionSpace::new(&seen.collect::<Vec<_>>()).ok()?;
        Some(field)
    }

    /// +1 beyond the bent boundary.
    fn label(&self, site: Site, motion: u32) -> Label {
        let at = Point2::<f64>::from(site);
        let [a, b, _] = self.line.coefficients();
        let middle = Point2::new(10.0, 10.0)
            - Vector2::new(a, b) * self.line.distance(Point2::new(10.0, 10.0));
        let along = (at - middle).dot(&Vector2::new(b, -a));
        let is_above = self.line.distance(at) > (self.bend)(along, motion);
        if is_above { Label::Positive } else { Label::Negative }
    }

    fn fly(&self, vehicle: impl Dynamics, area: MissionArea) -> Flown {
        let mut planner = self.mission.lookahead(area, vehicle);
        let mut pose = self.mission.start;
        let mut flown = Flown { ended: Ended::Otherwise(None), agreed: 0, motions: 0, metres: 0.0 };
        for motion in 0..MOTIONS {
            let plan = planner.plan(pose);
            assert_eq!(plan, planner.plan(pose), "a plan asked for twice is the same");
            flown.agreed = planner.audit().map_or(0, |audit| audit.agreed());
            let step = match plan {
                Plan::Move(step) => step,
                Plan::Stop(reason) => {
                    flown.ended = match reason {
                        StopReason::Known => Ended::Known,
                        StopReason::NoLine => Ended::NoLine,
                        other => Ended::Otherwise(Some(other)),
                    };
                    return flown;
                }
            };
            if step.stage == Some(Stage::Audit) {
                flown.motions += 1;
                flown.metres += f64::from(step.control.distance_m);
            }
            assert!(area.contains(step.target.site), "{step:?}");
            pose = step.target;
            let reading = step.wants_label.then(|| self.label(pose.site, motion).into());
            match planner.observe(pose, reading) {
                Ok(()) => {}
                Err(ObservationError::Contradiction(_)) => {
                    flown.ended = Ended::Contradiction;
                    return flown;
                }
                Err(other) => panic!("{other}"),
            }
        }
        flown
    }
}

fn vehicles() -> [(&'static str, AnyVehicle); 3] {
    let shape = Shape {
        radius_mm: 1_000,
        shortest_mm: 200,
        turn_step_urad: 10_000,
        speeds: 20,
        speed_step_mm: 100,
    };
    let steps = Unicycle::new(10_000, 0.4, 20, 100).expect("steps");
    let fan = Algorithm::Lookahead.grid().into();
    let [car, boat] = [
        AnyVehicle::Car(Car::new(shape).expect("a car")),
        AnyVehicle::Boat(Boat::new(steps).expect("a boat")),
    ];
    [("unicycle", fan), ("car", car), ("boat", boat)]
}

/// All that a number of fields come to.
#[derive(Default, Debug)]
struct Tally {
    fields: u32,
    known: u32,
    no_line: u32,
    contradiction: u32,
    otherwise: Vec<StopReason>,
    /// Of those that were known: labels, motions and metres of the audit.
    labels: f64,
    motions: f64,
    metres: f64,
}

fn tally(fields: u64, degrees: f64, vehicle: AnyVehicle, bend: &Bend) -> Tally {
    let flights = (0..fields).into_par_iter().filter_map(|number| {
        let field = Field::new(number, degrees, bend)?;
        let area = field.mission.config.area;
        Some(match vehicle {
            AnyVehicle::Unicycle(it) => field.fly(it, area),
            AnyVehicle::Car(it) => field.fly(it, area),
            AnyVehicle::Boat(it) => field.fly(it, area),
        })
    });
    let mut tally = Tally::default();
    for flown in flights.collect::<Vec<_>>() {
        tally.fields += 1;
        match flown.ended {
            Ended::Known => {
                tally.known += 1;
                tally.labels += f64::from(flown.agreed);
                tally.motions += f64::from(flown.motions);
                tally.metres += flown.metres;
            }
            Ended::NoLine => tally.no_line += 1,
            Ended::Contradiction => tally.contradiction += 1,
            Ended::Otherwise(why) => tally.otherwise.extend(why),
        }
    }
    let known = f64::from(tally.known);
    (tally.labels, tally.motions, tally.metres) =
        (tally.labels / known, tally.motions / known, tally.metres / known);
    tally
}

#[test]
fn true_labels_of_a_line_are_never_refuted() {
    for (name, vehicle) in vehicles() {
        for degrees in [2.0, 0.5, 0.1] {
            let tally = tally(cases(60, 10_000), degrees, vehicle, &|_, _| 0.0);
            println!("{name} {degrees}: {tally:?}");
            assert_eq!((tally.no_line, tally.contradiction), (0, 0));
        }
    }
}

#[test]
fn bent_and_drifting_boundaries_are_refuted() {
    let (_, vehicle) = vehicles()[0];
    for height in [0.1, 0.25, 0.5, 1.0, 2.0] {
        let bent = move |along: f64, _: u32| height * (1.0 - along * along / 100.0);
        let tally = tally(cases(100, 1_500), 0.5, vehicle, &bent);
        println!("bent by {height}: {tally:?}");
    }
    let drifts = |_: f64, motion: u32| 0.05 * f64::from(motion);
    println!("drifts: {:?}", tally(cases(100, 200), 0.5, vehicle, &drifts));
}
