//! What `idle` runs: asks for a mission, flies it, logs it, and asks for the next.

use planner_core::link::delivery::LinkError;
use planner_core::link::message::{Algorithm, DeclinedError, MissionArea, MissionEnd, Setup};
use planner_core::link::station::{Flown, PlannerSetup, Prepared, Station};
use planner_core::{
    Accuracy, AnyVehicle, Goal, LocalLine, Noise, PinSensor, Planner, Policy, Prior, Reading, Step,
};
use stm32f4xx_hal::gpio::{Input, PB1};

use crate::serial::Serial;
use crate::stop::Enable;

/// Samples that a mission with true labels can hold: 64 labels beside four given ones.
const TRUE_SAMPLES: usize = 68;

/// Samples that a mission with doubtful labels can hold: 32 labels beside four given ones.
const DOUBTFUL_SAMPLES: usize = 36;

/// All hypotheses that 32 labels can leave.
const HYPOTHESES: usize = 529;

/// What it plans with: any vehicle in any area.
type Known = PlannerSetup<AnyVehicle, MissionArea>;

/// The parts of the board that a mission uses.
pub(crate) struct Board {
    pub(crate) station: Station<Serial, PinSensor<PB1<Input>>>,
    pub(crate) enable: Enable,
}

impl Board {
    pub(crate) fn run(&mut self) -> ! {
        loop {
            let setup = self.station.await_setup();
            defmt::info!("mission: {}, {=u16} steps at most", setup.algorithm, setup.steps);
            match self.station.terms(&setup) {
                Ok(terms) => self.fly_with(&setup, &terms),
                Err(none) => log_end(0, &self.station.give_up(none)),
            }
        }
    }

    fn fly_with(&mut self, setup: &Setup, terms: &Known) {
        match setup.algorithm {
            Algorithm::Cfc => self.fly(setup, &mut setup.cfc::<_, _, TRUE_SAMPLES>(*terms)),
            Algorithm::Lookahead { evaluations, goal, noise: None } => {
                self.fly(
                    setup,
                    &mut setup.lookahead::<_, _, Accuracy, TRUE_SAMPLES>(*terms, evaluations, goal),
                );
            }
            Algorithm::Lookahead { evaluations, goal, noise: Some((noise, prior)) } => {
                self.fly_forecast(setup, terms, (evaluations, goal), (noise, prior));
            }
            Algorithm::Scc { noise, policy, prior } => {
                self.fly_scc(setup, terms, policy, (noise, prior));
            }
        }
    }

    // Tables of hypotheses are large. Each is in a function of its own, so that only one is on the stack.
    #[inline(never)]
    fn fly_forecast(
        &mut self,
        setup: &Setup,
        terms: &Known,
        (evaluations, goal): (u32, Option<Goal>),
        (noise, prior): (Noise, Prior),
    ) {
        let mut planner = setup.lookahead_in_noise::<_, _, DOUBTFUL_SAMPLES, HYPOTHESES>(
            *terms,
            evaluations,
            goal,
        );
        self.fly(setup, &mut setup.prepare(&mut planner, prior, noise));
    }

    #[inline(never)]
    fn fly_scc(
        &mut self,
        setup: &Setup,
        terms: &Known,
        policy: Policy,
        (noise, prior): (Noise, Prior),
    ) {
        let mut planner = setup.scc::<_, _, DOUBTFUL_SAMPLES, HYPOTHESES>(*terms, policy);
        self.fly(setup, &mut setup.prepare(&mut planner, prior, noise));
    }

    /// Flies a mission. The drive is enabled meanwhile.
    fn fly<L: Planner>(&mut self, setup: &Setup, planner: &mut Result<Prepared<L>, DeclinedError>) {
        if planner.is_ok() {
            self.enable.on();
        }
        let mut steps = 0;
        let flown = self.station.fly(setup, planner, |step| {
            steps += 1;
            log_step(steps, step);
        });
        self.enable.off();
        log_end(steps, &flown);
    }
}

fn log_end(steps: u16, flown: &Result<Flown, LinkError>) {
    match flown {
        Ok(Flown::Ended(MissionEnd { reason, estimates, .. })) => {
            defmt::info!("ended after {=u16} steps: {}", steps, reason);
            log_line("centre", estimates.centre);
            log_line("maximum margin", estimates.maximum_margin);
            log_line("bisector", estimates.bisector);
        }
        Ok(Flown::Declined(declined)) => defmt::warn!("declined: {}", declined),
        Err(lost) => defmt::error!("stopped after {=u16} steps: {}", steps, lost),
    }
}

fn log_step(number: u16, Step { motion, pose, reading }: &Step) {
    defmt::info!(
        "step {=u16}: {} {}, action {=u32}, to x {=i32}, z {=i32}, heading {=u32:#010x}, label {}",
        number,
        motion.stage,
        motion.recovery,
        motion.action.0,
        pose.site.x(),
        pose.site.z(),
        pose.heading.0,
        reading.map(Reading::sign),
    );
}

/// A line in axes of its own: about a site and along a direction, both on the lattice, by slope and intercept
/// in metres.
fn log_line(name: &str, line: Option<LocalLine>) {
    match line {
        None => defmt::info!("{=str}: none", name),
        Some(line) => defmt::info!(
            "{=str}: about x {=i32}, z {=i32}, along x {=i32}, z {=i32}: slope {=f32}, intercept {=f32}",
            name,
            line.about().x(),
            line.about().z(),
            line.along().x(),
            line.along().z(),
            line.slope(),
            line.intercept(),
        ),
    }
}
