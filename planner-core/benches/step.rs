//! Host-side times of one planning step, one cut and one estimate, over the states of a mission.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use nalgebra::Point2;
use planner_core::{
    Area, Belief as _, CellPosterior, Cfc, Heading, Label, Noise, Plan, Planner, Pose, Prior,
    Reliability, Sample, Scc, Site, Tolerance, Unicycle, VersionSpace,
};

type Cfc32 = Cfc<Unicycle, 32>;

fn at(x: f64, z: f64) -> Site {
    Site::try_from(Point2::new(x, z)).expect("on the lattice")
}

fn label(site: Site) -> Label {
    let at = Point2::<f64>::from(site);
    if at.y > 0.41 * at.x + 3.5 { Label::Positive } else { Label::Negative }
}

fn area() -> Area {
    Area::metres([0.0, 0.0], [20.0, 20.0]).expect("an area")
}

/// The planner and the pose before each of the first steps of the paper's noiseless example.
fn states() -> Vec<(Cfc32, Pose)> {
    let corners = [(2.0, 1.0), (2.0, 8.0), (18.0, 16.0), (18.0, 5.0)].map(|(x, z)| at(x, z));
    let oracle = corners.map(|site| Sample { site, label: label(site) });
    let space = VersionSpace::new(&oracle).expect("separable");
    let mut planner = Cfc::new(area(), Unicycle::paper(), space).expect("settings that agree");
    let mut pose = Pose { site: corners[0], heading: Heading(0) };
    let mut states = Vec::new();
    for _ in 0..24 {
        states.push((planner.clone(), pose));
        let Plan::Move(motion) = planner.plan(pose) else { break };
        pose = motion.target;
        let reading = motion.wants_label.then(|| label(pose.site).into());
        planner.observe(pose, reading).expect("labels are true");
    }
    states
}

fn step(criterion: &mut Criterion) {
    let states = states();
    let n = states.len();
    criterion.bench_function(&format!("plan, {n} states of a mission"), |bencher| {
        bencher.iter_batched_ref(
            || states.clone(),
            |states| {
                for (planner, pose) in states {
                    let _ = black_box(planner.plan(*pose));
                }
            },
            BatchSize::SmallInput,
        );
    });
    criterion.bench_function(
        &format!("the same problems by trying every action, {n} states"),
        |bencher| {
            bencher.iter(|| {
                for (planner, pose) in &states {
                    let problem = planner.problem();
                    black_box(problem.solve_exhaustively(&Unicycle::paper(), *pose));
                }
            });
        },
    );
    let (last, _) = states.last().expect("states");
    let samples = last.belief().samples();
    let before = VersionSpace::<32>::new(&samples[..samples.len() - 1]).expect("separable");
    criterion.bench_function("cut by one sample", |bencher| {
        bencher.iter_batched_ref(
            || before.clone(),
            |space| space.insert(black_box(samples[samples.len() - 1])),
            BatchSize::SmallInput,
        );
    });
    criterion.bench_function("three estimates", |bencher| {
        bencher.iter(|| black_box(last.belief()).estimates());
    });
}

/// Algorithm 2 after some labels of the same example, every third of them wrong.
fn noisy(labels: usize) -> (Scc<Unicycle, 36, 529>, Pose) {
    let (planner, start) = states().swap_remove(0);
    let reliability = Reliability::new(0.7).expect("a probability");
    let noise = Noise { reliability, trusted_radius: 0, tolerance: Tolerance::NONE };
    let hypotheses =
        CellPosterior::new(planner.belief().samples(), Prior::Area, noise).expect("an oracle");
    let mut planner = Scc::new(area(), Unicycle::paper(), hypotheses).expect("settings that agree");
    let mut pose = start;
    let mut taken = 0;
    while taken < labels {
        let Plan::Move(motion) = planner.plan(pose) else { break };
        pose = motion.target;
        let seen = if taken % 3 == 0 { -label(pose.site) } else { label(pose.site) };
        taken += usize::from(motion.wants_label);
        planner.observe(pose, motion.wants_label.then(|| seen.into())).expect("possible");
    }
    (planner, pose)
}

fn noisy_step(criterion: &mut Criterion) {
    let (planner, pose) = noisy(10);
    let n = planner.belief().iter().len();
    criterion.bench_function(&format!("noisy: plan at 10 labels, {n} hypotheses"), |bencher| {
        bencher.iter_batched_ref(
            || planner.clone(),
            |planner| planner.plan(black_box(pose)),
            BatchSize::SmallInput,
        );
    });
    let (planner, pose) = noisy(31);
    let n = planner.belief().iter().len();
    criterion.bench_function(&format!("noisy: the 32nd label, {n} hypotheses"), |bencher| {
        bencher.iter_batched_ref(
            || planner.clone(),
            |planner| planner.observe(black_box(pose), Some(Label::Positive.into())),
            BatchSize::SmallInput,
        );
    });
}

criterion_group!(benches, step, noisy_step);
criterion_main!(benches);
