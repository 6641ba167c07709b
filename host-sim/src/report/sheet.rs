//! A sheet that a figure is drawn on, as SVG. What is drawn on it is named in its legend: each mark has a look, and
//! the legend shows the looks that were named.

use nalgebra::Vector2;
use svg::Document;
use svg::node::element::path::Data;
use svg::node::element::{Definitions, Group, Path, Pattern, Rectangle, SVG, Title};

use crate::report::look::{Look, NUMBER_OF_STEP, marker};
use crate::report::placing::Frame;
use crate::report::shapes::{Anchor, NUMBER, Spot, continued, outline, rounded, text, width};
use crate::report::style::{self, Fill, HATCHED, INK, Stroke};

/// A figure that is being drawn.
pub(crate) struct Sheet {
    size: Vector2<f64>,
    title: String,
    drawn: Group,
    /// What is cut off at a window, while one is open.
    window: Option<Group>,
    named: Vec<(Look, String)>,
}

/// Size of the legend's words.
const ENTRY: f64 = 13.0;

impl Sheet {
    /// An empty one of some size above its legend.
    pub(crate) fn new(title: &str, size: Vector2<f64>) -> Self {
        Self { size, title: title.to_owned(), drawn: Group::new(), window: None, named: Vec::new() }
    }

    /// Has the legend say what a look means, once. The legend keeps the order.
    pub(crate) fn name(&mut self, look: Look, meaning: impl Into<String>) {
        if !self.named.iter().any(|(named, _)| named.class() == look.class()) {
            self.named.push((look, meaning.into()));
        }
    }

    fn add(&mut self, group: Group) {
        let drawn = self.window.as_mut().unwrap_or(&mut self.drawn);
        *drawn = std::mem::replace(drawn, Group::new()).add(group);
    }

    /// From here on what is drawn is cut off at a window, until it is [closed](Self::close).
    pub(crate) fn open(&mut self) {
        self.window = Some(Group::new());
    }

    /// Closes the window.
    pub(crate) fn close(&mut self, frame: &Frame) {
        let Some(drawn) = self.window.take() else { return };
        let (from, size) = (frame.middle - frame.half, frame.half * 2.0);
        let [x, y, wide, high] = [from.x, from.y, size.x, size.y].map(rounded);
        let window = SVG::new().set("x", x).set("y", y).set("width", wide).set("height", high);
        self.add(Group::new().add(window.set("viewBox", (x, y, wide, high)).add(drawn)));
    }

    /// A mark at a place.
    pub(crate) fn mark(&mut self, look: Look, at: Spot) {
        self.add(look.at(at));
    }

    /// Ways, each through its places.
    pub(crate) fn ways<'a>(&mut self, stroke: Stroke, ways: impl IntoIterator<Item = &'a [Spot]>) {
        let draw = |group: Group, way| group.add(Path::new().set("d", outline(way)));
        self.add(ways.into_iter().fold(Look::Line(stroke).group(), draw));
    }

    /// Ground within polygons, all filled together by the even-odd rule.
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
        self.add(Look::Mark(NUMBER_OF_STEP).group().add(text(words, at, NUMBER, Anchor::Middle)));
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
        let Self { size, title, drawn, named, .. } = self;
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
            legend = legend.add(look.at(at)).add(text(&meaning, spot, ENTRY, Anchor::Start));
            is_left = !is_left || is_wide;
            row += if is_left { 1.0 } else { 0.0 };
        }
        let rows = if is_left { row } else { row + 1.0 };
        let (wide, high) = (size.x.ceil(), (size.y + rows * ROW + 12.0).ceil());
        let document = Document::new()
            .set("width", wide)
            .set("height", high)
            .set("viewBox", (0.0, 0.0, wide, high))
            .set("style", "max-width:100%;height:auto") // the width of a phone
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

fn hatches() -> Definitions {
    HATCHED.iter().fold(Definitions::new(), |all, fill| {
        let Some((ink, strokes, side)) = fill.strokes else { return all };
        let tile = Rectangle::new().set("width", side).set("height", side);
        let strokes = Path::new().set("d", strokes).set("stroke", ink);
        let pattern = Pattern::new()
            .set("id", fill.class)
            .set("patternUnits", "userSpaceOnUse")
            .set("width", side)
            .set("height", side)
            .add(tile.set("fill", fill.colour))
            .add(strokes.set("stroke-width", 1));
        all.add(pattern)
    })
}
