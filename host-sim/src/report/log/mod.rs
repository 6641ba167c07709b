//! A mission as an MCAP log for Foxglove, Rerun and `PlotJuggler`. A step takes a second; the start is at 0.
//!
//! `/pose` and `/tf` contain the poses that the robot reported, `/scene` draws the mission, and `/step` has numbers to
//! plot. Rerun reads no scenes, so `/robot` and `/map/...` contain the same drawing as clouds of points.

mod cloud;
mod drawing;
mod messages;
mod plotted;

use std::collections::BTreeMap;
use std::io::Cursor;
use std::iter;

use anyhow::{Context as _, Result};
use foxglove::Encode;
use foxglove::messages::{FrameTransform, PoseInFrame, SceneUpdate};
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use prost::Message;

use crate::mission::recording::Recording;
use crate::mission::results::PoseRecord;
use crate::report::flat;
use crate::report::log::messages::{FRAME, ROBOT, pose, time};
use crate::report::log::plotted::Plot;
use crate::report::page::scene::Flight;

const PROTOBUF: &str = "protobuf";

/// A log that is being written.
struct Log {
    writer: Writer<Cursor<Vec<u8>>>,
    /// Channels by their topics, each from its first message on.
    channels: BTreeMap<String, u16>,
}

impl Log {
    /// Writes one of Foxglove's messages, which holds from a second on.
    fn write<M: Encode + Message>(&mut self, topic: &str, second: u32, message: &M) -> Result<()> {
        let schema = M::get_schema().context("a message with a schema")?;
        self.write_bytes(topic, second, (&schema.name, &schema.data), &message.encode_to_vec())
    }

    fn write_bytes(
        &mut self,
        topic: &str,
        second: u32,
        (schema, descriptors): (&str, &[u8]),
        message: &[u8],
    ) -> Result<()> {
        let channel_id = if let Some(channel) = self.channels.get(topic) {
            *channel
        } else {
            let schema = self.writer.add_schema(schema, PROTOBUF, descriptors)?;
            let channel = self.writer.add_channel(schema, topic, PROTOBUF, &BTreeMap::new())?;
            self.channels.insert(topic.to_owned(), channel);
            channel
        };
        let log_time = u64::from(second) * 1_000_000_000;
        let header =
            MessageHeader { channel_id, sequence: second, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, message)?)
    }

    /// Writes the drawing of a second, as a scene and as clouds: one for each entity, of an area of some size.
    fn draw(&mut self, second: u32, drawn: &SceneUpdate, size: f64) -> Result<()> {
        self.write("/scene", second, drawn)?;
        for entity in &drawn.entities {
            let topic = format!("/map/{}", entity.id.replace(' ', "_"));
            self.write(&topic, second, &cloud::of(entity, size))?;
        }
        Ok(())
    }
}

/// The log of a mission.
///
/// # Errors
/// When the format's library fails.
pub fn mcap(recording: &Recording) -> Result<Vec<u8>> {
    let options = WriteOptions::new().compression(Some(Compression::Lz4)).library("host-sim");
    let writer = options.create(Cursor::new(Vec::new())).context("the log could not be begun")?;
    let mut log = Log { writer, channels: BTreeMap::new() };
    let results = &recording.results;
    let rows = flat::rows(results);
    let plot = Plot::of(&rows)?;
    let (name, descriptors) = plot.schema();
    let flight = Flight::of(recording.mission.algorithm.title(), recording);
    let size = flight.size();
    log.write("/robot", 0, &cloud::of(&drawing::robot(&flight), size))?;
    log.draw(0, &drawing::begin(&flight), size)?;
    let stops = iter::once(&results.start.pose).chain(results.steps.iter().map(|it| &it.pose));
    for (second, at) in (0..).zip(stops) {
        let pose = posed(second, at);
        log.write("/tf", second, &transform(&pose))?;
        log.write("/pose", second, &pose)?;
    }
    for (second, drawn) in (1..).zip(drawing::steps(&flight)) {
        log.draw(second, &drawn, size)?;
    }
    for (second, (row, scene)) in (1..).zip(rows.iter().zip(flight.scenes.iter().skip(1))) {
        let message = plot.message(second, row, scene)?;
        log.write_bytes("/step", second, (name, &descriptors), &message)?;
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
