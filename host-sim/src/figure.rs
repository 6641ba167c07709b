//! Figures in the manner of the paper's Figure 7: what is certain, the path, the labels, the lines.

use std::fmt::Display;

use anyhow::{Result, anyhow};
use nalgebra::{Point2, Vector2};
use planner_core::area::Area;
use planner_core::line::Line;
use planner_core::sample::{Label, Reading, Sample};
use planner_core::version_space::VersionSpace;
use plotters::coord::types::RangedCoordf64;
use plotters::coord::{CoordTranslate, Shift};
use plotters::prelude::*;

use crate::mission::CAPACITY;
use crate::polygon::Polygon;
use crate::recording::{Recorded, Recording};

// Orange for +1 and blue for -1, as in the paper's Figure 1, in hues that colour-blind readers tell
// apart; shapes tell them apart too.
const POSITIVE: RGBColor = RGBColor(213, 94, 0);
const NEGATIVE: RGBColor = RGBColor(0, 114, 178);
const PATH: RGBColor = RGBColor(90, 90, 90);
const ESTIMATE: RGBColor = RGBColor(0, 120, 80);

/// What to draw.
pub struct Figure<'a> {
    /// The title.
    pub title: String,
    /// The ground to show.
    pub area: Area,
    /// What is known at the end.
    pub space: &'a VersionSpace<CAPACITY>,
    /// How many of its samples were given, not taken on the way.
    pub given: usize,
    /// The steps of a mission and where it began.
    pub path: Option<(Point2<f64>, &'a [Recorded])>,
    /// The true line, where known.
    pub truth: Option<Line>,
    /// The estimate.
    pub estimate: Option<Line>,
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn colour(label: Label) -> RGBColor {
    match label {
        Label::Positive => POSITIVE,
        Label::Negative => NEGATIVE,
    }
}

fn failed(error: impl Display) -> anyhow::Error {
    anyhow!("the figure could not be drawn: {error}")
}

fn xy(point: Point2<f64>) -> (f64, f64) {
    (point.x, point.y)
}

impl<'a> Figure<'a> {
    /// The figure of a mission.
    pub fn of(title: &str, recording: &'a Recording) -> Self {
        let mission = &recording.mission;
        Self {
            title: title.to_owned(),
            area: mission.config.area,
            space: &recording.space,
            given: mission.space.samples().len(),
            path: Some((Point2::from(mission.start.site), &recording.steps)),
            truth: Some(mission.truth),
            estimate: recording.estimates().centre,
        }
    }

    /// The figure as an SVG document.
    ///
    /// # Errors
    /// When the drawing library fails.
    pub fn svg(&self) -> Result<String> {
        const SIZE: f64 = 760.0;
        let (min, max) =
            (Point2::<f64>::from(self.area.min()), Point2::<f64>::from(self.area.max()));
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
            self.draw_legend(&legend)?;
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
            self.draw_lines(&mut chart)?;
            self.draw_path(&mut chart, 14.0 / scale)?;
            self.draw_samples(&mut chart)?;
            root.present().map_err(failed)?;
        }
        Ok(svg)
    }

    /// The two regions of certainty: the ground on one side of every bound.
    fn draw_ground(&self, chart: &mut Chart) -> Result<()> {
        for label in [Label::Positive, Label::Negative] {
            let side = f64::from(label.sign());
            let certain = self.space.bounds().fold(Polygon::from(self.area), |ground, bound| {
                ground.clip(&Line::from(bound), side)
            });
            let corners: Vec<_> = certain.0.into_iter().map(xy).collect();
            if corners.len() >= 3 {
                let fill = colour(label).mix(0.18).filled();
                chart
                    .draw_series([plotters::element::Polygon::new(corners, fill)])
                    .map_err(failed)?;
            }
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
        if let Some(estimate) = self.estimate {
            let style = ESTIMATE.stroke_width(2);
            chart
                .draw_series(DashedLineSeries::new(across(estimate), 9, 6, style))
                .map_err(failed)?;
        }
        Ok(())
    }

    /// The path with a tick at each pose that shows its heading; `tick` in metres.
    fn draw_path(&self, chart: &mut Chart, tick: f64) -> Result<()> {
        let Some((start, steps)) = self.path else { return Ok(()) };
        let places = steps.iter().map(|s| Point2::<f64>::from(s.step.pose.site));
        let corners: Vec<_> = std::iter::once(start).chain(places).map(xy).collect();
        chart.draw_series([PathElement::new(corners, PATH.stroke_width(1))]).map_err(failed)?;
        for (s, number) in steps.iter().zip(1..) {
            let at = Point2::<f64>::from(s.step.pose.site);
            let (sin, cos) = libm::sincos(s.step.pose.heading.radians());
            let tip = at + Vector2::new(cos, sin) * tick;
            chart
                .draw_series([PathElement::new([xy(at), xy(tip)], PATH.stroke_width(2))])
                .map_err(failed)?;
            let style = ("sans-serif", 13).into_font().color(&BLACK.mix(0.75));
            let beside = EmptyElement::at(xy(at)) + Text::new(format!("{number}"), (7, -15), style);
            chart.draw_series([beside]).map_err(failed)?;
            if s.step.reading == Some(Reading::Boundary) || s.step.reading.is_none() {
                chart
                    .draw_series([Circle::new(xy(at), 4, PATH.stroke_width(1))])
                    .map_err(failed)?;
            }
        }
        Ok(())
    }

    fn draw_samples(&self, chart: &mut Chart) -> Result<()> {
        for (i, sample) in self.space.samples().iter().enumerate() {
            let given = i < self.given;
            let place = xy(Point2::from(sample.site));
            mark(chart.plotting_area(), place, sample.label, if given { 7 } else { 5 })?;
            if given && self.path.is_some() {
                let style = ("sans-serif", 15).into_font().color(&BLACK);
                let name = Text::new(format!("p{}", i + 1), (-24, -18), style);
                chart.draw_series([EmptyElement::at(place) + name]).map_err(failed)?;
            }
        }
        Ok(())
    }

    fn draw_legend(&self, legend: &DrawingArea<SVGBackend, Shift>) -> Result<()> {
        let font = |size: i32| ("sans-serif", size).into_font().color(&BLACK);
        legend.draw(&Text::new(self.title.clone(), (16, 12), font(19))).map_err(failed)?;
        let text = |words: &str, x: i32, y: i32| {
            legend.draw(&Text::new(words.to_owned(), (x + 34, y - 8), font(14))).map_err(failed)
        };
        let (left, right, rows) = (20, 330, [54, 80, 106]);
        for (label, y, words) in [
            (Label::Positive, rows[0], "label +1, ground certain to have it"),
            (Label::Negative, rows[1], "label -1, ground certain to have it"),
        ] {
            let ground = Rectangle::new(
                [(left, y - 9), (left + 26, y + 9)],
                colour(label).mix(0.18).filled(),
            );
            legend.draw(&ground).map_err(failed)?;
            mark(legend, (left + 13, y), label, 5)?;
            text(words, left, y)?;
        }
        if self.path.is_some() {
            let path =
                PathElement::new([(left, rows[2]), (left + 26, rows[2])], PATH.stroke_width(1));
            legend.draw(&path).map_err(failed)?;
            let heading = PathElement::new(
                [(left + 12, rows[2]), (left + 26, rows[2])],
                PATH.stroke_width(2),
            );
            legend.draw(&heading).map_err(failed)?;
            text("path with headings; o: no sample", left, rows[2])?;
        }
        if self.truth.is_some() {
            let line =
                PathElement::new([(right, rows[0]), (right + 26, rows[0])], BLACK.stroke_width(2));
            legend.draw(&line).map_err(failed)?;
            text("true line", right, rows[0])?;
        }
        if self.estimate.is_some() {
            for x in [right, right + 15] {
                let dash =
                    PathElement::new([(x, rows[1]), (x + 10, rows[1])], ESTIMATE.stroke_width(2));
                legend.draw(&dash).map_err(failed)?;
            }
            text("estimate: centre of the version space", right, rows[1])?;
        }
        Ok(())
    }
}

/// A sample's mark: a disc for +1, a square for -1.
fn mark<C: CoordTranslate<From = P>, P: Clone + 'static>(
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

/// The smallest area that shows all samples with a margin, for samples without a mission.
pub fn area_around(samples: &[Sample]) -> Option<Area> {
    let places = || samples.iter().map(|s| Point2::<f64>::from(s.site));
    let (min, max) = (places().reduce(|a, b| a.inf(&b))?, places().reduce(|a, b| a.sup(&b))?);
    let margin = Vector2::repeat(0.1 * (max - min).amax());
    Area::new((min - margin).try_into().ok()?, (max + margin).try_into().ok()?)
}
