//! Where labels come from: a named value, or a channel of the remote control.

use std::fmt;
use std::str::FromStr;

use anyhow::{Result, bail};
use mavlink::dialects::common::{MavMessage, RC_CHANNELS_DATA};
use planner_core::Label;

/// Characters that a named value's name has at most.
const LONGEST_NAME: usize = 10;

/// Channels that `RC_CHANNELS` has.
const CHANNELS: u8 = 18;

/// The source of labels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// `NAMED_VALUE_FLOAT` or `NAMED_VALUE_INT` of this name.
    Named(String),
    /// A channel of `RC_CHANNELS`, 1 to 18.
    Channel(u8),
}

impl FromStr for Source {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        if let Some(number) = text.strip_prefix("channel:") {
            return match number.parse() {
                Ok(number @ 1..=CHANNELS) => Ok(Self::Channel(number)),
                _ => bail!("found channel {number:?}, expected 1 to {CHANNELS}"),
            };
        }
        let fits = (1..=LONGEST_NAME).contains(&text.len());
        if !fits || !text.bytes().all(|byte| byte.is_ascii_graphic()) {
            bail!(
                "found {text:?}, expected the name of a named value, 1 to {LONGEST_NAME} ASCII \
                 characters, or channel:N"
            );
        }
        Ok(Self::Named(text.to_owned()))
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Named(name) => write!(f, "the named value {name}"),
            Self::Channel(number) => write!(f, "channel {number} of RC_CHANNELS"),
        }
    }
}

/// The source of labels, and the threshold that makes labels of its values.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelSource {
    /// Where values come from.
    pub source: Source,
    /// A value above it is +1, any other -1.
    pub threshold: f64,
}

/// A label, and when it was read by the vehicle's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Told {
    /// Milliseconds since the vehicle's start.
    pub at_ms: u32,
    /// What was read.
    pub label: Label,
}

impl LabelSource {
    /// A source with its usual threshold unless one is given: 0 of named values, 1500 us of channels.
    pub fn new(source: Source, threshold: Option<f64>) -> Self {
        let usual = if matches!(source, Source::Named(_)) { 0.0 } else { 1500.0 };
        Self { threshold: threshold.unwrap_or(usual), source }
    }

    /// The label in a message, if it has one.
    pub fn read(&self, message: &MavMessage) -> Option<Told> {
        let (at_ms, value) = match (&self.source, message) {
            (Source::Named(name), MavMessage::NAMED_VALUE_FLOAT(it)) => {
                (it.name.to_str() == Ok(name)).then(|| (it.time_boot_ms, f64::from(it.value)))?
            }
            (Source::Named(name), MavMessage::NAMED_VALUE_INT(it)) => {
                (it.name.to_str() == Ok(name)).then(|| (it.time_boot_ms, f64::from(it.value)))?
            }
            (Source::Channel(number), MavMessage::RC_CHANNELS(it)) => {
                (it.time_boot_ms, f64::from(channel(it, *number)?))
            }
            _ => return None,
        };
        let label = if value > self.threshold { Label::Positive } else { Label::Negative };
        (!value.is_nan()).then_some(Told { at_ms, label })
    }
}

/// The value of a channel; `None` if the message marks it as absent.
fn channel(rc: &RC_CHANNELS_DATA, number: u8) -> Option<u16> {
    let value = *channels(&mut rc.clone())[usize::from(number) - 1];
    // ArduPilot says 0 of a channel without a signal.
    (number <= rc.chancount && value != u16::MAX && value != 0).then_some(value)
}

/// The channels in their order.
pub fn channels(rc: &mut RC_CHANNELS_DATA) -> [&mut u16; CHANNELS as usize] {
    [
        &mut rc.chan1_raw,
        &mut rc.chan2_raw,
        &mut rc.chan3_raw,
        &mut rc.chan4_raw,
        &mut rc.chan5_raw,
        &mut rc.chan6_raw,
        &mut rc.chan7_raw,
        &mut rc.chan8_raw,
        &mut rc.chan9_raw,
        &mut rc.chan10_raw,
        &mut rc.chan11_raw,
        &mut rc.chan12_raw,
        &mut rc.chan13_raw,
        &mut rc.chan14_raw,
        &mut rc.chan15_raw,
        &mut rc.chan16_raw,
        &mut rc.chan17_raw,
        &mut rc.chan18_raw,
    ]
}

#[cfg(test)]
mod tests {
    use mavlink::dialects::common::{NAMED_VALUE_FLOAT_DATA, NAMED_VALUE_INT_DATA};

    use super::*;

    fn float(name: &str, value: f32) -> MavMessage {
        let name = name.into();
        MavMessage::NAMED_VALUE_FLOAT(NAMED_VALUE_FLOAT_DATA { time_boot_ms: 7, value, name })
    }

    #[test]
    fn a_named_value_above_its_threshold_is_positive() {
        let label = |source: &LabelSource, message| source.read(&message).map(|it| it.label);
        let source = LabelSource::new("WET".parse().expect("a name"), None);
        assert_eq!(label(&source, float("WET", 0.1)), Some(Label::Positive));
        assert_eq!(label(&source, float("WET", 0.0)), Some(Label::Negative));
        assert_eq!(label(&source, float("WET", f32::NAN)), None);
        assert_eq!(label(&source, float("WETTER", 1.0)), None);
        let int = NAMED_VALUE_INT_DATA { time_boot_ms: 9, value: 1, name: "WET".into() };
        let told = source.read(&MavMessage::NAMED_VALUE_INT(int));
        assert_eq!(told, Some(Told { at_ms: 9, label: Label::Positive }));
        let strict = LabelSource::new("WET".parse().expect("a name"), Some(2.5));
        assert_eq!(label(&strict, float("WET", 2.0)), Some(Label::Negative));
    }

    #[test]
    fn a_channel_without_a_signal_tells_nothing() {
        let source = LabelSource::new("channel:7".parse().expect("a channel"), None);
        let rc = |raw, chancount| {
            let rc = RC_CHANNELS_DATA { chan7_raw: raw, chancount, ..RC_CHANNELS_DATA::default() };
            source.read(&MavMessage::RC_CHANNELS(rc)).map(|it| it.label)
        };
        assert_eq!(rc(1900, 8), Some(Label::Positive));
        assert_eq!(rc(1500, 8), Some(Label::Negative));
        assert_eq!((rc(1900, 6), rc(0, 8), rc(u16::MAX, 8)), (None, None, None));
    }
}
