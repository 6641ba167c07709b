//! How a front may go between two samples that differ, by all samples that are given.
//!
//! It crosses the way from one to the other anywhere, in any direction. A few such lines are weighed by all samples. Those
//! further off count less, as the front may bend on the way there.

use crate::belief::curve::gaussian::BEND;
use crate::belief::curve::normal::Normal;
use crate::belief::front::{Unit, angle, metres};
use crate::belief::sample::{Label, Sample};
use crate::geometry::approximate::{METRE, distance, heading_of, sqrt};
use crate::geometry::heading::{Angle, Heading};
use crate::geometry::lattice::{Site, Vector};

/// Directions to either side of the most likely one, and places on either side of the middle.
const TURNS: i32 = 7;
const PLACES: i32 = 3;

/// From one direction to the next, radians.
const TURN: f32 = 1.4 / TURNS as f32;

/// A sample blurs where the front is by this at least, reaches.
const BLUR: f32 = 0.05;

/// Labels that are false with a higher chance than this are doubtful. The front may lie so many times further off then.
const DOUBTFUL: f32 = 0.01;
const WIDER: f32 = 3.0;

/// A deviation is no less than the root of this, in reaches or radians.
const LEAST: f32 = 1e-4;

/// Where and how a front begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrontStart {
    pub(crate) site: Site,
    /// Its +1 side is to the left.
    pub(crate) heading: Heading,
    /// The deviations of offset and direction; the former in reaches.
    pub(crate) deviation: [f32; 2],
}

impl FrontStart {
    /// Across the way from one site to another. The +1 side is where more of the labels are +1.
    pub(crate) fn across([from, to]: [Site; 2], labels: &[Sample], errs: f32, reach: f32) -> Self {
        let middle = Site::between(from, to);
        let sign = |it: &Sample| {
            let way = (it.site - middle).dot(to - from);
            if (it.label == Label::Positive) == (way > 0) { 1 } else { -1 }
        };
        let rises: i32 = labels.iter().map(sign).sum();
        let [plus, minus] = if rises > 0 { [to, from] } else { [from, to] };
        let way = plus - minus;
        // A false label beside the front shifts where labels seem to change.
        let wider = if errs > DOUBTFUL { WIDER } else { 1.0 };
        let gap = wider * distance(way) * METRE / reach;
        let heading = heading_of(way).turned(Angle(0_u32.wrapping_sub(1 << 30)));
        let along = Unit::of(heading);
        let (mut sum, mut first, mut second) = (0.0, [0.0_f32; 2], [0.0_f32; 2]);
        for k in -TURNS..=TURNS {
            let turn = k as f32 * TURN;
            let Unit { x: cos, z: sin } = Unit::of(Heading(angle(turn).0));
            for n in -PLACES..=PLACES {
                let offset = n as f32 / (2 * PLACES + 1) as f32 * gap;
                let mut weight = cos;
                for sample in labels {
                    let [x, z] = along.seen(metres(sample.site - middle)).map(|it| it / reach);
                    let [ahead, left] = Unit { x: cos, z: sin }.seen([x, z - offset]);
                    let bulge = 0.5 * BEND * ahead * ahead;
                    let sign = if sample.label == Label::Positive { 1.0 } else { -1.0 };
                    let is_so = Normal::below(sign * left / (bulge + BLUR));
                    weight *= errs + (1.0 - 2.0 * errs) * is_so;
                }
                sum += weight;
                for ((first, second), it) in
                    first.iter_mut().zip(&mut second).zip([offset * cos, turn])
                {
                    *first += weight * it;
                    *second += weight * it * it;
                }
            }
        }
        let each = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let [offset, turn] = first.map(|it| it * each);
        let [offsets, turns] = second.map(|it| it * each);
        let deviation = [offsets - offset * offset, turns - turn * turn]
            .map(|it| sqrt(if it > LEAST { it } else { LEAST }));
        let heading = heading.turned(angle(turn));
        let Unit { x, z } = Unit::of(heading);
        let units = offset * reach / METRE;
        let site = middle.step(Vector { x: (-z * units) as i32, z: (x * units) as i32 });
        Self { site: site.unwrap_or(middle), heading, deviation }
    }
}

/// Those two samples that differ and are the nearest to each other; `None` if none differ.
pub(crate) fn nearest_pair(given: &[Sample]) -> Option<[Site; 2]> {
    let of = |label| given.iter().filter(move |it| it.label == label).map(|it| it.site);
    let pairs = of(Label::Positive).flat_map(|plus| of(Label::Negative).map(move |it| [plus, it]));
    let length = |[plus, minus]: &[Site; 2]| {
        let way = *plus - *minus;
        way.dot(way)
    };
    pairs.min_by_key(length)
}
