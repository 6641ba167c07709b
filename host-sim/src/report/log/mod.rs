//! A mission as an MCAP log, which Foxglove, Rerun and `PlotJuggler` open: `/pose` where the robot reported to be,
//! `/scene` what is drawn of it, `/step` what there is to plot. A step takes a second; the start is at 0.

mod drawing;
mod messages;

use std::collections::BTreeMap;
use std::io::Cursor;

use anyhow::{Context as _, Result};
use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};
use prost::Message;

use crate::mission::recording::Recording;
use crate::mission::results::{PoseRecord, Results};
use crate::report::flat;
use crate::report::log::messages::{
    FRAME, POSE, Plotted, Pose, PoseInFrame, SCENE, STEP, Timestamp,
};
use crate::report::page::scene::Flight;

const PROTOBUF: &str = "protobuf";

/// A log that is being written.
struct Log {
    writer: Writer<Cursor<Vec<u8>>>,
}

/// Where messages of a kind go.
#[derive(Clone, Copy)]
struct Channel(u16);

impl Log {
    fn channel(&mut self, topic: &str, (schema, descriptors): (&str, &[u8])) -> Result<Channel> {
        let schema = self.writer.add_schema(schema, PROTOBUF, descriptors)?;
        Ok(Channel(self.writer.add_channel(schema, topic, PROTOBUF, &BTreeMap::new())?))
    }

    /// Takes down what holds from a second on.
    fn write(
        &mut self,
        Channel(channel_id): Channel,
        second: u32,
        message: &impl Message,
    ) -> Result<()> {
        let log_time = u64::from(second) * 1_000_000_000;
        let header =
            MessageHeader { channel_id, sequence: second, log_time, publish_time: log_time };
        Ok(self.writer.write_to_known_channel(&header, &message.encode_to_vec())?)
    }
}

/// The log of a mission.
///
/// # Errors
/// When the format's library fails.
pub fn mcap(recording: &Recording) -> Result<Vec<u8>> {
    let options = WriteOptions::new().compression(None).library("host-sim");
    let writer = options.create(Cursor::new(Vec::new())).context("the log could not be begun")?;
    let mut log = Log { writer };
    let (poses, scenes, steps) =
        (log.channel("/pose", POSE)?, log.channel("/scene", SCENE)?, log.channel("/step", STEP)?);
    let results = &recording.results;
    let flight = Flight::of(recording.mission.algorithm.title(), recording);
    log.write(poses, 0, &pose(0, &results.start.pose))?;
    log.write(scenes, 0, &drawing::begin(&flight))?;
    for (second, step) in (1..).zip(&results.steps) {
        log.write(poses, second, &pose(second, &step.pose))?;
    }
    for (second, drawn) in (1..).zip(drawing::steps(&flight)) {
        log.write(scenes, second, &drawn)?;
    }
    for (second, plotted) in (1..).zip(plotted(results, &flight)) {
        log.write(steps, second, &plotted)?;
    }
    log.writer.finish().context("the log could not be completed")?;
    Ok(log.writer.into_inner().into_inner())
}

fn pose(second: u32, &PoseRecord { x, z, heading }: &PoseRecord) -> PoseInFrame {
    let (timestamp, frame_id) = (Some(Timestamp::of(second)), FRAME.to_owned());
    PoseInFrame { timestamp, frame_id, pose: Some(Pose::new([x, z], heading)) }
}

/// The numbers of each step, as flat rows have them, and how far the estimate is off.
fn plotted(results: &Results, flight: &Flight) -> impl Iterator<Item = Plotted> {
    let stages = flight.scenes.iter().skip(1);
    (1..).zip(flat::rows(results).zip(stages)).map(|(second, (row, scene))| {
        let estimate = scene.estimate.as_ref();
        Plotted {
            timestamp: Some(Timestamp::of(second)),
            step: second,
            problem: row.problem.unwrap_or_default().to_owned(),
            recovery: row.recovery.unwrap_or_default().to_owned(),
            label: row.label.map(i32::from),
            slope_from: row.slope_from,
            slope_to: row.slope_to,
            intercept_from: row.intercept_from,
            intercept_to: row.intercept_to,
            bits: row.bits,
            entropy: row.entropy,
            hypotheses: row.hypotheses.map(|count| count as u32),
            control_cost: row.control_cost,
            metres: row.metres,
            slope_error_deg: estimate.and_then(|line| line.off_deg),
            misclassified: estimate.and_then(|line| line.misclassified),
        }
    })
}
