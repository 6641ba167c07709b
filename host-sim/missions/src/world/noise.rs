//! How labels are flipped in the simulated world.

use planner_core::{Motion, Noise, Pose, Reading, Reliability, Sample, Tolerance};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::world::World;
use crate::world::on_the_way::Way;
use crate::world::robot::{Glimpse, Robot};

/// How labels are flipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Where labels can be wrong, they are true with this probability.
    pub p: f64,
    /// Where labels can be wrong.
    pub extent: Extent,
}

/// Where labels can be wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// Outside balls of this radius around the oracle's points, metres.
    OutsideBalls(f64),
    /// Within this distance of the boundary, metres (Section II-B's `c_bar`). A planner cannot know this extent.
    Band(f64),
}

impl NoiseModel {
    /// The noise as the planner is configured with it. Of a band it knows only `p`.
    ///
    /// # Panics
    /// Never: a model holds a probability and a radius within the lattice.
    pub fn told(&self, tolerance: Tolerance) -> Noise {
        let radius = match self.extent {
            Extent::OutsideBalls(radius) => radius,
            Extent::Band(_) => 0.0,
        };
        Noise {
            reliability: Reliability::new(self.p).expect("a probability"),
            trusted_radius: Noise::radius(radius).expect("a radius"),
            tolerance,
        }
    }
}

/// A robot whose labels are sometimes flipped: a wrapper around any other.
pub struct Flipped {
    /// The robot.
    pub body: Box<dyn Robot>,
    /// How labels are flipped.
    pub model: NoiseModel,
    /// What it moves in.
    pub world: World,
    /// The oracle's samples.
    pub given: Vec<Sample>,
    /// The random number generator.
    pub rng: ChaCha8Rng,
}

impl Robot for Flipped {
    fn true_pose(&self) -> Option<Pose> {
        self.body.true_pose()
    }

    fn travel(
        &mut self,
        motion: &Motion,
        pose: &mut Pose,
        way: Way,
        pass: &mut dyn FnMut(Glimpse),
    ) -> Option<Reading> {
        self.world.advance();
        let Self { body, model, world, given, rng } = self;
        let mut flipped = |reading, place| {
            let exposed = match model.extent {
                Extent::OutsideBalls(_) => {
                    model.told(Tolerance::NONE).at(place, given) != Reliability::CERTAIN
                }
                Extent::Band(half) => world.distance(place).abs() <= half,
            };
            // Drawn whether it is used or not, so that a path's noise does not depend on its places.
            let flips = rng.random_range(0.0..1.0) >= model.p;
            match reading {
                Reading::Side(label) if exposed && flips => Reading::Side(-label),
                reading => reading,
            }
        };
        let reading = body.travel(motion, pose, way, &mut |it| {
            pass(Glimpse { reading: it.reading.map(|reading| flipped(reading, it.site)), ..it });
        });
        let place = body.true_pose().unwrap_or(*pose).site;
        reading.map(|reading| flipped(reading, place))
    }
}

/// The most bits that a label can carry if it is true with probability `p`: `1 - H(p)`.
pub fn limit(p: f64) -> f64 {
    let term = |p: f64| if p > 0.0 { p * libm::log2(p) } else { 0.0 };
    1.0 + term(p) + term(1.0 - p)
}
