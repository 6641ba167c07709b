//! A mission as an MCAP log for Foxglove, Rerun and `PlotJuggler`. A step takes a second; the start is at 0.
//!
//! `/pose` and `/tf` contain the poses that the robot reported, `/scene` draws the mission, and `/step` has numbers to
//! plot. Rerun reads no scenes, so `/robot` and `/map/...` contain the same drawing as clouds of points.

mod cloud;
mod drawing;
mod plotted;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::iter;

use anyhow::{Context as _, Result};
use foxglove::Encode;
use foxglove::messages::{
    FrameTransform, Point3, PointCloud, Pose, PoseInFrame, Quaternion, SceneUpdate, Timestamp,
    Vector3,
};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use prost::Message;

use crate::mission::recording::Recording;
use crate::mission::results::PoseRecord;
use crate::report::flat;
use crate::report::log::plotted::Plot;
use crate::report::page::scene::Flight;

const PROTOBUF: &str = "protobuf";

/// A place in the plane, metres.
type Place = [f64; 2];

/// The schema of our own message: name and descriptors.
const STEP: (&str, &[u8]) = ("host_sim.Step", include_bytes!("../../../schemas/host_sim.Step.bin"));

/// The frame of all places.
const FRAME: &str = "field";

/// The frame that moves with the robot.
const ROBOT: &str = "robot";

/// A place in the plane: its `z` is the viewer's `y`.
const fn point([x, y]: Place) -> Point3 {
    Point3 { x, y, z: 0.0 }
}

/// A pose in the plane; the heading in radians.
fn pose([x, y]: Place, heading: f64) -> Pose {
    let (z, w) = libm::sincos(heading / 2.0);
    let orientation = Quaternion { x: 0.0, y: 0.0, z, w };
    Pose { position: Some(Vector3 { x, y, z: 0.0 }), orientation: Some(orientation) }
}

/// This many seconds after the start.
fn time(second: u32) -> Timestamp {
    Timestamp::new(second, 0)
}

/// A log that is being written.
struct Log {
    writer: Writer<Cursor<Vec<u8>>>,
    /// Topics of clouds, each from its first cloud on.
    clouds: BTreeMap<String, Channel>,
}

/// A channel of the log, for one kind of message.
#[derive(Clone, Copy)]
struct Channel(u16);

impl Log {
    /// A channel for one of Foxglove's messages.
    fn channel<M: Encode>(&mut self, topic: &str) -> Result<Channel> {
        let schema = M::get_schema().context("a message with a schema")?;
        self.channel_of(topic, &schema.name, &schema.data)
    }

    fn channel_of(&mut self, topic: &str, schema: &str, descriptors: &[u8]) -> Result<Channel> {
        let schema = self.writer.add_schema(schema, PROTOBUF, descriptors)?;
        Ok(Channel(self.writer.add_channel(schema, topic, PROTOBUF, &BTreeMap::new())?))
    }

    /// Writes the drawing of a second, as a scene and as clouds: one for each entity, of an area of some size.
    fn draw(&mut self, scenes: Channel, second: u32, drawn: &SceneUpdate, size: f64) -> Result<()> {
        self.write(scenes, second, drawn)?;
        for entity in &drawn.entities {
            let topic = format!("/map/{}", entity.id.replace(' ', "_"));
            let channel = if let Some(channel) = self.clouds.get(&topic) {
                *channel
            } else {
                let channel = self.channel::<PointCloud>(&topic)?;
                self.clouds.insert(topic, channel);
                channel
            };
            self.write(channel, second, &cloud::of(entity, size))?;
        }
        Ok(())
    }

    /// Writes a message that holds from a second on.
    fn write(&mut self, channel: Channel, second: u32, message: &impl Message) -> Result<()> {
        self.write_bytes(channel, second, &message.encode_to_vec())
    }

    fn write_bytes(
        &mut self,
        Channel(channel_id): Channel,
        second: u32,
        message: &[u8],
    ) -> Result<()> {
        let log_time = u64::from(second) * 1_000_000_000;
        let header =
            MessageHeader { channel_id, sequence: second, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, message)?)
    }
}

/// The log of a mission.
///
/// # Errors
/// When the format's library fails.
pub fn mcap(recording: &Recording) -> Result<Vec<u8>> {
    let options = WriteOptions::new().compression(Some(Compression::Lz4)).library("host-sim");
    let writer = options.create(Cursor::new(Vec::new())).context("the log could not be begun")?;
    let mut log = Log { writer, clouds: BTreeMap::new() };
    let results = &recording.results;
    let rows = flat::rows(results);
    let plot = Plot::of(&rows)?;
    let poses = log.channel::<PoseInFrame>("/pose")?;
    let scenes = log.channel::<SceneUpdate>("/scene")?;
    let (name, descriptors) = plot.schema();
    let steps = log.channel_of("/step", name, &descriptors)?;
    let frames = log.channel::<FrameTransform>("/tf")?;
    let robot = log.channel::<PointCloud>("/robot")?;
    let flight = Flight::of(recording.mission.algorithm.title(), recording);
    let size = flight.size();
    log.write(robot, 0, &cloud::of(&drawing::robot(&flight), size))?;
    log.draw(scenes, 0, &drawing::begin(&flight), size)?;
    let stops = iter::once(&results.start.pose).chain(results.steps.iter().map(|it| &it.pose));
    for (second, at) in (0..).zip(stops) {
        let pose = posed(second, at);
        log.write(frames, second, &transform(&pose))?;
        log.write(poses, second, &pose)?;
    }
    for (second, drawn) in (1..).zip(drawing::steps(&flight)) {
        log.draw(scenes, second, &drawn, size)?;
    }
    for (second, (row, scene)) in (1..).zip(rows.iter().zip(flight.scenes.iter().skip(1))) {
        log.write_bytes(steps, second, &plot.message(second, row, scene)?)?;
    }
    log.writer.finish().context("the log could not be completed")?;
    Ok(log.writer.into_inner().into_inner())
}

fn posed(second: u32, &PoseRecord { x, z, heading }: &PoseRecord) -> PoseInFrame {
    let (timestamp, frame_id) = (Some(time(second)), FRAME.to_owned());
    PoseInFrame { timestamp, frame_id, pose: Some(pose([x, z], heading)) }
}

/// The robot's frame at a pose.
fn transform(PoseInFrame { timestamp, frame_id, pose }: &PoseInFrame) -> FrameTransform {
    FrameTransform {
        timestamp: *timestamp,
        parent_frame_id: frame_id.clone(),
        child_frame_id: ROBOT.to_owned(),
        translation: pose.and_then(|pose| pose.position),
        rotation: pose.and_then(|pose| pose.orientation),
    }
}
