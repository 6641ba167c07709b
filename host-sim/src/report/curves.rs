//! Curves of campaigns: how errors shrink and bits grow, a curve for each planner.

use nalgebra::{Point2, Vector2};

use crate::campaign::spread::Spread;
use crate::campaign::{accuracy, calibration};
use crate::report::axes::{Axes, Axis, Scale};
use crate::report::look::Look;
use crate::report::shapes::{Anchor, Spot};
use crate::report::sheet::Sheet;
use crate::report::style::{CURVES, Stroke};

/// Below this an error is drawn as if it were this.
const LEAST: f64 = 1e-9;

/// The line of the most that labels can carry.
const LIMIT: Stroke = Stroke { class: "limit", colour: "#000000", width: 1.2, dashes: "2 3" };

/// The measure that grows. The others are errors, drawn by powers of ten, with their spread.
const BITS: &str = "information, bits";

/// Curves of several planners.
#[derive(Clone, Debug)]
pub struct Curves {
    title: String,
    note: String,
    by: &'static str,
    planners: Vec<String>,
    panels: Vec<Panel>,
}

/// One measure of all planners.
#[derive(Clone, Debug)]
struct Panel {
    name: &'static str,
    /// For each planner, the numbers of steps or labels with the spread after each.
    of: Vec<Vec<(u32, Spread)>>,
    /// A bound, for each step or label.
    limit: Option<f64>,
}

fn alike(value: f64) -> Spread {
    Spread { median: value, p90: value, worst: value }
}

/// A measure of all planners: for each the rows, and of a row where it stands and what it comes to.
fn panel<R>(
    name: &'static str,
    limit: Option<f64>,
    planners: &[&[R]],
    of: fn(&R) -> (u32, Spread),
) -> Panel {
    let of = planners.iter().map(|rows| rows.iter().map(of).collect()).collect();
    Panel { name, of, limit }
}

impl Curves {
    /// Of planners whose labels are true.
    pub fn of_accuracy(summaries: &[accuracy::Summary]) -> Self {
        let rows: Vec<_> = summaries.iter().map(|it| &*it.rows).collect();
        Self {
            title: "How fast the boundary is found, with true labels".to_owned(),
            note: note(summaries.first().map_or(0, |it| it.fields)),
            by: "steps",
            planners: summaries.iter().map(|it| it.algorithm.title().to_owned()).collect(),
            panels: vec![
                panel("error of the slope, degrees", None, &rows, |row| (row.step, row.centre_deg)),
                panel("misclassified area, %", None, &rows, |row| {
                    (row.step, row.centre_misclassified.scaled(100.0))
                }),
                panel(BITS, None, &rows, |row| {
                    (row.step, alike(row.bits_per_step * f64::from(row.step)))
                }),
            ],
        }
    }

    /// Of planners whose labels may err.
    pub fn of_calibration(summaries: &[calibration::Summary]) -> Self {
        let first = summaries.first();
        let rows: Vec<_> = summaries.iter().map(|it| &*it.rows).collect();
        let p = first.map_or(1.0, |it| it.p);
        let limit = first.map(|it| it.limit);
        Self {
            title: format!(
                "How fast the boundary is found, with labels true {:.0} times in 100",
                100.0 * p
            ),
            note: note(first.map_or(0, |it| it.fields)),
            by: "labels",
            planners: summaries.iter().map(|it| it.algorithm.title().to_owned()).collect(),
            panels: vec![
                panel("error of the slope, degrees", None, &rows, |row| (row.labels, row.mean_deg)),
                panel(BITS, limit, &rows, |row| (row.labels, alike(row.bits))),
            ],
        }
    }

    /// The curves as an SVG document.
    pub fn svg(&self) -> String {
        const TOP: f64 = 66.0;
        const SIZE: Vector2<f64> = Vector2::new(290.0, 270.0);
        const APART: f64 = 92.0;
        let left = |k: usize| APART + (SIZE.x + APART) * k as f64;
        let mut sheet = Sheet::new(
            &self.title,
            Vector2::new(left(self.panels.len()) - APART + 28.0, TOP + SIZE.y + 56.0),
        );
        sheet.words(&self.title, Spot::new(16.0, 28.0), 17.0, Anchor::Start);
        sheet.words(&self.note, Spot::new(16.0, 48.0), 13.0, Anchor::Start);
        for (k, panel) in self.panels.iter().enumerate() {
            let from = Spot::new(left(k), TOP);
            panel.draw(&mut sheet, from, from + SIZE, self.by);
        }
        for (k, planner) in self.planners.iter().enumerate() {
            sheet.name(Look::Marker(k % CURVES.len()), planner.clone());
        }
        if self.panels.iter().any(|panel| panel.limit.is_some()) {
            sheet.name(Look::Line(LIMIT), "what so many labels can tell at most");
        }
        sheet.finish()
    }
}

fn note(fields: u64) -> String {
    format!(
        "{fields} standard fields; errors: the median, shaded up to the 90th percentile (thin); bits: the mean"
    )
}

impl Panel {
    fn is_error(&self) -> bool {
        self.name != BITS
    }

    fn draw(&self, sheet: &mut Sheet, from: Spot, to: Spot, by: &'static str) {
        let all = || self.of.iter().flatten();
        let last = all().map(|(at, _)| *at).max().unwrap_or(1);
        let highest = all().map(|(_, it)| it.p90).fold(0.0, f64::max);
        let z = if self.is_error() {
            let lowest = all().map(|(_, it)| it.median.max(LEAST)).fold(f64::INFINITY, f64::min);
            let power = |it: f64| libm::pow(10.0, it);
            let least = power(libm::floor(libm::log10(lowest.min(highest.max(LEAST)))));
            let most = power(libm::ceil(libm::log10(highest.max(10.0 * least))));
            Axis { scale: Scale::Logarithmic, figures: [least, most], pixels: [to.y, from.y] }
        } else {
            let limit = self.limit.map_or(0.0, |it| it * f64::from(last));
            let most = 1.05 * highest.max(limit).max(LEAST);
            Axis { scale: Scale::Linear, figures: [0.0, most], pixels: [to.y, from.y] }
        };
        let x =
            Axis { scale: Scale::Linear, figures: [0.0, f64::from(last)], pixels: [from.x, to.x] };
        let axes = Axes { x, z };
        let spots = |of: &[(u32, Spread)], pick: fn(&Spread) -> f64| -> Vec<Spot> {
            of.iter().map(|(at, it)| axes.at(Point2::new(f64::from(*at), pick(it)))).collect()
        };
        if self.is_error() {
            for (k, of) in self.of.iter().enumerate().filter(|(_, of)| of.len() > 1) {
                let mut ring = spots(of, |it| it.median);
                let edge = spots(of, |it| it.p90);
                sheet.ways(Stroke { width: 0.7, ..CURVES[k % CURVES.len()] }, [&edge[..]]);
                ring.extend(edge.into_iter().rev());
                sheet.spread(k % CURVES.len(), &ring);
            }
        }
        if let Some(limit) = self.limit {
            let end = Point2::new(f64::from(last), limit * f64::from(last));
            sheet.ways(LIMIT, [&[axes.at(Point2::origin()), axes.at(end)][..]]);
        }
        for (k, of) in self.of.iter().enumerate() {
            sheet.curve(k % CURVES.len(), &spots(of, |it| it.median));
        }
        axes.draw(sheet, [by, self.name]);
    }
}
