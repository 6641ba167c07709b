//! Colours, strokes and fills that figures share. Whatever differs in colour differs in dashes, hatching or lightness
//! too, so that a figure can be read in black and white.

use planner_core::Label;

use crate::report::bands::LEAST;
use crate::report::picture::Kind;

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
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// What it is, for programs that read the figure.
    pub(crate) class: &'static str,
    pub(crate) colour: &'static str,
    pub(crate) width: f64,
    pub(crate) dashes: &'static str,
}

pub(crate) const TRUTH: Stroke = solid("truth", "#000000", 2.2);
pub(crate) const PAST_TRUTH: Stroke =
    Stroke { class: "past-truth", colour: "#000000", width: 2.2, dashes: "2 5" };
/// The front as it is mapped, and the true one, thin so that it does not hide the map.
pub(crate) const FRONT: Stroke = solid("front", "#00784f", 2.2);
pub(crate) const TRUE_FRONT: Stroke =
    Stroke { class: "truth", colour: "#000000", width: 1.0, dashes: "4 5" };
pub(crate) const PATH: Stroke = solid("path", "#4a4a4a", 1.1);
pub(crate) const HEADING: Stroke = solid("heading", "#4a4a4a", 2.6);
/// All of the area beside a part of it.
pub(crate) const INSET: Stroke = solid("inset", INK, 1.2);
pub(crate) const BORDER: Stroke = solid("border", INK, 0.8);

const fn solid(class: &'static str, colour: &'static str, width: f64) -> Stroke {
    Stroke { class, colour, width, dashes: "" }
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

pub(crate) const fn of_line(kind: Kind) -> Stroke {
    let (class, colour, width, dashes) = match kind {
        Kind::Estimate => ("estimate", "#00784f", 2.2, "9 5"),
        Kind::Printed => ("printed-estimate", "#be003c", 2.0, "10 4 2 4"),
        Kind::Bound => ("bound", "#5b2a86", 1.6, "2 3"),
        Kind::MaximumMargin => ("maximum-margin", "#be003c", 2.2, "9 5"),
        Kind::SecondBest => ("second-best", "#5a5a5a", 1.8, "6 4 2 4"),
        Kind::ThirdBest => ("third-best", "#8a8a8a", 1.8, "2 4"),
        Kind::Fewest => ("fewest", "#be003c", 2.0, "3 3"),
    };
    Stroke { class, colour, width, dashes }
}

/// The curves of the planners of a campaign, one after the other: the hues of Okabe and Ito.
pub(crate) const CURVES: [Stroke; 6] = [
    Stroke { class: "curve-1", colour: "#0072b2", width: 2.0, dashes: "" },
    Stroke { class: "curve-2", colour: "#d55e00", width: 2.0, dashes: "9 4" },
    Stroke { class: "curve-3", colour: "#009e73", width: 2.0, dashes: "2 3" },
    Stroke { class: "curve-4", colour: "#a0458a", width: 2.0, dashes: "10 4 2 4" },
    Stroke { class: "curve-5", colour: "#7a6a00", width: 2.0, dashes: "5 3" },
    Stroke { class: "curve-6", colour: "#333333", width: 2.0, dashes: "1 5" },
];
