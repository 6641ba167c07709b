//! Values in ascending order, slot by slot: a slot is a stage, and what was measured there.

use std::vec;

use rayon::prelude::*;

/// A value in its slot. Equal ones stay in the order in which they came.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Value {
    /// The slot whose values are sorted together.
    pub(crate) slot: u32,
    /// Goes with the value and plays no part in its order.
    pub(crate) is_marked: bool,
    pub(crate) number: f64,
}

/// The values of all slots, in their order.
pub(crate) type Sorted = vec::IntoIter<Value>;

/// Sorts them, on all cores.
pub(crate) fn sorted(mut values: Vec<Value>) -> Sorted {
    values.par_sort_by(|a, b| a.slot.cmp(&b.slot).then(a.number.total_cmp(&b.number)));
    values.into_iter()
}
