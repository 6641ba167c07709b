//! The configuration of a planner that is asked about, and the programs that were measured.

use std::fmt;

use serde::Serialize;

/// A planner and what it is to hold.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Configuration {
    /// Who plans.
    pub planner: Planner,
    /// Samples, the given ones included; 0 of a follower of fronts, which stores none.
    #[serde(skip_serializing_if = "is_zero")]
    pub samples: u16,
    /// Hypotheses; 1 where labels are true, 0 of a follower of fronts.
    #[serde(skip_serializing_if = "is_zero")]
    pub hypotheses: u16,
    /// Any vehicle in any area, instead of the unicycle in a rectangle.
    pub roams: bool,
}

/// Who plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Planner {
    /// Algorithm 1
    Cfc,
    /// Algorithm 2
    Scc,
    /// Look-ahead
    Lookahead,
    /// The follower of fronts
    Track,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
const fn is_zero(count: &u16) -> bool {
    *count == 0
}

impl Configuration {
    /// Whether labels may be wrong.
    pub const fn is_noisy(self) -> bool {
        self.hypotheses > 1
    }
}

impl fmt::Display for Configuration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let planner = match self.planner {
            Planner::Cfc => "Algorithm 1",
            Planner::Scc => "Algorithm 2",
            Planner::Lookahead => "look-ahead",
            Planner::Track => "the follower of fronts",
        };
        write!(f, "{planner}, {}", holds(self.samples, self.hypotheses))?;
        f.write_str(if self.roams {
            ", any vehicle in any area"
        } else {
            ", a unicycle in a rectangle"
        })
    }
}

/// What there is room for, in words. A follower of fronts stores no samples.
fn holds(samples: u16, hypotheses: u16) -> String {
    match (samples, hypotheses) {
        (0, _) => "no samples".to_owned(),
        (_, 0 | 1) => format!("{samples} samples"),
        _ => format!("{samples} samples, {hypotheses} hypotheses"),
    }
}

/// A program that was measured: what it can fly.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// Its name among the measurements.
    pub name: &'static str,
    planners: &'static [Planner],
    samples: u16,
    hypotheses: u16,
    roams: bool,
}

const ALL: &[Planner] = &[Planner::Cfc, Planner::Scc, Planner::Lookahead];
const TRUE: &[Planner] = &[Planner::Cfc, Planner::Lookahead];

/// Those of `tests/bare-core`, the smaller before the larger.
pub const PROGRAMS: [Program; 7] = [
    Program::new("alone", &[Planner::Cfc], 16, 1),
    Program::new("small", TRUE, 16, 1),
    Program::new("medium", TRUE, 68, 1),
    Program::new("standard", ALL, 36, 529),
    Program { roams: true, ..Program::new("vehicles", ALL, 36, 529) },
    Program::new("large", ALL, 68, 2_081),
    Program::new("track", &[Planner::Track], 0, 0),
];

impl Program {
    const fn new(
        name: &'static str,
        planners: &'static [Planner],
        samples: u16,
        hypotheses: u16,
    ) -> Self {
        Self { name, planners, samples, hypotheses, roams: false }
    }

    /// Whether it has room for all that is asked.
    pub fn covers(&self, asked: Configuration) -> bool {
        self.planners.contains(&asked.planner)
            && self.samples >= asked.samples
            && self.hypotheses >= asked.hypotheses
            && (self.roams || !asked.roams)
    }

    /// What it has room for.
    pub fn room(&self) -> String {
        let roams = if self.roams { ", any vehicle in any area" } else { "" };
        holds(self.samples, self.hypotheses) + roams
    }
}
