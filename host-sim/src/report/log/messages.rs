//! The messages of a log: Foxglove's, as far as they are used here, and one of our own. Tags and kinds are those of the
//! schemas, which go into the log beside them.

use prost::Message;

/// The schemas: name and descriptors.
pub(super) const POSE: (&str, &[u8]) =
    ("foxglove.PoseInFrame", include_bytes!("../../../schemas/foxglove.PoseInFrame.bin"));
pub(super) const SCENE: (&str, &[u8]) =
    ("foxglove.SceneUpdate", include_bytes!("../../../schemas/foxglove.SceneUpdate.bin"));
pub(super) const CLOUD: (&str, &[u8]) =
    ("foxglove.PointCloud", include_bytes!("../../../schemas/foxglove.PointCloud.bin"));
pub(super) const TRANSFORM: (&str, &[u8]) =
    ("foxglove.FrameTransform", include_bytes!("../../../schemas/foxglove.FrameTransform.bin"));
pub(super) const STEP: (&str, &[u8]) =
    ("host_sim.Step", include_bytes!("../../../schemas/host_sim.Step.bin"));

/// The frame of all places.
pub(super) const FRAME: &str = "field";

/// The frame that moves with the robot.
pub(super) const ROBOT: &str = "robot";

/// A point, a vector: `z` of a place in the plane is the viewer's `y`.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Point {
    #[prost(double, tag = "1")]
    x: f64,
    #[prost(double, tag = "2")]
    y: f64,
    #[prost(double, tag = "3")]
    z: f64,
}

impl Point {
    pub(super) const fn at([x, y]: [f64; 2]) -> Self {
        Self { x, y, z: 0.0 }
    }

    /// Where it is in the plane.
    pub(super) const fn place(&self) -> [f64; 2] {
        [self.x, self.y]
    }

    pub(super) const fn cube(size: f64) -> Self {
        Self { x: size, y: size, z: size }
    }
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Quaternion {
    #[prost(double, tag = "1")]
    x: f64,
    #[prost(double, tag = "2")]
    y: f64,
    #[prost(double, tag = "3")]
    z: f64,
    #[prost(double, tag = "4")]
    w: f64,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Pose {
    #[prost(message, optional, tag = "1")]
    pub(super) position: Option<Point>,
    #[prost(message, optional, tag = "2")]
    pub(super) orientation: Option<Quaternion>,
}

impl Pose {
    /// In the plane; the heading in radians.
    pub(super) fn new(at: [f64; 2], heading: f64) -> Self {
        let (z, w) = libm::sincos(heading / 2.0);
        let orientation = Quaternion { x: 0.0, y: 0.0, z, w };
        Self { position: Some(Point::at(at)), orientation: Some(orientation) }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, Message)]
pub(super) struct Timestamp {
    #[prost(int64, tag = "1")]
    seconds: i64,
    #[prost(int32, tag = "2")]
    nanos: i32,
}

impl Timestamp {
    /// This many seconds after the start.
    pub(super) fn of(second: u32) -> Self {
        Self { seconds: second.into(), nanos: 0 }
    }
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct PoseInFrame {
    #[prost(message, optional, tag = "1")]
    pub(super) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(super) frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub(super) pose: Option<Pose>,
}

/// Where a frame is in another.
#[derive(Clone, PartialEq, Message)]
pub(super) struct FrameTransform {
    #[prost(message, optional, tag = "1")]
    pub(super) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(super) parent_frame_id: String,
    #[prost(string, tag = "3")]
    pub(super) child_frame_id: String,
    #[prost(message, optional, tag = "4")]
    pub(super) translation: Option<Point>,
    #[prost(message, optional, tag = "5")]
    pub(super) rotation: Option<Quaternion>,
}

/// Points, packed as their fields say.
#[derive(Clone, PartialEq, Message)]
pub(super) struct PointCloud {
    #[prost(message, optional, tag = "1")]
    pub(super) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(super) frame_id: String,
    #[prost(message, optional, tag = "3")]
    pub(super) pose: Option<Pose>,
    /// Bytes of a point.
    #[prost(fixed32, tag = "4")]
    pub(super) point_stride: u32,
    #[prost(message, repeated, tag = "5")]
    pub(super) fields: Vec<PackedField>,
    #[prost(bytes = "vec", tag = "6")]
    pub(super) data: Vec<u8>,
}

/// A field of a point: its name, its first byte and its numeric type.
#[derive(Clone, PartialEq, Eq, Message)]
pub(super) struct PackedField {
    #[prost(string, tag = "1")]
    pub(super) name: String,
    #[prost(fixed32, tag = "2")]
    pub(super) offset: u32,
    #[prost(int32, tag = "3")]
    pub(super) kind: i32,
}

#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Color {
    #[prost(double, tag = "1")]
    pub(super) r: f64,
    #[prost(double, tag = "2")]
    pub(super) g: f64,
    #[prost(double, tag = "3")]
    pub(super) b: f64,
    #[prost(double, tag = "4")]
    pub(super) a: f64,
}

/// A strip of lines, or a closed loop.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Line {
    /// 0 a strip, 1 a loop.
    #[prost(int32, tag = "1")]
    pub(super) kind: i32,
    #[prost(message, optional, tag = "2")]
    pub(super) pose: Option<Pose>,
    /// Pixels, as it does not scale.
    #[prost(double, tag = "3")]
    pub(super) thickness: f64,
    #[prost(bool, tag = "4")]
    pub(super) scale_invariant: bool,
    #[prost(message, repeated, tag = "5")]
    pub(super) points: Vec<Point>,
    #[prost(message, optional, tag = "6")]
    pub(super) color: Option<Color>,
}

/// Triangles, three points each.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Triangles {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<Pose>,
    #[prost(message, repeated, tag = "2")]
    pub(super) points: Vec<Point>,
    #[prost(message, optional, tag = "3")]
    pub(super) color: Option<Color>,
}

/// A sphere, or a cube: both are a pose, a size and a colour.
#[derive(Clone, Copy, PartialEq, Message)]
pub(super) struct Solid {
    #[prost(message, optional, tag = "1")]
    pub(super) pose: Option<Pose>,
    #[prost(message, optional, tag = "2")]
    pub(super) size: Option<Point>,
    #[prost(message, optional, tag = "3")]
    pub(super) color: Option<Color>,
}

/// A drawing under one name. It replaces the drawing under that name before.
#[derive(Clone, PartialEq, Message)]
pub(super) struct Entity {
    #[prost(message, optional, tag = "1")]
    pub(super) timestamp: Option<Timestamp>,
    #[prost(string, tag = "2")]
    pub(super) frame_id: String,
    #[prost(string, tag = "3")]
    pub(super) id: String,
    #[prost(message, repeated, tag = "8")]
    pub(super) cubes: Vec<Solid>,
    #[prost(message, repeated, tag = "9")]
    pub(super) spheres: Vec<Solid>,
    #[prost(message, repeated, tag = "11")]
    pub(super) lines: Vec<Line>,
    #[prost(message, repeated, tag = "12")]
    pub(super) triangles: Vec<Triangles>,
}

#[derive(Clone, PartialEq, Message)]
pub(super) struct SceneUpdate {
    #[prost(message, repeated, tag = "2")]
    pub(super) entities: Vec<Entity>,
}
