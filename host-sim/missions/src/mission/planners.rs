//! The planner of a mission, whichever belief it has.

use planner_core::dynamics::Dynamics;
use planner_core::error::ObservationError;
use planner_core::watch::Alarm;
use planner_core::{
    Accuracy, AnyReliability, AnySight, AnyVehicle, Cfc, FrontState, FrontStretch, Guard,
    Lookahead, Plan, Planner, Pose, PredictiveBelief, Reading, Scc, Site, Tolerance, Track, Trust,
    Workspace,
};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use crate::mission::algorithm::Algorithm;
use crate::mission::baseline::{Baseline, Ground, Strategy};
use crate::mission::chords::{self, Chords};
use crate::mission::definition::{DoubtfulBelief, HYPOTHESES, Mission};
use crate::mission::from_nothing::FromNothing;
use crate::mission::given::{CAPACITY, Lines};
use crate::mission::lawnmower::Lawnmower;
use crate::mission::margin::Margin;
use crate::mission::random_walk::RandomWalk;
use crate::mission::read_out::{AnyPlanner, ReadOut};

/// Why a constructor cannot refuse a mission's settings.
const FITS: &str = "settings that contradict each other were refused";

/// A planner, with the type of its belief forgotten.
struct Erased<P>(P);

impl<P: Planner<Belief: ReadOut + Sized + 'static>> Planner for Erased<P> {
    type Belief = dyn ReadOut;

    fn plan(&mut self, pose: Pose) -> Plan {
        self.0.plan(pose)
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.0.observe_within(pose, reading, tolerance)
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        self.0.observe_on_the_way(site, reading)
    }

    fn belief(&self) -> &(dyn ReadOut + 'static) {
        self.0.belief()
    }

    fn alarm(&self) -> Option<Alarm> {
        self.0.alarm()
    }

    fn front(&self) -> Option<FrontState> {
        self.0.front()
    }
}

fn erased(
    planner: impl Planner<Belief: ReadOut + Sized + 'static> + Send + Sync + 'static,
) -> AnyPlanner {
    Box::new(Erased(planner))
}

impl Mission {
    /// The planner before the first step.
    ///
    /// # Panics
    /// When settings contradict each other. Reading scenario files and flags refuses such settings.
    pub fn planner(&self) -> AnyPlanner {
        self.planner_told(&mut |_, _, _| ())
    }

    /// The same; `hear` is told each reading of others, and what was known before it.
    pub(crate) fn planner_told(
        &self,
        hear: &mut dyn FnMut(&dyn ReadOut, Site, Reading),
    ) -> AnyPlanner {
        let mut planner = self.fresh_planner();
        for &(site, reading) in &self.read_before {
            hear(planner.belief(), site, reading);
            let taken = planner.observe(Pose { site, ..self.start }, Some(reading));
            taken.expect("readings that were tried");
        }
        planner
    }

    /// The same mission after readings of others, beside those that it has.
    ///
    /// # Errors
    /// The number of a reading that contradicts what is known or finds no room, and why.
    pub fn having_read(
        mut self,
        read: &[(Site, Reading)],
    ) -> Result<Self, (usize, ObservationError)> {
        let mut planner = self.planner();
        for (k, &(site, reading)) in read.iter().enumerate() {
            let taken = planner.observe(Pose { site, ..self.start }, Some(reading));
            taken.map_err(|why| (k, why))?;
        }
        self.read_before.extend_from_slice(read);
        Ok(self)
    }

    /// The planner without a label.
    pub(crate) fn fresh_planner(&self) -> AnyPlanner {
        let (area, dynamics) = (self.terrain(), self.vehicle);
        match self.algorithm {
            _ if self.begins_from_nothing() && self.algorithm != Algorithm::Lawnmower => {
                Box::new(FromNothing::new(self, dynamics, Self::fresh_planner))
            }
            Algorithm::Cfc => erased(self.cfc(area, dynamics)),
            Algorithm::Scc => erased(self.scc(area, dynamics)),
            Algorithm::Lookahead if self.is_noisy() => erased(self.doubtful(area, dynamics)),
            Algorithm::Lookahead => erased(self.lookahead(area, dynamics)),
            Algorithm::Chords => {
                let ends = chords::ends(self.oracle()).expect(FITS);
                let p = self.noise_told().reliability.nominal().probability();
                let most = (self.steps, self.asking.labels);
                self.baseline(Chords::new(ends, p, self.start.site, most))
            }
            Algorithm::Margin => self.baseline(Margin),
            Algorithm::Random => self.baseline(RandomWalk(ChaCha8Rng::seed_from_u64(self.seed))),
            Algorithm::Lawnmower => {
                let of = (&area, &dynamics);
                let mower = Lawnmower::new(of, self.start, self.steps, self.asking.labels);
                self.baseline(mower)
            }
            Algorithm::Track => match self.watch {
                Some(metres) => erased(self.guard(area, dynamics, metres)),
                None => erased(self.track(area, dynamics)),
            },
        }
    }

    /// What is known before the first step.
    ///
    /// # Panics
    /// As [`planner`](Self::planner).
    pub fn belief(&self) -> Box<dyn ReadOut> {
        if self.read_before.is_empty() {
            self.fresh_belief()
        } else {
            self.planner().belief().boxed()
        }
    }

    /// What is known without a label.
    pub(crate) fn fresh_belief(&self) -> Box<dyn ReadOut> {
        match () {
            () if !self.algorithm.seeks_line() => {
                Box::new(self.track(self.terrain(), self.vehicle).belief().clone())
            }
            () if self.begins_from_nothing() => Box::new(self.sought()),
            () if self.is_noisy() => Box::new(self.table()),
            () => Box::new(self.lines()),
        }
    }

    fn baseline(&self, strategy: impl Strategy<AnyVehicle> + Send + Sync + 'static) -> AnyPlanner {
        let (dynamics, area) = (self.vehicle, self.terrain());
        Box::new(Baseline {
            strategy,
            ground: Ground { dynamics, area, belief: self.fresh_belief() },
        })
    }

    /// The follower of fronts with the mission's settings.
    ///
    /// # Panics
    /// When settings contradict each other.
    pub fn track<D: Dynamics, G: Workspace>(&self, area: G, dynamics: D) -> Track<D, G> {
        let planner = Track::new(area, dynamics, self.front, self.noise_told()).expect(FITS);
        let planner = planner.seeking(self.seeking).expect(FITS).knowing(self.given.samples());
        if self.until_closed { planner.until_closed() } else { planner }
    }

    /// The same, but it watches so many metres of the front.
    ///
    /// # Panics
    /// When settings contradict each other.
    pub fn guard<D: Dynamics, G: Workspace>(
        &self,
        area: G,
        dynamics: D,
        metres: f64,
    ) -> Guard<D, G> {
        let stretch = FrontStretch::metres(metres).expect("a length that was checked");
        let told = (self.front, stretch);
        let guard = Guard::watching(area, dynamics, told, self.noise_told()).expect(FITS);
        guard.seeking(self.seeking).expect(FITS).knowing(self.given.samples())
    }

    /// The half-width below which the front counts as found, metres; `None` if the planner seeks a line.
    pub fn found_width(&self) -> Option<f32> {
        let (area, vehicle) = (self.terrain(), self.vehicle);
        (!self.algorithm.seeks_line()).then(|| self.track(area, vehicle).width())
    }

    /// Algorithm 1 with the mission's settings, in an area and with a vehicle that may be others than its own.
    ///
    /// # Panics
    /// When settings contradict each other.
    pub fn cfc<D: Dynamics, G: Workspace>(&self, area: G, dynamics: D) -> Cfc<D, CAPACITY, G> {
        Cfc::new(area, dynamics, self.lines()).expect(FITS).with(self.config.options())
    }

    /// The same by Algorithm 2.
    ///
    /// # Panics
    /// As [`cfc`](Self::cfc).
    pub fn scc<D: Dynamics, G: Workspace>(
        &self,
        area: G,
        dynamics: D,
    ) -> Scc<D, CAPACITY, HYPOTHESES, G, AnyReliability> {
        let planner = Scc::new(area, dynamics, self.table()).expect(FITS);
        planner.with(self.config.options()).voting(self.policy)
    }

    /// The same by look-ahead, with labels that are true.
    ///
    /// # Panics
    /// As [`cfc`](Self::cfc).
    pub fn lookahead<D: Dynamics, G: Workspace>(
        &self,
        area: G,
        dynamics: D,
    ) -> Lookahead<D, Lines, G, Accuracy, AnySight> {
        self.looking_ahead(area, dynamics, self.lines())
    }

    /// The same by look-ahead, with labels that may be wrong.
    ///
    /// # Panics
    /// As [`cfc`](Self::cfc).
    pub fn doubtful<D: Dynamics, G: Workspace>(
        &self,
        area: G,
        dynamics: D,
    ) -> Lookahead<D, DoubtfulBelief, G, Accuracy, AnySight> {
        self.looking_ahead(area, dynamics, self.noisy_belief())
    }

    fn looking_ahead<D: Dynamics, B: PredictiveBelief, G: Workspace>(
        &self,
        area: G,
        dynamics: D,
        belief: B,
    ) -> Lookahead<D, B, G, Accuracy, AnySight> {
        let planner = Lookahead::new(area, dynamics, belief).expect(FITS);
        let planner = planner.seeing(self.sight()).pricing(self.config.price()).until(self.goal);
        if self.audits { planner } else { planner.without_audit() }
    }
}
