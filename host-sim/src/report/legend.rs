//! A figure's title and legend, and the marks that both share.

use anyhow::Result;
use planner_core::belief::sample::Label;
use plotters::coord::{CoordTranslate, Shift};
use plotters::prelude::*;

use crate::report::figure::{Figure, Ground, PATH, SHADE, colour, failed};

impl Figure<'_> {
    pub(crate) fn draw_legend(&self, legend: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        let font = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
        legend.draw(&Text::new(self.title.clone(), (16, 12), font(19))).map_err(failed)?;
        let text = |words: &str, x: i32, y: i32| {
            legend.draw(&Text::new(words.to_owned(), (x + 34, y - 8), font(14))).map_err(failed)
        };
        let (left, right, rows) = (20, 400, [50, 72, 94, 116]);
        let stroke = |x: i32, y: i32, length: i32, colour: RGBColor, width: u32| {
            let style = colour.stroke_width(width);
            legend.draw(&PathElement::new([(x, y), (x + length, y)], style)).map_err(failed)
        };
        let certain = matches!(self.ground, Ground::Certain(_));
        for (label, y) in [(Label::Positive, rows[0]), (Label::Negative, rows[1])] {
            if certain {
                let corners = [(left, y - 9), (left + 26, y + 9)];
                let ground = Rectangle::new(corners, colour(label).mix(0.18).filled());
                legend.draw(&ground).map_err(failed)?;
            }
            mark(legend, (left + 13, y), label, 5)?;
            let known = if certain { ", ground certain to have it" } else { "" };
            text(&format!("label {:+}{known}", label.sign()), left, y)?;
        }
        if self.path.is_some() {
            stroke(left, rows[2], 26, PATH, 1)?;
            stroke(left + 12, rows[2], 14, PATH, 2)?;
            text("path with headings; o: no sample", left, rows[2])?;
        }
        if let Some(note) = &self.note {
            text(note, left, rows[2])?;
        }
        if let Ground::Credible(..) = self.ground {
            let corners = [(left, rows[3] - 9), (left + 26, rows[3] + 9)];
            let shade = SHADE.mix(0.5).filled();
            legend.draw(&Rectangle::new(corners, shade)).map_err(failed)?;
            text("lines of the 90 % credible set; ringed: a wrong label", left, rows[3])?;
        } else if !certain {
            legend
                .draw(&Circle::new((left + 13, rows[2]), 9, BLACK.stroke_width(1)))
                .map_err(failed)?;
            text("a wrong label", left, rows[2])?;
        }
        let mut row = rows.into_iter();
        if let (Some(_), Some(y)) = (self.truth, row.next()) {
            stroke(right, y, 26, BLACK, 2)?;
            text("true line", right, y)?;
        }
        for (named, y) in self.lines.iter().zip(row) {
            stroke(right, y, 10, named.colour, 2)?;
            stroke(right + 15, y, 10, named.colour, 2)?;
            text(&named.name, right, y)?;
        }
        Ok(())
    }
}

/// A sample's mark: a disc for +1, a square for -1.
pub(crate) fn mark<C: CoordTranslate<From = P>, P: Clone + 'static>(
    area: &DrawingArea<SVGBackend, C>,
    place: P,
    label: Label,
    size: i32,
) -> Result<()> {
    let style = colour(label).filled();
    match label {
        Label::Positive => area.draw(&(EmptyElement::at(place) + Circle::new((0, 0), size, style))),
        Label::Negative => {
            let corners = [(1 - size, 1 - size), (size - 1, size - 1)];
            area.draw(&(EmptyElement::at(place) + Rectangle::new(corners, style)))
        }
    }
    .map_err(failed)
}
