//! A mission that a vehicle flies: the planner's loop around a pilot and a link.

use planner_core::robot::AgentError;
use planner_core::{Agent, Event, Planner as _};

use crate::fly::control::Control;
use crate::fly::failure::Failure;
use crate::fly::link::Link;
use crate::mission::definition::Mission;
use crate::mission::flight::Flown;
use crate::mission::legs::Legs;
use crate::mission::recording::{Recorder, Recording};
use crate::mission::results::Ending;
use crate::output::notes::{announce, count, warn};
use crate::report::live::Live;

/// A mission that was flown, as far as it went.
pub struct Flight {
    /// The mission as it went.
    pub recording: Recording,
    /// Why it went no further, and what became of the vehicle.
    pub failure: Option<(Failure, String)>,
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
    control.prepare(&mut mission, live.as_deref_mut())?;
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
