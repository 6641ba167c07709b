//! One small program on one core: it keeps its budgets, it flies as this machine does, and it declines what it has no
//! code for. The hardest missions that are known are among those flown.

use chips::budget::book::Book;
use chips::budget::workload::DOUBT;
use chips::budget::{footprint, timing};
use chips::emulator::{Core, Emulator};
use chips::program::{CHIP, bare};
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;

#[test]
fn it_keeps_its_budgets_and_flies_as_this_machine() {
    if cfg!(not(feature = "all")) {
        let why = "cargo test -p chips --features all has them";
        tests::build::leave_out("all but one program on one emulated core", why);
    }
    let Some(elf) = bare(CHIP, "small") else { return };
    let mut book = Book::open();
    let bound = footprint::measure(&mut book, "small", &elf).stack;
    let stack = timing::time(&mut book, [Core::M4F.name(), "small"], |workload, numbers| {
        timing::fly(Core::M4F, &elf, numbers, |it| workload.mission(it), workload.calls)
    });
    assert!(stack <= bound, "{stack} bytes of stack, more than its bound of {bound}");
    book.close();
}

#[test]
fn it_declines_what_it_has_no_code_for() {
    let Some(elf) = bare(CHIP, "small") else { return };
    let mut emulator = Emulator::load(&elf, Core::M4F);
    let mission = |algorithm, steps| standard_field::standard(5, 1, algorithm, steps);
    let noisy = Mission { noise: DOUBT, ..mission(Algorithm::Lookahead, 8) };
    let scc = Mission { noise: DOUBT, ..mission(Algorithm::Scc, 8) };
    let mut declined = vec![(noisy, "algorithm"), (scc, "algorithm")];
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        assert!(emulator.fly(&mission(algorithm, 12)).is_ok());
        declined.push((mission(algorithm, 13), "at most 12"));
    }
    for (mission, why) in declined {
        let refusal = emulator.fly(&mission).expect_err("it is declined").to_string();
        assert!(refusal.contains(why), "{why}: {refusal}");
    }
}

#[test]
fn the_planner_forbids_unsafe_code() {
    let text = include_str!("../../../planner-core/src/lib.rs");
    assert!(text.starts_with("#![no_std]\n#![forbid(unsafe_code)]\n"));
}
