//! Where the regions of an area lie: discs of three radii on square cells, and half-planes.
//!
//! All is in metres from the middle of the rectangle around the area.

use crate::belief::field::seeking::Seeking;
use crate::belief::front::limited;
use crate::geometry::approximate::{METRE, sqrt};
use crate::geometry::heading::Heading;
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};
use crate::geometry::workspace::Workspace;

/// Discs of all radii, at most.
pub(crate) const DISCS: usize = 768;

/// Directions of half-planes in half a turn, and half-planes of a direction.
pub(crate) const DIRECTIONS: usize = 20;
pub(crate) const OFFSETS: usize = 20;

/// The radii of discs as multiples of the smallest, and how likely each is.
const RADII: [(f32, f32); 3] = [(1.0, 0.5), (1.7, 0.3), (3.0, 0.2)];

/// The side of the cells of discs as a share of their radius: the least, the most, and by how much it grows until all discs
/// have room.
const CELL: [f32; 2] = [0.5, 1.0];
const GROWS: f32 = 1.04;

/// Discs are smaller than this share of the area's shorter side.
const LARGEST: f32 = 0.5;

/// The usual radius of the smallest disc, as a share of the mean of the area's sides, and at most of the shorter side.
const USUAL: f32 = 1.0 / 16.0;
const USUAL_OF_SHORT: f32 = 0.25;

/// A half-plane cuts off at least so many radii of the smallest disc.
const CUTS_OFF: f32 = 0.5;

/// Discs of one radius on a grid of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lattice {
    pub(crate) radius: f32,
    /// How likely each disc is, of all discs.
    pub(crate) weight: f32,
    /// The sides of a cell.
    pub(crate) cell: [f32; 2],
    pub(crate) columns: u16,
    pub(crate) rows: u16,
}

impl Lattice {
    const NONE: Self = Self { radius: 0.0, weight: 0.0, cell: [1.0; 2], columns: 0, rows: 0 };

    fn count(&self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }
}

/// Where the regions of an area lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) middle: Site,
    /// Half of the sides of the rectangle around the area.
    pub(crate) half: [f32; 2],
    /// The radius of the smallest patch.
    pub(crate) patch: f32,
    pub(crate) lattices: [Lattice; 3],
    /// The offset of the first half-plane of each direction, and from one to the next.
    spans: [[f32; 2]; DIRECTIONS],
}

/// The shape of a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RegionShape {
    /// All within a radius of a centre.
    Disc { centre: [f32; 2], radius: f32 },
    /// All places whose product with the normal is below the offset.
    HalfPlane { normal: [f32; 2], offset: f32 },
}

impl RegionShape {
    /// How far a place lies from the border of a half-plane. 0 for a disc.
    pub(crate) fn beyond(self, [x, z]: [f32; 2]) -> f32 {
        let Self::HalfPlane { normal: [a, b], offset } = self else { return 0.0 };
        (a * x + b * z - offset).abs()
    }

    /// The centre of a disc. A half-plane has none.
    pub(crate) fn centre(self) -> Option<[f32; 2]> {
        if let Self::Disc { centre, .. } = self { Some(centre) } else { None }
    }
}

/// A region that may have another label than all else; or all but a shape, if that is not inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Region {
    pub(crate) shape: RegionShape,
    pub(crate) is_inside: bool,
}

impl Layout {
    pub(crate) const NONE: Self = Self {
        middle: Site::ORIGIN,
        half: [1.0; 2],
        patch: 1.0,
        lattices: [Lattice::NONE; 3],
        spans: [[0.0, 1.0]; DIRECTIONS],
    };

    /// The layout for an area. Without `patches` it has no discs. The error has the least radius of a patch that suits the
    /// area, and the most, metres.
    pub(crate) fn of<G: Workspace>(
        area: &G,
        seeking: Seeking,
        patches: bool,
    ) -> Result<Self, [f32; 2]> {
        let bounds = area.bounds();
        let half = bounds.half_sides().map(|it| it as f32 * METRE);
        let [x, z] = half;
        let (short, mean) = (2.0 * if x < z { x } else { z }, x + z);
        let usual = USUAL * mean;
        let usual = if usual < USUAL_OF_SHORT * short { usual } else { USUAL_OF_SHORT * short };
        let patch = if seeking.patch() > 0.0 { seeking.patch() } else { usual };
        let mut layout = Self { middle: bounds.middle(), half, patch, ..Self::NONE };
        if patches {
            layout.lattices = lattices(half, (patch, short)).ok_or_else(|| {
                let least = sqrt(4.0 * x * z / DISCS as f32) * 1.3;
                [least, LARGEST * short]
            })?;
        }
        layout.spans = core::array::from_fn(|k| layout.span(area, k));
        Ok(layout)
    }

    /// The offsets of the half-planes of a direction.
    fn span<G: Workspace>(&self, area: &G, direction: usize) -> [f32; 2] {
        let [x, z] = normal(direction);
        let (mut least, mut most) = (f32::MAX, f32::MIN);
        for corner in corners(area) {
            let [a, b] = self.seen(corner);
            let off = a * x + b * z;
            least = if off < least { off } else { least };
            most = if off > most { off } else { most };
        }
        let (least, most) = (least + CUTS_OFF * self.patch, most - CUTS_OFF * self.patch);
        let step = (most - least) / (OFFSETS - 1) as f32;
        // An area that is no broader than that has all its half-planes in the middle.
        if step > 0.0 { [least, step] } else { [0.5 * (least + most), 1e-3] }
    }

    /// A place deep in a region: the centre of a disc, or the corner of the area that lies furthest beyond a border.
    pub(crate) fn heart<G: Workspace>(
        &self,
        area: &G,
        Region { shape, is_inside }: Region,
    ) -> [f32; 2] {
        // Of a place: how far it lies from the border of a half-plane, or from a disc that has been seen.
        let depth = |[x, z]: [f32; 2]| match shape {
            RegionShape::Disc { centre: [a, b], .. } => (x - a) * (x - a) + (z - b) * (z - b),
            RegionShape::HalfPlane { normal: [a, b], .. } if is_inside => -(a * x + b * z),
            RegionShape::HalfPlane { normal: [a, b], .. } => a * x + b * z,
        };
        match shape.centre() {
            Some(centre) if is_inside => centre,
            _ => {
                let mut deepest = ([0.0; 2], f32::MIN);
                for place in corners(area).map(|it| self.in_bounds(self.seen(it))) {
                    let depth = depth(place);
                    if depth > deepest.1 {
                        deepest = (place, depth);
                    }
                }
                deepest.0
            }
        }
    }

    /// The place of the rectangle that is the nearest to a place.
    fn in_bounds(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        [limited(x, self.half[0]), limited(z, self.half[1])]
    }

    /// Where a site lies.
    pub(crate) fn seen(&self, site: Site) -> [f32; 2] {
        let way = site - self.middle;
        [way.x as f32 * METRE, way.z as f32 * METRE]
    }

    /// The site of a place. `None` off the lattice.
    pub(crate) fn site(&self, [x, z]: [f32; 2]) -> Option<Site> {
        let units = |it: f32| (it * UNITS_PER_METRE as f32) as i32;
        self.middle.step(Vector::new(units(x), units(z))?).ok()
    }

    /// The discs, in order, with their weights.
    pub(crate) fn discs(&self) -> impl Iterator<Item = (RegionShape, f32)> {
        let [x, z] = self.half;
        self.lattices.into_iter().flat_map(move |it| {
            (0..it.rows).flat_map(move |row| {
                (0..it.columns).map(move |column| {
                    let centre = [
                        (f32::from(column) + 0.5) * it.cell[0] - x,
                        (f32::from(row) + 0.5) * it.cell[1] - z,
                    ];
                    (RegionShape::Disc { centre, radius: it.radius }, it.weight)
                })
            })
        })
    }

    /// Whether there are any.
    pub(crate) fn has_discs(&self) -> bool {
        self.lattices.iter().any(|it| it.columns > 0)
    }

    /// The numbers of the discs that hold a place, by their order.
    pub(crate) fn discs_at(&self, [x, z]: [f32; 2]) -> impl Iterator<Item = usize> {
        let (x, z) = (x + self.half[0], z + self.half[1]);
        let mut first = 0;
        self.lattices.into_iter().flat_map(move |it| {
            let begin = first;
            first += it.count();
            let columns = around(x, it.radius, it.cell[0], it.columns);
            around(z, it.radius, it.cell[1], it.rows).flat_map(move |row| {
                let off = (f32::from(row) + 0.5) * it.cell[1] - z;
                let begin = begin + usize::from(row) * usize::from(it.columns);
                columns.clone().filter_map(move |column| {
                    let aside = (f32::from(column) + 0.5) * it.cell[0] - x;
                    let is_in = off * off + aside * aside <= it.radius * it.radius;
                    is_in.then_some(begin + usize::from(column))
                })
            })
        })
    }

    /// In how many half-planes of a direction a place does not lie.
    pub(crate) fn bin(&self, direction: usize, [x, z]: [f32; 2]) -> usize {
        let [a, b] = normal(direction);
        let [first, step] = self.spans.get(direction).copied().unwrap_or([0.0, 1.0]);
        // A cast takes what is below to 0.
        (((a * x + b * z - first) / step + 1.0) as usize).min(OFFSETS)
    }

    /// The half-planes of a direction, in order.
    pub(crate) fn half_planes(&self, direction: usize) -> impl Iterator<Item = RegionShape> {
        let [first, step] = self.spans.get(direction).copied().unwrap_or([0.0, 1.0]);
        let normal = normal(direction);
        (0..OFFSETS)
            .map(move |k| RegionShape::HalfPlane { normal, offset: first + k as f32 * step })
    }
}

/// The normal of the half-planes of a direction.
fn normal(direction: usize) -> [f32; 2] {
    const ONE: i32 = 1 << 24;
    const EACH: u32 = (1 << 31) / DIRECTIONS as u32;
    let Vector { x, z } = Heading((direction as u32).wrapping_mul(EACH)).unit().scaled(ONE);
    [x as f32 / ONE as f32, z as f32 / ONE as f32]
}

/// The cells along a side whose middles are within a radius of a place.
fn around(at: f32, radius: f32, cell: f32, count: u16) -> core::ops::Range<u16> {
    // A cast takes what is below to 0.
    let first = ((at - radius) / cell + 0.5) as u16;
    first..(((at + radius) / cell + 0.5) as u16).min(count)
}

/// The corners of an area: those of its rectangle, and the ends of its other sides, where they are part of it.
fn corners<G: Workspace>(area: &G) -> impl Iterator<Item = Site> {
    let (min, max) = (area.bounds().min(), area.bounds().max());
    let of_bounds =
        [(min.x(), min.z()), (max.x(), min.z()), (min.x(), max.z()), (max.x(), max.z())];
    let of_bounds = of_bounds.into_iter().filter_map(|(x, z)| Site::new(x, z).ok());
    let of_bounds = of_bounds.filter(|it| area.encloses(*it));
    of_bounds.chain(
        area.sides().flat_map(|side| {
            [Some(side.from), side.from.step(side.along).ok()].into_iter().flatten()
        }),
    )
}

/// The discs of a patch, in cells that are no smaller than must be. `None` where there is no room for enough of them.
fn lattices([x, z]: [f32; 2], (patch, short): (f32, f32)) -> Option<[Lattice; 3]> {
    let mut share = CELL[0];
    while share <= CELL[1] {
        let of = |(times, weight): (f32, f32)| {
            let radius = times * patch;
            if radius >= LARGEST * short {
                return Lattice::NONE;
            }
            let fit = |side: f32| libm::ceilf(side / (share * radius)) as u16;
            let (columns, rows) = (fit(2.0 * x), fit(2.0 * z));
            let cell = [2.0 * x / f32::from(columns), 2.0 * z / f32::from(rows)];
            Lattice { radius, weight, cell, columns, rows }
        };
        let mut all = RADII.map(of);
        let count: usize = all.iter().map(Lattice::count).sum();
        if count == 0 {
            return None;
        }
        if count <= DISCS {
            let whole: f32 = all.iter().map(|it| it.weight).sum();
            for it in &mut all {
                it.weight /= whole * it.count().max(1) as f32;
            }
            return Some(all);
        }
        share *= GROWS;
    }
    None
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::draws::Draws;
    use crate::geometry::area::Area;

    pub(crate) fn layout(patch: f64) -> Layout {
        let area = Area::metres([0.0, 0.0], [200.0, 150.0]).unwrap();
        Layout::of(&area, Seeking::patches(patch).unwrap(), true).unwrap()
    }

    #[test]
    fn discs_are_as_many_as_their_weights_say() {
        for patch in [9.0, 20.0, 45.0, 74.0] {
            let layout = layout(patch);
            let whole: f32 = layout.discs().map(|it| it.1).sum();
            assert!((whole - 1.0).abs() < 1e-4 && layout.discs().count() <= DISCS, "{patch}");
        }
        let area = Area::metres([0.0, 0.0], [200.0, 150.0]).unwrap();
        for patch in [5.0, 75.0] {
            let [least, most] =
                Layout::of(&area, Seeking::patches(patch).unwrap(), true).unwrap_err();
            assert!(least > 5.0 && least < 9.0 && most > 74.9, "{least}, {most}");
        }
        let coast = Layout::of(&area, Seeking::USUAL, false).unwrap();
        assert!(!coast.has_discs() && (coast.patch - 10.9375).abs() < 1e-3);
    }

    /// Against all discs and all half-planes, one after the other.
    #[test]
    fn a_place_is_in_the_regions_that_hold_it() {
        let mut draws = Draws::new(8);
        for patch in [10.0, 20.0, 60.0] {
            let layout = layout(patch);
            for _ in 0..100 {
                let [x, z] = [200.0, 150.0].map(|side| side * (draws.unit() as f32 - 0.5));
                let mut held = layout.discs_at([x, z]).peekable();
                for (k, (shape, _)) in layout.discs().enumerate() {
                    let RegionShape::Disc { centre: [a, b], radius } = shape else {
                        unreachable!()
                    };
                    let square = (x - a) * (x - a) + (z - b) * (z - b);
                    if (square - radius * radius).abs() > 1e-2 {
                        let is_held = held.next_if_eq(&k).is_some();
                        assert_eq!(is_held, square < radius * radius, "({x}, {z}), {shape:?}");
                    }
                }
                for k in 0..DIRECTIONS {
                    let out = layout.half_planes(k).filter(|it| {
                        let RegionShape::HalfPlane { normal: [a, b], offset } = *it else {
                            unreachable!()
                        };
                        a * x + b * z > offset
                    });
                    assert_eq!(layout.bin(k, [x, z]), out.count());
                }
            }
        }
    }
}
