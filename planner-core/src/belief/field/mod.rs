//! Where a boundary of unknown shape may be: a belief over discs and half-planes, one byte each.
//!
//! A closed curve that bends nowhere more tightly than a radius encloses a disc of that radius (Pestov and Ionin,
//! 1959). So a search that rules out every disc of that radius finds every such patch. A boundary that crosses the area
//! cuts off a half-plane, nearly enough to be found. The belief is a sum over all these regions:
//!
//! | module | contains |
//! | --- | --- |
//! | `seeking` | what a user says of the boundary: the radius of a patch, and what is likely |
//! | `layout` | where the discs and the half-planes of an area lie |
//! | `memory` | the labels that each region has seen, in bytes, and the last labels one by one |
//! | `recent` | the last labels, and the last place between two of them where the boundary was crossed |
//! | `odds` | the mass of a region, and what is left of discs and of half-planes |
//!
//! With `s` the sum of the labels that were read in a region, `T` that of all labels, and labels that are true with
//! probability `p`, the odds of "the region has one label and all else the other one" against "all has one label" are
//!
//! ```text
//! cosh(o (T - 2 s) / 2) / cosh(o T / 2),    o = ln(p / (1 - p))
//! ```
//!
//! times the odds beforehand. Once a boundary is near, a finer belief takes over: see [`front`](crate::belief::front).

mod layout;
mod memory;
mod odds;
mod recent;
mod seeking;

pub(crate) use layout::{Region, RegionShape};
pub use memory::FieldMemory;
pub use odds::Left;
pub(crate) use odds::{BoundaryOdds, Field};
pub(crate) use recent::REMEMBERED;
pub(crate) use seeking::MOST_PATCHES;
pub use seeking::{Likely, Seeking};
