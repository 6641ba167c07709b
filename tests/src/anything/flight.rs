//! Flies a mission and checks what must hold of any: see [`Finding`].

use std::collections::HashMap;

use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::read_out::ReadOut;
use host_sim::mission::results::Ending;
use host_sim::world::errors::{CUT, Errors};
use planner_core::error::ObservationError;
use planner_core::{AnyVehicle, Motion, Plan, Planner, Pose};

use super::counted::{self, Counted};
use super::plain::{Ground, metres, path};
use super::reason::refute;

/// Motions without a label, one after the other, after which a mission counts as endless.
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
    /// The true line was cut off, or a true label was refused.
    TruthLost,
    /// The reason to stop is false.
    FalseReason,
    /// A plan took more than its stated work.
    TooLong,
    /// A planner that was asked twice gave two plans.
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

/// Flies a mission. `most_asked` is the most that a plan may ask of the area.
///
/// # Panics
/// When a planner panics.
pub fn fly(mission: &Mission, most_asked: u64) -> Flight {
    let (area, vehicle) = (Counted(mission.config.area), mission.vehicle);
    let fly = Fly { mission, ground: Ground::of(&mission.config.area), most_asked };
    match (mission.algorithm, mission.is_noisy()) {
        (Algorithm::Cfc, _) => fly.with(mission.cfc(area, vehicle)),
        (Algorithm::Scc, _) => fly.with(mission.scc(area, vehicle)),
        (Algorithm::Track, _) => match mission.watch {
            Some(metres) => fly.with(mission.guard(area, vehicle, metres)),
            None => fly.with(mission.track(area, vehicle)),
        },
        (_, true) => fly.with(mission.doubtful(area, vehicle)),
        (_, false) => fly.with(mission.lookahead(area, vehicle)),
    }
}

struct Fly<'a> {
    mission: &'a Mission,
    ground: Ground,
    most_asked: u64,
}

impl Fly<'_> {
    fn with<P: Planner<Belief: ReadOut + Sized>>(&self, mut planner: P) -> Flight {
        let mission = self.mission;
        let mut robot = mission.robot();
        let mut pose = mission.start;
        let mut flight =
            Flight { ending: Ending::Steps, motions: 0, labels: 0, asked: 0, findings: vec![] };
        let (mut been, mut fruitless, mut before) = (HashMap::new(), 0, None::<(Pose, Motion)>);
        while flight.motions < mission.steps {
            counted::asked();
            let plan = planner.plan(pose);
            let asked = counted::asked();
            flight.asked = flight.asked.max(asked);
            if asked > self.most_asked {
                flight.note(Finding::TooLong, format!("{asked} asked at {pose:?}"));
            }
            if flight.motions.is_multiple_of(4) && planner.plan(pose) != plan {
                flight.note(Finding::Fickle, format!("another plan when asked twice at {pose:?}"));
            }
            let motion = match plan {
                Plan::Move(motion) => motion,
                Plan::Stop(reason) => {
                    flight.ending = Ending::Stopped(reason);
                    break;
                }
            };
            if let Some(wrong) = self.leaves(pose, &motion) {
                flight.note(Finding::Unsafe, wrong);
            }
            if let Some((from, last)) = before
                && !last.wants_label
                && !motion.wants_label
                && is_same(from, motion.target)
            {
                flight.note(Finding::Undone, format!("{last:?}, then {motion:?}"));
            }
            // A way to a place that ends on certain ground leads back once: no other is begun before the next label.
            let times = been.entry((pose.site, pose.heading.0)).or_insert(0);
            *times += 1;
            // A follower of fronts goes to places far off too. One of 5,000 missions needs the second return.
            let goes_far = mission.asking.price.is_some() || mission.algorithm == Algorithm::Track;
            let most = 1 + u32::from(goes_far);
            // Where no label is worth it, sixteen motions without one may lead round.
            let most = if mission.asking.worth > 0.0 { most + 16 } else { most };
            if *times > most && mission.errors == Errors::default() {
                flight
                    .note(Finding::Endless, format!("at {pose:?} again after {fruitless} motions"));
                break;
            }
            before = Some((pose, motion));
            let Ok(reading) = robot.perform(&motion, &mut pose);
            flight.motions += 1;
            fruitless += 1;
            if reading.is_some() {
                (fruitless, flight.labels) = (0, flight.labels + 1);
                been.clear();
            }
            if fruitless > FRUITLESS {
                flight.note(Finding::Endless, format!("{fruitless} motions without a label"));
                break;
            }
            if let Err(refused) = planner.observe(pose, reading) {
                if self.errs_within_tolerance()
                    || !matches!(refused, ObservationError::Contradiction(_))
                {
                    flight.note(Finding::TruthLost, format!("{refused}"));
                }
                break;
            }
        }
        let belief = planner.belief();
        if let Some(space) = belief.version_space()
            && mission.noise.is_none()
            && self.errs_within_tolerance()
            && mission.world.is_among(space.lines()) == Some(false)
        {
            flight.note(Finding::TruthLost, "the true line is cut off".to_owned());
        }
        if let Some(wrong) = refute(mission, belief, pose, flight.ending) {
            flight.note(Finding::FalseReason, format!("{:?}: {wrong}", flight.ending));
        }
        flight
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
    fn note(&mut self, finding: Finding, text: String) {
        if self.findings.iter().all(|(known, _)| *known != finding) {
            self.findings.push((finding, text));
        }
    }
}

fn is_same(a: Pose, b: Pose) -> bool {
    let [p, q] = [a.site, b.site].map(metres);
    let turned = (a.heading.0.wrapping_sub(b.heading.0) as i32).unsigned_abs();
    (p[0] - q[0]).hypot(p[1] - q[1]) < 1e-3 && turned < 1 << 20
}
