//! How likely each region is to have another label than all else, and whether any is.

use crate::belief::field::layout::{DIRECTIONS, Layout, OFFSETS, Region, RegionShape};
use crate::belief::field::memory::{FieldMemory, SHUT};
use crate::belief::field::recent::Recent;
use crate::belief::field::seeking::Seeking;
use crate::belief::sample::Label;
use crate::geometry::hull::Extent;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;

/// Labels count as true no more often than this: a label then carries odds of `e^6`.
const MOST: f32 = 0.9975;

/// Odds are no smaller than this, and no larger than its inverse.
const LEAST: f32 = 1e-15;

/// A label that is known for sure counts as labels that carry these odds together.
const SURE: f32 = 6.0;

/// What may be left of an area that has one label, each as a probability if there is such a boundary in every second area.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Left {
    /// A patch that holds a disc of the radius that is sought; `None` if no patch is sought.
    pub patch: Option<f32>,
    /// A boundary that crosses the area.
    pub coast: f32,
}

/// The odds of discs and of half-planes against "all has one label".
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BoundaryOdds {
    pub(crate) discs: f32,
    pub(crate) half_planes: f32,
    /// The region with the most odds, and these.
    pub(crate) heaviest: (Option<Region>, f32),
}

impl BoundaryOdds {
    /// Of all regions.
    pub(crate) fn odds(self) -> f32 {
        self.discs + self.half_planes
    }

    /// The probability that there is a boundary.
    pub(crate) fn probability(self) -> f32 {
        self.odds() / (1.0 + self.odds())
    }
}

/// Sums whose odds are known, by their last bits.
const KNOWN: usize = 32;

/// The odds of regions by the sums of their labels. Many regions have the same sum.
struct KnownOdds {
    total: i32,
    /// The odds of all that is possible.
    whole: f32,
    odds: [Option<(i32, f32)>; KNOWN],
}

impl KnownOdds {
    fn of_total(field: &Field, total: i32) -> Self {
        Self { total, whole: 1.0 + field.power(total.abs()), odds: [None; KNOWN] }
    }

    /// Whether the inside of a region is what has not been seen, and its odds, if it was as likely as none beforehand.
    fn of(&mut self, field: &Field, sum: i32) -> (bool, f32) {
        let inside = if self.total < 0 { sum.wrapping_neg() } else { sum };
        let outside = self.total.abs().wrapping_sub(inside);
        let is_inside = inside <= outside;
        let Some(known) = self.odds.get_mut(sum as usize % KNOWN) else { return (is_inside, 0.0) };
        match known {
            Some((of, odds)) if *of == sum => (is_inside, *odds),
            _ => {
                let odds = (field.power(inside) + field.power(outside)) / self.whole;
                *known = Some((sum, odds));
                (is_inside, odds)
            }
        }
    }
}

/// What is known of a boundary of any shape in an area: 1.9 kB.
#[derive(Clone, Debug)]
pub(crate) struct Field {
    pub(crate) layout: Layout,
    pub(crate) memory: FieldMemory,
    seeking: Seeking,
    /// Whether there may be patches.
    patches: bool,
    /// The odds that a label is wrong: to the powers of 1, 2, 4 and so on.
    powers: [f32; 10],
}

impl Field {
    /// Of no area yet.
    pub(crate) const NONE: Self = Self {
        layout: Layout::NONE,
        memory: FieldMemory::NONE,
        seeking: Seeking::USUAL,
        patches: false,
        powers: [1.0; 10],
    };

    /// Begins a search of an area with labels that are true with probability `p`. A straight front has no `patches`.
    ///
    /// # Errors
    /// The least and the most radius of a patch that suit the area, metres.
    pub(crate) fn begin<G: Workspace>(
        &mut self,
        area: &G,
        (seeking, patches): (Seeking, bool),
        p: f32,
    ) -> Result<(), [f32; 2]> {
        (self.layout, self.seeking, self.patches) =
            (Layout::of(area, seeking, patches)?, seeking, patches);
        let p = if p < 0.5 { 1.0 - p } else { p };
        let p = if p < MOST { p } else { MOST };
        let mut power = (1.0 - p) / p;
        for it in &mut self.powers {
            *it = power;
            power = if power > LEAST { power * power } else { 0.0 };
        }
        self.memory.begin(&self.layout, area, &Recent::NONE);
        Ok(())
    }

    /// Forgets all labels but the last ones. What lies in these extents is not sought again.
    pub(crate) fn forget<G: Workspace>(&mut self, area: &G, known: &[Extent]) {
        let kept = self.memory.recent;
        self.memory.begin(&self.layout, area, &kept);
        for it in known {
            self.memory.leave_out(&self.layout, *it);
        }
    }

    /// A label counts no longer.
    pub(crate) fn take_back(&mut self, site: Site, label: Label) {
        self.memory.take(&self.layout, site, label, -1);
    }

    /// What lies in an extent is not sought, and the last labels were about it.
    pub(crate) fn leave_out(&mut self, extent: Extent) {
        self.memory.leave_out(&self.layout, extent);
        self.memory.recent = Recent::NONE;
    }

    /// What was said of the boundary.
    pub(crate) fn seeking(&self) -> Seeking {
        self.seeking
    }

    /// Takes in a label: some 3,000 instructions.
    pub(crate) fn observe(&mut self, site: Site, label: Label) {
        self.memory.take(&self.layout, site, label, 1);
    }

    /// Takes in a label that is known for sure.
    pub(crate) fn know(&mut self, site: Site, label: Label) {
        let times = SURE / self.odds();
        let times = if times < 100.0 { times } else { 100.0 };
        self.memory.take(&self.layout, site, label, times as i8 + 1);
    }

    /// What a label carries: the logarithm of its odds.
    pub(crate) fn odds(&self) -> f32 {
        -libm::logf(self.powers.first().copied().unwrap_or(1.0))
    }

    /// The odds that so many labels are wrong.
    fn power(&self, labels: i32) -> f32 {
        let mut bits = labels.unsigned_abs().min(1023);
        let mut odds = 1.0;
        for power in &self.powers {
            if bits & 1 == 1 {
                odds *= power;
            }
            bits >>= 1;
            if bits == 0 || odds < LEAST {
                break;
            }
        }
        let odds = if odds > LEAST { odds } else { LEAST };
        match labels {
            ..0 => 1.0 / odds,
            _ if odds > LEAST => odds,
            _ => 0.0,
        }
    }

    /// Goes through all regions, each with its odds. Some 30 instructions a region.
    pub(crate) fn each(&self, mut take: impl FnMut(Region, f32)) {
        let share =
            if self.layout.has_discs() { self.seeking.most_likely().patches() } else { 0.0 };
        let mut known = KnownOdds::of_total(self, self.memory.total);
        for (sum, (shape, weight)) in
            self.memory.discs.0.as_flattened().iter().zip(self.layout.discs())
        {
            if *sum != SHUT {
                let (is_inside, odds) = known.of(self, (*sum).into());
                take(Region { shape, is_inside }, odds * weight * share);
            }
        }
        let weight = (1.0 - share) / (DIRECTIONS * OFFSETS) as f32;
        let shut = self.memory.shut.iter();
        for ((direction, bins), [first, last]) in self.memory.bins.0.iter().enumerate().zip(shut) {
            let sought = usize::from(*first)..OFFSETS.saturating_sub((*last).into());
            let total = bins.iter().map(|it| i32::from(*it)).sum();
            if total != known.total {
                known = KnownOdds::of_total(self, total);
            }
            let mut sum = 0;
            for (n, (bin, shape)) in bins.iter().zip(self.layout.half_planes(direction)).enumerate()
            {
                sum += i32::from(*bin);
                if sought.contains(&n) {
                    let (is_inside, odds) = known.of(self, sum);
                    take(Region { shape, is_inside }, odds * weight);
                }
            }
        }
    }

    /// The odds of all regions together.
    pub(crate) fn sought(&self) -> BoundaryOdds {
        let mut sought = BoundaryOdds::default();
        self.each(|region, odds| {
            match region.shape {
                RegionShape::Disc { .. } => sought.discs += odds,
                RegionShape::HalfPlane { .. } => sought.half_planes += odds,
            }
            if odds > sought.heaviest.1 {
                sought.heaviest = (Some(region), odds);
            }
        });
        sought
    }

    /// What may be left, if all has one label.
    pub(crate) fn left(&self, sought: BoundaryOdds) -> Left {
        let share = self.seeking.most_likely().patches();
        let even = |odds: f32, share: f32| {
            let odds = odds / share;
            odds / (1.0 + odds)
        };
        let has_discs = self.layout.has_discs();
        Left {
            patch: has_discs.then(|| even(sought.discs, share)),
            coast: even(sought.half_planes, if has_discs { 1.0 - share } else { 1.0 }),
        }
    }

    /// The label that most places have.
    pub(crate) fn label(&self) -> Label {
        if self.memory.total < 0 { Label::Negative } else { Label::Positive }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::area::Area;

    fn area() -> Area {
        Area::metres([0.0, 0.0], [200.0, 150.0]).unwrap()
    }

    fn field(p: f32) -> Field {
        let mut field = Field::NONE;
        let seeking = Seeking::patches(20.0).unwrap();
        field.begin(&area(), (seeking, true), p).unwrap();
        field
    }

    fn at(x: f64, z: f64) -> Site {
        Site::metres([x, z]).unwrap()
    }

    /// Lanes a patch's diameter apart, and a label every three metres.
    fn mown(p: f32, read: impl Fn(f64, f64) -> Label) -> Field {
        let mut field = field(p);
        for lane in 0..6 {
            for k in 0..66 {
                let (x, z) = (2.0 + 3.0 * f64::from(k), 7.0 + 27.2 * f64::from(lane));
                field.observe(at(x, z), read(x, z));
            }
        }
        field
    }

    #[test]
    fn nothing_is_known_before_the_first_label() {
        let sought = field(0.9).sought();
        assert!((sought.probability() - 0.5).abs() < 1e-3, "{sought:?}");
        assert!((sought.discs - 0.9).abs() < 1e-3 && (sought.half_planes - 0.1).abs() < 1e-3);
    }

    #[test]
    fn an_area_that_was_mown_has_one_label() {
        for (p, most) in [(1.0, 1e-3), (0.9, 1e-2)] {
            let field = mown(p, |_, _| Label::Negative);
            let left = field.left(field.sought());
            assert!(left.patch < Some(most) && left.coast < most, "{p}: {left:?}");
            assert_eq!(field.label(), Label::Negative);
        }
    }

    #[test]
    fn a_patch_and_a_coast_are_seen() {
        let patch = |x: f64, z: f64| (x - 120.0).powi(2) + (z - 60.0).powi(2) < 625.0;
        let coast = |x: f64, z: f64| x + 0.5 * z < 40.0;
        let of = |is: bool| if is { Label::Positive } else { Label::Negative };
        let seen = mown(0.9, |x, z| of(patch(x, z)));
        assert!(seen.sought().discs > 100.0 && seen.sought().probability() > 0.99);
        for outside in [true, false] {
            let seen = mown(0.9, |x, z| of(coast(x, z) == outside));
            assert!(seen.sought().half_planes > 100.0, "{:?}", seen.sought());
        }
    }

    #[test]
    fn keep_outs_are_not_sought() {
        use crate::geometry::polygon_area::{KeepOut, PolygonArea};
        let corners = [at(0.0, 0.0), at(200.0, 0.0), at(200.0, 150.0), at(0.0, 150.0)];
        let corners = corners.map(nalgebra::Point2::<f64>::from);
        let island = KeepOut::<4>::disc([100.0, 75.0], 40.0).unwrap();
        let area = PolygonArea::<4, 1>::metres(&corners, &[island]).unwrap();
        let shut = |field: &Field| {
            field.memory.discs.0.as_flattened().iter().filter(|it| **it == SHUT).count() as f32
                / field.layout.discs().count() as f32
        };
        let mut field = field(0.9);
        assert!(shut(&field) < 1e-6);
        field.forget(&area, &[]);
        assert!((shut(&field) - 0.168).abs() < 0.02, "{}", shut(&field));
    }
}
