//! The version space against its slow twin: every line through two samples that agrees with all.

use planner_core::error::{GivenError, ObservationError};
use planner_core::{Certainty, Label, Reading, Sample, Site, VersionSpace};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use tests::{clamped, cross, twin, wide};

type Space = VersionSpace<32>;

/// Samples of one line: on a grid so coarse that repeats and collinear triples abound, metres apart
/// near the origin, or kilometres away. A site on the line is given either label.
fn samples() -> impl Strategy<Value = Vec<Sample>> {
    let frame = prop_oneof![
        Just((1i64, 0i64, 0i64)),
        Just((65_536, 0, 0)),
        Just((40_000, 480_000_000, -500_000_000)),
        Just((26_000_000, 0, 0)),
    ];
    let sites = prop::collection::vec((-20..=20i64, -20..=20i64, any::<bool>()), 4..28);
    let line = (-9..=9i64, -9..=9i64, -99..=99i64);
    (frame, sites, line).prop_map(|((scale, x0, z0), sites, (a, b, c))| {
        let sample = |(x, z, coin): (i64, i64, bool)| {
            let value = a * x + b * z + c;
            let above = value > 0 || (value == 0 && coin);
            let label = if above { Label::Positive } else { Label::Negative };
            Sample { site: clamped(x0 + scale * x, z0 + scale * z), label }
        };
        sites.into_iter().map(sample).collect()
    })
}

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(0x11E5),
        failure_persistence: None,
        max_global_rejects: 200_000,
        ..ProptestConfig::default()
    }
}

/// What the twin says of a position.
fn certainty(lines: &[tests::TwinLine], q: Site) -> Certainty {
    match (lines.iter().any(|l| l.at(q) < 0), lines.iter().any(|l| l.at(q) > 0)) {
        (true, true) => Certainty::Uncertain,
        (true, false) => Certainty::Certain(Label::Negative),
        (false, _) => Certainty::Certain(Label::Positive),
    }
}

proptest! {
    #![proptest_config(config(tests::cases(600, 3_000) as u32))]

    #[test]
    fn agrees_with_its_slow_twin(samples in samples(), probes in prop::collection::vec((-30..=30i64, -30..=30i64), 40)) {
        let Ok(space) = Space::new(&samples) else {
            return Err(TestCaseError::reject("no version space"));
        };
        let lines = twin(&samples);
        // The vertices are the twin's lines, all of them and no others.
        for bound in space.bounds() {
            let same = |l: &&tests::TwinLine| {
                let d = l.direction();
                let along = wide(bound.along);
                cross(d, along) == 0 && d[0] * along[0] + d[1] * along[1] > 0 && l.at(bound.through) == 0
            };
            prop_assert!(lines.iter().find(same).is_some(), "{bound:?} is no line of the twin");
        }
        for line in &lines {
            let same = |bound: planner_core::parts::Bound| {
                let (d, along) = (line.direction(), wide(bound.along));
                cross(d, along) == 0 && d[0] * along[0] + d[1] * along[1] > 0 && line.at(bound.through) == 0
            };
            prop_assert!(space.bounds().any(same), "{line:?} is no vertex");
        }
        // Certainty of positions: near the samples, and the samples themselves.
        let step = samples[1].site - samples[0].site;
        let probes = probes.iter().map(|(i, j)| {
            let origin = samples[0].site;
            let along = |k: i64, v: i32| k * i64::from(v) / 8;
            clamped(
                i64::from(origin.x()) + along(*i, step.x()) + j,
                i64::from(origin.z()) + along(*j, step.z()) + i,
            )
        });
        for q in probes.chain(samples.iter().map(|s| s.site)) {
            prop_assert_eq!(space.certainty(q), certainty(&lines, q), "at {:?}", q);
        }
        // The arc has the outermost directions as its ends.
        let arc = space.slope_arc();
        for line in &lines {
            let d = line.direction();
            prop_assert!(cross(wide(arc.from()), d) >= 0 && cross(d, wide(arc.to())) >= 0);
        }
        // The intercepts, in the plainest arithmetic that is precise enough.
        let vertical = lines.iter().any(|l| l.abc[1] <= 0) && lines.iter().any(|l| l.abc[1] >= 0);
        match space.intercepts() {
            None => prop_assert!(vertical),
            Some([low, high]) => {
                prop_assert!(!vertical);
                let of = |l: &tests::TwinLine| -(l.abc[2] as f64) / l.abc[1] as f64 / 65_536.0;
                let (least, most) = lines.iter().map(of).fold(
                    (f64::INFINITY, f64::NEG_INFINITY),
                    |(least, most), c| (least.min(c), most.max(c)),
                );
                let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (1.0 + b.abs());
                prop_assert!(close(low, least) && close(high, most), "{low} {high} {least} {most}");
            }
        }
    }

    #[test]
    fn names_the_first_sample_that_cannot_be_separated(samples in samples(), flips in prop::collection::vec(0..28usize, 0..3)) {
        let mut samples = samples;
        for flip in flips {
            let i = flip % samples.len();
            samples[i].label = -samples[i].label;
        }
        match Space::new(&samples) {
            Ok(_) => prop_assert!(!mixed(&samples)),
            Err(GivenError::NotSeparable(i)) => {
                // Brute force decides this simply. The samples up to this one have no line, those before it have one.
                // There is none if a site has both labels, or lies between two sites of the other label or in a
                // triangle of them. Nor is there one if two segments cross.
                prop_assert!(mixed(&samples[..=i]), "{i} is not too many");
                prop_assert!(!mixed(&samples[..i]), "{i} is not the first");
            }
            Err(GivenError::OneLabel) => {
                prop_assert!(samples.iter().all(|s| s.label == samples[0].label));
            }
            Err(GivenError::Collinear) => {
                prop_assert!(!mixed(&samples));
                let collinear = |s: &Sample| samples.iter().all(|t| {
                    planner_core::lattice::orient(samples[0].site, s.site, t.site) == 0
                });
                prop_assert!(samples.iter().all(collinear));
            }
            Err(other) => prop_assert!(false, "{other}: 28 fit in 32"),
        }
    }

    #[test]
    fn one_by_one_is_the_same_as_all_at_once(samples in samples()) {
        let Some((n, mut space)) = (3..samples.len())
            .find_map(|n| Some((n, Space::new(&samples[..n]).ok()?)))
        else {
            return Err(TestCaseError::reject("no version space"));
        };
        for sample in &samples[n..] {
            if let Err(ObservationError::Contradiction(refused)) = space.insert(*sample) {
                prop_assert_eq!(refused, *sample);
            }
        }
        let kept = Space::new(space.samples()).expect("samples that were all taken");
        let vertices = |space: &Space| {
            let mut all: Vec<_> = space.support().map(|s| (s.site.x(), s.site.z())).collect();
            all.sort_unstable();
            all
        };
        prop_assert_eq!(vertices(&space), vertices(&kept));
    }

    #[test]
    fn a_true_reading_is_never_refused(
        sites in prop::collection::vec((-20..=20i64, -20..=20i64, any::<bool>()), 8..28),
        line in (-9..=9i64, -9..=9i64, -99..=99i64),
    ) {
        let (a, b, c) = line;
        prop_assume!((a, b) != (0, 0));
        let scale = 40_000;
        let read = |x: i64, z: i64| match (a * x + b * z + c).signum() {
            0 => Reading::Boundary,
            side => Reading::Side(if side > 0 { Label::Positive } else { Label::Negative }),
        };
        let sided: Vec<_> = sites.iter().filter_map(|&(x, z, _)| match read(x, z) {
            Reading::Side(label) => Some(Sample { site: clamped(scale * x, scale * z), label }),
            Reading::Boundary => None,
        }).collect();
        let Ok(mut space) = VersionSpace::<64>::new(sided.get(..6).unwrap_or(&[])) else {
            return Err(TestCaseError::reject("no version space"));
        };
        // Many sites on the line itself, from what lies in reach of the grid.
        let on = (-20..=20i64).flat_map(|x| (-20..=20i64).map(move |z| (x, z, x % 2 == 0)));
        let on = on.filter(|&(x, z, _)| read(x, z) == Reading::Boundary).take(20);
        for (x, z, coin) in on.chain(sites) {
            let either = if coin { Label::Positive } else { Label::Negative };
            let observed = space.take(clamped(scale * x, scale * z), read(x, z), either);
            prop_assert!(observed.is_ok(), "({x}, {z}): {observed:?} in {space:?}");
        }
    }

    #[test]
    fn a_contradiction_leaves_everything_as_it_was(samples in samples(), probes in prop::collection::vec((-30..=30i64, -30..=30i64), 20)) {
        let Ok(mut space) = Space::new(&samples) else {
            return Err(TestCaseError::reject("no version space"));
        };
        let before = format!("{space:?}");
        for (x, z) in probes {
            let origin = samples[0].site;
            let q = clamped(i64::from(origin.x()) + 9_000 * x, i64::from(origin.z()) + 9_000 * z);
            if let Certainty::Certain(label) = space.certainty(q) {
                let wrong = Sample { site: q, label: -label };
                // On the border of a region of certainty both labels leave the same closed cell.
                let refused = space.insert(wrong);
                prop_assert_eq!(refused, Err(ObservationError::Contradiction(wrong)));
                prop_assert_eq!(format!("{space:?}"), before.clone());
            }
        }
    }
}

/// Whether no line separates the samples, by brute force: some site of one label lies on a point,
/// a segment or a triangle of the other, or two segments of different labels cross.
fn mixed(samples: &[Sample]) -> bool {
    let of = |label| samples.iter().filter(move |s| s.label == label).map(|s| s.site);
    let turn = |a, b, q| planner_core::lattice::orient(a, b, q).signum();
    let on = |a: Site, b: Site, q: Site| turn(a, b, q) == 0 && (a - q).dot(b - q) <= 0;
    [Label::Negative, Label::Positive].into_iter().any(|label| {
        of(label).any(|q| {
            of(-label).any(|a| {
                of(-label).any(|b| {
                    on(a, b, q)
                        || of(-label).any(|c| {
                            let turns = [turn(a, b, q), turn(b, c, q), turn(c, a, q)];
                            turn(a, b, c) != 0
                                && (turns.iter().all(|t| *t >= 0) || turns.iter().all(|t| *t <= 0))
                        })
                        || of(label).any(|r| {
                            turn(a, b, q) * turn(a, b, r) < 0 && turn(q, r, a) * turn(q, r, b) < 0
                        })
                })
            })
        })
    })
}
