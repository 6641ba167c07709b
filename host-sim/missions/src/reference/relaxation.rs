//! A lower bound on the control that balances the labels, from a relaxed problem that fits a table.
//!
//! Labels depend on the signed distance from the true line alone, and changes of that distance depend on the heading.
//! So the relaxed problem ignores the position along the line, the area's border and the cost of the line. Two numbers
//! are left. A dynamic program over them computes the least control that balances the labels within the remaining
//! motions.
//!
//! Both numbers are divided into bins. A motion may end in each bin that it could reach from anywhere in its own. So
//! the table may give too low a cost, but never too high a cost. A motion has three parts. First comes a turn, whose
//! cost is the action's less the square of its reach. Then comes one of the speeds, in the direction of travel. At the
//! end, the heading may differ from that direction by as much as after any motion of the vehicle (it does for a car).

use std::f64::consts::TAU;

use planner_core::dynamics::Dynamics as _;
use planner_core::{Line, Pose, Site, Workspace as _};
use rayon::prelude::*;

use crate::reference::instance::{Instance, Partial};
use crate::reference::objective::Problem;

/// Bins of distance, over all distances that can be reached.
const DISTANCES: f64 = 400.0;

/// Bins of a whole turn.
const HEADINGS: usize = 256;

/// A bin of a turn, radians.
const BIN_RAD: f64 = TAU / HEADINGS as f64;

/// More than the rounding of headings, radians.
const SLACK_RAD: f64 = 1e-6;

/// More than the rounding of positions to the lattice, metres.
const SLACK_M: f64 = 1e-4;

/// The cost of what is impossible.
const NEVER: u64 = u64::MAX;

/// Least control costs, in millionths.
pub struct Relaxation<'a> {
    instance: &'a Instance,
    bins: Bins,
    /// What the cheapest motion costs.
    idlest: u64,
    /// By motions left, where labels need balance.
    tables: Vec<Tables>,
}

/// Tables for one number of motions left. For each sum of labels from `-most` to `most` there is a cost for each bin.
/// Sums that cannot occur have no costs.
struct Tables {
    most: i32,
    by_sum: Vec<Vec<u64>>,
}

/// How distances and headings are put into bins.
struct Bins {
    width: f64,
    /// Bins on the -1 side.
    negative: usize,
    /// Bins on both sides.
    distances: usize,
    /// The heading that leads away from the line, to its +1 side; radians.
    normal: f64,
}

/// What a vehicle can do, in terms of the bins.
struct Moves {
    /// Turns by bins, and what each costs at least.
    turns: Vec<(usize, u64)>,
    /// Reaches in metres, and their squares in millionths.
    reaches: Vec<(f64, u64)>,
    /// How many bins the heading may be off the direction of travel in the end.
    swing: usize,
}

impl<'a> Relaxation<'a> {
    /// Solves the relaxed problem of an instance.
    pub fn of(instance: &'a Instance) -> Self {
        let idlest = instance.choices.first().map_or(0, |choice| choice.effort);
        let bins = Bins::of(instance);
        let mut relaxation = Self { instance, bins, idlest, tables: Vec::new() };
        if let Problem::Divided(_) = instance.problem {
            let moves = Moves::of(instance);
            for left in 0..=instance.horizon() {
                let tables = relaxation.tables_for(left, &moves);
                relaxation.tables.push(tables);
            }
        }
        relaxation
    }

    /// The least cost of the motions that a sequence has left; `None` if none of them balances its labels.
    pub fn least(&self, at: &Partial) -> Option<u64> {
        let Some(tables) = self.tables.get(at.left as usize) else {
            return Some(u64::from(at.left) * self.idlest);
        };
        let costs = tables.of(at.sum)?;
        let bin = self.bins.of_pose(at.pose, self.instance.mission.world.distance(at.pose.site));
        let least = bin.map_or(0, |bin| costs[bin]);
        (least != NEVER).then_some(least)
    }

    fn tables_for(&self, left: u32, moves: &Moves) -> Tables {
        // A larger sum cannot return to what is allowed within the labels left. Each label so far has changed it by 1.
        let most = left as i32 + 1;
        let mission = &self.instance.mission;
        let made = (self.instance.horizon() - left) as i32;
        let begun = i32::from(mission.world.reading(mission.start.site).sign());
        let comes_up = |sum: i32| {
            let change = sum - begun;
            change.abs() <= made && (made - change) % 2 == 0
        };
        let table = |sum| if comes_up(sum) { self.table(left, sum, moves) } else { Vec::new() };
        Tables { most, by_sum: (-most..=most).map(table).collect() }
    }

    fn table(&self, left: u32, sum: i32, moves: &Moves) -> Vec<u64> {
        let size = self.bins.distances * HEADINGS;
        let Some(next) = left.checked_sub(1).map(|next| &self.tables[next as usize]) else {
            let cost = if self.instance.problem.allows_sum(sum) { 0 } else { NEVER };
            return vec![cost; size];
        };
        // What follows a motion that ends on the -1 side, on the +1 side, by the bin of its direction of travel.
        let after = [sum - 1, sum + 1].map(|sum| next.of(sum).map(|costs| moves.swung(costs)));
        let mut costs = vec![NEVER; size];
        costs.par_chunks_mut(HEADINGS).enumerate().for_each(|(distance, row)| {
            let driven: Vec<_> = (0..HEADINGS)
                .map(|heading| self.driven(distance, heading, moves, &after))
                .collect();
            for (heading, cost) in row.iter_mut().enumerate() {
                let turned = |&(turn, cost): &(usize, u64)| {
                    driven[(heading + turn) % HEADINGS].saturating_add(cost)
                };
                *cost = moves.turns.iter().map(turned).min().unwrap_or(NEVER);
            }
        });
        costs
    }

    /// The least cost of a drive in a direction and of all that follows.
    fn driven(
        &self,
        distance: usize,
        heading: usize,
        moves: &Moves,
        after: &[Option<Vec<u64>>; 2],
    ) -> u64 {
        let Bins { width, negative, distances, .. } = self.bins;
        let from = (distance as f64 - negative as f64) * width;
        let [least, most] = cosines(heading);
        let best = moves.reaches.iter().map(|&(reach, cost)| {
            let slack = if reach > 0.0 { SLACK_M } else { 0.0 };
            let ends = if reach > 0.0 {
                let to = [from + reach * least - slack, from + width + reach * most + slack];
                to.map(|to| (to / width).floor() + negative as f64)
            } else {
                [distance as f64; 2]
            };
            let first = ends[0].max(0.0) as usize;
            let last = (ends[1].max(-1.0) + 1.0) as usize;
            let follows = (first..last.min(distances)).map(|end| {
                let costs = &after[usize::from(end >= negative)];
                costs.as_ref().map_or(NEVER, |costs| costs[end * HEADINGS + heading])
            });
            follows.min().unwrap_or(NEVER).saturating_add(cost)
        });
        best.min().unwrap_or(NEVER)
    }
}

impl Tables {
    fn of(&self, sum: i32) -> Option<&Vec<u64>> {
        self.by_sum.get(usize::try_from(sum + self.most).ok()?).filter(|costs| !costs.is_empty())
    }
}

impl Bins {
    fn of(instance: &Instance) -> Self {
        let mission = &instance.mission;
        let (world, bounds) = (&mission.world, mission.config.area.bounds());
        let grid = mission.vehicle.grid();
        let way = f64::from(grid.reach_m(grid.speeds() - 1)) * f64::from(instance.horizon());
        let start = world.distance(mission.start.site);
        let (min, max) = (bounds.min(), bounds.max());
        let corner = |x, z| Site::new(x, z).map_or(start, |site| world.distance(site));
        let corners = [
            corner(min.x(), min.z()),
            corner(min.x(), max.z()),
            corner(max.x(), min.z()),
            corner(max.x(), max.z()),
        ];
        let lowest = corners.into_iter().fold(start, f64::min).max(start - way) - SLACK_M;
        let highest = corners.into_iter().fold(start, f64::max).min(start + way) + SLACK_M;
        let width = (highest - lowest) / DISTANCES;
        let side = |most: f64| if most > 0.0 { (most / width) as usize + 1 } else { 0 };
        let (negative, positive) = (side(-lowest), side(highest));
        let [a, b, _] = world.line().map_or([0.0, 1.0, 0.0], Line::coefficients);
        Self { width, negative, distances: negative + positive, normal: libm::atan2(b, a) }
    }

    /// The bin of a pose at this distance from the line; `None` if there is none.
    fn of_pose(&self, pose: Pose, distance: f64) -> Option<usize> {
        let steps = (distance.abs() / self.width) as usize;
        // By its sign, as labels are, so that no rounding puts it on the other side.
        let row = if distance < 0.0 {
            self.negative.checked_sub(steps + 1)?
        } else {
            self.negative + steps
        };
        let turn = (pose.heading.radians() - self.normal).rem_euclid(TAU);
        let column = ((turn / BIN_RAD) as usize).min(HEADINGS - 1);
        (row < self.distances).then_some(row * HEADINGS + column)
    }
}

impl Moves {
    fn of(instance: &Instance) -> Self {
        let (vehicle, pose) = (instance.mission.vehicle, instance.mission.start);
        let grid = vehicle.grid();
        let mut cost_by_turn = [NEVER; HEADINGS];
        let (mut reaches, mut swing) = (Vec::new(), 0.0_f64);
        for choice in &instance.choices {
            let (_, speed) = grid.split(choice.action);
            let Some(ray) = vehicle.ray_of(pose, choice.action) else { continue };
            let Ok(end) = vehicle.arrive(pose, &ray, speed) else { continue };
            let square = u64::from(grid.reach_mm(speed)).pow(2);
            let turn = ray.heading.since(pose.heading).radians();
            let first = ((turn - SLACK_RAD) / BIN_RAD).floor() as i64;
            let last = ((turn + SLACK_RAD) / BIN_RAD).floor() as i64 + 1;
            for bin in first..=last {
                let cost = &mut cost_by_turn[bin.rem_euclid(HEADINGS as i64) as usize];
                *cost = choice.effort.saturating_sub(square).min(*cost);
            }
            reaches.push((f64::from(grid.reach_mm(speed)) / 1e3, square));
            swing = swing.max(end.heading.since(ray.heading).radians().abs());
        }
        reaches.sort_by_key(|reach| reach.1);
        reaches.dedup();
        let turns = cost_by_turn.into_iter().enumerate().filter(|turn| turn.1 != NEVER).collect();
        let swing = if swing > 0.0 { (swing / BIN_RAD) as usize + 1 } else { 0 };
        Self { turns, reaches, swing: swing.min(HEADINGS / 2) }
    }

    /// The least cost within the swing of each heading.
    fn swung(&self, costs: &[u64]) -> Vec<u64> {
        if self.swing == 0 {
            return costs.to_vec();
        }
        let of_row = |row: &[u64]| {
            let around = |heading: usize| {
                let window = heading + HEADINGS - self.swing..=heading + HEADINGS + self.swing;
                window.map(|bin| row[bin % HEADINGS]).min().unwrap_or(NEVER)
            };
            (0..HEADINGS).map(around).collect::<Vec<_>>()
        };
        costs.chunks(HEADINGS).flat_map(of_row).collect()
    }
}

/// The least and the greatest cosine of the angles of a bin, with slack.
fn cosines(bin: usize) -> [f64; 2] {
    let [from, to] = [bin, bin + 1].map(|bin| libm::cos(bin as f64 * BIN_RAD));
    // A bin begins or ends at each multiple of a quarter turn, so cosines are monotone on it.
    [from.min(to) - SLACK_RAD, from.max(to) + SLACK_RAD]
}
