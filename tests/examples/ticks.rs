//! Temporary.
use host_sim::field;
use host_sim::mission::Algorithm;
use host_sim::world::{Extent, NoiseModel};
use planner_core::scc::Policy;
use rayon::prelude::*;
use tests::bench;
use tests::emulator::{Core, Emulator};

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let n: u64 = args[1].parse().unwrap();
    let steps: u32 = args[2].parse().unwrap();
    let kind = args[3].clone();
    let elf = std::fs::read(&args[4]).unwrap();
    let mut rows: Vec<(u32, u32, u64, usize, String)> = (0..n)
        .into_par_iter()
        .flat_map_iter(|number| {
            let algorithm = if kind == "cfc" { Algorithm::Cfc } else { Algorithm::Scc };
            let mut mission = field::standard(7, number, algorithm, steps);
            if kind != "cfc" {
                mission.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
                if kind == "joint" {
                    mission.policy = Policy::Joint;
                }
            }
            let mut emulator = Emulator::load(&elf, Core::M4F);
            let played = bench::fly(&mut emulator, &mission).expect("flies");
            let mut rows: Vec<_> = played
                .took
                .iter()
                .zip(&played.recording.steps)
                .enumerate()
                .map(|(i, (t, s))| {
                    let m = s.step.motion;
                    (
                        t.plan,
                        t.observe,
                        number,
                        i,
                        format!("{:?} {:?} ex {}", m.stage, m.recovery, m.examined),
                    )
                })
                .collect();
            if rows.len() < steps as usize {
                rows.push((played.ending.plan, 0, number, rows.len(), "end".into()));
            }
            rows
        })
        .collect();
    rows.sort_by_key(|r| r.0);
    let q = |f: f64| rows[((rows.len() - 1) as f64 * f) as usize].0;
    println!(
        "{} states: plan median {} p90 {} p99 {} p99.9 {} max {}",
        rows.len(),
        q(0.5),
        q(0.9),
        q(0.99),
        q(0.999),
        q(1.0)
    );
    for r in rows.iter().rev().take(8) {
        println!("  {r:?}");
    }
    rows.sort_by_key(|r| r.1);
    let q = |f: f64| rows[((rows.len() - 1) as f64 * f) as usize].1;
    println!("observe median {} p99 {} max {}", q(0.5), q(0.99), q(1.0));
    if steps > 9 && kind != "cfc" {
        let mut at: Vec<_> = rows.iter().filter(|r| r.3 == 10).map(|r| r.0).collect();
        at.sort();
        println!("plan at 10: median {} max {}", at[at.len() / 2], at[at.len() - 1]);
    }
}
