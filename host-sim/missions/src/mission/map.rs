//! The map of a front: what following it came to.

use serde::{Deserialize, Serialize};

use crate::mission::front::VertexRecord;
use crate::world::World;

/// What following a front came to.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct MapRecord {
    /// How it stands in the end.
    pub state: State,
    /// The step after which the front was found first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub found: Option<usize>,
    /// Where it was known best when it was found last, if it is lost, and after which step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<LostRecord>,
    /// Vertices of the map: steps after which the front was found.
    pub vertices: usize,
    /// Metres of front that they go along, to and fro.
    pub metres: f64,
    /// Metres driven since it was found.
    pub driven: f64,
    /// The half-widths (90 %), metres: their median and the largest. Null without vertices.
    pub half_width: Option<[f64; 2]>,
    /// Beside the true front, if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub off: Option<OffRecord>,
}

/// How a front stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// It is found, and the robot goes along it.
    Followed,
    /// The robot has gone all round it.
    Closed,
    /// It was found, and is lost.
    Lost,
    /// It was not found.
    Sought,
}

/// Where a front was lost.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct LostRecord {
    /// The last step after which it was found.
    pub step: usize,
    /// Metres.
    pub x: f64,
    /// Metres.
    pub z: f64,
}

/// How far the vertices lie from the true front.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct OffRecord {
    /// The median, metres.
    pub median: f64,
    /// 95 % of them lie within this, metres.
    pub most: f64,
    /// The share of them whose half-width covers it.
    pub covered: f64,
}

impl MapRecord {
    /// Of a mission's steps in a world, as [`Self::after`] has them.
    pub fn of(steps: &[(f64, Option<VertexRecord>)], world: &World, is_closed: bool) -> Self {
        let vertices: Vec<_> =
            (1..).zip(steps).filter_map(|(step, (_, vertex))| Some((step, (*vertex)?))).collect();
        let off = OffRecord::of(&vertices, world);
        Self { off, ..Self::after(steps.iter().copied(), is_closed) }
    }

    /// Of the steps or rows of a track, counted from 1: after each how far the robot had driven, and where the front was
    /// known best, if it was found. `is_closed` says whether the robot went all round it.
    pub fn after(
        steps: impl IntoIterator<Item = (f64, Option<VertexRecord>)>,
        is_closed: bool,
    ) -> Self {
        let (mut vertices, mut begin) = (Vec::new(), None);
        let (mut whole, mut is_found) = (0.0, false);
        for (step, (metres, vertex)) in (1..).zip(steps) {
            (whole, is_found) = (metres, vertex.is_some());
            if let Some(vertex) = vertex {
                begin.get_or_insert(metres);
                vertices.push((step, vertex));
            }
        }
        let last = vertices.last();
        let state = match last {
            Some(_) if is_closed => State::Closed,
            Some(_) if is_found => State::Followed,
            Some(_) => State::Lost,
            None => State::Sought,
        };
        let lost = last.filter(|_| state == State::Lost);
        Self {
            state,
            found: vertices.first().map(|(step, _)| *step),
            lost: lost.map(|&(step, it)| LostRecord { step, x: it.x, z: it.z }),
            vertices: vertices.len(),
            // The sum of nothing is -0.
            metres: 0.0 + vertices.windows(2).map(along).sum::<f64>(),
            driven: begin.map_or(0.0, |begin| whole - begin),
            half_width: median_and_most(vertices.iter().map(|(_, it)| it.half_width), 1.0),
            off: None,
        }
    }
}

/// Metres along the front between two vertices of one piece of the map.
fn along(pair: &[(usize, VertexRecord)]) -> f64 {
    let [(step, from), (next, to)] = pair else { return 0.0 };
    let (sin, cos) = libm::sincos(from.heading);
    let way = to.at() - from.at();
    if *next == step + 1 { (way.x * cos + way.y * sin).abs() } else { 0.0 }
}

/// The median, and the number below which so large a share lies.
fn median_and_most(numbers: impl Iterator<Item = f64>, share: f64) -> Option<[f64; 2]> {
    let mut sorted: Vec<_> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    Some([0.5, share].map(|share| sorted[(last as f64 * share).round() as usize]))
}

impl OffRecord {
    fn of(vertices: &[(usize, VertexRecord)], world: &World) -> Option<Self> {
        let off = |(step, it): &(usize, VertexRecord)| {
            let site = it.at().try_into().ok()?;
            world.is_known().then(|| (world.after(*step).distance(site).abs(), it.half_width))
        };
        let off: Vec<_> = vertices.iter().filter_map(off).collect();
        let [median, most] = median_and_most(off.iter().map(|it| it.0), 0.95)?;
        let covered = off.iter().filter(|(off, half)| off <= half).count();
        Some(Self { median, most, covered: covered as f64 / off.len() as f64 })
    }
}
