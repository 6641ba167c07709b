//! Sleep and wake: what planners remember beside labels, and bytes that are not such a planner's, which are refused.
//!
//! The random missions of `anything` sleep after every plan and after every label.

use host_sim::campaign::standard_field;
use host_sim::mission::algorithm::Algorithm;
use host_sim::mission::definition::Mission;
use planner_core::SNAPSHOT_VERSION;
use planner_core::error::{ReplayError, RestoreError};
use planner_core::link::message::{MOST_CORNERS, MissionArea};
use planner_core::{
    AnyVehicle, Belief as _, CellPosterior, Cfc, Front, KeepOut, Label, Lookahead, Noise,
    NoisyBelief, Persist as _, Plan, Planner as _, Policy, Pose, Prior, Reliability, Sample, Scc,
    Tolerance, Unicycle, VersionSpace,
};
use tests::anything::flight::{Sleeper, bytes_of, sleep};
use tests::cases;
use tests::ensemble::noisy;

/// What a label's own reliability made of the table is there after the sleep.
#[test]
fn labels_keep_the_reliability_that_they_came_with() {
    let mission = noisy(standard_field::standard(45, 7, Algorithm::Lookahead, 0), 0.8, 0.5);
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
        let before = chance(&awake);
        assert_ne!(before, chance(&told(0.55)), "reliabilities count");
        assert_eq!(chance(&sleep(awake, &make)), before);
    }
}

/// No plan differs where each observation brings a tolerance of its own, and the planner sleeps after each.
fn sleeps_with_own_tolerances<P: Sleeper>(mission: &Mission, make: impl Fn() -> P) {
    let (mut awake, mut asleep, mut pose) = (make(), make(), mission.start);
    for step in 0..mission.steps {
        let plan = awake.plan(pose);
        assert_eq!(plan, asleep.plan(pose), "step {step}: {mission:?}");
        let Plan::Move(motion) = plan else {
            assert!(step > 4, "{step} steps");
            break;
        };
        pose = motion.target;
        let reading = motion.wants_label.then(|| mission.world.reading(pose.site));
        let metres = [0.01, 0.5, 0.0, 0.2, 0.07][step as usize % 5];
        let tolerance = Tolerance::new(metres).expect("a distance");
        for planner in [&mut awake, &mut asleep] {
            // Every third does not say.
            let observed = match step % 3 {
                2 => planner.observe(pose, reading),
                _ => planner.observe_within(pose, reading, tolerance),
            };
            observed.expect("a true label");
        }
        asleep = sleep(asleep, &make);
    }
}

#[test]
fn own_tolerances_outlive_a_sleep() {
    for number in 0..cases(8, 200) {
        let mut mission = standard_field::standard(47, number, Algorithm::Cfc, 24);
        mission.config.tolerance = Tolerance::new(0.5).expect("a distance");
        let (area, vehicle) = (mission.config.area, mission.vehicle);
        sleeps_with_own_tolerances(&mission, || mission.cfc(area, vehicle));
        sleeps_with_own_tolerances(&mission, || mission.lookahead(area, vehicle));
        let mut mission = Mission { steps: 14, ..noisy(mission, 0.9, 0.5) };
        sleeps_with_own_tolerances(&mission, || mission.doubtful(area, vehicle));
        for policy in [Policy::Joint, Policy::MixtureOfOwn] {
            mission.policy = policy;
            sleeps_with_own_tolerances(&mission, || mission.scc(area, vehicle));
        }
    }
}

/// Where they begin.
fn start() -> Pose {
    standard_field::standard(46, 2, Algorithm::Cfc, 0).start
}

fn encoded(planner: &impl Sleeper) -> Vec<u8> {
    bytes_of(&planner.snapshot())
}

/// A snapshot of such a planner, of bytes that can be one.
fn decoded<P: Sleeper>(_: &P, bytes: &[u8]) -> Option<P::Snapshot> {
    postcard::from_bytes(bytes).ok()
}

/// What becomes of a planner that is restored from bytes which can be its snapshot.
fn restored<P: Sleeper>(planner: &mut P, bytes: &[u8]) -> Result<(), RestoreError> {
    let snapshot = decoded(planner, bytes).expect("the same layout");
    planner.restore(&snapshot)
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

#[test]
fn what_is_no_snapshot_of_such_a_planner_is_refused() {
    let (mut cfc, mut lookahead, mut scc) = planners::<16>();
    let [of_cfc, of_lookahead, of_scc] = [encoded(&cfc), encoded(&lookahead), encoded(&scc)];
    let with = |bytes: &[u8], at: usize, byte| {
        let mut bytes = bytes.to_vec();
        bytes[at] = byte;
        bytes
    };
    // Another version, which is the first that is written.
    assert_eq!(u16::from(of_lookahead[0]), SNAPSHOT_VERSION);
    let later = restored(&mut lookahead, &with(&of_lookahead, 0, 8));
    assert_eq!(later, Err(RestoreError::Version(8)));
    // More given samples than there are: the number comes after the version and the mark, whose last byte is below 128.
    let given = |bytes: &[u8]| {
        2 + bytes.iter().skip(1).position(|it| *it < 128).expect("the end of the mark")
    };
    let spoilt = Err(RestoreError::Log(ReplayError::Spoilt));
    assert_eq!(restored(&mut lookahead, &with(&of_lookahead, given(&of_lookahead), 99)), spoilt);
    assert_eq!(restored(&mut scc, &with(&of_scc, given(&of_scc), 99)), spoilt);
    // Another planner's, and another mission's. An audit comes after what the others remember.
    let mission = Err(RestoreError::Mission);
    assert_eq!(restored(&mut lookahead, &[&of_scc[..], &[0; 64]].concat()), mission);
    assert_eq!(restored(&mut scc, &of_lookahead), mission);
    assert_eq!(restored(&mut lookahead, &with(&of_lookahead, 1, of_lookahead[1] ^ 1)), mission);
    // No phase, and no room.
    assert!(decoded(&cfc, &of_cfc).is_some() && decoded(&cfc, &of_scc).is_none());
    let (_, small, _) = planners::<7>();
    assert!(decoded(&small, &encoded(&small)).is_some());
    let mut more = planners::<16>().1;
    let Plan::Move(motion) = more.plan(start()) else { panic!("no motion") };
    more.observe(motion.target, Some(Label::Positive.into())).expect("uncertain ground");
    assert!(decoded(&small, &encoded(&more)).is_none());
    // What was refused left them as good as new.
    for _ in 0..2 {
        assert_eq!(restored(&mut cfc, &of_cfc), Ok(()));
        assert_eq!(restored(&mut lookahead, &of_lookahead), Ok(()));
        assert_eq!(restored(&mut scc, &of_scc), Ok(()));
    }
    assert_eq!(encoded(&scc), of_scc);
}

/// Without a check sum a spoilt snapshot may be another that is possible; it is never more than that.
#[test]
fn spoilt_snapshots_are_refused_or_possible() {
    fn spoil<P: Sleeper>(planner: &mut P) -> [usize; 3] {
        let whole = encoded(planner);
        let mut outcomes = [0; 3];
        let each_bit = (0..8 * whole.len()).map(|bit| {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        });
        for bytes in each_bit.chain((0..whole.len()).map(|len| whole[..len].to_vec())) {
            let Some(snapshot) = decoded(planner, &bytes) else {
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
        assert!(outcomes.iter().all(|it| *it > 0), "not read, refused, taken in: {outcomes:?}");
    }
}

/// A setting of a mission, changed.
type Change = (&'static str, fn(&mut Mission));

const CHANGES: [Change; 4] = [
    ("area", |it| it.config.area = rectangle(20.5, &[])),
    ("keep-out", |it| {
        let disc = KeepOut::disc([19.0, 0.5], 0.1).expect("a disc");
        it.config.area = rectangle(20.0, &[disc]);
    }),
    ("tolerance", |it| it.config.tolerance = Tolerance::new(0.01).expect("a distance")),
    ("vehicle", |it| it.vehicle = AnyVehicle::Unicycle(Unicycle::paper())),
];

const OF_NOISE: [Change; 2] = [
    ("p", |it| *it = noisy(it.clone(), 0.81, 0.5)),
    ("trusted balls", |it| *it = noisy(it.clone(), 0.8, 0.4)),
];

const OF_FRONTS: [Change; 1] = [("speed", |it| it.front = it.front.moving(0.01).expect("a speed"))];

fn rectangle(width: f64, keep_outs: &[KeepOut<MOST_CORNERS>]) -> MissionArea {
    let corners = [[0.0, 0.0], [width, 0.0], [width, 20.0], [0.0, 20.0]];
    MissionArea::metres(&corners, keep_outs).expect("a rectangle")
}

/// A snapshot is of one mission. A planner that was made with another setting refuses it, and its own is taken.
fn refuses_other_missions<P: Sleeper>(
    mission: &Mission,
    changes: &[Change],
    make: impl Fn(&Mission) -> P,
) {
    let snapshot = make(mission).snapshot();
    assert_eq!(make(mission).restore(&snapshot), Ok(()));
    for (what, change) in changes {
        let mut other = mission.clone();
        change(&mut other);
        assert_eq!(make(&other).restore(&snapshot), Err(RestoreError::Mission), "{what}");
    }
}

#[test]
fn snapshots_of_other_missions_are_refused() {
    let mission = standard_field::standard(46, 3, Algorithm::Lookahead, 20);
    refuses_other_missions(&mission, &CHANGES, |it| it.cfc(it.config.area, it.vehicle));
    refuses_other_missions(&mission, &CHANGES, |it| it.lookahead(it.config.area, it.vehicle));
    let doubtful = [&CHANGES[..], &OF_NOISE].concat();
    let mission = noisy(mission, 0.8, 0.5);
    refuses_other_missions(&mission, &doubtful, |it| it.doubtful(it.config.area, it.vehicle));
    refuses_other_missions(&mission, &doubtful, |it| it.scc(it.config.area, it.vehicle));
    let front = Front::bending(30.0).expect("a radius");
    let mission = Mission { algorithm: Algorithm::Track, front, ..mission };
    let of_fronts = [&CHANGES[..], &OF_NOISE[..1], &OF_FRONTS].concat();
    refuses_other_missions(&mission, &of_fronts, |it| it.track(it.config.area, it.vehicle));
    refuses_other_missions(&mission, &of_fronts, |it| it.guard(it.config.area, it.vehicle, 20.0));
}

/// A follower and a guard remember things of the same shape.
#[test]
fn a_guard_refuses_the_bytes_of_a_follower() {
    let mission = standard_field::standard(46, 3, Algorithm::Track, 20);
    let (area, vehicle) = (mission.config.area, mission.vehicle);
    let (follower, mut guard) = (mission.track(area, vehicle), mission.guard(area, vehicle, 20.0));
    let bytes = bytes_of(&follower.snapshot());
    if let Ok(snapshot) = postcard::from_bytes(&bytes) {
        assert_eq!(guard.restore(&snapshot), Err(RestoreError::Mission));
    }
}
