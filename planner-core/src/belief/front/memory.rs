//! What a tracker has to remember over a sleep: its cells and their masses, as labels cannot be replayed.

use crate::belief::evidence::Evidence;
use crate::belief::front::lay::Lay;
use crate::belief::front::learnt::Learnt;
use crate::belief::front::tracker::Tracker;
use crate::belief::observation_log::{FromLog, ReplayError};
use crate::geometry::lattice::Site;
use crate::geometry::mark::Mark;

/// The masses of all cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Masses<const K: usize, const M: usize, const L: usize>(
    pub(crate) [[[f32; M]; K]; L],
);

/// What a tracker knows, without what it was told. `4 K M L` bytes and some 100.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FrontMemory<const K: usize, const M: usize, const L: usize> {
    pub(crate) lay: Lay,
    pub(crate) masses: Masses<K, M, L>,
    pub(crate) nowhere: [f32; 2],
    pub(crate) learnt: Option<Learnt>,
    pub(crate) evidence: Evidence,
    pub(crate) heard: Site,
    pub(crate) was_known: bool,
}

impl<const K: usize, const M: usize, const L: usize> FrontMemory<K, M, L> {
    /// Whether a tracker can have stored it: masses that make 1 together, in cells that have a size.
    pub(crate) fn is_valid(&self) -> bool {
        let Lay { turn, low, step, bend, .. } = self.lay;
        let masses = || self.masses.0.iter().flatten().flatten().chain(&self.nowhere);
        let sum: f32 = masses().sum();
        // Smaller cells come of bytes alone, and dividing by them overflows.
        let has_size = |it: f32| it > 1e-7 && it < 1e6;
        masses().all(|it| (0.0..=1.0).contains(it))
            && (sum - 1.0).abs() < 1e-2
            && has_size(turn)
            && turn * K as f32 <= 6.3
            && has_size(step)
            && low.abs() < 1e6
            && (0.0..1e6).contains(&bend)
            && self.learnt.is_none_or(Learnt::is_valid)
    }
}

impl<const K: usize, const M: usize, const L: usize> FromLog for Tracker<K, M, L> {
    type ObservationLog = FrontMemory<K, M, L>;

    fn log(&self) -> FrontMemory<K, M, L> {
        let Self { nowhere, learnt, evidence, heard, was_known, .. } = *self;
        let (lay, masses) = (self.grid.lay, Masses(self.grid.mass));
        FrontMemory { lay, masses, nowhere, learnt, evidence, heard, was_known }
    }

    fn mark(&self) -> Mark {
        self.noise.mark().and(<[u32; 2]>::from(self.front))
    }

    /// Goes on from there at once: nothing is replayed.
    fn replay(&mut self, log: &FrontMemory<K, M, L>) -> Result<(), ReplayError> {
        if !log.is_valid() {
            return Err(ReplayError::Spoilt);
        }
        if log.learnt.is_some() != self.learnt.is_some() {
            return Err(ReplayError::Kind);
        }
        self.grid.mass = log.masses.0;
        self.grid.set(log.lay);
        (self.nowhere, self.learnt, self.evidence) = (log.nowhere, log.learnt, log.evidence);
        (self.heard, self.was_known) = (log.heard, log.was_known);
        Ok(())
    }
}

#[cfg(feature = "serde")]
mod bytes {
    use core::fmt::{Formatter, Result as Written};

    use serde::de::{Error, SeqAccess, Visitor};
    use serde::ser::SerializeTuple as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Masses;

    impl<const K: usize, const M: usize, const L: usize> Serialize for Masses<K, M, L> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut tuple = serializer.serialize_tuple(K * M * L)?;
            for mass in self.0.iter().flatten().flatten() {
                tuple.serialize_element(mass)?;
            }
            tuple.end()
        }
    }

    struct Reader<const K: usize, const M: usize, const L: usize>;

    impl<'de, const K: usize, const M: usize, const L: usize> Visitor<'de> for Reader<K, M, L> {
        type Value = Masses<K, M, L>;

        fn expecting(&self, f: &mut Formatter<'_>) -> Written {
            write!(f, "{} masses", K * M * L)
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut masses = [[[0.0; M]; K]; L];
            for (k, mass) in masses.iter_mut().flatten().flatten().enumerate() {
                *mass = seq.next_element()?.ok_or_else(|| Error::invalid_length(k, &self))?;
            }
            Ok(Masses(masses))
        }
    }

    impl<'de, const K: usize, const M: usize, const L: usize> Deserialize<'de> for Masses<K, M, L> {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_tuple(K * M * L, Reader)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::front::settings::Front;
    use crate::belief::front::tracker::tests::{area, fly};
    use crate::belief::noise::Noise;

    #[test]
    fn what_it_was_goes_on_from_its_memory() {
        let front = Front::bending(60.0).unwrap();
        let noise = Noise::new(0.9).unwrap();
        let mut awake = Tracker::<16, 16, 3>::new(area(), front, noise);
        fly(&mut awake, 30);
        let mut woken = Tracker::new(area(), front, noise);
        let log = awake.log();
        woken.replay(&log).unwrap();
        for tracker in [&mut awake, &mut woken] {
            fly(tracker, 10);
        }
        assert_eq!(awake.log(), woken.log());
        let mut spoilt = log.clone();
        spoilt.masses.0[1][3][4] = f32::NAN;
        assert_eq!(woken.replay(&spoilt), Err(ReplayError::Spoilt));
        assert_eq!(
            woken.replay(&FrontMemory { nowhere: [0.9, 0.9], ..log.clone() }),
            Err(ReplayError::Spoilt)
        );
        for lay in [Lay { turn: 1e-30, ..log.lay }, Lay { step: 1e-38, ..log.lay }] {
            assert_eq!(woken.replay(&FrontMemory { lay, ..log.clone() }), Err(ReplayError::Spoilt));
        }
        let learnt = Some(Learnt::prior([8.0, 2.0]));
        assert_eq!(woken.replay(&FrontMemory { learnt, ..log }), Err(ReplayError::Kind));
        assert_eq!(awake.log(), woken.log());
    }
}
