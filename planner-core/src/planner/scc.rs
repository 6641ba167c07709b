//! Algorithm 2, stochastic control for classification (SCC): noisy labels.
//!
//! As printed, it solves P1 at even steps and P2 at odd steps, and each time makes the most likely action of the
//! policy. Every label updates the distribution over hypotheses. Here steps are counted by labels, so that a turn
//! without a sample does not change the problem. The paper leaves the [`Policy`] open:
//!
//! - [`Joint`](Policy::Joint): P3 and P4 as printed, over all retained hypotheses at once.
//! - [`MixtureOfStart`](Policy::MixtureOfStart): Equation 9. Each hypothesis votes for its own best action with its
//!   posterior weight. As in P3 and P4, it is restricted by the starting regions of certainty.
//! - [`MixtureOfOwn`](Policy::MixtureOfOwn): the same, but each hypothesis is restricted by its own regions of
//!   certainty as in P1 and P2. Algorithm 2 lists this policy. It learns the most, so it is the default.
//!
//! The policies were compared over 2,000 standard fields at `p = 0.7`. Thirty labels carry at most 3.56 bits:
//!
//! | policy | bits learnt |
//! | --- | --- |
//! | `MixtureOfOwn`, P2 as printed ([`Options::SCC`]) | 2.18 |
//! | `MixtureOfOwn`, P2 along the bisector | 2.08 |
//! | `Joint` | 1.53 |
//! | `MixtureOfStart` | 1.43 |
//! | a random walk | 0.76 |
//!
//! When no hypothesis has a feasible action, the recovery ladder climbs on the starting ground.

use heapless::Vec;

use crate::belief::Belief as _;
use crate::belief::ObservationError;
use crate::belief::cells::CellView;
use crate::belief::doubtful_labels::{CellPosterior, Hypothesis};
use crate::belief::noise::Noise;
use crate::belief::observation_log::{FromLog as _, ObservationLog};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Reading, Sample};
use crate::belief::tolerance::Tolerance;
use crate::belief::trust::Trust;
use crate::belief::weight::Prior;
use crate::geometry::area::Area;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose};
use crate::planner::options::{Options, first_to_second};
use crate::planner::setup::{Restart, SetupError, aimed_for, aimed_for_by};
use crate::planner::silence::Silence;
use crate::planner::snapshot::{Kind, Persist, RestoreError, Snapshot, mark};
use crate::planner::vote::Ballot;
use crate::planner::{Motion, Plan, Planner, Stage, StopReason};
use crate::search::course::Course;
use crate::search::dead_end::DeadEnd;
use crate::search::direction_rule::{ArcRule, ArcUnion, DirectionRule, UnionRule};
use crate::search::objective::{Effort, LOOKS, OPENING};
use crate::search::problem::Problem;
use crate::search::recovery::{Found, Recovery, solve_or_recover};

/// How the hypotheses choose an action together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Policy {
    /// One problem, P3 or P4, whose rule looks at the slopes of all hypotheses.
    Joint,
    /// A vote among each hypothesis's own P3 or P4, on the ground that was uncertain at the start.
    MixtureOfStart,
    /// A vote among each hypothesis's own P1 or P2, on the ground that is uncertain to it.
    #[default]
    MixtureOfOwn,
}

/// Algorithm 2 for `D`'s dynamics, with room for `N` samples, the given ones included, and `H`
/// hypotheses.
#[derive(Clone, Debug)]
pub struct Scc<D, const N: usize, const H: usize, G = Area, R: Trust = Reliability> {
    /// Where motions aim for.
    area: G,
    options: Options,
    policy: Policy,
    dynamics: D,
    hypotheses: CellPosterior<N, H, 15, R>,
    /// Whether the number of labels that were read on the way of motions is odd. They do not count for the turns of
    /// P3 and P4.
    is_odd_on_the_way: bool,
    silence: Silence,
}

impl<D: Dynamics, const N: usize, const H: usize, G: Workspace, R: Trust> Scc<D, N, H, G, R> {
    /// A planner over a table of hypotheses, whose prior weighs their votes. It has [`Options::SCC`] and
    /// [`Policy::MixtureOfOwn`].
    ///
    /// # Errors
    /// [`SetupError`].
    #[inline] // it is made where it stays, as it may be large
    pub fn new(
        area: G,
        dynamics: D,
        hypotheses: CellPosterior<N, H, 15, R>,
    ) -> Result<Self, SetupError> {
        let area = aimed_for_by(area, &dynamics, &hypotheses)?;
        Ok(Self::of((area, dynamics), hypotheses, Options::SCC, Policy::default()))
    }

    /// The same in the part of an area that motions aim for, with all that can be chosen. A planner may be large, and a
    /// chip has no room for a copy of it.
    #[inline]
    pub(crate) fn of(
        (area, dynamics): (G, D),
        hypotheses: CellPosterior<N, H, 15, R>,
        options: Options,
        policy: Policy,
    ) -> Self {
        let (is_odd_on_the_way, silence) = (false, Silence::NONE);
        Self { area, options, policy, dynamics, hypotheses, is_odd_on_the_way, silence }
    }

    /// The same with other options.
    #[must_use]
    #[inline]
    pub fn with(self, options: Options) -> Self {
        Self { options, ..self }
    }

    /// The same with another way to choose an action.
    #[must_use]
    #[inline]
    pub fn voting(self, policy: Policy) -> Self {
        Self { policy, ..self }
    }

    fn is_even(&self) -> bool {
        self.hypotheses.taken().is_multiple_of(2) != self.is_odd_on_the_way
    }

    /// The problem of a hypothesis: where it votes to go.
    pub fn problem<'a>(&'a self, hypothesis: &'a Hypothesis<15, R>) -> Problem<'a, ArcRule, G> {
        let own = self.hypotheses.lines(hypothesis);
        let ground = match self.policy {
            Policy::MixtureOfOwn => own,
            Policy::Joint | Policy::MixtureOfStart => self.hypotheses.start(),
        };
        let arc = own.slope_arc();
        let rule = if self.is_even() {
            self.options.crossing_rule(arc, first_to_second(self.hypotheses.given()))
        } else {
            self.options.following_rule(arc)
        };
        self.on(ground, rule)
    }

    fn on<'a, T>(&self, lines: CellView<'a>, rule: T) -> Problem<'a, T, G> {
        Problem { lines, area: self.area, weight: self.options.weight, rule }
    }

    /// Equation 9: the action with the most votes, and of equals the one of smallest index.
    ///
    /// The heaviest hypotheses are asked first, then those at least half as heavy, and so on, until the
    /// others cannot change the outcome.
    fn elect(&self, pose: Pose, effort: &mut Effort) -> Option<Action> {
        const { assert!(H < 1 << 12, "a table's votes are counted in 32 bits") };
        let weights = || self.hypotheses.iter().map(Hypothesis::weight);
        let heaviest = weights().max()?;
        // As many votes as hypotheses: nothing is refused.
        let mut votes: Vec<u32, H, u16> = Vec::new();
        for weight in weights() {
            let _ = votes.push(weight.votes(heaviest));
        }
        let mut ballot: Ballot<H> = Ballot::new(votes.iter().sum());
        let (mut asked_down_to, mut least) = (u32::MAX, votes.iter().copied().max()?);
        while asked_down_to > 1 && effort.is_enough() {
            for (hypothesis, &votes) in self.hypotheses.iter().zip(&votes) {
                if votes < least || votes >= asked_down_to {
                    continue;
                }
                effort.take(OPENING);
                let best = self.problem(hypothesis).find(effort, &self.dynamics, pose);
                ballot.cast(votes, best.map(|best| best.action));
                if best.is_some() && ballot.is_decided() {
                    return ballot.winner();
                }
            }
            (asked_down_to, least) = (least, (least / 2).max(1));
        }
        ballot.winner()
    }

    fn find(&self, pose: Pose, effort: &mut Effort, course: &mut Course) -> Result<Found, DeadEnd> {
        if self.policy == Policy::Joint {
            // P3 and P4 as printed: travel in no retained hypothesis's slopes, or in some one's.
            let slopes = self.hypotheses.iter().map(|h| self.hypotheses.lines(h).slope_arc());
            let slopes: ArcUnion = slopes.collect();
            let rule = UnionRule { arcs: slopes.arcs(), among: !self.is_even() };
            return self.find_on_start(rule, pose, effort, course);
        }
        // The rest is for the ladder.
        let kept = effort.keep_back(effort.looks / 2);
        let elected = self.elect(pose, effort);
        effort.give_back(kept);
        let elected = elected.and_then(|action| {
            let target = self.dynamics.target(pose, action)?;
            Some(Found::of(None, (action, target)))
        });
        elected.map_or_else(
            || {
                let found = self.find_on_start(ArcRule::default(), pose, effort, course)?;
                let recovery = found.recovery.or(Some(Recovery::Undirected));
                Ok(Found { recovery, ..found })
            },
            Ok,
        )
    }

    /// The best action on the ground that was uncertain at the start, or the ladder's.
    fn find_on_start(
        &self,
        rule: impl DirectionRule,
        pose: Pose,
        effort: &mut Effort,
        course: &mut Course,
    ) -> Result<Found, DeadEnd> {
        let problem = self.on(self.hypotheses.start(), rule);
        let mut search = problem.search(&self.dynamics, pose, *effort);
        let search = search.open();
        let found = solve_or_recover(&problem, search, None, course);
        *effort = search.effort;
        found
    }
}

impl<D: Dynamics, const N: usize, const H: usize, G: Workspace, R: Trust> Planner
    for Scc<D, N, H, G, R>
{
    type Belief = CellPosterior<N, H, 15, R>;

    fn plan(&mut self, pose: Pose) -> Plan {
        if self.hypotheses.is_full() {
            return Plan::Stop(StopReason::SamplesFull);
        }
        let stage = match (self.policy, self.is_even()) {
            (Policy::MixtureOfOwn, true) => Stage::P1,
            (Policy::MixtureOfOwn, false) => Stage::P2,
            (_, true) => Stage::P3,
            (_, false) => Stage::P4,
        };
        let mut effort = Effort::within(&self.area, LOOKS);
        let mut course = self.silence.course();
        match self.find(pose, &mut effort, &mut course) {
            Ok(found) => {
                let motion = Motion::of(Some(stage), pose, &found, &self.dynamics, effort);
                self.silence.keep(pose, motion, course, &self.dynamics)
            }
            Err(dead_end) => Plan::Stop(dead_end.into()),
        }
    }

    fn observe_within(
        &mut self,
        pose: Pose,
        reading: Option<Reading>,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        if let Some(reading) = reading {
            self.hypotheses.observe_within(pose.site, reading, tolerance)?;
        }
        self.silence.observe(reading.is_some());
        Ok(())
    }

    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let is_kept = self.hypotheses.observe_on_the_way(site, reading)?;
        if is_kept {
            self.is_odd_on_the_way = !self.is_odd_on_the_way;
            self.silence.hear();
        }
        Ok(is_kept)
    }

    fn belief(&self) -> &CellPosterior<N, H, 15, R> {
        &self.hypotheses
    }
}

impl<D: Dynamics, const N: usize, const H: usize, G: Workspace> Restart for Scc<D, N, H, G> {
    const ROOM: [usize; 2] = [N, H];

    fn restart(&mut self, given: &[Sample], prior: Prior, noise: Noise) -> Result<(), SetupError> {
        let area = aimed_for(self.area, &self.dynamics, noise.tolerance)?;
        self.hypotheses.restart(given, prior, noise)?;
        (self.area, self.is_odd_on_the_way, self.silence) = (area, false, Silence::NONE);
        Ok(())
    }
}

impl<D: Dynamics, const N: usize, const H: usize, G: Workspace, R: Trust> Persist
    for Scc<D, N, H, G, R>
{
    type Snapshot = Snapshot<ObservationLog<N>, (Silence, bool)>;

    fn snapshot(&self) -> Self::Snapshot {
        let mark = mark(Kind::Scc, (&self.dynamics, &self.area), self.hypotheses.mark());
        Snapshot::new(mark, self.hypotheses.log(), (self.silence, self.is_odd_on_the_way))
    }

    fn restore(&mut self, snapshot: &Self::Snapshot) -> Result<(), RestoreError> {
        let mark = mark(Kind::Scc, (&self.dynamics, &self.area), self.hypotheses.mark());
        let (log, &(silence, is_odd_on_the_way)) = snapshot.open(mark)?;
        self.hypotheses.replay(log)?;
        (self.silence, self.is_odd_on_the_way) = (silence, is_odd_on_the_way);
        Ok(())
    }
}
