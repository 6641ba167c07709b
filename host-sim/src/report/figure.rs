//! Figures in the manner of the paper's Figure 7: what is certain, the path, the labels, the lines.

use std::fmt::Display;

use anyhow::{Result, anyhow};
use nalgebra::{Point2, Vector2};
use planner_core::belief::candidates::Certainty;
use planner_core::belief::estimate;
use planner_core::belief::posterior::Posterior;
use planner_core::belief::sample::{Label, Reading, Sample};
use planner_core::geometry::area::Area;
use planner_core::geometry::lattice::{LIMIT, Site, UNITS_PER_METRE, Vector};
use planner_core::geometry::line::Line;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use crate::mission::definition::Table;
use crate::mission::recording::{LEVEL, Outcome, Recorded, Recording};
use crate::report::legend::mark;
use crate::world::polygon::Polygon;
use crate::world::truth;

// Orange for +1 and blue for -1, as in the paper's Figure 1, in hues that colour-blind readers tell
// apart; shapes tell them apart too.
const POSITIVE: RGBColor = RGBColor(213, 94, 0);
const NEGATIVE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const PATH: RGBColor = RGBColor(90, 90, 90);
pub(crate) const SHADE: RGBColor = RGBColor(120, 60, 160);
const ESTIMATE: RGBColor = RGBColor(0, 120, 80);

/// What to draw.
pub struct Figure<'a> {
    /// The title.
    pub title: String,
    /// What the legend says of the samples, if anything.
    pub note: Option<String>,
    /// The ground to show.
    pub area: Area,
    /// What is known at the end.
    pub ground: Ground<'a>,
    /// The samples, with the labels that were seen.
    pub samples: &'a [Sample],
    /// How many of them were given, not taken on the way.
    pub given: usize,
    /// The steps of a mission and where it began.
    pub path: Option<(Point2<f64>, &'a [Recorded])>,
    /// The true line, where known.
    pub truth: Option<Line>,
    /// Other lines, with their names.
    pub lines: Vec<Named>,
}

/// What is known of the ground.
pub enum Ground<'a> {
    /// All lines that agree with every label: two regions of certainty. The samples that bound the lines, in
    /// cyclic order.
    Certain(Vec<Sample>),
    /// A credible set of hypotheses, shaded by probability.
    Credible(&'a Table),
    /// Nothing to show.
    Plain,
}

/// A line with a name for the legend.
pub struct Named {
    /// The name.
    pub name: String,
    /// The line.
    pub line: Line,
    /// How it is drawn.
    pub colour: RGBColor,
    /// A short mark beside it, if any.
    pub mark: Option<String>,
}

impl Named {
    /// The estimate that is recommended.
    pub fn estimate(name: &str, line: Option<Line>) -> Option<Self> {
        Some(Self { name: format!("estimate: {name}"), line: line?, colour: ESTIMATE, mark: None })
    }
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

pub(crate) fn colour(label: Label) -> RGBColor {
    match label {
        Label::Positive => POSITIVE,
        Label::Negative => NEGATIVE,
    }
}

pub(crate) fn failed(error: impl Display) -> anyhow::Error {
    anyhow!("the figure could not be drawn: {error}")
}

fn xy(point: Point2<f64>) -> (f64, f64) {
    (point.x, point.y)
}

impl<'a> Figure<'a> {
    /// The figure of a mission.
    pub fn of(title: &str, recording: &'a Recording) -> Self {
        let mission = &recording.mission;
        let mut lines = Vec::new();
        let centre = recording.estimates().centre;
        let (ground, samples) = match &recording.outcome {
            Outcome::Lines(space) => {
                lines.extend(Named::estimate("centre of the version space", centre));
                (Ground::Certain(space.support().collect()), space.samples())
            }
            Outcome::Hypotheses(table) => {
                lines.extend(Named::estimate("posterior mean", centre));
                lines.extend(bounding(table));
                (Ground::Credible(table), table.samples())
            }
        };
        Self {
            title: title.to_owned(),
            note: None,
            area: mission.config.area,
            ground,
            samples,
            given: mission.space.samples().len(),
            path: Some((Point2::from(mission.start.site), &recording.steps)),
            truth: Some(mission.truth),
            lines,
        }
    }

    /// The figure of the lines that violate the fewest labels of a noisy mission, with their counts
    /// of violations, and of the one among them that a plain maximum margin would choose.
    pub fn of_candidates(title: &str, recording: &'a Recording) -> Option<Self> {
        const SHOWN: usize = 3;
        const SPREAD: [RGBColor; SHOWN] =
            [RGBColor(110, 110, 110), RGBColor(150, 150, 150), RGBColor(185, 185, 185)];
        let Outcome::Hypotheses(table) = &recording.outcome else { return None };
        let taken = &table.samples()[table.given().len()..];
        let violations = |line: &Line| {
            taken.iter().filter(|s| truth::reading(line, s.site) != Reading::Side(s.label)).count()
        };
        let mut candidates: Vec<_> = table
            .iter()
            .filter_map(|h| {
                let widest = estimate::maximum_margin(table.candidates(h))?;
                let margin =
                    table.samples().iter().map(|s| widest.distance(Point2::from(s.site)).abs());
                Some((violations(&widest), widest, margin.fold(f64::INFINITY, f64::min)))
            })
            .collect();
        candidates.sort_by(|a, b| a.0.cmp(&b.0).then(b.2.total_cmp(&a.2)));
        let lines =
            candidates.iter().zip(SPREAD).enumerate().map(|(i, ((n, line, _), grey))| Named {
                name: match i {
                    0 => format!("plain maximum margin; violations: {n}"),
                    _ => format!("another candidate; violations: {n}"),
                },
                line: *line,
                colour: if i == 0 { RGBColor(190, 0, 60) } else { grey },
                mark: Some(format!("{n}")),
            });
        let of = Self::of(title, recording);
        let lines = lines.collect();
        Some(Self { ground: Ground::Plain, path: None, lines, ..of })
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

    fn draw_ground(&self, chart: &mut Chart) -> Result<()> {
        match &self.ground {
            Ground::Certain(support) => self.draw_certain(chart, support),
            Ground::Credible(table) => self.draw_credible(chart, table),
            Ground::Plain => Ok(()),
        }
    }

    /// The credible set: each patch of ground as dark as the hypotheses of the set are likely whose
    /// lines pass through it.
    fn draw_credible(&self, chart: &mut Chart, table: &Table) -> Result<()> {
        const PATCHES: i32 = 72;
        let posterior = Posterior::new(table);
        let set = posterior.credible(LEVEL);
        let (min, max) =
            (Point2::<f64>::from(self.area.min()), Point2::<f64>::from(self.area.max()));
        let size = (max - min) / f64::from(PATCHES);
        for (i, j) in (0..PATCHES).flat_map(|i| (0..PATCHES).map(move |j| (i, j))) {
            let corner = min + size.component_mul(&Vector2::new(f64::from(i), f64::from(j)));
            let Ok(q) = Site::try_from(corner + size / 2.0) else { continue };
            let passing = posterior
                .members(&set)
                .filter(|h| table.candidates(h).certainty(q) == Certainty::Uncertain);
            let mass: f64 = passing.map(|h| posterior.probability(h)).sum();
            if mass > 0.01 {
                let patch = [xy(corner), xy(corner + size)];
                let shade = SHADE.mix(0.75 * mass.min(1.0)).filled();
                chart.draw_series([Rectangle::new(patch, shade)]).map_err(failed)?;
            }
        }
        Ok(())
    }

    /// The two regions of certainty.
    fn draw_certain(&self, chart: &mut Chart, support: &[Sample]) -> Result<()> {
        for label in [Label::Positive, Label::Negative] {
            let certain = Polygon::certain(self.area, support, label);
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
        for Named { line, colour, mark, .. } in &self.lines {
            let ends = across(*line);
            let style = colour.stroke_width(2);
            chart.draw_series(DashedLineSeries::new(ends.clone(), 9, 6, style)).map_err(failed)?;
            if let (Some(mark), Some(&end)) = (mark, ends.iter().max_by(|a, b| a.0.total_cmp(&b.0)))
            {
                let font = ("sans-serif", 15).into_font().color(colour);
                let text = Text::new(mark.clone(), (4, -8), font);
                chart.draw_series([EmptyElement::at(end) + text]).map_err(failed)?;
            }
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
        for (i, sample) in self.samples.iter().enumerate() {
            let given = i < self.given;
            let place = xy(Point2::from(sample.site));
            let right = Reading::Side(sample.label);
            if self.truth.is_some_and(|truth| truth::reading(&truth, sample.site) != right) {
                let ring = Circle::new((0, 0), 10, BLACK.stroke_width(1));
                chart.draw_series([EmptyElement::at(place) + ring]).map_err(failed)?;
            }
            mark(chart.plotting_area(), place, sample.label, if given { 7 } else { 5 })?;
            if given && self.truth.is_some() {
                let style = ("sans-serif", 15).into_font().color(&BLACK);
                let name = Text::new(format!("p{}", i + 1), (-24, -18), style);
                chart.draw_series([EmptyElement::at(place) + name]).map_err(failed)?;
            }
        }
        Ok(())
    }
}

/// The lines at the two ends of a credible set's slopes: the paper's `l1` and `l2`.
fn bounding(table: &Table) -> Vec<Named> {
    let posterior = Posterior::new(table);
    let set = posterior.credible(LEVEL);
    let bounds = || posterior.members(&set).flat_map(|h| table.candidates(h).bounds());
    let ends = [("l1", set.slope_arc.from()), ("l2", set.slope_arc.to())];
    let named = |(name, end): (&str, Vector)| {
        let bound = bounds().find(|bound| bound.along.cross(end) == 0)?;
        Some(Named {
            name: format!("{name}, which bounds the credible slopes"),
            line: bound.into(),
            colour: SHADE,
            mark: Some(name.to_owned()),
        })
    };
    ends.into_iter().filter_map(named).collect()
}

/// The smallest area that shows all samples with a margin, for samples without a mission. Where the lattice
/// ends there is no margin.
pub fn area_around(samples: &[Sample]) -> Option<Area> {
    const END: f64 = (LIMIT - 1) as f64 / UNITS_PER_METRE as f64;
    let places = || samples.iter().map(|s| Point2::<f64>::from(s.site));
    let (min, max) = (places().reduce(|a, b| a.inf(&b))?, places().reduce(|a, b| a.sup(&b))?);
    let margin = Vector2::repeat(0.1 * (max - min).amax());
    let corner = |at: Point2<f64>| Site::try_from(at.map(|m| m.clamp(-END, END))).ok();
    Area::new(corner(min - margin)?, corner(max + margin)?)
}
