//! `truth` of a scenario file: the boundary of the simulated world.

use std::path::Path;

use anyhow::{Result, anyhow, bail};
use nalgebra::Point2;
use planner_core::Line;
use planner_core::link::message::MissionArea;
use serde::Deserialize;

use crate::mission::lake::{self, Lake};
use crate::mission::strict::{Numbers, Table, wrong};
use crate::output::kind;
use crate::output::notes::mention;
use crate::world::World;
use crate::world::boundary::{CoastRecord, Curve};
use crate::world::circle::Circle;
use crate::world::crs::Crs;
use crate::world::extent::around;
use crate::world::files;
use crate::world::frame::System;
use crate::world::grid::Axes;
use crate::world::moving::Moving;
use crate::world::polygon::Polygon;
use crate::world::polyline::Polyline;
use crate::world::raster::Raster;
use crate::world::raster_file;
use crate::world::shapes::Shapes;
use crate::world::sine::Sine;
use crate::world::way::Way;

/// Lengths are up to so many metres, so that no sum of theirs overflows.
const FURTHEST: f64 = 1e6;

/// The part of a coast that is drawn is so many of its lengths to either side, at most.
const MOST_LENGTHS: f64 = 1_000.0;

/// The boundary: a straight line, or another kind by its key.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TruthTable {
    /// A line `z = slope x + intercept`, +1 above
    slope: Option<f64>,
    /// Its height at `x = 0`, metres
    intercept: Option<f64>,
    /// Instead of both: `[A, B, C]` of `A x + B z + C = 0`, +1 where it is positive
    line: Option<Numbers<3>>,
    /// `[x, z, radius]`, +1 inside
    circle: Option<Numbers<3>>,
    /// `[height, length, phase]` of a wave about `slope` and `intercept` (0 unless given) or `line`, see below
    sine: Option<Numbers<3>>,
    /// `[[x, z], ...]`, +1 above; each `x` is greater than the one before, and the ends go on straight
    polyline: Option<Vec<Numbers<2>>>,
    /// `[[x, z], ...]`, +1 inside
    polygon: Option<Vec<Numbers<2>>>,
    /// A random coast about the middle of the area, +1 above
    coast: Option<Table<CoastRecord>>,
    /// A file beside the scenario, +1 where its value is `threshold` or more, see below
    raster: Option<String>,
    /// Of a raster
    threshold: Option<f64>,
    /// Of a raster in an area from a map: the system of its metres, if it is neither told in the file nor that of the area
    crs: Option<String>,
    /// Polygons of a file beside the scenario, +1 inside, in the coordinates of the area
    geojson: Option<String>,
    /// The boundary moves with every motion: a line by `[metres along its normal, degrees]`, any other by `[x, z]`, metres
    drift: Option<Numbers<2>>,
}

impl TruthTable {
    /// Its slope and its intercept.
    pub(crate) fn base(&self) -> Option<[f64; 2]> {
        Some([self.slope?, self.intercept?])
    }

    /// The world that it describes. A raster is sought in a folder.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn world(
        &self,
        area: &MissionArea,
        lake: Option<&Lake>,
        folder: &Path,
    ) -> Result<World> {
        let area = Polygon::from(*area);
        self.check_keys()?;
        let rectangle = around(area.0.iter().copied()).unwrap_or_default();
        let curve: Box<dyn Curve> = if let Some(Numbers([x, z, radius])) = self.circle {
            Box::new(circle([x, z], radius)?)
        } else if let Some(Numbers(wave)) = self.sine {
            Box::new(self.sine(wave)?)
        } else if let Some(points) = &self.polyline {
            Box::new(polyline(points)?)
        } else if let Some(points) = &self.polygon {
            Box::new(Shapes::drawn(places("truth.polygon", points, 3)?))
        } else if let Some(Table(coast)) = &self.coast {
            Box::new(self::coast(*coast, rectangle)?)
        } else if let Some(name) = &self.geojson {
            let rings = match lake {
                Some(lake) => lake.rings_of(&folder.join(name), name),
                None => metres(&folder.join(name), name),
            };
            let rings = rings.map_err(|why| anyhow!("truth.geojson: {why}"))?;
            Box::new(Shapes::new(name.clone(), rings))
        } else if let (Some(name), Some(threshold)) = (&self.raster, self.threshold) {
            if !threshold.is_finite() {
                return wrong("truth.threshold", threshold, "a number");
            }
            let path = folder.join(name);
            if let Err(error) = files::open(&path) {
                let expected = "the name of one, beside the scenario";
                return wrong(
                    "truth.raster",
                    format!("{} as {name}", kind::unread(&error)),
                    expected,
                );
            }
            let grid = raster_file::read(&path, rectangle);
            let (mut grid, own) = grid.or_else(|why| wrong("truth.raster", name, why))?;
            let is_placed = !name.to_ascii_lowercase().ends_with(".png");
            let map = lake.filter(|_| is_placed);
            if let (Some(crs), None) = (&self.crs, map) {
                let expected = "an area from a map, and a grid or a GeoTIFF for its truth";
                return wrong("truth.crs", crs, expected);
            }
            if let Some(lake) = map {
                let system = self.system(own)?;
                let middle = grid.middle();
                let drawn = grid.drawn_on(rectangle, |at| lake.frame.on_map(at, &system, middle));
                grid = drawn.or_else(|why| wrong("truth.raster", name, why))?;
            } else if own == Some(Axes::Degrees) {
                let found = format!("{name} in latitude and longitude");
                return wrong("truth.raster", found, "metres, or an area from a map");
            } else if let Some([x, z]) = grid.brought_to(rectangle) {
                mention(format_args!(
                    "truth.raster: {name} lies far off, so its corner ({x}, {z}) is put at that of the area"
                ));
            }
            Box::new(Raster::new(name.clone(), &grid, threshold))
        } else {
            let start = self.line()?;
            let Some(Numbers([offset, turn])) = self.drift else {
                return Ok(World::divided_by(start));
            };
            if !(offset.abs() <= FURTHEST && turn.abs() <= 360.0) {
                let expected = "metres and degrees for each motion, up to 1e6 and 360";
                return wrong("truth.drift", format!("[{offset}, {turn}]"), expected);
            }
            let [min, max] = rectangle;
            let about = nalgebra::center(&min, &max);
            return Ok(World::divided_by_moving(Moving { start, offset, turn, about }));
        };
        let drift = self.drift.as_ref().map_or([0.0; 2], |Numbers(drift)| *drift);
        if !drift.iter().all(|it| it.abs() <= FURTHEST) {
            let expected = "metres along x and z for each motion, up to 1e6";
            return wrong("truth.drift", format!("{drift:?}"), expected);
        }
        Ok(World::divided_by_moving_curve(curve, &area, drift.into()))
    }

    /// What the coordinates of a raster are, by `crs` and by what its file says.
    fn system(&self, own: Option<Axes>) -> Result<System> {
        let own = own.map(|it| match it {
            Axes::Degrees => Ok(System::Degrees),
            Axes::Metres(code) => format!("EPSG:{code}").parse().map(System::Metres),
        });
        let Some(told) = &self.crs else {
            return own.unwrap_or(Ok(System::OfMap)).map_err(|why| anyhow!("truth.raster: {why}"));
        };
        let told: Crs = told.parse().map_err(|error| anyhow!("truth.crs: {error}"))?;
        match own {
            Some(Ok(System::Degrees)) => {
                wrong("truth.crs", told, "none, as the file is in latitude and longitude")
            }
            Some(Ok(System::Metres(own))) if own != told => {
                wrong("truth.crs", told, format!("none, as the file says {own}"))
            }
            _ => Ok(System::Metres(told)),
        }
    }

    /// Whether the keys describe one boundary.
    fn check_keys(&self) -> Result<()> {
        let has_base = self.slope.is_some() || self.intercept.is_some() || self.line.is_some();
        let has_raster = self.raster.is_some() || self.threshold.is_some();
        let kinds = [
            ("circle", self.circle.is_some()),
            ("sine", self.sine.is_some()),
            ("polyline", self.polyline.is_some()),
            ("polygon", self.polygon.is_some()),
            ("coast", self.coast.is_some()),
            ("raster", has_raster),
            ("geojson", self.geojson.is_some()),
            ("a line", has_base && self.sine.is_none()),
        ];
        let found: Vec<_> =
            kinds.iter().filter(|(_, is_found)| *is_found).map(|(name, _)| *name).collect();
        if found.len() > 1 {
            return wrong("truth", found.join(" and "), "one boundary");
        }
        if let (Some(crs), false) = (&self.crs, has_raster) {
            return wrong("truth.crs", crs, "none: it is of a raster");
        }
        match (has_raster, self.raster.is_some(), self.threshold.is_some()) {
            (true, true, false) => wrong("truth", "raster without threshold", "both"),
            (true, false, true) => wrong("truth", "threshold without raster", "both"),
            _ => Ok(()),
        }
    }

    /// The straight line.
    fn line(&self) -> Result<Line> {
        let expected = "either { slope, intercept } or { line = [A, B, C] }";
        let coefficients = self.line.as_ref().map(|numbers| numbers.0);
        let line = match (self.slope, self.intercept, coefficients) {
            (Some(slope), Some(intercept), None) => Line::from_slope(slope, intercept),
            (None, None, Some([a, b, c])) => Line::from_coefficients(a, b, c),
            (None, None, None) => return wrong("truth", "no boundary", expected),
            (_, _, Some(_)) => return wrong("truth", "both", expected),
            (Some(_), None, _) => return wrong("truth", "slope without intercept", expected),
            (None, Some(_), _) => return wrong("truth", "intercept without slope", expected),
        };
        let found = match (self.slope, self.intercept, coefficients) {
            (Some(slope), Some(intercept), _) => format!("slope {slope}, intercept {intercept}"),
            (_, _, line) => format!("{:?}", line.unwrap_or_default()),
        };
        let finite = "finite numbers, A and B not both 0";
        line.map_or_else(|| wrong("truth", found, finite), Ok)
    }

    /// A sine over its base line, which is the x axis unless the file says otherwise.
    fn sine(&self, [height, length, phase]: [f64; 3]) -> Result<Sine> {
        let is_one = (0.0..=FURTHEST).contains(&height)
            && (1e-3..=FURTHEST).contains(&length)
            && phase.abs() <= FURTHEST;
        if !is_one {
            let expected = "[height, length, phase]: metres from 0, metres from 0.001, and radians";
            return wrong("truth.sine", format!("[{height}, {length}, {phase}]"), expected);
        }
        let base = if self.line.is_some() {
            self.line()?
        } else {
            let [slope, intercept] = [self.slope, self.intercept].map(Option::unwrap_or_default);
            Self { slope: Some(slope), intercept: Some(intercept), ..Self::default() }.line()?
        };
        Ok(Sine { base, height, length, phase })
    }
}

/// The rings of all polygons of a file in the metres of the area.
fn metres(path: &Path, name: &str) -> Result<Vec<Way>> {
    let rings = lake::read_polygons(path, name, false)?.concat();
    let rings: Vec<Way> =
        rings.into_iter().map(|it| it.into_iter().map(Point2::from).collect()).collect();
    let is_far = |at: &&Point2<f64>| !(at.x.abs() <= FURTHEST && at.y.abs() <= FURTHEST);
    match rings.iter().flatten().find(is_far) {
        Some(at) => {
            bail!("{name}: found the position ({}, {}), expected metres, up to 1e6", at.x, at.y)
        }
        None => Ok(rings),
    }
}

fn circle([x, z]: [f64; 2], radius: f64) -> Result<Circle> {
    if !(x.abs() <= FURTHEST && z.abs() <= FURTHEST && radius > 0.0 && radius <= FURTHEST) {
        let expected = "[x, z, radius] in metres, up to 1e6, with a radius above 0";
        return wrong("truth.circle", format!("[{x}, {z}, {radius}]"), expected);
    }
    Ok(Circle { middle: Point2::new(x, z), radius })
}

fn coast(record: CoastRecord, [min, max]: [Point2<f64>; 2]) -> Result<Polyline> {
    let CoastRecord { height, length, .. } = record;
    let half = 0.75 * (max - min).norm();
    for (name, value) in [("height", height), ("length", length)] {
        if !(value > 0.0 && value <= FURTHEST) {
            return wrong(&format!("truth.coast.{name}"), value, "metres, above 0 and up to 1e6");
        }
    }
    if half / length > MOST_LENGTHS {
        let least = half / MOST_LENGTHS;
        return wrong("truth.coast.length", length, format!("{least:.3} m at least in this area"));
    }
    let coast = Polyline::coast(record, nalgebra::center(&min, &max), half);
    coast.map_or_else(|| wrong("truth.coast", "none", "a coast"), Ok)
}

/// Points of a boundary, so many at least.
fn places(field: &str, points: &[Numbers<2>], fewest: usize) -> Result<Way> {
    if points.len() < fewest {
        return wrong(field, format!("{} points", points.len()), format!("{fewest} at least"));
    }
    let place = |(i, Numbers([x, z])): (usize, &Numbers<2>)| {
        if x.abs() <= FURTHEST && z.abs() <= FURTHEST {
            return Ok(Point2::new(*x, *z));
        }
        wrong(&format!("{field}[{i}]"), format!("[{x}, {z}]"), "metres, up to 1e6")
    };
    points.iter().enumerate().map(place).collect()
}

fn polyline(points: &[Numbers<2>]) -> Result<Polyline> {
    const FIELD: &str = "truth.polyline";
    let places = places(FIELD, points, 2)?;
    for (i, pair) in places.windows(2).enumerate() {
        let [before, at] = [pair[0], pair[1]];
        if at.x <= before.x {
            let expected = format!("an x above that of the point before, {}", before.x);
            return wrong(
                &format!("{FIELD}[{}]", i + 1),
                format!("[{}, {}]", at.x, at.y),
                expected,
            );
        }
    }
    Polyline::through(places).map_or_else(|| wrong(FIELD, "these", "points from left to right"), Ok)
}
