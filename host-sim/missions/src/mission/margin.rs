//! Margin sampling, the usual rule of active learning: a baseline that a planner made for this problem has to beat.
//!
//! It samples where the maximum-margin line is least certain. Of all drives that stay in the area and end on uncertain
//! ground, it makes the one whose end is nearest to that line. If labels are true, ground is uncertain where the
//! remaining lines disagree. If labels may be wrong, ground is uncertain where the starting lines disagree, and the
//! line is that of the most likely hypothesis.
//!
//! The rule assumes that every place can be sampled at will. If no uncertain end is in reach it would wait for ever, as
//! waiting teaches nothing. So it then moves without a label:
//!
//! 1. *Reorient*: a turn in place after which there is such a drive, to the side where that ends nearer to the line.
//! 2. *Transit*: the drive that ends nearest to the line, on certain ground. A drive is never of length 0, so other
//!    places are in reach next time. This helps also where uncertain ground is thinner than the action grid.
//! 3. In a corner that no drive leads out of: a turn to the left, until one does.

use nalgebra::Point2;
use planner_core::dynamics::{Action, Dynamics, Side};
use planner_core::{Certainty, Line, Motion, Pose, Recovery, Site, StopReason, Workspace as _};

use crate::mission::baseline::{Ground, Strategy, motion};
use crate::mission::definition::Table;
use crate::mission::given::Lines;

/// Takes the drive that ends nearest to the maximum-margin line, on uncertain ground.
pub struct Margin;

/// A drive that stays in the area, or comes back to it.
#[derive(Clone, Copy)]
struct Drive {
    action: Action,
    target: Pose,
    /// What its turn costs.
    effort: u32,
    /// Its length.
    reach_mm: u32,
    /// From its end to the line, metres.
    distance: f64,
}

impl<D: Dynamics> Ground<D> {
    /// The drives from a pose: by their turns, the smallest first, left before right.
    fn drives(&self, line: &Line, pose: Pose) -> impl Iterator<Item = Drive> {
        let grid = self.dynamics.grid();
        self.dynamics.rays(pose).flat_map(move |ray| {
            (1..grid.speeds()).filter_map(move |speed| {
                let action = grid.action(ray.index, speed);
                let target = self.dynamics.target(pose, action)?;
                let is_inside = self.area.contains(target.site)
                    && self.dynamics.keeps_inside(pose, target, &self.area, 0);
                let comes_back = self.comes_back(pose.site, target.site)
                    && self.dynamics.stays_inside(pose, target, &self.area);
                (is_inside || comes_back).then(|| Drive {
                    action,
                    target,
                    effort: ray.turn_cost,
                    reach_mm: grid.reach_mm(speed),
                    distance: line.distance(Point2::from(target.site)).abs(),
                })
            })
        })
    }

    /// Whether a drive from outside the area, where an error has brought it, leads nearer to its middle.
    fn comes_back(&self, from: Site, to: Site) -> bool {
        let [before, after] = [from, to].map(|site| {
            let way = self.area.area().middle() - site;
            way.dot(way)
        });
        !self.area.contains(from) && after < before
    }

    /// The drive that asks: it ends on uncertain ground of the area.
    fn asking(&self, line: &Line, pose: Pose) -> Option<Drive> {
        nearest(self.drives(line, pose).filter(|drive| self.is_uncertain(drive.target.site)))
    }

    /// The turn in place after which a drive asks, nearest to the line.
    fn reorient(&self, line: &Line, pose: Pose) -> Option<(Action, Pose)> {
        let turns = [Side::Left, Side::Right].map(|side| self.dynamics.turn_in_place(pose, side));
        let asking = |turn: (Action, Pose)| Some((turn, self.asking(line, turn.1)?.distance));
        let sides = turns.into_iter().flatten().filter_map(asking);
        sides.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(turn, _)| turn)
    }

    /// Whether lines disagree about a site of the area. Where labels may err, these are the starting lines, else the
    /// lines left.
    fn is_uncertain(&self, site: Site) -> bool {
        let left = self.belief.version_space().map(Lines::lines);
        let lines = left.or_else(|| self.belief.hypotheses().map(Table::start));
        self.area.contains(site)
            && lines.is_some_and(|lines| lines.certainty(site) == Certainty::Uncertain)
    }
}

/// The drive that ends nearest to the line. Ties go to the smaller turn, then the shorter drive, then the left.
fn nearest(drives: impl Iterator<Item = Drive>) -> Option<Drive> {
    drives.min_by(|a, b| {
        let by_turn = || a.effort.cmp(&b.effort);
        let by_length = || a.reach_mm.cmp(&b.reach_mm);
        a.distance.total_cmp(&b.distance).then_with(by_turn).then_with(by_length)
    })
}

impl<D: Dynamics> Strategy<D> for Margin {
    fn choose(&mut self, ground: &Ground<D>, pose: Pose) -> Result<Motion, StopReason> {
        let line = ground.belief.estimates().maximum_margin.map(Line::from);
        let line = line.ok_or(StopReason::Resolution)?;
        let (recovery, action, target) = if let Some(drive) = ground.asking(&line, pose) {
            (None, drive.action, drive.target)
        } else if let Some((action, target)) = ground.reorient(&line, pose) {
            (Some(Recovery::Reorient), action, target)
        } else if let Some(drive) = nearest(ground.drives(&line, pose)) {
            (Some(Recovery::Transit), drive.action, drive.target)
        } else if let Some((action, target)) = ground.dynamics.turn_in_place(pose, Side::Left) {
            (Some(Recovery::Reorient), action, target)
        } else {
            return Err(StopReason::Cornered);
        };
        Ok(Motion {
            recovery,
            wants_label: recovery.is_none(),
            examined: u32::try_from(ground.dynamics.grid().actions()).unwrap_or(u32::MAX),
            ..motion(&ground.dynamics, pose, action, target)
        })
    }
}
