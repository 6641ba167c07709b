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
    self, ChartPiece, ChartShape, ClockRate, EndReason, LabelSource, MissionArea, PROTOCOL, Reply,
    Request, Setup, Took,
};
use planner_core::{Chart, Estimates, FrontState, Motion, Plan, Pose, Reading, Site, Stage, Step};

use crate::hil::logbook::{Logbook, Sensed};
use crate::hil::setup;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::read_out::AnyPlanner;
use crate::mission::recording::{Recorder, Recording};
use crate::mission::results::{Ending, StepResult};
use crate::mission::trace;
use crate::report::live::Live;
use crate::world::on_the_way::Way;
use crate::world::robot::{Glimpse, Robot};

/// The most hellos before another request. A chip that sends more hears nothing: it sends a request 16 times at most.
const MOST_HELLOS: u32 = 5 * 16;

/// The most beginnings of a chip without a new motion.
const MOST_RESTARTS: u32 = 16;

/// Plays the world for one mission.
pub struct Player {
    setup: Setup,
    /// The whole area. The setup has only its bounds.
    area: MissionArea,
    /// What is open in it, if it is from a map.
    chart: Option<Chart<'static>>,
    responder: Responder,
    robot: Box<dyn Robot>,
    /// Where it is.
    pose: Pose,
    /// Takes in the same readings as the chip.
    planner: AnyPlanner,
    recorder: Recorder,
    /// How often the chip has asked for a mission since it took up the last.
    hellos: u32,
    /// How often a motion is read on.
    way: Way,
    /// The last motion: the chip has not said yet what it took in at its end.
    pending: Option<Made>,
    /// What was read on the way of each step.
    passed: Vec<Vec<Passed>>,
    /// What is known here of the front after each step, if one is followed; and what the chip says of it after the last
    /// motion.
    fronts: Vec<Option<FrontState>>,
    claimed: Option<FrontState>,
    /// How many labels on its way the chip was told of the motion under way; `None` if none is.
    told: Option<usize>,
    /// Ticks of the motions that the chip has asked for since it began.
    took: Vec<Took>,
    /// Whether a chip that restarts may begin again, and how often it has since the last motion that was new.
    resumes: bool,
    restarts: u32,
    /// Where steps are kept as they are taken.
    logbook: Option<Logbook>,
    /// Where steps are shown as they are taken.
    live: Option<Live>,
    ending: Took,
    clock: Option<ClockRate>,
    /// How the mission ended, or why it came to nothing.
    outcome: Option<Result<Ending>>,
    /// The chip has heard that its mission is over.
    dismissed: bool,
}

/// Where the vehicle was on its way, and what was read there. `None` if it has not been said what the chip's sensor read.
type Passed = (Site, Option<Reading>);

/// A motion that was made.
struct Made {
    motion: Motion,
    /// What was read on its way.
    passed: Vec<Passed>,
    /// What the vehicle sensed at its end.
    sensed: Option<Reading>,
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
    /// Where it is shown, if it is: all but its end.
    pub live: Option<Live>,
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
            chart: mission.lake.as_ref().map(|it| it.chart),
            responder: Responder::new(seed),
            robot: mission.robot(),
            pose: mission.start,
            planner: mission.planner(),
            recorder: Recorder::new(mission.clone()),
            hellos: 0,
            way: mission.way(),
            pending: None,
            passed: Vec::new(),
            fronts: Vec::new(),
            claimed: None,
            told: None,
            took: Vec::new(),
            resumes: false,
            restarts: 0,
            logbook: None,
            live: None,
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
        let logbook = Logbook::open(path, &start, |read| Ok(trace::step(self.retrace(&read)?)))?;
        Ok(Self { logbook: Some(logbook), ..self.resuming() })
    }

    /// The same, shown on a live page, if there is one.
    #[must_use]
    pub fn shown(self, live: Option<Live>) -> Self {
        Self { live, ..self }
    }

    /// Where it is shown.
    pub const fn live(&mut self) -> Option<&mut Live> {
        self.live.as_mut()
    }

    /// Where its steps are kept.
    pub const fn logbook(&self) -> Option<&Logbook> {
        self.logbook.as_ref()
    }

    /// Where the robot said last that it is: on the way of a motion, or at its end.
    pub fn place(&self) -> Site {
        let on_the_way = self.told.and_then(|told| self.under_way().get(told.checked_sub(1)?));
        on_the_way.map_or(self.pose.site, |(site, _)| *site)
    }

    /// What is read on the way of the motion that the chip asked for last.
    fn under_way(&self) -> &[Passed] {
        let step = self.motions().checked_sub(1).and_then(|step| self.passed.get(step));
        let passed = step.or_else(|| self.pending.as_ref().map(|made| &made.passed));
        passed.map_or(&[], Vec::as_slice)
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
            Request::Outline(_)
            | Request::Chart
            | Request::Cells(_)
            | Request::Ready(_)
            | Request::Declined(_)
                if self.clock.is_some() && !self.resumes =>
            {
                bail!("the board restarted or gave up after step {}", self.steps())
            }
            Request::Outline(number) => match setup::outlines(&self.area).nth(number.into()) {
                Some(outline) => Ok(Reply::Outline(outline)),
                None => bail!("the board asks for outline {number}, which there is not"),
            },
            Request::Chart => match &self.chart {
                Some(chart) => Ok(Reply::Chart(ChartShape::of(chart))),
                None => bail!("the board asks for a chart, which there is not"),
            },
            Request::Cells(number) => {
                match self.chart.and_then(|chart| ChartPiece::of(&chart, number)) {
                    Some(piece) => Ok(Reply::Cells(piece)),
                    None => {
                        bail!("the board asks for piece {number} of a chart, which there is not")
                    }
                }
            }
            Request::Declined(declined) => {
                self.outcome = Some(Err(setup::declined(declined, &self.setup, self.way.readings)));
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
                (self.told, self.claimed) = (None, None);
                Ok(Reply::Noted)
            }
            Request::Front(front) => {
                if self.motions() == 0 || self.told.is_some() || self.claimed.is_some() {
                    bail!(
                        "step {}: the board reports a front, but no motion has ended",
                        self.motions()
                    );
                }
                self.claimed = Some(front);
                Ok(Reply::Noted)
            }
            Request::Move(message::Move { motion, last, took }) => {
                if self.told.is_some() {
                    bail!(
                        "step {}: the board asks for the next motion before its end",
                        self.motions()
                    );
                }
                self.settle(last, took)?;
                match self.made() {
                    Some((made, ..)) if made != motion => {
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
                    Some(_) => {}
                    None => self.make(motion),
                }
                self.took.push(Took { observe: 0, ..took });
                self.told = Some(0);
                self.goes_on()
            }
            Request::Onward { last } => {
                self.hear_on_the_way(last)?;
                self.goes_on()
            }
            Request::End(end) => {
                let settled = match self.told {
                    None => self.settle(end.last, end.took),
                    Some(_) => self.no_readings(),
                };
                self.ending = end.took;
                self.outcome = Some(settled.and_then(|()| self.judge(&end)));
                Ok(Reply::Noted)
            }
        }
    }

    /// What comes next of the motion under way: a label on the way, or its end.
    fn goes_on(&mut self) -> Result<Reply> {
        let told = self.told.context("no motion is under way")?;
        if let Some(&(site, reading)) = self.under_way().get(told) {
            self.told = Some(told + 1);
            return Ok(Reply::OnTheWay { site, reading });
        }
        self.told = None;
        let (_, pose, reading) =
            self.motions().checked_sub(1).and_then(|at| self.made_at(at)).context("a motion")?;
        Ok(Reply::Arrived { pose, reading })
    }

    /// Takes down what the chip took in on the way.
    fn hear_on_the_way(&mut self, last: Option<Reading>) -> Result<()> {
        let step = self.motions();
        let Some(told) = self.told.and_then(|told| told.checked_sub(1)) else {
            bail!("after step {step}: the board goes on with a motion, but none is under way");
        };
        let is_of_chip = self.setup.labels == LabelSource::Chip;
        let reading = self.under_way().get(told).and_then(|(_, reading)| *reading);
        let is_new = self.steps() < step;
        match &mut self.pending {
            Some(made) if is_new && is_of_chip && reading.is_none() => made.passed[told].1 = last,
            _ if reading != last => {
                bail!("step {step}: read {reading:?} on the way, the board took in {last:?}")
            }
            _ => {}
        }
        Ok(())
    }

    /// Fails, as the chip ended the mission in the middle of a motion: it was told of a label on the way.
    fn no_readings(&self) -> Result<()> {
        bail!(
            "readings: found {}, expected 1: the board takes in the label at a motion's end alone",
            self.way.readings
        )
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
        self.made_at(self.motions())
    }

    /// The same of the motion of any number, from 0.
    fn made_at(&self, number: usize) -> Option<(Motion, Pose, Option<Reading>)> {
        let known = self.recorder.steps().get(number);
        let known = known.map(|step| (step.motion, step.pose, step.reading));
        let pending = || self.pending.as_ref().map(|made| (made.motion, self.pose, made.sensed));
        known.or_else(pending)
    }

    /// Makes a motion that the chip has planned.
    fn make(&mut self, motion: Motion) {
        if motion.stage == Some(Stage::Audit) || self.planner.front().is_some() {
            // The planner here has to know that the label is the audit's, and one of fronts which way the robot faces.
            let _ = self.planner.plan(self.pose);
        }
        self.make_planned(motion);
    }

    /// Makes a motion that the planner here has planned too, where it has to.
    fn make_planned(&mut self, motion: Motion) {
        let robot_senses = self.setup.labels == LabelSource::Vehicle;
        let made = Motion { wants_label: motion.wants_label && robot_senses, ..motion };
        let mut passed = Vec::new();
        let mut pass = |Glimpse { reported, reading, .. }| {
            if !robot_senses || reading.is_some() {
                passed.push((reported, reading.filter(|_| robot_senses)));
            }
        };
        let sensed = self.robot.travel(&made, &mut self.pose, self.way, &mut pass);
        (self.pending, self.restarts) = (Some(Made { motion, passed, sensed }), 0);
    }

    /// Records the last step, when the chip reports what it took in at its end.
    fn settle(&mut self, last: Option<Reading>, took: Took) -> Result<()> {
        let Some(current) = self.took.last_mut() else { return Ok(()) };
        current.observe = took.observe;
        let told = match (self.recorder.steps().get(self.took.len() - 1), &self.pending) {
            (Some(step), _) => Some(step.reading),
            (None, Some(made)) if self.setup.labels == LabelSource::Vehicle => Some(made.sensed),
            _ => None,
        };
        if let Some(told) = told.filter(|told| *told != last) {
            bail!("step {}: sensed {told:?}, the board took in {last:?}", self.motions());
        }
        if self.steps() < self.motions() {
            self.take_in(last)?;
        }
        self.compare_front()
    }

    /// Checks that the chip knows of the front after its last motion what is known here, to the last bit.
    fn compare_front(&mut self) -> Result<()> {
        let step = self.motions();
        let here = step.checked_sub(1).and_then(|at| *self.fronts.get(at)?);
        let chip = self.claimed.take();
        if chip != here {
            bail!("step {step}: the front: found {chip:?} on the board, expected {here:?} as here");
        }
        Ok(())
    }

    /// Takes in what was read on the way of the last motion, and the reading at its end.
    fn take_in(&mut self, reading: Option<Reading>) -> Result<()> {
        let Some(Made { motion, passed, .. }) = self.pending.take() else { return Ok(()) };
        let pose = self.pose;
        let read: Vec<_> = passed.iter().filter_map(|(site, it)| Some((*site, (*it)?))).collect();
        for (site, reading) in &read {
            if let Err(refused) = self.planner.observe_on_the_way(*site, *reading) {
                return Err(self.recorder.refusal(&refused));
            }
        }
        if let Err(refused) = self.planner.observe(pose, reading) {
            return Err(self.recorder.refusal(&refused));
        }
        let step = Step { motion, pose, reading, alarm: None };
        self.recorder.pass(&read);
        self.recorder.take(&step, self.robot.true_pose(), self.planner.belief());
        self.passed.push(passed);
        self.fronts.push(self.planner.front());
        if let Some(live) = &mut self.live {
            live.step(&self.recorder);
        }
        match (&mut self.logbook, self.recorder.last()) {
            (Some(logbook), Some(step)) => logbook.take(step),
            _ => Ok(()),
        }
    }

    /// Makes the next step before a chip asks for it. It is a step from before this program restarted. `read` is what
    /// was read then, by the chip's own sensor perhaps.
    ///
    /// # Errors
    /// When the mission has no such step.
    fn retrace(&mut self, read: &Sensed) -> Result<&StepResult> {
        let motion = match self.planner.plan(self.pose) {
            Plan::Move(motion) if self.steps() < usize::from(self.setup.steps) => motion,
            _ => bail!("expected no more than {} steps", self.steps()),
        };
        self.make_planned(motion);
        let made = self.pending.as_mut().context("a motion")?;
        let reading = match self.setup.labels {
            LabelSource::Vehicle => made.sensed,
            LabelSource::Chip => {
                for (passed, reading) in made.passed.iter_mut().zip(&read.on_the_way) {
                    passed.1 = Some(*reading);
                }
                let label = motion.wants_label.then_some(read.at_end);
                label.map(|label| label.context("expected a label")).transpose()?
            }
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
        let sensed = self.pending.as_ref().and_then(|made| made.sensed);
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
        let Self { recorder, planner, took, ending, clock, outcome, logbook, live, .. } = self;
        let unfinished = || anyhow!("the mission broke off after step {}", recorder.steps().len());
        let (reason, failure, clock) = match (outcome.ok_or_else(unfinished)?, clock) {
            (Ok(reason), Some(clock)) => (reason, None, clock),
            (Err(why), Some(clock)) => (Ending::BrokenOff, Some(why), clock),
            (Ok(_), None) => return Err(unfinished()),
            (Err(why), None) => return Err(why),
        };
        let flown = Flown { ending: reason, belief: planner.belief().boxed() };
        let recording = recorder.end(flown);
        Ok((Played { recording, took, ending, clock, logbook, live }, failure))
    }
}
