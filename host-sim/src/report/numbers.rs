//! The numbers of steps, placed beside the steps' ends. Where there is too little space a number is left out. The
//! first, the last and every fifth are always shown: they stand further away, and a thin line leads to them. Many steps have
//! no numbers.

use nalgebra::Vector2;

use crate::report::look::{Look, NUMBER_OF_STEP};
use crate::report::placing::{Placing, foot};
use crate::report::shapes::{NUMBER, Spot, width};
use crate::report::sheet::Sheet;
use crate::report::style::{INK, Stroke};

/// The line from a step to its number, if the number is far away.
const LEADER: Stroke = Stroke { class: "number", colour: INK, width: 0.6, dashes: "1.5 1.5" };

/// The distance of a number from its step, pixels: the least, the greatest without a leader, the greatest.
const AWAY: [f64; 3] = [5.0, 13.0, 120.0];

/// The steps between two numbers that are always shown.
const EVERY: usize = 5;

/// Steps that have numbers, at most.
const MOST: usize = 60;

/// Draws them; steps end at these places.
pub(crate) fn draw(sheet: &mut Sheet, placing: &mut Placing, stops: &[Spot]) {
    let [least, near, most] = AWAY;
    let count = stops.len();
    if count > MOST {
        return;
    }
    let is_kept = |k: usize| k == 1 || k == count || k.is_multiple_of(EVERY);
    let kept = (1..=count).filter(|k| is_kept(*k));
    let others = (1..=count).filter(|k| !is_kept(*k));
    let mut left_out = 0;
    for k in kept.chain(others) {
        let at = stops[k - 1];
        let name = k.to_string();
        let size = Vector2::new(width(&name, NUMBER) + 1.0, NUMBER);
        let reach = if is_kept(k) { most } else { near };
        let Some(frame) = placing.place(at, size, least, reach) else {
            left_out += 1;
            continue;
        };
        let way = frame.middle - at;
        let room = way.abs() - frame.half;
        if room.x.max(room.y) > near {
            let share = (frame.half.x / way.x.abs()).min(frame.half.y / way.y.abs());
            let leader = [at + way.normalize() * least, frame.middle - way * share];
            sheet.ways(LEADER, [&leader[..]]);
            placing.way(&leader);
        }
        sheet.number(&name, foot(&frame) - Vector2::new(0.0, 0.5));
    }
    if count > 0 {
        let meaning = NUMBER_OF_STEP.meaning;
        let meaning = match left_out {
            0 => meaning.to_owned(),
            _ => format!("{meaning}; left out where too tight: {left_out}"),
        };
        sheet.name(Look::Mark(NUMBER_OF_STEP), meaning);
    }
}
