//! What marks look like: each has one look, on the figure as in its legend.

use nalgebra::Vector2;
use planner_core::Label;
use svg::node::element::{Group, Path};

use crate::report::picture::Ring;
use crate::report::shapes::{Anchor, NUMBER, Spot, circle, outline, rectangle, square, text};
use crate::report::style::{self, Fill, INK, Stroke};

/// How a mark looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// A label that was read: a disc for +1, a square for -1.
    Read(Label),
    /// The same, small: there are many along a front, and they must not hide its map.
    Small(Label),
    /// The same, lighter, where a front was sought.
    Faint(Label),
    /// One that was given: larger, outlined.
    Given(Label),
    /// A ring about a label.
    Ringed(Ring),
    /// A ring about a small one whose label is known to be false.
    Wrong,
    /// A diamond where a robot starts.
    Start,
    /// The same, filled and smaller, where one ends.
    End,
    /// A small circle where no label was read.
    Unread,
    /// The same, struck through, where one was asked for.
    Missing,
    /// A cross where a robot truly was.
    Truly,
    /// The number of a step.
    Number,
    /// A line.
    Line(Stroke),
    /// The marker of a curve, by the curve's number.
    Marker(usize),
    /// Ground.
    Ground(Fill),
    /// This many shades of ground, side by side.
    Shades(usize),
}

impl Look {
    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::Read(Label::Positive) | Self::Small(Label::Positive) => "read-positive",
            Self::Read(Label::Negative) | Self::Small(Label::Negative) => "read-negative",
            Self::Faint(Label::Positive) => "sought-positive",
            Self::Faint(Label::Negative) => "sought-negative",
            Self::Given(Label::Positive) => "given-positive",
            Self::Given(Label::Negative) => "given-negative",
            Self::Ringed(Ring::Wrong) | Self::Wrong => "wrong",
            Self::Ringed(Ring::Disagrees) => "disagrees",
            Self::Ringed(Ring::Against) => "against",
            Self::Ringed(Ring::Refutes) => "refutes",
            Self::Start => "start",
            Self::End => "end",
            Self::Unread => "unread",
            Self::Missing => "missing",
            Self::Truly => "truly",
            Self::Number => "number",
            Self::Line(stroke) => stroke.class,
            Self::Marker(k) => style::CURVES[k].class,
            Self::Ground(fill) => fill.class(),
            Self::Shades(_) => "shading",
        }
    }

    /// A group of such marks.
    pub(crate) fn group(self) -> Group {
        let group = Group::new().set("class", self.class());
        let outlined = |group: Group, width: f64| {
            group.set("fill", "none").set("stroke", INK).set("stroke-width", width)
        };
        match self {
            Self::Read(label) | Self::Small(label) => group.set("fill", style::of_label(label)),
            Self::Faint(label) => group.set("fill", style::faint(label)),
            Self::Given(label) => {
                let group = group.set("fill", style::of_label(label));
                group.set("stroke", "#000000").set("stroke-width", 1.8)
            }
            Self::Ringed(Ring::Against) => outlined(group, 1.4).set("stroke-dasharray", "3 2"),
            Self::Ringed(_) | Self::Start => outlined(group, 1.4),
            Self::Truly => outlined(group, 1.1),
            Self::Wrong => outlined(group, 0.8),
            Self::Unread | Self::Missing => outlined(group, 1.2).set("fill", "#ffffff"),
            Self::Number | Self::End => group.set("fill", INK),
            Self::Line(Stroke { colour, width, dashes, .. }) => {
                let group = group.set("fill", "none").set("stroke", colour);
                let group = group.set("stroke-width", width);
                if dashes.is_empty() { group } else { group.set("stroke-dasharray", dashes) }
            }
            Self::Marker(k) => group.set("fill", style::CURVES[k].colour),
            Self::Ground(fill) => group.set("fill", fill.paint()),
            Self::Shades(_) => group,
        }
    }

    /// One of them at a place.
    pub(crate) fn mark(self, at: Spot) -> Group {
        let group = self.group();
        match self {
            Self::Read(Label::Positive) => group.add(circle(at, 4.6)),
            Self::Read(Label::Negative) => group.add(square(at, 4.1)),
            Self::Small(Label::Positive) => group.add(circle(at, 2.3)),
            Self::Small(Label::Negative) => group.add(square(at, 2.0)),
            Self::Faint(Label::Positive) => group.add(circle(at, 2.6)),
            Self::Faint(Label::Negative) => group.add(square(at, 2.3)),
            Self::Wrong => group.add(circle(at, 4.2)),
            Self::Given(Label::Positive) => group.add(circle(at, 6.8)),
            Self::Given(Label::Negative) => group.add(square(at, 6.1)),
            Self::Ringed(Ring::Refutes) => group.add(circle(at, 8.5)).add(circle(at, 12.5)),
            Self::Ringed(_) => group.add(circle(at, 9.5)),
            Self::Start | Self::End => {
                let size = if self == Self::Start { 13.0 } else { 8.0 };
                let to = |x: f64, y: f64| at + Vector2::new(x, y) * size;
                let corners = [to(1.0, 0.0), to(0.0, 1.0), to(-1.0, 0.0), to(0.0, -1.0)];
                group.add(Path::new().set("d", outline(&corners).close()))
            }
            Self::Unread => group.add(circle(at, 3.4)),
            Self::Missing => {
                let half = Vector2::new(4.6, -4.6);
                let stroke = Path::new().set("d", outline(&[at - half, at + half]));
                group.add(circle(at, 3.4)).add(stroke)
            }
            Self::Truly => {
                let to = |x: f64, y: f64| at + Vector2::new(x, y) * 3.6;
                let strokes = [[to(-1.0, -1.0), to(1.0, 1.0)], [to(-1.0, 1.0), to(1.0, -1.0)]];
                strokes.iter().fold(group, |group, it| group.add(Path::new().set("d", outline(it))))
            }
            Self::Number => {
                group.add(text("7", at + Vector2::new(0.0, 4.0), NUMBER, Anchor::Middle))
            }
            Self::Line(_) => {
                let half = Vector2::new(15.0, 0.0);
                group.add(Path::new().set("d", outline(&[at - half, at + half])))
            }
            Self::Marker(k) => {
                let line = Self::Line(style::CURVES[k]);
                let half = Vector2::new(17.0, 0.0);
                let way = Path::new().set("d", outline(&[at - half, at + half]));
                Group::new()
                    .set("class", self.class())
                    .add(line.group().add(way))
                    .add(marker(k, at).set("fill", style::CURVES[k].colour))
            }
            Self::Ground(_) => {
                let half = Vector2::new(14.0, 7.0);
                let edge = rectangle(at - half, at + half).set("stroke", "#8a8a8a");
                group.add(edge.set("stroke-width", 0.6))
            }
            Self::Shades(_) => group,
        }
    }

    /// How much wider than others it is in a legend.
    pub(crate) fn reach(self) -> f64 {
        if let Self::Shades(count) = self { 30.0 * (count as f64 - 1.0) } else { 0.0 }
    }

    /// As a legend shows it.
    pub(crate) fn entry(self, at: Spot) -> Group {
        let Self::Shades(count) = self else { return self.mark(at) };
        let shade = |k: usize| {
            let at = at + Vector2::new(30.0 * k as f64, 0.0);
            Self::Ground(Fill::Shade(k)).mark(at)
        };
        (0..count).map(shade).fold(self.group(), Group::add)
    }
}

/// The marker of the `k`-th curve.
pub(crate) fn marker(k: usize, at: Spot) -> Path {
    let shape: &[[f64; 2]] = match k {
        0 => &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
        1 => &[[0.0, -1.4], [1.3, 1.0], [-1.3, 1.0]],
        2 => &[[0.0, -1.4], [1.4, 0.0], [0.0, 1.4], [-1.4, 0.0]],
        3 => &[[0.0, 1.4], [1.3, -1.0], [-1.3, -1.0]],
        4 => &[[-1.4, -0.6], [1.4, -0.6], [1.4, 0.6], [-1.4, 0.6]],
        _ => &[[-0.6, -1.4], [0.6, -1.4], [0.6, 1.4], [-0.6, 1.4]],
    };
    let corners: Vec<_> = shape.iter().map(|it| at + Vector2::from(*it) * 3.6).collect();
    Path::new().set("d", outline(&corners).close())
}
