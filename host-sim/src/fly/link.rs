//! What carries messages to a vehicle and back, with a clock.

use std::time::Duration;

use anyhow::Result;
use mavlink::MavHeader;
use mavlink::dialects::common::MavMessage;

/// A way to a vehicle: a socket, an ideal vehicle, a test's own.
pub trait Link {
    /// The time since the link was opened.
    fn now(&self) -> Duration;

    /// Sends a message. One that cannot be sent counts as lost on its way: only a missing answer shows it.
    fn send(&mut self, message: &MavMessage);

    /// The next message that arrives before a time, with its sender; `None` if none does.
    ///
    /// # Errors
    /// When the link is broken.
    fn receive(&mut self, until: Duration) -> Result<Option<(MavHeader, MavMessage)>>;
}
