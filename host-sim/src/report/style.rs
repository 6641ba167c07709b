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

/// How ground is filled: with a colour, and with strokes if it is hatched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fill {
    pub(crate) class: &'static str,
    pub(crate) colour: &'static str,
    /// The colour of the strokes of a square tile, these, and its side in pixels.
    pub(crate) strokes: Option<(&'static str, &'static str, u32)>,
}

/// Ground that has a label.
pub(crate) const GROUND_POSITIVE: Fill =
    hatched("ground-positive", "#fbe9dc", ("#efc3a3", "M-2,10L10,-2M-2,2L2,-2M6,10L10,6", 8));
pub(crate) const GROUND_NEGATIVE: Fill =
    hatched("ground-negative", "#ddebf5", ("#a9cbe3", "M-2,-2L10,10M-2,6L2,10M6,-2L10,2", 8));
/// Labels may be wrong there.
pub(crate) const DOUBTFUL: Fill =
    hatched("ground-doubtful", "#f3efdc", ("#b9ad72", "M1,2L3,2M5,6L7,6", 8));
pub(crate) const KEEP_OUT: Fill =
    hatched("keep-out", "#c9c9c9", ("#6e6e6e", "M-1,7L7,-1M-1,-1L7,7", 6));
/// All that are hatched.
pub(crate) const HATCHED: [Fill; 4] = [GROUND_POSITIVE, GROUND_NEGATIVE, DOUBTFUL, KEEP_OUT];

/// Nothing is said of it.
pub(crate) const BLANK: Fill = plain("ground-blank", "#ffffff");
/// Not of the area.
pub(crate) const OUTSIDE: Fill = plain("outside", "#e4e4e4");
/// Where a front lies.
pub(crate) const FRONT_BAND: Fill = plain("front-band", SHADES[2].colour);

/// The shades of bands, the least likely first.
pub(crate) const SHADES: [Fill; LEAST.len()] = [
    plain("shading", "#f0e8f6"),
    plain("shading", "#dccbe9"),
    plain("shading", "#c3a5d7"),
    plain("shading", "#a67cc2"),
    plain("shading", "#8653a6"),
];

const fn plain(class: &'static str, colour: &'static str) -> Fill {
    Fill { class, colour, strokes: None }
}

const fn hatched(
    class: &'static str,
    colour: &'static str,
    strokes: (&'static str, &'static str, u32),
) -> Fill {
    Fill { class, colour, strokes: Some(strokes) }
}

impl Fill {
    /// The paint: the colour, or the pattern of this name.
    pub(crate) fn paint(self) -> String {
        self.strokes.map_or_else(|| self.colour.to_owned(), |_| format!("url(#{})", self.class))
    }
}

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
