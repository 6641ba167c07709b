//! Figures in the manner of the paper's Figure 7, as SVG.

use nalgebra::Point2;

use crate::report::map::Map;
use crate::report::picture::{Picture, Truth};
use crate::report::style::{self, FRONT, PAST_TRUTH, TRUTH};

impl Picture {
    /// The picture as an SVG document.
    pub fn svg(&self) -> String {
        let stops = self.path.as_ref().map_or(&[][..], |(_, stops)| stops);
        let mut map = Map::new(&self.title, self.note.as_deref(), &self.area, &self.places());
        map.ground(&self.ground, self.is_refuted);
        map.front_ground(&self.front);
        map.limits();
        if let Some(truth) = self.truth.as_ref().and_then(Truth::line) {
            map.line(&truth, TRUTH, "true line", None);
        }
        for it in self.truth.iter().flat_map(Truth::outlines) {
            let stroke = if it.is_past { PAST_TRUTH } else { TRUTH };
            for way in &it.ways {
                map.stretch(way, stroke, it.name);
            }
        }
        for it in &self.lines {
            map.line(&it.line, style::of_line(it.kind), &it.name, it.beside.as_deref());
        }
        if let Some((start, stops)) = &self.path {
            map.path(*start, stops);
        }
        map.samples(&self.samples, self.given);
        // On top, as marks lie close together along a front.
        let moves = self.truth.iter().flat_map(Truth::outlines).any(|it| it.is_past);
        let mapped = if moves { "as it was when it was mapped" } else { "as it is mapped" };
        for way in self.front.ways() {
            map.stretch(&way, FRONT, &format!("the front {mapped}"));
        }
        map.finish(stops)
    }

    /// Places that may lie outside the area.
    fn places(&self) -> Vec<Point2<f64>> {
        let stops = self.path.iter().flat_map(|(_, stops)| stops);
        let of_path = stops.flat_map(|stop| stop.way.iter().copied().chain(stop.truly));
        let of_front = self.front.ground().flatten();
        of_path.chain(self.samples.iter().map(|dot| dot.at)).chain(of_front).collect()
    }
}
