//! Vehicles that speak `MAVLink` and are not ours, in their own time: nothing else runs beside them.

use std::sync::{Mutex, MutexGuard, PoisonError};

mod ardupilot;
mod mavlink;

/// Lets one test run at a time: a machine that is too busy cannot judge flights.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}
