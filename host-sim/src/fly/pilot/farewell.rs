//! What became of a vehicle, for people.

use crate::fly::failure::Failure;
use crate::fly::frame::{ALIKE, apart};
use crate::fly::limits::TOLD_BEFORE;
use crate::fly::orders::Order;
use crate::fly::pilot::Pilot;

impl Pilot {
    /// What became of the vehicle in the end: whether it rests, who drives it, and what it said.
    pub fn farewell(&self) -> String {
        let is_out_of_hands = self.failure.as_ref().is_some_and(Failure::is_out_of_our_hands);
        let mut text = match () {
            () if is_out_of_hands => "nothing more was sent to it",
            () if self.rests => "it was told to stop, and says that it is at rest",
            () => "it was told to stop, and does not say that it is at rest",
        }
        .to_owned();
        text.extend(self.final_mode().map(|mode| format!("; its mode is now {mode}")));
        text.extend(self.said().map(|said| format!("; {said}")));
        text
    }

    /// Its mode, unless that is guided or the failure names it.
    fn final_mode(&self) -> Option<String> {
        let (_, status) = self.vehicle.status?;
        let mode = status.craft.mode(status.mode);
        let is_told = matches!(&self.failure, Some(Failure::TakenOver(told)) if *told == mode);
        (status.mode != status.craft.guided() && !is_told).then_some(mode)
    }

    /// The warnings that came with its failure, or the last before.
    fn said(&self) -> Option<String> {
        let warnings = &self.vehicle.warnings;
        let ended = self.ended?;
        let about: Vec<_> = warnings
            .iter()
            .filter(|(at, _)| *at + TOLD_BEFORE >= ended)
            .map(|(_, text)| format!("{text:?}"))
            .collect();
        if about.is_empty() {
            return warnings.last().map(|(_, text)| format!("it last warned: {text:?}"));
        }
        Some(format!("it said {}", about.join(", ")))
    }

    /// How far the vehicle is from its target, in words.
    pub(super) fn off(&self, order: &Order) -> String {
        let Some((fix, yaw)) = self.whereabouts() else {
            return "it is nobody knows where".to_owned();
        };
        let off = fix.at.distance(order.to);
        let turned = apart(yaw, order.yaw);
        if !order.is_turn || turned < ALIKE {
            return format!("it is {off:.2} m from where it was sent");
        }
        let lacks = turned.to_degrees();
        format!(
            "it lacks {lacks:.0} degrees of its turn: a vehicle that does not turn on the spot is a `boat`"
        )
    }
}
