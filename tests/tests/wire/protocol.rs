//! `docs/protocol.md` says what `planner-core` sends: its worked examples are held against the types both ways, its
//! tables of variants against what the types take in.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{Debug, Write as _};
use std::fs;
use std::path::Path;
use std::process::Command;

use host_sim::hil::setup;
use host_sim::mission::algorithm::Algorithm as Planner;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::mission::scenario::{self, Overrides};
use planner_core::error::{GivenError, GridError, ObservationError, ShapeError};
use planner_core::link::frame::{Decoder, Envelope, FRAME, Frame, Message};
use planner_core::link::message::{
    Accepted, Algorithm, Capacity, ClockRate, DeclinedError, EndReason, LabelSource, MOST_CORNERS,
    MOST_GIVEN, MOST_KEEP_OUTS, MissionEnd, Move, PROTOCOL, Reply, Request, Setup, Took,
};
use planner_core::motion::any_vehicle::Shape;
use planner_core::planner::Stage;
use planner_core::search::recovery::Recovery;
use planner_core::{
    Accuracy, Crossing, Following, FrontState, Heading, Label, Policy, Prior, Reading, Site,
    StopReason, Waist,
};
use serde::de::DeserializeOwned;
use tests::build;

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/protocol.md");
    fs::read_to_string(path).expect("docs/protocol.md")
}

/// A worked example: a frame, and its content part by part with the check sum.
#[derive(Debug, PartialEq)]
struct Example {
    frame: Vec<u8>,
    content: Vec<u8>,
}

/// The bytes that a line begins with; what follows two spaces is for people.
fn bytes(line: &str) -> impl Iterator<Item = u8> {
    let hex = line.split("  ").next().unwrap_or_default().split(' ');
    hex.map(|byte| u8::from_str_radix(byte, 16).expect("two digits a byte"))
}

/// The page's blocks of the kind `frame`, by the names that they begin with.
fn examples(page: &str) -> BTreeMap<String, Example> {
    let blocks = page.split("\n```frame\n").skip(1).map(|rest| rest.split("\n```").next());
    let read = |block: &str| {
        let (head, parts) = block.split_once("\n\n").expect("a frame, a blank line, its parts");
        let (name, frame) = head.split_once('\n').expect("a name and a frame");
        let example = Example {
            frame: frame.lines().flat_map(bytes).collect(),
            content: parts.lines().flat_map(bytes).collect(),
        };
        (name.to_owned(), example)
    };
    let blocks: Vec<_> = blocks.flatten().map(read).collect();
    let count = blocks.len();
    let examples: BTreeMap<_, _> = blocks.into_iter().collect();
    assert_eq!(examples.len(), count, "two examples of one name");
    examples
}

/// COBS by its definition: what stands between two zeros.
fn unstuffed(frame: &[u8]) -> Vec<u8> {
    let inner = frame.strip_prefix(&[0]).and_then(|it| it.strip_suffix(&[0]));
    let mut rest = inner.expect("a zero before and after");
    let mut content = Vec::new();
    while let [code, more @ ..] = rest {
        let (group, after) = more.split_at(usize::from(*code) - 1);
        content.extend(group);
        if *code != 255 && !after.is_empty() {
            content.push(0);
        }
        rest = after;
    }
    content
}

fn hex(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        let _ = write!(text, "{byte:02x} ");
    }
    text.trim_end().to_owned()
}

/// What is said on the page, by its name.
struct Said {
    examples: BTreeMap<String, Example>,
    checked: BTreeSet<String>,
    wrong: Vec<String>,
}

impl Said {
    /// Whether an example is this message, both ways.
    fn is<M: Message + Debug>(&mut self, name: &str, session: u32, number: u32, message: M) {
        self.checked.insert(name.to_owned());
        let debug = format!("{message:?}");
        let frame = Frame::of(&Envelope::new(session, number, message));
        let Some(example) = self.examples.get(name) else {
            self.wrong.push(format!("expected an example {name}:\n{}", hex(frame.bytes())));
            return;
        };
        if example.frame != frame.bytes() {
            self.wrong.push(format!("{name}: expected the frame\n{}", hex(frame.bytes())));
        }
        if example.content != unstuffed(&example.frame) {
            self.wrong.push(format!("{name}: the parts are not what is in the frame"));
        }
        let mut decoder = Decoder::default();
        let envelopes = example.frame.iter().filter_map(|byte| decoder.feed::<M>(*byte));
        let heard: Vec<_> =
            envelopes.map(|it| (it.session, it.number, format!("{:?}", it.message))).collect();
        if heard != [(session, number, debug)] {
            self.wrong.push(format!("{name}: the frame reads as {heard:?}"));
        }
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

/// The mission of the page: session 8, the paper's noiseless example, whose frames these are in their order; then what
/// else can be said.
#[test]
fn the_examples_are_what_is_sent() {
    let page = page();
    let mut said = Said { examples: examples(&page), checked: BTreeSet::new(), wrong: Vec::new() };

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

    said.is("Hello", 0, 1, Request::Hello { protocol: PROTOCOL });
    said.is("Setup of Algorithm 1", 8, 1, Reply::Setup(setup(&paper, LabelSource::Vehicle)));
    let clock = ClockRate { per_second: 168_000_000, emulated: true };
    let capacity = Capacity { samples: 68, hypotheses: 1 };
    said.is("Ready", 8, 2, Request::Ready(Accepted { capacity, clock }));
    said.is("Noted", 8, 2, Reply::Noted);
    let took = Took { observe: 0, plan: 71_234, estimate: 0 };
    said.is("Move", 8, 3, Request::Move(Move { motion: first.motion, last: None, took }));
    said.is("Busy", 8, 3, Reply::Busy);
    said.is("Arrived", 8, 3, Reply::Arrived { pose: first.pose, reading: first.reading });
    let took = Took { observe: 35_801, plan: 68_110, estimate: 0 };
    let (motion, told) = (second.motion, first.reading);
    said.is("Move, the next", 8, 4, Request::Move(Move { motion, last: told, took }));
    said.is("Arrived, no reading", 8, 4, Reply::Arrived { pose: second.pose, reading: None });
    said.is("Failed", 8, 4, Reply::Failed);
    let took = Took { observe: 30_977, plan: 60_502, estimate: 52_190 };
    let (reason, estimates) = (EndReason::Steps, flown.belief.estimates());
    let end = MissionEnd { reason, last: last.reading, took, estimates };
    said.is("End", 8, 13, Request::End(end));
    said.is("Stale", 7, 12, Reply::Stale);

    let twice = Recording::of(&Mission { readings: 2, ..paper.clone() }).expect("labels are true");
    let passed = twice.results.steps[0].passed().next();
    let (site, reading) = passed.map(|(site, it)| (site, Some(it))).expect("one on the way");
    said.is("OnTheWay", 12, 3, Reply::OnTheWay { site, reading });
    said.is("Onward", 12, 4, Request::Onward { last: reading });

    said.is("Setup of Algorithm 2", 9, 1, Reply::Setup(setup(&noisy, LabelSource::Vehicle)));
    let least = DeclinedError::Capacity(Capacity { samples: 36, hypotheses: 529 });
    said.is("Declined", 9, 2, Request::Declined(least));
    let by_true = setup(&by_lookahead, LabelSource::Vehicle);
    said.is("Setup of look-ahead, true labels", 10, 1, Reply::Setup(by_true));
    let by_doubtful = setup(&by_car, LabelSource::Chip);
    said.is("Setup of look-ahead, labels in doubt", 11, 1, Reply::Setup(by_doubtful));
    said.is("Outline, asked", 11, 2, Request::Outline(0));
    let mut outlines = setup::outlines(&by_car.config.area);
    let mut outline = || Reply::Outline(outlines.next().expect("one more"));
    said.is("Outline, the border", 11, 2, outline());
    said.is("Outline, a disc", 11, 3, outline());

    let along_front = read(ALONG_FRONT, plain);
    let by_tracker = setup(&along_front, LabelSource::Vehicle);
    said.is("Setup of a follower of fronts", 13, 1, Reply::Setup(by_tracker));
    let watched = ALONG_FRONT.replace("speed = 0.02", "speed = 0.02, watch = 30.0");
    let watched = read(&watched.replace("stop = { closed = true }\n", ""), plain);
    let by_guard = setup(&watched, LabelSource::Vehicle);
    said.is("Setup of a guard of a front", 14, 1, Reply::Setup(by_guard));
    let waist = Waist {
        site: Site::metres([8.25, 30.5]).expect("near"),
        heading: Heading::from_radians(0.25).expect("an angle"),
        curvature: -0.03125,
        deviation: 0.375,
        turn_deviation: 0.125,
    };
    let found = FrontState { waist: Some(waist), is_closed: false };
    said.is("Front", 13, 6, Request::Front(found));
    said.is("Front, not found", 13, 4, Request::Front(FrontState::default()));

    let Said { examples, checked, wrong, .. } = said;
    assert!(wrong.is_empty(), "docs/protocol.md:\n{}", wrong.join("\n"));
    let unchecked: Vec<_> = examples.keys().filter(|name| !checked.contains(*name)).collect();
    assert!(unchecked.is_empty(), "no message of this test: {unchecked:?}");
}

/// The variants that a type takes in, in their order, given what may follow their index.
fn variants<T: DeserializeOwned + Debug>(contents: &[&[u8]]) -> Vec<String> {
    let named = |index: u8| {
        contents.iter().find_map(|content| {
            let bytes = [&[index], *content].concat();
            let value = postcard::take_from_bytes::<T>(&bytes).ok()?.0;
            let debug = format!("{value:?}");
            Some(debug.split([' ', '(']).next().unwrap_or_default().to_owned())
        })
    };
    // Past the last there is none.
    let all: Vec<_> = (0..64).map(named).collect();
    let count = all.iter().flatten().count();
    assert!(all[..count].iter().all(Option::is_some), "one of these is not reached: {all:?}");
    all.into_iter().flatten().collect()
}

/// The names in the table under a title: `| 0 | `Name` | ...`.
fn table(page: &str, title: &str) -> Vec<String> {
    let after = page.split(&format!("\n#### {title}\n")).nth(1);
    let section = after.unwrap_or_default().split("\n#").next().unwrap_or_default();
    let rows = section.lines().filter_map(|line| {
        let mut cells = line.strip_prefix("| ")?.split(" | ");
        let number: usize = cells.next()?.parse().ok()?;
        Some((number, cells.next()?.trim_matches('`').to_owned()))
    });
    let rows: Vec<_> = rows.collect();
    assert!(rows.iter().map(|(number, _)| *number).eq(0..rows.len()), "{title}: {rows:?}");
    rows.into_iter().map(|(_, name)| name).collect()
}

#[test]
fn the_tables_have_every_variant() {
    let page = page();
    let zeros: &[u8] = &[0; 64];
    let mission = read(scenario::PAPER_NOISELESS, Overrides::default());
    let setup = Reply::Setup(setup(&mission, LabelSource::Vehicle));
    let mut bytes = [0; FRAME];
    let setup = postcard::to_slice(&setup, &mut bytes).expect("it fits");
    let replies: &[&[u8]] = &[zeros, &setup[1..]];
    let mut wrong = Vec::new();
    let mut check = |title: &str, expected: Vec<String>| {
        let found = table(&page, title);
        if found != expected {
            wrong.push(format!("{title}: found {found:?}, expected {expected:?}"));
        }
    };
    macro_rules! check {
        ($($name:ident),*) => { $(check(stringify!($name), variants::<$name>(&[zeros]));)* };
    }
    check!(Request, Policy, Prior, Accuracy, Crossing, Following, Label, Reading, Stage, Recovery);
    check!(
        EndReason,
        StopReason,
        ObservationError,
        DeclinedError,
        GivenError,
        ShapeError,
        GridError
    );
    check("Reply", variants::<Reply>(replies));
    // A stretch of no length is refused. This one has 200 mm.
    let watch: &[u8] = &[0, 0, 0, 0, 0, 200, 1];
    check("Algorithm", variants::<Algorithm>(&[zeros, watch]));
    check("Vehicle", variants::<Shape>(&[zeros]));
    check("Labels", variants::<LabelSource>(&[zeros]));
    assert!(wrong.is_empty(), "docs/protocol.md:\n{}", wrong.join("\n"));
}

/// Figures that stand in the page's sentences.
#[test]
fn the_page_says_the_limits() {
    let page = page();
    for said in [
        format!("This page is of version {PROTOCOL}."),
        format!("A frame is at most {FRAME} bytes long"),
        format!("at most {MOST_GIVEN} samples"),
        format!("at most {MOST_CORNERS} corners"),
        format!("at most {MOST_KEEP_OUTS} keep-outs"),
        "16 times".to_owned(),
    ] {
        assert!(page.contains(&said), "docs/protocol.md: expected {said:?}");
    }
}

/// The Python that was written from the page reads and writes the examples as they stand there, part by part.
#[test]
fn python_reads_the_page_so_too() {
    if !build::has_tool("python3") {
        build::skip("docs/wire.py", "python3 is not on PATH");
        return;
    }
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let mut python = Command::new("python3");
    python.arg("wire.py").args(["--vectors", "protocol.md"]).current_dir(&docs);
    let output = python.output().expect("python3 starts");
    let [said, complaint] = [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it));
    assert!(output.status.success(), "{said}{complaint}");
    assert_eq!(said, format!("{} examples agree\n", examples(&page()).len()));
}

/// The seeds of the fuzz target `frames` are the examples without their check sums. `UPDATE_EXPECT` writes them.
#[test]
fn fuzzing_begins_from_the_examples() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus/frames");
    for (name, Example { content, .. }) in examples(&page()) {
        let words = name.split(|it: char| !it.is_alphanumeric()).filter(|it| !it.is_empty());
        let file = corpus.join(words.collect::<Vec<_>>().join("-").to_lowercase());
        let (content, _) = content.split_last_chunk::<4>().expect("a check sum");
        if tests::is_updating() {
            fs::write(&file, content).expect("writes a seed");
        }
        assert_eq!(fs::read(&file).ok().as_deref(), Some(content), "{}", file.display());
    }
}
