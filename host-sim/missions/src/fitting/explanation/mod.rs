//! What explains labels: a straight, still line, or else a bend, a drift, a second boundary, or a fault of the sensor.
//!
//! Of labels that are said to be true, each cause has a share of the chance (`exact`). Of labels that may be
//! wrong, a cause is named if it makes them much more likely than any straight line does (`doubtful`). The bars are
//! measured, so that 1 straight survey in 100 is refused at most.

mod counts;
mod doubtful;
mod exact;
mod labels;
mod shapes;
mod stretch;

use std::collections::BTreeMap;

use planner_core::{Line, Sample};
use serde::{Deserialize, Serialize};

/// What explains labels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cause {
    /// A straight, still line does.
    Line,
    /// The boundary bends.
    Bend,
    /// The boundary moves.
    Drift,
    /// There are two boundaries, or one with a corner.
    #[serde(rename = "two boundaries")]
    TwoBoundaries,
    /// The sensor repeats a label.
    Stuck,
    /// The sensor reads the other label.
    Inverted,
    /// One of the two: the labels are the same.
    #[serde(rename = "stuck or inverted")]
    StuckOrInverted,
    /// Labels come some samples late.
    Late,
    /// Labels are wrong at random.
    Random,
    /// The labels do not tell.
    #[default]
    #[serde(rename = "cannot tell")]
    Unclear,
}

/// Labels, and what is said of them.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// Samples whose labels are certain.
    pub given: &'a [Sample],
    /// The samples that were read, each with its time or its row, in order.
    pub read: &'a [(Sample, u32)],
    /// How often labels are true, if some may be wrong.
    pub p: Option<f64>,
    /// How far off their positions may be, metres.
    pub tolerance: f64,
    /// The best line.
    pub line: &'a Line,
}

/// What explains labels.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The labels that may disagree with the best line: those further from it than the tolerance.
    pub labels: usize,
    /// How many of them do.
    pub disagreeing: usize,
    /// How many of them would, least and most, if a straight line is true.
    pub expected: [usize; 2],
    /// The cause, if one is clearly better than all others.
    pub cause: Cause,
    /// Of labels that are true: the probability of each cause, if all are alike beforehand.
    pub shares: BTreeMap<Cause, f64>,
    /// The tolerance that covers a bend or a drift, if it is one, metres.
    pub tolerance: Option<f64>,
    /// More of the cause, of labels that may be wrong.
    pub found: Option<Found>,
}

/// A cause other than a straight line, with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "each variant says what its numbers are")]
pub enum Found {
    /// An arc of this radius, which is so far from its chord, metres. So many labels disagree with it.
    Bend { radius: f64, sagitta: f64, disagreeing: usize },
    /// A line that moved so far while the labels were read, metres.
    Drift { metres: f64, disagreeing: usize },
    /// Two lines.
    TwoBoundaries { disagreeing: usize },
    /// The labels from one time to another do not depend on places as the others do: so many, of which so many disagree
    /// with the line. Labels elsewhere are true with probability `p`.
    Stretch { times: [u32; 2], fault: Fault, counts: [usize; 2], p: f64 },
}

/// What labels say in a stretch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// Either label, as a coin falls.
    Coin,
    /// The label of the other side.
    Inverted,
    /// The same label: whether it is +1.
    Stuck(bool),
}

impl Explanation {
    /// What explains labels.
    pub fn of(question: &Question) -> Self {
        question.p.map_or_else(|| question.exact(), |p| question.doubtful(p))
    }

    /// Of so many labels that all agree with a straight line.
    pub fn agreeing(labels: usize) -> Self {
        Self {
            labels,
            disagreeing: 0,
            expected: [0; 2],
            cause: Cause::Line,
            shares: BTreeMap::new(),
            tolerance: None,
            found: None,
        }
    }

    /// How often labels are true, by those that disagree: Laplace's rule. Its one label more makes up for the one or two
    /// that the fit takes.
    pub fn suggested_p(&self) -> f64 {
        (1.0 - (self.disagreeing + 1) as f64 / (self.labels + 2) as f64).max(0.5)
    }

    /// The verdict in a word or three.
    pub fn verdict(&self) -> &'static str {
        match self.found {
            Some(Found::Bend { .. }) => "bend",
            Some(Found::Drift { .. }) => "drift",
            Some(Found::TwoBoundaries { .. }) => "two boundaries",
            Some(Found::Stretch { .. }) => "run",
            None if self.disagreeing > self.expected[1] => "p too high",
            None if self.disagreeing < self.expected[0] => "p too low",
            None => "fits",
        }
    }

    /// Whether the line is not to be trusted. A `p` that is too low only makes sets too wide.
    pub fn is_bad(&self) -> bool {
        self.found.is_some() || self.disagreeing > self.expected[1]
    }
}

impl Found {
    fn cause(self) -> Cause {
        match self {
            Self::Bend { .. } => Cause::Bend,
            Self::Drift { .. } => Cause::Drift,
            Self::TwoBoundaries { .. } => Cause::TwoBoundaries,
            Self::Stretch { fault: Fault::Stuck(_), .. } => Cause::Stuck,
            Self::Stretch { fault: Fault::Inverted, .. } => Cause::Inverted,
            Self::Stretch { fault: Fault::Coin, .. } => Cause::Random,
        }
    }

    /// The tolerance that covers it: half of its extent.
    fn tolerance(self) -> Option<f64> {
        match self {
            Self::Bend { sagitta: metres, .. } | Self::Drift { metres, .. } => Some(0.5 * metres),
            Self::TwoBoundaries { .. } | Self::Stretch { .. } => None,
        }
    }
}
