//! Labels on the way of a motion, each at the place where the vehicle was when it read the label.
//!
//! Labels and positions come in messages of their own, which have the time of the vehicle's clock. A label belongs
//! between the two positions before and after it. The vehicle is taken to move straight and evenly from the one to the
//! other. Positions come ten times a second, so a fast vehicle has fewer labels on a way than were asked for.

use std::collections::VecDeque;

use planner_core::Label;

use crate::fly::frame::Ned;
use crate::fly::label::Told;
use crate::fly::vehicle::Fix;

/// The longest time between two positions that place a label, milliseconds. Where more than one was lost, nobody knows
/// where the vehicle was meanwhile.
const MOST_APART_MS: u32 = 250;

/// How long positions are kept for a label that comes late, milliseconds.
const KEPT_MS: u32 = 2_000;

/// What is read on the way of one motion.
#[derive(Clone, Debug)]
pub(crate) struct OnTheWay {
    /// Labels that are wanted of the motion, the one at its end included.
    readings: u32,
    from: Ned,
    to: Ned,
    /// Parts of the way that lie behind the last label.
    parts: u32,
    /// Positions, the newest last.
    fixes: VecDeque<Fix>,
    /// Labels that wait for a position after them.
    waiting: Vec<Told>,
    /// What was read and not taken yet.
    read: Vec<(Ned, Label)>,
}

impl OnTheWay {
    /// No way as yet, with so many labels a motion.
    pub(crate) const fn new(readings: u32) -> Self {
        let nowhere = Ned { north: 0.0, east: 0.0 };
        Self {
            readings,
            from: nowhere,
            to: nowhere,
            parts: 0,
            fixes: VecDeque::new(),
            waiting: Vec::new(),
            read: Vec::new(),
        }
    }

    /// A motion begins at a position.
    pub(crate) fn begin(&mut self, fix: Fix, to: Ned) {
        *self = Self { from: fix.at, to, ..Self::new(self.readings) };
        self.fixes.push_back(fix);
    }

    /// Takes in a position, which is newer than the last.
    pub(crate) fn locate(&mut self, fix: Fix) {
        self.fixes.push_back(fix);
        self.fixes.retain(|it| it.at_ms + KEPT_MS >= fix.at_ms);
        for told in std::mem::take(&mut self.waiting) {
            self.hear(told);
        }
    }

    /// Takes in a label.
    pub(crate) fn hear(&mut self, told: Told) {
        if self.fixes.back().is_some_and(|last| last.at_ms < told.at_ms) {
            self.waiting.push(told);
        } else if let Some(at) = self.place(told.at_ms)
            && let Some(parts) = self.parts_behind(at)
            && parts > self.parts
        {
            self.parts = parts;
            self.read.push((at, told.label));
        }
    }

    /// What was read since this was asked last.
    pub(crate) fn take(&mut self) -> Vec<(Ned, Label)> {
        std::mem::take(&mut self.read)
    }

    /// Where the vehicle was at a time of its clock; `None` if no two positions close to it tell.
    fn place(&self, at_ms: u32) -> Option<Ned> {
        let after = self.fixes.iter().position(|it| it.at_ms >= at_ms)?;
        let next = self.fixes[after];
        if next.at_ms == at_ms {
            return Some(next.at);
        }
        let last = self.fixes[after.checked_sub(1)?];
        let apart = next.at_ms - last.at_ms;
        if apart > MOST_APART_MS {
            return None;
        }
        let share = (at_ms - last.at_ms) as f32 / apart as f32;
        let between = |from: f32, to: f32| from + share * (to - from);
        Some(Ned {
            north: between(last.at.north, next.at.north),
            east: between(last.at.east, next.at.east),
        })
    }

    /// How many of as many equal parts as there are labels lie behind a place. `None` where the motion turns on the
    /// spot, and where the place is as good as its end: nearer than half a part.
    fn parts_behind(&self, at: Ned) -> Option<u32> {
        let of = |place: Ned| [place.north - self.from.north, place.east - self.from.east];
        let ([north, east], [to_north, to_east]) = (of(at), of(self.to));
        let share = (north * to_north + east * to_east) / (to_north * to_north + to_east * to_east);
        let parts = share * self.readings as f32;
        let is_on_the_way = parts >= 1.0 && parts < self.readings as f32 - 0.5;
        is_on_the_way.then_some(parts as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fix(at_ms: u32, east: f32) -> Fix {
        Fix { at_ms, at: Ned { north: 1.0, east }, down: 0.0, velocity: [0.0; 2] }
    }

    fn told(at_ms: u32) -> Told {
        Told { at_ms, label: Label::Positive }
    }

    /// Four metres to the east in four parts, a metre a second.
    fn way() -> OnTheWay {
        let mut way = OnTheWay::new(4);
        way.begin(fix(1_000, 0.0), Ned { north: 1.0, east: 4.0 });
        way
    }

    fn taken(way: &mut OnTheWay) -> Vec<f32> {
        way.take().into_iter().map(|(at, _)| at.east).collect()
    }

    #[test]
    fn a_label_lies_between_the_positions_before_and_after_it() {
        let mut way = way();
        way.locate(fix(2_000, 1.0));
        way.locate(fix(2_200, 1.2));
        // It waits for a position, another is too early, and a third is at a position.
        way.hear(told(2_250));
        assert!(taken(&mut way).is_empty());
        way.locate(fix(2_300, 1.3));
        assert_eq!(taken(&mut way), [1.25]);
        // It has one of that part of the way.
        way.hear(told(2_300));
        assert!(taken(&mut way).is_empty());
        way.locate(fix(3_100, 2.1));
        way.locate(fix(3_300, 2.3));
        way.hear(told(3_100));
        assert_eq!(taken(&mut way), [2.1]);
    }

    #[test]
    fn where_positions_were_lost_there_is_no_place() {
        let mut way = way();
        way.locate(fix(2_000, 1.0));
        way.locate(fix(2_251, 1.251));
        way.hear(told(2_100));
        assert!(taken(&mut way).is_empty());
        // Nor is there one for a label from before all positions that are kept.
        way.locate(fix(4_900, 1.5));
        way.hear(told(2_251));
        assert!(taken(&mut way).is_empty());
    }

    #[test]
    fn the_end_is_not_on_the_way_and_a_turn_has_none() {
        let mut way = way();
        for tenth in 1..=40_u32 {
            way.locate(fix(1_000 + 100 * tenth, tenth as f32 / 10.0));
            way.hear(told(1_000 + 100 * tenth));
        }
        assert_eq!(taken(&mut way), [1.0, 2.0, 3.0]);
        way.locate(fix(6_000, 4.0));
        way.hear(told(6_000));
        assert!(taken(&mut way).is_empty());
        way.begin(fix(7_000, 4.0), Ned { north: 1.0, east: 4.0 });
        way.locate(fix(7_100, 4.1));
        way.hear(told(7_100));
        assert!(taken(&mut way).is_empty());
        let mut one = OnTheWay::new(1);
        one.begin(fix(0, 0.0), Ned { north: 1.0, east: 4.0 });
        one.locate(fix(100, 2.0));
        one.hear(told(100));
        assert!(taken(&mut one).is_empty());
    }
}
