//! A route through an area that is expected to meet a boundary soon: few corners, made better plan by plan.
//!
//! | module | contains |
//! | --- | --- |
//! | `corners` | what a route is made of |
//! | `cost` | the metres that a route is expected to take until it meets the boundary |
//! | `patterns` | sweeps and spirals, and random changes of a route |
//! | `search` | the search for a better route |

mod corners;
mod cost;
mod patterns;
mod search;

pub(crate) use corners::Hears;
pub use search::Route;
