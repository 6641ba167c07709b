//! What marks look like: each has one look, on the figure as in its legend.

use nalgebra::Vector2;
use planner_core::Label;
use svg::Node;
use svg::node::element::{Group, Path};

use crate::report::shapes::{Anchor, NUMBER, Spot, circle, outline, rectangle, square, text};
use crate::report::style::{self, Fill, INK, SHADES, Stroke};

/// How something looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// A mark.
    Mark(Mark),
    /// A line.
    Line(Stroke),
    /// The marker of a curve, by the curve's number.
    Marker(usize),
    /// Ground.
    Ground(Fill),
    /// This many shades of ground, side by side.
    Shades(usize),
}

/// A mark at a place: how it looks, what it means and how much space it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    pub(crate) class: &'static str,
    /// What the legend says of it.
    pub(crate) meaning: &'static str,
    shapes: &'static [Shape],
    fill: &'static str,
    /// The colour and the width of its outline.
    stroke: (&'static str, f64),
    dashes: &'static str,
    /// Words stay so many pixels off its middle.
    pub(crate) radius: f64,
    /// The map of a front has one in each cell of so many pixels; 0: all.
    pub(crate) cell: f64,
}

/// A part of a mark about its middle, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Disc(f64),
    Square(f64),
    Diamond(f64),
    /// A stroke that ends so far right and below, and as far on the other side.
    Stroke(f64, f64),
    Word(&'static str),
}
use Shape::{Diamond, Disc, Square, Word};

/// Where a robot starts, and where one that follows a front ends.
pub(crate) const START: Mark =
    mark("start", "start", &[Diamond(13.0)]).outlined(1.4).space(13.5, 0.0);
pub(crate) const END: Mark = mark("end", "end", &[Diamond(8.0)]).filled(INK);
pub(crate) const UNREAD: Mark =
    mark("unread", "a stop where no label was read", &[Disc(3.4)]).filled("#ffffff").outlined(1.2);
pub(crate) const MISSING: Mark =
    mark("missing", "a label was asked for, and none came", &[Disc(3.4), Shape::Stroke(4.6, -4.6)])
        .filled("#ffffff")
        .outlined(1.2)
        .space(0.0, 12.0);
pub(crate) const TRULY: Mark = mark(
    "truly",
    "where the robot truly was",
    &[Shape::Stroke(3.6, 3.6), Shape::Stroke(3.6, -3.6)],
)
.outlined(1.1)
.space(4.0, 0.0);
pub(crate) const NUMBER_OF_STEP: Mark =
    mark("number", "number of the step that ends here", &[Word("7")]).filled(INK);

/// Rings about labels: the label is known to be false.
pub(crate) const WRONG: Mark = ring("wrong", "ringed: the label is wrong", &[Disc(9.5)]);
/// The same about a small one.
pub(crate) const SMALL_WRONG: Mark = Mark { shapes: &[Disc(4.2)], ..WRONG }.outlined(0.8);
/// It disagrees with the line. The truth is not known.
pub(crate) const DISAGREES: Mark =
    ring("disagrees", "ringed: disagrees with the line", &[Disc(9.5)]);
/// It disagrees with the line that the fewest do.
pub(crate) const AGAINST: Mark = Mark {
    dashes: "3 2",
    ..ring("against", "dashed ring: disagrees with the best line", &[Disc(9.5)])
};
/// No line left has this label here.
pub(crate) const REFUTES: Mark =
    ring("refutes", "double ring: no line left has this label here", &[Disc(8.5), Disc(12.5)])
        .space(13.0, 16.0);

/// A label that was read: a disc for +1, a square for -1.
pub(crate) fn read(label: Label) -> Mark {
    let mark = match label {
        Label::Positive => mark("read-positive", "label +1 was read here", &[Disc(4.6)]),
        Label::Negative => mark("read-negative", "label -1 was read here", &[Square(4.1)]),
    };
    mark.filled(style::of_label(label)).space(5.0, 8.0)
}

/// The same, small: there are many along a front, and they must not hide its map.
pub(crate) fn small(label: Label) -> Mark {
    let shapes: &[Shape] = match label {
        Label::Positive => &[Disc(2.3)],
        Label::Negative => &[Square(2.0)],
    };
    Mark { shapes, ..read(label) }
}

/// The same, lighter, where a front was sought.
pub(crate) fn sought(label: Label) -> Mark {
    let mark = match label {
        Label::Positive => {
            mark("sought-positive", "label +1, while the front was sought", &[Disc(2.6)])
        }
        Label::Negative => {
            mark("sought-negative", "label -1, while the front was sought", &[Square(2.3)])
        }
    };
    mark.filled(style::faint(label)).space(3.0, 8.0)
}

/// One that was given: larger, outlined.
pub(crate) fn given(label: Label) -> Mark {
    let mark = match label {
        Label::Positive => mark("given-positive", "given beforehand, label +1", &[Disc(6.8)]),
        Label::Negative => mark("given-negative", "given beforehand, label -1", &[Square(6.1)]),
    };
    Mark { stroke: ("#000000", 1.8), ..mark.filled(style::of_label(label)).space(8.0, 0.0) }
}

const fn mark(class: &'static str, meaning: &'static str, shapes: &'static [Shape]) -> Mark {
    let (fill, stroke, dashes) = ("none", ("", 0.0), "");
    Mark { class, meaning, shapes, fill, stroke, dashes, radius: 0.0, cell: 0.0 }
}

const fn ring(class: &'static str, meaning: &'static str, shapes: &'static [Shape]) -> Mark {
    mark(class, meaning, shapes).outlined(1.4).space(10.0, 16.0)
}

impl Mark {
    const fn filled(self, fill: &'static str) -> Self {
        Self { fill, ..self }
    }

    const fn outlined(self, width: f64) -> Self {
        Self { stroke: (INK, width), ..self }
    }

    const fn space(self, radius: f64, cell: f64) -> Self {
        Self { radius, cell, ..self }
    }

    /// The same with another meaning than on other maps.
    pub(crate) const fn meaning(self, meaning: &'static str) -> Self {
        Self { meaning, ..self }
    }

    /// It at a place.
    fn at(self, at: Spot) -> Group {
        let add = |group: Group, shape: &Shape| match *shape {
            Disc(radius) => group.add(circle(at, radius)),
            Square(half) => group.add(square(at, half)),
            Diamond(size) => {
                let to = |x: f64, y: f64| at + Vector2::new(x, y) * size;
                let corners = [to(1.0, 0.0), to(0.0, 1.0), to(-1.0, 0.0), to(0.0, -1.0)];
                group.add(Path::new().set("d", outline(&corners).close()))
            }
            Shape::Stroke(x, y) => way(group, at, Vector2::new(x, y)),
            Word(word) => {
                group.add(text(word, at + Vector2::new(0.0, 4.0), NUMBER, Anchor::Middle))
            }
        };
        self.shapes.iter().fold(Look::Mark(self).group(), add)
    }
}

/// A straight way through a place.
fn way(group: Group, at: Spot, half: Vector2<f64>) -> Group {
    group.add(Path::new().set("d", outline(&[at - half, at + half])))
}

impl Look {
    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::Mark(mark) => mark.class,
            Self::Line(stroke) => stroke.class,
            Self::Marker(k) => style::CURVES[k].class,
            Self::Ground(fill) => fill.class,
            Self::Shades(_) => "shading",
        }
    }

    /// A group of such marks.
    pub(crate) fn group(self) -> Group {
        let group = Group::new().set("class", self.class());
        let (fill, (colour, width), dashes) = match self {
            Self::Mark(Mark { fill, stroke, dashes, .. }) => (fill.to_owned(), stroke, dashes),
            Self::Line(it) => ("none".to_owned(), (it.colour, it.width), it.dashes),
            Self::Marker(k) => (style::CURVES[k].colour.to_owned(), ("", 0.0), ""),
            Self::Ground(fill) => (fill.paint(), ("", 0.0), ""),
            Self::Shades(_) => return group,
        };
        let mut group = group.set("fill", fill);
        if width > 0.0 {
            group.assign("stroke", colour);
            group.assign("stroke-width", width);
        }
        if dashes.is_empty() { group } else { group.set("stroke-dasharray", dashes) }
    }

    /// One of them at a place, as a legend shows it.
    pub(crate) fn at(self, at: Spot) -> Group {
        let group = self.group();
        match self {
            Self::Mark(mark) => mark.at(at),
            Self::Line(_) => way(group, at, Vector2::new(15.0, 0.0)),
            Self::Marker(k) => {
                let line = Self::Line(style::CURVES[k]).group();
                Group::new()
                    .set("class", self.class())
                    .add(way(line, at, Vector2::new(17.0, 0.0)))
                    .add(marker(k, at).set("fill", style::CURVES[k].colour))
            }
            Self::Ground(_) => {
                let half = Vector2::new(14.0, 7.0);
                let edge = rectangle(at - half, at + half).set("stroke", "#8a8a8a");
                group.add(edge.set("stroke-width", 0.6))
            }
            Self::Shades(count) => {
                let shade = |k| Self::Ground(SHADES[k]).at(at + Vector2::new(30.0 * k as f64, 0.0));
                (0..count).map(shade).fold(group, Group::add)
            }
        }
    }

    /// How much wider than others it is in a legend.
    pub(crate) fn reach(self) -> f64 {
        if let Self::Shades(count) = self { 30.0 * (count as f64 - 1.0) } else { 0.0 }
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
