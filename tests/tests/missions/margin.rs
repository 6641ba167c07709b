//! Margin sampling asks where it should, by trying all actions.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use nalgebra::Point2;
use planner_core::dynamics::{Action, Dynamics as _};
use planner_core::{Certainty, Line, Site, Unicycle, Workspace as _};
use tests::ensemble::noisy;

/// Of all drives that end on uncertain ground it makes the one whose end is nearest to the maximum margin. If labels may be
/// wrong, ground is as uncertain as at the start. Where no drive does, it moves on without a label, and not for long.
#[test]
fn it_asks_on_uncertain_ground_nearest_to_the_maximum_margin() {
    let (unicycle, mut recoveries) = (Unicycle::paper(), 0);
    for number in 0..8 {
        let mission = standard_field::standard(3, number, Algorithm::Margin, 24);
        let mission = if number % 2 == 1 { noisy(mission, 0.7, 0.0) } else { mission };
        let (start, area) = (mission.lines(), mission.config.area);
        let (mut before, mut pose, mut silent) = (mission.belief(), mission.start, 0);
        let flown = mission.fly(|step, belief| {
            let line = Line::from(before.estimates().maximum_margin.expect("a line"));
            let off = |site: Site| line.distance(Point2::from(site)).abs();
            let lines = before.version_space().unwrap_or(&start);
            let asks = |site: &Site| {
                area.contains(*site) && lines.certainty(*site) == Certainty::Uncertain
            };
            let actions = (0..unicycle.grid().actions()).map(|index| Action(index as u32));
            let ends = actions.filter_map(|it| Some(unicycle.target(pose, it)?.site));
            let asking = ends.filter(|it| *it != pose.site && asks(it)).map(off);
            let nearest = asking.reduce(f64::min);
            let found = step.motion.wants_label.then(|| off(step.motion.target.site));
            assert_eq!(found, nearest, "field {number}: {:?}", step.motion);
            silent = if found.is_some() { 0 } else { silent + 1 };
            assert!(pose != step.pose && silent < 20, "field {number}: {silent} without a label");
            assert_eq!(step.motion.recovery.is_none(), found.is_some());
            recoveries += u32::from(found.is_none());
            (before, pose) = (belief.boxed(), step.pose);
        });
        assert!(flown.is_ok());
    }
    assert!(recoveries > 0, "it moves without a label too");
}
