//! The joined map: drawn, and for a map (`GeoJSON`).

use anyhow::{Context as _, Result, bail};
use serde_json::Value;

use crate::replay::front_drawing::{degrees, features, some};
use crate::replay::geojson::collection;
use crate::replay::joined_map::JoinedMap;
use crate::report::picture::{Ground, Picture, area_of};
use crate::report::ribbon::Ribbon;

impl JoinedMap {
    /// The joined map by its pieces. One that is closed ends where it begins.
    fn ribbon(&self) -> Ribbon {
        let mut ribbon = Ribbon::from(&self.pieces);
        if let (true, Some(rungs)) = (self.joined.is_closed, ribbon.0.first_mut()) {
            rungs.extend(rungs.first().copied());
        }
        ribbon
    }

    /// The joined map as an SVG document. Of very many vertices it shows some.
    ///
    /// # Errors
    /// When it could not be drawn.
    pub fn figure(&self) -> Result<String> {
        let front = some(self.ribbon());
        let area = area_of(front.ways().flatten()).context("no area around the map")?;
        let (metres, count) = (self.joined.metres(), self.files.len());
        let what = if self.joined.is_closed { "A closed front" } else { "A front" };
        let names: Vec<_> = self.files.iter().map(|it| it.name.clone()).collect();
        let svg = Picture {
            title: names.join(", "),
            note: Some(format!("{what}: {metres:.0} m mapped by {count} robots")),
            area: area.into(),
            ground: Ground::Plain,
            is_refuted: false,
            samples: Vec::new(),
            given: 0,
            path: None,
            truth: None,
            lines: Vec::new(),
            follows: true,
            front,
        };
        Ok(svg.svg())
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
        let lons = self.places().map(|it| Ok(degrees(&self.frame, it.vertex.at())?[0]));
        let lons = lons.collect::<Result<Vec<_>>>()?;
        let [least, most] = [f64::min, f64::max].map(|it| lons.iter().copied().fold(lons[0], it));
        if most - least > 180.0 {
            bail!("--geojson: the maps lie on both sides of the 180th meridian, expected one side");
        }
        let robots: Vec<_> = self.places().map(|it| it.robot).collect();
        let number = |index: usize, number: usize, told: &mut Value| {
            told[self.numbers()] = number.into();
            told["robot"] = robots[index].into();
        };
        Ok(collection(features(&self.pieces, &self.ribbon(), &self.frame, &number)?))
    }
}
