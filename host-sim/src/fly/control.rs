//! A vehicle at the other end of a link, as a body: it is waited for, makes motions, and is brought to rest.

use std::time::Duration;

use anyhow::anyhow;
use nalgebra::Point2;
use planner_core::robot::Body;
use planner_core::{Motion, Pose, Reading, Site};

use crate::fly::by_hand::ByHandNews;
use crate::fly::failure::Failure;
use crate::fly::frame::Local;
use crate::fly::link::Link;
use crate::fly::orders::Order;
use crate::fly::pilot::Pilot;
use crate::mission::definition::Mission;
use crate::mission::legs::Leg;
use crate::mission::recording::refusal;
use crate::mission::scenario::{Room, check_steps};
use crate::mission::terrain::{Terrain, check_inside};
use crate::output::notes::announce;
use crate::report::live::Live;

/// How long a round waits for a message before it sends what is due.
const ROUND: Duration = Duration::from_millis(20);

/// The most messages that a round takes in before it sends what is due.
const MOST_WAITING: usize = 1000;

/// How long something must be missing before the user is told so.
const PATIENCE: Duration = Duration::from_secs(1);

/// A vehicle at the other end of a link: a body like any other.
pub struct Control<L> {
    link: L,
    pub(super) pilot: Pilot,
    interrupted: fn() -> Option<i32>,
    local: Local,
    /// Where it may be.
    area: Option<Terrain>,
    /// The motions so far, and the time from which theirs are counted.
    pub(super) legs: Vec<Leg>,
    began: Duration,
    /// What was read on the way of the last motion.
    pub(super) passed: Vec<(Site, Reading)>,
}

impl<L: Link> Control<L> {
    /// A pilot at a link; `interrupted` returns the signal that is to end the program, if one arrived.
    pub fn new(link: L, pilot: Pilot, interrupted: fn() -> Option<i32>) -> Self {
        let (legs, passed, local) = (Vec::new(), Vec::new(), Local::default());
        Self { link, pilot, interrupted, local, area: None, legs, began: Duration::ZERO, passed }
    }

    /// The link.
    pub const fn link(&self) -> &L {
        &self.link
    }

    /// Takes in the messages that have arrived, then sends what is due. Messages wait while the planner computes.
    fn round(&mut self) {
        if let Some(signal) = (self.interrupted)() {
            self.pilot.end(self.link.now(), Some(Failure::Interrupted(signal)));
        }
        let mut until = self.link.now() + ROUND;
        for _ in 0..MOST_WAITING {
            match self.link.receive(until) {
                Ok(Some((header, message))) => self.pilot.hear(self.link.now(), header, &message),
                Ok(None) => break,
                Err(error) => {
                    self.pilot.give_up(self.link.now(), Failure::Broken(error.to_string()));
                    break;
                }
            }
            until = self.link.now();
        }
        for message in self.pilot.due(self.link.now()) {
            self.link.send(&message);
        }
    }

    /// Waits until the vehicle is ready to be flown, and prints what is missing. The mission gets what is read meanwhile.
    pub(super) fn prepare(
        &mut self,
        mission: &mut Mission,
        mut live: Option<&mut Live>,
    ) -> Result<(), Failure> {
        let (mut awaited, mut since, mut is_said) = (None, self.link.now(), false);
        while !self.pilot.is_ready() {
            if let Some(failure) = self.pilot.failure() {
                return Err(failure.clone());
            }
            let now = self.link.now();
            let missing = self.pilot.missing(now);
            if missing != awaited {
                (awaited, since, is_said) = (missing, now, false);
            }
            if let Some(awaited) = awaited.as_ref().filter(|_| !is_said && now >= since + PATIENCE)
            {
                announce(format_args!("waiting for {awaited}"));
                if let Some(live) = &live {
                    live.say(format_args!("waiting for {awaited}"));
                }
                is_said = true;
            }
            self.round();
            for news in self.pilot.take_by_hand() {
                let said = self.read_by_hand(mission, news);
                announce(&said);
                if let Some(live) = &mut live {
                    live.begin(&self.standing(mission));
                    live.say(said);
                }
            }
        }
        Ok(())
    }

    /// Takes in what came of the operator's driving; what to say of it.
    fn read_by_hand(&self, mission: &mut Mission, news: ByHandNews) -> String {
        let ByHandNews::Label(at, label) = news else {
            let dropped = std::mem::take(&mut mission.read_before).len();
            return format!(
                "its positions count from elsewhere now: labels by hand are dropped, {dropped} of them"
            );
        };
        let local = Local::of(mission.lake.as_deref(), self.pilot.origin());
        let Some(site) = local.site(at) else { return Failure::LatticeError.to_string() };
        let (sign, place) = (label.sign(), place(mission, site));
        let mut take = || {
            check_inside("its position", site, &mission.terrain())?;
            let read = mission.given.samples().len() + mission.read_before.len() + 1;
            let room = Room::of(mission.is_noisy(), &mission.asking, mission.audits);
            check_steps("steps", mission.steps, read, room)?;
            let after = mission.clone().having_read(&[(site, label.into())]);
            *mission = after.map_err(|(_, why)| anyhow!(refusal(&why)))?;
            anyhow::Ok(mission.read_before.len())
        };
        match take() {
            Ok(number) => format!("label {number} by hand: {sign:+} at {place}"),
            Err(why) => format!("a label by hand is left out, {sign:+} at {place}: {why:#}"),
        }
    }

    /// The mission as it would begin where the vehicle is.
    fn standing(&self, mission: &Mission) -> Mission {
        let local = Local::of(mission.lake.as_deref(), self.pilot.origin());
        let pose = self.pilot.whereabouts();
        let pose = pose.and_then(|(fix, yaw)| local.pose(mission.start, fix.at, yaw));
        Mission { start: pose.unwrap_or(mission.start), ..mission.clone() }
    }

    /// Where the mission begins: where the vehicle is.
    pub(super) fn start(&mut self, mission: &Mission) -> Result<Pose, Failure> {
        let (fix, yaw) = self.pilot.whereabouts().ok_or(Failure::LatticeError)?;
        self.local = Local::of(mission.lake.as_deref(), self.pilot.origin());
        let pose = self.local.pose(mission.start, fix.at, yaw).ok_or(Failure::LatticeError)?;
        self.area = Some(mission.terrain());
        self.began = self.link.now();
        self.check(pose)?;
        let [at, start] = [pose.site, mission.start.site].map(Point2::<f64>::from);
        announce(format_args!(
            "ready at {}, {:.2} m from the scenario's start: the mission begins here",
            place(mission, pose.site),
            (at - start).norm()
        ));
        Ok(pose)
    }

    /// Whether the vehicle is where it may be.
    fn check(&self, pose: Pose) -> Result<(), Failure> {
        let inside =
            self.area.map_or(Ok(()), |area| check_inside("its position", pose.site, &area));
        inside.map_err(|error| Failure::Misplaced(error.to_string()))
    }

    /// Brings the vehicle to rest, whatever has happened.
    pub(super) fn end(&mut self, failure: Option<Failure>) {
        self.pilot.end(self.link.now(), failure);
        while !self.pilot.is_over() {
            self.round();
        }
    }
}

impl<L: Link> Body for Control<L> {
    type Error = Failure;

    fn perform(&mut self, motion: &Motion, pose: &mut Pose) -> Result<Option<Reading>, Failure> {
        self.perform_reading(motion, pose, &mut |_, _| ())
    }

    fn perform_reading(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        tell: &mut dyn FnMut(Site, Reading),
    ) -> Result<Option<Reading>, Failure> {
        self.passed.clear();
        let Motion { target, wants_label, .. } = *motion;
        let order = Order {
            to: self.local.ned(target.site).ok_or(Failure::LatticeError)?,
            yaw: self.local.yaw(target),
            is_turn: target.site == pose.site,
        };
        let began = self.link.now();
        self.pilot.order(began, order, wants_label);
        loop {
            for (at, label) in self.pilot.take_passed() {
                let site = self.local.site(at).ok_or(Failure::LatticeError)?;
                self.passed.push((site, label.into()));
                tell(site, label.into());
            }
            if let Some(arrival) = self.pilot.take_arrival() {
                let reached = self.local.pose(target, arrival.fix.at, arrival.yaw);
                *pose = reached.ok_or(Failure::LatticeError)?;
                // Within the acceptance it is not checked: motions keep a margin for that, or the user was warned.
                if arrival.is_short {
                    self.check(*pose)?;
                }
                let seconds = |at: Duration| millis(at.saturating_sub(self.began).as_secs_f64());
                let (began, ended) = (seconds(began), seconds(self.link.now()));
                self.legs.push(Leg {
                    began,
                    ended,
                    off: millis(arrival.fix.at.distance(order.to)),
                });
                return Ok(arrival.label.map(Reading::Side));
            }
            if let Some(failure) = self.pilot.failure() {
                return Err(failure.clone());
            }
            self.round();
        }
    }
}

/// A place in the scenario's terms.
fn place(mission: &Mission, site: Site) -> String {
    let at = Point2::from(site);
    match mission.lake.as_ref().map(|it| it.frame.on_globe(at)) {
        Some(Ok([lat, lon])) => format!("lat = {lat:.7}, lon = {lon:.7}"),
        _ => format!("x = {:.2}, z = {:.2}", at.x, at.y),
    }
}

/// Rounds to thousandths.
fn millis(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}
