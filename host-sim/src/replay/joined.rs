//! The maps of several robots on one front, read from their files and joined.

use std::path::Path;

use anyhow::{Result, anyhow, bail};
use nalgebra::Point2;
use serde::Serialize;

use crate::mission::front::VertexRecord;
use crate::mission::join::{self, Joined, Place};
use crate::mission::map::{State, median_and_most};
use crate::output::file;
use crate::replay::Report;
use crate::replay::map_file::MapFile;
use crate::replay::placed_map::{PlaceRecord, PlacedMap};
use crate::report::front::{extent, within};
use crate::report::on_map::collection;
use crate::report::pieces::Pieces;
use crate::world::crs::Crs;
use crate::world::frame::{Frame, check_degrees};

/// Maps of one front, and what they are together.
pub struct JoinedMap {
    /// In the order in which they were named: the first is that of robot 1.
    robots: Vec<RobotRecord>,
    map: WholeRecord,
    mapped: PlacedMap,
}

/// A joined map.
#[derive(Serialize)]
struct JoinedRecord<'a> {
    robots: &'a [RobotRecord],
    map: &'a WholeRecord,
    #[serde(flatten)]
    frame: &'a Frame,
    vertices: Vec<PlaceRecord>,
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
    /// The step at which the robots had closed the map, if their numbers are steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    met: Option<usize>,
    pieces: usize,
    vertices: usize,
    metres: f64,
    /// The half-widths: their median and the most, metres.
    half_width: [f64; 2],
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
        if let (Some(crs), true) = (crs, first.is_geographic()) {
            let name = &first.name;
            bail!("--crs {crs}: found latitude and longitude in {name}, expected metres");
        }
        let rows = || files.iter().flat_map(|file| file.rows.iter().map(move |row| (file, row)));
        for (file, row) in rows().filter(|_| first.is_geographic()) {
            check_degrees(row.position)
                .map_err(|error| anyhow!("{}:{}: {error}", file.name, row.line))?;
        }
        let positions: Vec<_> = rows().map(|(_, row)| row.position).collect();
        let frame = Frame::of(&positions, first.is_geographic(), None, crs)?;
        let robots = files.iter().map(|it| in_frame(it, &frame)).collect::<Result<Vec<_>>>()?;
        let joined = Joined::of(&robots);
        let is_of_steps = files.iter().all(|it| it.numbers == "step");
        let met = is_of_steps && !files.iter().any(|it| it.is_joined);
        let met = met.then(|| Joined::closes_at(&robots)).flatten();
        let places: Vec<_> = joined.pieces.iter().flatten().collect();
        let half_width = median_and_most(places.iter().map(|it| it.vertex.half_width), 1.0);
        let map = WholeRecord {
            state: if joined.is_closed { State::Closed } else { State::Followed },
            met,
            pieces: joined.pieces.len(),
            vertices: places.len(),
            metres: joined.metres(),
            half_width: half_width.unwrap_or_default(),
        };
        let robot = |(robot, file): (usize, &MapFile)| RobotRecord {
            name: file.name.clone(),
            numbers: file.numbers,
            vertices: file.rows.len(),
            kept: places.iter().filter(|it| it.robot == robot).count(),
        };
        let numbered = |it: &Vec<Place>| it.iter().map(|it| (it.number, it.vertex)).collect();
        let mapped = PlacedMap {
            frame,
            numbers: if is_of_steps { "step" } else { "row" },
            pieces: Pieces(joined.pieces.iter().map(numbered).collect()),
            robots: places.iter().map(|it| it.robot).collect(),
            is_round: joined.is_closed,
        };
        Ok(Self { robots: (1..).zip(&files).map(robot).collect(), map, mapped })
    }
}

impl Report for JoinedMap {
    fn words(&self) -> String {
        let &WholeRecord { state, met, vertices, metres, half_width, .. } = &self.map;
        let mut text = format!("{} maps of one front, joined.\n", self.robots.len());
        let robot = |(robot, it): (usize, &RobotRecord)| {
            let RobotRecord { name, vertices, kept, .. } = it;
            let places = if *vertices == 1 { "place" } else { "places" };
            format!("Robot {robot}, {name}: {kept} of {vertices} {places} are kept.\n")
        };
        text.extend((1..).zip(&self.robots).map(robot));
        text.extend((state == State::Closed).then(|| {
            let from = met.map_or(String::new(), |step| format!(", from step {step} on"));
            format!("The front is closed: the maps together go all round it{from}.\n")
        }));
        text + &extent(vertices, metres)
            + ".\n"
            + &within(half_width)
            + &self.mapped.in_words("longest", self.mapped.numbers)
    }

    fn json(&self) -> String {
        let Self { robots, map, mapped } = self;
        let (frame, vertices) = (&mapped.frame, mapped.vertices());
        file::json(&JoinedRecord { robots, map, frame, vertices })
    }

    /// Of very many vertices it shows some.
    fn figure(&self) -> Result<String> {
        let (metres, count) = (self.map.metres, self.robots.len());
        let what = if self.map.state == State::Closed { "A closed front" } else { "A front" };
        let names: Vec<_> = self.robots.iter().map(|it| it.name.clone()).collect();
        let note = format!("{what}: {metres:.0} m mapped by {count} robots");
        Ok(self.mapped.picture(&names.join(", "), note, Vec::new())?.svg())
    }

    fn geojson(&self) -> Result<String> {
        let PlacedMap { frame, pieces, .. } = &self.mapped;
        frame.check_globe((&self.robots[0].name, ""), pieces.ways().flatten())?;
        Ok(collection(self.mapped.features(|_| None)?))
    }

    fn csv(&self) -> Result<String> {
        self.mapped.csv()
    }

    /// Why the map is in pieces, if it is.
    fn warning(&self) -> Option<String> {
        let pieces = self.map.pieces;
        (pieces > 1).then(|| {
            format!(
                "the joined map has {pieces} pieces. Maps are joined where their ends are no further apart than three \
                 usual steps"
            )
        })
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
