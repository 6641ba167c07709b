//! What a user says of a front: whether it bends, how fast it moves, and how much of it is to be watched.

use crate::geometry::value::ValueError;

/// Whether a front bends, and how fast it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "[u32; 2]", into = "[u32; 2]"))]
pub struct Front {
    /// A radius, millimetres; 0 if it is straight. No other counts.
    radius_mm: u32,
    /// How far it moves in a unit of time at most, micrometres.
    speed_um: u32,
}

impl Front {
    /// Straight and still.
    pub const STRAIGHT: Self = Self { radius_mm: 0, speed_um: 0 };

    /// It bends, nobody knows how, and is still.
    pub const BENDING: Self = Self { radius_mm: 20_000, speed_um: 0 };

    /// It bends, with a radius of so many metres. Any will do: planners learn how it bends.
    ///
    /// # Errors
    /// [`ValueError`] unless it is from 0.1 to 1,000,000 m.
    pub fn bending(metres: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError =
            ValueError("the radius of the tightest bend is from 0.1 to 1000000 m");
        let radius_mm = libm::round(metres * 1e3) as u32;
        let is_radius = (0.1..=1e6).contains(&metres);
        is_radius.then_some(Self { radius_mm, speed_um: 0 }).ok_or(RANGE)
    }

    /// The same, but it moves by so many metres in a unit of time. If in doubt, name a higher speed.
    ///
    /// # Errors
    /// [`ValueError`] unless it is from 0 to 1,000 m.
    pub fn moving(self, metres: f64) -> Result<Self, ValueError> {
        const RANGE: ValueError =
            ValueError("the speed of a front is from 0 to 1000 m in a unit of time");
        let speed_um = libm::round(metres * 1e6) as u32;
        let is_speed = (0.0..=1e3).contains(&metres);
        is_speed.then_some(Self { speed_um, ..self }).ok_or(RANGE)
    }

    /// The radius that was named, metres; `None` if it is straight.
    pub fn radius(self) -> Option<f64> {
        (self.radius_mm > 0).then(|| f64::from(self.radius_mm) / 1e3)
    }

    /// How far it moves in a unit of time, metres.
    pub fn speed(self) -> f64 {
        f64::from(self.speed_um) / 1e6
    }

    /// The speed in single precision, metres in a unit of time.
    pub(crate) fn pace(self) -> f32 {
        self.speed_um as f32 * 1e-6
    }
}

impl From<Front> for [u32; 2] {
    /// Millimetres and micrometres.
    fn from(front: Front) -> Self {
        [front.radius_mm, front.speed_um]
    }
}

impl TryFrom<[u32; 2]> for Front {
    type Error = ValueError;

    /// # Errors
    /// As [`bending`](Front::bending) and [`moving`](Front::moving).
    fn try_from([radius_mm, speed_um]: [u32; 2]) -> Result<Self, ValueError> {
        const RANGE: ValueError = ValueError("a front bends and moves within bounds");
        let is_front = matches!(radius_mm, 0 | 100..=1_000_000_000) && speed_um <= 1_000_000_000;
        is_front.then_some(Self { radius_mm, speed_um }).ok_or(RANGE)
    }
}

/// How much of a front is to be watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u32", into = "u32"))]
pub struct FrontStretch {
    length_mm: u32,
}

impl FrontStretch {
    /// A stretch of so many metres, rounded to millimetres.
    ///
    /// # Errors
    /// [`ValueError`] unless that is from 0.1 to 10,000 m.
    pub fn metres(metres: f64) -> Result<Self, ValueError> {
        // A cast takes what is no number to 0, and what is too large to the largest number.
        Self::try_from(libm::round(metres * 1e3) as u32)
    }

    /// Its length in single precision, metres.
    pub(crate) fn length(self) -> f32 {
        self.length_mm as f32 / 1e3
    }
}

impl From<FrontStretch> for u32 {
    /// Millimetres.
    fn from(stretch: FrontStretch) -> Self {
        stretch.length_mm
    }
}

impl TryFrom<u32> for FrontStretch {
    type Error = ValueError;

    /// # Errors
    /// As [`metres`](FrontStretch::metres).
    fn try_from(length_mm: u32) -> Result<Self, ValueError> {
        const RANGE: ValueError = ValueError("the length of a stretch is from 0.1 to 10000 m");
        (100..=10_000_000).contains(&length_mm).then_some(Self { length_mm }).ok_or(RANGE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_stretch_is_refused() {
        for metres in [0.0, 0.09, -5.0, f64::NAN, f64::INFINITY, 1e4 + 0.1, 5e6, 1e300] {
            assert!(FrontStretch::metres(metres).is_err(), "{metres}");
        }
        for metres in [0.1, 12.3, 30.0, 1e4] {
            let length = FrontStretch::metres(metres).map(FrontStretch::length);
            assert_eq!(length, Ok(metres as f32));
        }
    }

    #[test]
    fn what_is_no_front_is_refused() {
        for radius in [0.0, 0.09, -5.0, f64::NAN, f64::INFINITY, 2e6] {
            assert!(Front::bending(radius).is_err(), "{radius}");
        }
        for speed in [-0.1, f64::NAN, 1_001.0] {
            assert!(Front::STRAIGHT.moving(speed).is_err(), "{speed}");
        }
        let front = Front::bending(40.0).and_then(|it| it.moving(0.05)).unwrap();
        assert_eq!(front.radius(), Some(40.0));
        // A quotient of integers is the number that is written so: no digit is added to what was told.
        for count in (100..200_000).step_by(7) {
            let (radius, speed) = (f64::from(count) / 1e3, f64::from(count) / 1e6);
            let front = Front::bending(radius).and_then(|it| it.moving(speed)).unwrap();
            let read = (front.radius().unwrap(), front.speed());
            assert_eq!([read.0.to_bits(), read.1.to_bits()], [radius, speed].map(f64::to_bits));
        }
        assert_eq!(Front::STRAIGHT.moving(0.05).unwrap().speed().to_bits(), 0.05f64.to_bits());
        assert_eq!(Front::STRAIGHT.radius(), None);
    }
}
