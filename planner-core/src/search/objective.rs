//! The worth of a motion, the choice that follows from it, and the limit on the effort of finding it.

use crate::geometry::hull::Extent;
use crate::geometry::lattice::Site;
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::Pose;

/// The most looks that a plan takes. A look at a ray counts as one. Any other long calculation counts as the number of
/// looks that take as long.
///
/// One look takes up to some 2,000 instructions of a Cortex-M4, so that a plan stays below 20 million. Among many keep-outs
/// a look takes longer, so there are fewer. With the paper's grid, no plan in 3,000 standard missions of 60 steps needed
/// more than 520 rays.
pub const LOOKS: u32 = 9_216;

/// How long a look takes in a rectangle, and how much longer with a side and with a keep-out.
const RECTANGLE: u32 = 64;
const SIDE: u32 = 1;
const KEEP_OUT: u32 = 6;

/// A look on a chart takes as much longer as with so many keep-outs.
const CHART: usize = 4;

/// With so many keep-outs no look takes longer than the longest in a rectangle.
const FEW: usize = 2;

/// The looks that it costs to open a view, where many are opened.
pub(crate) const OPENING: u32 = 2;

/// The weight of the control in the paper's objective, its `varrho`: in [0, 1), to six decimal places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u32", into = "u32"))]
pub struct EffortWeight {
    pub(crate) millionths: u32,
}

const RANGE: ValueError = ValueError("a weight of the control is from 0 to below 1");

impl EffortWeight {
    pub(crate) const ONE: u32 = 1_000_000;

    /// The paper's 0.1.
    pub const PAPER: Self = Self { millionths: 100_000 };

    /// The nearest weight. From 1 on, the objective would reward standing still.
    ///
    /// # Errors
    /// [`ValueError`] outside [0, 1).
    pub fn new(value: f64) -> Result<Self, ValueError> {
        let millionths = libm::round(value * f64::from(Self::ONE));
        let is_weight = value >= 0.0 && millionths < f64::from(Self::ONE);
        is_weight.then_some(Self { millionths: millionths as u32 }).ok_or(RANGE)
    }

    /// The weight as a number.
    pub fn value(self) -> f64 {
        f64::from(self.millionths) / f64::from(Self::ONE)
    }

    /// The objective, in 10^-12 m^2: an integer, so that ties are ties.
    pub(crate) const fn objective(self, reach_mm: u32, effort: u32) -> i64 {
        let reach = reach_mm as i64 * reach_mm as i64;
        let (weight, one) = (self.millionths as i64, Self::ONE as i64);
        (one - weight) * reach - weight * effort as i64
    }
}

/// Millionths.
impl From<EffortWeight> for u32 {
    fn from(EffortWeight { millionths }: EffortWeight) -> Self {
        millionths
    }
}

impl TryFrom<u32> for EffortWeight {
    type Error = ValueError;

    fn try_from(millionths: u32) -> Result<Self, ValueError> {
        (millionths < Self::ONE).then_some(Self { millionths }).ok_or(RANGE)
    }
}

/// A feasible action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Choice {
    /// The action.
    pub action: Action,
    /// The pose after it.
    pub target: Pose,
    /// The objective, in 10^-12 m^2.
    pub objective: i64,
}

/// What searches may still cost, and have cost.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// Looks that may still be taken.
    pub(crate) looks: u32,
    /// Actions whose position was looked at so far.
    pub(crate) examined: u32,
}

impl Effort {
    pub(crate) const fn of(looks: u32) -> Self {
        Self { looks, examined: 0 }
    }

    /// The same in an area: a look takes longer with each side of its border that cuts the rectangle around it, and with
    /// each keep-out.
    pub(crate) fn within<G: Workspace>(area: &G, looks: u32) -> Self {
        let (sides, mut keep_outs) = (area.sides().count(), area.keep_outs().skip(FEW).count());
        keep_outs += area.chart().map_or(0, |_| CHART);
        let takes = RECTANGLE + SIDE * sides as u32 + KEEP_OUT * keep_outs as u32;
        Self::of((looks * RECTANGLE).checked_div(takes).unwrap_or(0))
    }

    /// Keeps back all looks but `all_but`. [`give_back`](Self::give_back) adds them again.
    pub(crate) const fn keep_back(&mut self, all_but: u32) -> u32 {
        let kept = self.looks.saturating_sub(all_but);
        self.looks -= kept;
        kept
    }

    /// Adds looks that were kept back.
    pub(crate) const fn give_back(&mut self, kept: u32) {
        self.looks += kept;
    }

    /// Takes so many looks; whether there were as many.
    pub(crate) const fn take(&mut self, looks: u32) -> bool {
        let is_enough = looks <= self.looks;
        self.looks = self.looks.saturating_sub(looks);
        is_enough
    }

    /// Takes the looks of a [sweep].
    pub(crate) fn take_sweep<G: Workspace>(&mut self, area: &G, hull: &[Site]) -> bool {
        let looks = sweep(area, hull);
        looks == 0 || self.take(looks)
    }

    /// Whether no search has ended for want of looks.
    pub(crate) const fn is_enough(self) -> bool {
        self.looks > 0
    }
}

/// The looks that it costs to see whether a hull touches a keep-out: one for each keep-out nearby, and one for each two
/// of its corners; and one for each four rows of a chart.
pub(crate) fn sweep<G: Workspace>(area: &G, hull: &[Site]) -> u32 {
    let extent = Extent::of(hull);
    let near = area.keep_outs().filter(|it| it.is_near(extent, 0));
    let hulls: u32 = near.map(|it| 1 + it.corners.len() as u32 / 2).sum();
    hulls + area.chart().map_or(0, |it| 1 + it.rows_of(extent) / 4)
}
