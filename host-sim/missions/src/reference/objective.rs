//! What a full-horizon problem asks beside the control: what the line costs, and which samples it allows.

use planner_core::{Label, Reading, Sample, Site};
use serde::Serialize;

use crate::reference::margin::Gap;
use crate::reference::slopes::Slopes;

/// What a line costs in Section II-A.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum LineCost {
    /// slope^2 / 2, with every sample a metre above or below the line, as printed
    #[default]
    Slope,
    /// 1 / (2 margin^2) of the line furthest from the samples, as the text around it says
    Margin,
}

/// A full-horizon problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Problem {
    /// Section II-A: a line that divides the samples, and both labels equally often.
    Divided(LineCost),
    /// Section II-B: as many samples as possible on the side of their true label.
    Labelled,
}

impl Problem {
    /// The paper's section.
    pub fn section(self) -> &'static str {
        match self {
            Self::Divided(_) => "II-A",
            Self::Labelled => "II-B",
        }
    }

    /// What the cost of the line is called.
    pub fn line_cost(self) -> &'static str {
        match self {
            Self::Divided(LineCost::Slope) => "slope^2 / 2",
            Self::Divided(LineCost::Margin) => "1 / (2 margin^2)",
            Self::Labelled => "-(labels on their side)",
        }
    }

    /// Whether a complete sequence may have this sum of labels.
    pub fn allows_sum(self, sum: i32) -> bool {
        self == Self::Labelled || sum.abs() <= 1
    }

    /// The lines that the given samples leave, before any other; `None` if it has none that the problem allows.
    pub fn begin(self, given: &[Sample], above: Label, at_start: Reading) -> Option<Lines> {
        let begun = match self {
            Self::Divided(LineCost::Slope) => Lines::Sloped(Slopes::all(above)),
            Self::Divided(LineCost::Margin) => Lines::Apart(Gap::OPEN),
            Self::Labelled => return Some(Lines::Agreeing(at_start.sign().unsigned_abs().into())),
        };
        given.iter().enumerate().try_fold(begun, |lines, (k, sample)| {
            lines.with(&given[..k], sample.site, sample.label.into())
        })
    }
}

/// The lines that samples leave, as far as a problem's cost depends on them.
#[derive(Clone, Copy, Debug)]
pub enum Lines {
    /// By their slopes.
    Sloped(Slopes),
    /// By the room between the samples of either label.
    Apart(Gap),
    /// By how many samples can be on their side.
    Agreeing(u32),
}

impl Lines {
    /// The lines that another sample leaves; `None` if the problem does not allow that sample.
    #[must_use]
    pub fn with(self, earlier: &[Sample], site: Site, reading: Reading) -> Option<Self> {
        let side = match reading {
            Reading::Side(label) => Some(Sample { site, label }),
            Reading::Boundary => None,
        };
        match self {
            Self::Sloped(slopes) => slopes.with(earlier, side?).map(Self::Sloped),
            Self::Apart(gap) => Some(Self::Apart(gap.with(earlier, side?))),
            // On the true line the sign is 0, whatever line is drawn.
            Self::Agreeing(count) => Some(Self::Agreeing(count + u32::from(side.is_some()))),
        }
    }

    /// A lower bound on the cost of the best line after `left` further samples. With none left it is the cost.
    pub fn cost(self, left: u32) -> f64 {
        match self {
            Self::Sloped(slopes) => slopes.least().powi(2) / 2.0,
            Self::Apart(gap) => 0.5 / gap.margin_squared(),
            Self::Agreeing(count) => -f64::from(count + left),
        }
    }
}
