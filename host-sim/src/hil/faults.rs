//! A link that is spoiled on purpose: frames are lost, cut, corrupted, doubled and delayed, by a seed.

use std::str::FromStr;
use std::time::Duration;

use anyhow::{Result, anyhow, bail};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// How likely each fault is, for each frame either way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// The frame is lost.
    pub drop: f64,
    /// The frame's end is lost.
    pub cut: f64,
    /// A bit of the frame is flipped.
    pub corrupt: f64,
    /// The frame comes twice.
    pub duplicate: f64,
    /// Frames come late by up to this, each by a time of its own, so they may overtake each other.
    pub delay: Duration,
}

/// `drop=0.1,cut=0.05,corrupt=0.05,duplicate=0.1,delay=20ms`, any of these.
impl FromStr for Faults {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut faults = Self::default();
        let mut named = Vec::new();
        for part in text.split(',') {
            let (name, value) = part
                .split_once('=')
                .ok_or_else(|| anyhow!("found {part:?}, expected name=value, such as drop=0.1"))?;
            if named.contains(&name) {
                bail!("found {name} twice, expected once");
            }
            named.push(name);
            let place = match name {
                "drop" => &mut faults.drop,
                "cut" => &mut faults.cut,
                "corrupt" => &mut faults.corrupt,
                "duplicate" => &mut faults.duplicate,
                "delay" => {
                    let ms = value.strip_suffix("ms").and_then(|ms| ms.parse().ok());
                    let ms = ms.ok_or_else(|| {
                        anyhow!(
                            "found delay={value}, expected whole milliseconds such as delay=20ms"
                        )
                    })?;
                    faults.delay = Duration::from_millis(ms);
                    continue;
                }
                _ => {
                    bail!("found {name}, expected one of drop, cut, corrupt, duplicate and delay")
                }
            };
            *place = match value.parse() {
                Ok(p) if (0.0..=1.0).contains(&p) => p,
                _ => bail!("found {name}={value}, expected a probability in [0, 1]"),
            };
        }
        Ok(faults)
    }
}

/// Spoils one direction of a link.
#[derive(Clone, Debug)]
pub struct Spoiler {
    faults: Faults,
    rng: ChaCha8Rng,
}

impl Spoiler {
    /// Faults in the order that a seed and a direction's number give.
    pub fn new(faults: Faults, seed: u64, direction: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_stream(2 + direction); // a mission's own chance has 0 and 1
        Self { faults, rng }
    }

    /// What arrives of a frame, and how late: nothing, the frame, or two of it.
    pub fn spoil(&mut self, frame: &[u8]) -> Vec<(Duration, Vec<u8>)> {
        let Faults { drop, cut, corrupt, duplicate, delay } = self.faults;
        let mut happens = |p: f64| self.rng.random_range(0.0..1.0) < p;
        let copies = 1 + usize::from(happens(duplicate));
        let mut arriving = Vec::with_capacity(copies);
        for _ in 0..copies {
            let mut happens = |p: f64| self.rng.random_range(0.0..1.0) < p;
            let (lost, cut, corrupt) = (happens(drop), happens(cut), happens(corrupt));
            if lost || frame.is_empty() {
                continue;
            }
            let mut bytes = frame.to_vec();
            if corrupt {
                let at = self.rng.random_range(0..bytes.len());
                bytes[at] ^= 1 << self.rng.random_range(0..8);
            }
            if cut {
                bytes.truncate(self.rng.random_range(0..bytes.len()));
            }
            arriving.push((delay.mul_f64(self.rng.random_range(0.0..1.0)), bytes));
        }
        arriving
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_read_and_wrong_ones_named() {
        let faults: Faults = "drop=0.1,corrupt=0.05,duplicate=0.1,delay=20ms".parse().unwrap();
        let delay = Duration::from_millis(20);
        assert_eq!(faults, Faults { drop: 0.1, corrupt: 0.05, duplicate: 0.1, cut: 0.0, delay });
        for (text, culprit) in [
            ("drop", "drop"),
            ("drop=2", "drop"),
            ("cut=x", "cut"),
            ("delay=20", "delay"),
            ("lose=0.1", "lose"),
            ("drop=0.1,cut=0.1,drop=0.2", "found drop twice"),
            ("delay=1ms,delay=1ms", "found delay twice"),
            ("", "name=value"),
        ] {
            let error = text.parse::<Faults>().unwrap_err().to_string();
            assert!(error.contains(culprit), "{text:?}: {error}");
        }
    }

    #[test]
    fn faults_come_as_often_as_asked() {
        let faults = Faults { drop: 0.1, duplicate: 0.2, ..Faults::default() };
        let mut spoiler = Spoiler::new(faults, 1, 0);
        let mut counts = [0; 3];
        for _ in 0..10_000 {
            counts[spoiler.spoil(&[1, 2, 3]).len()] += 1;
        }
        // None: 0.8 * 0.1 + 0.2 * 0.01. Two: 0.2 * 0.81.
        for (count, expected) in counts.into_iter().zip([0.082, 0.756, 0.162]) {
            assert!((f64::from(count) / 1e4 - expected).abs() < 0.015, "{counts:?}");
        }
    }
}
