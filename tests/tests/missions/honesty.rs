//! What is said of worlds that no straight, still line divides, and of sensors that fail: the evidence of labels, and the
//! audit before a goal's promise. Neither accuses a line that is true.

use std::cell::{Cell, RefCell};
use std::convert::Infallible;

use host_sim::campaign::standard_field;
use host_sim::fitting::explanation::{Cause, Explanation, Told};
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::CAPACITY;
use host_sim::world::polygon::misclassified;
use nalgebra::{Point2, Vector2};
use planner_core::error::ObservationError;
use planner_core::motion::car::Shape;
use planner_core::robot::{DriveFn, SensorFn};
use planner_core::watch::{Alarm, Watched};
use planner_core::{
    Agent, AnyVehicle, Belief as _, Boat, Car, Event, Goal, Label, Line, Lookahead, Motion, Plan,
    Planner, Sample, Site, Stage, StopReason, Tolerance, Unicycle, Vehicle, VersionSpace,
    Workspace as _,
};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

/// Motions of a mission at most.
const MOTIONS: u32 = 600;

/// The middle of the standard area.
const MIDDLE: Point2<f64> = Point2::new(10.0, 10.0);

/// How far the boundary lies from the true line, so many metres along that from the place nearest to the middle, after
/// so many motions.
type Bend = dyn Fn(f64, u32) -> f64 + Sync;

/// What the sensor reads as its `n`-th label, from 0, of these true ones.
type Sensor = dyn Fn(&[Label], &mut ChaCha8Rng) -> Label + Sync;

/// A world and a sensor.
struct Case<'a> {
    name: &'static str,
    bend: &'a Bend,
    sensor: &'a Sensor,
}

fn straight(_: f64, _: u32) -> f64 {
    0.0
}

fn perfect(labels: &[Label], _: &mut ChaCha8Rng) -> Label {
    labels[labels.len() - 1]
}

/// A standard field with another boundary; `None` if its given samples no longer tell a line.
struct Field<'a> {
    mission: Mission,
    line: Line,
    case: &'a Case<'a>,
}

/// What a mission came to.
struct Flown {
    ended: Option<StopReason>,
    /// A label was refused.
    is_refused: bool,
    alarm: Option<Alarm>,
    /// The share of the area that the estimate really misclassifies, and about what it expects.
    wrong: [f64; 2],
    /// Labels, motions and metres of the audit.
    audit: [f64; 3],
    /// What was given, and what was read after so many motions.
    given: Vec<Sample>,
    read: Vec<(Sample, u32)>,
    estimate: Option<Line>,
}

impl Flown {
    /// The result is much worse than it says.
    fn is_confidently_wrong(&self) -> bool {
        let [wrong, expected] = self.wrong;
        wrong > 0.05 && wrong > 3.0 * expected
    }

    /// Nothing says so.
    fn is_silent(&self) -> bool {
        let alarms = self.alarm.is_some_and(|it| it.evidence >= Alarm::ALARM);
        !alarms && !self.is_refused && self.ended != Some(StopReason::NoLine)
    }
}

impl Flown {
    fn told(&self) -> Told<'_> {
        Told {
            given: &self.given,
            read: &self.read,
            tolerance: Tolerance::NONE,
            near: self.estimate.as_ref().expect("a line"),
        }
    }

    /// What is said to explain the labels.
    fn cause(&self) -> Cause {
        Explanation::of(&self.told()).cause()
    }
}

impl<'a> Field<'a> {
    fn new(number: u64, algorithm: Algorithm, case: &'a Case<'a>) -> Option<Self> {
        let mut mission = standard_field::standard(41, number, algorithm, 1);
        let line = *mission.world.line()?;
        let samples = mission.given.samples().to_vec();
        let mut field = Self { mission: mission.clone(), line, case };
        let seen = samples.iter().map(|it| Sample { label: field.label(it.site, 0), ..*it });
        mission.given = VersionSpace::new(&seen.collect::<Vec<_>>()).ok()?.into();
        field.mission = mission;
        Some(field)
    }

    /// +1 beyond the boundary.
    fn label(&self, site: Site, motion: u32) -> Label {
        let at = Point2::<f64>::from(site);
        let [a, b, _] = self.line.coefficients();
        let foot = MIDDLE - Vector2::new(a, b) * self.line.distance(MIDDLE);
        let along = (at - foot).dot(&Vector2::new(b, -a));
        let is_above = self.line.distance(at) > (self.case.bend)(along, motion);
        if is_above { Label::Positive } else { Label::Negative }
    }

    /// Flies until it ends, or so many labels are read.
    fn fly(&self, planner: impl Planner<Belief = VersionSpace<CAPACITY>>, labels: usize) -> Flown {
        let mut planner = Watched::new(planner);
        let (mut pose, area) = (self.mission.start, self.mission.config.area);
        let mut rng = ChaCha8Rng::seed_from_u64(self.mission.seed);
        let (mut ended, mut is_refused, mut motion) = (None, false, 0);
        let (mut truths, mut audit, mut read) = (Vec::new(), [0.0; 3], Vec::new());
        while truths.len() < labels && motion < MOTIONS {
            let plan = planner.plan(pose);
            assert_eq!(plan, planner.plan(pose), "a plan asked for twice is the same");
            let step = match plan {
                Plan::Move(step) => step,
                Plan::Stop(reason) => {
                    ended = Some(reason);
                    break;
                }
            };
            assert!(area.contains(step.target.site), "{step:?}");
            (pose, motion) = (step.target, motion + 1);
            if step.stage == Some(Stage::Audit) {
                let metres = f64::from(step.control.distance_m);
                audit[0] += f64::from(u8::from(step.wants_label));
                audit[1] += 1.0;
                audit[2] += metres;
            }
            let reading = step.wants_label.then(|| {
                truths.push(self.label(pose.site, motion));
                let label = (self.case.sensor)(&truths, &mut rng);
                read.push((Sample { site: pose.site, label }, motion));
                label.into()
            });
            match planner.observe(pose, reading) {
                Ok(()) => {}
                Err(ObservationError::Contradiction(_)) => {
                    is_refused = true;
                    break;
                }
                Err(other) => panic!("{other}"),
            }
        }
        let wrong = self.wrong(planner.belief(), motion);
        let estimate = planner.belief().centre().map(Line::from);
        let given = planner.belief().given().to_vec();
        Flown { ended, is_refused, alarm: planner.alarm(), wrong, audit, given, read, estimate }
    }

    /// The real misclassified share of the centre, and the mean one of the vertices of the version space.
    fn wrong(&self, space: &VersionSpace<CAPACITY>, motion: u32) -> [f64; 2] {
        const SIDE: i32 = 100;
        let Some(centre) = space.centre().map(Line::from) else { return [0.0, 1.0] };
        let places = (0..SIDE * SIDE).map(|k| {
            let at = |k: i32| 20.0 * (f64::from(k) + 0.5) / f64::from(SIDE);
            Site::try_from(Point2::new(at(k % SIDE), at(k / SIDE))).expect("near")
        });
        let differs = |site: &Site| {
            let is_above = centre.distance(Point2::from(*site)) > 0.0;
            is_above != (self.label(*site, motion) == Label::Positive)
        };
        let wrong = places.filter(differs).count() as f64 / f64::from(SIDE * SIDE);
        let vertices: Vec<_> = space.bounds().map(Line::from).collect();
        let area = self.mission.config.area;
        let expected: f64 = vertices.iter().map(|it| misclassified(area, it, &centre)).sum();
        [wrong, expected / vertices.len() as f64]
    }
}

/// Algorithm 1 and look-ahead with true labels, for 20 labels; look-ahead with a goal of half a degree, and its audit.
const PLANNERS: [&str; 3] = ["Algorithm 1", "look-ahead", "with a goal"];

/// All fields of a case, for one of the planners.
fn fly_all(case: &Case<'_>, planner: &str, fields: u64) -> Vec<Flown> {
    let algorithm = if planner == PLANNERS[0] { Algorithm::Cfc } else { Algorithm::Lookahead };
    let fly = |number| {
        let field = Field::new(number, algorithm, case)?;
        let (area, fan) = (field.mission.config.area, algorithm.grid());
        Some(match planner {
            "Algorithm 1" => field.fly(field.mission.cfc(area, Unicycle::from(fan)), 20),
            "look-ahead" => field.fly(field.mission.lookahead(area, Unicycle::from(fan)), 20),
            _ => {
                let planner = field.mission.lookahead(area, Unicycle::from(fan));
                field.fly(planner.until(slope_within(0.5)), 64)
            }
        })
    };
    (0..fields).into_par_iter().filter_map(fly).collect()
}

fn slope_within(degrees: f64) -> Goal<planner_core::SlopeWithin> {
    Goal::slope_within_degrees(degrees).expect("an angle")
}

fn percent(flown: &[Flown], of: impl Fn(&Flown) -> bool) -> f64 {
    100.0 * flown.iter().filter(|it| of(it)).count() as f64 / flown.len() as f64
}

fn circle(radius: f64) -> impl Fn(f64, u32) -> f64 {
    move |along, _| (radius * radius - along * along).max(0.0).sqrt() - radius
}

fn sine(height: f64) -> impl Fn(f64, u32) -> f64 {
    move |along, _| height * (along * std::f64::consts::TAU / 20.0).sin()
}

/// From a label on, counted from 1, the sensor reads otherwise.
fn from(
    first: usize,
    fault: impl Fn(Label) -> Label,
) -> impl Fn(&[Label], &mut ChaCha8Rng) -> Label {
    move |labels, rng| {
        let label = perfect(labels, rng);
        if labels.len() >= first { fault(label) } else { label }
    }
}

/// As many samples late.
fn late(by: usize) -> impl Fn(&[Label], &mut ChaCha8Rng) -> Label {
    move |labels, _| labels[labels.len().saturating_sub(1 + by)]
}

fn garbage(_: &[Label], rng: &mut ChaCha8Rng) -> Label {
    if rng.random() { Label::Positive } else { Label::Negative }
}

/// The table of the study, off the model.
#[test]
fn results_that_are_wrong_say_so() {
    let fields = cases(40, 600);
    println!(
        "confidently wrong, %: all; of these silent; and missions that end Known, of {fields} fields"
    );
    let (circles, sines) = ([100.0, 50.0, 30.0, 20.0].map(circle), [0.5, 1.0, 2.0].map(sine));
    let drift = |_: f64, motion: u32| 0.05 * f64::from(motion);
    let stuck = [1, 5, 10].map(|first| from(first, |_| Label::Positive));
    let inverted = [1, 5, 10].map(|first| from(first, |label| -label));
    let lates = [1, 2].map(late);
    let mut all = vec![Case { name: "a straight line", bend: &straight, sensor: &perfect }];
    let names = ["front of 100 m", "front of 50 m", "front of 30 m", "front of 20 m"];
    all.extend(names.iter().zip(&circles).map(|(name, bend)| Case {
        name,
        bend,
        sensor: &perfect,
    }));
    let names = ["sine of 0.5 m", "sine of 1 m", "sine of 2 m"];
    all.extend(names.iter().zip(&sines).map(|(name, bend)| Case { name, bend, sensor: &perfect }));
    all.push(Case { name: "drift of 5 cm a step", bend: &drift, sensor: &perfect });
    let faulty = |name, sensor| Case { name, bend: &straight, sensor };
    let names = ["stuck from label 1", "stuck from label 5", "stuck from label 10"];
    all.extend(names.iter().zip(&stuck).map(|(name, it)| faulty(name, it as &Sensor)));
    let names = ["inverted from label 1", "inverted from label 5", "inverted from label 10"];
    all.extend(names.iter().zip(&inverted).map(|(name, it)| faulty(name, it as &Sensor)));
    all.push(faulty("garbage", &garbage));
    let names = ["one sample late", "two samples late"];
    all.extend(names.iter().zip(&lates).map(|(name, it)| faulty(name, it as &Sensor)));
    for case in &all {
        print!("{:<24}", case.name);
        for planner in PLANNERS {
            let flown = fly_all(case, planner, fields);
            let wrong = percent(&flown, Flown::is_confidently_wrong);
            let silent = percent(&flown, |it| it.is_confidently_wrong() && it.is_silent());
            print!("  {wrong:>5.1} {silent:>5.1}");
            if planner == PLANNERS[2] {
                let known = percent(&flown, |it| it.ended == Some(StopReason::Known));
                println!("  {known:>5.1}");
                // What is promised is kept.
                let lies = |it: &Flown| {
                    it.is_confidently_wrong()
                        && it.is_silent()
                        && it.ended == Some(StopReason::Known)
                };
                assert!(percent(&flown, lies) <= 2.5, "{}", case.name);
            }
            if case.name == "a straight line" {
                assert!(wrong < 0.1 && percent(&flown, |it| !it.is_silent()) <= 1.0);
            }
        }
    }
}

#[test]
fn an_audit_accuses_no_line_whatever_the_vehicle() {
    let case = Case { name: "a straight line", bend: &straight, sensor: &perfect };
    let shape = Shape {
        radius_mm: 1_000,
        shortest_mm: 200,
        turn_step_urad: 10_000,
        speeds: 20,
        speed_step_mm: 100,
    };
    let steps = Unicycle::new(10_000, 0.4, 20, 100).expect("steps");
    for (name, vehicle) in [
        ("unicycle", Algorithm::Lookahead.grid().into()),
        ("car", AnyVehicle::Car(Car::new(shape).expect("a car"))),
        ("boat", AnyVehicle::Boat(Boat::new(steps).expect("a boat"))),
    ] {
        for degrees in [2.0, 0.5, 0.1] {
            let fly = |number| {
                let field = Field::new(number, Algorithm::Lookahead, &case)?;
                let (area, goal) = (field.mission.config.area, slope_within(degrees));
                let labels = CAPACITY - 4;
                Some(match vehicle {
                    AnyVehicle::Unicycle(it) => {
                        field.fly(field.mission.lookahead(area, it).until(goal), labels)
                    }
                    AnyVehicle::Car(it) => {
                        field.fly(field.mission.lookahead(area, it).until(goal), labels)
                    }
                    AnyVehicle::Boat(it) => {
                        field.fly(field.mission.lookahead(area, it).until(goal), labels)
                    }
                })
            };
            let flown: Vec<_> = (0..cases(60, 3_334)).into_par_iter().filter_map(fly).collect();
            assert!(flown.iter().all(|it| !it.is_refused && it.ended != Some(StopReason::NoLine)));
            let known: Vec<_> =
                flown.iter().filter(|it| it.ended == Some(StopReason::Known)).collect();
            let mean =
                |k: usize| known.iter().map(|it| it.audit[k]).sum::<f64>() / known.len() as f64;
            let [labels, motions, metres] = [0, 1, 2].map(mean);
            println!(
                "{name}, {degrees} deg: {} of {} known; the audit took {labels:.1} labels, {motions:.1} motions, \
                 {metres:.1} m",
                known.len(),
                flown.len()
            );
            assert!(known.len() * 10 >= flown.len() * 9 && labels > 5.0);
        }
    }
}

/// Boundaries that bend or move a little: how many missions with a goal still end Known.
#[test]
fn bent_and_drifting_boundaries_are_refuted() {
    let share = |name, bend: &Bend, fields| {
        let case = Case { name, bend, sensor: &perfect };
        let flown = fly_all(&case, PLANNERS[2], fields);
        let known = percent(&flown, |it| it.ended == Some(StopReason::Known));
        println!("{name}: {known:.1} % of {} missions end Known", flown.len());
        known
    };
    for (name, height, most) in [
        ("bent by 0.1 m", 0.1, 80.0),
        ("bent by 0.25 m", 0.25, 1.0),
        ("bent by 0.5 m", 0.5, 0.0),
        ("bent by 1 m", 1.0, 0.0),
        ("bent by 2 m", 2.0, 1.0),
    ] {
        let bent = move |along: f64, _: u32| height * (1.0 - along * along / 100.0);
        assert!(share(name, &bent, cases(60, 300)) <= most);
    }
    let drifts = |_: f64, motion: u32| 0.05 * f64::from(motion);
    assert!(share("drifts by 5 cm a step", &drifts, cases(60, 200)) <= 1.0);
}

/// How a planner moves, and what its steps say.
fn stepped<P: Planner>(planner: P, field: &Field<'_>) -> Vec<(Site, Option<Alarm>)> {
    let (at, read) = (Cell::new(field.mission.start), RefCell::new(Vec::new()));
    let drive = |motion: &Motion| {
        at.set(motion.target);
        Ok::<_, Infallible>(motion.target)
    };
    let sense = || {
        read.borrow_mut().push(field.label(at.get().site, 0));
        let label = (field.case.sensor)(&read.borrow(), &mut ChaCha8Rng::seed_from_u64(0));
        Ok::<_, Infallible>(label)
    };
    let vehicle = Vehicle { drive: DriveFn(drive), sensor: SensorFn(sense) };
    let mut agent = Agent::new(planner, vehicle, field.mission.start);
    let mut steps = Vec::new();
    for _ in 0..20 {
        let event = agent.step();
        let Ok(Event::Step(step)) = event else { break };
        steps.push((step.pose.site, step.alarm));
    }
    steps
}

/// The evidence computed beside the mission reaches a warning and an alarm on the steps that say so, and on no others.
#[test]
fn steps_tell_of_a_warning_and_of_an_alarm() {
    let stuck = from(3, |_| Label::Positive);
    let case = Case { name: "stuck", bend: &straight, sensor: &stuck };
    let mut told = 0;
    for number in 0..40 {
        let Some(field) = Field::new(number, Algorithm::Cfc, &case) else { continue };
        let planner = || field.mission.cfc(field.mission.config.area, Unicycle::paper());
        let watched = stepped(Watched::new(planner()), &field);
        assert_eq!(watched, stepped(&mut Watched::new(planner()), &field));
        // Whoever does not watch moves alike, and is told nothing.
        let plain = stepped(planner(), &field);
        assert!(plain.iter().all(|(_, alarm)| alarm.is_none()));
        assert!(plain.iter().map(|it| it.0).eq(watched.iter().map(|it| it.0)), "{number}");
        // Beside it.
        let (mut alone, mut pose, mut read) = (planner(), field.mission.start, Vec::new());
        let (mut evidence, mut level) = (planner_core::watch::Evidence::NONE, 0);
        for (site, alarm) in watched {
            let Plan::Move(motion) = alone.plan(pose) else { panic!("it moved") };
            pose = motion.target;
            assert_eq!(pose.site, site);
            let label = motion.wants_label.then(|| {
                read.push(field.label(site, 0));
                stuck(&read, &mut ChaCha8Rng::seed_from_u64(0))
            });
            if let Some(label) = label {
                evidence.observe(label, alone.belief().chance_of(site, label));
            }
            alone.observe(pose, label.map(Into::into)).expect("it was taken in");
            let value = evidence.value();
            let now = i32::from(value >= 20.0) + i32::from(value >= 100.0);
            assert_eq!(alarm.is_some(), now > level, "{number}: {value}");
            assert!(alarm.is_none_or(|it| it.evidence.to_bits() == value.to_bits()));
            told += i32::from(alarm.is_some());
            level = now;
        }
    }
    assert!(told > 20, "{told}");
}

/// A mission that ended without a line is flown again with the tolerance that its result advises.
#[test]
fn the_tolerance_that_is_advised_covers_what_was_seen() {
    let fields = cases(15, 200);
    let again = |name: &'static str, bend: &Bend| {
        let case = Case { name, bend, sensor: &perfect };
        let fly = |number| {
            let mut field = Field::new(number, Algorithm::Lookahead, &case)?;
            let unicycle = Unicycle::from(Algorithm::Lookahead.grid());
            let (area, goal) = (field.mission.config.area, slope_within(0.5));
            let first = field.fly(field.mission.lookahead(area, unicycle).until(goal), 64);
            if first.ended != Some(StopReason::NoLine) {
                return None;
            }
            let metres = Explanation::of(&first.told()).covering(0.9)?;
            field.mission.config.tolerance = Tolerance::new(metres).expect("metres");
            let planner =
                Lookahead::new(area, unicycle, field.mission.lines()).expect("there is room");
            Some((metres, field.fly(planner.until(goal), 64)))
        };
        let flown: Vec<_> = (0..fields).into_par_iter().filter_map(fly).collect();
        let mut metres: Vec<_> = flown.iter().map(|it| it.0).collect();
        metres.sort_by(f64::total_cmp);
        let count = |is: fn(&Flown) -> bool| flown.iter().filter(|it| is(&it.1)).count();
        let refuted = count(|it| it.is_refused || it.ended == Some(StopReason::NoLine));
        let wrong = count(Flown::is_confidently_wrong);
        println!(
            "{name}: of {} missions flown again, with {:.2} m in the median, {refuted} end without a line, {wrong} are \
             confidently wrong",
            flown.len(),
            metres[metres.len() / 2]
        );
        assert!(10 * flown.len() as u64 >= 9 * fields);
        assert!(20 * (refuted + wrong) <= flown.len(), "{name}");
    };
    again("an arc of radius 100 m", &circle(100.0));
    again("an arc of radius 30 m", &circle(30.0));
    again("a sine of 1 m", &sine(1.0));
    again("a drift of 5 cm a step", &|_, motion| 0.05 * f64::from(motion));
}

/// The causes that results name, in the order of the table in docs/limits.md.
const CAUSES: [Cause; 9] = [
    Cause::Bend,
    Cause::Drift,
    Cause::Stuck,
    Cause::Inverted,
    Cause::StuckOrInverted,
    Cause::Late,
    Cause::Random,
    Cause::Line,
    Cause::Unclear,
];

/// What is said to explain the labels of missions that end without a line: the true cause or none, for the most part.
#[test]
fn explanations_are_right_or_none() {
    use Cause::{Bend, Drift, Inverted, Late, Random, Stuck, StuckOrInverted, Unclear};
    let fields = cases(60, 600);
    println!("missions without a line, %: said to be {CAUSES:?}");
    let mut named = [0, 0];
    let mut tell = |name: &'static str, bend: &self::Bend, sensor: &Sensor, right: &[Cause]| {
        let case = Case { name, bend, sensor };
        let flown = fly_all(&case, PLANNERS[2], fields);
        let refuted = flown.iter().filter(|it| it.ended == Some(StopReason::NoLine));
        let told: Vec<_> = refuted.map(Flown::cause).collect();
        let share = |cause| {
            100.0 * told.iter().filter(|it| **it == cause).count() as f64 / told.len() as f64
        };
        let shares = CAUSES.map(|cause| format!("{:>3.0}", share(cause)));
        println!("{name:<24} {:>5}: {}", told.len(), shares.join(" "));
        let said = told.iter().filter(|it| **it != Unclear);
        let [ours, all] = [said.clone().filter(|it| right.contains(it)).count(), said.count()];
        named = [named[0] + ours, named[1] + all];
        assert!(
            20 * (all - ours) <= 3 * told.len().max(20),
            "{name}: {all} named, {ours} of them rightly"
        );
    };
    for (name, radius) in [
        ("an arc of radius 100 m", 100.0),
        ("an arc of radius 50 m", 50.0),
        ("an arc of radius 30 m", 30.0),
        ("an arc of radius 20 m", 20.0),
    ] {
        tell(name, &circle(radius), &perfect, &[Bend]);
    }
    for (name, height) in [("a sine of 0.5 m", 0.5), ("a sine of 1 m", 1.0), ("a sine of 2 m", 2.0)]
    {
        tell(name, &sine(height), &perfect, &[Bend]);
    }
    for (name, metres) in [("a drift of 1 cm", 0.01), ("a drift of 5 cm", 0.05)] {
        tell(name, &move |_: f64, motion: u32| metres * f64::from(motion), &perfect, &[Drift]);
    }
    // What a stuck sensor reads, and an inverted one, is the same as long as the planner goes where both agree.
    let faults = [Stuck, Inverted, StuckOrInverted];
    for (name, first) in [("stuck from 1", 1), ("stuck from 5", 5), ("stuck from 10", 10)] {
        tell(name, &straight, &from(first, |_| Label::Positive), &faults);
    }
    for (name, first) in [("inverted from 1", 1), ("inverted from 5", 5), ("inverted from 10", 10)]
    {
        tell(name, &straight, &from(first, |label| -label), &faults);
    }
    tell("labels at random", &straight, &garbage, &[Random]);
    for (name, by) in [("one sample late", 1), ("two samples late", 2)] {
        tell(name, &straight, &late(by), &[Late]);
    }
    let wrong = |labels: &[Label], rng: &mut ChaCha8Rng| {
        let label = perfect(labels, rng);
        if rng.random_bool(0.1) { -label } else { label }
    };
    tell("one label in ten wrong", &straight, &wrong, &[Random]);
    let [ours, all] = named;
    println!("{all} causes named, {:.1} % of them rightly", 100.0 * ours as f64 / all as f64);
    assert!(10 * ours >= 9 * all && all > 100);
}
