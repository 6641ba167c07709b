//! The area of a mission and its keep-outs, as scenario files describe them.

use std::path::Path;

use anyhow::{Result, anyhow};
use nalgebra::{Point2, Vector2};
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::link::message::{MOST_CORNERS, MOST_KEEP_OUTS, MissionArea};
use planner_core::{Area, Chart, Charted, Hull, KeepOut, Line, Site, Workspace as _};
use serde::Deserialize;

use crate::mission::allowance::tidy;
use crate::mission::lake::{self, Lake};
use crate::mission::strict::{Numbers, Table, beyond, wrong};
use crate::output::notes::mention;
use crate::world::polygon::Polygon;

/// Where motions may go: an area, and the cells of a map if it is from one.
pub type Terrain = Charted<'static, MissionArea>;

/// `area` of a scenario file: a rectangle or a convex polygon by its corners in order, metres, or polygons of any shape from
/// a map.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct AreaTable {
    /// From and to
    x: Option<Numbers<2>>,
    /// From and to
    z: Option<Numbers<2>>,
    /// Instead of both: three to eight corners in order around a convex polygon
    polygon: Option<Vec<Numbers<2>>>,
    /// Instead of all: a file beside the scenario with polygons of any shape, in latitude and longitude, or in metres of `crs`
    geojson: Option<String>,
    /// The system of the file's metres, as `"EPSG:32633"`
    crs: Option<String>,
    /// Cells along the longer side of the polygons, 2 to 256: motions stay on cells that lie wholly inside [default: 256]
    cells: Option<u16>,
}

impl Default for AreaTable {
    fn default() -> Self {
        let range = || Some(Numbers([0.0, 20.0]));
        Self { x: range(), z: range(), polygon: None, geojson: None, crs: None, cells: None }
    }
}

/// One of `keep_out`, metres: a disc, or a convex polygon.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct KeepOutTable {
    /// The middle of a disc
    pub(crate) x: Option<f64>,
    /// The middle of a disc
    pub(crate) z: Option<f64>,
    /// The middle of a disc, degrees, where the area is from a map
    pub(crate) lat: Option<f64>,
    /// The middle of a disc, degrees, where the area is from a map
    pub(crate) lon: Option<f64>,
    /// Its radius, up to 4096
    radius: Option<f64>,
    /// Instead: two corners (a wall) to eight, in order around a convex polygon
    polygon: Option<Vec<Numbers<2>>>,
}

impl AreaTable {
    /// The ground on a map, if it is one.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn lake(&self, folder: &Path) -> Result<Option<Lake>> {
        let Some(name) = &self.geojson else {
            let of_map = [("crs", self.crs.is_some()), ("cells", self.cells.is_some())];
            let Some((key, _)) = of_map.into_iter().find(|(_, is_there)| *is_there) else {
                return Ok(None);
            };
            return wrong(&format!("area.{key}"), "one", "none without area.geojson");
        };
        let crs = self.crs.as_deref().map(str::parse).transpose();
        let crs = crs.map_err(|error| anyhow!("area.crs: {error}"))?;
        let cells = self.cells.unwrap_or(lake::USUAL);
        if !(2..=lake::USUAL).contains(&cells) {
            return wrong("area.cells", cells, format!("2 to {}", lake::USUAL));
        }
        let lake = Lake::read(&folder.join(name), name, crs.as_ref(), cells);
        let lake = lake.map_err(|error| anyhow!("area.geojson: {error}"))?;
        mention(format_args!("area.geojson: {}", lake.words()));
        Ok(Some(lake))
    }
}

/// The position of a table: latitude and longitude, or metres. Of an area from a map these are the map's.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn on_map(
    field: &str,
    lake: Option<&Lake>,
    [x, z]: [&mut Option<f64>; 2],
    [lat, lon]: [Option<f64>; 2],
) -> Result<()> {
    if lake.is_none() && (lat, lon) == (None, None) {
        return Ok(());
    }
    let frame = lake.map(|it| &it.frame);
    let recorded = match (lat, lon, *x, *z) {
        (None, None, None, None) => return Ok(()),
        (Some(lat), Some(lon), None, None) => match frame {
            Some(frame) if frame.is_geographic() => [lat, lon],
            Some(_) => return wrong(field, "lat and lon", "x and z in metres of area.crs"),
            None => return wrong(field, "lat and lon", "x and z, as the area is in metres"),
        },
        (None, None, Some(east), Some(north)) => match frame {
            Some(frame) if frame.is_geographic() => {
                return wrong(field, "x and z", "lat and lon, as the area has them");
            }
            _ => [east, north],
        },
        _ => return wrong(field, "a part of a position", "lat and lon, or x and z"),
    };
    let Some(frame) = frame else { return Ok(()) };
    let site = frame.site(recorded).map_err(|error| anyhow!("{field}: {error}"))?;
    let at = Point2::<f64>::from(site);
    (*x, *z) = (Some(at.x), Some(at.y));
    Ok(())
}

/// The area of a mission, with its keep-outs.
///
/// # Errors
/// Names the field, what was found and what was expected.
pub(crate) fn area(
    area: &AreaTable,
    lake: Option<&Lake>,
    keep_outs: &[Table<KeepOutTable>],
) -> Result<MissionArea> {
    let keys = [
        ("x", area.x.is_some()),
        ("z", area.z.is_some()),
        ("polygon", area.polygon.is_some()),
        ("geojson", area.geojson.is_some()),
    ];
    let plain = match (lake, &area.x, &area.z, &area.polygon) {
        (None, Some(Numbers([x0, x1])), Some(Numbers([z0, z1])), None) => {
            let corners = (site("area", *x0, *z0)?, site("area", *x1, *z1)?);
            let Ok(area) = Area::new(corners.0, corners.1) else {
                let found = format!("x = [{x0}, {x1}], z = [{z0}, {z1}]");
                return wrong("area", found, "each range from smaller to larger");
            };
            MissionArea::from(area)
        }
        (Some(lake), None, None, None) => MissionArea::from(lake.bounds()),
        (None, None, None, Some(corners)) => {
            let hull = hull("area.polygon", corners, 3)?;
            let found = |why| wrong("area.polygon", why, "a polygon with an inside");
            MissionArea::new(hull, &[]).or_else(found)?
        }
        _ => return wrong("area", present(&keys), "one of { x, z }, { polygon } and { geojson }"),
    };
    if keep_outs.len() > MOST_KEEP_OUTS {
        return wrong("keep_out", keep_outs.len(), format!("at most {MOST_KEEP_OUTS}"));
    }
    let each = keep_outs.iter().enumerate().map(|(i, table)| keep_out(i, &table.0));
    let keep_outs = each.collect::<Result<Vec<_>>>()?;
    let corners = plain.corners();
    let polygon = Hull::new(corners)?;
    MissionArea::new(polygon, &keep_outs).or_else(|why| wrong("keep_out", why, "smaller ones"))
}

fn keep_out(number: usize, table: &KeepOutTable) -> Result<KeepOut<MOST_CORNERS>> {
    let field = format!("keep_out[{number}]");
    match (table.x, table.z, table.radius, &table.polygon) {
        (Some(x), Some(z), Some(radius), None) => {
            let units = (radius * f64::from(UNITS_PER_METRE)).ceil();
            if !(radius > 0.0 && radius <= 4096.0) {
                return beyond(&format!("{field}.radius"), radius);
            }
            let hull = Hull::new(&[site(&field, x, z)?])?;
            Ok(KeepOut { hull, radius: units as u32 })
        }
        (None, None, None, Some(corners)) => {
            Ok(KeepOut { hull: hull(&format!("{field}.polygon"), corners, 2)?, radius: 0 })
        }
        _ => {
            let keys = [
                ("x", table.x.is_some()),
                ("z", table.z.is_some()),
                ("radius", table.radius.is_some()),
                ("polygon", table.polygon.is_some()),
            ];
            wrong(&field, present(&keys), "either { x, z, radius } or { polygon }")
        }
    }
}

/// The keys that are there.
fn present(keys: &[(&str, bool)]) -> String {
    let found: Vec<_> =
        keys.iter().filter(|(_, is_there)| *is_there).map(|(key, _)| *key).collect();
    if found.is_empty() { "no keys".to_owned() } else { found.join(" and ") }
}

fn hull(field: &str, corners: &[Numbers<2>], least: usize) -> Result<Hull<MOST_CORNERS>> {
    if corners.len() < least {
        return wrong(field, format!("{} corners", corners.len()), format!("{least} at least"));
    }
    let each = corners.iter().enumerate();
    let sites = each.map(|(i, Numbers([x, z]))| site(&format!("{field}[{i}]"), *x, *z));
    let sites = sites.collect::<Result<Vec<Site>>>()?;
    Hull::new(&sites).or_else(|why| {
        let list = corners.iter().map(|Numbers([x, z])| format!("[{x}, {z}]"));
        let expected = format!(
            "the corners of a convex polygon in order around it, at most {MOST_CORNERS} ({why})"
        );
        wrong(field, format!("[{}]", list.collect::<Vec<_>>().join(", ")), expected)
    })
}

/// A position in metres.
///
/// # Errors
/// Names the coordinate of `field` that is beyond the lattice.
pub(crate) fn site(field: &str, x: f64, z: f64) -> Result<Site> {
    for (name, value) in [("x", x), ("z", z)] {
        if Site::try_from(Point2::new(value, 0.0)).is_err() {
            let is_of_a_map = (1e5..1e8).contains(&value.abs());
            let hint = if is_of_a_map {
                ": count from a corner of the area, as a raster is brought there"
            } else {
                ""
            };
            let expected = format!("a finite coordinate smaller than 8192 m in size{hint}");
            return wrong(&format!("{field}.{name}"), value, expected);
        }
    }
    Ok(Site::try_from(Point2::new(x, z))?)
}

/// Whether a position is where the agent may be.
///
/// # Errors
/// Names `field` and what is in the way.
pub fn check_inside(field: &str, site: Site, area: &Terrain) -> Result<()> {
    let at = Point2::<f64>::from(site);
    let found = format!("({}, {})", tidy(at.x), tidy(at.y));
    if !area.encloses(site) {
        let bounds = area.bounds();
        let [min, max] = [bounds.min(), bounds.max()].map(Point2::<f64>::from);
        let [x, z] = [[min.x, max.x], [min.y, max.y]].map(|it| it.map(tidy));
        let expected = format!(
            "a point inside the area, in metres: x {} to {}, z {} to {}",
            x[0], x[1], z[0], z[1]
        );
        return wrong(field, found, expected);
    }
    let is_open = |it: &Chart<'_>| it.cell_of(site).is_some_and(|cell| it.is_open(cell));
    if let Some(chart) = area.chart().filter(|it| !is_open(it)) {
        let side = tidy(f64::from(chart.side()) / f64::from(UNITS_PER_METRE));
        let found = format!("{found}, metres from the middle");
        let expected = format!(
            "a point whose cell of {side} m lies wholly inside area.geojson, in its largest part"
        );
        return wrong(field, found, expected);
    }
    let in_the_way = area.keep_outs().position(|it| !it.is_clear_of(&[site], 0));
    in_the_way.map_or(Ok(()), |k| wrong(field, found, format!("a point outside keep_out[{k}]")))
}

/// Whether any of an area is further than a margin from its border.
pub(crate) fn leaves_any(area: &MissionArea, margin: f64) -> bool {
    let whole = Polygon::from(*area);
    let edges = whole.0.iter().zip(whole.0.iter().cycle().skip(1));
    let further = |rest: Polygon, (a, b): (&Point2<f64>, &Point2<f64>)| {
        let inwards = Vector2::new(a.y - b.y, b.x - a.x).normalize();
        let line = Line::through(a + inwards * margin, inwards);
        line.map_or(rest.clone(), |line| rest.clip(&line, 1.0))
    };
    edges.fold(whole.clone(), further).area() > 0.0
}
