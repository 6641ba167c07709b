//! Figures in the manner of the paper's Figure 7, as SVG.

use nalgebra::Point2;

use crate::report::map::Map;
use crate::report::picture::{Picture, Stop, Truth};
use crate::report::style::{self, FRONT, PAST_TRUTH, TRUE_FRONT, TRUTH};

impl Picture {
    /// The picture as an SVG document.
    pub fn svg(&self) -> String {
        if self.follows { self.front_svg() } else { self.line_svg() }
    }

    fn line_svg(&self) -> String {
        let note = self.note.as_deref();
        let mut map = Map::new(&self.title, note, &self.area, &self.places());
        map.ground(&self.ground, self.is_refuted);
        map.limits();
        if let Some(truth) = self.truth.as_ref().and_then(Truth::line) {
            map.line(&truth, TRUTH, "true line", None);
        }
        self.outlines(&mut map);
        for it in &self.lines {
            map.line(&it.line, style::of_line(it.kind), &it.name, it.beside.as_deref());
        }
        if let Some((start, stops)) = &self.path {
            map.path(*start, stops);
        }
        map.samples(&self.samples, self.given);
        map.finish(self.stops())
    }

    /// Of a front: marks are below the path and its map, as there are many.
    fn front_svg(&self) -> String {
        let (note, places) = (self.note.as_deref(), self.places());
        let mut map = Map::following(&self.title, note, &self.area, &places);
        let moves = self.truth.iter().flat_map(Truth::outlines).any(|it| it.is_past);
        let mapped = if moves { "as it was when it was mapped" } else { "as it is mapped" };
        let mapped = format!("the front {mapped}");
        map.front_ground(&self.front, &mapped);
        map.limits();
        map.samples(&self.samples, self.given);
        if let Some((start, stops)) = &self.path {
            map.path(*start, stops);
        }
        for way in self.front.ways() {
            map.stretch(&way, FRONT, &mapped);
        }
        if let Some(truth) = self.truth.as_ref().and_then(Truth::line) {
            map.line(&truth, TRUE_FRONT, "true line", None);
        }
        self.outlines(&mut map);
        map.inset(&places);
        map.finish(self.stops())
    }

    /// The true boundary where it is no still line.
    fn outlines(&self, map: &mut Map) {
        for it in self.truth.iter().flat_map(Truth::outlines) {
            let there = if self.follows { TRUE_FRONT } else { TRUTH };
            let stroke = if it.is_past { PAST_TRUTH } else { there };
            for way in &it.ways {
                map.stretch(way, stroke, it.name);
            }
        }
    }

    fn stops(&self) -> &[Stop] {
        self.path.as_ref().map_or(&[][..], |(_, stops)| stops)
    }

    /// Places of the track and of the map, which may lie outside the area.
    fn places(&self) -> Vec<Point2<f64>> {
        let starts = self.path.iter().map(|(start, _)| *start);
        let of_path =
            self.stops().iter().flat_map(|stop| stop.way.iter().copied().chain(stop.truly));
        let of_front = self.front.ground().flatten();
        let of_samples = self.samples.iter().map(|dot| dot.at);
        starts.chain(of_path).chain(of_samples).chain(of_front).collect()
    }
}
