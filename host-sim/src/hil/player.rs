//! The world that a chip plans in: bytes of the link in, frames out.
//!
//! It knows nothing of ports and clocks, so a serial line, an emulator and a test's own network can all carry the
//! bytes. Each reading is taken in here as on the chip. So both must know the same in the end: different final
//! estimates are an error.
//!
//! A chip that restarts in the middle of a mission flies it again from its beginning. Its requests up to that point
//! have been carried out already, so they are answered from memory. Nothing moves until a new request arrives.

use std::path::Path;

use anyhow::{Context as _, Result, anyhow, bail};
use planner_core::link::delivery::{Heard, Hello, Responder};
use planner_core::link::frame::Frame;
use planner_core::link::message::{
    self, ClockRate, EndReason, LabelSource, MissionArea, PROTOCOL, Reply, Request, Setup, Took,
};
use planner_core::planner::Stage;
use planner_core::{Estimates, Motion, Plan, Pose, Reading, Step};

use crate::hil::logbook::Logbook;
use crate::hil::setup;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::planners::AnyPlanner;
use crate::mission::recording::{Recorder, Recording};
use crate::mission::results::{Ending, StepResult};
use crate::report::trace;
use crate::world::robot::Robot;

/// The most hellos before another request. A chip that sends more hears nothing: it sends a request 16 times at most.
const MOST_HELLOS: u32 = 5 * 16;

/// The most beginnings of a chip without a new motion.
const MOST_RESTARTS: u32 = 16;

/// Plays the world for one mission.
pub struct Player {
    setup: Setup,
    /// The whole area. The setup has only its bounds.
    area: MissionArea,
    responder: Responder,
    robot: Box<dyn Robot>,
    /// Where it is.
    pose: Pose,
    /// Takes in the same readings as the chip.
    planner: AnyPlanner,
    recorder: Recorder,
    /// How often the chip has asked for a mission since it took up the last.
    hellos: u32,
    /// The last motion, and what the vehicle sensed at its end: the chip has not said yet what it took in there.
    pending: Option<(Motion, Option<Reading>)>,
    /// Ticks of the motions that the chip has asked for since it began.
    took: Vec<Took>,
    /// Whether a chip that restarts may begin again, and how often it has since the last motion that was new.
    resumes: bool,
    restarts: u32,
    /// Where steps are kept as they are taken.
    logbook: Option<Logbook>,
    ending: Took,
    clock: Option<ClockRate>,
    /// How the mission ended, or why it came to nothing.
    outcome: Option<Result<Ending>>,
    /// The chip has heard that its mission is over.
    dismissed: bool,
}

/// A mission that a chip has flown.
#[derive(Debug)]
pub struct Played {
    /// The mission as it went.
    pub recording: Recording,
    /// Ticks of the chip's clock for each step.
    pub took: Vec<Took>,
    /// Ticks of the mission's end: a plan that found no motion, if one did not, and the estimates.
    pub ending: Took,
    /// The rate of these ticks.
    pub clock: ClockRate,
    /// The mission on disc, if it was to be kept there: all but its end.
    pub logbook: Option<Logbook>,
}

impl Player {
    /// A world that waits for a chip. `seed` tells the world's starts apart: see [`Responder::new`].
    ///
    /// # Errors
    /// When no chip can fly such a mission.
    pub fn new(mission: &Mission, labels: LabelSource, seed: u32) -> Result<Self> {
        let setup = setup::setup(mission, labels)?;
        Ok(Self {
            setup,
            area: mission.config.area,
            responder: Responder::new(seed),
            robot: mission.robot(),
            pose: mission.start,
            planner: mission.planner(),
            recorder: Recorder::new(mission.clone()),
            hellos: 0,
            pending: None,
            took: Vec::new(),
            resumes: false,
            restarts: 0,
            logbook: None,
            ending: Took::default(),
            clock: None,
            outcome: None,
            dismissed: false,
        })
    }

    /// The same, for a chip that may restart: it goes on where it was.
    #[must_use]
    pub fn resuming(self) -> Self {
        Self { resumes: true, ..self }
    }

    /// The same, with its steps kept on disc, so that they outlive this program too. Steps that are there already are
    /// made again first.
    ///
    /// # Errors
    /// As [`Logbook::open`].
    pub fn keeping(mut self, path: &Path) -> Result<Self> {
        let start = self.recorder.start();
        let logbook = Logbook::open(path, &start, |read| Ok(trace::step(self.retrace(read)?)))?;
        Ok(Self { logbook: Some(logbook), ..self.resuming() })
    }

    /// Where its steps are kept.
    pub const fn logbook(&self) -> Option<&Logbook> {
        self.logbook.as_ref()
    }

    /// Where the robot says that it is.
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Steps that have been flown.
    pub fn steps(&self) -> usize {
        self.recorder.steps().len()
    }

    /// Motions that the chip has asked for since it began.
    pub fn motions(&self) -> usize {
        self.took.len()
    }

    /// Whether the mission is over.
    pub fn is_over(&self) -> bool {
        self.outcome.is_some()
    }

    /// Frames that came whole from the chip and held no message.
    pub fn unreadable(&self) -> u32 {
        self.responder.unreadable()
    }

    /// Whether the chip knows that the mission is over.
    pub fn is_dismissed(&self) -> bool {
        self.dismissed
    }

    /// Takes in a byte from the chip. Returns the frame to send in turn, if there is one.
    ///
    /// # Errors
    /// When the chip gives the mission up, or sends a request that cannot be.
    pub fn hear(&mut self, byte: u8) -> Result<Option<Frame>> {
        match self.responder.hear(byte) {
            None => Ok(None),
            Some(Heard::Old(frame)) => Ok(Some(frame)),
            Some(Heard::Hello(hello)) => self.welcome(hello),
            Some(Heard::New(request)) => {
                let reply = self.act(request)?;
                Ok(Some(self.responder.answer(reply).clone()))
            }
        }
    }

    fn welcome(&mut self, hello: Hello) -> Result<Option<Frame>> {
        if self.is_over() {
            self.dismissed |= hello.is_later;
            return Ok(None);
        }
        if hello.protocol != PROTOCOL {
            bail!("the board speaks protocol {}, expected {PROTOCOL}", hello.protocol);
        }
        self.hellos += 1;
        if self.hellos > MOST_HELLOS {
            bail!("the board asks for a mission again and again, and hears no answer");
        }
        Ok(Some(self.responder.offer(hello, self.setup.clone())))
    }

    fn act(&mut self, request: Request) -> Result<Reply> {
        self.hellos = 0;
        match request {
            Request::Hello { .. } => unreachable!("a hello is welcomed"),
            // These begin a session: the chip has forgotten the last one.
            Request::Outline(_) | Request::Ready(_) | Request::Declined(_)
                if self.clock.is_some() && !self.resumes =>
            {
                bail!("the board restarted or gave up after step {}", self.steps())
            }
            Request::Outline(number) => match setup::outlines(&self.area).nth(number.into()) {
                Some(outline) => Ok(Reply::Outline(outline)),
                None => bail!("the board asks for outline {number}, which there is not"),
            },
            Request::Declined(declined) => {
                self.outcome = Some(Err(setup::declined(declined, &self.setup)));
                Ok(Reply::Noted)
            }
            Request::Ready(accepted) => {
                if self.clock.replace(accepted.clock).is_some() {
                    self.restarts += 1;
                }
                if self.restarts > MOST_RESTARTS {
                    bail!("the board restarts again and again after step {}", self.steps());
                }
                self.took.clear();
                Ok(Reply::Noted)
            }
            Request::Move(message::Move { motion, last, took }) => {
                self.settle(last, took)?;
                let (pose, reading) = match self.made() {
                    Some((made, _, _)) if made != motion => {
                        let (step, place) = (self.motions() + 1, |it: Motion| it.target.site);
                        bail!(
                            "step {step}: the board asks for action {} to {:?}, expected {} to {:?} as \
                             before it restarted",
                            motion.action.0,
                            place(motion),
                            made.action.0,
                            place(made),
                        )
                    }
                    Some((_, pose, reading)) => (pose, reading),
                    None => self.make(motion),
                };
                self.took.push(Took { observe: 0, ..took });
                Ok(Reply::Arrived { pose, reading })
            }
            Request::End(end) => {
                let settled = self.settle(end.last, end.took);
                self.ending = end.took;
                self.outcome = Some(settled.and_then(|()| self.judge(&end)));
                Ok(Reply::Noted)
            }
        }
    }

    /// The mission's ending. Fails if a mission cannot end so here.
    fn judge(&self, end: &message::MissionEnd) -> Result<Ending> {
        let reason = match end.reason {
            EndReason::Steps => Ending::Steps,
            EndReason::Labels => Ending::Labels,
            EndReason::Stopped(reason) => Ending::Stopped(reason),
            EndReason::Refused(refused) => bail!("the board refused what agrees: {refused}"),
            EndReason::Sensor if self.setup.labels == LabelSource::Vehicle => {
                bail!("step {}: the board got no label where it wanted one", self.motions())
            }
            EndReason::Sensor => bail!("step {}: the board's sensor failed", self.motions()),
            EndReason::Vehicle => bail!("step {}: the vehicle failed", self.motions()),
        };
        self.compare(&end.estimates)?;
        Ok(reason)
    }

    /// The chip's next motion, where it ended and the reading there, if it was made before.
    fn made(&self) -> Option<(Motion, Pose, Option<Reading>)> {
        let known = self.recorder.steps().get(self.motions());
        let known = known.map(|step| (step.motion, step.pose, step.reading));
        known.or_else(|| self.pending.map(|(motion, sensed)| (motion, self.pose, sensed)))
    }

    /// Makes a motion: where it ended, and what the vehicle sensed there.
    fn make(&mut self, motion: Motion) -> (Pose, Option<Reading>) {
        let robot_senses = self.setup.labels == LabelSource::Vehicle;
        let made = Motion { wants_label: motion.wants_label && robot_senses, ..motion };
        if motion.stage == Some(Stage::Audit) {
            // The planner here has to know that the label is the audit's.
            let _ = self.planner.plan(self.pose);
        }
        let Ok(sensed) = self.robot.perform(&made, &mut self.pose);
        (self.pending, self.restarts) = (Some((motion, sensed)), 0);
        (self.pose, sensed)
    }

    /// Records the last step, when the chip reports what it took in at its end.
    fn settle(&mut self, last: Option<Reading>, took: Took) -> Result<()> {
        let Some(current) = self.took.last_mut() else { return Ok(()) };
        current.observe = took.observe;
        let told = match (self.recorder.steps().get(self.took.len() - 1), self.pending) {
            (Some(step), _) => Some(step.reading),
            (None, Some((_, sensed))) if self.setup.labels == LabelSource::Vehicle => Some(sensed),
            _ => None,
        };
        if let Some(told) = told.filter(|told| *told != last) {
            bail!("step {}: sensed {told:?}, the board took in {last:?}", self.motions());
        }
        if self.steps() < self.motions() { self.take_in(last) } else { Ok(()) }
    }

    /// Takes in the reading of the last motion.
    fn take_in(&mut self, reading: Option<Reading>) -> Result<()> {
        let Some((motion, _)) = self.pending.take() else { return Ok(()) };
        let pose = self.pose;
        if let Err(refused) = self.planner.observe(pose, reading) {
            return Err(self.recorder.refusal(&refused));
        }
        let step = Step { motion, pose, reading, alarm: None };
        self.recorder.take(&step, self.robot.true_pose(), self.planner.belief());
        match (&mut self.logbook, self.recorder.last()) {
            (Some(logbook), Some(step)) => logbook.take(step),
            _ => Ok(()),
        }
    }

    /// Makes the next step before a chip asks for it. It is a step from before this program restarted. `read` is what
    /// the chip's own sensor read.
    ///
    /// # Errors
    /// When the mission has no such step.
    fn retrace(&mut self, read: Option<Reading>) -> Result<&StepResult> {
        let motion = match self.planner.plan(self.pose) {
            Plan::Move(motion) if self.steps() < usize::from(self.setup.steps) => motion,
            _ => bail!("expected no more than {} steps", self.steps()),
        };
        let (_, sensed) = self.make(motion);
        let reading = match self.setup.labels {
            LabelSource::Vehicle => sensed,
            LabelSource::Chip if !motion.wants_label => None,
            LabelSource::Chip => Some(read.context("expected a label")?),
        };
        self.take_in(reading)?;
        self.recorder.last().context("a step")
    }

    /// Checks that the chip's estimates are those of this machine, to the last bit. A chip may have the centre alone.
    fn compare(&self, chip: &Estimates) -> Result<()> {
        let mut here = self.planner.estimates();
        if chip.bisector.is_none() && chip.maximum_margin.is_none() {
            here = Estimates { bisector: None, maximum_margin: None, ..here };
        }
        for (name, chip, here) in [
            ("bisector", chip.bisector, here.bisector),
            ("centre", chip.centre, here.centre),
            ("maximum margin", chip.maximum_margin, here.maximum_margin),
        ] {
            if chip != here {
                bail!("the {name}: found {chip:?} on the board, expected {here:?} as here");
            }
        }
        Ok(())
    }

    /// The mission so far, when the chip has been halted. The chip has taken in the last reading, but has not reported
    /// it.
    ///
    /// # Errors
    /// When that is refused here, or the chip had not begun.
    pub fn break_off(mut self) -> Result<Played> {
        let sensed = self.pending.and_then(|(_, reading)| reading);
        self.take_in(sensed)?;
        self.outcome = Some(Ok(Ending::Steps));
        self.finish()
    }

    /// The mission as it went.
    ///
    /// # Errors
    /// When it is not over, the chip declined it, or it came to nothing.
    pub fn finish(self) -> Result<Played> {
        let (played, failure) = self.finish_as_far_as_flown()?;
        failure.map_or(Ok(played), Err)
    }

    /// The mission as far as it was flown, and why it was broken off, if it was.
    ///
    /// # Errors
    /// When it is not over, or did not begin.
    pub fn finish_as_far_as_flown(self) -> Result<(Played, Option<anyhow::Error>)> {
        let Self { recorder, planner, took, ending, clock, outcome, logbook, .. } = self;
        let unfinished = || anyhow!("the mission broke off after step {}", recorder.steps().len());
        let (reason, failure, clock) = match (outcome.ok_or_else(unfinished)?, clock) {
            (Ok(reason), Some(clock)) => (reason, None, clock),
            (Err(why), Some(clock)) => (Ending::BrokenOff, Some(why), clock),
            (Ok(_), None) => return Err(unfinished()),
            (Err(why), None) => return Err(why),
        };
        let flown = Flown { ending: reason, belief: planner.belief().boxed() };
        let recording = recorder.end(flown);
        Ok((Played { recording, took, ending, clock, logbook }, failure))
    }
}
