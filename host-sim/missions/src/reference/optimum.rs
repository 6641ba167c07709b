//! The optimum of an instance, if the instance is small enough.

use anyhow::Result;

use crate::reference::instance::Instance;
use crate::reference::search::{Search, Sequence};
use crate::reference::size;

/// The best sequence of motions; `None` if there is none that the problem allows.
///
/// # Errors
/// Names the horizon if there are too many sequences.
pub fn solve(instance: &Instance) -> Result<Option<Sequence>> {
    let (search, root) = Search::begin(instance);
    let Some(root) = root else { return Ok(None) };
    size::check(instance, &search, &root)?;
    search.run(root)
}
