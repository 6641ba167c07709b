//! The joined map: drawn, and for a map (`GeoJSON`).

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::replay::front_drawing::features;
use crate::replay::geojson::collection;
use crate::replay::joined_map::JoinedMap;
use crate::report::picture::Picture;
use crate::report::pieces::Pieces;

impl JoinedMap {
    /// The joined map by its pieces. One that is closed ends where it begins.
    fn drawn(&self) -> Pieces {
        let pieces = self.pieces.clone();
        if self.joined.is_closed { pieces.closed() } else { pieces }
    }

    /// The joined map as an SVG document. Of very many vertices it shows some.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let (metres, count) = (self.joined.metres(), self.files.len());
        let what = if self.joined.is_closed { "A closed front" } else { "A front" };
        let names: Vec<_> = self.files.iter().map(|it| it.name.clone()).collect();
        let note = format!("{what}: {metres:.0} m mapped by {count} robots");
        let picture = Picture::of_front(&names.join(", "), note, Vec::new(), self.drawn());
        Ok(picture.context("no area around the map")?.svg())
    }

    /// The joined map by its pieces, as `replay --front` writes one. A vertex also has its `robot`.
    ///
    /// # Errors
    /// For maps whose positions are in metres without a coordinate system. Also for positions on both sides of the
    /// 180th meridian.
    pub fn geojson(&self) -> Result<String> {
        if !self.frame.is_on_globe() {
            bail!(
                "--geojson: found positions in metres in {}, expected latitude and longitude, or the system of the metres \
                 (--crs EPSG:...)",
                self.files[0].name
            );
        }
        if self.frame.crosses_meridian(self.places().map(|it| it.vertex.at()))? {
            bail!("--geojson: the maps lie on both sides of the 180th meridian, expected one side");
        }
        let robots: Vec<_> = self.places().map(|it| it.robot).collect();
        let number = |index: usize, number: usize, told: &mut Value| {
            told[self.numbers()] = number.into();
            told["robot"] = robots[index].into();
        };
        Ok(collection(features(&self.pieces, &self.drawn(), &self.frame, &number)?))
    }
}
