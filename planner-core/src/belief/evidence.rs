//! Evidence against the model: a straight, still line, and a sensor as it was described.
//!
//! Each alternative bets on the next label. The model's own chance of that label is known before it is read. The ratio of
//! the two has the mean 1 as long as the model is true, whatever the planner does. So a product of such ratios, and every
//! mean of such products, reaches `c` with a probability of `1 / c` at most, however long the mission (Ville, 1939). This
//! is an *e-value*: 20 is a warning, 100 an alarm.
//!
//! | alternative | bets |
//! | --- | --- |
//! | [`Coin`](Suspect::Coin) | even |
//! | [`Inverted`](Suspect::Inverted) | as the model, on the other label |
//! | [`Stuck`](Suspect::Stuck) | 0.97 on the label before |
//!
//! Each may begin at any label: a share of what is left begins to bet at each. 20 bytes. It changes no plan.
//!
//! The bound holds on the average over lines drawn from the prior. For one line in a corner of the start it may be
//! exceeded early, which is why a warning begins at 20. Where labels are true, look-ahead asks where both are as likely:
//! then only the stuck sensor shows, and the [`audit`](crate::planner::audit) has to find the rest.

use crate::belief::sample::Label;

/// The share of what is left that begins to bet at a label.
const BEGINS: f32 = 0.05;

/// The chance with which a stuck sensor repeats its label.
const REPEATS: f32 = 0.97;

/// A label counts as so much likelier than the belief says. Chances are in single precision, off by less than that, so
/// evidence gains nothing by rounding. Nor does one label hide what the others say.
const ROUNDING: f32 = 1e-5;

/// Evidence is not counted beyond this, as single precision ends.
const MOST: f32 = 1e30;

/// A failing sensor is suspected if it explains the labels so many times better than a coin: a coin stands for a boundary
/// that bends or moves as well.
const CLEARLY: f32 = 8.0;

/// The chance of a label that is not counted, whatever it is: that has to be known before it is read.
pub(crate) const NO_EVIDENCE: f32 = f32::INFINITY;

/// What explains the labels better than the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Suspect {
    /// Labels follow no straight, still line: the boundary bends or moves, or the sensor reads at random.
    Coin,
    /// The sensor reads the other label.
    Inverted,
    /// The sensor repeats a label.
    Stuck,
}

/// What speaks against the model, when it is much.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Alarm {
    /// The e-value, at least [`WARNING`](Self::WARNING).
    pub evidence: f32,
    /// What explains the labels best.
    pub suspect: Suspect,
}

impl Alarm {
    /// The least evidence of a warning: at most 1 mission in 20 reaches it while the model is true.
    pub const WARNING: f32 = 20.0;

    /// The least evidence of an alarm: at most 1 mission in 100 reaches it while the model is true.
    pub const ALARM: f32 = 100.0;

    /// Whether it is an alarm, and not only a warning.
    pub fn is_grave(&self) -> bool {
        self.evidence >= Self::ALARM
    }

    /// What is new after a label: a warning that was none before it, or an alarm that was none.
    pub(crate) fn risen(before: Option<Self>, after: Option<Self>) -> Option<Self> {
        after.filter(|after| before.is_none_or(|before| after.is_grave() && !before.is_grave()))
    }
}

impl core::fmt::Display for Alarm {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self.suspect {
            Suspect::Coin => {
                "labels follow no straight, still line: the boundary bends or moves, or the sensor reads at random"
            }
            Suspect::Inverted => "the sensor seems to read the other label",
            Suspect::Stuck => "the sensor seems stuck on one label",
        })
    }
}

/// Evidence so far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Evidence {
    /// What the alternatives have made of what they bet: coin, inverted, stuck.
    made: [f32; 3],
    /// What has not begun to bet.
    left: f32,
    last: Option<Label>,
}

impl Evidence {
    /// Of no label.
    pub const NONE: Self = Self { made: [0.0; 3], left: 1.0, last: None };

    /// Takes in a label. `chance` is that of this label before it was read, or more: what
    /// [`Belief::chance_of`](crate::belief::Belief::chance_of) says. With 0 it is a label that no line left has. With more than 1
    /// it is no evidence, and not counted.
    pub fn observe(&mut self, label: Label, chance: f32) {
        if chance > 1.0 + ROUNDING {
            return;
        }
        let chance = if chance > 0.0 { chance + ROUNDING } else { ROUNDING };
        let repeats = match self.last {
            None => 0.5,
            Some(last) if last == label => REPEATS,
            Some(_) => 1.0 - REPEATS,
        };
        let other = if chance < 1.0 { 1.0 - chance } else { 0.0 };
        for (made, bet) in self.made.iter_mut().zip([0.5, other, repeats]) {
            let more = (*made + BEGINS * self.left) * (bet / chance);
            *made = if more < MOST { more } else { MOST };
        }
        self.left *= 1.0 - BEGINS;
        self.last = Some(label);
    }

    /// The e-value: about 1 while the model is true.
    pub fn value(&self) -> f32 {
        self.left + self.made.iter().sum::<f32>() / 3.0
    }

    /// What speaks against the model, if it is much.
    pub fn alarm(&self) -> Option<Alarm> {
        let [coin, inverted, stuck] = self.made;
        let suspect = match () {
            () if stuck > CLEARLY * coin && stuck > inverted => Suspect::Stuck,
            () if inverted > CLEARLY * coin => Suspect::Inverted,
            () => Suspect::Coin,
        };
        let evidence = self.value();
        (evidence >= Alarm::WARNING).then_some(Alarm { evidence, suspect })
    }
}

impl Default for Evidence {
    fn default() -> Self {
        Self::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean over all sequences of labels, each with the chance that the model gives it. The evidence takes in chances
    /// that are off by so much.
    fn mean(labels: u32, off: f64, chance: impl Fn(u32, u32) -> f64) -> f64 {
        let each = (0..1_u32 << labels).map(|sequence| {
            let (mut evidence, mut weight) = (Evidence::NONE, 1.0);
            for n in 0..labels {
                let is_above = sequence >> n & 1 == 1;
                let above = chance(n, sequence & ((1 << n) - 1));
                let here = if is_above { above } else { 1.0 - above };
                let label = if is_above { Label::Positive } else { Label::Negative };
                evidence.observe(label, (here + off) as f32);
                weight *= here;
            }
            weight * f64::from(evidence.value())
        });
        each.sum()
    }

    #[test]
    fn its_mean_is_one_while_the_model_is_true() {
        for labels in [1, 2, 5, 12] {
            for model in [
                |_: u32, _: u32| 0.5,
                |n: u32, _: u32| 0.1 + 0.8 * f64::from(n % 3) / 2.0,
                |_: u32, before: u32| if before.count_ones().is_multiple_of(2) { 0.3 } else { 0.8 },
            ] {
                let mean = mean(labels, 0.0, model);
                assert!(mean <= 1.0 && mean > 0.9995, "{labels}: {mean}");
            }
        }
    }

    /// Both chances of a label are too low by as much as single precision may be off.
    #[test]
    fn rounding_does_not_make_evidence() {
        for labels in [1, 5, 12] {
            for above in [0.5, 0.1, 0.001, 2e-5] {
                let mean = mean(labels, -9e-6, |_, _| above);
                assert!(mean <= 1.0, "{labels}, {above}: {mean}");
            }
        }
    }

    #[test]
    fn a_warning_and_an_alarm_are_new_once_each() {
        let of = |evidence| {
            (evidence >= Alarm::WARNING).then_some(Alarm { evidence, suspect: Suspect::Coin })
        };
        let values = [1.0, 19.9, 20.0, 60.0, 99.9, 100.0, 3e5, 100.0, 70.0, 101.0, 5.0, 200.0];
        let new = values
            .windows(2)
            .map(|pair| Alarm::risen(of(pair[0]), of(pair[1])).map(|alarm| alarm.evidence as u32));
        let told =
            [None, Some(20), None, None, Some(100), None, None, None, Some(101), None, Some(200)];
        assert!(new.eq(told));
    }

    #[test]
    fn each_suspect_is_told() {
        let after = |labels: &mut dyn Iterator<Item = (Label, f32)>| {
            let mut evidence = Evidence::NONE;
            labels.for_each(|(label, chance)| evidence.observe(label, chance));
            evidence.alarm().map(|alarm| alarm.suspect)
        };
        let (up, down) = (Label::Positive, Label::Negative);
        assert_eq!(after(&mut (0..20).map(|_| (up, 0.5))), Some(Suspect::Stuck));
        let turns = |n: u32| if n.is_multiple_of(2) { up } else { down };
        assert_eq!(after(&mut (0..20).map(|n| (turns(n), 0.1))), Some(Suspect::Inverted));
        let half = |n: u32| if n % 4 < 2 { 0.05 } else { 0.95 };
        assert_eq!(after(&mut (0..40).map(|n| (turns(n), half(n)))), Some(Suspect::Coin));
        assert_eq!(after(&mut (0..40).map(|n| (turns(n), 0.9))), None);
        // A label that cannot be is more than any alarm, and no number overflows.
        let mut evidence = Evidence::NONE;
        (0..60).for_each(|n| evidence.observe(turns(n), 0.0));
        assert!(evidence.value() > Alarm::ALARM && evidence.value().is_finite());
    }
}
