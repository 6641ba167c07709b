//! What following a front came to, in words.

use std::fmt::Write as _;

use crate::mission::front::FrontTable;
use crate::mission::map::{LostRecord, MapRecord, OffRecord, State};
use crate::mission::results::StepResult;
use crate::report::table::{Cells, Column};

/// Bends of less than so many radii of its turning circle are too tight for a car: its map is off, and has gaps.
const LEAST: f64 = 3.0;

/// What the planner is told of the front, and what a car with a turning circle of this radius can follow.
pub(crate) fn told(&FrontTable { speed, watch, .. }: &FrontTable, circle: Option<f64>) -> String {
    let moves = if speed > 0.0 {
        format!("moves by up to {speed} m a step")
    } else {
        "does not move".to_owned()
    };
    let watches = watch.map_or(String::new(), |metres| format!(" It watches {metres} m of it."));
    let follows = circle.map_or(String::new(), |it| {
        format!(" A car that turns in {it} m follows bends of {:.0} m and more.", LEAST * it)
    });
    format!(
        "The planner is told that the front {moves}, and nothing of how it bends.{watches}{follows}"
    )
}

/// What is known of the front after each step: where it was known best, and within how much it lies there.
pub(crate) const KNOWN: [Cells<'static, StepResult>; 4] = [
    (Column::left("front at m", 18).apart(), &|it| {
        it.front.map_or("not known".into(), |it| format!("({:.2}, {:.2})", it.x, it.z))
    }),
    (Column::right("within m", 8), &|it| {
        it.front.map_or(String::new(), |it| format!("{:.2}", it.half_width))
    }),
    (Column::right("deg", 7), &|it| {
        it.front.map_or(String::new(), |it| format!("{:.1}", it.heading.to_degrees()))
    }),
    (Column::right("bits", 5), &|it| format!("{:.2}", it.bits)),
];

/// What an alarm says of a front, where it says of a line that none explains the labels.
pub(crate) const BENDS_MORE: &str = "labels do not follow the front: it turns sharply or moves faster than was told, or the \
                                     sensor reads at random";

/// Gaps are told if they come to more than this share of the map. Places of a map lie a metre or two apart.
const UNMAPPED: f64 = 0.03;

/// The map in words: sentences, a line each. `unit` is what the record numbers.
pub(crate) fn map(record: &MapRecord, unit: &str) -> String {
    let &MapRecord { state, found, lost, vertices, metres, driven, half_width, off, .. } = record;
    let Some(found) = found else {
        return "The front was not found.\n".to_owned();
    };
    let mut text = match (state, lost) {
        (State::Closed, _) if record.closed > 1 => {
            format!(
                "The first front was found at {unit} {found}, and the robot went all round {} of them.\n",
                record.closed
            )
        }
        (State::Closed, _) if has_gaps(record) => {
            format!(
                "The front is closed: it was found at {unit} {found}, and the robot came back there.\n"
            )
        }
        (State::Closed, _) => {
            format!(
                "The front is closed: it was found at {unit} {found}, and the robot went all round it.\n"
            )
        }
        (_, Some(LostRecord { step, x, z })) => format!(
            "The front was found at {unit} {found}, and is lost since {unit} {step}. It was last at ({x:.2}, {z:.2}).\n"
        ),
        _ => format!("The front was found at {unit} {found}, and is known in the end.\n"),
    };
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}; {driven:.1} m were driven for it.", extent(vertices, metres));
    if has_gaps(record) {
        let MapRecord { pieces, gaps, .. } = record;
        let _ = match pieces {
            1 => writeln!(text, "Between its ends {:.0} m are not mapped.", gaps.ceil()),
            _ => writeln!(
                text,
                "It has {pieces} pieces: {:.0} m between them are not mapped.",
                gaps.ceil()
            ),
        };
    }
    text.extend(half_width.map(within));
    if let Some(OffRecord { median, most, covered }) = off {
        let percent = 100.0 * covered;
        let _ = writeln!(
            text,
            "In truth it was {median:.2} m off when it was mapped (median), 95 % within {most:.2} m; the stated widths hold \
             for {percent:.0} %."
        );
    }
    text
}

/// Whether a part of the front that is worth a word is not mapped.
pub(crate) fn has_gaps(record: &MapRecord) -> bool {
    record.gaps > UNMAPPED * record.metres
}

/// How far a map goes, at the beginning of a sentence.
pub(crate) fn extent(vertices: usize, metres: f64) -> String {
    let places = if vertices == 1 { "place" } else { "places" };
    format!("The map has {vertices} {places} along {metres:.1} m of front")
}

/// How near the front is to the places of a map: a sentence.
pub(crate) fn within([median, most]: [f64; 2]) -> String {
    format!(
        "With probability 0.9 the front lies within {median:.2} m of such a place (median; {most:.2} m at most).\n"
    )
}

/// What to change if a front was not found, or is lost.
pub(crate) fn remedy(record: &MapRecord) -> Option<&'static str> {
    match record.state {
        State::Lost => Some(
            "A front is lost if it turns sharply, or moves faster than was told. Shorter motions or a higher front.speed \
             may keep it.",
        ),
        State::Sought => Some(
            "To find it, allow more steps, say a smaller seek.patch, or give points of both labels.",
        ),
        State::Followed | State::Closed => None,
    }
}
