//! The maps of several robots on one front, read from their files and joined.

use std::path::Path;

use anyhow::{Result, anyhow, bail};
use nalgebra::Point2;
use serde::Serialize;

use crate::mission::front::VertexRecord;
use crate::mission::join::{self, Joined, Place};
use crate::mission::map::State;
use crate::replay::crs::Crs;
use crate::replay::frame::{Frame, check_degrees};
use crate::replay::front_record::MappedRecord;
use crate::replay::map_file::MapFile;
use crate::replay::rows::Layout;
use crate::report::pieces::Pieces;

/// Maps of one front, and what they are together.
pub struct JoinedMap {
    pub(crate) files: Vec<MapFile>,
    pub(crate) frame: Frame,
    pub(crate) joined: Joined,
    pub(crate) pieces: Pieces,
    /// The step at which the robots had closed the map, if their numbers are steps.
    pub(crate) met: Option<usize>,
}

impl JoinedMap {
    /// Reads map files and joins them.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub fn read(paths: &[impl AsRef<Path>], crs: Option<&Crs>) -> Result<Self> {
        let files =
            paths.iter().map(|it| MapFile::read(it.as_ref())).collect::<Result<Vec<_>>>()?;
        let [first, others @ ..] = &files[..] else { bail!("found no map, expected two") };
        if let Some(other) = others.iter().find(|it| it.kind() != first.kind()) {
            let [name, found, expected] = [&other.name, other.kind(), first.kind()];
            bail!("{name}: found {found}, expected {expected}, as {} has them", first.name);
        }
        if let (Some(crs), true) = (crs, first.is_geographic) {
            let name = &first.name;
            bail!("--crs {crs}: found latitude and longitude in {name}, expected metres");
        }
        for file in files.iter().filter(|it| it.is_geographic) {
            for row in &file.rows {
                check_degrees(row.position)
                    .map_err(|error| anyhow!("{}:{}: {error}", file.name, row.line))?;
            }
        }
        let positions: Vec<_> =
            files.iter().flat_map(|it| &it.rows).map(|it| it.position).collect();
        let layout = Layout { crs: crs.cloned(), ..Layout::default() };
        let frame = Frame::of(&positions, first.is_geographic, &layout)?;
        let robots = files.iter().map(|it| in_frame(it, &frame)).collect::<Result<Vec<_>>>()?;
        let joined = Joined::of(&robots);
        let are_steps = files.iter().all(|it| it.numbers == "step" && !it.is_joined);
        let met = are_steps.then(|| Joined::closes_at(&robots)).flatten();
        let numbered =
            |piece: &Vec<Place>| piece.iter().map(|it| (it.number, it.vertex)).collect::<Vec<_>>();
        let pieces = joined.pieces.iter().map(numbered).collect::<Vec<_>>().into();
        Ok(Self { files, frame, joined, pieces, met })
    }

    /// All vertices in their order.
    pub(crate) fn places(&self) -> impl Iterator<Item = &Place> {
        self.joined.pieces.iter().flatten()
    }

    /// What numbers the vertices.
    pub(crate) fn numbers(&self) -> &'static str {
        if self.files.iter().all(|it| it.numbers == "step") { "step" } else { "row" }
    }

    /// How many vertices of a robot are in the joined map.
    pub(crate) fn kept(&self, robot: usize) -> usize {
        self.places().filter(|it| it.robot == robot).count()
    }

    /// The half-widths: their median and the most, metres.
    pub(crate) fn half_width(&self) -> [f64; 2] {
        let mut sorted: Vec<_> = self.places().map(|it| it.vertex.half_width).collect();
        sorted.sort_by(f64::total_cmp);
        [sorted.len() / 2, sorted.len().saturating_sub(1)]
            .map(|k| sorted.get(k).copied().unwrap_or(0.0))
    }

    /// The joined map as a file of vertices. Its last column says whose each is.
    ///
    /// # Errors
    /// When a row could not be written.
    pub fn csv(&self) -> Result<String> {
        let titles = if self.frame.is_geographic() { ["lat", "lon"] } else { ["file_x", "file_z"] };
        let recorded = |it: &VertexRecord| self.frame.recorded(it.at());
        let robots: Vec<_> = self.places().map(|it| it.robot).collect();
        let own = self.frame.origin().map(|_| (titles, &recorded as _));
        self.pieces.csv_of(self.numbers(), own, &robots)
    }

    /// The joined map as a record.
    pub fn record(&self) -> JoinedRecord {
        let map = |(robot, file): (usize, &MapFile)| RobotRecord {
            name: file.name.clone(),
            numbers: file.numbers,
            vertices: file.rows.len(),
            kept: self.kept(robot),
        };
        let vertices = self.pieces.vertices().zip(self.places());
        let vertices = vertices.map(|((piece, number, vertex), place)| MappedRecord {
            number,
            piece,
            vertex: *vertex,
            in_file: self.frame.origin().map(|_| self.frame.recorded(vertex.at())),
            robot: Some(place.robot),
        });
        JoinedRecord {
            robots: (1..).zip(&self.files).map(map).collect(),
            map: WholeRecord {
                state: if self.joined.is_closed { State::Closed } else { State::Followed },
                met: self.met,
                pieces: self.joined.pieces.len(),
                vertices: self.places().count(),
                metres: self.joined.metres(),
                half_width: self.half_width(),
            },
            origin: self.frame.origin(),
            crs: self.frame.crs().map(ToString::to_string),
            vertices: vertices.collect(),
        }
    }
}

/// The pieces of a map about the origin of all.
fn in_frame(file: &MapFile, frame: &Frame) -> Result<join::Pieces> {
    let (mut pieces, mut last) = (join::Pieces::new(), None);
    for row in &file.rows {
        let site = frame.site(row.position);
        let site = site.map_err(|error| anyhow!("{}:{}: {error}", file.name, row.line))?;
        let Point2 { coords: at } = Point2::<f64>::from(site);
        let vertex = VertexRecord { x: at.x, z: at.y, ..row.vertex };
        match pieces.last_mut() {
            Some(piece) if last == Some(row.piece) => piece.push((row.number, vertex)),
            _ => pieces.push(vec![(row.number, vertex)]),
        }
        last = Some(row.piece);
    }
    Ok(pieces)
}

/// A joined map.
#[derive(Serialize)]
pub struct JoinedRecord {
    /// The maps, in the order in which they were named: the first is that of robot 1.
    robots: Vec<RobotRecord>,
    map: WholeRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    origin: Option<[f64; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crs: Option<String>,
    vertices: Vec<MappedRecord>,
}

/// The map of a robot.
#[derive(Serialize)]
struct RobotRecord {
    name: String,
    numbers: &'static str,
    vertices: usize,
    /// Of these, vertices in the joined map.
    kept: usize,
}

/// What the joined map comes to.
#[derive(Serialize)]
struct WholeRecord {
    state: State,
    #[serde(skip_serializing_if = "Option::is_none")]
    met: Option<usize>,
    pieces: usize,
    vertices: usize,
    metres: f64,
    half_width: [f64; 2],
}
