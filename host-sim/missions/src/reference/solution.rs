//! A solved instance: the optimum, and the cost of planners that do not know the line.

use anyhow::Result;
use serde::Serialize;

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::results::StepResult;
use crate::reference::account::Account;
use crate::reference::flight;
use crate::reference::instance::Instance;
use crate::reference::objective::Problem;
use crate::reference::optimum::solve;

/// A solved instance.
#[derive(Debug)]
pub struct Solution {
    /// What was solved.
    pub instance: Instance,
    /// The optimum as it is flown; `None` if no sequence keeps the constraints.
    pub optimum: Option<Recording>,
    /// What each pays, the optimum first.
    pub accounts: Vec<Account>,
}

/// A solved instance, for programs.
#[derive(Debug, Serialize)]
pub struct Record<'a> {
    problem: &'static str,
    line_cost: &'static str,
    horizon: u32,
    actions: usize,
    optimum: Option<&'a [StepResult]>,
    accounts: &'a [Account],
}

impl Solution {
    /// Solves an instance, and has the planners fly it.
    ///
    /// # Errors
    /// Names the horizon if that is too far, or the sample that contradicts what is known.
    pub fn of(instance: Instance) -> Result<Self> {
        let best = solve(&instance)?;
        let cost = best.as_ref().map(|best| best.cost);
        let optimum = best.map(|best| flight::fly(&instance.mission, &best.actions)).transpose()?;
        let mut accounts: Vec<_> = optimum
            .iter()
            .map(|recording| Account::of(&instance, "optimum", recording, cost))
            .collect();
        for algorithm in planners(instance.problem) {
            let recording = Recording::of(&flown_by(&instance.mission, algorithm))?;
            accounts.push(Account::of(&instance, algorithm.title(), &recording, cost));
        }
        Ok(Self { instance, optimum, accounts })
    }

    /// For programs.
    pub fn record(&self) -> Record<'_> {
        let Self { instance, optimum, accounts } = self;
        Record {
            problem: instance.problem.section(),
            line_cost: instance.problem.line_cost(),
            horizon: instance.horizon(),
            actions: instance.choices.len(),
            optimum: optimum.as_ref().map(|recording| recording.results.steps.as_slice()),
            accounts,
        }
    }
}

/// Who is compared: the paper's algorithm for the problem, and look-ahead.
fn planners(problem: Problem) -> [Algorithm; 2] {
    let of_the_paper = match problem {
        Problem::Divided(_) => Algorithm::Cfc,
        Problem::Labelled => Algorithm::Scc,
    };
    [of_the_paper, Algorithm::Lookahead]
}

/// The mission flown by an algorithm, with the same actions. If the scenario names another, it gets its own defaults.
fn flown_by(mission: &Mission, algorithm: Algorithm) -> Mission {
    let mut mission = mission.clone();
    if mission.algorithm != algorithm {
        mission.algorithm = algorithm;
        mission.config.weight = algorithm.weight();
        mission.config.following = algorithm.following();
    }
    mission
}
