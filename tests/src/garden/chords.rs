//! The line found by hand: bisect chords of the lawn, then join the places where they cross the boundary.
//!
//! Each place is asked until one label leads by two, as labels may be wrong. The rover drives straight across trees and
//! corner: nothing keeps it out, which favours the method.

use nalgebra::Point2;
use planner_core::{Label, Line};

use super::flight::{COMPARED, Ended, Finder, Outcome};
use super::lawn::{Garden, SIDE};
use super::rover::Rover;
use crate::anything::plain::{Point, metres};

/// A chord between places of different labels.
#[derive(Clone, Copy, Debug)]
struct Chord {
    negative: Point,
    positive: Point,
}

impl Chord {
    fn middle(&self) -> Point {
        [0, 1].map(|i| 0.5 * (self.negative[i] + self.positive[i]))
    }

    fn length(&self) -> f64 {
        distance(self.negative, self.positive)
    }
}

/// A mission by hand, with as many labels as are compared.
pub fn find(garden: &Garden, finder: Finder) -> Outcome {
    let mut hand = Hand { rover: Rover::new(garden), outcome: Outcome::NONE };
    let mut chords = match finder {
        Finder::Edge => hand.edge(garden),
        _ => Some(given(garden)),
    };
    if let Some(chords) = &mut chords {
        while hand.outcome.labels < COMPARED {
            // The longer chord is halved.
            let [a, b] = chords;
            let chord = if a.length() >= b.length() { a } else { b };
            let middle = chord.middle();
            match hand.ask(middle) {
                Some(Label::Positive) => chord.positive = middle,
                Some(Label::Negative) => chord.negative = middle,
                None => {}
            }
        }
    }
    let Hand { rover, mut outcome } = hand;
    let estimate = chords.and_then(|[a, b]| through(a.middle(), b.middle()));
    outcome.compare(&rover, estimate, &garden.line);
    outcome.last_error = outcome.slope_error;
    outcome.ended = Ended::Labels;
    outcome.close(&rover)
}

/// The two chords between given places whose middles are the furthest apart: the lever is long.
fn given(garden: &Garden) -> [Chord; 2] {
    let [n, p, q, m] = garden.given.map(|sample| metres(sample.site));
    let pair = |a, b| [Chord { negative: n, positive: a }, Chord { negative: m, positive: b }];
    let lever = |[a, b]: &[Chord; 2]| distance(a.middle(), b.middle());
    let (straight, crosswise) = (pair(p, q), pair(q, p));
    if lever(&straight) >= lever(&crosswise) { straight } else { crosswise }
}

struct Hand<'a> {
    rover: Rover<'a>,
    outcome: Outcome,
}

impl Hand<'_> {
    /// The label of a place: the one that leads by two, unless labels run out before.
    fn ask(&mut self, place: Point) -> Option<Label> {
        self.rover.steer_to(place);
        self.rover.stop();
        self.outcome.motions += 1;
        let mut lead = 0_i32;
        while lead.abs() < 2 {
            if self.outcome.labels == COMPARED {
                return None;
            }
            self.outcome.labels += 1;
            lead += i32::from(self.rover.read().sign());
        }
        Some(if lead > 0 { Label::Positive } else { Label::Negative })
    }

    /// The two sides of the square on which the label changes, if it changes on two. The corners are asked first.
    ///
    /// The far corner of the square is asked as if nothing kept the rover out.
    fn edge(&mut self, garden: &Garden) -> Option<[Chord; 2]> {
        let (from, to) = (garden.setting.largest_error(), SIDE - garden.setting.largest_error());
        let corners = [[from, from], [to, from], [to, to], [from, to]];
        let mut labelled = Vec::new();
        for corner in corners {
            labelled.push((corner, self.ask(corner)?));
        }
        let next = labelled.iter().cycle().skip(1);
        let chords: Vec<Chord> = labelled
            .iter()
            .zip(next)
            .filter_map(|(&(a, label), &(b, other))| match (label, other) {
                (Label::Negative, Label::Positive) => Some(Chord { negative: a, positive: b }),
                (Label::Positive, Label::Negative) => Some(Chord { negative: b, positive: a }),
                _ => None,
            })
            .collect();
        <[Chord; 2]>::try_from(chords).ok()
    }
}

fn through(a: Point, b: Point) -> Option<Line> {
    let [x, z] = [b[0] - a[0], b[1] - a[1]];
    Line::through(Point2::from(a), nalgebra::Vector2::new(-z, x))
}

fn distance(a: Point, b: Point) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
