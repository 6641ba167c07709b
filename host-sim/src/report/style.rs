//! Colours and symbols that figures share.

use std::fmt::Display;

use anyhow::{Result, anyhow};
use planner_core::belief::sample::Label;
use plotters::coord::CoordTranslate;
use plotters::prelude::*;

use crate::report::picture::Kind;

// Orange for +1 and blue for -1, as in the paper's Figure 1, in hues that colour-blind readers tell
// apart; shapes tell them apart too.
const POSITIVE: RGBColor = RGBColor(213, 94, 0);
const NEGATIVE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const PATH: RGBColor = RGBColor(90, 90, 90);
pub(crate) const SHADE: RGBColor = RGBColor(120, 60, 160);
pub(crate) const KEEP_OUT: RGBColor = RGBColor(150, 150, 150);
pub(crate) const ESTIMATE: RGBColor = RGBColor(0, 120, 80);

pub(crate) fn of_label(label: Label) -> RGBColor {
    match label {
        Label::Positive => POSITIVE,
        Label::Negative => NEGATIVE,
    }
}

pub(crate) fn of_line(kind: Kind) -> RGBColor {
    match kind {
        Kind::Estimate => ESTIMATE,
        Kind::Bound => SHADE,
        Kind::Printed | Kind::MaximumMargin => RGBColor(190, 0, 60),
        Kind::SecondBest => RGBColor(150, 150, 150),
        Kind::ThirdBest => RGBColor(185, 185, 185),
    }
}

pub(crate) fn failed(error: impl Display) -> anyhow::Error {
    anyhow!("the figure could not be drawn: {error}")
}

/// A sample's symbol: a disc for +1, a square for -1.
pub(crate) fn symbol<C: CoordTranslate<From = P>, P: Clone + 'static>(
    area: &DrawingArea<SVGBackend, C>,
    place: P,
    label: Label,
    size: i32,
) -> Result<()> {
    let style = of_label(label).filled();
    match label {
        Label::Positive => area.draw(&(EmptyElement::at(place) + Circle::new((0, 0), size, style))),
        Label::Negative => {
            let corners = [(1 - size, 1 - size), (size - 1, size - 1)];
            area.draw(&(EmptyElement::at(place) + Rectangle::new(corners, style)))
        }
    }
    .map_err(failed)
}
