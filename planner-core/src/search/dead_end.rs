//! Why a search found no further motion.
//!
//! Places of the area are sampled to see whether there is ground to find. That no way leads there is no proof: in some missions a
//! search of all ways would find one.

use crate::belief::cells::CellView;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::workspace::Workspace;

/// Why there is no way on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DeadEnd {
    /// What is uncertain is thinner than the action grid can hit, or lies outside the area.
    Resolution,
    /// What is uncertain is so thin that no label can tell more, as positions err.
    Tolerance,
    /// There is uncertain ground, but no motion that leads towards it: the border or a keep-out is in the
    /// way, or the agent cannot turn.
    Cornered,
    /// There is uncertain ground, but none of the ways that a plan tries leads there.
    Undecided,
    /// The agent is outside the area, and no motion leads back.
    Outside,
}

/// Number of places of the area that are tested.
const PLACES: u32 = 256;

/// The ground is open if labels can tell something at more than so many of them.
const FEW: usize = 2;

impl DeadEnd {
    /// The reason that is true where the ground is not open.
    pub(crate) fn of_thin_ground(self, lines: CellView<'_>) -> Self {
        let errs = lines.shift != Vector::default();
        match self {
            Self::Outside => self,
            _ if errs && !is_broad(lines) => Self::Tolerance,
            _ => Self::Resolution,
        }
    }

    /// The reason that is true where the ground is open.
    pub(crate) fn of_open_ground(self) -> Self {
        if self == Self::Resolution { Self::Undecided } else { self }
    }
}

/// The way to the nearest place where labels can tell something. `None` unless the ground is open: more than [`FEW`] of
/// the [`PLACES`] must be such.
///
/// Cost: one orientation for each edge and place, some 100,000 instructions.
pub(crate) fn way_to_open_ground<G: Workspace>(
    lines: CellView<'_>,
    area: &G,
    from: Site,
) -> Option<Vector> {
    let open = || (0..PLACES).filter_map(|k| place(area, k)).filter(|it| lines.can_cut(*it));
    let nearest = open().map(|it| it - from).min_by_key(|way| way.dot(*way));
    nearest.filter(|_| open().nth(FEW).is_some())
}

/// One of the places that are spread evenly over an area's rectangle, if it lies inside. No line passes many of them.
pub(crate) fn place<G: Workspace>(area: &G, k: u32) -> Option<Site> {
    // The additive recurrence of the plastic number (Roberts, 2018).
    const STEPS: [u32; 2] = [3_242_174_889, 2_447_445_414];
    let (min, max) = (area.bounds().min(), area.bounds().max());
    let part = |step: u32, from: i32, to: i32| {
        let share = u64::from(k.wrapping_mul(step));
        from + ((u64::from((to - from).unsigned_abs()) * share) >> 32) as i32
    };
    let (x, z) = (part(STEPS[0], min.x(), max.x()), part(STEPS[1], min.z(), max.z()));
    Site::new(x, z).ok().filter(|site| area.contains(*site))
}

/// Whether lines lie so far apart, somewhere between samples of both labels, that a label could tell something if
/// positions erred twice as much. Then it is not their error that leaves no place to ask.
pub(crate) fn is_broad(lines: CellView<'_>) -> bool {
    let Vector { x, z } = lines.shift;
    let twice = |v: i32| v.saturating_mul(2);
    let lines = CellView { shift: Vector { x: twice(x), z: twice(z) }, ..lines };
    lines.support().any(|a| {
        lines.support().filter(|b| a.label != b.label).any(|b| {
            let way = b.site - a.site;
            (1..4).any(|k| {
                let by = Vector { x: way.x / 4 * k, z: way.z / 4 * k };
                a.site.step(by).is_ok_and(|site| lines.can_cut(site))
            })
        })
    })
}
