//! One mission: steps the agent and logs each step, the three estimates, and how it ended.
//!
//! Lines are logged as the bits of their coefficients too, so that a log from the chip can be
//! compared with a run on a host exactly.

use core::convert::Infallible;

use planner_core::agent::{AgentError, Event, Step};
use planner_core::estimate::Estimates;
use planner_core::line::Line;
use planner_core::sample::Reading;

use crate::world::{self, NoMission, World};

/// What ended a mission early.
#[derive(defmt::Format)]
pub(crate) enum Failure {
    /// The compiled-in data are at fault.
    Mission(NoMission),
    /// A step failed.
    Step(AgentError<Infallible, Infallible>),
}

/// Runs the compiled-in mission from its start to its end.
pub(crate) fn run() -> Result<(), Failure> {
    let world = World::new().map_err(Failure::Mission)?;
    let mut agent = world.agent().map_err(Failure::Mission)?;
    let mut steps = 0;
    let stopped = loop {
        if steps == world::STEPS {
            break None;
        }
        match agent.step().map_err(Failure::Step)? {
            Event::Step(step) => {
                steps += 1;
                log_step(steps, &step);
            }
            Event::Stopped(reason) => break Some(reason),
        }
    };
    let Estimates { bisector, centre, maximum_margin } = Estimates::of(agent.planner.space());
    log_line("bisector", bisector);
    log_line("centre", centre);
    log_line("maximum margin", maximum_margin);
    match stopped {
        None => defmt::info!("end: all {=u32} steps made", steps),
        Some(reason) => defmt::info!("end: {} after {=u32} steps", reason, steps),
    }
    Ok(())
}

/// Position in lattice units, heading as a binary angle; the reading is `None` where no sample was
/// taken.
fn log_step(number: u32, step: &Step) {
    let Step { motion, pose, reading } = step;
    defmt::info!(
        "step {=u32}: action {=u16}, x {=i32}, z {=i32}, heading {=u32:#010x}, reading {}",
        number,
        motion.action.0,
        pose.site.x(),
        pose.site.z(),
        pose.heading.0,
        reading.map(Reading::sign),
    );
}

/// Slope and intercept in metres, `NaN` for a vertical line, then the bits of `a x + b z + c = 0`.
fn log_line(name: &str, line: Option<Line>) {
    let Some(line) = line else {
        defmt::info!("{=str}: none", name);
        return;
    };
    let [a, b, c] = line.coefficients().map(f64::to_bits);
    defmt::info!(
        "{=str}: slope {=f64}, intercept {=f64}; a {=u64:#018x}, b {=u64:#018x}, c {=u64:#018x}",
        name,
        line.slope().unwrap_or(f64::NAN),
        line.intercept().unwrap_or(f64::NAN),
        a,
        b,
        c,
    );
}
