//! The front along a recorded track, in words.

use std::fmt::Write as _;

use nalgebra::Point2;

use crate::mission::map::State;
use crate::mission::results::PTold;
use crate::replay::front_map::FrontMap;
use crate::report::front;

/// Pieces of the map, and alarms, that are named in words; the record has all.
const MOST_NAMED: usize = 20;

impl FrontMap {
    /// What the track maps, in words.
    pub fn report(&self) -> String {
        let (file, unit) = (&self.file, self.unit());
        let skipped = file.skipped_in_words() + &file.odd_in_words();
        let about = file.about();
        let mut text =
            format!("{}: {}.\n{skipped}{about}{}\n", file.name, self.headline(), self.told());
        // Writing to a string cannot fail.
        if let Some(says) = self.one_label_in_words() {
            let _ = writeln!(text, "{says}");
        } else {
            text += &front::map(&self.map, unit);
            text += &self.end_in_words();
        }
        let pieces = &self.pieces.0;
        if pieces.len() > 1 {
            let count = pieces.len();
            let more = if count > MOST_NAMED { ", the first of which are" } else { "" };
            let _ = writeln!(text, "It has {count} pieces{more}:");
        }
        for piece in pieces.iter().take(MOST_NAMED).filter(|_| pieces.len() > 1) {
            if let ([(first, from), ..], [.., (last, to)]) = (&piece[..], &piece[..]) {
                let ends = [from, to].map(|it| format!("({:.2}, {:.2})", it.x, it.z));
                let [from, to] = ends;
                let _ = writeln!(text, "  {unit}s {first} to {last}: from {from} to {to}");
            }
        }
        let named: Vec<_> = self.alarms.iter().take(MOST_NAMED).map(ToString::to_string).collect();
        if !named.is_empty() {
            let s = if named.len() == 1 { "" } else { "s" };
            let more = if self.alarms.len() > MOST_NAMED { " and others" } else { "" };
            let _ = writeln!(
                text,
                "At {unit}{s} {}{more} the labels contradicted what was known, and the front was sought anew nearby.",
                named.join(", ")
            );
        }
        text
    }

    /// Why the map is not to be relied on, and what to change, if the front is not known in the end.
    pub fn warning(&self) -> Option<String> {
        if let Some(says) = self.one_label_in_words() {
            return Some(says);
        }
        let unit = self.unit();
        match (self.map.state, self.map.lost) {
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

    /// What numbers the rows of the track.
    fn unit(&self) -> &'static str {
        if self.is_of_trace() { "step" } else { self.file.unit.name() }
    }

    fn headline(&self) -> String {
        let count = self.file.samples.len();
        let p = match self.p {
            PTold::Number(p) if p < 1.0 => format!(", each label true with probability {p}"),
            PTold::Number(_) => String::new(),
            PTold::Beta([a, b]) => format!(", labels as reliable as Beta({a}, {b}) says"),
        };
        let off = self.tolerance;
        let within =
            if off > 0.0 { format!(", each position within {off} m") } else { String::new() };
        format!("{count} samples along a track{p}{within}")
    }

    fn told(&self) -> String {
        let is = if self.front.radius().is_some() { "may bend" } else { "is straight" };
        let moves = match self.front.speed() {
            speed if speed > 0.0 => format!("moves by up to {speed} m a {}", self.number()),
            _ => "does not move".to_owned(),
        };
        let width = self.width;
        format!(
            "Told: the front {is}, and {moves}. It counts as found where its half-width is below {width:.2} m.\n"
        )
    }

    /// Where the map ends, and how far from the end of the track: a line, if it has vertices.
    fn end_in_words(&self) -> String {
        let (last, end) = (self.pieces.vertices().last(), self.file.samples.last());
        let (Some((_, _, last)), Some(end)) = (last, end) else { return String::new() };
        let off = (last.at() - Point2::<f64>::from(end.site)).norm();
        format!(
            "It ends at ({:.2}, {:.2}), {off:.1} m from the end of the track.\n",
            last.x, last.z
        )
    }

    fn one_label_in_words(&self) -> Option<String> {
        let label = self.one_label?.sign();
        Some(format!("The ground has one label, {label:+}: no front was found."))
    }
}
