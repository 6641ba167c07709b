//! The map of a front: what following it came to.

use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::front::{PassedRecord, VertexRecord};
use crate::world::World;

/// What following a front came to.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct MapRecord {
    /// How it stands in the end: `followed`, `closed`, `lost`, or `sought` if it was never found.
    pub state: State,
    /// The step after which the front was found first.
    pub found: Option<usize>,
    /// If it is lost: the last place where it was known (`step`, `x`, `z`).
    pub lost: Option<LostRecord>,
    /// Vertices of the map.
    pub vertices: usize,
    /// Metres of front that they go along, to and fro.
    pub metres: f64,
    /// The pieces of the map.
    #[serde(default)]
    pub pieces: usize,
    /// Metres between them that are not mapped, in straight lines.
    #[serde(default)]
    pub gaps: f64,
    /// How many fronts the robot has gone all round, if several are sought.
    #[serde(default, skip_serializing_if = "is_one")]
    pub closed: usize,
    /// Metres driven since it was found.
    pub driven: f64,
    /// The half-widths (90 %), metres: their median and the largest. Null without vertices.
    #[serialize_always]
    pub half_width: Option<[f64; 2]>,
    /// Beside the true front as it was then, if that is known.
    pub off: Option<OffRecord>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
const fn is_one(closed: &usize) -> bool {
    *closed < 2
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

/// A step of a mission, or a row of a track, as the map has it.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// The number of the step or row.
    pub number: usize,
    /// Metres driven so far.
    pub metres: f64,
    /// Whether the front is known after it.
    pub is_known: bool,
    /// The places that the map has more.
    pub vertices: Vec<PassedRecord>,
}

/// The places of a map, each with the number of the step or row at which the robot passed it. A new piece begins
/// where the front was not known after one, and where the robot drove back.
pub type Places = Vec<Vec<(usize, VertexRecord)>>;

/// The map by its pieces. None is empty.
pub fn pieces<'a>(steps: impl IntoIterator<Item = &'a Mapped>) -> Places {
    let (mut pieces, mut is_open) = (Places::new(), false);
    for Mapped { is_known, vertices, .. } in steps {
        for it in vertices {
            let vertex = (it.passed, it.vertex);
            match pieces.last_mut() {
                Some(piece) if is_open && !it.begins => piece.push(vertex),
                _ => pieces.push(vec![vertex]),
            }
            is_open = true;
        }
        is_open &= *is_known;
    }
    pieces
}

impl MapRecord {
    /// Of a mission's steps in a world, as [`Self::after`] has them.
    pub fn of(steps: &[Mapped], world: &World, is_over: bool) -> Self {
        let off = OffRecord::of(&pieces(steps).concat(), world);
        Self { off, ..Self::after(steps, is_over) }
    }

    /// Of the steps of a mission or the rows of a track. `is_over` says whether the robot has gone along all of the front.
    pub fn after(steps: &[Mapped], is_over: bool) -> Self {
        let pieces = pieces(steps);
        let fronts = fronts(&pieces);
        let is_known = steps.last().is_some_and(|it| it.is_known);
        let is_closed = fronts.last().is_some_and(|last| {
            let has_left = !is_known && is_back(last);
            turns(last) > ROUND && (is_over || has_left)
        });
        let closed = fronts.len().saturating_sub(usize::from(!is_closed));
        let along = |pair: &[(usize, VertexRecord)]| match pair {
            [(_, from), (_, to)] => along(from, to),
            _ => 0.0,
        };
        let metres: f64 = pieces.iter().flat_map(|piece| piece.windows(2)).map(along).sum();
        let gaps = fronts
            .iter()
            .enumerate()
            .map(|(n, it)| gaps(it, n + 1 < fronts.len() || is_closed))
            .sum();
        let (number, vertices) = (pieces.len(), pieces.concat());
        let found = steps.iter().find(|it| it.is_known);
        let known = steps.iter().rfind(|it| it.is_known);
        let (last, end) = (vertices.last(), steps.last());
        let state = match found {
            Some(_) if is_closed => State::Closed,
            Some(_) if is_known || is_over => State::Followed,
            Some(_) => State::Lost,
            None => State::Sought,
        };
        let lost = known.zip(last).filter(|_| state == State::Lost);
        let whole = end.map_or(0.0, |it| it.metres);
        Self {
            state,
            found: found.map(|it| it.number),
            lost: lost.map(|(known, (_, at))| LostRecord { step: known.number, x: at.x, z: at.z }),
            vertices: vertices.len(),
            // The sum of nothing is -0.
            metres: 0.0 + metres,
            pieces: number,
            gaps,
            closed,
            driven: found.map_or(0.0, |it| whole - it.metres),
            half_width: median_and_most(vertices.iter().map(|(_, it)| it.half_width), 1.0),
            off: None,
        }
    }
}

/// A front of which all is mapped is closed if it turns by more than this, radians. One that leads out of the area at both
/// ends turns less.
const ROUND: f64 = 4.0;

/// A place is near the last one within so many times the way to the one before.
const NEAR: f64 = 4.0;

/// Some pieces of a map, in their order.
type Part = [Vec<(usize, VertexRecord)>];

/// The pieces by the fronts that they are of. Where the robot has gone all round one, what begins elsewhere is of another.
fn fronts(pieces: &Places) -> Vec<&Part> {
    let (mut fronts, mut begins, mut turned) = (Vec::new(), 0, 0.0);
    for (n, pair) in (1..).zip(pieces.windows(2)) {
        turned += turn(&pair[0]);
        let (front, next) = (&pieces[begins..n], &pair[1][0].1);
        if f64::abs(turned) > ROUND && is_back(front) && !is_near(front, next) {
            fronts.push(front);
            (begins, turned) = (n, 0.0);
        }
    }
    fronts.extend(pieces.get(begins..).filter(|it| !it.is_empty()));
    fronts
}

/// Whether a front comes back to its first place.
fn is_back(front: &Part) -> bool {
    is_near(front, &front[0][0].1)
}

/// Whether the last place of a front is near another, by the way between its last places.
fn is_near(front: &Part, other: &VertexRecord) -> bool {
    let mut last = front.iter().rev().flat_map(|it| it.iter().rev()).map(|it| &it.1);
    let (Some(end), Some(before)) = (last.next(), last.next()) else { return false };
    let off = |it: &VertexRecord| (it.at() - end.at()).norm();
    off(other) <= NEAR * off(before) + end.half_width
}

/// By how much the front turns along its pieces, radians.
fn turns(front: &Part) -> f64 {
    front.iter().map(|piece| turn(piece)).sum::<f64>().abs()
}

/// The same along a piece, to the left.
fn turn(piece: &[(usize, VertexRecord)]) -> f64 {
    let turn = |pair: &[(usize, VertexRecord)]| {
        let by = pair[1].1.heading - pair[0].1.heading;
        libm::remainder(by, std::f64::consts::TAU)
    };
    piece.windows(2).map(turn).sum()
}

/// Metres between the pieces in straight lines, and of a closed front from the last place to the first. A piece begins
/// near where the one before ended, or the robot has driven back to the first place.
fn gaps(pieces: &Part, is_closed: bool) -> f64 {
    let Some((_, first)) = pieces.first().and_then(|piece| piece.first()) else { return 0.0 };
    let mut ends = pieces.iter().filter_map(|piece| piece.last());
    let starts = pieces.iter().skip(1).filter_map(|piece| piece.first());
    let off = |from: &VertexRecord, to: &VertexRecord| (to.at() - from.at()).norm();
    let between = ends
        .clone()
        .zip(starts)
        .map(|((_, end), (_, start))| off(end, start).min(off(first, start)));
    let last = ends.next_back().filter(|_| is_closed).map_or(0.0, |(_, end)| off(end, first));
    between.sum::<f64>() + last
}

/// Metres along the front between two vertices of one piece of the map.
fn along(from: &VertexRecord, to: &VertexRecord) -> f64 {
    let (sin, cos) = libm::sincos(from.heading);
    let way = to.at() - from.at();
    (way.x * cos + way.y * sin).abs()
}

/// The median, and the number below which so large a share lies.
pub fn median_and_most(numbers: impl Iterator<Item = f64>, share: f64) -> Option<[f64; 2]> {
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
