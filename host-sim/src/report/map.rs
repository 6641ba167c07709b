//! A map of an area: ground, lines, paths and samples on it, each named in the legend as it is drawn.

use std::collections::HashSet;

use nalgebra::{Point2, Vector2};
use planner_core::link::message::MissionArea;
use planner_core::{Label, Line, Workspace as _};

use crate::report::axes::{Axes, Axis, Scale};
use crate::report::bands::Band;
use crate::report::ground::Ground;
use crate::report::look::Look;
use crate::report::numbers;
use crate::report::picture::{Dot, Ring, Stop};
use crate::report::placing::{Frame, Placing, foot};
use crate::report::ribbon::Ribbon;
use crate::report::shapes::{Anchor, Spot, width};
use crate::report::sheet::Sheet;
use crate::report::style::{BORDER, FRONT, Fill, HEADING, INK, INSET, PATH, Stroke};
use crate::world::extent::around;
use crate::world::polygon::Polygon;

/// Metres and pixels of a map, and what is on it so far.
pub(crate) struct Map {
    area: MissionArea,
    axes: Axes,
    sheet: Sheet,
    placing: Placing,
    /// Words that are placed after all marks: the text, its spot and its size.
    words: Vec<(String, Spot, f64)>,
    /// Whether it is of a front: marks are small and thinned, as there are many.
    follows: bool,
    /// Where a thinned map has marks already: what mark, in which cell.
    marked: HashSet<(&'static str, [i64; 2])>,
    /// Whether it shows a part of the area.
    is_part: bool,
}

/// A track is shown alone if it is smaller than this share of the area.
const SMALL: f64 = 0.5;

/// The sides of a part of an area differ by this factor at most.
const SLIM: f64 = 0.4;

/// The greatest distance of a name from its spot, pixels.
const REACH: f64 = 90.0;

impl Map {
    /// The bare area, large enough for some more places.
    pub(crate) fn new(
        title: &str,
        note: Option<&str>,
        area: &MissionArea,
        more: &[Point2<f64>],
    ) -> Self {
        let ends = ends(area);
        let ends = around(ends.into_iter().chain(more.iter().copied())).unwrap_or(ends);
        Self::between([title, note.unwrap_or_default()], area, more, (ends, false))
    }

    /// The same for the map of a front. If the track covers a small part of the area, it shows that part.
    pub(crate) fn following(
        title: &str,
        note: Option<&str>,
        area: &MissionArea,
        track: &[Point2<f64>],
    ) -> Self {
        let [low, high] = ends(area);
        let part = around(track.iter().copied()).map(|[min, max]| {
            let size = max - min;
            let margin = 0.1 * size.amax();
            let half = size.map(|it| it.max(SLIM * size.amax()) / 2.0 + margin);
            let middle = nalgebra::center(&min, &max);
            [middle - half, middle + half]
        });
        let part = part.filter(|[min, max]| (max - min).amax() < SMALL * (high - low).amax());
        let titles = [title, note.unwrap_or_default()];
        let mut map = match part.filter(|[min, max]| min != max) {
            Some(part) => Self::between(titles, area, track, (part, true)),
            None => Self::new(title, note, area, track),
        };
        map.follows = true;
        map
    }

    fn between(
        [title, note]: [&str; 2],
        area: &MissionArea,
        more: &[Point2<f64>],
        ([min, max], is_part): ([Point2<f64>; 2], bool),
    ) -> Self {
        const SIZE: f64 = 620.0;
        const LEAST: f64 = 220.0;
        const TOP: f64 = 70.0;
        let scale = SIZE / (max - min).amax();
        let size = (max - min).map(|metres| (metres * scale).max(LEAST));
        let axis = |figures, pixels| Axis { scale: Scale::Linear, figures, pixels };
        let mut axes = Axes {
            x: axis([min.x, max.x], [0.0, 0.0]),
            z: axis([min.y, max.y], [TOP + size.y, TOP]),
        };
        let widest = axes.z.ticks().iter().map(|(_, name)| width(name, 12.0)).fold(0.0, f64::max);
        let left = 48.0 + widest;
        axes.x.pixels = [left, left + size.x];
        let all =
            (left + size.x + 30.0).max(24.0 + width(title, 17.0)).max(24.0 + width(note, 13.0));
        let mut sheet = Sheet::new(title, Vector2::new(all, TOP + size.y + 56.0));
        sheet.words(title, Spot::new(16.0, 28.0), 17.0, Anchor::Start);
        if !note.is_empty() {
            sheet.words(note, Spot::new(16.0, 48.0), 13.0, Anchor::Start);
        }
        if is_part {
            sheet.open();
        }
        let placing = Placing::new(axes.frame());
        let mut map = Self {
            area: *area,
            axes,
            sheet,
            placing,
            words: Vec::new(),
            follows: false,
            marked: HashSet::new(),
            is_part,
        };
        let mut border = map.spots(&Polygon::from(*area).0);
        border.extend(border.first().copied());
        map.placing.way(&border);
        let is_all =
            area.sides().next().is_none() && more.iter().all(|at| Polygon::from(*area).holds(*at));
        if !is_all {
            let ([left, right], [bottom, top]) = (map.axes.x.pixels, map.axes.z.pixels);
            let corners = [(left, bottom), (right, bottom), (right, top), (left, top)];
            let all: Vec<_> = corners.iter().map(|(x, z)| Spot::new(*x, *z)).collect();
            map.sheet.ground(Fill::Outside, &[all, map.spots(&Polygon::from(*area).0)]);
            map.sheet.name(Look::Ground(Fill::Outside), "outside the area");
        }
        map
    }

    fn spots(&self, places: &[Point2<f64>]) -> Vec<Spot> {
        places.iter().map(|at| self.axes.at(*at)).collect()
    }

    /// What is known of the ground.
    ///
    /// `is_refuted`: a label contradicts it.
    pub(crate) fn ground(&mut self, ground: &Ground, is_refuted: bool) {
        match ground {
            Ground::Certain(regions) => {
                let certain = if is_refuted { "taken to be certain of" } else { "certain to have" };
                self.regions(regions, &format!("ground {certain} label"));
                self.sheet.name(Look::Ground(Fill::Blank), "white: still uncertain");
            }
            Ground::Agreed(regions) => {
                self.regions(regions, "all lines of the set have label");
                self.sheet.name(Look::Ground(Fill::Blank), "white: lines of the set differ");
            }
            Ground::Credible(bands) => self.shade(bands),
            Ground::Plain => {}
        }
    }

    /// Ground of either label.
    fn regions(&mut self, [positive, negative]: &[Polygon; 2], meaning: &str) {
        for (label, region) in [(Label::Positive, positive), (Label::Negative, negative)] {
            let meaning = format!("{meaning} {:+}", label.sign());
            self.fill(Fill::Of(label), &[&region.0[..]], &meaning);
        }
    }

    fn shade(&mut self, bands: &[Band]) {
        for (k, Band { rings, .. }) in bands.iter().enumerate() {
            let rings: Vec<_> = rings.iter().map(|ring| self.spots(ring)).collect();
            self.sheet.ground(Fill::Shade(k), &rings);
        }
        let least = bands.iter().map(|band| format!("{:.0}", 100.0 * band.from));
        let least: Vec<_> = least.collect();
        if let Some((last, before)) = least.split_last() {
            let list = if before.is_empty() {
                last.clone()
            } else {
                format!("{} and {last}", before.join(", "))
            };
            let meaning = format!(
                "the line passes here with a probability of at least {list} % (white: less)"
            );
            self.sheet.name(Look::Shades(bands.len()), meaning);
        }
    }

    /// Ground of one kind.
    pub(crate) fn fill(&mut self, fill: Fill, polygons: &[&[Point2<f64>]], meaning: &str) {
        let rings: Vec<_> =
            polygons.iter().map(|ring| self.spots(ring)).filter(|ring| ring.len() > 2).collect();
        if !rings.is_empty() {
            self.sheet.ground(fill, &rings);
            self.sheet.name(Look::Ground(fill), meaning);
        }
    }

    /// The ground where a mapped front lies with a probability of 0.9. The legend begins with it and its front.
    pub(crate) fn front_ground(&mut self, front: &Ribbon, mapped: &str) {
        let mut is_narrow = true;
        for quad in front.ground() {
            let ring = self.spots(&quad);
            is_narrow &= (ring[0] - ring[3]).norm() < FRONT.width;
            self.sheet.ground(Fill::Front, &[ring]);
        }
        if !front.is_empty() {
            let seen = if is_narrow { "; here it is narrower than the line" } else { "" };
            let meaning = format!("the front lies here with a probability of 90 %{seen}");
            self.sheet.name(Look::Ground(Fill::Front), meaning);
            self.sheet.name(Look::Line(FRONT), mapped);
        }
    }

    /// Whether there is space for a mark: a map of a front has one of a look in each cell of so many pixels.
    fn has_space(&mut self, look: Look, at: Spot, cell: f64) -> bool {
        let of = |it: f64| (it / cell).floor() as i64;
        !self.follows || self.marked.insert((look.class(), [of(at.x), of(at.y)]))
    }

    /// Draws the keep-outs.
    pub(crate) fn limits(&mut self) {
        let outlines: Vec<Polygon> = self.area.hulls().map(Polygon::from).collect();
        for Polygon(outline) in &outlines {
            let ring = self.spots(outline);
            if let [from, to] = ring[..] {
                self.sheet.ways(
                    Stroke { class: "keep-out", width: 4.0, colour: "#6e6e6e", dashes: "" },
                    [&[from, to][..]],
                );
            }
            self.sheet.ground(Fill::KeepOut, &[ring]);
            self.sheet.name(Look::Ground(Fill::KeepOut), "kept out of");
        }
    }

    /// A line across the area, with a short name beside it if it has one.
    pub(crate) fn line(
        &mut self,
        line: &Line,
        stroke: Stroke,
        meaning: &str,
        beside: Option<&str>,
    ) {
        let Some(chord) = Polygon::from(self.area).chord(line) else { return };
        self.stretch(&chord, stroke, meaning);
        if let Some(name) = beside {
            let mut ends = self.spots(&chord);
            ends.sort_by(|p, q| p.x.total_cmp(&q.x));
            let inward = (ends[0] - ends[1]).normalize() * 16.0;
            self.beside(name, ends[1] + inward, 14.0);
        }
    }

    /// A way through some places.
    pub(crate) fn stretch(&mut self, places: &[Point2<f64>], stroke: Stroke, meaning: &str) {
        let spots = self.spots(places);
        self.placing.way(&spots);
        self.sheet.ways(stroke, [&spots[..]]);
        self.sheet.name(Look::Line(stroke), meaning);
    }

    /// Gives a look another meaning than it has on other maps.
    pub(crate) fn mean(&mut self, look: Look, meaning: String) {
        self.sheet.name(look, meaning);
    }

    /// A short name beside a place.
    pub(crate) fn name(&mut self, name: &str, at: Point2<f64>) {
        let at = self.axes.at(at);
        self.beside(name, at, 14.0);
    }

    fn beside(&mut self, name: &str, at: Spot, size: f64) {
        self.words.push((name.to_owned(), at, size));
    }

    /// The path with the heading after each step, and where the robot truly was. Numbers of steps come last.
    pub(crate) fn path(&mut self, start: Point2<f64>, stops: &[Stop]) {
        let places = stops.iter().flat_map(|stop| &stop.way);
        let way: Vec<_> =
            std::iter::once(&start).chain(places).map(|at| self.axes.at(*at)).collect();
        self.placing.way(&way);
        self.sheet.mark(Look::Start, way[0]);
        self.sheet.name(Look::Start, "start");
        self.placing.mark(way[0], 13.5);
        if stops.is_empty() {
            return;
        }
        self.sheet.ways(PATH, [&way[..]]);
        self.sheet.name(Look::Line(PATH), "path of the robot");
        if !self.follows {
            self.headings(stops);
        }
        for stop in stops {
            let at = self.axes.at(stop.at);
            if let Some(truly) = stop.truly.map(|truly| self.axes.at(truly)) {
                let thin = Stroke { class: "truly", colour: INK, width: 0.8, dashes: "" };
                self.sheet.ways(thin, [&[at, truly][..]]);
                self.sheet.mark(Look::Truly, truly);
                self.sheet.name(Look::Truly, "where the robot truly was");
                self.placing.way(&[at, truly]);
                self.placing.mark(truly, 4.0);
            }
            if stop.lacks_reading {
                if self.has_space(Look::Missing, at, 12.0) {
                    self.sheet.mark(Look::Missing, at);
                }
                self.sheet.name(Look::Missing, "a label was asked for, and none came");
            } else if !stop.sensed && !self.follows {
                self.sheet.mark(Look::Unread, at);
                self.sheet.name(Look::Unread, "a stop where no label was read");
            }
            self.placing.mark(at, 4.5);
        }
        if let (true, Some(end)) = (self.follows, way.last()) {
            self.sheet.mark(Look::End, *end);
            self.sheet.name(Look::End, "end");
        }
    }

    /// The heading after each step.
    fn headings(&mut self, stops: &[Stop]) {
        const TICK: f64 = 13.0;
        let ticks = stops.iter().map(|stop| {
            let (sin, cos) = libm::sincos(stop.heading);
            let at = self.axes.at(stop.at);
            vec![at, at + Vector2::new(cos, -sin) * TICK]
        });
        let ticks: Vec<_> = ticks.collect();
        for tick in &ticks {
            self.placing.way(tick);
        }
        self.sheet.ways(HEADING, ticks.iter().map(Vec::as_slice));
        self.sheet.name(Look::Line(HEADING), "heading after a step");
    }

    /// Draws the samples, the first `given` of which were given. Along a front the others are small.
    pub(crate) fn samples(&mut self, samples: &[Dot], given: usize) {
        for (k, dot) in samples.iter().enumerate() {
            let at = self.axes.at(dot.at);
            let sign = dot.label.sign();
            let (look, meaning, radius) = if k < given {
                self.beside(&format!("p{}", k + 1), at, 14.0);
                (Look::Given(dot.label), format!("given beforehand, label {sign:+}"), 8.0)
            } else if dot.sought {
                let meaning = format!("label {sign:+}, while the front was sought");
                (Look::Faint(dot.label), meaning, 3.0)
            } else {
                let look = if self.follows { Look::Small } else { Look::Read };
                (look(dot.label), format!("label {sign:+} was read here"), 5.0)
            };
            if let Some(ring) = dot.ring {
                let meaning = match ring {
                    Ring::Wrong => "ringed: the label is wrong",
                    Ring::Disagrees => "ringed: disagrees with the line",
                    Ring::Against => "dashed ring: disagrees with the best line",
                    Ring::Refutes => "double ring: no line left has this label here",
                };
                let is_small = self.follows && ring == Ring::Wrong;
                let ring = if is_small { Look::Wrong } else { Look::Ringed(ring) };
                if self.has_space(ring, at, 16.0) {
                    self.sheet.mark(ring, at);
                }
                self.sheet.name(ring, meaning);
            }
            if k < given || self.has_space(look, at, 8.0) {
                self.sheet.mark(look, at);
            }
            self.sheet.name(look, meaning);
            let radius = match dot.ring {
                None => radius,
                Some(Ring::Refutes) => 13.0,
                Some(_) => 10.0,
            };
            self.placing.mark(at, radius);
        }
    }

    /// All of the area in a corner with few of the places of a track, and what part of it is shown.
    pub(crate) fn inset(&mut self, track: &[Point2<f64>]) {
        const SIDE: f64 = 120.0;
        const OFF: f64 = 8.0;
        if !self.is_part {
            return;
        }
        let frame = self.axes.frame();
        self.sheet.close(&frame);
        let [min, max] = ends(&self.area);
        let scale = SIDE / (max - min).amax();
        let half = (max - min) * scale / 2.0;
        let off = frame.half - half - Vector2::repeat(OFF);
        let signs = [[1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [-1.0, 1.0]];
        let boxes = signs.map(|[x, y]| Frame {
            middle: frame.middle + Vector2::new(x * off.x, y * off.y),
            half,
        });
        let spots = self.spots(track);
        let hidden = |it: &Frame| spots.iter().filter(|at| it.meets(&[**at, **at])).count();
        let Some(place) = boxes.into_iter().min_by_key(hidden) else { return };
        let corner = Spot::new(place.middle.x - half.x, place.middle.y + half.y);
        let spot = |at: &Point2<f64>| {
            let from = (at - min) * scale;
            corner + Vector2::new(from.x, -from.y)
        };
        let ring = |[from, to]: [Point2<f64>; 2]| {
            let corners = [(from.x, from.y), (to.x, from.y), (to.x, to.y), (from.x, to.y)];
            let mut ring: Vec<_> =
                corners.iter().map(|(x, z)| spot(&Point2::new(*x, *z))).collect();
            ring.push(ring[0]);
            ring
        };
        let all = ring([min, max]);
        let ([left, right], [bottom, top]) = (self.axes.x.figures, self.axes.z.figures);
        let part = ring([Point2::new(left, bottom), Point2::new(right, top)]);
        self.sheet.ground(Fill::Blank, std::slice::from_ref(&all));
        self.sheet.ways(INSET, [&all[..], &part[..]]);
        let of = max - min;
        let meaning =
            format!("inset: all of the area, {} m x {} m, and the part shown", of.x, of.y);
        self.sheet.name(Look::Line(INSET), meaning);
        self.placing.block(place);
    }

    /// The numbers of steps, after names have found their places; then the figure is complete.
    pub(crate) fn finish(mut self, stops: &[Stop]) -> String {
        for (words, at, size) in std::mem::take(&mut self.words) {
            let frame = Vector2::new(width(&words, size) + 2.0, size);
            if let Some(found) = self.placing.place(at, frame, 6.0, REACH) {
                self.sheet.words(
                    &words,
                    foot(&found) - Vector2::new(0.0, 2.0),
                    size,
                    Anchor::Middle,
                );
            }
        }
        let spots: Vec<_> = stops.iter().map(|stop| self.axes.at(stop.at)).collect();
        numbers::draw(&mut self.sheet, &mut self.placing, &spots);
        self.axes.draw(&mut self.sheet, ["x, metres", "z, metres"]);
        if self.area.sides().next().is_some() && !self.is_part {
            let mut corners = self.spots(&Polygon::from(self.area).0);
            corners.extend(corners.first().copied());
            self.sheet.ways(BORDER, [&corners[..]]);
        }
        self.sheet.finish()
    }
}

/// The lower left and the upper right corner of an area's bounds.
fn ends(area: &MissionArea) -> [Point2<f64>; 2] {
    let bounds = area.bounds();
    [bounds.min(), bounds.max()].map(Point2::from)
}
