//! A figure's title and legend.

use anyhow::Result;
use planner_core::belief::sample::Label;
use plotters::coord::Shift;
use plotters::prelude::*;

use crate::report::ground::Ground;
use crate::report::picture::Picture;
use crate::report::style::{self, PATH, SHADE, failed, symbol};

/// Draws them.
pub(crate) fn draw(picture: &Picture, legend: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
    let font = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
    legend.draw(&Text::new(picture.title.clone(), (16, 12), font(19))).map_err(failed)?;
    let text = |words: &str, x: i32, y: i32| {
        legend.draw(&Text::new(words.to_owned(), (x + 34, y - 8), font(14))).map_err(failed)
    };
    let (left, right, rows) = (20, 400, [50, 72, 94, 116]);
    let stroke = |x: i32, y: i32, length: i32, colour: RGBColor, width: u32| {
        let style = colour.stroke_width(width);
        legend.draw(&PathElement::new([(x, y), (x + length, y)], style)).map_err(failed)
    };
    let certain = matches!(picture.ground, Ground::Certain(_));
    for (label, y) in [(Label::Positive, rows[0]), (Label::Negative, rows[1])] {
        if certain {
            let corners = [(left, y - 9), (left + 26, y + 9)];
            let ground = Rectangle::new(corners, style::of_label(label).mix(0.18).filled());
            legend.draw(&ground).map_err(failed)?;
        }
        symbol(legend, (left + 13, y), label, 5)?;
        let known = if certain { ", ground certain to have it" } else { "" };
        text(&format!("label {:+}{known}", label.sign()), left, y)?;
    }
    if let Some((_, stops)) = &picture.path {
        stroke(left, rows[2], 26, PATH, 1)?;
        stroke(left + 12, rows[2], 14, PATH, 2)?;
        let errs = stops.iter().any(|stop| stop.truly.is_some());
        let truly = if errs { "; x: where it truly was" } else { "" };
        text(&format!("path with headings; o: no sample{truly}"), left, rows[2])?;
    }
    if let Some(note) = &picture.note {
        text(note, left, rows[2])?;
    }
    if let Ground::Credible(..) = &picture.ground {
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
    if picture.area.hulls().next().is_some() {
        let corners = [(right + 210, rows[0] - 9), (right + 236, rows[0] + 9)];
        legend.draw(&Rectangle::new(corners, style::KEEP_OUT.filled())).map_err(failed)?;
        text("kept out of", right + 210, rows[0])?;
    }
    let mut row = rows.into_iter();
    if let (Some(_), Some(y)) = (picture.truth, row.next()) {
        stroke(right, y, 26, BLACK, 2)?;
        text("true line", right, y)?;
    }
    for (named, y) in picture.lines.iter().zip(row) {
        stroke(right, y, 10, style::of_line(named.kind), 2)?;
        stroke(right + 15, y, 10, style::of_line(named.kind), 2)?;
        text(&named.name, right, y)?;
    }
    Ok(())
}
