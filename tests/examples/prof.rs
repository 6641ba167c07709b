//! x
use host_sim::field;
use host_sim::mission::Algorithm;
use host_sim::world::{Extent, NoiseModel};
use tests::bench;
use tests::emulator::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let number: u64 = a[1].parse().unwrap();
    let steps: u32 = a[2].parse().unwrap();
    let elf = std::fs::read(&a[4]).unwrap();
    let mut runs = vec![];
    for st in [steps, steps + 1] {
        PROFILE.with(|p| p.borrow_mut().clear());
        let alg = if a[3] == "cfc" { Algorithm::Cfc } else { Algorithm::Scc };
        let mut m = field::standard(7, number, alg, st);
        if a[3] != "cfc" {
            m.noise = Some(NoiseModel { p: 0.7, extent: Extent::OutsideBalls(0.5) });
            if a[3] == "joint" {
                m.policy = planner_core::scc::Policy::Joint;
            }
        }
        let mut e = Emulator::load(&elf, Core::M4F);
        let p = bench::fly(&mut e, &m).unwrap();
        eprintln!("{:?}", p.took.last());
        runs.push(PROFILE.with(|p| p.borrow().clone()));
    }
    for (pc, n) in &runs[1] {
        let d = *n as i64 - *runs[0].get(pc).unwrap_or(&0) as i64;
        if d > 0 {
            println!("{pc:x} {d}");
        }
    }
}
