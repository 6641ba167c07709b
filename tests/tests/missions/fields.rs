//! Every plan of Algorithm 1 over the standard fields, beside one that tries all actions.

use std::collections::BTreeMap;
use std::sync::Mutex;

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::world::robot::{Ideal, Robot as _};
use planner_core::link::message::MissionArea;
use planner_core::{Plan, Planner as _, Pose, Recovery, Unicycle};
use rayon::prelude::*;
use tests::cases;
use tests::twins::ladder::{Ladder, Rung};

#[test]
fn every_plan_is_what_trying_all_actions_would_make_it() {
    let unicycle = Unicycle::paper();
    let rungs = Mutex::new(BTreeMap::new());
    (0..cases(70, 2_000)).into_par_iter().for_each(|number| {
        let mission = standard_field::standard(12, number, Algorithm::Cfc, 60);
        let mut robot = Ideal { world: mission.world.clone() };
        let mut planner = mission.cfc(mission.config.area, unicycle);
        let mut pose = mission.start;
        for step in 1..=mission.steps {
            let slow = planner.problem().solve_exhaustively(&unicycle, pose).best;
            let plan = planner.plan(pose);
            // Where P2 found nothing the problem is P1 by now.
            let slow = slow.or_else(|| planner.problem().solve_exhaustively(&unicycle, pose).best);
            let undirected = || planner.problem().undirected().solve_exhaustively(&unicycle, pose);
            let expected = match slow {
                Some(best) => Some((None, best.action)),
                None => undirected().best.map(|it| (Some(Recovery::Undirected), it.action)),
            };
            let found = match plan {
                Plan::Move(motion) => Some((motion.recovery, motion.action)),
                Plan::Stop(_) => None,
            };
            let rung = found.and_then(|(recovery, _)| recovery);
            let place = format!("field {number}, step {step}");
            if expected.is_some() {
                assert_eq!(found, expected, "{place}");
            } else {
                let problem = planner.problem().undirected();
                climb(&Ladder { problem, dynamics: &unicycle }, pose, plan, &place);
            }
            *rungs.lock().expect("no panic").entry(format!("{rung:?}")).or_insert(0) += 1;
            let Plan::Move(motion) = plan else { break };
            let reading = robot.perform(&motion, &mut pose);
            planner.observe(pose, reading).expect("labels are true");
        }
    });
    let rungs = rungs.into_inner().expect("no panic");
    assert!(rungs.len() == 4 && rungs.values().all(|count| *count >= 20), "{rungs:?}");
}

/// What the ladder finds is what its slow twin does.
fn climb(ladder: &Ladder<Unicycle, MissionArea>, pose: Pose, plan: Plan, place: &str) {
    let rung = ladder.rung(pose);
    match (plan, rung) {
        (Plan::Stop(found), Rung::Stop(reason)) => assert_eq!(found, reason, "{place}"),
        (Plan::Move(motion), Rung::Take(recovery, action)) => {
            assert_eq!((motion.recovery, motion.action), (Some(recovery), action), "{place}");
        }
        (Plan::Move(motion), Rung::Far(distance)) => {
            assert_eq!(motion.recovery, Some(Recovery::Transit), "{place}");
            let nearer = distance - ladder.distance(motion.target.site).expect("it is inside");
            let eighth = f64::from(motion.control.distance_m) / 8.0;
            assert!(nearer > eighth - 1e-3, "{place}: {nearer} nearer by {motion:?}");
        }
        _ => panic!("{place}: {plan:?}, expected {rung:?}"),
    }
}
