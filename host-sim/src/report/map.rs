//! A picture as SVG, in the manner of the paper's Figure 7. Ground, lines, paths and samples are named in the legend as
//! they are drawn.

use std::collections::HashSet;
use std::iter;

use nalgebra::{Point2, Vector2};
use planner_core::Workspace as _;
use planner_core::link::message::MissionArea;

use crate::report::axes::{Axes, Axis, Scale};
use crate::report::bands::Band;
use crate::report::ground::Ground;
use crate::report::look::{END, Look, Mark, NUMBER_OF_STEP, START, TRULY};
use crate::report::picture::{Drawn, Picture};
use crate::report::placing::{Frame, Placing, foot};
use crate::report::shapes::{self, Anchor, NUMBER, Spot, width};
use crate::report::sheet::Sheet;
use crate::report::style::{
    BLANK, BORDER, DOUBTFUL, FRONT, FRONT_BAND, Fill, GROUND_NEGATIVE, GROUND_POSITIVE, HEADING,
    INK, INSET, KEEP_OUT, OUTSIDE, PATH, SHADES, Stroke, dashed,
};
use crate::world::extent::around;
use crate::world::polygon::Polygon;

/// Metres and pixels of a map, and what is on it so far.
struct Map<'a> {
    picture: &'a Picture,
    /// The border of the area, the first corner once more at the end.
    border: Vec<Spot>,
    axes: Axes,
    sheet: Sheet,
    placing: Placing,
    /// Words that are placed after all marks: the text and its spot.
    words: Vec<(String, Spot)>,
    /// Where a thinned map has marks already: what mark, in which cell.
    marked: HashSet<(&'static str, [i64; 2])>,
    /// Whether it shows a part of the area.
    is_part: bool,
}

/// A track is shown alone if it is smaller than this share of the area.
const SMALL: f64 = 0.5;

/// The sides of a part of an area differ by this factor at most.
const SLIM: f64 = 0.4;

impl Picture {
    /// The picture as an SVG document. Of a front marks are below the path and its map, as there are many.
    pub fn svg(&self) -> String {
        let mut map = Map::of(self);
        map.ground();
        if self.follows {
            map.samples();
            map.path();
            map.draw(&self.mapped());
        }
        self.truth.iter().chain(&self.lines).for_each(|it| map.draw(it));
        if self.follows {
            map.inset();
        } else {
            map.path();
            map.samples();
        }
        map.finish()
    }

    /// The part of the area that a map of a front shows: the track alone if that is small.
    fn part(&self, places: &[Point2<f64>]) -> Option<[Point2<f64>; 2]> {
        let [low, high] = ends(&self.area);
        let [min, max] = around(places.iter().copied()).filter(|_| self.follows)?;
        let size = max - min;
        let margin = 0.1 * size.amax();
        let half = size.map(|it| it.max(SLIM * size.amax()) / 2.0 + margin);
        let middle = nalgebra::center(&min, &max);
        let is_small = size.amax() > 0.0 && 2.0 * half.amax() < SMALL * (high - low).amax();
        is_small.then_some([middle - half, middle + half])
    }
}

impl<'a> Map<'a> {
    /// The bare area, large enough for all places of the picture.
    fn of(picture: &'a Picture) -> Self {
        const SIZE: f64 = 620.0;
        const LEAST: f64 = 220.0;
        const TOP: f64 = 70.0;
        let Picture { title, note, area, .. } = picture;
        let places = picture.places();
        let part = picture.part(&places);
        let all = || around(ends(area).into_iter().chain(places.iter().copied()));
        let [min, max] = part.or_else(all).unwrap_or(ends(area));
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
        if part.is_some() {
            sheet.open();
        }
        let border = Polygon::from(*area);
        let corners = border.0.iter().chain(border.0.first());
        let mut map = Self {
            picture,
            border: corners.map(|at| axes.at(*at)).collect(),
            placing: Placing::new(axes.frame()),
            axes,
            sheet,
            words: Vec::new(),
            marked: HashSet::new(),
            is_part: part.is_some(),
        };
        map.placing.way(&map.border);
        let is_all = area.sides().next().is_none() && places.iter().all(|at| border.holds(*at));
        if !is_all {
            let all = shapes::border(map.axes.at(min), map.axes.at(max));
            map.sheet.ground(OUTSIDE, &[all[..4].to_vec(), map.spots(&border.0)]);
            map.sheet.name(Look::Ground(OUTSIDE), "outside the area");
        }
        map
    }

    fn spots(&self, places: &[Point2<f64>]) -> Vec<Spot> {
        places.iter().map(|at| self.axes.at(*at)).collect()
    }

    /// What is known of the ground, and what is kept out of.
    fn ground(&mut self) {
        match &self.picture.ground {
            Ground::Labelled(regions) => {
                let [labelled, white] = self.picture.says;
                let [positive, negative] = regions;
                self.fill(GROUND_POSITIVE, &positive.0, &format!("{labelled} +1"));
                self.fill(GROUND_NEGATIVE, &negative.0, &format!("{labelled} -1"));
                if !white.is_empty() {
                    self.sheet.name(Look::Ground(BLANK), white);
                }
            }
            Ground::Credible(bands) => self.shade(bands),
            Ground::Plain => {}
        }
        self.fill(DOUBTFUL, &self.picture.doubtful.0, "labels may be wrong here");
        self.front_ground();
        if !self.picture.shores.is_empty() {
            let rings = self.picture.shores.iter().map(|ring| self.spots(ring));
            let land: Vec<_> = [self.border.clone()].into_iter().chain(rings).collect();
            self.sheet.ground(KEEP_OUT, &land);
            self.sheet.name(Look::Ground(KEEP_OUT), "land");
        }
        for hull in self.picture.area.hulls() {
            let Polygon(outline) = Polygon::from(hull);
            if outline.len() == 2 {
                let way = self.spots(&outline);
                self.sheet.ways(dashed("keep-out", "#6e6e6e", 4.0, ""), [&way[..]]);
                self.sheet.name(Look::Ground(KEEP_OUT), "kept out of");
            }
            self.fill(KEEP_OUT, &outline, "kept out of");
        }
    }

    fn shade(&mut self, bands: &[Band]) {
        for (k, Band { rings, .. }) in bands.iter().enumerate() {
            let rings: Vec<_> = rings.iter().map(|ring| self.spots(ring)).collect();
            self.sheet.ground(SHADES[k], &rings);
        }
        let least = bands.iter().map(|band| format!("{:.0}", 100.0 * band.from));
        let least: Vec<_> = least.collect();
        if let Some((last, before)) = least.split_last() {
            let before = before.join(", ");
            let list = if before.is_empty() { last } else { &format!("{before} and {last}") };
            let meaning = format!(
                "the line passes here with a probability of at least {list} % (white: less)"
            );
            self.sheet.name(Look::Shades(bands.len()), meaning);
        }
    }

    /// Ground of one kind.
    fn fill(&mut self, fill: Fill, ring: &[Point2<f64>], meaning: &str) {
        if ring.len() > 2 {
            self.sheet.ground(fill, &[self.spots(ring)]);
            self.sheet.name(Look::Ground(fill), meaning);
        }
    }

    /// The ground where a mapped front lies with a probability of 0.9. The legend begins with it and its front.
    fn front_ground(&mut self) {
        let mut rings = self.picture.front.ground().flatten().peekable();
        if rings.peek().is_none() {
            return;
        }
        let mut is_narrow = true;
        for quad in rings {
            let ring = self.spots(&quad);
            is_narrow &= (ring[0] - ring[3]).norm() < FRONT.width;
            self.sheet.ground(FRONT_BAND, &[ring]);
        }
        let seen = if is_narrow { "; here it is narrower than the line" } else { "" };
        let meaning = format!("the front lies here with a probability of 90 %{seen}");
        self.sheet.name(Look::Ground(FRONT_BAND), meaning);
        self.sheet.name(Look::Line(FRONT), self.picture.mapped().name);
    }

    /// A line or a boundary, with its short word beside its right end.
    fn draw(&mut self, Drawn { name, stroke, ways, beside }: &Drawn) {
        for way in ways {
            let mut spots = self.spots(way);
            self.placing.way(&spots);
            self.sheet.ways(*stroke, [&spots[..]]);
            self.sheet.name(Look::Line(*stroke), name);
            if let Some(word) = beside {
                spots.sort_by(|p, q| p.x.total_cmp(&q.x));
                let inward = (spots[0] - spots[1]).normalize() * 16.0;
                self.words.push((word.clone(), spots[1] + inward));
            }
        }
    }

    /// A mark, if there is space for it: a map of a front has one of a look in each cell.
    fn mark(&mut self, mark: Mark, at: Spot) {
        let cell = [at.x, at.y].map(|it| (it / mark.cell).floor() as i64);
        let is_thinned = self.picture.follows && mark.cell > 0.0;
        if !is_thinned || self.marked.insert((mark.class, cell)) {
            self.sheet.mark(Look::Mark(mark), at);
        }
        self.sheet.name(Look::Mark(mark), mark.meaning);
        self.placing.mark(at, mark.radius);
    }

    /// The path with the heading after each step, and where the robot truly was. Numbers of steps come last.
    fn path(&mut self) {
        let Picture { start, stops, follows, .. } = self.picture;
        let Some(start) = start else { return };
        let places = stops.iter().flat_map(|stop| &stop.way);
        let way: Vec<_> = iter::once(start).chain(places).map(|at| self.axes.at(*at)).collect();
        self.placing.way(&way);
        self.mark(START, way[0]);
        let [.., end] = way[..] else { return };
        if stops.is_empty() {
            return;
        }
        self.sheet.ways(PATH, [&way[..]]);
        self.sheet.name(Look::Line(PATH), "path of the robot");
        if !follows {
            self.headings();
        }
        for stop in stops {
            let at = self.axes.at(stop.at);
            if let Some(truly) = stop.truly.map(|truly| self.axes.at(truly)) {
                self.sheet.ways(dashed("truly", INK, 0.8, ""), [&[at, truly][..]]);
                self.placing.way(&[at, truly]);
                self.mark(TRULY, truly);
            }
            if let Some(mark) = stop.mark {
                self.mark(mark, at);
            }
            self.placing.mark(at, 4.5);
        }
        if *follows {
            self.mark(END, end);
        }
    }

    /// The heading after each step.
    fn headings(&mut self) {
        const TICK: f64 = 13.0;
        let ticks = self.picture.stops.iter().map(|stop| {
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

    /// The samples, the given ones with their names.
    fn samples(&mut self) {
        for (k, dot) in self.picture.samples.iter().enumerate() {
            let at = self.axes.at(dot.at);
            if k < self.picture.given {
                self.words.push((format!("p{}", k + 1), at));
            }
            for mark in dot.ring.into_iter().chain([dot.mark]) {
                self.mark(mark, at);
            }
        }
    }

    /// All of the area in a corner with few of the places of the track, and what part of it is shown.
    fn inset(&mut self) {
        const SIDE: f64 = 120.0;
        const OFF: f64 = 8.0;
        if !self.is_part {
            return;
        }
        let frame = self.axes.frame();
        self.sheet.close(&frame);
        let [min, max] = ends(&self.picture.area);
        let scale = SIDE / (max - min).amax();
        let half = (max - min) * scale / 2.0;
        let off = frame.half - half - Vector2::repeat(OFF);
        let signs = [[1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [-1.0, 1.0]];
        let boxes = signs.map(|[x, y]| Frame {
            middle: frame.middle + Vector2::new(x * off.x, y * off.y),
            half,
        });
        let spots = self.spots(&self.picture.places());
        let hidden = |it: &Frame| spots.iter().filter(|at| it.meets(&[**at, **at])).count();
        let Some(place) = boxes.into_iter().min_by_key(hidden) else { return };
        let corner = Spot::new(place.middle.x - half.x, place.middle.y + half.y);
        let spot = |at: &Point2<f64>| {
            let from = (at - min) * scale;
            corner + Vector2::new(from.x, -from.y)
        };
        let ([left, right], [bottom, top]) = (self.axes.x.figures, self.axes.z.figures);
        let ring = |from, to| shapes::border(spot(&from), spot(&to));
        let all = ring(min, max);
        let part = ring(Point2::new(left, bottom), Point2::new(right, top));
        self.sheet.ground(BLANK, std::slice::from_ref(&all));
        self.sheet.ways(INSET, [&all[..], &part[..]]);
        let of = max - min;
        let meaning =
            format!("inset: all of the area, {} m x {} m, and the part shown", of.x, of.y);
        self.sheet.name(Look::Line(INSET), meaning);
        self.placing.block(place);
    }

    /// The numbers of steps, after names have found their places; then the figure is complete.
    fn finish(mut self) -> String {
        const WORDS: f64 = 14.0;
        const REACH: f64 = 90.0;
        let named = self.picture.words.iter().map(|(word, at)| (word.clone(), self.axes.at(*at)));
        for (words, at) in self.words.into_iter().chain(named) {
            let size = Vector2::new(width(&words, WORDS) + 2.0, WORDS);
            if let Some(found) = self.placing.place(at, size, 6.0, REACH) {
                let foot = foot(&found) - Vector2::new(0.0, 2.0);
                self.sheet.words(&words, foot, WORDS, Anchor::Middle);
            }
        }
        let stops = &self.picture.stops;
        let spots: Vec<_> = stops.iter().map(|stop| self.axes.at(stop.at)).collect();
        number(&mut self.sheet, &mut self.placing, &spots);
        self.axes.draw(&mut self.sheet, ["x, metres", "z, metres"]);
        if self.picture.area.sides().next().is_some() && !self.is_part {
            self.sheet.ways(BORDER, [&self.border[..]]);
        }
        self.sheet.finish()
    }
}

/// The lower left and the upper right corner of an area's bounds.
fn ends(area: &MissionArea) -> [Point2<f64>; 2] {
    let bounds = area.bounds();
    [bounds.min(), bounds.max()].map(Point2::from)
}

/// The line from a step to its number, if the number is far away.
const LEADER: Stroke = Stroke { class: "number", colour: INK, width: 0.6, dashes: "1.5 1.5" };

/// The distance of a number from its step, pixels: the least, the greatest without a leader, the greatest.
const AWAY: [f64; 3] = [5.0, 13.0, 120.0];

/// The steps between two numbers that are always shown.
const EVERY: usize = 5;

/// Steps that have numbers, at most.
const MOST: usize = 60;

/// The numbers of steps, placed beside the steps' ends. Where there is too little space a number is left out. The first,
/// the last and every fifth are always shown: they stand further away, and a thin line leads to them. Many steps have no
/// numbers.
fn number(sheet: &mut Sheet, placing: &mut Placing, stops: &[Spot]) {
    let [least, near, most] = AWAY;
    let count = stops.len();
    if count > MOST {
        return;
    }
    let is_kept = |k: usize| k == 1 || k == count || k.is_multiple_of(EVERY);
    let kept = (1..=count).filter(|k| is_kept(*k));
    let others = (1..=count).filter(|k| !is_kept(*k));
    let mut left_out = 0;
    for k in kept.chain(others) {
        let at = stops[k - 1];
        let name = k.to_string();
        let size = Vector2::new(width(&name, NUMBER) + 1.0, NUMBER);
        let reach = if is_kept(k) { most } else { near };
        let Some(frame) = placing.place(at, size, least, reach) else {
            left_out += 1;
            continue;
        };
        let way = frame.middle - at;
        let room = way.abs() - frame.half;
        if room.x.max(room.y) > near {
            let share = (frame.half.x / way.x.abs()).min(frame.half.y / way.y.abs());
            let leader = [at + way.normalize() * least, frame.middle - way * share];
            sheet.ways(LEADER, [&leader[..]]);
            placing.way(&leader);
        }
        sheet.number(&name, foot(&frame) - Vector2::new(0.0, 0.5));
    }
    if count > 0 {
        let meaning = NUMBER_OF_STEP.meaning;
        let meaning = match left_out {
            0 => meaning.to_owned(),
            _ => format!("{meaning}; left out where too tight: {left_out}"),
        };
        sheet.name(Look::Mark(NUMBER_OF_STEP), meaning);
    }
}
