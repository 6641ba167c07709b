//! Vehicles that speak `MAVLink` and are not ours, in real time.

mod ardupilot;
mod mavlink;

/// What a flight says that got too few messages. A simulator that gets no turn on a busy machine sends none.
const STARVED: [&str; 3] =
    ["no position for 2 s", "no heartbeat for 5 s", "the simulation does not open its second port"];

/// Whether a flight ended as it got too few messages, where nothing was to keep them from it.
fn is_starved(said: &str) -> bool {
    STARVED.iter().any(|it| said.contains(it))
}
