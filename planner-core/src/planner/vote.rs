//! A vote among hypotheses for an action.

use core::cmp::Reverse;

use heapless::Vec;

use crate::motion::action::Action;

/// The votes for each action so far, at most as many actions as there are voters, and how many votes are
/// still to be cast.
pub(crate) struct Ballot<const H: usize> {
    sums: Vec<(Action, u32), H, u16>,
    outstanding: u32,
}

impl<const H: usize> Ballot<H> {
    /// No vote is cast yet of so many.
    pub(crate) const fn new(outstanding: u32) -> Self {
        Self { sums: Vec::new(), outstanding }
    }

    /// One voter's votes for an action, or for none.
    pub(crate) fn cast(&mut self, votes: u32, action: Option<Action>) {
        self.outstanding -= votes;
        let Some(action) = action else { return };
        match self.sums.iter_mut().find(|(other, _)| *other == action) {
            Some((_, sum)) => *sum += votes,
            // There are no more actions than voters: nothing is refused.
            None => drop(self.sums.push((action, votes))),
        }
    }

    /// Whether the votes that are still to be cast cannot change who wins.
    pub(crate) fn is_decided(&self) -> bool {
        let [first, second] = self.sums.iter().fold([0; 2], |[first, second], &(_, votes)| {
            if votes > first { [votes, first] } else { [first, second.max(votes)] }
        });
        first - second > self.outstanding
    }

    /// The action with the most votes, and of equals the one of smallest index.
    pub(crate) fn winner(&self) -> Option<Action> {
        let best = self.sums.iter().max_by_key(|(action, votes)| (*votes, Reverse(*action)))?;
        Some(best.0)
    }
}
