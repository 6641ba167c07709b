//! What reports and campaigns read of a belief, beside what every planner asks of it.

use std::fmt::Debug;

use planner_core::{
    AnyReliability, Area, Belief, Curve, Goal, Label, MapPlace, Planner, PosteriorView,
    Reliability, Sample, Site, Tolerance, Waist,
};

use crate::mission::definition::{SoughtLine, Table};
use crate::mission::given::Lines;
use crate::world::noise::limit;

/// The level of the credible sets that are reported.
pub const LEVEL: f64 = 0.9;

/// Of a Gaussian [`LEVEL`] lies within so many deviations.
const DEVIATIONS: f64 = 1.645;

/// What is known after some step, in figures.
#[derive(Clone, Debug)]
pub struct Knowledge {
    /// The slopes left, as intervals of degrees: of all lines that agree with the labels, or of the
    /// credible set.
    pub slope_arcs: Vec<[f64; 2]>,
    /// The intercepts left, metres; `None` when unbounded.
    pub intercept: Option<[f64; 2]>,
    /// Bits learnt since the start.
    pub bits: f64,
    /// The distribution over hypotheses, where labels may err.
    pub doubt: Option<Doubt>,
}

/// A distribution over hypotheses, in figures.
#[derive(Clone, Copy, Debug)]
pub struct Doubt {
    /// Number of hypotheses.
    pub hypotheses: usize,
    /// The probability given up as the table was full, at most.
    pub pruned_mass: f64,
    /// Entropy over the hypotheses, bits.
    pub entropy: f64,
}

/// What is expected of a label before it is read.
#[derive(Clone, Copy, Debug)]
pub struct Expectation {
    /// The chance that it is +1.
    pub chance: f64,
    /// Bits, on average.
    pub bits: f64,
}

impl Expectation {
    /// No label tells less than nothing on average: what is below that is rounded.
    fn of(chance: f64, bits: f64) -> Self {
        Self { chance, bits: if bits > 0.0 { bits } else { 0.0 } }
    }
}

/// A planner whose belief can be read out.
pub type AnyPlanner = Box<dyn Planner<Belief = dyn ReadOut> + Send + Sync>;

/// A belief that can be read out.
pub trait ReadOut: Belief + Debug + Send + Sync {
    /// What is known, in figures.
    fn knowledge(&self) -> Knowledge;

    /// What is expected of a label at a site, by the exact distribution.
    fn expects(&self, site: Site) -> Expectation;

    /// Whether it [meets](Belief::meets) a goal. A front goes on, and meets none.
    fn reaches(&self, _: Goal, _: Area) -> bool {
        false
    }

    /// All samples that it keeps, with the labels that were taken in, the given ones first. A front keeps none.
    fn samples(&self) -> &[Sample] {
        &[]
    }

    /// The lines that agree with every label, where these are true.
    fn version_space(&self) -> Option<&Lines> {
        None
    }

    /// The front, where one is followed.
    fn front(&self) -> Option<&Curve> {
        None
    }

    /// The line, where it is sought from nothing and not yet found.
    fn sought(&self) -> Option<&SoughtLine> {
        None
    }

    /// The hypotheses, where labels may err.
    fn hypotheses(&self) -> Option<&Table> {
        None
    }

    /// A copy.
    fn boxed(&self) -> Box<dyn ReadOut>;
}

impl Clone for Box<dyn ReadOut> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}

/// Places that the map of a front has more when the mission ends, the oldest first.
pub fn rest(front: &Curve) -> Vec<MapPlace> {
    let mut rest: Vec<_> = front.places().collect();
    rest.reverse();
    rest
}

impl ReadOut for Curve {
    fn knowledge(&self) -> Knowledge {
        let waist = self.now();
        let half = DEVIATIONS * f64::from(waist.turn_deviation).to_degrees();
        let slopes = || slopes_about(waist.heading.radians().to_degrees(), half);
        let slope_arcs = if self.is_begun() { slopes() } else { vec![[-90.0, 90.0]] };
        let bits = if self.is_begun() { self.information() } else { 0.0 };
        Knowledge { slope_arcs, intercept: None, bits, doubt: None }
    }

    fn expects(&self, site: Site) -> Expectation {
        let chance = self.chance(site);
        Expectation::of(chance, limit(self.reliability().into()) - limit(chance))
    }

    fn front(&self) -> Option<&Curve> {
        Some(self)
    }

    fn boxed(&self) -> Box<dyn ReadOut> {
        Box::new(self.clone())
    }
}

impl ReadOut for Lines {
    fn knowledge(&self) -> Knowledge {
        Knowledge {
            slope_arcs: self.slope_arc().intervals_deg().to_vec(),
            intercept: self.intercepts(),
            bits: self.information(),
            doubt: None,
        }
    }

    fn expects(&self, site: Site) -> Expectation {
        let chance = self.chance(site);
        // A true label says which of two parts of the lines is left, and carries the entropy of that division.
        let is_exact = self.tolerance() == Tolerance::NONE;
        let bits = if is_exact { 1.0 - limit(chance) } else { mean_told(self, site, chance) };
        Expectation::of(chance, bits)
    }

    fn reaches(&self, goal: Goal, area: Area) -> bool {
        self.meets(goal, area)
    }

    fn samples(&self) -> &[Sample] {
        self.samples()
    }

    fn version_space(&self) -> Option<&Lines> {
        Some(self)
    }

    fn boxed(&self) -> Box<dyn ReadOut> {
        Box::new(self.clone())
    }
}

impl ReadOut for SoughtLine {
    fn knowledge(&self) -> Knowledge {
        let slopes = || {
            let Waist { heading, turn_deviation, .. } = self.waist();
            let half = DEVIATIONS * f64::from(turn_deviation).to_degrees();
            slopes_about(heading.radians().to_degrees(), half)
        };
        let slope_arcs = if self.is_open() { vec![[-90.0, 90.0]] } else { slopes() };
        Knowledge { slope_arcs, intercept: None, bits: self.information(), doubt: None }
    }

    fn expects(&self, site: Site) -> Expectation {
        let chance = self.chance(site);
        Expectation::of(chance, limit(self.reliability().into()) - limit(chance))
    }

    fn sought(&self) -> Option<&SoughtLine> {
        Some(self)
    }

    fn boxed(&self) -> Box<dyn ReadOut> {
        Box::new(self.clone())
    }
}

/// Directions within so many degrees of one, as intervals of slopes.
fn slopes_about(angle: f64, half: f64) -> Vec<[f64; 2]> {
    if half >= 90.0 {
        return vec![[-90.0, 90.0]];
    }
    let middle = angle - (angle / 180.0).round() * 180.0;
    let (from, to) = (middle - half, middle + half);
    match () {
        () if from < -90.0 => vec![[-90.0, to], [from + 180.0, 90.0]],
        () if to > 90.0 => vec![[-90.0, to - 180.0], [from, 90.0]],
        () => vec![[from, to]],
    }
}

impl ReadOut for Table {
    fn knowledge(&self) -> Knowledge {
        let posterior = PosteriorView::new(self);
        let credible = posterior.credible(LEVEL);
        Knowledge {
            slope_arcs: credible.slope_arc.intervals_deg().to_vec(),
            intercept: credible.intercept,
            bits: posterior.information(),
            doubt: Some(Doubt {
                hypotheses: self.iter().len(),
                pruned_mass: posterior.pruned_mass(),
                entropy: posterior.entropy(),
            }),
        }
    }

    fn expects(&self, site: Site) -> Expectation {
        let chance = self.chance(site);
        let is_exact = self.noise().tolerance == Tolerance::NONE;
        let is_trusted = self.reliability(site) == Reliability::CERTAIN;
        let bits = if is_exact && is_unknown(self) && !is_trusted {
            // Each hypothesis has a reliability of its own.
            let posterior = PosteriorView::new(self);
            let of = |h| posterior.probability(h) * limit(self.agreement(h));
            self.iter().map(of).sum::<f64>() - limit(chance)
        } else if is_exact {
            limit(self.reliability(site).probability()) - limit(chance)
        } else {
            mean_told(self, site, chance)
        };
        Expectation::of(chance, bits)
    }

    fn reaches(&self, goal: Goal, area: Area) -> bool {
        self.meets(goal, area)
    }

    fn samples(&self) -> &[Sample] {
        self.samples()
    }

    fn hypotheses(&self) -> Option<&Table> {
        Some(self)
    }

    fn boxed(&self) -> Box<dyn ReadOut> {
        Box::new(self.clone())
    }
}

/// Whether nobody knows how reliable labels are.
pub fn is_unknown(table: &Table) -> bool {
    matches!(table.noise().reliability, AnyReliability::Unknown(_))
}

/// The mean information of the two possible labels where positions err. A copy of the belief takes each in; one that it
/// refuses carries none.
fn mean_told(known: &(impl Belief + Clone), site: Site, chance: f64) -> f64 {
    let now = known.information();
    let after = |label: Label| {
        let mut after = known.clone();
        after.observe(site, label.into()).map_or(now, |()| after.information())
    };
    let [above, below] = [Label::Positive, Label::Negative].map(after);
    chance * above + (1.0 - chance) * below - now
}
