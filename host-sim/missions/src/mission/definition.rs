//! What a mission is, and how it is flown in the simulated world.

use std::sync::Arc;

use planner_core::link::message::MissionArea;
use planner_core::link::message::Settings;
use planner_core::{
    AnyReliability, AnySight, AnyVehicle, CellPosterior, Crossing, Following, Front, Goal, Noise,
    NoisyBelief, Policy, Pose, Prior, Reading, Sample, Seeking, Site, UnknownReliability,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::mission::algorithm::Algorithm;
use crate::mission::allowance::{Allowance, ToleranceRecord, tidy};
use crate::mission::asking::Asking;
use crate::mission::bounds::Bounds;
use crate::mission::given::{CAPACITY, Given, Lines};
use crate::mission::lake::Lake;
use crate::mission::terrain::Terrain;
use crate::output::notes;
use crate::world::World;
use crate::world::errors::{CUT, Erring, Errors};
use crate::world::faults::{Failing, Fault};
use crate::world::noise::{Flipped, NoiseModel};
use crate::world::on_the_way::Way;
use crate::world::robot::{Ideal, Robot};

/// Hypotheses that a simulated planner can hold: all that 64 labels can come to.
pub const HYPOTHESES: usize = 2081;

/// The hypothesis table of simulated planners.
pub type Table = CellPosterior<CAPACITY, HYPOTHESES, 15, AnyReliability>;

/// The belief of simulated planners that seek a line from nothing.
pub type SoughtLine = planner_core::Lines<16, 16>;

/// The belief of simulated look-ahead in noise.
pub type DoubtfulBelief = NoisyBelief<CAPACITY, HYPOTHESES, AnyReliability>;

/// Everything that determines a mission.
#[derive(Clone, Debug)]
pub struct Mission {
    /// Who plans.
    pub algorithm: Algorithm,
    /// Steps at most.
    pub steps: u32,
    /// Readings a motion, evenly spread over its length. The last is the label at its end.
    pub readings: u32,
    /// Seed of whatever is random.
    pub seed: u64,
    /// Area, weight of the control, directions of P1 and P2, tolerance.
    pub config: Settings<MissionArea>,
    /// The part of the tolerance that allows for a boundary that bends or moves, and for late labels.
    pub allowance: Allowance,
    /// The map that the area is from.
    pub lake: Option<Arc<Lake>>,
    /// What moves.
    pub vehicle: AnyVehicle,
    /// Where the agent starts.
    pub start: Pose,
    /// What is really there.
    pub world: World,
    /// What the oracle's points and the bounds say.
    pub given: Given,
    /// What is known of the line beside the oracle's points. Its samples are the last ones that are given.
    pub bounds: Bounds,
    /// What an operator or another robot read before the first step. Planners weigh it as their own readings.
    pub read_before: Vec<(Site, Reading)>,
    /// How labels are flipped; `None` when they are true.
    pub noise: Option<NoiseModel>,
    /// How often labels are true, as planners are told, if that is not the `p` of the noise.
    pub p_told: Option<AnyReliability>,
    /// How the robot errs.
    pub errors: Errors,
    /// How the sensor fails, which no planner is told. Later faults act on what earlier ones leave.
    pub sensor: Vec<Fault>,
    /// How hypotheses choose an action together (Algorithm 2).
    pub policy: Policy,
    /// How hypotheses are weighed beforehand (Algorithm 2, look-ahead).
    pub prior: Prior,
    /// What is enough to know, if the mission is to end there (look-ahead).
    pub goal: Option<Goal>,
    /// Whether an audit comes before the goal's promise.
    pub audits: bool,
    /// What labels cost, what they are to bring, and how many there may be.
    pub asking: Asking,
    /// What a planner of fronts is told of the front.
    pub front: Front,
    /// What it is told of a boundary of which nothing is known.
    pub seeking: Seeking,
    /// Metres of front that it watches, if it does not go along all of it.
    pub watch: Option<f64>,
    /// Whether it ends once it has gone round a closed front.
    pub until_closed: bool,
    /// What of the file may be meant otherwise.
    pub doubts: Vec<String>,
}

impl Mission {
    /// The same mission with the paper's algorithms as they are printed: P1 and P2 in any direction that their
    /// slopes allow; in Algorithm 2 the most likely action of each hypothesis's own P1 or P2, as it lists them, and
    /// all label sequences alike beforehand.
    #[must_use]
    pub fn as_printed(mut self) -> Self {
        self.config.crossing = Crossing::Unrestricted;
        self.config.following = Following::Unrestricted;
        (self.policy, self.prior) = (Policy::MixtureOfOwn, Prior::Sequences);
        self
    }

    /// The same mission flown by look-ahead, with its own weight of the control and the unicycle of its own fan.
    #[must_use]
    pub fn by_lookahead(mut self) -> Self {
        self.algorithm = Algorithm::Lookahead;
        (self.config.weight, self.vehicle) =
            (self.algorithm.weight(), self.algorithm.grid().into());
        self
    }

    /// Where motions may go.
    pub fn terrain(&self) -> Terrain {
        Terrain::new(self.config.area, self.lake.as_ref().map(|it| it.chart))
    }

    /// Whether what is known is a distribution over hypotheses.
    pub fn is_noisy(&self) -> bool {
        self.algorithm.weighs(self.noise.is_some())
    }

    /// What a planner is told of the noise.
    pub fn noise_told(&self) -> Noise<AnyReliability> {
        let tolerance = self.config.tolerance;
        let exact = Noise { tolerance, ..Noise::NONE };
        let Noise { reliability, trusted_radius, tolerance } =
            self.noise.map_or(exact, |model| model.told(tolerance));
        let reliability = self.p_told.unwrap_or(reliability.into());
        Noise { reliability, trusted_radius, tolerance }
    }

    /// The same with a reliability that is known; `None` if planners are told a prior.
    pub fn noise_known(&self) -> Option<Noise> {
        let Noise { reliability, trusted_radius, tolerance } = self.noise_told();
        match reliability {
            AnyReliability::Known(reliability) => {
                Some(Noise { reliability, trusted_radius, tolerance })
            }
            AnyReliability::Unknown(_) => None,
        }
    }

    /// The prior of a reliability that planners do not know.
    pub fn unknown_p(&self) -> Option<UnknownReliability> {
        if let Some(AnyReliability::Unknown(prior)) = self.p_told { Some(prior) } else { None }
    }

    /// The table before the first label.
    ///
    /// # Panics
    /// When more than 15 of the oracle's points bound the line. Reading a scenario file refuses that.
    pub fn table(&self) -> Table {
        Table::new(self.given.samples(), self.prior, self.noise_told())
            .expect("15 points bound the line at most")
    }

    /// The belief of look-ahead in noise, before the first label: the table and the columns that predict labels.
    ///
    /// # Panics
    /// As [`table`](Self::table).
    pub fn noisy_belief(&self) -> DoubtfulBelief {
        let mut belief = NoisyBelief::NONE;
        let made = belief.restart(self.given.samples(), self.prior, self.noise_told());
        made.expect("15 points bound the line at most");
        belief
    }

    /// How far the planner takes reported positions to be off, metres: the tolerance without the allowance.
    pub fn position_tolerance(&self) -> f64 {
        let all = self.config.tolerance.metres();
        let Allowance { bend, drift, lag } = self.allowance;
        if self.allowance == Allowance::NONE {
            all
        } else {
            tidy(all - bend - drift - lag).max(0.0)
        }
    }

    /// The tolerance and its parts, if it has any beside that of positions.
    pub fn tolerance_record(&self) -> Option<ToleranceRecord> {
        let record = || ToleranceRecord::of(self.position_tolerance(), &self.allowance);
        (self.allowance != Allowance::NONE).then(record)
    }

    /// Warns of what the file called `name` may not mean.
    pub fn warn(&self, name: &str) {
        self.doubts.iter().cloned().chain(self.warning()).for_each(|why| notes::warn(name, why));
    }

    /// What the planner is told that does not cover the simulated world, where labels are taken to be true: the
    /// positions' part of the tolerance is smaller than the robot's errors, or an oracle's point is so near to the
    /// boundary that its label may be untrue of the straight line.
    fn warning(&self) -> Option<String> {
        if self.is_noisy() || !self.algorithm.seeks_line() {
            return None;
        }
        let (needs, told) = (CUT * self.errors.position, self.position_tolerance());
        if told < needs {
            return Some(format!(
                "tolerance: {told} m with positions that err by up to {needs} m: true labels may be \
                 refused, or cut the true line off"
            ));
        }
        let needs = self.allowance.of_given();
        let samples = self.oracle().iter().enumerate();
        let far = samples.map(|(k, sample)| (k, self.world.distance(sample.site).abs()));
        let (k, near) = far.min_by(|a, b| a.1.total_cmp(&b.1))?;
        (near < needs).then(|| {
            format!(
                "oracle[{k}]: {near:.3} m from the boundary, which may bend and drift by {needs} m: a label so near may \
                 cut the line off that fits best"
            )
        })
    }

    /// The oracle's points.
    pub fn oracle(&self) -> &[Sample] {
        let given = self.given.samples();
        &given[..given.len() - self.bounds.len()]
    }

    /// What the oracle's points leave open, for samples whose positions err by the tolerance at most.
    ///
    /// # Panics
    /// When they bound no lines, or the tolerance is too much for them. Reading a scenario file refuses that.
    pub fn lines(&self) -> Lines {
        let lines = self.given.lines().expect("given points that bound the line");
        let lines = lines.clone().with_tolerance(self.config.tolerance);
        lines.expect("the tolerance leaves something to find")
    }

    /// How far look-ahead looks for labels, what they must carry, and how many there are a motion.
    pub fn sight(&self) -> AnySight {
        let readings = u8::try_from(self.readings).unwrap_or(u8::MAX);
        self.asking.sight().with_readings(readings)
    }

    /// Where its robot reads on the way of a motion.
    pub const fn way(&self) -> Way {
        Way { readings: self.readings, is_arc: matches!(self.vehicle, AnyVehicle::Car(_)) }
    }

    /// The robot, ready to be moved from its start.
    pub fn robot(&self) -> Box<dyn Robot> {
        let rng = |stream| {
            let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
            rng.set_stream(stream); // the random walk has stream 0
            rng
        };
        let world = || self.world.clone();
        let body: Box<dyn Robot> = if self.errors == Errors::default() {
            Box::new(Ideal { world: world() })
        } else {
            Box::new(Erring::new(world(), self.errors, self.start, rng(2)))
        };
        // Each fault has a stream of its own.
        let failing = |body: Box<dyn Robot>, precedes_noise| {
            let faults = (3..).zip(&self.sensor);
            faults
                .filter(|(_, it)| it.precedes_noise() == precedes_noise)
                .fold(body, |body, (stream, fault)| {
                    Box::new(Failing::new(body, *fault, world(), rng(stream)))
                })
        };
        let body = failing(body, true);
        let body: Box<dyn Robot> = if let Some(model) = self.noise {
            let given = self.given.samples().to_vec();
            Box::new(Flipped { body, model, world: world(), given, rng: rng(1) })
        } else {
            body
        };
        failing(body, false)
    }
}
