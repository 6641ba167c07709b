//! Ground of any shape from a map: polygons of a `GeoJSON` file, and the cells that lie wholly in them.
//!
//! Positions of the file are in latitude and longitude, or in metres of a system that the scenario names. A
//! [`Frame`] brings them to the lattice, about the middle of the polygons.
//!
//! A cell is open if no side of a polygon meets it and its middle lies inside. Of the open cells the largest connected piece is
//! kept: what lies apart from it no robot reaches. How much of the ground is lost to both is told.

use std::mem;
use std::path::Path;

use anyhow::{Result, anyhow, bail};
use geojson::{Feature, GeometryValue, Position};
use nalgebra::Point2;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::{Area, Chart, Site};
use serde_json::{Number, Value, json};

use crate::output::kind;
use crate::world::crs::Crs;
use crate::world::extent::around;
use crate::world::files;
use crate::world::frame::Frame;

/// Cells along the longer side of the ground, unless the scenario says another number.
pub(crate) const USUAL: u16 = 256;

/// A ring of a polygon, without its first corner again at the end; metres on the lattice.
type Ring = Vec<Point2<f64>>;

/// Ground of any shape.
#[derive(Debug)]
pub struct Lake {
    /// The file.
    pub name: String,
    /// Where its positions lie on the lattice.
    pub frame: Frame,
    /// Its polygons, each with the rings around it and its holes.
    pub polygons: Vec<Vec<Ring>>,
    /// What of it is open.
    pub chart: Chart<'static>,
    /// The ground, square metres.
    pub ground: f64,
    /// What of it lies on closed cells, and what on open ones apart from the others; shares.
    pub lost: [f64; 2],
}

impl Lake {
    /// The ground of a file, in so many cells along its longer side.
    ///
    /// # Errors
    /// Names the file, what was found and what was expected.
    pub(crate) fn read(path: &Path, name: &str, crs: Option<&Crs>, cells: u16) -> Result<Self> {
        let found = read_polygons(path, name, crs.is_none())?;
        let all: Vec<_> = found.iter().flatten().flatten().copied().collect();
        let is_geographic = crs.is_none();
        let frame = Frame::of(&all, is_geographic, None, crs)
            .map_err(|error| anyhow!("{name}: {error}"))?;
        let rings = |rings: &Vec<Vec<_>>| placed(&frame, rings);
        let polygons = found.iter().map(rings).collect::<Result<Vec<_>>>();
        let polygons = polygons.map_err(|error| anyhow!("{name}: {error}"))?;
        let (chart, lost, ground) =
            charted(&polygons, cells).map_err(|error| anyhow!("{name}: {error}"))?;
        Ok(Self { name: name.to_owned(), frame, polygons, chart, ground, lost })
    }

    /// The rings of all polygons of another file for the same map.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub(crate) fn rings_of(&self, path: &Path, name: &str) -> Result<Vec<Ring>> {
        let polygons = read_polygons(path, name, self.frame.is_geographic())?;
        placed(&self.frame, &polygons.concat()).map_err(|error| anyhow!("{name}: {error}"))
    }

    /// What it is, in words: a line.
    pub fn words(&self) -> String {
        let ([columns, rows], side) = (self.chart.size(), metres(self.chart.side()));
        let [edge, apart] = self.lost.map(|it| 100.0 * it);
        let apart = if apart < 0.05 { String::new() } else { format!(", {apart:.1} % lies apart") };
        format!(
            "{}: {:.3} km2 in {columns} x {rows} cells of {side:.2} m; {edge:.1} % is lost along the shore{apart}",
            self.name,
            self.ground / 1e6
        )
    }

    /// The rectangle around it.
    pub fn bounds(&self) -> Area {
        self.chart.bounds()
    }
}

/// Rings on the lattice.
fn placed(frame: &Frame, rings: &[Vec<[f64; 2]>]) -> Result<Vec<Ring>> {
    let place = |at: &[f64; 2]| Ok(Point2::from(frame.site(*at)?));
    rings.iter().map(|ring| ring.iter().map(place).collect()).collect()
}

/// The polygons of a file, by the positions of their rings: latitude and longitude, or x and z.
///
/// # Errors
/// Names the file, what was found and what was expected.
pub(crate) fn read_polygons(
    path: &Path,
    name: &str,
    is_geographic: bool,
) -> Result<Vec<Vec<Vec<[f64; 2]>>>> {
    let text = files::read(path).map_err(|error| {
        let expected = "the name of one, beside the scenario";
        anyhow!("found {} as {name}, expected {expected}", kind::unread(&error))
    })?;
    polygons(name, &text, is_geographic)
}

fn metres(units: u32) -> f64 {
    f64::from(units) / f64::from(UNITS_PER_METRE)
}

fn polygons(name: &str, text: &[u8], is_geographic: bool) -> Result<Vec<Vec<Vec<[f64; 2]>>>> {
    let mut file: Value = serde_json::from_slice(text)
        .map_err(|error| anyhow!("{name}:{}: expected GeoJSON: {error}", error.line()))?;
    plain(&mut file);
    let features = match file["type"].as_str() {
        Some("FeatureCollection") => mem::take(&mut file["features"]),
        Some("Feature") => json!([file]),
        _ => json!([{ "type": "Feature", "geometry": file, "properties": {} }]),
    };
    let features: Vec<Feature> = serde_json::from_value(features)
        .map_err(|error| anyhow!("{name}: expected GeoJSON: {error}"))?;
    let mut found = Vec::new();
    let mut others = None;
    for feature in features {
        match feature.geometry.map(|it| it.value) {
            Some(GeometryValue::Polygon { coordinates }) => found.push(coordinates),
            Some(GeometryValue::MultiPolygon { coordinates }) => found.extend(coordinates),
            Some(other) => others = Some(format!("a {}", other.type_name())),
            None => others = Some("a feature without geometry".to_owned()),
        }
    }
    if found.is_empty() {
        let found = others.unwrap_or_else(|| "no feature".to_owned());
        bail!("{name}: found {found}, expected a Polygon or MultiPolygon");
    }
    let position = |at: &Position| match at.as_slice() {
        [x, z, ..] if x.is_finite() && z.is_finite() => {
            Ok(if is_geographic { [*z, *x] } else { [*x, *z] })
        }
        other => bail!("{name}: found the position {other:?}, expected two numbers"),
    };
    let ring = |ring: &Vec<Position>| {
        let mut ring = ring.iter().map(position).collect::<Result<Vec<_>>>()?;
        // Files repeat the first corner at the end, and some repeat others.
        ring.dedup();
        if ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        if ring.len() < 3 {
            bail!("{name}: found a ring of {} corners, expected three at least", ring.len());
        }
        Ok(ring)
    };
    found.iter().map(|rings| rings.iter().map(ring).collect()).collect()
}

/// Numbers as the program has them. Where serde keeps all digits of a file, it does not give `24.90` as a number.
fn plain(value: &mut Value) {
    match value {
        Value::Number(number) => {
            if let Some(same) = number.as_f64().and_then(Number::from_f64) {
                *number = same;
            }
        }
        Value::Array(all) => all.iter_mut().for_each(plain),
        Value::Object(all) => all.values_mut().for_each(plain),
        _ => {}
    }
}

/// The cells of polygons, what is lost by them, and all of the ground, square metres.
fn charted(polygons: &[Vec<Ring>], cells: u16) -> Result<(Chart<'static>, [f64; 2], f64)> {
    let all = polygons.iter().flatten().flatten().copied();
    let Some([min, max]) = around(all) else { bail!("found no corner, expected a polygon") };
    let longer = (max - min).max();
    // A row and a column are spare, as the corner is rounded.
    let side = (longer * f64::from(UNITS_PER_METRE) / f64::from(cells - 1)).ceil() as u32;
    let side = side.max(1);
    let size = [max.x - min.x, max.y - min.y]
        .map(|it| ((it / metres(side)).floor() as u16 + 1).clamp(1, Chart::MOST_CELLS));
    let corner = Site::try_from(min)?;
    let grid = Grid { from: Point2::from(corner), side: metres(side), size };
    let inside: Vec<bool> = polygons.iter().fold(vec![false; grid.len()], |open, rings| {
        open.iter().zip(grid.inside(rings)).map(|(a, b)| *a || b).collect()
    });
    let kept = grid.largest_piece(&inside);
    let count = |cells: &[bool]| cells.iter().filter(|it| **it).count() as f64;
    let ground: f64 = polygons.iter().map(|rings| area(rings)).sum();
    let cell = grid.side * grid.side;
    if count(&kept) == 0.0 {
        bail!(
            "found no cell of {:.2} m that lies wholly inside, expected ground with room for one, or more `cells`",
            grid.side
        );
    }
    let lost = [ground - count(&inside) * cell, (count(&inside) - count(&kept)) * cell];
    let words = Chart::words_in(size[0]);
    let mut bits = vec![0_u32; words * usize::from(size[1])];
    for (row, open) in kept.chunks(size[0].into()).enumerate() {
        for (column, _) in open.iter().enumerate().filter(|(_, open)| **open) {
            bits[row * words + column / 32] |= 1 << (column % 32);
        }
    }
    // A program reads one scenario, and its chart lasts as long.
    let chart = Chart::new(corner, side, size, Vec::leak(bits))?;
    Ok((chart, lost.map(|it| (it / ground).max(0.0)), ground))
}

/// The area of a polygon without its holes.
fn area(rings: &[Ring]) -> f64 {
    let of = |ring: &Ring| {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(p, q)| p.coords.perp(&q.coords)).sum::<f64>().abs() / 2.0
    };
    let [border, holes @ ..] = rings else { return 0.0 };
    of(border) - holes.iter().map(of).sum::<f64>()
}

/// Sides are somewhat wider than they are, cells, so that rounding closes a cell rather than opens one.
const DUST: f64 = 1e-6;

/// Cells by rows, from the least coordinates on.
struct Grid {
    from: Point2<f64>,
    side: f64,
    size: [u16; 2],
}

impl Grid {
    fn len(&self) -> usize {
        self.size.map(usize::from).iter().product()
    }

    /// Which cells lie wholly inside a polygon: no side meets them, and as many sides lie left of their middle as make it odd.
    fn inside(&self, rings: &[Ring]) -> Vec<bool> {
        let [columns, rows] = self.size.map(usize::from);
        let (mut met, mut odd) = (vec![false; self.len()], vec![false; self.len()]);
        let sides = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        for (p, q) in sides {
            let [p, q] = [p, q].map(|at| (at - self.from) / self.side);
            let (low, high) = if p.y <= q.y { (p, q) } else { (q, p) };
            let at = |z: f64| {
                let part = if high.y > low.y { (z - low.y) / (high.y - low.y) } else { 0.0 };
                low.x + part * (high.x - low.x)
            };
            let clamp = |it: f64, count: usize| (it.floor().max(0.0) as usize).min(count - 1);
            for row in clamp(low.y - DUST, rows)..=clamp(high.y + DUST, rows) {
                let z = row as f64;
                let ends = if high.y > low.y {
                    [at((z - DUST).max(low.y)), at((z + 1.0 + DUST).min(high.y))]
                } else {
                    [low.x, high.x]
                };
                let [left, right] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                for column in clamp(left - DUST, columns)..=clamp(right + DUST, columns) {
                    met[row * columns + column] = true;
                }
                let middle = z + 0.5;
                if low.y <= middle && middle < high.y {
                    let crossing = at(middle);
                    for column in 0..columns {
                        odd[row * columns + column] ^= column as f64 + 0.5 > crossing;
                    }
                }
            }
        }
        met.into_iter().zip(odd).map(|(met, odd)| odd && !met).collect()
    }

    /// The cells of the largest piece, whose cells are connected along their sides.
    fn largest_piece(&self, open: &[bool]) -> Vec<bool> {
        let [columns, rows] = self.size.map(usize::from);
        let mut piece = vec![0_usize; open.len()];
        let mut sizes = vec![0_usize];
        for first in 0..open.len() {
            if !open[first] || piece[first] != 0 {
                continue;
            }
            let number = sizes.len();
            sizes.push(0);
            let mut ahead = vec![first];
            piece[first] = number;
            while let Some(cell) = ahead.pop() {
                sizes[number] += 1;
                let (column, row) = (cell % columns, cell / columns);
                let beside = [
                    (column > 0).then(|| cell - 1),
                    (column + 1 < columns).then(|| cell + 1),
                    (row > 0).then(|| cell - columns),
                    (row + 1 < rows).then(|| cell + columns),
                ];
                for next in beside.into_iter().flatten().filter(|it| open[*it]) {
                    if piece[next] == 0 {
                        piece[next] = number;
                        ahead.push(next);
                    }
                }
            }
        }
        let largest = (1..sizes.len()).max_by_key(|it| sizes[*it]).unwrap_or(usize::MAX);
        piece.into_iter().map(|it| it == largest).collect()
    }
}
