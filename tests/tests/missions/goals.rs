//! What a goal takes: labels and metres until the slopes left lie within so many degrees, beside two bisected chords.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::asking::Asking;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use planner_core::Goal;
use tests::{cases, ensemble, seed};

/// Labels and metres until the slopes left lie within so many degrees.
fn taken(mission: &Mission, degrees: f64) -> Option<[f64; 2]> {
    let results = Recording::of(mission).expect("labels are true").results;
    let is_known = |arcs: &[[f64; 2]]| matches!(arcs, [[from, to]] if to - from <= degrees);
    let step = results.steps.iter().position(|step| is_known(&step.slope_arcs))?;
    let labels = results.steps[..=step].iter().filter(|it| it.label.is_some()).count();
    Some([labels as f64, results.steps[step].metres])
}

/// The medians of what missions of standard fields take.
fn medians(of: impl Fn(u64) -> Option<[f64; 2]> + Sync + Send) -> [f64; 2] {
    let count = cases(60, 1_000);
    let flown = ensemble::fly_some(count, of);
    assert!(flown.len() as u64 * 100 >= count * 99, "{} of {count} meet their goal", flown.len());
    [0, 1].map(|k| ensemble::median(flown.iter().map(|it| it[k])))
}

#[test]
fn goals_take_few_more_labels_than_two_chords_and_fewer_metres() {
    let field = |number, algorithm| standard_field::standard(seed(777), number, algorithm, 400);
    for degrees in [0.5, 0.1, 0.02] {
        // As many labels as it takes, of which half are read on each chord.
        let chords = medians(|number| {
            (4..60).find_map(|labels| {
                let asking = Asking { labels: Some(labels), ..Asking::USUAL };
                taken(&Mission { asking, ..field(number, Algorithm::Chords) }, degrees)
            })
        });
        println!("{degrees} degrees, chords that know how many labels it takes: {chords:.1?}");
        for (price, labels, metres) in [
            (None, 5.0, 0.9),
            (Some(0.5), 5.0, 0.7),
            (Some(2.5), 2.0, 0.85),
            (Some(10.0), 1.0, 1.15),
        ] {
            let goal = Some(Goal::slope_within_degrees(degrees).expect("a goal").into());
            let asking = Asking { price, ..Asking::USUAL };
            let mission = |number| Mission {
                goal,
                asking,
                audits: false,
                ..field(number, Algorithm::Lookahead)
            };
            let ours = medians(|number| taken(&mission(number), degrees));
            println!("{degrees} degrees, look-ahead at price {price:?}: {ours:.1?}");
            assert!(ours[0] <= chords[0] + labels, "{degrees}, {price:?}: {ours:?}, {chords:?}");
            assert!(ours[1] <= metres * chords[1], "{degrees}, {price:?}: {ours:?}, {chords:?}");
        }
    }
}
