//! Figures in the manner of the paper's Figure 7, as SVG.

use anyhow::Result;
use nalgebra::{Point2, Vector2};
use planner_core::belief::sample::Label;
use planner_core::geometry::line::Line;
use planner_core::geometry::region::Region as _;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::report::bands::Band;
use crate::report::ground::Ground;
use crate::report::legend;
use crate::report::picture::{Named, Picture, Stop};
use crate::report::style::{self, PATH, SHADE, failed, symbol};
use crate::world::polygon::Polygon;

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn xy(point: Point2<f64>) -> (f64, f64) {
    (point.x, point.y)
}

impl Picture {
    /// The picture as an SVG document.
    ///
    /// # Errors
    /// When the drawing library fails.
    pub fn svg(&self) -> Result<String> {
        const SIZE: f64 = 760.0;
        let bounds = self.area.bounds();
        let [min, max] = [bounds.min(), bounds.max()].map(Point2::<f64>::from);
        let (width, height) = (max.x - min.x, max.y - min.y);
        let scale = SIZE / width.max(height);
        let margins = (125.0, 210.0); // axes below and left; title, legend and axis above
        let canvas = |length: f64, margin: f64| ((length * scale).max(260.0) + margin) as u32;
        let mut svg = String::new();
        {
            let size = (canvas(width, margins.0), canvas(height, margins.1));
            let root = SVGBackend::with_string(&mut svg, size).into_drawing_area();
            root.fill(&WHITE).map_err(failed)?;
            let (legend, plot) = root.split_vertically(130);
            legend::draw(self, &legend)?;
            let mut chart = ChartBuilder::on(&plot)
                .margin(15)
                .margin_right(35)
                .x_label_area_size(45)
                .y_label_area_size(75)
                .build_cartesian_2d(min.x..max.x, min.y..max.y)
                .map_err(failed)?;
            self.draw_ground(&mut chart)?;
            chart
                .configure_mesh()
                .light_line_style(TRANSPARENT)
                .bold_line_style(BLACK.mix(0.08))
                .x_label_formatter(&|x| format!("{x}"))
                .y_label_formatter(&|z| format!("{z}"))
                .x_desc("x, m")
                .y_desc("z, m")
                .label_style(("sans-serif", 15))
                .draw()
                .map_err(failed)?;
            self.draw_area(&mut chart)?;
            self.draw_lines(&mut chart)?;
            self.draw_path(&mut chart, 14.0 / scale)?;
            self.draw_samples(&mut chart)?;
            root.present().map_err(failed)?;
        }
        Ok(svg)
    }

    fn draw_ground(&self, chart: &mut Chart) -> Result<()> {
        match &self.ground {
            Ground::Certain(regions) => draw_certain(chart, regions),
            Ground::Credible(bands) => draw_credible(chart, bands),
            Ground::Plain => Ok(()),
        }
    }

    /// The border of a polygon, and what is kept out of.
    fn draw_area(&self, chart: &mut Chart) -> Result<()> {
        if self.area.sides().next().is_some() {
            let corners = self.area.corners().iter().chain(self.area.corners().first());
            let border = corners.map(|corner| xy(Point2::from(*corner))).collect::<Vec<_>>();
            let style = BLACK.mix(0.6).stroke_width(1);
            chart.draw_series([PathElement::new(border, style)]).map_err(failed)?;
        }
        for keep_out in self.area.hulls() {
            let outline: Vec<_> = Polygon::from(keep_out).0.into_iter().map(xy).collect();
            let fill = style::KEEP_OUT.filled();
            chart.draw_series([plotters::element::Polygon::new(outline, fill)]).map_err(failed)?;
        }
        Ok(())
    }

    fn draw_lines(&self, chart: &mut Chart) -> Result<()> {
        let across = |line: Line| {
            let part = Polygon::from(self.area).clip(&line, 1.0);
            let on = part.0.into_iter().filter(move |p| line.distance(*p).abs() < 1e-6);
            on.map(xy).collect::<Vec<_>>()
        };
        if let Some(truth) = self.truth {
            let style = BLACK.stroke_width(2);
            chart.draw_series([PathElement::new(across(truth), style)]).map_err(failed)?;
        }
        for Named { line, kind, beside, .. } in &self.lines {
            let ends = across(*line);
            let colour = style::of_line(*kind);
            let style = colour.stroke_width(2);
            chart.draw_series(DashedLineSeries::new(ends.clone(), 9, 6, style)).map_err(failed)?;
            if let (Some(beside), Some(&end)) =
                (beside, ends.iter().max_by(|a, b| a.0.total_cmp(&b.0)))
            {
                let font = ("sans-serif", 15).into_font().color(&colour);
                let text = Text::new(beside.clone(), (4, -8), font);
                chart.draw_series([EmptyElement::at(end) + text]).map_err(failed)?;
            }
        }
        Ok(())
    }

    /// The path with a tick at each pose that shows its heading; `tick` in metres.
    fn draw_path(&self, chart: &mut Chart, tick: f64) -> Result<()> {
        let Some((start, stops)) = &self.path else { return Ok(()) };
        let places = stops.iter().flat_map(|stop| &stop.way);
        let corners: Vec<_> = std::iter::once(start).chain(places).copied().map(xy).collect();
        chart.draw_series([PathElement::new(corners, PATH.stroke_width(1))]).map_err(failed)?;
        for (&Stop { at, truly, heading, sensed, .. }, number) in stops.iter().zip(1..) {
            let (sin, cos) = libm::sincos(heading);
            let tip = at + Vector2::new(cos, sin) * tick;
            chart
                .draw_series([PathElement::new([xy(at), xy(tip)], PATH.stroke_width(2))])
                .map_err(failed)?;
            let style = ("sans-serif", 13).into_font().color(&BLACK.mix(0.75));
            let beside = EmptyElement::at(xy(at)) + Text::new(format!("{number}"), (7, -15), style);
            chart.draw_series([beside]).map_err(failed)?;
            if let Some(truly) = truly {
                let style = BLACK.stroke_width(1);
                let way = PathElement::new([xy(at), xy(truly)], style);
                chart.draw_series([way]).map_err(failed)?;
                chart.draw_series([Cross::new(xy(truly), 4, style)]).map_err(failed)?;
            }
            if !sensed {
                chart
                    .draw_series([Circle::new(xy(at), 4, PATH.stroke_width(1))])
                    .map_err(failed)?;
            }
        }
        Ok(())
    }

    fn draw_samples(&self, chart: &mut Chart) -> Result<()> {
        for (i, dot) in self.samples.iter().enumerate() {
            let given = i < self.given;
            let place = xy(dot.at);
            if dot.wrong {
                let ring = Circle::new((0, 0), 10, BLACK.stroke_width(1));
                chart.draw_series([EmptyElement::at(place) + ring]).map_err(failed)?;
            }
            symbol(chart.plotting_area(), place, dot.label, if given { 7 } else { 5 })?;
            if given {
                let style = ("sans-serif", 15).into_font().color(&BLACK);
                let name = Text::new(format!("p{}", i + 1), (-24, -18), style);
                chart.draw_series([EmptyElement::at(place) + name]).map_err(failed)?;
            }
        }
        Ok(())
    }
}

/// The two regions of certainty.
fn draw_certain(chart: &mut Chart, regions: &[Polygon; 2]) -> Result<()> {
    for (label, region) in [Label::Positive, Label::Negative].into_iter().zip(regions) {
        let corners: Vec<_> = region.0.iter().copied().map(xy).collect();
        if corners.len() >= 3 {
            let fill = style::of_label(label).mix(0.18).filled();
            chart.draw_series([plotters::element::Polygon::new(corners, fill)]).map_err(failed)?;
        }
    }
    Ok(())
}

/// The credible set: the likelier that the line passes, the darker.
fn draw_credible(chart: &mut Chart, bands: &[Band]) -> Result<()> {
    for Band { rings, .. } in bands {
        for ring in rings {
            let corners: Vec<_> = ring.iter().copied().map(xy).collect();
            let fill = SHADE.mix(0.15).filled();
            chart.draw_series([plotters::element::Polygon::new(corners, fill)]).map_err(failed)?;
        }
    }
    Ok(())
}
