//! A label sensor on a quantity that is measured: a threshold, with hysteresis.

use core::fmt::Debug;

use crate::belief::sample::{Label, Reading};
use crate::robot::hal::LabelSensor;

/// Reads a label off a quantity such as the counts of a converter, a concentration or a depth: one label above a
/// band, the other below it. Inside the band the label is the one that was read last (a Schmitt trigger). If none was
/// read yet, the middle of the band decides.
///
/// The band keeps noise of the quantity from changing the label again and again near the line. But inside the band the
/// old label may be wrong. A band of width `b`, where the quantity changes by `g` a metre, moves the line by up to
/// `b / 2g` metres. Add this to the [tolerance](crate::belief::tolerance::Tolerance).
///
/// ```
/// use planner_core::robot::ThresholdSensor;
/// use planner_core::robot::LabelSensor;
/// use planner_core::{Label, Reading};
///
/// let mut counts = [470, 530, 490, 520, 440].into_iter();
/// let measure = || counts.next().ok_or("no conversion");
/// let mut sensor = ThresholdSensor::new(measure, 450..=520, Label::Positive);
/// let mut read = || sensor.read();
/// assert_eq!(read()?, Reading::Side(Label::Negative)); // nearer to the lower end
/// assert_eq!(read()?, Reading::Side(Label::Positive));
/// assert_eq!(read()?, Reading::Side(Label::Positive)); // inside the band, as before
/// assert_eq!(read()?, Reading::Side(Label::Positive));
/// assert_eq!(read()?, Reading::Side(Label::Negative));
/// assert_eq!(read(), Err("no conversion"));
/// # Ok::<(), &str>(())
/// ```
///
/// With a `measure` that is an `async` closure it is the same sensor for [drivers that are
/// awaited](crate::robot::asynchronous).
#[derive(Clone, Debug)]
pub struct ThresholdSensor<F> {
    pub(super) measure: F,
    low: i32,
    high: i32,
    above: Label,
    last: Option<Label>,
}

impl<F> ThresholdSensor<F> {
    /// A sensor that reads the label `above` beyond the upper end of a band, and the other beyond the lower. Ends are
    /// in whatever units `measure` has, and belong to the band; one value is a band without hysteresis.
    pub const fn new(measure: F, band: core::ops::RangeInclusive<i32>, above: Label) -> Self {
        Self { measure, low: *band.start(), high: *band.end(), above, last: None }
    }

    /// Gives back what measures.
    pub fn release(self) -> F {
        self.measure
    }

    /// The label of a value, which becomes the last one.
    pub(super) fn judge(&mut self, value: i32) -> Label {
        let by_the_middle = || {
            let is_above = value.abs_diff(self.low) > value.abs_diff(self.high);
            if is_above { self.above } else { -self.above }
        };
        let label = match value {
            _ if value > self.high => self.above,
            _ if value < self.low => -self.above,
            _ => self.last.unwrap_or_else(by_the_middle),
        };
        self.last = Some(label);
        label
    }
}

impl<F: FnMut() -> Result<i32, E>, E: Debug> LabelSensor for ThresholdSensor<F> {
    type Error = E;

    fn read(&mut self) -> Result<Reading, E> {
        let value = (self.measure)()?;
        Ok(self.judge(value).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The labels of some values, by a sensor that begins.
    fn labels<const N: usize>(values: [i32; N], band: core::ops::RangeInclusive<i32>) -> [i8; N] {
        let mut next = values.into_iter();
        let measure = || next.next().ok_or(());
        let mut sensor = ThresholdSensor::new(measure, band, Label::Positive);
        values.map(|_| sensor.read().unwrap().sign())
    }

    #[test]
    fn a_label_stays_until_the_other_end_is_passed() {
        assert_eq!(labels([9, 10, 20, 21, 20, 10, 9, 10], 10..=20), [-1, -1, -1, 1, 1, 1, -1, -1]);
        // The first by the middle, which is the lower half's.
        assert_eq!([14, 15, 16].map(|first| labels([first], 10..=20)), [[-1], [-1], [1]]);
        assert_eq!(labels([i32::MAX, i32::MIN, i32::MAX], i32::MIN..=i32::MAX), [1, 1, 1]);
    }

    #[test]
    fn one_value_is_a_threshold_without_hysteresis() {
        assert_eq!(labels([4, 6, 4, 6], 5..=5), [-1, 1, -1, 1]);
    }

    #[test]
    fn either_label_may_be_above() {
        let mut sensor = ThresholdSensor::new(|| Ok::<_, ()>(7), 1..=2, Label::Negative);
        assert_eq!(sensor.read(), Ok(Reading::Side(Label::Negative)));
        let _ = (sensor.release())();
    }
}
