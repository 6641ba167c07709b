//! What a field remembers: the sum of the labels in each region, in a byte, and the last labels one by one.

use crate::belief::field::layout::{DIRECTIONS, DISCS, Layout, OFFSETS, Region, RegionShape};
use crate::belief::field::recent::Recent;
use crate::belief::rows::Rows;
use crate::belief::sample::Label;
use crate::geometry::hull::Extent;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;

/// A disc whose centre the robot cannot come to: it is not sought.
pub(crate) const SHUT: i8 = i8::MIN;

/// The square of how near a heart is to a place where the robot sought it, as a share of how near the robot came.
const SAME: f32 = 0.01;

/// What a field has to remember: 1.6 kB.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FieldMemory {
    /// Of each disc, the sum of its labels.
    pub(crate) discs: Rows<i8, 1, DISCS>,
    /// Of each direction, the sums of the labels between one half-plane's border and the next one's.
    pub(crate) bins: Rows<i8, DIRECTIONS, { OFFSETS + 1 }>,
    /// Of each direction, how many half-planes from either end are not sought: the robot cannot come to them.
    pub(crate) shut: [[u8; 2]; DIRECTIONS],
    /// Of all labels.
    pub(crate) total: i32,
    pub(crate) recent: Recent,
}

impl FieldMemory {
    /// No label.
    pub(crate) const NONE: Self = Self {
        discs: Rows([[0; DISCS]]),
        bins: Rows([[0; OFFSETS + 1]; DIRECTIONS]),
        shut: [[0; 2]; DIRECTIONS],
        total: 0,
        recent: Recent::NONE,
    };

    /// Forgets all labels of an area, but for the last ones if they are `kept`.
    pub(crate) fn begin<G: Workspace>(&mut self, layout: &Layout, area: &G, kept: &Recent) {
        *self = Self::NONE;
        for (sum, (shape, _)) in self.discs.0.as_flattened_mut().iter_mut().zip(layout.discs()) {
            let site = shape.centre().and_then(|at| layout.site(at));
            *sum = if site.is_some_and(|it| area.contains(it)) { 0 } else { SHUT };
        }
        for it in kept.iter() {
            self.take(layout, it.site, it.label, 1);
        }
    }

    /// The robot came no nearer to a place than `least`, metres: what lies about it and goes no further is not sought.
    pub(crate) fn shut<G: Workspace>(
        &mut self,
        (layout, area): (&Layout, &G),
        at: [f32; 2],
        least: f32,
    ) {
        let is_there = |[x, z]: [f32; 2]| {
            let [x, z] = [x - at[0], z - at[1]];
            x * x + z * z <= SAME * least * least
        };
        for (sum, (shape, _)) in self.discs.0.as_flattened_mut().iter_mut().zip(layout.discs()) {
            if let RegionShape::Disc { centre, radius } = shape
                && radius <= least
                && is_there(centre)
            {
                *sum = SHUT;
            }
        }
        for (direction, shut) in self.shut.iter_mut().enumerate() {
            for (shut, is_inside) in shut.iter_mut().zip([true, false]) {
                let Some(shape) = layout.half_planes(direction).next() else { continue };
                let heart = layout.heart(area, Region { shape, is_inside });
                let is_shallow = |it: &RegionShape| it.beyond(heart) <= least;
                if is_there(heart) {
                    let count = layout.half_planes(direction).filter(is_shallow).count();
                    *shut = (*shut).max(count as u8);
                }
            }
        }
    }

    /// Discs whose centres lie in an extent are not sought: what lies there is known.
    pub(crate) fn leave_out(&mut self, layout: &Layout, extent: Extent) {
        for (sum, (shape, _)) in self.discs.0.as_flattened_mut().iter_mut().zip(layout.discs()) {
            let site = shape.centre().and_then(|at| layout.site(at));
            if site.is_some_and(|it| extent.holds(it)) {
                *sum = SHUT;
            }
        }
    }

    /// Takes in a label that counts so many times; -1 takes one back.
    pub(crate) fn take(&mut self, layout: &Layout, site: Site, label: Label, times: i8) {
        let by = if label == Label::Positive { times } else { times.saturating_neg() };
        let at = layout.seen(site);
        let add = |sum: &mut i8| {
            if *sum != SHUT {
                *sum = sum.saturating_add(by).max(-i8::MAX);
            }
        };
        for k in layout.discs_at(at) {
            self.discs.0.as_flattened_mut().get_mut(k).into_iter().for_each(add);
        }
        for (k, bins) in self.bins.0.iter_mut().enumerate() {
            bins.get_mut(layout.bin(k, at)).into_iter().for_each(add);
        }
        self.total = self.total.saturating_add(by.into());
        for _ in 0..times {
            self.recent.push(site, label);
        }
    }
}

#[cfg(feature = "serde")]
mod bytes {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::belief::field::recent::{REMEMBERED, Recent};
    use crate::belief::sample::Sample;

    type Labels = heapless::Vec<Sample, REMEMBERED, u8>;

    impl Serialize for Recent {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            self.iter().collect::<Labels>().serialize(serializer)
        }
    }

    impl<'de> Deserialize<'de> for Recent {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let mut recent = Self::NONE;
            for it in &Labels::deserialize(deserializer)? {
                recent.push(it.site, it.label);
            }
            Ok(recent)
        }
    }
}
