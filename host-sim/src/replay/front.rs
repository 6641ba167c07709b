//! The map of a front along a recorded track.
//!
//! A follower takes in row after row, as in a mission in which another drives. The places that it has passed come on the
//! map.

use std::path::Path;

use anyhow::Result;
use nalgebra::Point2;
use planner_core::{Front, Label, Sample};
use serde::Serialize;

use crate::mission::front::{FrontTable, PassedRecord};
use crate::mission::map::{self, MapRecord, State, pieces};
use crate::mission::read_out::rest;
use crate::mission::results::PTold;
use crate::output::file;
use crate::output::notes::progress;
use crate::replay::answer::Trust;
use crate::replay::placed_map::{PlaceRecord, PlacedMap};
use crate::replay::rows::{Layout, Skipped};
use crate::replay::sample_file::SampleFile;
use crate::replay::track::RecordedTrack;
use crate::replay::{MOST_NAMED, Report};
use crate::report::on_map::collection;
use crate::report::picture::Dot;
use crate::report::pieces::Pieces;
use crate::report::{front, look};
use crate::world::frame::Frame;

/// Rows that are taken in between two looks at the progress.
const ROWS: usize = 1_000;

/// Samples that a figure shows at most, so that they do not hide the front.
const MOST: usize = 150;

/// Samples from a file, and the front that they map.
pub struct FrontMap {
    file: SampleFile,
    facts: Facts,
    mapped: PlacedMap,
}

/// What was told, and what following the front came to.
#[derive(Serialize)]
struct Facts {
    front: FrontTable,
    p: PTold,
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    /// The front counts as found where its half-width is below this, metres.
    found_within: f64,
    /// What its numbers are: `row` (the line of the file, or its feature) or `step`.
    numbers: &'static str,
    map: MapRecord,
    /// The label of all ground, where no front was found and most likely none is there.
    #[serde(skip_serializing_if = "Option::is_none")]
    one_label: Option<i8>,
    /// After which the front was sought anew.
    alarms: Vec<usize>,
}

/// The front along a track.
#[derive(Serialize)]
struct FrontRecord<'a> {
    samples: usize,
    skipped: &'a Skipped,
    #[serde(flatten)]
    facts: &'a Facts,
    #[serde(flatten)]
    frame: &'a Frame,
    vertices: Vec<PlaceRecord>,
}

impl FrontMap {
    /// Reads a file of any length and maps the front along it, as far as its samples are trusted.
    ///
    /// # Errors
    /// Names the file and the line, what was found and what was expected.
    pub fn read(path: &Path, layout: &Layout, front: Front, trust: Trust) -> Result<Self> {
        let file = SampleFile::read(path, layout)?;
        let mut track = RecordedTrack::of(&file, front, trust)?;
        let count = track.rows.len();
        let bar = progress(count as u64, "rows")?;
        let (mut alarms, mut after) = (Vec::new(), Vec::with_capacity(count));
        for k in 0..count {
            let (number, metres) = (track.rows[k].number, track.rows[k].driven);
            if track.take(k)? {
                alarms.push(number);
            }
            let known = &track.known;
            let passed = |it| PassedRecord::of(it, number);
            let vertices = known.curve().mapped().iter().copied().map(passed).collect();
            let is_known = known.is_found();
            after.push(map::Mapped { number, metres, is_known, vertices });
            if k % ROWS == 0 {
                bar.set_position(k as u64);
            }
        }
        bar.finish_and_clear();
        let RecordedTrack { known, width, p, is_closed, .. } = track;
        if let Some(last) = after.last_mut() {
            let passed = |it| PassedRecord::of(it, last.number);
            last.vertices.extend(rest(known.curve()).into_iter().map(passed));
        }
        let map = MapRecord::after(&after, is_closed);
        let one_label = known.one_label().map(|it| it.label).or_else(|| one_label(&file.samples));
        let numbers = if file.rows.mission.is_some() { "step" } else { "row" };
        let facts = Facts {
            front: front.into(),
            p,
            tolerance: Some(trust.tolerance).filter(|it| *it > 0.0),
            found_within: width.into(),
            numbers,
            map,
            one_label: one_label.filter(|_| map.state == State::Sought).map(Label::sign),
            alarms,
        };
        let (frame, pieces) = (file.frame.clone(), Pieces(pieces(&after)));
        let mapped = PlacedMap { frame, numbers, pieces, robots: Vec::new(), is_round: false };
        Ok(Self { file, facts, mapped })
    }

    /// What numbers the rows of the track, in words.
    fn unit(&self) -> &'static str {
        if self.file.rows.mission.is_some() { "step" } else { self.file.unit.name() }
    }

    fn headline(&self) -> String {
        let p = match self.facts.p {
            PTold::Number(p) if p < 1.0 => format!(", each label true with probability {p}"),
            PTold::Number(_) => String::new(),
            PTold::Beta([a, b]) => format!(", labels as reliable as Beta({a}, {b}) says"),
        };
        let within = self.facts.tolerance.map(|off| format!(", each position within {off} m"));
        let count = self.file.samples.len();
        format!("{count} samples along a track{p}{}", within.unwrap_or_default())
    }

    fn told(&self) -> String {
        let Facts { front: FrontTable { radius, speed, .. }, found_within, numbers, .. } =
            &self.facts;
        let is = if radius.is_some() { "may bend" } else { "is straight" };
        let moves = match speed {
            0.0 => "does not move".to_owned(),
            speed => format!("moves by up to {speed} m a {numbers}"),
        };
        format!(
            "Told: the front {is}, and {moves}. It counts as found where its half-width is below {found_within:.2} m.\n\n"
        )
    }

    /// Where the map ends, and how far from the end of the track: a line, if it has vertices.
    fn end_in_words(&self) -> Option<String> {
        let (_, _, last) = self.mapped.pieces.vertices().last()?;
        let off = (last.at() - Point2::<f64>::from(self.file.samples.last()?.site)).norm();
        Some(format!(
            "It ends at ({:.2}, {:.2}), {off:.1} m from the end of the track.\n",
            last.x, last.z
        ))
    }

    fn one_label_in_words(&self) -> Option<String> {
        let label = self.facts.one_label?;
        Some(format!("The ground has one label, {label:+}: no front was found."))
    }

    fn alarms_in_words(&self) -> Option<String> {
        let (unit, alarms) = (self.unit(), &self.facts.alarms);
        let named: Vec<_> = alarms.iter().take(MOST_NAMED).map(ToString::to_string).collect();
        let s = if named.len() == 1 { "" } else { "s" };
        let more = if alarms.len() > MOST_NAMED { " and others" } else { "" };
        (!named.is_empty()).then(|| {
            format!(
                "At {unit}{s} {}{more} the labels contradicted what was known, and the front was sought anew nearby.\n",
                named.join(", ")
            )
        })
    }
}

impl Report for FrontMap {
    fn words(&self) -> String {
        let mut text = self.file.beginning(&self.headline()) + &self.told();
        if let Some(says) = self.one_label_in_words() {
            text += &(says + "\n");
        } else {
            text += &front::map(&self.facts.map, self.unit());
            text.extend(self.end_in_words());
        }
        text += &self.mapped.in_words("first", self.unit());
        text.extend(self.alarms_in_words());
        text
    }

    fn json(&self) -> String {
        file::json(&FrontRecord {
            samples: self.file.samples.len(),
            skipped: &self.file.rows.skipped,
            facts: &self.facts,
            frame: &self.file.frame,
            vertices: self.mapped.vertices(),
        })
    }

    /// Of very many samples and vertices it shows some.
    fn figure(&self) -> Result<String> {
        let samples = &self.file.samples;
        let count = samples.len();
        let every = count.div_ceil(MOST).max(1);
        let sparse =
            if every > 1 { format!("; one label in {every} shown") } else { String::new() };
        let metres = self.facts.map.metres;
        let what = match self.facts.map.state {
            _ if self.facts.one_label.is_some() => "No front: the ground has one label".to_owned(),
            State::Sought => "A front that was not found".to_owned(),
            State::Lost => format!("A front that is lost: {metres:.0} m mapped"),
            State::Closed => format!("A closed front: {metres:.0} m mapped"),
            State::Followed => format!("A front: {metres:.0} m mapped"),
        };
        let note = format!("{what} along a track of {count} labels{sparse}");
        let dots = samples.iter().map(|s| Dot::new(s.site, look::small(s.label))).collect();
        let mut picture = self.mapped.picture(&self.file.name, note, dots)?;
        picture.samples = picture.samples.into_iter().step_by(every).collect();
        Ok(picture.svg())
    }

    fn geojson(&self) -> Result<String> {
        self.file.area_on_globe()?;
        let mut features = self.mapped.features(|number| self.file.time(number))?;
        features.extend(self.file.points(None)?);
        Ok(collection(features))
    }

    fn csv(&self) -> Result<String> {
        self.mapped.csv()
    }

    /// Why the map is not to be relied on, and what to change, if the front is not known in the end.
    fn warning(&self) -> Option<String> {
        let unit = self.unit();
        match (self.facts.map.state, self.facts.map.lost) {
            _ if self.facts.one_label.is_some() => self.one_label_in_words(),
            (State::Lost, Some(lost)) => Some(format!(
                "the front is lost since {unit} {}. If it moves faster than --front says, name a higher speed",
                lost.step
            )),
            (State::Sought, _) => Some(
                "the front was not found. A track finds it if it crosses it several times; a --tolerance or a --p may \
                 be too low for it"
                    .to_owned(),
            ),
            _ => None,
        }
    }
}

/// The label of all samples, if they have one.
fn one_label(samples: &[Sample]) -> Option<Label> {
    let first = samples.first()?.label;
    samples.iter().all(|it| it.label == first).then_some(first)
}
