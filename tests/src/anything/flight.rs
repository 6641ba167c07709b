//! Flies a mission and checks what must hold of any: see [`Finding`].

use std::collections::HashMap;

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::given::Lines;
use host_sim::mission::read_out::ReadOut;
use host_sim::mission::results::Ending;
use host_sim::world::errors::{CUT, Errors};
use planner_core::dynamics::Dynamics;
use planner_core::error::ObservationError;
use planner_core::parts::LOOKED_AT;
use planner_core::{
    AnyVehicle, Belief as _, Certainty, Motion, Persist, Plan, Planner, Pose, Sample, StopReason,
    Tolerance, VersionSpace, Workspace as _,
};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::counted::{self, Counted};
use super::plain::{Ground, metres, path};
use super::reason::{place, refute};
use crate::ensemble;

/// Motions without a label, one after the other, after which a mission counts as endless, besides those that it takes
/// to go round the area.
const FRUITLESS: u32 = 150;

/// What a mission broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finding {
    /// It goes on without learning anything.
    Endless,
    /// A motion without a label undid the one before.
    Undone,
    /// A motion led outside, or into a keep-out.
    Unsafe,
    /// The true line was cut off, a true label was refused, or what is certain is false.
    TruthLost,
    /// The reason to stop is false.
    FalseReason,
    /// A plan took more than its stated work.
    TooLong,
    /// A planner that was asked twice gave two plans, or another plan after a sleep.
    Fickle,
}

/// How a mission went.
#[derive(Debug)]
pub struct Flight {
    /// How it ended.
    pub ending: Ending,
    /// Motions made.
    pub motions: u32,
    /// Labels taken.
    pub labels: u32,
    /// The most that a plan asked of the area.
    pub asked: u64,
    /// What it broke, once each.
    pub findings: Vec<(Finding, String)>,
}

/// A planner whose state is saved to bytes and restored.
pub trait Sleeper: Persist<Snapshot: Serialize + DeserializeOwned> {}

impl<P: Persist<Snapshot: Serialize + DeserializeOwned>> Sleeper for P {}

/// What is kept of a planner while the power is off.
///
/// # Panics
/// When it is more than a page of 64 kB.
pub fn bytes_of(value: &impl Serialize) -> Vec<u8> {
    let mut page = vec![0; 1 << 16];
    postcard::to_slice(value, &mut page).expect("room").to_vec()
}

/// Saves a planner to bytes, and restores it as another one.
///
/// # Panics
/// When the bytes are refused, or are others after the sleep.
pub fn sleep<P: Sleeper>(planner: P, make: &impl Fn() -> P) -> P {
    let bytes = bytes_of(&planner.snapshot());
    drop(planner);
    let mut woken = make();
    let snapshot = postcard::from_bytes(&bytes).expect("what was written");
    woken.restore(&snapshot).expect("its own snapshot");
    assert!(bytes_of(&woken.snapshot()) == bytes, "the snapshot of what was restored");
    woken
}

/// Flies a mission with a vehicle. `most_asked` is the most that a plan may ask of the area.
///
/// # Panics
/// When a planner panics.
pub fn fly<D: Dynamics + Copy>(mission: &Mission, vehicle: D, most_asked: u64) -> Flight {
    let area = Counted(mission.terrain());
    let fly = Fly { mission, vehicle, ground: Ground::of_mission(mission), most_asked };
    match (mission.algorithm, mission.is_noisy()) {
        _ if mission.begins_from_nothing() => {
            let (mut flight, seek, pose) = fly.flown(|| mission.seek(vehicle));
            fly.judge_lent(&mut flight, seek.given(), seek.belief().tolerance());
            if seek.given().is_empty() {
                fly.judge(&mut flight, seek.belief(), pose);
            }
            flight
        }
        (Algorithm::Cfc, _) => fly.with(|| mission.cfc(area, vehicle)),
        (Algorithm::Scc, _) => fly.with(|| mission.scc(area, vehicle)),
        (Algorithm::Track, _) => match mission.watch {
            Some(metres) => fly.with(|| mission.guard(area, vehicle, metres)),
            None => fly.with(|| mission.track(area, vehicle)),
        },
        (_, true) => fly.with(|| mission.doubtful(area, vehicle)),
        (_, false) => fly.with(|| mission.lookahead(area, vehicle)),
    }
}

struct Fly<'a, D> {
    mission: &'a Mission,
    vehicle: D,
    ground: Ground,
    most_asked: u64,
}

impl<D: Dynamics> Fly<'_, D> {
    fn with<P>(&self, make: impl Fn() -> P) -> Flight
    where
        P: Sleeper<Belief: ReadOut + Sized>,
    {
        let (mut flight, planner, pose) = self.flown(make);
        self.judge(&mut flight, planner.belief(), pose);
        flight
    }

    /// Flies it. In every third mission a second planner sleeps after every fourth plan and every motion.
    fn flown<P>(&self, make: impl Fn() -> P) -> (Flight, P, Pose)
    where
        P: Sleeper<Belief: ReadOut + Sized>,
    {
        let mission = self.mission;
        let (mut robot, mut rng) = (mission.robot(), ensemble::rng(mission.seed, 1));
        let (mut planner, mut pose) = (make(), mission.start);
        let mut sleeper = mission.seed.is_multiple_of(3).then(&make);
        let mut flight = Flight::at_start();
        let (mut been, mut fruitless, mut before) = (HashMap::new(), 0, None::<(Pose, Motion)>);
        while flight.motions < mission.steps {
            counted::asked();
            let plan = planner.plan(pose);
            let asked = counted::asked();
            flight.asked = flight.asked.max(asked);
            if asked > self.most_asked {
                flight.note(Finding::TooLong, format!("{asked} asked at {pose:?}"));
            }
            let is_fourth = flight.motions.is_multiple_of(4);
            let again = is_fourth.then(|| planner.plan(pose));
            let asleep = sleeper.as_mut().map(|it| it.plan(pose));
            if again.is_some_and(|it| it != plan) || asleep.is_some_and(|it| it != plan) {
                flight.note(Finding::Fickle, format!("{again:?} or {asleep:?} at {pose:?}"));
            }
            sleeper = sleeper.map(|it| if is_fourth { sleep(it, &make) } else { it });
            let motion = match plan {
                Plan::Move(motion) => motion,
                Plan::Stop(reason) => {
                    flight.ending = Ending::Stopped(reason);
                    break;
                }
            };
            self.check(&mut flight, (pose, &motion), before);
            // A way to a place that ends on certain ground leads back once: no other is begun before the next label.
            let times = been.entry((pose.site, pose.heading.0)).or_insert(0);
            *times += 1;
            // A follower of fronts goes to places far off too. One of 5,000 missions needs the second return.
            let goes_far = mission.asking.price.is_some() || self.looks();
            let most = 1 + u32::from(goes_far);
            // Where no label is worth it, sixteen motions without one may lead round.
            let most = if mission.asking.worth > 0.0 { most + 16 } else { most };
            if *times > most && mission.errors == Errors::default() {
                flight
                    .note(Finding::Endless, format!("at {pose:?} again after {fruitless} motions"));
                break;
            }
            before = Some((pose, motion));
            let mut passed = Vec::new();
            let reading = robot.travel(&motion, &mut pose, mission.way(), &mut |it| {
                passed.extend(it.reading.map(|reading| (it.reported, reading)));
            });
            flight.motions += 1;
            fruitless += 1;
            if reading.is_some() {
                (fruitless, flight.labels) = (0, flight.labels + 1);
                been.clear();
            }
            if fruitless > self.fruitless() {
                flight.note(Finding::Endless, format!("{fruitless} motions without a label"));
                break;
            }
            let mut observed = Ok(());
            for (site, read) in passed {
                let heard = planner.observe_on_the_way(site, read);
                if let Some(it) = &mut sleeper {
                    assert_eq!(heard, it.observe_on_the_way(site, read));
                }
                if heard == Ok(true) {
                    fruitless = 0;
                    been.clear();
                }
                observed = observed.and(heard.map(|_| ()));
            }
            let heard = planner.observe(pose, reading);
            if let Some(it) = &mut sleeper {
                assert_eq!(heard, it.observe(pose, reading));
            }
            if let Err(refused) = observed.and(heard) {
                if self.errs_within_tolerance()
                    || !matches!(refused, ObservationError::Contradiction(_))
                {
                    flight.note(Finding::TruthLost, format!("{refused}"));
                }
                break;
            }
            sleeper = sleeper.map(|it| sleep(it, &make));
            if let Some(space) = planner.belief().version_space()
                && let Some(wrong) = self.denies_truth(space, &mut rng)
            {
                flight.note(Finding::TruthLost, wrong);
            }
        }
        (flight, planner, pose)
    }

    /// Motions without a label, one after the other, that a mission may make.
    fn fruitless(&self) -> u32 {
        let bounds = self.mission.config.area.bounds();
        let [from, to] = [bounds.min(), bounds.max()].map(metres);
        let grid = self.vehicle.grid();
        let round = 2.0 * (to - from).sum();
        FRUITLESS + (round / f64::from(grid.reach_m(grid.speeds() - 1))) as u32
    }

    /// Whether a motion from a pose, after the one before, is as it should be.
    fn check(
        &self,
        flight: &mut Flight,
        (pose, motion): (Pose, &Motion),
        before: Option<(Pose, Motion)>,
    ) {
        if let Some(wrong) = self.leaves(pose, motion) {
            flight.note(Finding::Unsafe, wrong);
        }
        let is_safe = |pose| self.vehicle.is_safe(pose, &self.mission.terrain());
        let gives_up = is_safe(pose) && !is_safe(motion.target);
        let is_strict = self.mission.config.tolerance == Tolerance::NONE;
        if gives_up && is_strict || self.vehicle.target(pose, motion.action) != Some(motion.target)
        {
            flight.note(Finding::Unsafe, format!("{motion:?} from {pose:?}"));
        }
        if self.looks() && motion.examined > LOOKED_AT {
            flight.note(Finding::TooLong, format!("{motion:?}"));
        }
        if let Some((from, last)) = before
            && !last.wants_label
            && !motion.wants_label
            && is_same(from, motion.target)
        {
            flight.note(Finding::Undone, format!("{last:?}, then {motion:?}"));
        }
    }

    /// What a version space says that is false, if anything.
    fn denies_truth(&self, space: &Lines, rng: &mut ChaCha8Rng) -> Option<String> {
        let world = &self.mission.world;
        if self.mission.noise.is_some() || !self.errs_within_tolerance() {
            return None;
        }
        let truth = world.line()?;
        let q = place(self.mission.config.area.bounds(), rng);
        if let Certainty::Certain(label) = space.certainty(q)
            && !world.agrees(q, label)
        {
            return Some(format!("certain of {label:?} at {q:?}"));
        }
        let (angle, arcs) = (truth.angle_deg(), space.slope_arc().intervals_deg());
        if !arcs.iter().any(|[from, to]| (from - 1e-9..=to + 1e-9).contains(&angle)) {
            return Some(format!("{angle} is not in {arcs:?}"));
        }
        let (range, c) = (space.intercepts()?, truth.intercept()?);
        let slack = 1e-9 * (1.0 + c.abs());
        let is_in = (range[0] - slack..=range[1] + slack).contains(&c);
        (!is_in).then(|| format!("{c} is not in {range:?}"))
    }

    /// Whether the end is as it should be.
    fn judge(&self, flight: &mut Flight, belief: &dyn ReadOut, pose: Pose) {
        let mission = self.mission;
        if let Some(space) = belief.version_space()
            && mission.noise.is_none()
            && self.errs_within_tolerance()
            && mission.world.is_among(space.lines()) == Some(false)
        {
            flight.note(Finding::TruthLost, "the true line is cut off".to_owned());
        }
        if let Some(wrong) = refute(mission, &self.vehicle, belief, pose, flight.ending) {
            flight.note(Finding::FalseReason, format!("{:?}: {wrong}", flight.ending));
        }
    }

    /// Whether the labels that a search from nothing lends leave lines. True ones leave the true line.
    fn judge_lent(&self, flight: &mut Flight, given: &[Sample], tolerance: Tolerance) {
        if given.is_empty() != (flight.ending != Ending::Stopped(StopReason::Known)) {
            flight.note(Finding::FalseReason, format!("{:?} with {given:?}", flight.ending));
        } else if !given.is_empty() {
            let uncertain: Vec<_> = given.iter().map(|it| (*it, tolerance)).collect();
            let lines = if self.mission.noise.is_none() && tolerance != Tolerance::NONE {
                VersionSpace::<32>::of_uncertain(&uncertain)
            } else {
                VersionSpace::new(given)
            };
            let is_true = |it: &Sample| self.mission.world.agrees(it.site, it.label);
            let are_true = |lines: &VersionSpace<32>| lines.samples().iter().all(is_true);
            let may_err = self.mission.noise.is_some() || !self.errs_within_tolerance();
            if !lines.is_ok_and(|lines| may_err || are_true(&lines)) {
                flight.note(Finding::TruthLost, format!("it lends {given:?}"));
            }
        }
    }

    /// Whether its planner looks at places all over the area.
    fn looks(&self) -> bool {
        self.mission.algorithm == Algorithm::Track || self.mission.begins_from_nothing()
    }

    fn errs_within_tolerance(&self) -> bool {
        CUT * self.mission.errors.position <= self.mission.config.tolerance.metres() + 1e-9
    }

    /// How a motion that begins inside leaves the ground, if it does.
    fn leaves(&self, from: Pose, motion: &Motion) -> Option<String> {
        let is_car = matches!(self.mission.vehicle, AnyVehicle::Car(_));
        // An arc's end is rounded to the lattice, and its control to single precision.
        let reach = f64::from(motion.control.distance_m.abs());
        let slack = 1e-4 + if is_car { 3e-6 * reach } else { 0.0 };
        if self.ground.margin(metres(from.site)) < -1e-9 {
            return None;
        }
        let control = [motion.control.distance_m, motion.control.turn_rad].map(f64::from);
        let way = path(from, motion.target, control, is_car, 200);
        let worst = way.into_iter().map(|p| self.ground.margin(p)).fold(f64::INFINITY, f64::min);
        (worst < -slack).then(|| format!("{worst} m inside: {from:?}, {motion:?}"))
    }
}

impl Flight {
    fn at_start() -> Self {
        let (ending, findings) = (Ending::Steps, Vec::new());
        Self { ending, motions: 0, labels: 0, asked: 0, findings }
    }

    fn note(&mut self, finding: Finding, text: String) {
        if self.findings.iter().all(|(known, _)| *known != finding) {
            self.findings.push((finding, text));
        }
    }
}

fn is_same(a: Pose, b: Pose) -> bool {
    let [p, q] = [a.site, b.site].map(metres);
    let turned = (a.heading.0.wrapping_sub(b.heading.0) as i32).unsigned_abs();
    (p - q).norm() < 1e-3 && turned < 1 << 20
}
