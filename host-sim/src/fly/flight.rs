//! A mission that a vehicle flies: the planner's loop around a pilot and a link.

use std::time::Duration;

use nalgebra::Point2;
use planner_core::robot::AgentError;
use planner_core::robot::Body;
use planner_core::{Agent, Event, Motion, Planner as _, Pose, Reading, Site};

use crate::fly::failure::Failure;
use crate::fly::frame::Local;
use crate::fly::link::Link;
use crate::fly::orders::Order;
use crate::fly::pilot::Pilot;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::legs::{Leg, Legs};
use crate::mission::recording::{Recorder, Recording};
use crate::mission::results::Ending;
use crate::mission::terrain::{Terrain, check_inside};
use crate::output::notes::{announce, count, warn};
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
    pilot: Pilot,
    interrupted: fn() -> Option<i32>,
    local: Local,
    /// Where it may be.
    area: Option<Terrain>,
    /// The motions so far, and the time from which theirs are counted.
    legs: Vec<Leg>,
    began: Duration,
    /// What was read on the way of the last motion.
    passed: Vec<(Site, Reading)>,
}

/// A mission that was flown, as far as it went.
pub struct Flight {
    /// The mission as it went.
    pub recording: Recording,
    /// Why it went no further, and what became of the vehicle.
    pub failure: Option<(Failure, String)>,
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

    /// Waits until the vehicle is ready to be flown, and prints what is missing.
    fn prepare(&mut self, live: Option<&Live>) -> Result<(), Failure> {
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
                if let Some(live) = live {
                    live.say(format_args!("waiting for {awaited}"));
                }
                is_said = true;
            }
            self.round();
        }
        Ok(())
    }

    /// Where the mission begins: where the vehicle is.
    fn start(&mut self, mission: &Mission) -> Result<Pose, Failure> {
        let (fix, yaw) = self.pilot.whereabouts().ok_or(Failure::LatticeError)?;
        self.local = Local::of(mission.lake.as_deref(), self.pilot.origin());
        let pose = self.local.pose(mission.start, fix.at, yaw).ok_or(Failure::LatticeError)?;
        self.area = Some(mission.terrain());
        self.began = self.link.now();
        self.check(pose)?;
        let [at, start] = [pose.site, mission.start.site].map(Point2::<f64>::from);
        let place = match mission.lake.as_ref().map(|it| it.frame.on_globe(at)) {
            Some(Ok([lat, lon])) => format!("lat = {lat:.7}, lon = {lon:.7}"),
            _ => format!("x = {:.2}, z = {:.2}", at.x, at.y),
        };
        announce(format_args!(
            "ready at {place}, {:.2} m from the scenario's start: the mission begins here",
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
    fn end(&mut self, failure: Option<Failure>) {
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

/// Rounds to thousandths.
fn millis(number: f64) -> f64 {
    (number * 1e3).round() / 1e3
}

/// Prints how near to its targets the vehicle came, unless it reached each of them exactly.
fn tell(Legs { motions, seconds, off, off_most, tolerance }: &Legs) {
    if *off_most > 0.0 {
        announce(format_args!(
            "{motions} motions, {seconds:.1} s each in the median. It came to rest {off:.2} m from where it was sent, \
             {off_most:.2} m at most. A tolerance of {tolerance:.1} m covers that; add what its position errs by."
        ));
    }
}

/// Flies a mission.
///
/// # Errors
/// Why the flight did not begin. No setpoint was sent then.
pub fn fly<L: Link>(mission: Mission, control: &mut Control<L>) -> Result<Flight, Failure> {
    fly_shown(mission, control, None)
}

/// The same, shown on a live page, if there is one.
///
/// # Errors
/// As [`fly`].
pub fn fly_shown<L: Link>(
    mut mission: Mission,
    control: &mut Control<L>,
    mut live: Option<&mut Live>,
) -> Result<Flight, Failure> {
    if mission.lake.is_some() {
        control.pilot.wants_origin();
    }
    control.prepare(live.as_deref())?;
    mission.start = control.start(&mission)?;
    if let Some(live) = &mut live {
        live.begin(&mission);
        live.say("the mission began where the vehicle was");
    }
    control.pilot.reads(mission.readings);
    let mut planner = mission.planner();
    let mut recorder = Recorder::new(mission.clone());
    let bar = count("steps flown").ok();
    let (mut ending, mut failure) = (Ending::Steps, None);
    let mut agent = Agent::new(&mut *planner, &mut *control, mission.start);
    let mut labels = 0;
    for _ in 0..mission.steps {
        if mission.asking.is_enough(labels) {
            ending = Ending::Labels;
            break;
        }
        match agent.step() {
            Ok(Event::Step(step)) => {
                labels += u32::from(step.reading.is_some());
                recorder.pass(&agent.body().passed);
                recorder.take(&step, None, agent.planner.belief());
                if let Some(live) = &mut live {
                    live.step(&recorder);
                }
            }
            Ok(Event::Stopped(reason)) => {
                ending = Ending::Stopped(reason);
                break;
            }
            Err(AgentError::Body(error)) => failure = Some(error),
            Err(AgentError::Observation(refused)) => {
                failure = Some(Failure::Refused(recorder.refusal(&refused).to_string()));
            }
        }
        if failure.is_some() {
            ending = Ending::BrokenOff;
            break;
        }
        if let Some(bar) = &bar {
            bar.inc(1);
        }
    }
    let belief = planner.belief().boxed();
    recorder.take_legs(&control.legs);
    control.end(failure.clone());
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let farewell = control.pilot.farewell();
    if failure.is_none() && !control.pilot.is_at_rest() {
        warn("the vehicle", &farewell);
    }
    let recording = recorder.end(Flown { ending, belief });
    if let Some(live) = live {
        match &failure {
            Some(why) => live.say(format_args!("{why}; {farewell}")),
            None => live.say(&farewell),
        }
        live.end(&recording);
    }
    let told = |failure| (failure, farewell);
    if let Some(legs) = &recording.results.end.flown {
        tell(legs);
    }
    Ok(Flight { recording, failure: failure.map(told) })
}
