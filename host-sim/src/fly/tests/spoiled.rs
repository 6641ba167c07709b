//! The ideal vehicle at the end of a link that a test spoils, and what is asked of messages.

use std::time::Duration;

use anyhow::{Result, bail};
use mavlink::MavHeader;
use mavlink::dialects::common::{MavMessage, PositionTargetTypemask as Ignored};

use crate::fly::control::Control;
use crate::fly::failure::Failure;
use crate::fly::flight::{self, Flight};
use crate::fly::ideal::Ideal;
use crate::fly::label::LabelSource;
use crate::fly::limits::Limits;
use crate::fly::link::Link;
use crate::fly::orders::AUTOPILOT;
use crate::fly::pilot::Pilot;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides, PAPER_NOISELESS};
use crate::mission::trace;

pub(super) const SYSTEM: u8 = 3;

/// What becomes of a message, by the time and by its number in its direction.
pub(super) type Spoil<'a> = Box<dyn FnMut(Duration, usize, MavMessage) -> Vec<MavMessage> + 'a>;

/// An ideal vehicle on a spoiled link.
pub(super) struct Spoiled<'a> {
    pub(super) ideal: Ideal,
    pub(super) there: Spoil<'a>,
    pub(super) back: Spoil<'a>,
    /// How many have gone either way.
    pub(super) gone: [usize; 2],
    pub(super) waiting: Vec<MavMessage>,
    pub(super) breaks_at: Option<Duration>,
}

impl Link for Spoiled<'_> {
    fn now(&self) -> Duration {
        self.ideal.now()
    }

    fn send(&mut self, message: &MavMessage) {
        self.gone[0] += 1;
        for message in (self.there)(self.ideal.now(), self.gone[0] - 1, message.clone()) {
            self.ideal.send(&message);
        }
    }

    fn receive(&mut self, until: Duration) -> Result<Option<(MavHeader, MavMessage)>> {
        if self.breaks_at.is_some_and(|at| self.now() >= at) {
            bail!("gone");
        }
        if self.waiting.is_empty() {
            let Some((_, message)) = self.ideal.receive(until)? else { return Ok(None) };
            self.gone[1] += 1;
            self.waiting = (self.back)(self.ideal.now(), self.gone[1] - 1, message);
        }
        let header = MavHeader { system_id: SYSTEM.into(), component_id: AUTOPILOT, sequence: 0 };
        Ok(self.waiting.pop().map(|message| (header, message)))
    }
}

pub(super) fn mission() -> Mission {
    let text = format!("tolerance = 0.02\n{PAPER_NOISELESS}");
    let overrides = Overrides { steps: Some(4), ..Overrides::default() };
    scenario::parse("m", &text, overrides).expect("a scenario")
}

pub(super) fn as_it_is(_: Duration, _: usize, message: MavMessage) -> Vec<MavMessage> {
    vec![message]
}

/// A flight, and what the vehicle was sent.
pub(super) struct Flown {
    pub(super) flight: Result<Flight, Failure>,
    pub(super) sent: Vec<(Duration, MavMessage)>,
    pub(super) gone: [usize; 2],
}

impl Flown {
    /// The trace, without what a flight adds.
    pub(super) fn trace(&self) -> String {
        match &self.flight {
            Ok(flight) => {
                let mut results = flight.recording.results.clone();
                results.end.flown = None;
                results.steps.iter_mut().for_each(|step| step.flown = None);
                trace::lines(&results)
            }
            Err(failure) => panic!("{failure}"),
        }
    }

    pub(super) fn failure(&self) -> Option<&Failure> {
        match &self.flight {
            Ok(flight) => flight.failure.as_ref().map(|it| &it.0),
            Err(failure) => Some(failure),
        }
    }
}

/// How far and how long.
pub(super) const LIMITS: Limits = Limits {
    acceptance: 0.02,
    tolerance: 0.02,
    ready: Duration::from_mins(1),
    motion: Duration::from_secs(20),
    label: Duration::from_secs(5),
};

pub(super) fn fly_with(
    there: Spoil<'_>,
    back: Spoil<'_>,
    breaks_at: Option<Duration>,
    interrupted: fn() -> Option<i32>,
) -> Flown {
    fly_mission(mission(), (there, back), breaks_at, interrupted)
}

pub(super) fn fly_mission(
    mission: Mission,
    spoil: (Spoil<'_>, Spoil<'_>),
    breaks_at: Option<Duration>,
    interrupted: fn() -> Option<i32>,
) -> Flown {
    let control = |link| Control::new(link, Pilot::new(SYSTEM, wet(), LIMITS), interrupted);
    fly_by(mission, spoil, breaks_at, control)
}

/// What tells labels.
pub(super) fn wet() -> LabelSource {
    LabelSource::new("WET".parse().expect("a name"), None)
}

pub(super) fn fly_by<'a>(
    mission: Mission,
    (there, back): (Spoil<'a>, Spoil<'a>),
    breaks_at: Option<Duration>,
    control: impl FnOnce(Spoiled<'a>) -> Control<Spoiled<'a>>,
) -> Flown {
    let ideal = Ideal::new(&mission, SYSTEM, wet());
    let waiting = Vec::new();
    let link = Spoiled { ideal, there, back, gone: [0; 2], waiting, breaks_at };
    let mut control = control(link);
    let flight = flight::fly(mission, &mut control);
    let link = control.link();
    Flown { flight, sent: link.ideal.sent().to_vec(), gone: link.gone }
}

pub(super) fn fly<'a>(
    there: impl FnMut(Duration, usize, MavMessage) -> Vec<MavMessage> + 'a,
    back: impl FnMut(Duration, usize, MavMessage) -> Vec<MavMessage> + 'a,
) -> Flown {
    fly_with(Box::new(there), Box::new(back), None, || None)
}

pub(super) fn of_run() -> String {
    trace::lines(&Recording::of(&mission()).expect("labels are true").results)
}

/// A vehicle that goes round and round where it says that it is, at 2 rad/s.
pub(super) fn circling(now: Duration, message: MavMessage, radius: f32) -> MavMessage {
    let MavMessage::LOCAL_POSITION_NED(mut it) = message else { return message };
    let (sine, cosine) = (2.0 * now.as_secs_f32()).sin_cos();
    (it.x, it.y) = (it.x + radius * cosine, it.y + radius * sine);
    (it.vx, it.vy) = (it.vx - 2.0 * radius * sine, it.vy + 2.0 * radius * cosine);
    MavMessage::LOCAL_POSITION_NED(it)
}

/// Whether a message moves a vehicle.
pub(super) fn moves(message: &MavMessage) -> bool {
    let MavMessage::SET_POSITION_TARGET_LOCAL_NED(it) = message else { return false };
    !is_stop(message) || (it.vx, it.vy, it.vz, it.yaw_rate) != (0.0, 0.0, 0.0, 0.0)
}

pub(super) fn is_stop(message: &MavMessage) -> bool {
    matches!(message, MavMessage::SET_POSITION_TARGET_LOCAL_NED(it)
        if it.type_mask.contains(Ignored::POSITION_TARGET_TYPEMASK_X_IGNORE)
            && !it.type_mask.contains(Ignored::POSITION_TARGET_TYPEMASK_VX_IGNORE))
}
