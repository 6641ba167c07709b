//! A sheet that a figure is drawn on, as SVG. What is drawn on it is named in its legend: each mark has a look, and
//! the legend shows the looks that were named.

use nalgebra::{Point2, Vector2};
use planner_core::belief::sample::Label;
use svg::Document;
use svg::node::element::path::Data;
use svg::node::element::{Circle, Definitions, Group, Path, Pattern, Rectangle, Text, Title};

use crate::report::style::{self, Fill, HATCHES, INK, Stroke};

/// A place on a sheet, pixels from its upper left corner.
pub(crate) type Spot = Point2<f64>;

/// How a mark looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Look {
    /// A label that was read: a disc for +1, a square for -1.
    Read(Label),
    /// One that was given: larger, outlined.
    Given(Label),
    /// A ring about a wrong label.
    Wrong,
    /// A diamond where a robot starts.
    Start,
    /// A small circle where no label was read.
    Unread,
    /// A cross where a robot truly was.
    Truly,
    /// The number of a step.
    Number,
    /// A line.
    Line(Stroke),
    /// A marker of a curve: which of those that there are.
    Marker(usize),
    /// Ground.
    Ground(Fill),
    /// So many shades of ground, side by side.
    Shades(usize),
}

/// A figure that is being drawn.
pub(crate) struct Sheet {
    size: Vector2<f64>,
    title: String,
    drawn: Group,
    named: Vec<(Look, String)>,
}

/// Which side of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Hundredths of a pixel are enough, and keep files small.
fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

/// How wide a text is at most, as the widest of usual fonts without serifs have it.
pub(crate) fn width(words: &str, size: f64) -> f64 {
    let wide = |c: char| match c {
        'i' | 'l' | 'j' | '.' | ',' | ':' | ';' | '\'' | '|' | '(' | ')' | 'I' => 0.36,
        ' ' | 't' | 'f' | 'r' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.96,
        'A'..='Z' => 0.7,
        _ => 0.6,
    };
    words.chars().map(wide).sum::<f64>() * size
}

pub(crate) fn text(words: &str, at: Spot, size: f64, anchor: Anchor) -> Text {
    let text =
        Text::new(words).set("x", rounded(at.x)).set("y", rounded(at.y)).set("font-size", size);
    match anchor {
        Anchor::Start => text,
        Anchor::Middle => text.set("text-anchor", "middle"),
        Anchor::End => text.set("text-anchor", "end"),
    }
}

fn continued(data: Data, corners: &[Spot]) -> Data {
    let at = |spot: &Spot| (rounded(spot.x), rounded(spot.y));
    let mut spots = corners.iter().map(at);
    let Some(first) = spots.next() else { return data };
    spots.fold(data.move_to(first), Data::line_to)
}

fn outline(corners: &[Spot]) -> Data {
    continued(Data::new(), corners)
}

fn circle(at: Spot, radius: f64) -> Circle {
    Circle::new().set("cx", rounded(at.x)).set("cy", rounded(at.y)).set("r", radius)
}

fn square(at: Spot, half: f64) -> Rectangle {
    rectangle(at - Vector2::repeat(half), at + Vector2::repeat(half))
}

fn rectangle(from: Spot, to: Spot) -> Rectangle {
    Rectangle::new()
        .set("x", rounded(from.x))
        .set("y", rounded(from.y))
        .set("width", rounded(to.x - from.x))
        .set("height", rounded(to.y - from.y))
}

impl Look {
    pub(crate) const fn class(self) -> &'static str {
        match self {
            Self::Read(Label::Positive) => "read-positive",
            Self::Read(Label::Negative) => "read-negative",
            Self::Given(Label::Positive) => "given-positive",
            Self::Given(Label::Negative) => "given-negative",
            Self::Wrong => "wrong",
            Self::Start => "start",
            Self::Unread => "unread",
            Self::Truly => "truly",
            Self::Number => "number",
            Self::Line(stroke) => stroke.class,
            Self::Marker(k) => style::CURVES[k].class,
            Self::Ground(fill) => fill.class(),
            Self::Shades(_) => "shading",
        }
    }

    /// A group of such marks.
    fn group(self) -> Group {
        let group = Group::new().set("class", self.class());
        let outlined = |group: Group, width: f64| {
            group.set("fill", "none").set("stroke", INK).set("stroke-width", width)
        };
        match self {
            Self::Read(label) => group.set("fill", style::of_label(label)),
            Self::Given(label) => {
                let group = group.set("fill", style::of_label(label));
                group.set("stroke", "#000000").set("stroke-width", 1.8)
            }
            Self::Wrong => outlined(group, 1.4),
            Self::Start => outlined(group, 1.4),
            Self::Truly => outlined(group, 1.1),
            Self::Unread => outlined(group, 1.2).set("fill", "#ffffff"),
            Self::Number => group.set("fill", INK),
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
    fn mark(self, at: Spot) -> Group {
        let group = self.group();
        match self {
            Self::Read(Label::Positive) => group.add(circle(at, 4.6)),
            Self::Read(Label::Negative) => group.add(square(at, 4.1)),
            Self::Given(Label::Positive) => group.add(circle(at, 6.8)),
            Self::Given(Label::Negative) => group.add(square(at, 6.1)),
            Self::Wrong => group.add(circle(at, 9.5)),
            Self::Start => {
                let to = |x: f64, y: f64| at + Vector2::new(x, y) * 13.0;
                let corners = [to(1.0, 0.0), to(0.0, 1.0), to(-1.0, 0.0), to(0.0, -1.0)];
                group.add(Path::new().set("d", outline(&corners).close()))
            }
            Self::Unread => group.add(circle(at, 3.4)),
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
}

/// The marker of the `k`-th curve.
fn marker(k: usize, at: Spot) -> Path {
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

/// Size of the numbers of steps.
pub(crate) const NUMBER: f64 = 11.0;

const ENTRY: f64 = 13.0;

impl Sheet {
    /// An empty one of some size above its legend.
    pub(crate) fn new(title: &str, size: Vector2<f64>) -> Self {
        Self { size, title: title.to_owned(), drawn: Group::new(), named: Vec::new() }
    }

    /// Has the legend say what a look means, once. The legend keeps the order.
    pub(crate) fn name(&mut self, look: Look, meaning: impl Into<String>) {
        if !self.named.iter().any(|(named, _)| named.class() == look.class()) {
            self.named.push((look, meaning.into()));
        }
    }

    fn add(&mut self, group: Group) {
        self.drawn = std::mem::replace(&mut self.drawn, Group::new()).add(group);
    }

    /// A mark at each of some places.
    pub(crate) fn mark(&mut self, look: Look, at: Spot) {
        self.add(look.mark(at));
    }

    /// Ways, each through its places.
    pub(crate) fn ways<'a>(&mut self, stroke: Stroke, ways: impl IntoIterator<Item = &'a [Spot]>) {
        let draw = |group: Group, way| group.add(Path::new().set("d", outline(way)));
        self.add(ways.into_iter().fold(Look::Line(stroke).group(), draw));
    }

    /// Ground within polygons, one and all filled by the even-odd rule.
    pub(crate) fn ground(&mut self, fill: Fill, rings: &[Vec<Spot>]) {
        let mut rings = rings.iter().filter(|ring| ring.len() > 2).peekable();
        if rings.peek().is_some() {
            let data = rings.fold(Data::new(), |data, ring| continued(data, ring).close());
            let path = Path::new().set("d", data).set("fill-rule", "evenodd");
            self.add(Look::Ground(fill).group().add(path));
        }
    }

    /// Ground between a curve's median and its 90th percentile.
    pub(crate) fn spread(&mut self, k: usize, ring: &[Spot]) {
        let path = Path::new().set("d", outline(ring).close());
        let group = Group::new().set("class", "spread").set("fill", style::CURVES[k].colour);
        self.add(group.set("fill-opacity", 0.14).add(path));
    }

    /// The `k`-th curve, with a marker at each place.
    pub(crate) fn curve(&mut self, k: usize, spots: &[Spot]) {
        self.ways(style::CURVES[k], [spots]);
        let group = Look::Marker(k).group();
        self.add(spots.iter().fold(group, |group, at| group.add(marker(k, *at))));
    }

    /// The number of a step, its middle foot at a place.
    pub(crate) fn number(&mut self, words: &str, at: Spot) {
        self.add(Look::Number.group().add(text(words, at, NUMBER, Anchor::Middle)));
    }

    /// Words beside what they name.
    pub(crate) fn words(&mut self, words: &str, at: Spot, size: f64, anchor: Anchor) {
        let group = Group::new().set("class", "words").set("fill", INK);
        self.add(group.add(text(words, at, size, anchor)));
    }

    /// Words that read upwards.
    pub(crate) fn upright(&mut self, words: &str, at: Spot, size: f64) {
        let turn = format!("rotate(-90 {} {})", rounded(at.x), rounded(at.y));
        let group = Group::new().set("class", "words").set("fill", INK);
        self.add(group.add(text(words, at, size, Anchor::Middle).set("transform", turn)));
    }

    /// The figure with its legend, as an SVG document.
    pub(crate) fn finish(self) -> String {
        const LEFT: f64 = 24.0;
        const ROW: f64 = 23.0;
        let Self { size, title, drawn, named } = self;
        let mut legend = Group::new().set("class", "legend").set("fill", INK);
        let half = (size.x - 2.0 * LEFT) / 2.0;
        let (mut row, mut is_left) = (0.0, true);
        for (look, meaning) in named {
            let is_wide = 44.0 + look.reach() + width(&meaning, ENTRY) > half;
            if is_wide && !is_left {
                (row, is_left) = (row + 1.0, true);
            }
            let x = if is_left { LEFT } else { LEFT + half };
            let at = Spot::new(x + 16.0, size.y + 12.0 + row * ROW);
            let spot = at + Vector2::new(26.0 + look.reach(), 4.5);
            legend = legend.add(look.entry(at)).add(text(&meaning, spot, ENTRY, Anchor::Start));
            is_left = !is_left || is_wide;
            row += if is_left { 1.0 } else { 0.0 };
        }
        let rows = if is_left { row } else { row + 1.0 };
        let (wide, high) = (size.x.ceil(), (size.y + rows * ROW + 12.0).ceil());
        let document = Document::new()
            .set("width", wide)
            .set("height", high)
            .set("viewBox", (0.0, 0.0, wide, high))
            .set("role", "img")
            .set("font-family", "Arial, Helvetica, 'DejaVu Sans', sans-serif")
            .add(Title::new(title))
            .add(hatches())
            .add(Rectangle::new().set("width", wide).set("height", high).set("fill", "#ffffff"))
            .add(drawn.set("class", "figure"))
            .add(legend);
        document.to_string() + "\n"
    }
}

impl Look {
    /// How much wider than others it is in a legend.
    fn reach(self) -> f64 {
        if let Self::Shades(count) = self { 30.0 * (count as f64 - 1.0) } else { 0.0 }
    }

    /// As a legend shows it: at half its size where it is large.
    fn entry(self, at: Spot) -> Group {
        let Self::Shades(count) = self else { return self.mark(at) };
        let shade = |k: usize| {
            let at = at + Vector2::new(30.0 * k as f64, 0.0);
            Self::Ground(Fill::Shade(k)).mark(at)
        };
        (0..count).map(shade).fold(self.group(), Group::add)
    }
}

fn hatches() -> Definitions {
    HATCHES.iter().fold(Definitions::new(), |all, hatch| {
        let tile = Rectangle::new().set("width", hatch.side).set("height", hatch.side);
        let strokes = Path::new().set("d", hatch.strokes).set("stroke", hatch.ink);
        let pattern = Pattern::new()
            .set("id", hatch.fill.class())
            .set("patternUnits", "userSpaceOnUse")
            .set("width", hatch.side)
            .set("height", hatch.side)
            .add(tile.set("fill", hatch.ground))
            .add(strokes.set("stroke-width", 1));
        all.add(pattern)
    })
}
