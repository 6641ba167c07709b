//! What Foxglove's messages are made of here, and the schema of our own.

use foxglove::messages::{Point3, Pose, Quaternion, Timestamp, Vector3};

/// A place in the plane, metres.
pub(super) type Place = [f64; 2];

/// The schema of our own message: name and descriptors.
pub(super) const STEP: (&str, &[u8]) =
    ("host_sim.Step", include_bytes!("../../../schemas/host_sim.Step.bin"));

/// The frame of all places.
pub(super) const FRAME: &str = "field";

/// The frame that moves with the robot.
pub(super) const ROBOT: &str = "robot";

/// A place in the plane: its `z` is the viewer's `y`.
pub(super) const fn point([x, y]: Place) -> Point3 {
    Point3 { x, y, z: 0.0 }
}

/// A pose in the plane; the heading in radians.
pub(super) fn pose([x, y]: Place, heading: f64) -> Pose {
    let (z, w) = libm::sincos(heading / 2.0);
    let orientation = Quaternion { x: 0.0, y: 0.0, z, w };
    Pose { position: Some(Vector3 { x, y, z: 0.0 }), orientation: Some(orientation) }
}

/// This many seconds after the start.
pub(super) fn time(second: u32) -> Timestamp {
    Timestamp::new(second, 0)
}
