//! The joined map in words.

use std::fmt::Write as _;

use crate::replay::joined_map::JoinedMap;

/// Pieces that are named in words; the record has all.
const MOST_NAMED: usize = 20;

impl JoinedMap {
    /// What the maps are together, in words.
    pub fn report(&self) -> String {
        let (count, metres) = (self.places().count(), self.joined.metres());
        let mut text = format!("{} maps of one front, joined.\n", self.files.len());
        // Writing to a string cannot fail.
        for (robot, file) in (1..).zip(&self.files) {
            let (name, all, kept) = (&file.name, file.rows.len(), self.kept(robot));
            let places = if all == 1 { "place" } else { "places" };
            let _ = writeln!(text, "Robot {robot}, {name}: {kept} of {all} {places} are kept.");
        }
        if self.joined.is_closed {
            text += "The front is closed: the maps together go all round it";
            text += &self.met.map_or(String::new(), |step| format!(", from step {step} on"));
            text += ".\n";
        }
        let places = if count == 1 { "place" } else { "places" };
        let _ = writeln!(text, "The map has {count} {places} along {metres:.1} m of front.");
        let [median, most] = self.half_width();
        let _ = writeln!(
            text,
            "With probability 0.9 the front lies within {median:.2} m of such a place (median; {most:.2} m at most)."
        );
        let pieces = &self.joined.pieces;
        if pieces.len() > 1 {
            let count = pieces.len();
            let more = if count > MOST_NAMED { ", the longest of which are" } else { "" };
            let _ = writeln!(text, "It has {count} pieces{more}:");
        }
        for piece in pieces.iter().take(MOST_NAMED) {
            if let ([from, ..], [.., to]) = (&piece[..], &piece[..]) {
                let [from, to] = [from, to].map(|it| {
                    let (robot, at) = (it.robot, it.vertex);
                    format!("({:.2}, {:.2}) of robot {robot}", at.x, at.z)
                });
                let _ = writeln!(text, "  from {from} to {to}");
            }
        }
        text
    }

    /// Why the map is in pieces, if it is.
    pub fn warning(&self) -> Option<String> {
        let pieces = self.joined.pieces.len();
        (pieces > 1).then(|| {
            format!(
                "the joined map has {pieces} pieces. Maps are joined where their ends are no further apart than three \
                 usual steps"
            )
        })
    }
}
