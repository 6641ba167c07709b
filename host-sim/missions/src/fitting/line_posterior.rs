//! The distribution over all lines through the ground of a record, when its labels may be wrong.
//!
//! Before any label, all lines that cross the ground are equally likely by the measure of lines, whichever of their
//! sides is +1. The plane of lines is halved again and again, best first. All lines of a box have most positions on the
//! same side, so the labels of these are settled. The other labels bound the box's weight from above.
//!
//! A box that few positions cut is cut along them, exactly. Where positions err, a box is done when the neglected part
//! of its weight is small. The search ends when all remaining boxes together weigh some millionths, and this weight is
//! reported. So the work depends on how much the labels leave open, and hardly on how many labels there are.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Point2, Vector2};
use planner_core::Label;

use crate::fitting::doubt::{Doubt, Votes};
use crate::fitting::patch::{Mass, Patch, Quarter};
use crate::world::polygon::Polygon;

/// A patch of lines that explain the labels about equally well.
#[derive(Clone, Debug)]
pub struct Cell {
    /// The lines of it.
    pub patch: Patch,
    /// The logarithm of what the labels say of its lines.
    pub log: f64,
    /// The probability of its lines by the labels, and their integrals.
    pub mass: Mass,
}

/// The distribution.
#[derive(Debug)]
pub struct LinePosterior {
    /// The most likely lines first; their measures add up to 1.
    pub cells: Vec<Cell>,
    /// What has been left out, as a share of all, at most.
    pub pruned_mass: f64,
}

/// Why there is no distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooOpen {
    /// More cells than this.
    Cells(usize),
    /// More work than this, positions by boxes.
    Work(u64),
    /// No line agrees with what is certain.
    NoLine,
}

impl std::fmt::Display for TooOpen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Cells(most) => write!(
                f,
                "found more than {most} sets of lines, expected fewer: surer labels (--p) or more of them"
            ),
            Self::Work(most) => write!(
                f,
                "found more than {most} samples to look at, over all sets of lines, expected fewer: a smaller --tolerance or fewer samples"
            ),
            Self::NoLine => f.write_str("no line agrees with what is certain"),
        }
    }
}

/// The most cells that are kept.
const MOST_CELLS: usize = 1_000_000;

/// The most positions that are looked at, over all boxes.
const MOST_WORK: u64 = 3_000_000_000;

/// The work of a blurred position, in positions that are not.
const BLURRED_WORK: u64 = 5;

/// The most positions that may cut a box that is done.
const FEW: usize = 8;

/// The most that a box that is done may reach in slope, to either side of its middle.
const NARROW: f64 = 1.0 / 16.0;

/// The most that may be neglected over a box that is done, of the logarithm.
const LITTLE: f64 = 0.1;

/// Boxes narrower than this are done, whatever cuts them: positions are no finer.
const FINEST: f64 = 1e-12;

/// The corners of a square about the origin, in order.
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// The logarithm of the share at which the rest is left out.
const REST: f64 = -12.0;

/// Lines of one quarter: a rectangle of slopes and offsets.
#[derive(Debug)]
struct LineBox {
    quarter: Quarter,
    middle: [f64; 2],
    half: [f64; 2],
    /// The weight of the positions that lie on one side of all its lines.
    settled: f64,
    /// The other positions, which may cut it.
    open: Vec<u32>,
    /// Where positions err: the weight of the open ones at the middle, how it changes, and a bound on what that
    /// neglects.
    blurred: Option<Blurred>,
    /// The logarithm of what it weighs at most.
    upper: f64,
}

#[derive(Clone, Copy, Debug)]
struct Blurred {
    log: f64,
    change: [f64; 2],
    beyond: f64,
}

impl PartialEq for LineBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for LineBox {}

impl PartialOrd for LineBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for LineBox {
    fn cmp(&self, other: &Self) -> Ordering {
        self.upper.total_cmp(&other.upper)
    }
}

/// The logarithm of the sum of two numbers that are given by their logarithms.
fn log_sum(a: f64, b: f64) -> f64 {
    let (most, least) = (a.max(b), a.min(b));
    if least == f64::NEG_INFINITY { most } else { most + libm::log1p(libm::exp(least - most)) }
}

/// What lines are weighed by.
struct Problem<'a> {
    votes: &'a [Votes],
    doubt: &'a Doubt,
    /// The corners of the ground, which every line crosses.
    ground: [Point2<f64>; 4],
    /// The furthest of them along an axis.
    extent: f64,
    work: u64,
}

impl LinePosterior {
    /// The distribution over the lines that cross a rectangle about the origin. `reach` is half its size along each
    /// axis.
    ///
    /// # Errors
    /// [`TooOpen`].
    pub fn of(votes: &[Votes], doubt: &Doubt, reach: Vector2<f64>) -> Result<Self, TooOpen> {
        let ground = CORNERS.map(|[x, z]| Point2::new(x * reach.x, z * reach.y));
        let extent = reach.amax();
        let mut problem = Problem { votes, doubt, ground, extent, work: 0 };
        let all: Vec<u32> = (0..votes.len() as u32).collect();
        let mut boxes = BinaryHeap::new();
        for quarter in Quarter::ALL {
            let half = [1.0, reach.x + reach.y];
            boxes.extend(problem.line_box(quarter, [0.0; 2], half, 0.0, &all));
        }
        let (mut cells, mut total, mut pruned) = (Vec::new(), f64::NEG_INFINITY, f64::NEG_INFINITY);
        while let Some(next) = boxes.pop() {
            if next.upper + libm::log(1.0 + boxes.len() as f64) < total + REST {
                boxes.push(next);
                break;
            }
            if problem.work > MOST_WORK {
                return Err(TooOpen::Work(MOST_WORK));
            }
            if problem.is_done(&next) {
                problem.cut(&next, |cell| {
                    total = log_sum(total, cell.log + libm::log(cell.mass.measure));
                    cells.push(cell);
                });
                if cells.len() > MOST_CELLS {
                    return Err(TooOpen::Cells(MOST_CELLS));
                }
                continue;
            }
            for part in problem.halves(&next) {
                // So little that all such together are below rounding.
                if part.upper < total - 45.0 {
                    pruned = log_sum(pruned, part.upper);
                } else {
                    boxes.push(part);
                }
            }
        }
        if total == f64::NEG_INFINITY {
            return Err(TooOpen::NoLine);
        }
        pruned = boxes.iter().fold(pruned, |sum, it| log_sum(sum, it.upper));
        for cell in &mut cells {
            let all = cell.mass;
            cell.mass = Mass::default();
            cell.mass.add(&all, libm::exp(cell.log - total));
        }
        cells.retain(|cell| cell.mass.measure > 1e-14);
        cells.sort_by(|a, b| b.log.total_cmp(&a.log));
        Ok(Self { cells, pruned_mass: libm::exp(pruned - log_sum(pruned, total)) })
    }
}

impl Problem<'_> {
    /// The box of some lines; `None` if none of them is possible. `open` are the positions that may cut it.
    fn line_box(
        &mut self,
        quarter: Quarter,
        middle: [f64; 2],
        half: [f64; 2],
        settled: f64,
        open: &[u32],
    ) -> Option<LineBox> {
        let [slope, offset] = middle;
        let height = |[ahead, left]: [f64; 2]| left - slope * ahead - offset;
        let spread = |ahead: f64| ahead.abs() * half[0] + half[1] + 1e-12 * self.extent;
        // All corners of the ground on one side: no line of the box crosses it.
        let sides = self.ground.map(|corner| {
            let seen = quarter.seen(corner);
            let (height, spread) = (height(seen), spread(seen[0]));
            i8::from(height > spread) - i8::from(height < -spread)
        });
        if sides == [1; 4] || sides == [-1; 4] {
            return None;
        }
        self.work += open.len() as u64;
        let within = self.doubt.blurred_within() * libm::hypot(1.0, slope.abs() + half[0]);
        let mut line_box = LineBox {
            quarter,
            middle,
            half,
            settled,
            open: Vec::new(),
            blurred: None,
            upper: f64::NEG_INFINITY,
        };
        for &index in open {
            let votes = &self.votes[index as usize];
            let seen = quarter.seen(votes.at);
            let (height, spread) = (height(seen), spread(seen[0]));
            let reach = spread + if votes.certain.is_some() { 0.0 } else { within };
            if height > reach {
                line_box.settled += self.doubt.on(votes, Label::Positive);
            } else if height < -reach {
                line_box.settled += self.doubt.on(votes, Label::Negative);
            } else {
                line_box.open.push(index);
            }
        }
        if line_box.settled == f64::NEG_INFINITY {
            return None;
        }
        let best = if within > 0.0 {
            let blurred = self.blurred(&line_box);
            line_box.blurred = Some(blurred);
            let [a, b] = [0, 1].map(|k| blurred.change[k].abs() * half[k]);
            (blurred.log + a + b + blurred.beyond).min(0.0)
        } else {
            let sides = |index: &u32| {
                let votes = &self.votes[*index as usize];
                let on = |label| self.doubt.on(votes, label);
                on(Label::Positive).max(on(Label::Negative))
            };
            line_box.open.iter().map(sides).sum()
        };
        line_box.upper = line_box.settled + best + libm::log(4.0 * half[0] * half[1]);
        Some(line_box)
    }

    /// The weight of the open positions over a box, where positions err.
    fn blurred(&mut self, line_box: &LineBox) -> Blurred {
        self.work += BLURRED_WORK * line_box.open.len() as u64;
        let ([slope, offset], half) = (line_box.middle, line_box.half);
        let length = libm::hypot(1.0, slope);
        let mut blurred = Blurred { log: 0.0, change: [0.0; 2], beyond: 0.0 };
        for votes in line_box.open.iter().map(|index| &self.votes[*index as usize]) {
            if votes.count() == 0.0 {
                continue;
            }
            let [ahead, left] = line_box.quarter.seen(votes.at);
            let height = left - slope * ahead - offset;
            let told = self.doubt.near(votes, height / length);
            // The distance is height over length; both change.
            let by_slope = -ahead / length - height * slope / (length * length * length);
            let by_offset = -1.0 / length;
            blurred.log += told.log;
            blurred.change[0] += told.slope * by_slope;
            blurred.change[1] += told.slope * by_offset;
            let far = (ahead.abs() + height.abs()) * half[0] + half[1];
            let [steepest, sharpest] = self.doubt.bounds(height / length, far);
            let bent = (2.0 * ahead.abs() + 3.0 * (height.abs() + far)) * half[0] * half[0]
                + 2.0 * half[0] * half[1];
            blurred.beyond += votes.count() * 0.5 * (sharpest * far * far + steepest * bent);
        }
        blurred
    }

    /// Whether a box can be cut into cells.
    fn is_done(&self, line_box: &LineBox) -> bool {
        let half = line_box.half;
        if half[0] < FINEST || half[1] < FINEST * self.extent {
            return true;
        }
        let is_little = line_box.blurred.is_none_or(|blurred| {
            let change: f64 = (0..2).map(|k| blurred.change[k].abs() * half[k]).sum();
            blurred.beyond < LITTLE && change < 0.5
        });
        half[0] <= NARROW && is_little && self.cutting(line_box).count() <= FEW
    }

    /// The open positions that cut a box, and do not fade over it.
    fn cutting<'a>(&'a self, line_box: &'a LineBox) -> impl Iterator<Item = &'a Votes> {
        let is_blurred = line_box.blurred.is_some();
        let votes = line_box.open.iter().map(|index| &self.votes[*index as usize]);
        votes.filter(move |votes| !is_blurred || votes.certain.is_some())
    }

    /// The two halves of a box, across the side by which its lines differ the more.
    fn halves(&mut self, line_box: &LineBox) -> impl Iterator<Item = LineBox> {
        let [slope, offset] = line_box.half;
        let k = usize::from(slope * self.extent < offset);
        let mut half = line_box.half;
        half[k] *= 0.5;
        let part = |side: f64| {
            let mut middle = line_box.middle;
            middle[k] += side * half[k];
            self.line_box(line_box.quarter, middle, half, line_box.settled, &line_box.open)
        };
        [-1.0, 1.0].map(part).into_iter().flatten()
    }

    /// The cells of a box that is done.
    fn cut(&self, line_box: &LineBox, mut take: impl FnMut(Cell)) {
        let ([slope, offset], [half_slope, half_offset]) = (line_box.middle, line_box.half);
        let corner =
            |[a, b]: [f64; 2]| Point2::new(slope + a * half_slope, offset + b * half_offset);
        let lines = Polygon(CORNERS.map(corner).into());
        let quarter = line_box.quarter;
        let mut parts = vec![(Patch { quarter, lines }, line_box.settled)];
        let mut split = |at: [f64; 2], told: &dyn Fn(Label) -> f64| {
            let whole = std::mem::take(&mut parts);
            for (patch, log) in whole {
                let sides = [Label::Positive, Label::Negative];
                for (part, side) in patch.split(at).into_iter().zip(sides) {
                    let log = log + told(side);
                    if let Some(part) = part.filter(|_| log > f64::NEG_INFINITY) {
                        parts.push((part, log));
                    }
                }
            }
        };
        if self.cutting(line_box).count() <= FEW {
            for votes in self.cutting(line_box) {
                let told = |side| {
                    let blurred = line_box.blurred.is_some() && votes.count() > 0.0;
                    let on = self.doubt.on(votes, side);
                    // Its uncertain labels are in the blurred weight already.
                    if blurred && on.is_finite() { 0.0 } else { on }
                };
                split(quarter.seen(votes.at), &told);
            }
        } else {
            // Finer than positions are: by the line in the middle.
            let told = self.cutting(line_box).map(|votes| {
                let [ahead, left] = quarter.seen(votes.at);
                let is_above = left - slope * ahead - offset >= 0.0;
                let side = if is_above { Label::Positive } else { Label::Negative };
                self.doubt.on(votes, side)
            });
            parts[0].1 += told.sum::<f64>();
            parts.retain(|(_, log)| *log > f64::NEG_INFINITY);
        }
        let mut split_ground = |at: [f64; 2]| {
            let whole = std::mem::take(&mut parts);
            parts.extend(whole.into_iter().flat_map(|(patch, log)| {
                patch.split(at).into_iter().flatten().map(move |part| (part, log))
            }));
        };
        for at in self.ground.map(|corner| quarter.seen(corner)) {
            let height = at[1] - slope * at[0] - offset;
            if height.abs() <= at[0].abs() * half_slope + half_offset {
                split_ground(at);
            }
        }
        for (patch, log) in parts {
            let middle = patch.middle();
            let above = self.ground.map(|corner| {
                let [ahead, left] = quarter.seen(corner);
                left - middle.x * ahead - middle.y > 0.0
            });
            if above == [true; 4] || above == [false; 4] {
                continue;
            }
            let (log, mass) = match line_box.blurred {
                None => (log, patch.mass(|_| 1.0)),
                Some(blurred) => {
                    let change = |at: Point2<f64>| -> f64 {
                        (0..2).map(|k| blurred.change[k] * (at[k] - line_box.middle[k])).sum()
                    };
                    let own = change(middle);
                    (log + blurred.log + own, patch.mass(|at| libm::exp(change(at) - own)))
                }
            };
            if mass.measure > 0.0 {
                take(Cell { patch, log, mass });
            }
        }
    }
}
