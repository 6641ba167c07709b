//! Colours, strokes and fills that figures share. Whatever differs in colour differs in dashes, hatching or lightness
//! too, so that a figure can be read in black and white.

use planner_core::Label;
use serde::Serialize;

use crate::report::bands::LEAST;

// Orange for +1 and blue for -1, as in the paper's Figure 1, in hues that colour-blind readers tell apart.
const POSITIVE: &str = "#d55e00";
const NEGATIVE: &str = "#0072b2";
// The same for labels that tell nothing of a front, as they were read far from it.
const FAINT_POSITIVE: &str = "#f0b78c";
const FAINT_NEGATIVE: &str = "#a3cbe6";

/// The colour of text, axes and outlines.
pub(crate) const INK: &str = "#1a1a1a";

/// How many shades there are.
pub(crate) const SHADES_COUNT: usize = LEAST.len();

/// The shades of bands, the least likely first.
const SHADES: [&str; SHADES_COUNT] = ["#f0e8f6", "#dccbe9", "#c3a5d7", "#a67cc2", "#8653a6"];

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Stroke {
    /// What it is, for programs that read the figure.
    pub(crate) class: &'static str,
    #[serde(skip)]
    pub(crate) colour: &'static str,
    #[serde(skip)]
    pub(crate) width: f64,
    #[serde(skip)]
    pub(crate) dashes: &'static str,
}

pub(crate) const TRUTH: Stroke = solid("truth", "#000000", 2.2);
pub(crate) const PAST_TRUTH: Stroke = dashed("past-truth", "#000000", 2.2, "2 5");
/// The front as it is mapped, and the true one, thin so that it does not hide the map.
pub(crate) const FRONT: Stroke = solid("front", "#00784f", 2.2);
pub(crate) const TRUE_FRONT: Stroke = dashed("truth", "#000000", 1.0, "4 5");
pub(crate) const PATH: Stroke = solid("path", "#4a4a4a", 1.1);
pub(crate) const HEADING: Stroke = solid("heading", "#4a4a4a", 2.6);
/// All of the area beside a part of it.
pub(crate) const INSET: Stroke = solid("inset", INK, 1.2);
pub(crate) const BORDER: Stroke = solid("border", INK, 0.8);

/// The estimate that is recommended.
pub(crate) const ESTIMATE: Stroke = dashed("estimate", "#00784f", 2.2, "9 5");
/// The paper's printed estimate.
pub(crate) const PRINTED: Stroke = dashed("printed-estimate", "#be003c", 2.0, "10 4 2 4");
/// An end of the credible slopes.
pub(crate) const BOUND: Stroke = dashed("bound", "#5b2a86", 1.6, "2 3");
/// The plain maximum margin, and the candidates after it.
pub(crate) const CANDIDATES: [Stroke; 3] = [
    dashed("maximum-margin", "#be003c", 2.2, "9 5"),
    dashed("second-best", "#5a5a5a", 1.8, "6 4 2 4"),
    dashed("third-best", "#8a8a8a", 1.8, "2 4"),
];
/// The line that the fewest labels disagree with, if no line explains them all.
pub(crate) const FEWEST: Stroke = dashed("fewest", "#be003c", 2.0, "3 3");

const fn solid(class: &'static str, colour: &'static str, width: f64) -> Stroke {
    dashed(class, colour, width, "")
}

pub(crate) const fn dashed(
    class: &'static str,
    colour: &'static str,
    width: f64,
    dashes: &'static str,
) -> Stroke {
    Stroke { class, colour, width, dashes }
}

/// How ground is filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fill {
    /// It has a label.
    Of(Label),
    /// Nothing is said of it.
    Blank,
    /// Labels may be wrong there.
    Doubtful,
    /// Kept out of.
    KeepOut,
    /// Not of the area.
    Outside,
    /// Where a front lies.
    Front,
    /// A band, by its number.
    Shade(usize),
}

impl Fill {
    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::Of(Label::Positive) => "ground-positive",
            Self::Of(Label::Negative) => "ground-negative",
            Self::Blank => "ground-blank",
            Self::Doubtful => "ground-doubtful",
            Self::KeepOut => "keep-out",
            Self::Outside => "outside",
            Self::Front => "front-band",
            Self::Shade(_) => "shading",
        }
    }

    /// The paint: a colour, or one of [`HATCHES`].
    pub(crate) fn paint(self) -> String {
        match self {
            Self::Blank => "#ffffff".to_owned(),
            Self::Outside => "#e4e4e4".to_owned(),
            Self::Front => SHADES[2].to_owned(),
            Self::Shade(k) => SHADES[k.min(SHADES.len() - 1)].to_owned(),
            hatched => format!("url(#{})", hatched.class()),
        }
    }
}

/// Hatched fills: the ground and the strokes of a square tile, its side in pixels.
pub(crate) struct Hatch {
    pub(crate) fill: Fill,
    pub(crate) ground: &'static str,
    pub(crate) ink: &'static str,
    pub(crate) strokes: &'static str,
    pub(crate) side: u32,
}

pub(crate) const HATCHES: [Hatch; 4] = [
    Hatch {
        fill: Fill::Of(Label::Positive),
        ground: "#fbe9dc",
        ink: "#efc3a3",
        strokes: "M-2,10L10,-2M-2,2L2,-2M6,10L10,6",
        side: 8,
    },
    Hatch {
        fill: Fill::Of(Label::Negative),
        ground: "#ddebf5",
        ink: "#a9cbe3",
        strokes: "M-2,-2L10,10M-2,6L2,10M6,-2L10,2",
        side: 8,
    },
    Hatch {
        fill: Fill::Doubtful,
        ground: "#f3efdc",
        ink: "#b9ad72",
        strokes: "M1,2L3,2M5,6L7,6",
        side: 8,
    },
    Hatch {
        fill: Fill::KeepOut,
        ground: "#c9c9c9",
        ink: "#6e6e6e",
        strokes: "M-1,7L7,-1M-1,-1L7,7",
        side: 6,
    },
];

pub(crate) fn of_label(label: Label) -> &'static str {
    match label {
        Label::Positive => POSITIVE,
        Label::Negative => NEGATIVE,
    }
}

pub(crate) fn faint(label: Label) -> &'static str {
    match label {
        Label::Positive => FAINT_POSITIVE,
        Label::Negative => FAINT_NEGATIVE,
    }
}

/// The curves of the planners of a campaign, one after the other: the hues of Okabe and Ito.
pub(crate) const CURVES: [Stroke; 6] = [
    solid("curve-1", "#0072b2", 2.0),
    dashed("curve-2", "#d55e00", 2.0, "9 4"),
    dashed("curve-3", "#009e73", 2.0, "2 3"),
    dashed("curve-4", "#a0458a", 2.0, "10 4 2 4"),
    dashed("curve-5", "#7a6a00", 2.0, "5 3"),
    dashed("curve-6", "#333333", 2.0, "1 5"),
];
