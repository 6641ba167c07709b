//! Sleep and wake. A planner is converted to bytes and back after every plan and every label: its mission has the trace
//! of one that stays awake. Bytes that are not such a planner's are refused.

use crc::{CRC_32_ISO_HDLC, Crc};
use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use host_sim::mission::flight::Flown;
use host_sim::mission::read_out::ReadOut;
use host_sim::mission::recording::{Recorder, Recording};
use host_sim::mission::results::Ending;
use host_sim::report::trace;
use host_sim::world::noise::{Extent, NoiseModel};
use host_sim::world::robot::Glimpse;
use planner_core::SNAPSHOT_VERSION;
use planner_core::error::{ReplayError, RestoreError};
use planner_core::{
    Belief as _, CellPosterior, Cfc, Label, Lookahead, Noise, NoisyBelief, Persist, Plan,
    Planner as _, Policy, Pose, Prior, Reliability, Sample, Scc, Step, Tolerance, Unicycle,
    VersionSpace,
};
use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tests::cases;
use tests::missions::{by_turns, of_any_vehicle, stopping};

static CHECK: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// A planner whose snapshot goes to bytes and back.
trait Sleeper: Persist<Snapshot: Serialize + DeserializeOwned> {}

impl<P: Persist<Snapshot: Serialize + DeserializeOwned>> Sleeper for P {}

/// What is kept while the power is off.
fn bytes_of(planner: &impl Sleeper, pose: Pose) -> Vec<u8> {
    let mut bytes = vec![0; 4_096];
    let kept = (pose, planner.snapshot());
    let used = postcard::to_slice_crc32(&kept, &mut bytes, CHECK.digest()).expect("room");
    used.to_vec()
}

/// Goes to sleep and wakes: another planner, and where it is.
fn sleep<P: Sleeper>(planner: P, pose: Pose, make: &impl Fn() -> P) -> (P, Pose) {
    let bytes = bytes_of(&planner, pose);
    drop(planner);
    let (pose, snapshot): (Pose, P::Snapshot) =
        postcard::from_bytes_crc32(&bytes, CHECK.digest()).expect("what was written");
    let mut woken = make();
    woken.restore(&snapshot).expect("what it told itself");
    assert_eq!(bytes_of(&woken, pose), bytes, "a snapshot of what was restored");
    (woken, pose)
}

/// The trace of a mission whose planner sleeps after every plan and after every label, or what ended it.
fn asleep<P>(mission: &Mission, make: impl Fn() -> P) -> Result<String, String>
where
    P: Sleeper<Belief: ReadOut + Sized + 'static>,
{
    let (mut robot, mut recorder) = (mission.robot(), Recorder::new(mission.clone()));
    let (mut planner, mut pose) = (make(), mission.start);
    let mut ending = Ending::Steps;
    for _ in 0..mission.steps {
        let plan = planner.plan(pose);
        (planner, pose) = sleep(planner, pose, &make);
        let motion = match plan {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => {
                ending = Ending::Stopped(reason);
                break;
            }
        };
        let mut passed = Vec::new();
        let mut pass = |it: Glimpse| passed.extend(it.reading.map(|read| (it.reported, read)));
        let reading = robot.travel(&motion, &mut pose, mission.way(), &mut pass);
        for &(site, reading) in &passed {
            let heard = planner.observe_on_the_way(site, reading);
            heard.map_err(|refused| recorder.refusal(&refused).to_string())?;
            (planner, pose) = sleep(planner, pose, &make);
        }
        let observed = planner.observe(pose, reading);
        observed.map_err(|refused| recorder.refusal(&refused).to_string())?;
        (planner, pose) = sleep(planner, pose, &make);
        recorder.pass(&passed);
        recorder.take(
            &Step { motion, pose, reading, alarm: None },
            robot.true_pose(),
            planner.belief(),
        );
    }
    let recording = recorder.end(Flown { ending, belief: planner.belief().boxed() });
    Ok(trace::lines(&recording.results))
}

/// The same with the planner of the mission.
fn asleep_as_asked(mission: &Mission) -> Result<String, String> {
    let (area, vehicle) = (mission.config.area, mission.vehicle);
    match mission.algorithm {
        Algorithm::Cfc => asleep(mission, || mission.cfc(area, vehicle)),
        Algorithm::Scc => asleep(mission, || mission.scc(area, vehicle)),
        Algorithm::Lookahead if mission.is_noisy() => {
            asleep(mission, || mission.doubtful(area, vehicle))
        }
        Algorithm::Lookahead => asleep(mission, || mission.lookahead(area, vehicle)),
        Algorithm::Track => match mission.watch {
            Some(metres) => asleep(mission, || mission.guard(area, vehicle, metres)),
            None => asleep(mission, || mission.track(area, vehicle)),
        },
        Algorithm::Margin | Algorithm::Random | Algorithm::Lawnmower => {
            panic!("no planner of planner-core")
        }
    }
}

fn sleeps_without_a_trace(what: &str, missions: impl ParallelIterator<Item = Mission>) {
    let steps: usize = missions
        .map(|mission| {
            let awake = Recording::of(&mission).map(|it| trace::lines(&it.results));
            let awake = awake.map_err(|error| error.to_string());
            assert_eq!(asleep_as_asked(&mission), awake, "{what}: {mission:?}");
            awake.map_or(0, |trace| trace.lines().count())
        })
        .sum();
    println!("{what}: {steps} lines of traces");
}

/// So many missions of each planner, and of Algorithm 2 of each policy.
fn missions() -> u64 {
    cases(24, 1_000)
}

fn noisy(mut mission: Mission, p: f64) -> Mission {
    mission.noise = Some(NoiseModel { p, extent: Extent::OutsideBalls(0.5) });
    mission
}

#[test]
fn every_planner_sleeps_at_every_step() {
    let fields = || (0..missions()).into_par_iter();
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        let standard = |number| standard_field::standard(41, number, algorithm, 24);
        sleeps_without_a_trace(&format!("{algorithm:?}"), fields().map(standard));
    }
    for policy in [Policy::Joint, Policy::MixtureOfStart, Policy::MixtureOfOwn] {
        let standard = |number| {
            let mission = standard_field::standard(42, number, Algorithm::Scc, 16);
            Mission { policy, ..noisy(mission, 0.8) }
        };
        sleeps_without_a_trace(&format!("Scc, {policy:?}"), fields().map(standard));
    }
    let doubtful =
        |number| noisy(standard_field::standard(43, number, Algorithm::Lookahead, 16), 0.9);
    sleeps_without_a_trace("Lookahead in noise", fields().map(doubtful));
}

#[test]
fn every_vehicle_and_robots_that_err_sleep_as_well() {
    let number = || (0..cases(24, 240)).into_par_iter();
    sleeps_without_a_trace("any vehicle", number().map(|number| of_any_vehicle(number, 12)));
    sleeps_without_a_trace("by turns", number().map(|number| by_turns(44, number, 16)));
    sleeps_without_a_trace("stopping", number().map(stopping));
}

#[test]
fn readings_on_the_way_outlive_a_sleep() {
    let number = || (0..cases(12, 120)).into_par_iter();
    let reading = |mission: Mission| Mission { readings: 4, ..mission };
    for algorithm in [Algorithm::Cfc, Algorithm::Lookahead] {
        let mission = |number| reading(standard_field::standard(48, number, algorithm, 30));
        sleeps_without_a_trace(&algorithm.name(), number().map(mission));
    }
    for algorithm in [Algorithm::Scc, Algorithm::Lookahead] {
        let mission = |number| {
            let mission = reading(standard_field::standard(49, number, algorithm, 10));
            noisy(mission, 0.8)
        };
        sleeps_without_a_trace(&algorithm.name(), number().map(mission));
    }
}

/// What a label's own reliability made of the table is there after the sleep.
#[test]
fn labels_keep_the_reliability_that_they_came_with() {
    let mission = noisy(standard_field::standard(45, 7, Algorithm::Lookahead, 0), 0.8);
    let middle = standard_field::area().middle();
    for noise in [mission.noise_known().expect("a number"), Noise::NONE] {
        let noise = Noise { reliability: Reliability::new(0.8).expect("a probability"), ..noise };
        let make = || {
            let noisy = NoisyBelief::<36, 529>::new(mission.given.samples(), noise).expect("four");
            Lookahead::new(mission.config.area, mission.vehicle, noisy)
                .expect("settings that agree")
        };
        let told = |first: f64| {
            let mut planner = make();
            for (number, p) in [first, 0.6, 0.99, 0.7].into_iter().enumerate() {
                let Plan::Move(motion) = planner.plan(mission.start) else { panic!("no motion") };
                let label = if number % 2 == 0 { Label::Positive } else { Label::Negative };
                let sample = Sample { site: motion.target.site, label };
                let reliability = Reliability::new(p).expect("a probability");
                planner.belief_mut().take(sample, reliability).expect("a possible label");
            }
            planner
        };
        let chance = |planner: &Lookahead<_, NoisyBelief<36, 529>, _>| {
            planner.belief().chance(middle).to_bits()
        };
        let awake = told(0.9);
        let other = chance(&told(0.55));
        let before = chance(&awake);
        assert_ne!(before, other, "reliabilities count");
        let (woken, _) = sleep(awake, mission.start, &make);
        assert_eq!(chance(&woken), before);
    }
}

/// Plans of a planner whose observations each bring a tolerance of their own; with `make` it sleeps after each of them.
fn plans_with_own_tolerances<P: Sleeper>(
    mission: &Mission,
    mut planner: P,
    make: Option<&dyn Fn() -> P>,
) -> Vec<Plan> {
    let truth = mission.world.line().expect("a line divides it");
    let (mut pose, mut plans) = (mission.start, Vec::new());
    for step in 0..mission.steps {
        let plan = planner.plan(pose);
        plans.push(plan);
        let Plan::Move(motion) = plan else { break };
        pose = motion.target;
        let is_above = truth.distance(pose.site.into()) >= 0.0;
        let label = if is_above { Label::Positive } else { Label::Negative };
        let reading = motion.wants_label.then_some(label.into());
        let metres = [0.01, 0.5, 0.0, 0.2, 0.07][step as usize % 5];
        let tolerance = Tolerance::new(metres).expect("a distance");
        // Every third does not say.
        let observed = match step % 3 {
            2 => planner.observe(pose, reading),
            _ => planner.observe_within(pose, reading, tolerance),
        };
        observed.expect("a true label");
        if let Some(make) = make {
            (planner, pose) = sleep(planner, pose, &make);
        }
    }
    plans
}

/// How many plans differ where each observation brings a tolerance of its own: none.
#[test]
fn own_tolerances_outlive_a_sleep() {
    fn check<P: Sleeper>(what: &str, mission: &Mission, make: impl Fn() -> P) {
        let awake = plans_with_own_tolerances(mission, make(), None);
        let asleep = plans_with_own_tolerances(mission, make(), Some(&make));
        let differ = awake.iter().zip(&asleep).filter(|(a, b)| a != b).count();
        assert_eq!((differ, asleep.len()), (0, awake.len()), "{what}");
        assert!(awake.len() > 4, "{what}: {} plans", awake.len());
    }
    for number in 0..cases(8, 200) {
        let mut mission = standard_field::standard(47, number, Algorithm::Cfc, 24);
        mission.config.tolerance = Tolerance::new(0.5).expect("a distance");
        let (area, vehicle) = (mission.config.area, mission.vehicle);
        check("Cfc", &mission, || mission.cfc(area, vehicle));
        check("Lookahead", &mission, || mission.lookahead(area, vehicle));
        let mut mission = Mission { steps: 14, ..noisy(mission, 0.9) };
        check("Lookahead in noise", &mission, || mission.doubtful(area, vehicle));
        for policy in [Policy::Joint, Policy::MixtureOfOwn] {
            mission.policy = policy;
            check("Scc", &mission, || mission.scc(area, vehicle));
        }
    }
}

/// Where they begin.
fn start() -> Pose {
    standard_field::standard(46, 2, Algorithm::Cfc, 0).start
}

fn encoded(value: &impl Serialize) -> Vec<u8> {
    postcard::to_slice(value, &mut [0; 1_024]).expect("room").to_vec()
}

/// Planners with room for `N` samples, that have taken in three labels.
fn planners<const N: usize>()
-> (Cfc<Unicycle, N>, Lookahead<Unicycle, VersionSpace<N>>, Scc<Unicycle, N, 30>) {
    let mission = standard_field::standard(46, 2, Algorithm::Cfc, 0);
    let (area, options) = (standard_field::area(), mission.config.options());
    let (given, unicycle) = (mission.given.samples(), Unicycle::paper());
    let space = VersionSpace::new(given).expect("four points");
    let noise = Noise::new(0.8).expect("a probability");
    let table = CellPosterior::new(given, Prior::Area, noise).expect("four points");
    let agree = "settings that agree";
    let mut cfc = Cfc::new(area, unicycle, space.clone()).expect(agree).with(options);
    let mut lookahead = Lookahead::new(area, unicycle, space).expect(agree);
    let scc = Scc::new(area, unicycle, table).expect(agree);
    let mut scc = scc.with(options).voting(Policy::Joint);
    for label in [Label::Positive, Label::Negative, Label::Positive] {
        let Plan::Move(motion) = lookahead.plan(mission.start) else { panic!("no motion") };
        let reading = Some(label.into());
        cfc.observe(motion.target, reading).expect("uncertain ground");
        lookahead.observe(motion.target, reading).expect("uncertain ground");
        scc.observe(motion.target, reading).expect("any label");
    }
    (cfc, lookahead, scc)
}

/// Whether bytes can be a snapshot of such a planner.
fn reads<P: Sleeper>(_: &P, bytes: &[u8]) -> bool {
    postcard::from_bytes::<P::Snapshot>(bytes).is_ok()
}

#[test]
fn what_is_no_snapshot_of_such_a_planner_is_refused() {
    let (mut cfc, mut lookahead, mut scc) = planners::<16>();
    let of_cfc = encoded(&cfc.snapshot());
    let of_lookahead = encoded(&lookahead.snapshot());
    let of_scc = encoded(&scc.snapshot());

    // Another version, which is the first that is written.
    let mut later = of_lookahead.clone();
    assert_eq!(u16::from(later[0]), SNAPSHOT_VERSION);
    later[0] = 9;
    let later = postcard::from_bytes(&later).expect("the same layout");
    assert_eq!(lookahead.restore(&later), Err(RestoreError::Version(9)));

    // More given samples than there are: the number comes after the version.
    let mut more_given = of_lookahead.clone();
    more_given[1] = 99;
    let spoilt = Err(RestoreError::Log(ReplayError::Spoilt));
    assert_eq!(lookahead.restore(&postcard::from_bytes(&more_given).expect("as told")), spoilt);
    let mut more_given = of_scc.clone();
    more_given[1] = 99;
    assert_eq!(scc.restore(&postcard::from_bytes(&more_given).expect("as told")), spoilt);

    // The other kind of labels.
    let kind = Err(RestoreError::Log(ReplayError::Kind));
    // An audit comes after what the others remember.
    let as_lookahead = [&of_scc[..], &[0; 32]].concat();
    let as_lookahead = postcard::from_bytes(&as_lookahead).expect("as it is told");
    assert_eq!(lookahead.restore(&as_lookahead), kind);
    assert_eq!(scc.restore(&postcard::from_bytes(&of_lookahead).expect("as it is told")), kind);

    // No phase, and no room.
    assert!(reads(&cfc, &of_cfc) && !reads(&cfc, &of_scc));
    let (_, small, _) = planners::<7>();
    assert!(reads(&small, &encoded(&small.snapshot())));
    let more = {
        let mut planner = planners::<16>().1;
        let Plan::Move(motion) = planner.plan(start()) else { panic!("no motion") };
        planner.observe(motion.target, Some(Label::Positive.into())).expect("uncertain ground");
        encoded(&planner.snapshot())
    };
    assert!(!reads(&small, &more));

    // What was refused left them as good as new.
    for _ in 0..2 {
        cfc.restore(&postcard::from_bytes(&of_cfc).expect("its own")).expect("its own");
        lookahead.restore(&postcard::from_bytes(&of_lookahead).expect("its own")).expect("its own");
        scc.restore(&postcard::from_bytes(&of_scc).expect("its own")).expect("its own");
    }
    assert_eq!(encoded(&scc.snapshot()), of_scc);
}

/// Without a check sum a spoilt snapshot may be another that is possible; it is never more than that.
#[test]
fn spoilt_snapshots_are_refused_or_possible() {
    fn spoil<P: Sleeper>(planner: &mut P) -> [usize; 3] {
        let whole = encoded(&planner.snapshot());
        let mut outcomes = [0; 3];
        let each_bit = (0..8 * whole.len()).map(|bit| {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        });
        for bytes in each_bit.chain((0..whole.len()).map(|len| whole[..len].to_vec())) {
            let Ok(snapshot) = postcard::from_bytes::<P::Snapshot>(&bytes) else {
                outcomes[0] += 1;
                continue;
            };
            let restored = planner.restore(&snapshot);
            outcomes[if restored.is_ok() { 2 } else { 1 }] += 1;
            let _ = (planner.plan(start()), planner.estimates());
        }
        outcomes
    }
    let (mut cfc, mut lookahead, mut scc) = planners::<16>();
    for outcomes in [spoil(&mut cfc), spoil(&mut lookahead), spoil(&mut scc)] {
        println!("not read, refused, taken in: {outcomes:?}");
        assert!(outcomes.iter().all(|it| *it > 0), "{outcomes:?}");
    }
}
