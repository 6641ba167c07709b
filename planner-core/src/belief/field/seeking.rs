//! What a user says of a boundary that is sought.

use crate::geometry::value::ValueError;

/// What a boundary that is sought most likely is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Likely {
    /// The edge of a patch that lies inside the area, such as a spill.
    Spill,
    /// A boundary that crosses the area, such as a coast.
    Coast,
    /// Nobody knows: nine in ten are patches.
    #[default]
    Either,
}

impl Likely {
    /// The share of patches among all boundaries.
    pub(crate) const fn patches(self) -> f32 {
        match self {
            Self::Spill => 0.98,
            Self::Coast => 0.1,
            Self::Either => 0.9,
        }
    }
}

/// How a boundary is sought of which nothing is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "(u32, Likely, u8)", into = "(u32, Likely, u8)"))]
pub struct Seeking {
    /// 0 for the usual radius.
    patch_mm: u32,
    likely: Likely,
    /// How many patches more than one.
    more: u8,
}

impl Seeking {
    /// For patches that hold a disc of a sixteenth of the mean of the area's sides, and for coasts.
    pub const USUAL: Self = Self { patch_mm: 0, likely: Likely::Either, more: 0 };

    /// For patches that hold a disc of this radius, metres, rounded to millimetres. A smaller patch may be missed. If in
    /// doubt, say less: half of the true radius costs little.
    ///
    /// # Errors
    /// [`ValueError`] unless the radius is from 0.01 to 5,000 m. A planner checks that it suits its area.
    pub fn patches(radius: f64) -> Result<Self, ValueError> {
        // A cast takes what is no number to 0, and what is too large to the largest number.
        Self::try_from((libm::round(radius * 1e3) as u32, Likely::Either, 0))
            .ok()
            .filter(|it| it.patch_mm > 0)
            .ok_or(RANGE)
    }

    /// The same, where the boundary most likely is such.
    #[must_use]
    pub const fn likely(self, likely: Likely) -> Self {
        Self { likely, ..self }
    }

    /// The same for so many patches: a follower that ends once it has [gone round](crate::Track::until_closed) seeks the
    /// next one then, until so many are mapped or none is left.
    ///
    /// # Errors
    /// [`ValueError`] unless there are 1 to 8.
    pub const fn several(self, patches: u8) -> Result<Self, ValueError> {
        match patches {
            1..=MOST_PATCHES => Ok(Self { more: patches - 1, ..self }),
            _ => Err(SEVERAL),
        }
    }

    /// How many patches are mapped at most.
    pub const fn most_patches(self) -> u8 {
        self.more.saturating_add(1)
    }

    /// What the boundary most likely is.
    pub const fn most_likely(self) -> Likely {
        self.likely
    }

    /// The radius of the smallest patch, metres; `None` for the usual one.
    pub fn radius(self) -> Option<f64> {
        (self.patch_mm > 0).then(|| f64::from(self.patch_mm) / 1e3)
    }

    /// The same in single precision, 0 for the usual one.
    pub(crate) fn patch(self) -> f32 {
        self.patch_mm as f32 / 1e3
    }
}

/// Patches at most.
pub(crate) const MOST_PATCHES: u8 = 8;

const SEVERAL: ValueError = ValueError("1 to 8 patches are mapped");

const RANGE: ValueError = ValueError("the radius of a patch is from 0.01 to 5000 m");

impl From<Seeking> for (u32, Likely, u8) {
    /// Millimetres, 0 for the usual radius; and how many patches more than one.
    fn from(Seeking { patch_mm, likely, more }: Seeking) -> Self {
        (patch_mm, likely, more)
    }
}

impl TryFrom<(u32, Likely, u8)> for Seeking {
    type Error = ValueError;

    /// # Errors
    /// As [`patches`](Self::patches), but 0 stands for the usual radius.
    fn try_from((patch_mm, likely, more): (u32, Likely, u8)) -> Result<Self, ValueError> {
        let is_radius = matches!(patch_mm, 0 | 10..=5_000_000);
        let radius = is_radius.then_some(Self { patch_mm, likely, more: 0 }).ok_or(RANGE);
        radius?.several(more.saturating_add(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_radius_is_refused() {
        for radius in [0.0, 0.009, -5.0, f64::NAN, f64::INFINITY, 5_001.0] {
            assert!(Seeking::patches(radius).is_err(), "{radius}");
        }
        let seeking = Seeking::patches(20.0).unwrap().likely(Likely::Spill);
        assert_eq!((seeking.radius(), seeking.most_likely()), (Some(20.0), Likely::Spill));
        assert_eq!((Seeking::USUAL.radius(), Seeking::USUAL.most_patches()), (None, 1));
        assert_eq!(seeking.several(3).map(Seeking::most_patches), Ok(3));
        assert!(seeking.several(0).is_err() && seeking.several(9).is_err());
    }
}
