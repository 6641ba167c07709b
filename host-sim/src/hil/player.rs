//! The world that a chip plans in: bytes of the link in, frames out.
//!
//! Knows nothing of ports and clocks, so a serial line, an emulator and a test's own network can all
//! carry the bytes. Each reading is taken in here as on the chip. What is known then is the same, or
//! the estimates at the end would differ, and that is an error.

use anyhow::{Result, anyhow, bail};
use heapless::Vec as BoundedVec;
use planner_core::belief::estimate::Estimates;
use planner_core::belief::sample::Reading;
use planner_core::geometry::region::Region as _;
use planner_core::link::delivery::{Heard, Hello, Responder};
use planner_core::link::frame::Frame;
use planner_core::link::message::{
    self, Capacity, ClockRate, Declined, EndReason, LabelSource, MissionArea, Outline, PROTOCOL,
    Reply, Request, Setup, Took,
};
use planner_core::motion::dynamics::Pose;
use planner_core::planner::config::Config;
use planner_core::planner::{Motion, lookahead};
use planner_core::robot::agent::Step;

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::planners::AnyPlanner;
use crate::mission::recording::{Recorder, Recording};
use crate::mission::results::Ending;
use crate::world::robot::Robot;

/// A chip that has asked so often for a mission hears nothing: five times as often as it sends a request.
const MOST_HELLOS: u32 = 5 * 16;

/// Plays the world for one mission.
pub struct Player {
    setup: Setup,
    /// What the setup's area is in full.
    area: MissionArea,
    responder: Responder,
    robot: Box<dyn Robot>,
    /// Where it is.
    pose: Pose,
    /// Takes in what the chip takes in.
    planner: AnyPlanner,
    recorder: Recorder,
    /// How often the chip has asked for a mission since it took up the last.
    hellos: u32,
    /// The motion under way, and what the vehicle sensed at its end.
    pending: Option<(Motion, Option<Reading>)>,
    took: Vec<Took>,
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
    /// What they are.
    pub clock: ClockRate,
}

impl Player {
    /// A world that waits for a chip. `seed` tells the world's starts apart: see [`Responder::new`].
    ///
    /// # Errors
    /// When the mission is none that a chip can be asked to fly.
    pub fn new(mission: &Mission, labels: LabelSource, seed: u32) -> Result<Self> {
        let setup = setup(mission, labels)?;
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
            ending: Took::default(),
            clock: None,
            outcome: None,
            dismissed: false,
        })
    }

    /// Steps that have been flown.
    pub fn steps(&self) -> usize {
        self.recorder.steps()
    }

    /// Motions that the vehicle has made.
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

    /// Whether the chip knows that it is.
    pub fn is_dismissed(&self) -> bool {
        self.dismissed
    }

    /// Takes in a byte from the chip; what is to be sent in turn.
    ///
    /// # Errors
    /// When the chip gives the mission up, or says what cannot be.
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
            // Of a session that the chip begins: it knows nothing of the last.
            Request::Outline(_) | Request::Ready(_) | Request::Declined(_)
                if self.clock.is_some() =>
            {
                bail!("the board restarted or gave up after step {}", self.steps())
            }
            Request::Outline(number) => match outlines(&self.area).nth(number.into()) {
                Some(outline) => Ok(Reply::Outline(outline)),
                None => bail!("the board asks for outline {number}, which there is not"),
            },
            Request::Declined(declined) => {
                self.outcome = Some(Err(decline(declined, &self.setup)));
                Ok(Reply::Noted)
            }
            Request::Ready(accepted) => {
                self.clock = Some(accepted.clock);
                Ok(Reply::Noted)
            }
            Request::Move(message::Move { motion, last, took }) => {
                self.settle(last, took)?;
                let robot_senses = self.setup.labels == LabelSource::Vehicle;
                let made = Motion { wants_label: motion.wants_label && robot_senses, ..motion };
                let Ok(reading) = self.robot.perform(&made, &mut self.pose);
                self.pending = Some((motion, reading));
                self.took.push(Took { observe: 0, ..took });
                Ok(Reply::Arrived { pose: self.pose, reading })
            }
            Request::End(end) => {
                let settled = self.settle(end.last, end.took);
                self.ending = end.took;
                self.outcome = Some(settled.and_then(|()| self.judge(&end)));
                Ok(Reply::Noted)
            }
        }
    }

    /// Whether the mission ended as it can end here.
    fn judge(&self, end: &message::MissionEnd) -> Result<Ending> {
        let reason = match end.reason {
            EndReason::Steps => Ending::Steps,
            EndReason::Stopped(reason) => Ending::Stopped(reason),
            EndReason::Refused(refused) => bail!("the board refused what agrees: {refused}"),
            EndReason::Sensor => bail!("step {}: the board's sensor failed", self.motions()),
            EndReason::Vehicle => bail!("step {}: the vehicle failed", self.motions()),
        };
        self.compare(&end.estimates)?;
        Ok(reason)
    }

    /// Takes down the last step, now that the chip says what it took in at its end.
    fn settle(&mut self, last: Option<Reading>, took: Took) -> Result<()> {
        let Some((motion, sensed)) = self.pending.take() else { return Ok(()) };
        if self.setup.labels == LabelSource::Vehicle && last != sensed {
            bail!("step {}: sensed {sensed:?}, the board took in {last:?}", self.motions());
        }
        let pose = self.pose;
        if let Some(current) = self.took.last_mut() {
            current.observe = took.observe;
        }
        if let Err(refused) = self.planner.observe(pose, last) {
            return Err(self.recorder.refusal(&refused));
        }
        let step = Step { motion, pose, reading: last };
        self.recorder.take(&step, self.robot.true_pose(), self.planner.belief());
        Ok(())
    }

    /// Whether the chip's estimates are those of this machine, to the last bit.
    fn compare(&self, chip: &Estimates) -> Result<()> {
        let here = self.planner.estimates();
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

    /// The mission as it went so far, when the chip has been halted: what the vehicle sensed last it has
    /// taken in, but has not said so.
    ///
    /// # Errors
    /// When that is refused here, or the chip had not begun.
    pub fn break_off(mut self) -> Result<Played> {
        let sensed = self.pending.and_then(|(_, reading)| reading);
        self.settle(sensed, Took::default())?;
        self.outcome = Some(Ok(Ending::Steps));
        self.finish()
    }

    /// The mission as it went.
    ///
    /// # Errors
    /// When it is not over, the chip declined it, or it came to nothing.
    pub fn finish(self) -> Result<Played> {
        let Self { recorder, planner, took, ending, clock, outcome, .. } = self;
        let unfinished = || anyhow!("the mission broke off after step {}", recorder.steps());
        let reason = outcome.unwrap_or_else(|| Err(unfinished()))?;
        let clock = clock.ok_or_else(unfinished)?;
        let flown = Flown { ending: reason, belief: planner.belief().boxed() };
        Ok(Played { recording: recorder.end(flown), took, ending, clock })
    }
}

/// The mission as a chip is told it.
///
/// # Errors
/// When it is none that a chip can be asked to fly.
pub fn setup(mission: &Mission, labels: LabelSource) -> Result<Setup> {
    let algorithm = match mission.algorithm {
        Algorithm::Cfc => message::Algorithm::Cfc,
        Algorithm::Scc => message::Algorithm::Scc {
            noise: mission.noise_told(),
            policy: mission.policy,
            prior: mission.prior,
        },
        Algorithm::Lookahead => message::Algorithm::Lookahead {
            evaluations: lookahead::EVALUATIONS,
            goal: mission.goal,
            noise: mission.noise.map(|_| (mission.noise_told(), mission.prior)),
        },
        other => bail!("algorithm: found {}, expected cfc, scc or lookahead", other.name()),
    };
    let samples = mission.given.samples();
    let given = BoundedVec::from_slice(samples).map_err(|_| {
        let most = message::MOST_GIVEN;
        anyhow!("oracle: found {} points, expected at most {most} on a board", samples.len())
    })?;
    // Labels that are all certain make no second hypothesis; of t others there are at most so many.
    let taken = mission.steps;
    let hypotheses = match mission.algorithm {
        _ if mission.is_noisy() => 1 + taken + taken * taken.saturating_sub(1) / 2,
        _ => 1,
    };
    let capacity =
        Capacity { samples: (samples.len() as u32 + taken) as u16, hypotheses: hypotheses as u16 };
    let &Mission { config: Config { area, varrho, crossing, following, tolerance }, start, .. } =
        mission;
    let config = Config { area: area.bounds(), varrho, crossing, following, tolerance };
    let is_plain = area.sides().next().is_none() && area.hulls().next().is_none();
    let keep_outs = (!is_plain).then(|| area.hulls().count() as u8);
    let (protocol, vehicle, steps) = (PROTOCOL, mission.vehicle.into(), taken as u16);
    Ok(Setup {
        protocol,
        algorithm,
        config,
        keep_outs,
        vehicle,
        capacity,
        steps,
        start,
        labels,
        given,
    })
}

/// The border of an area, then its keep-outs.
pub fn outlines(area: &MissionArea) -> impl Iterator<Item = Outline> {
    let border = Outline { corners: area.corners().iter().copied().collect(), radius: 0 };
    [border].into_iter().chain(area.hulls().map(Outline::from))
}

fn decline(declined: Declined, setup: &Setup) -> anyhow::Error {
    match declined {
        Declined::Protocol(theirs) => {
            anyhow!("the board speaks protocol {theirs}, expected {PROTOCOL}")
        }
        Declined::Capacity(Capacity { samples, hypotheses }) => {
            let most = usize::from(samples).saturating_sub(setup.given.len());
            anyhow!(
                "steps: found {}, expected at most {most}: the board has room for {samples} samples \
                 and {hypotheses} hypotheses, {} of the samples the oracle's",
                setup.steps,
                setup.given.len(),
            )
        }
        Declined::Algorithm => anyhow!("algorithm: declined by the board, which has another"),
        Declined::Given(error) => anyhow!("oracle: declined by the board: {error}"),
        Declined::Vehicle(why) => anyhow!("vehicle: declined by the board: expected {why}"),
        Declined::Area => anyhow!("area: declined by the board: {declined}"),
        Declined::Labels => anyhow!("--labels: found chip, but this board has no label sensor"),
    }
}
