//! What lines have to remember over a sleep: its cells and their masses, as labels cannot be replayed.

use crate::belief::evidence::Evidence;
use crate::belief::front::Learnt;
use crate::belief::lines::grid::Lay;
use crate::belief::lines::known::Lines;
use crate::belief::observation_log::{FromLog, ReplayError};
use crate::belief::rows::Rows;
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;

/// What lines know, without what they were told. `4 K M` bytes and some 100.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LinesMemory<const K: usize, const M: usize> {
    pub(crate) lay: Lay,
    /// Of all cells.
    pub(crate) masses: Rows<f32, K, M>,
    pub(crate) nowhere: [f32; 2],
    pub(crate) learnt: Option<Learnt>,
    pub(crate) evidence: Evidence,
    pub(crate) heard: Site,
}

impl<const K: usize, const M: usize> LinesMemory<K, M> {
    /// Whether lines can have stored it: masses that make 1 together, in cells that have a size.
    pub(crate) fn is_valid(&self) -> bool {
        let Lay { turn, low, step, .. } = self.lay;
        let masses = || self.masses.0.iter().flatten().chain(&self.nowhere);
        let sum: f32 = masses().sum();
        // Smaller cells come of bytes alone, and dividing by them overflows.
        let has_size = |it: f32| it > 1e-7 && it < 1e6;
        masses().all(|it| (0.0..=1.0).contains(it))
            && (sum - 1.0).abs() < 1e-2
            && has_size(turn)
            && turn * K as f32 <= 6.3
            && has_size(step)
            && low.abs() < 1e6
            && self.learnt.is_none_or(Learnt::is_valid)
    }
}

impl<const K: usize, const M: usize> FromLog for Lines<K, M> {
    type ObservationLog = LinesMemory<K, M>;

    fn log(&self) -> LinesMemory<K, M> {
        let Self { nowhere, learnt, evidence, heard, .. } = *self;
        let (lay, masses) = (self.grid.lay, Rows(self.grid.mass));
        LinesMemory { lay, masses, nowhere, learnt, evidence, heard }
    }

    fn mark(&self) -> Mark {
        self.noise.mark()
    }

    /// Goes on from there at once: nothing is replayed.
    fn replay(&mut self, log: &LinesMemory<K, M>) -> Result<(), ReplayError> {
        if !log.is_valid() {
            return Err(ReplayError::Spoilt);
        }
        if log.learnt.is_some() != self.learnt.is_some() {
            return Err(ReplayError::Kind);
        }
        self.grid.mass = log.masses.0;
        self.grid.set(log.lay);
        (self.nowhere, self.learnt, self.evidence) = (log.nowhere, log.learnt, log.evidence);
        self.heard = log.heard;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::lines::known::tests::{area, fly};
    use crate::belief::noise::Noise;

    #[test]
    fn what_it_was_goes_on_from_its_memory() {
        let noise = Noise::new(0.9).unwrap();
        let mut awake = Lines::<16, 16>::new(area(), noise);
        fly(&mut awake, 30);
        let mut woken = Lines::new(area(), noise);
        let log = awake.log();
        woken.replay(&log).unwrap();
        for lines in [&mut awake, &mut woken] {
            fly(lines, 10);
        }
        assert_eq!(awake.log(), woken.log());
        let mut spoilt = log.clone();
        spoilt.masses.0[3][4] = f32::NAN;
        assert_eq!(woken.replay(&spoilt), Err(ReplayError::Spoilt));
        let more = LinesMemory { nowhere: [0.9, 0.9], ..log.clone() };
        assert_eq!(woken.replay(&more), Err(ReplayError::Spoilt));
        for lay in [Lay { turn: 1e-30, ..log.lay }, Lay { step: 1e-38, ..log.lay }] {
            assert_eq!(woken.replay(&LinesMemory { lay, ..log.clone() }), Err(ReplayError::Spoilt));
        }
        let learnt = Some(Learnt::prior([8.0, 2.0]));
        assert_eq!(woken.replay(&LinesMemory { learnt, ..log }), Err(ReplayError::Kind));
        assert_eq!(awake.log(), woken.log());
    }
}
