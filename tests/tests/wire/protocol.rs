//! `docs/protocol.schema` and `docs/protocol.vectors` say what `planner-core` sends. Both are written from its types:
//! `UPDATE_EXPECT=1` writes them, and comments of the schema stay. `docs/wire.py` reads the vectors by the schema.

use std::fmt::{Debug, Write as _};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use expect_test::expect_file;
use host_sim::hil::setup;
use host_sim::mission::algorithm::Algorithm as Planner;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use planner_core::error::{GivenError, GridError, ObservationError, RoomError, ShapeError};
use planner_core::link::delivery::Link;
use planner_core::link::frame::{Decoder, Envelope, FRAME, Frame, Message};
use planner_core::link::message::{
    Accepted, Algorithm, Capacity, ChartFault, ChartPiece, ChartShape, ClockRate, DeclinedError,
    EndReason, LabelSource, MOST_GIVEN, MOST_KEEP_OUTS, MissionArea, MissionEnd, Move, Outline,
    PROTOCOL, Reply, Request, Settings, Setup, Took,
};
use planner_core::{
    Angle, Area, Car, CarShape, Crossing, EffortWeight, Estimates, Far, Following, Front,
    FrontState, FrontStretch, Goal, Heading, Hull, KeepOut, Label, LocalLine, Motion, Noise,
    Policy, Pose, Prior, Reading, Recovery, Reliability, Sample, Site, Stage, StopReason,
    Tolerance, Unicycle, UnicycleShape, VehicleShape, Waist,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use tests::build;
use tests::chip::Socket;
use tests::lakes;

use crate::traced::{self, Schema};

fn docs() -> PathBuf {
    build::root().join("docs")
}

fn page(name: &str) -> String {
    fs::read_to_string(docs().join(name)).expect(name)
}

/// The frame of a content: its check sum behind it, bit by bit, then COBS group by group.
fn framed(content: &[u8]) -> Vec<u8> {
    let mut sum = u32::MAX;
    for byte in content {
        sum ^= u32::from(*byte);
        for _ in 0..8 {
            sum = sum >> 1 ^ if sum & 1 == 1 { 0xEDB8_8320 } else { 0 };
        }
    }
    let whole = [content, &(!sum).to_le_bytes()].concat();
    let mut frame = vec![0];
    for part in whole.split(|byte| *byte == 0) {
        let mut groups = part.chunks_exact(254);
        for group in &mut groups {
            frame.push(255);
            frame.extend(group);
        }
        frame.push(groups.remainder().len() as u8 + 1);
        frame.extend(groups.remainder());
    }
    frame.push(0);
    frame
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

/// What a receiver takes these bytes for, both ways.
fn heard(bytes: &[u8]) -> Vec<String> {
    fn of<M: Message + Debug>(bytes: &[u8]) -> Vec<String> {
        let mut decoder = Decoder::default();
        let envelopes = bytes.iter().filter_map(|byte| decoder.feed::<M>(*byte));
        envelopes.map(|it| format!("{it:?}")).collect()
    }
    [of::<Request>(bytes), of::<Reply>(bytes)].concat()
}

/// The vectors, and the schema of what is in them.
#[derive(Default)]
struct Vectors {
    text: String,
    schema: Schema,
    /// Names with their contents. A name without a slash is a seed of the fuzz target `frames`.
    contents: Vec<(String, Vec<u8>)>,
}

impl Vectors {
    /// Adds a message as the planner's encoder writes it.
    fn add<M: Message + Debug>(&mut self, name: &str, session: u32, number: u32, message: M) {
        let mut bytes = [0; FRAME];
        let bare = postcard::to_slice(&message, &mut bytes).expect("it fits");
        traced::read::<M>(bare, &mut self.schema);
        let envelope = Envelope::new(session, number, message);
        let mut bytes = [0; FRAME];
        let content = postcard::to_slice(&envelope, &mut bytes).expect("it fits").to_vec();
        let frame = Frame::of(&envelope);
        assert_eq!(hex(frame.bytes()), hex(&framed(&content)), "{name}");
        assert_eq!(heard(frame.bytes()), [format!("{envelope:?}")], "{name}");
        let said = serde_json::to_string(&envelope).expect("numbers and names");
        self.line(name, frame.bytes(), &format!("\"envelope\":{said}"));
        self.contents.push((name.to_owned(), content));
    }

    /// Adds a frame that is no message.
    fn refuse(&mut self, name: &str, frame: &[u8], why: &str) {
        assert!(heard(frame).is_empty(), "{name}: {:?}", heard(frame));
        self.line(name, frame, &format!("\"refused\":\"{why}\""));
    }

    fn line(&mut self, name: &str, frame: &[u8], said: &str) {
        let start = format!("{{\"name\":\"{name}\",");
        assert!(!self.text.contains(&start), "two vectors of one name: {name}");
        let _ = writeln!(self.text, "{start}\"frame\":\"{}\",{said}}}", hex(frame));
    }
}

const BY_CAR: &str = r#"
algorithm = "lookahead"
steps = 20
vehicle = { kind = "car", radius = 1.0, shortest = 0.3 }
tolerance = 0.06
area = { polygon = [[0, 0], [20, 0], [20, 15], [8, 20]] }
keep_out = [{ x = 5.0, z = 6.0, radius = 1.0 }, { polygon = [[9, 9], [11, 9], [10, 11]] }]
start = { heading = 0.5 }
truth = { slope = 0.41, intercept = 3.5 }
noise = { p = 0.9, trusted_radius = 0.5 }
stop = { slope_arc_deg = 2.0, level = 0.95 }
oracle = [
  { x = 2.0, z = 1.0, label = -1 },
  { x = 4.0, z = 8.0, label = 1 },
  { x = 16.0, z = 15.0, label = 1 },
  { x = 18.0, z = 5.0, label = -1 },
]
"#;

const ALONG_FRONT: &str = r#"
algorithm = "track"
steps = 90
area = { x = [0.0, 160.0], z = [0.0, 60.0] }
front = { radius = 20.0, speed = 0.02 }
truth = { sine = [3.0, 60.0, 0.0], intercept = 30.0 }
noise = { p = 0.9 }
stop = { closed = true }
start = { x = 8.0, z = 30.0 }
oracle = [
  { x = 4.0, z = 20.0, label = -1 },
  { x = 4.0, z = 40.0, label = 1 },
]
"#;

fn read(text: &str, overrides: Overrides) -> Mission {
    scenario::parse("", text, overrides).expect("a good scenario")
}

fn setup(mission: &Mission, labels: LabelSource) -> Setup {
    setup::setup(mission, labels).expect("a mission for a chip")
}

/// A mission that is a setup, an answer and so on: session 8 is the paper's noiseless example, whose frames these are in
/// their order.
fn missions(vectors: &mut Vectors) {
    let plain = Overrides::default();
    let paper = read(scenario::PAPER_NOISELESS, plain);
    let noisy = read(scenario::PAPER_NOISY, plain);
    let lookahead = Overrides { algorithm: Some(Planner::Lookahead), ..plain };
    let stops = format!("{}\nstop = {{ misclassified = 0.001 }}\n", scenario::PAPER_NOISELESS);
    let by_lookahead = read(&stops, lookahead);
    let by_car = read(BY_CAR, plain);
    let flown = Recording::of(&paper).expect("labels are true");
    let [first, second] = [0, 1].map(|step: usize| flown.steps[step]);
    let last = flown.steps[flown.steps.len() - 1];

    vectors.add("hello", 0, 1, Request::Hello { protocol: PROTOCOL });
    vectors.add("setup-of-algorithm-1", 8, 1, Reply::Setup(setup(&paper, LabelSource::Vehicle)));
    let clock = ClockRate { per_second: 168_000_000, emulated: true };
    let capacity = Capacity { samples: 68, hypotheses: 1 };
    vectors.add("ready", 8, 2, Request::Ready(Accepted { capacity, clock }));
    vectors.add("noted", 8, 2, Reply::Noted);
    let took = Took { observe: 0, plan: 71_234, estimate: 0 };
    vectors.add("move", 8, 3, Request::Move(Move { motion: first.motion, last: None, took }));
    vectors.add("busy", 8, 3, Reply::Busy);
    vectors.add("arrived", 8, 3, Reply::Arrived { pose: first.pose, reading: first.reading });
    let took = Took { observe: 35_801, plan: 68_110, estimate: 0 };
    let (motion, told) = (second.motion, first.reading);
    vectors.add("move-the-next", 8, 4, Request::Move(Move { motion, last: told, took }));
    vectors.add("arrived-no-reading", 8, 4, Reply::Arrived { pose: second.pose, reading: None });
    vectors.add("failed", 8, 4, Reply::Failed);
    let took = Took { observe: 30_977, plan: 60_502, estimate: 52_190 };
    let (reason, estimates) = (EndReason::Steps, flown.belief.estimates());
    let end = MissionEnd { reason, last: last.reading, took, estimates };
    vectors.add("end", 8, 13, Request::End(end));
    vectors.add("stale", 7, 12, Reply::Stale);

    let twice = Recording::of(&Mission { readings: 2, ..paper.clone() }).expect("labels are true");
    let passed = twice.results.steps[0].passed().next();
    let (site, reading) = passed.map(|(site, it)| (site, Some(it))).expect("one on the way");
    vectors.add("ontheway", 12, 3, Reply::OnTheWay { site, reading });
    vectors.add("onward", 12, 4, Request::Onward { last: reading });

    vectors.add("setup-of-algorithm-2", 9, 1, Reply::Setup(setup(&noisy, LabelSource::Vehicle)));
    let least = DeclinedError::Capacity(Capacity { samples: 36, hypotheses: 529 });
    vectors.add("declined", 9, 2, Request::Declined(least));
    let by_true = setup(&by_lookahead, LabelSource::Vehicle);
    vectors.add("setup-of-look-ahead-true-labels", 10, 1, Reply::Setup(by_true.clone()));
    let by_doubtful = setup(&by_car, LabelSource::Chip);
    vectors.add("setup-of-look-ahead-labels-in-doubt", 11, 1, Reply::Setup(by_doubtful));
    vectors.add("outline-asked", 11, 2, Request::Outline(0));
    let mut outlines = setup::outlines(&by_car.config.area);
    let mut outline = || Reply::Outline(outlines.next().expect("one more"));
    vectors.add("outline-the-border", 11, 2, outline());
    vectors.add("outline-a-disc", 11, 3, outline());

    let in_lake = lakes::mission(20, 24);
    let by_map = setup(&in_lake, LabelSource::Vehicle);
    vectors.add("setup-in-a-lake", 17, 1, Reply::Setup(by_map));
    let chart = in_lake.lake.expect("a lake").chart;
    vectors.add("chart-asked", 17, 3, Request::Chart);
    vectors.add("chart", 17, 3, Reply::Chart(ChartShape::of(&chart)));
    vectors.add("cells-asked", 17, 4, Request::Cells(0));
    let piece = ChartPiece::of(&chart, 0).expect("cells");
    vectors.add("cells", 17, 4, Reply::Cells(piece));

    let along_front = read(ALONG_FRONT, plain);
    let by_tracker = setup(&along_front, LabelSource::Vehicle);
    vectors.add("setup-of-a-follower-of-fronts", 13, 1, Reply::Setup(by_tracker.clone()));
    let watched = ALONG_FRONT.replace("speed = 0.02", "speed = 0.02, watch = 30.0");
    let watched = read(&watched.replace("stop = { closed = true }\n", ""), plain);
    let by_guard = setup(&watched, LabelSource::Vehicle);
    vectors.add("setup-of-a-guard-of-a-front", 14, 1, Reply::Setup(by_guard));
    let waist = Waist {
        site: Site::metres([8.25, 30.5]).expect("near"),
        heading: Heading::from_radians(0.25).expect("an angle"),
        curvature: -0.03125,
        deviation: 0.375,
        turn_deviation: 0.125,
    };
    let found = FrontState { waist: Some(waist), is_closed: false };
    vectors.add("front", 13, 6, Request::Front(found));
    vectors.add("front-not-found", 13, 4, Request::Front(FrontState::default()));

    options(vectors, &paper, &by_true);
    requests(vectors, first.motion);
    groups(vectors, &by_tracker);
}

/// What the setups of [`missions`] do not choose.
fn options(vectors: &mut Vectors, paper: &Mission, by_true: &Setup) {
    let Algorithm::Lookahead { evaluations, noise, sight, .. } = by_true.algorithm else {
        unreachable!("look-ahead")
    };
    let far = Far::at_price(80.0).expect("a price").with_labels(24);
    let priced = Algorithm::Lookahead { evaluations, noise, goal: None, sight: Some(far).into() };
    let most_labels = Some(24);
    let priced = Setup { algorithm: priced, most_labels, ..by_true.clone() };
    vectors.add("setup/price", 15, 1, Reply::Setup(priced));
    let goal = Goal::slope_within_degrees(0.5).expect("an angle");
    let sight = sight.with_readings(5);
    let goal = Some(goal.into());
    let several = Algorithm::Lookahead { evaluations, noise, goal, sight };
    vectors.add(
        "setup/readings",
        15,
        1,
        Reply::Setup(Setup { algorithm: several, ..by_true.clone() }),
    );

    let good = setup(paper, LabelSource::Vehicle);
    let VehicleShape::Unicycle(steps) = good.vehicle else { unreachable!("a unicycle") };
    let boat = Setup { vehicle: VehicleShape::Boat(steps), ..good.clone() };
    vectors.add("setup/boat", 15, 1, Reply::Setup(boat));
    for (name, crossing, following, policy, prior) in [
        ("joint", Crossing::AlongOracle, Following::Unrestricted, Policy::Joint, Prior::Sequences),
        (
            "mixture-of-start",
            Crossing::AcrossBisector,
            Following::AlongBisector,
            Policy::MixtureOfStart,
            Prior::Area,
        ),
    ] {
        let algorithm = Algorithm::Scc { noise: Noise::NONE, policy, prior };
        let config = Settings { crossing, following, ..good.config };
        let setup = Setup { algorithm, config, ..good.clone() };
        vectors.add(&format!("setup/{name}"), 15, 1, Reply::Setup(setup));
    }
}

/// Each reason and stage that the chip can send.
fn requests(vectors: &mut Vectors, motion: Motion) {
    let site = Site::metres([8.0, 2.0]).expect("near");
    let sample = Sample { site, label: Label::Negative };
    let mut named = |kind: &str, name: String, request: Request| {
        let words = name.split(|it: char| !it.is_alphanumeric()).filter(|it| !it.is_empty());
        let name = words.take(2).collect::<Vec<_>>().join("-").to_lowercase();
        vectors.add(&format!("{kind}/{name}"), 8, 9, request);
    };
    let given = [
        GivenError::Collinear,
        GivenError::OneLabel,
        GivenError::NotSeparable(3),
        GivenError::TooMany,
        GivenError::TooVague,
        GivenError::Tolerance,
        GivenError::Reliability,
    ];
    let grid = [GridError::Actions, GridError::Reach, GridError::Turn, GridError::Circle];
    let shapes = grid.map(ShapeError::Grid).into_iter();
    let shapes =
        shapes.chain([ShapeError::Kind, ShapeError::Room(RoomError { across_mm: 24_100 })]);
    let declined = [
        DeclinedError::Protocol(PROTOCOL + 1),
        DeclinedError::Algorithm,
        DeclinedError::Labels,
        DeclinedError::Area,
        DeclinedError::Tolerance,
        DeclinedError::Goal,
        DeclinedError::Price,
    ];
    let charts = [
        ChartFault::Room(512),
        ChartFault::Shape,
        ChartFault::Missing(7),
        ChartFault::Repeated(6),
        ChartFault::Wrong(7),
        ChartFault::Sum,
    ];
    let declined = declined.into_iter().chain(given.map(DeclinedError::Given));
    let declined = declined.chain(charts.map(DeclinedError::Chart));
    for why in declined {
        named("declined", format!("{why:?}"), Request::Declined(why));
    }
    for why in shapes {
        let name = format!("{why:?}").replace("Grid", "").replace("RoomError", "");
        named("declined/vehicle", name, Request::Declined(DeclinedError::Vehicle(why)));
    }

    let stops = [
        StopReason::Resolution,
        StopReason::SamplesFull,
        StopReason::OutsideArea,
        StopReason::Cornered,
        StopReason::Known,
        StopReason::Undecided,
        StopReason::Tolerance,
        StopReason::NoLine,
        StopReason::Worth,
        StopReason::Closed,
        StopReason::OneLabel,
    ];
    let refused = [
        ObservationError::Contradiction(sample),
        ObservationError::Full(sample),
        ObservationError::Tolerance(Tolerance::new(0.5).expect("a tolerance")),
        ObservationError::Reliability,
    ];
    let ends = stops.map(EndReason::Stopped).into_iter().chain(refused.map(EndReason::Refused));
    for reason in ends.chain([EndReason::Sensor, EndReason::Vehicle, EndReason::Labels]) {
        let estimates = Estimates { bisector: None, centre: None, maximum_margin: None };
        let end = MissionEnd { reason, last: None, took: Took::default(), estimates };
        named("end", format!("{reason:?}"), Request::End(end));
    }

    let stages = [
        Stage::P1,
        Stage::P2,
        Stage::P3,
        Stage::P4,
        Stage::Audit,
        Stage::Seek,
        Stage::Follow,
        Stage::Pass,
        Stage::Return,
    ];
    let recoveries = [Recovery::Undirected, Recovery::Reorient, Recovery::Transit];
    let kinds = stages.map(|it| (Some(it), None)).into_iter();
    for (stage, recovery) in kinds.chain(recoveries.map(|it| (None, Some(it)))) {
        let motion = Motion { stage, recovery, ..motion };
        let last = Some(Reading::Boundary);
        let name =
            stage.map_or(format!("{recovery:?}").replace("Some", ""), |it| format!("{it:?}"));
        named("move", name, Request::Move(Move { motion, last, took: Took::default() }));
    }
}

/// Setups with 254 bytes without a zero, at the end of the frame, before a zero, and before another byte.
fn groups(vectors: &mut Vectors, of: &Setup) {
    let Algorithm::Track { front, mut noise, .. } = of.algorithm else { unreachable!("track") };
    noise.trusted_radius = 1 << 16;
    noise.tolerance = Tolerance::new(0.05).expect("a tolerance");
    let algorithm = Algorithm::Track { front, noise, ends: true };
    let corner = |x: f64, z: f64| Site::metres([x, z]).expect("near");
    let area = Area::new(corner(-4_000.0, -4_000.0), corner(4_000.0, 4_000.0)).expect("an inside");
    let (crossing, tolerance) = (Crossing::AcrossBisector, noise.tolerance);
    let config = Settings { area, crossing, tolerance, ..of.config };
    let VehicleShape::Unicycle(steps) = of.vehicle else { unreachable!("a unicycle") };
    let start = Pose { site: corner(-2_800.5, 2_700.25), heading: Heading(1 << 29) };
    // Coordinates beyond 2,048 m take a byte more.
    let full = |near: u8, steps_at_most: u16, last: Label| {
        let sample = |k| Sample {
            site: if k < near { corner(-700.5, 500.25) } else { corner(-2_700.5, 2_500.25) },
            label: if usize::from(k) + 1 < MOST_GIVEN { Label::Positive } else { last },
        };
        Setup {
            algorithm,
            config,
            keep_outs: Some(1),
            vehicle: VehicleShape::Boat(steps),
            steps: steps_at_most,
            most_labels: Some(60),
            start,
            labels: LabelSource::Chip,
            given: (0..MOST_GIVEN as u8).map(sample).collect(),
            ..of.clone()
        }
    };
    let lengths = (0..16).flat_map(|near| (120..140).map(move |steps| (near, steps)));
    let all = [Label::Negative, Label::Positive].map(|last| {
        lengths.clone().map(move |(near, steps)| full(near, steps, last)).collect::<Vec<_>>()
    });
    let all = all.concat();
    // The zero that the number of the message is comes before the long group.
    let mut add = |name: &str, ends_so: &dyn Fn(&[u8]) -> bool| {
        let is_one = |setup: &&Setup| {
            let frame = Frame::of(&Envelope::new(16, 1, Reply::Setup((*setup).clone())));
            frame.bytes()[5] == 255 && frame.bytes().get(260..).is_some_and(ends_so)
        };
        let setup = all.iter().find(is_one).expect(name).clone();
        vectors.add(name, 16, 1, Reply::Setup(setup));
    };
    add("setup/ends-with-254", &|rest| rest == [1, 0]);
    add("setup/zero-after-254", &|rest| rest[0] == 1 && rest.len() > 2);
    add("setup/beyond-254", &|rest| rest[0] > 1);
    vectors.add("stale/largest-numbers", u32::MAX, u32::MAX, Reply::Stale);
}

/// What is no message, although most of it has the right check sum.
fn refused(vectors: &mut Vectors) {
    let mut spoiled = framed(&[0x3f, 12, 4, 6, 1, 0, 0]);
    spoiled[3] ^= 1;
    vectors.refuse("refused/check-sum", &spoiled, "another check sum");
    vectors.refuse("refused/empty", &[0, 0], "no content");
    vectors.refuse("refused/cobs", &[0, 9, 0x3f, 12, 4, 6, 0], "a group ends too early");
    for (name, content, why) in [
        ("way", &[0x22, 12, 4, 6, 0][..], "a way that there is not"),
        ("too-short", &[0x3f, 12, 4, 6], "content ends too early"),
        ("too-long", &[0x3f, 12, 4, 6, 0, 0], "content goes on"),
        ("variant", &[0x3f, 12, 4, 10], "a variant that there is not"),
        ("bool", &[0x3f, 13, 4, 7, 0, 2], "a bool of 2"),
        ("optional", &[0x3f, 12, 4, 6, 2, 1], "an optional that begins with 2"),
        ("u16", &[0x3f, 0, 1, 0, 0x80, 0x80, 4], "65536 is no u16"),
        ("u32", &[0x3f, 0xff, 0xff, 0xff, 0xff, 0x10, 1, 6, 0], "2^32 is no u32"),
        ("varint", &[0x3f, 0x80, 0x80, 0x80, 0x80, 0x80, 0, 1, 6, 0], "six bytes for a u32"),
        ("list", &[&[0x21, 11, 2, 1, 9][..], &[2; 18], &[0]].concat(), "nine corners"),
    ] {
        vectors.refuse(&format!("refused/{name}"), &framed(content), why);
    }
}

fn vectors() -> Vectors {
    let mut vectors = Vectors::default();
    missions(&mut vectors);
    refused(&mut vectors);
    vectors
}

/// Each kind of value, of reason and of stage has a vector, and the files are as the code writes them.
#[test]
fn the_files_are_what_is_sent() {
    let Vectors { text, schema, .. } = vectors();
    assert_eq!(schema.unread(), [""; 0], "no vector has these");
    let former = page("protocol.schema");
    let head: String = former.split_inclusive('\n').take_while(|it| it.starts_with('#')).collect();
    let envelope = former.split("\n\n").nth(1).expect("the envelope");
    let types = schema.text(&["Request", "Reply"], &former);
    let written = format!("{head}\n{envelope}\n\n{types}");
    expect_file!["../../../docs/protocol.schema"].assert_eq(&written);
    expect_file!["../../../docs/protocol.vectors"].assert_eq(&text);
}

/// A receiver takes a group of 254 bytes at the end of a frame with an empty group behind it and without.
#[test]
fn an_empty_group_at_the_end_may_be_left_out() {
    let vectors = vectors();
    let (_, content) =
        vectors.contents.iter().find(|it| it.0 == "setup/ends-with-254").expect("it");
    let frame = framed(content);
    let (rest, end) = frame.split_at(frame.len() - 2);
    assert_eq!(end, [1, 0]);
    let shorter = [rest, &[0]].concat();
    assert_eq!(heard(&shorter), heard(&frame));
    assert_eq!(heard(&shorter).len(), 1);
}

/// The comments of the schema state what the types refuse.
#[test]
fn the_schema_states_the_limits() {
    /// What of these is a value of a type.
    fn taken<T: DeserializeOwned, V: Serialize>(values: [V; 2]) -> [bool; 2] {
        values.map(|value| {
            let mut bytes = [0; 64];
            let bytes = postcard::to_slice(&value, &mut bytes).expect("it fits");
            postcard::from_bytes::<T>(bytes).is_ok()
        })
    }
    let schema = page("protocol.schema");
    let lattice = 1 << 29;
    let certain = 1_000_i64 << 32;
    let line = |along: i32, slope: f32| ((0, 0), [along, 1], [slope, 0.0]);
    let unicycle = |turn_step_urad, speeds, speed_step_mm| {
        let sharpest = Angle(1 << 30);
        let shape = UnicycleShape { turn_step_urad, sharpest, speeds, speed_step_mm };
        Unicycle::of(shape).is_ok()
    };
    let car = |radius_mm, turn_step_urad| {
        let (shortest_mm, speeds, speed_step_mm) = (0, 21, 100_000 - 1);
        let shape = CarShape { radius_mm, shortest_mm, turn_step_urad, speeds, speed_step_mm };
        Car::new(shape).is_ok()
    };
    let disc = |radius| {
        let corner = |x, z| Site::new(x, z).expect("near");
        let corners = [corner(0, 0), corner(9, 0), corner(0, 9)];
        let hull = Hull::new(&corners).expect("a triangle");
        let corners = corners.iter().take(1).copied().collect();
        let disc = KeepOut::try_from(Outline { corners, radius }).expect("a disc");
        MissionArea::new(hull, &[disc]).is_ok()
    };
    let goal = Goal::misclassified_share(0.5).expect("a share");
    for (name, said, taken) in [
        ("Site", "size below 2^29", taken::<Site, _>([(lattice - 1, 0), (lattice, 0)])),
        ("weight", "below 1,000,000", taken::<EffortWeight, _>([999_999_u32, 1_000_000])),
        ("tolerance", "at most 2^26", taken::<Tolerance, _>([1_u32 << 26, (1 << 26) + 1])),
        ("reliability", "at most 1,000 * 2^32", taken::<Reliability, _>([certain, certain + 1])),
        ("Front", "100 to 1,000,000,000", taken::<Front, _>([[100, 0], [99_u32, 0]])),
        (
            "Front",
            "100 to 1,000,000,000",
            taken::<Front, _>([[1_000_000_000_u32, 0], [1_000_000_001, 0]]),
        ),
        (
            "Front",
            "up to 1,000,000,000",
            taken::<Front, _>([[0, 1_000_000_000_u32], [0, 1_000_000_001]]),
        ),
        ("stretch", "100 to 10,000,000", taken::<FrontStretch, _>([100_u32, 99])),
        ("stretch", "100 to 10,000,000", taken::<FrontStretch, _>([10_000_000_u32, 10_000_001])),
        ("Line", "slope at most 1", taken::<LocalLine, _>([line(1, -1.0), line(1, -1.01)])),
        ("Line", "slope at most 1", taken::<LocalLine, _>([line(1, 1.0), line(1, f32::NAN)])),
        ("Line", "not 0", taken::<LocalLine, _>([line(0, 0.0), ((0, 0), [0, 0], [0.0, 0.0])])),
        (
            "Line",
            "intercept in metres",
            taken::<LocalLine, _>([f32::MAX, f32::INFINITY].map(|it| ((0, 0), [1, 0], [0.0, it]))),
        ),
        (
            "Line",
            "size below 2^30",
            taken::<LocalLine, _>([line(1 - (1 << 30), 0.0), line(1 << 30, 0.0)]),
        ),
        ("turn_step_urad", "1 to 3,141,592", [3_141_592, 3_141_593].map(|it| unicycle(it, 2, 1))),
        ("turn_step_urad", "1 to 785,398", [785_398, 785_399].map(|it| car(9_000, it))),
        ("speed_step_mm", "below 100,000", [99_999, 100_000].map(|it| unicycle(9, 2, it))),
        (
            "speed_step_mm",
            "below 3,000,000",
            [(31, 99_999), (51, 60_000)].map(|(n, it)| unicycle(9, n, it)),
        ),
        ("radius_mm", "below 2,048,000", [2_047_999, 2_048_000].map(|it| car(it, 10_000))),
        ("radius", "below 2^29", [(1 << 29) - 1, 1 << 29].map(disc)),
        ("level", "at most 999,900", [0.9999, 0.99991].map(|it| goal.with_confidence(it).is_ok())),
        ("price_mm", "1 to 16,384,000", [16_384.0, 16_384.001].map(|it| Far::at_price(it).is_ok())),
        ("Area", "has an inside", taken::<Area, _>([[(0, 0), (1, 1)], [(0, 0), (1, 0)]])),
    ] {
        assert_eq!(taken, [true, false], "{name}: {said}");
        let mut lines = schema.lines().filter(|it| it.split_whitespace().next() == Some(name));
        assert!(
            lines.any(|it| it.contains(said)),
            "docs/protocol.schema, {name}: expected {said:?}"
        );
    }
}

/// Figures that stand in the page's sentences.
#[test]
fn the_page_says_the_limits() {
    let head = format!("# The wire, version {PROTOCOL}:");
    assert!(page("protocol.schema").starts_with(&head), "docs/protocol.schema: expected {head:?}");
    let page = page("protocol.md");
    for said in [
        format!("about version {PROTOCOL}."),
        format!("at most {FRAME} bytes"),
        format!("at most {MOST_KEEP_OUTS} keep-outs"),
        format!("{} times", Link::<Socket<'_>>::ATTEMPTS),
    ] {
        assert!(page.contains(&said), "docs/protocol.md: expected {said:?}");
    }
}

/// A second reader, in Python and with code of its own, decodes the vectors by the schema and encodes them again.
#[test]
fn python_reads_the_vectors_so_too() {
    if !build::has_tool("python3") {
        build::skip("docs/wire.py", "python3 is not on PATH");
        return;
    }
    let mut python = Command::new("python3");
    python.args(["wire.py", "--vectors"]).current_dir(docs()).env("PYTHONDONTWRITEBYTECODE", "1");
    let said = build::printed(&mut python);
    assert_eq!(said, format!("{} vectors agree\n", page("protocol.vectors").lines().count()));
}

/// The seeds of the fuzz target `frames` are the contents of whole missions' vectors. `UPDATE_EXPECT` writes them.
#[test]
fn fuzzing_begins_from_the_vectors() {
    let corpus = build::root().join("fuzz/corpus/frames");
    for (name, content) in vectors().contents.iter().filter(|(name, _)| !name.contains('/')) {
        let file = corpus.join(name);
        if tests::is_updating() {
            fs::write(&file, content).expect("writes a seed");
        }
        assert_eq!(fs::read(&file).ok().as_ref(), Some(content), "{}", file.display());
    }
}
