//! The planner behind its C interface. The header matches the sources, and a C program flies the same missions as this
//! crate.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use chips::program;
use chips::program::graph::Graph;
use chips::program::image::Image;
use planner_core::lattice::UNITS_PER_METRE;
use planner_core::nalgebra::Point2;
use planner_core::{
    Angle, Area, Belief as _, Chart, Charted, Front, FrontStretch, Goal, Guard, Heading, Hull,
    KeepOut, Label, Line, Lookahead, Noise, NoisyBelief, Plan, Planner, PolygonArea, Pose,
    PredictiveBelief, Reliability, Sample, Site, SlopeWithin, StopReason, Tolerance, Track,
    Unicycle, VersionSpace,
};
use tests::build::{has_tool, printed, scratch, skip};
use tests::is_updating;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../planner-core/c")
}

#[test]
fn the_header_is_that_of_the_sources() {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).expect("a config");
    let sources = folder().join("src/lib.rs");
    let made = cbindgen::Builder::new().with_config(config).with_src(sources);
    let mut header = Vec::new();
    made.generate().expect("bindings").write(&mut header);
    let place = folder().join("include/planner.h");
    if is_updating() {
        fs::write(&place, &header).expect("writes the header");
    }
    assert!(fs::read(place).expect("a header") == header, "UPDATE_EXPECT=1 writes the header anew");
}

/// What `example.c` prints, by a planner.
fn flown<P: Planner<Belief: Sized>>(mut planner: P, start: Pose, is_doubtful: bool) -> String {
    let (mut pose, mut labels, mut lines) = (start, 0, String::new());
    loop {
        let motion = match planner.plan(pose) {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => break assert_eq!(reason, StopReason::Known),
        };
        pose = motion.target;
        let at = Point2::<f64>::from(pose.site);
        let label = motion.wants_label.then(|| {
            labels += 1;
            let is_above = at.y > 0.41 * at.x + 3.5;
            if is_above == (is_doubtful && labels % 7 == 3) {
                Label::Negative
            } else {
                Label::Positive
            }
        });
        let number = label.map_or(2, Label::sign);
        let heading = pose.heading.radians();
        let _ = writeln!(lines, "{:.9} {:.9} {heading:.9} {number}", at.x, at.y);
        planner.observe(pose, label.map(Into::into)).expect("a possible label");
    }
    let [a, b, c] = Line::from(planner.estimates().centre.expect("a line")).coefficients();
    let bits = planner.belief().information();
    lines + &format!("line {a:.9} {b:.9} {c:.9}, {bits:.6} bits")
}

fn at(x: f64, z: f64) -> Site {
    Site::try_from(Point2::new(x, z)).expect("near")
}

fn given() -> [Sample; 4] {
    let given = [(2.0, 1.0, -1), (2.0, 8.0, 1), (18.0, 16.0, 1), (18.0, 5.0, -1)];
    given.map(|(x, z, sign)| {
        let label = if sign > 0 { Label::Positive } else { Label::Negative };
        Sample { site: at(x, z), label }
    })
}

fn start() -> Pose {
    Pose { site: at(2.0, 1.0), heading: Heading(0) }
}

fn slopes(radians: f64, level: u32) -> Goal<SlopeWithin> {
    let goal = Angle::from_radians(radians).and_then(Goal::slope_within).expect("acute");
    Goal { level, ..goal }
}

fn tolerance(metres: f64) -> Tolerance {
    Tolerance::new(metres).expect("a tolerance")
}

fn reliability(p: f64) -> Reliability {
    Reliability::new(p).expect("a probability")
}

fn flown_here(is_doubtful: bool) -> String {
    let area = Area::metres([0.0, 0.0], [20.0, 20.0]).expect("an area");
    let unicycle = Unicycle::new(10_000, 1.57, 21, 50).expect("a grid");
    let goal = slopes(if is_doubtful { 0.21 } else { 0.0035 }, 900_000);
    if is_doubtful {
        let noise = Noise::new(0.85).expect("a probability");
        let noisy = NoisyBelief::<36, 529>::new(&given(), noise).expect("four points");
        let planner = Lookahead::new(area, unicycle, noisy).expect("settings that agree");
        flown(planner.until(Some(goal)), start(), true)
    } else {
        let space = VersionSpace::<68>::new(&given()).expect("four points");
        let planner = Lookahead::new(area, unicycle, space).expect("settings that agree");
        flown(planner.until(Some(goal)), start(), false)
    }
}

type Ground = PolygonArea<8, 8>;

/// The area of `asleep.c`.
fn ground() -> Ground {
    let hull = |corners: &[(f64, f64)]| {
        let corners: Vec<Site> = corners.iter().map(|&(x, z)| at(x, z)).collect();
        Hull::new(&corners).expect("a convex polygon")
    };
    let border = hull(&[(0.0, 0.0), (20.0, 0.0), (20.0, 17.0), (8.0, 20.0), (0.0, 20.0)]);
    let keep_outs = [
        (hull(&[(5.0, 6.0)]), UNITS_PER_METRE),
        (hull(&[(9.0, 7.0), (11.0, 7.0), (10.0, 9.0)]), 0),
        (hull(&[(13.0, 9.0), (16.0, 9.5)]), UNITS_PER_METRE / 4),
    ];
    let rounded = |(hull, radius): (_, i32)| KeepOut { hull, radius: radius.unsigned_abs() };
    PolygonArea::new(border, &keep_outs.map(rounded)).expect("an area")
}

/// The cells of `lake.c`.
fn lake_cells() -> Vec<u32> {
    let is_water = |column: usize, row: usize| {
        let is_island = (16..24).contains(&column) && (14..22).contains(&row);
        !is_island && column + row > 2 && column + row < 70
    };
    let mut cells = vec![0; 2 * 40];
    for (column, row) in (0..40).flat_map(|row| (0..40).map(move |column| (column, row))) {
        cells[2 * row + column / 32] |= u32::from(is_water(column, row)) << (column % 32);
    }
    cells
}

/// What `lake.c` prints in one of its modes.
fn in_lake(mode: &str) -> String {
    let cells = lake_cells();
    let side = UNITS_PER_METRE.unsigned_abs() / 2;
    let chart = Chart::new(Site::ORIGIN, side, [40, 40], &cells).expect("a chart");
    let buoy = KeepOut::new(Hull::<8>::new(&[at(5.0, 6.0)]).expect("a point"), 1.0);
    let border = Hull::of(chart.bounds());
    let area: Ground = PolygonArea::new(border, &[buoy.expect("a disc")]).expect("an area");
    let lake = Charted::new(area, Some(chart));
    let unicycle = Unicycle::new(10_000, 1.57, 21, 50).expect("a grid");
    let goal = slopes(if mode == "doubtful" { 0.21 } else { 0.0035 }, 900_000);
    match mode {
        "front" => {
            let front = Front::bending(4.0).expect("a front");
            let mut planner = Track::new(lake, unicycle, front, Noise::NONE).expect("settings");
            let (mut pose, mut said) =
                (Pose { site: at(10.0, 3.5), heading: Heading(0) }, String::new());
            for _ in 0..60 {
                let Plan::Move(motion) = planner.plan(pose) else { panic!("it goes on") };
                pose = motion.target;
                let here = Point2::<f64>::from(pose.site);
                let (x, z) = (here.x - 10.0, here.y - 9.0);
                let label = || {
                    if x * x + z * z < 36.0 { Label::Positive } else { Label::Negative }
                };
                let label = motion.wants_label.then(label);
                let number = label.map_or(2, Label::sign);
                let heading = pose.heading.radians();
                let _ = writeln!(said, "{:.9} {:.9} {heading:.9} {number}", here.x, here.y);
                planner.observe(pose, label.map(Into::into)).expect("any label goes");
            }
            said
        }
        "doubtful" => {
            let noise = Noise::new(0.85).expect("a probability");
            let noisy = NoisyBelief::<36, 529>::new(&given(), noise).expect("four points");
            let planner = Lookahead::new(lake, unicycle, noisy).expect("settings that agree");
            flown(planner.until(Some(goal)), start(), true)
        }
        _ => {
            let space = VersionSpace::<68>::new(&given()).expect("four points");
            let planner = Lookahead::new(lake, unicycle, space).expect("settings that agree");
            flown(planner.until(Some(goal)), start(), false)
        }
    }
}

type Finder<B> = Lookahead<Unicycle, B, Ground, SlopeWithin>;

/// An observation as `asleep.c` makes it: the planner, where it is, what was read, which label it is, and whether that is
/// wrong.
type Observe<B> = fn(&mut Finder<B>, Pose, Option<Label>, u32, bool);

fn observe_within<B: PredictiveBelief>(
    planner: &mut Finder<B>,
    pose: Pose,
    label: Option<Label>,
    number: u32,
    _: bool,
) {
    let within = tolerance(0.02 * f64::from(number % 5 + 1));
    let observed = planner.observe_within(pose, label.map(Into::into), within);
    observed.expect("a possible label");
}

fn observe_believed(
    planner: &mut Finder<NoisyBelief<36, 529>>,
    pose: Pose,
    label: Option<Label>,
    _: u32,
    is_wrong: bool,
) {
    let Some(label) = label else { return planner.observe(pose, None).expect("no label") };
    let reliability = reliability(if is_wrong { 0.6 } else { 0.95 });
    let sample = Sample { site: pose.site, label };
    planner.belief_mut().take(sample, reliability).expect("room");
}

/// What `asleep.c` prints, by a planner that stays awake.
fn awake<B: PredictiveBelief<Belief: Sized>>(
    belief: B,
    goal: Goal<SlopeWithin>,
    observe: Observe<B>,
) -> String {
    let unicycle = Unicycle::new(10_000, 1.57, 41, 50).expect("a grid");
    let planner = Lookahead::new(ground(), unicycle, belief);
    let mut planner = planner.expect("settings that agree").until(Some(goal));
    let is_doubtful = goal.level < 900_000;
    let (mut pose, mut labels, mut said, mut status) = (start(), 0, String::new(), 0);
    let print = |said: &mut String, number: f64| {
        let _ = write!(said, "{:016x} ", number.to_bits());
    };
    for _ in 0..80 {
        let motion = match planner.plan(pose) {
            Plan::Move(motion) => motion,
            Plan::Stop(reason) => {
                status = match reason {
                    StopReason::Known => 1,
                    StopReason::SamplesFull => 3,
                    StopReason::Undecided => 5,
                    StopReason::Tolerance => 6,
                    other => panic!("{other:?}"),
                };
                break;
            }
        };
        if !is_doubtful {
            let [from, to] = [pose, motion.target].map(|it| Point2::<f64>::from(it.site));
            let (x, z) = (f64::midpoint(from.x, to.x), f64::midpoint(from.y, to.y));
            let is_above = z > 0.41 * x + 3.5;
            let label = if is_above { Label::Positive } else { Label::Negative };
            planner.observe_on_the_way(at(x, z), label.into()).expect("a possible label");
        }
        pose = motion.target;
        let here = Point2::<f64>::from(pose.site);
        let label = motion.wants_label.then(|| {
            labels += 1;
            let is_wrong = is_doubtful && labels % 7 == 3;
            let is_above = here.y > 0.41 * here.x + 3.5;
            (if is_above == is_wrong { Label::Negative } else { Label::Positive }, is_wrong)
        });
        let chance = planner.belief().chance(pose.site);
        for number in [here.x, here.y, pose.heading.radians(), chance] {
            print(&mut said, number);
        }
        let _ = writeln!(said, "{}", label.map_or(2, |(label, _)| label.sign()));
        let is_wrong = label.is_some_and(|(_, is_wrong)| is_wrong);
        observe(&mut planner, pose, label.map(|(label, _)| label), labels, is_wrong);
    }
    let line = Line::from(planner.estimates().centre.expect("a line")).coefficients();
    for number in line.into_iter().chain([planner.belief().information()]) {
        print(&mut said, number);
    }
    said + &status.to_string()
}

/// What `following.c` prints, by planners that stay awake: one that goes along, one that watches.
fn followed() -> [String; 2] {
    let area = Area::metres([0.0, 0.0], [120.0, 120.0]).expect("an area");
    let front = Front::bending(30.0).and_then(|it| it.moving(0.01)).expect("a front");
    let noise = Noise { tolerance: tolerance(0.1), ..Noise::new(0.9).expect("a probability") };
    let given = [(60.0, 10.0, Label::Negative), (60.0, 50.0, Label::Positive)];
    let given = given.map(|(x, z, label)| Sample { site: at(x, z), label });
    let unicycle = Unicycle::new(10_000, 1.57, 21, 100).expect("a grid");
    let track = Track::new(area, unicycle, front, noise).expect("settings that agree");
    let stretch = FrontStretch::metres(20.0).expect("a stretch");
    let guard = Guard::watching(area, unicycle, (front, stretch), noise).expect("room");
    [along(track.knowing(&given)), along(guard.knowing(&given))]
}

fn along<const N: usize>(mut planner: Track<Unicycle, Area, N>) -> String {
    let mut pose = Pose { site: at(60.0, 28.0), heading: Heading(0) };
    let (mut labels, mut said) = (0_u32, String::new());
    let label = |x: f64, z: f64, is_wrong| {
        let is_inside = (x - 60.0) * (x - 60.0) + (z - 60.0) * (z - 60.0) < 900.0;
        if is_inside == is_wrong { Label::Negative } else { Label::Positive }
    };
    for _ in 0..130 {
        let Plan::Move(motion) = planner.plan(pose) else { break };
        let [from, here] = [pose, motion.target].map(|it| Point2::<f64>::from(it.site));
        let (x, z) = (f64::midpoint(from.x, here.x), f64::midpoint(from.y, here.y));
        let on_the_way = label(x, z, false).into();
        planner.observe_on_the_way(at(x, z), on_the_way).expect("any label goes");
        pose = motion.target;
        let reading = motion.wants_label.then(|| {
            labels += 1;
            label(here.x, here.y, labels % 11 == 3)
        });
        let chance = planner.belief().chance(pose.site);
        let within = tolerance(0.02 * f64::from(labels % 5 + 1));
        let observed = planner.observe_within(pose, reading.map(Into::into), within);
        observed.expect("any label goes");
        let mut numbers = vec![chance, here.x, here.y];
        let front = planner.front().expect("it follows one");
        if let Some(it) = front.waist {
            let at = Point2::<f64>::from(it.site);
            let rest = [it.curvature, it.deviation, it.turn_deviation].map(f64::from);
            numbers.extend([at.x, at.y, it.heading.radians()].into_iter().chain(rest));
            numbers.push(f64::from(u8::from(front.is_closed)));
            let beside = planner.beside(pose.site, pose.heading);
            numbers.extend([beside.left, beside.deviation].map(f64::from));
        }
        for number in numbers {
            let _ = write!(said, "{:016x} ", number.to_bits());
        }
        said.push('\n');
    }
    assert!(planner.front().is_some_and(|it| it.waist.is_some()) && said.lines().count() == 130);
    said
}

/// What `asleep.c` prints in one of its modes.
fn awake_in(mode: &str) -> String {
    let noise = |tolerance| Noise { reliability: reliability(0.85), tolerance, ..Noise::NONE };
    let noisy =
        |tolerance| NoisyBelief::<36, 529>::new(&given(), noise(tolerance)).expect("four points");
    let tolerance = tolerance(0.1);
    match mode {
        "true" => {
            let space =
                VersionSpace::<68>::new(&given()).and_then(|it| it.with_tolerance(tolerance));
            let space = space.expect("four points");
            awake(space, slopes(0.02, 900_000), observe_within)
        }
        "doubtful" => awake(noisy(Tolerance::NONE), slopes(0.15, 600_000), observe_believed),
        _ => awake(noisy(tolerance), slopes(0.15, 600_000), observe_within),
    }
}

/// A C program, built against the library; `None` without a compiler.
fn program(library: &Path, source: &Path) -> PathBuf {
    let name = source.file_name().expect("a name");
    let program = scratch().join(name).with_extension("program");
    let mut compiler = Command::new("cc");
    compiler
        .args(["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-I"])
        .arg(folder().join("include"))
        .arg(source)
        .arg(library.join("libplanner_c.a"))
        .args(["-lm", "-lpthread", "-ldl", "-o"])
        .arg(&program);
    printed(&mut compiler);
    program
}

/// What a program prints, which ends well.
fn said(program: &Path, argument: &str) -> String {
    printed(Command::new(program).arg(argument))
}

#[test]
fn a_c_program_flies_the_same_missions() {
    if !has_tool("cc") {
        skip("the C programs", "there is no C compiler `cc`");
        return;
    }
    let library = program::folder("planner-c", host(), "").expect("it is installed");
    let example = program(&library, &folder().join("example.c"));
    for (argument, is_doubtful) in [("", false), ("doubtful", true)] {
        let said = said(&example, argument);
        let (flight, _) = said.trim_end().rsplit_once(", ").expect("bytes at the end");
        assert_eq!(flight, flown_here(is_doubtful), "{argument}");
    }
    let bloom = said(&program(&library, &folder().join("bloom.c")), "");
    assert!(bloom.lines().count() > 30, "{bloom}");
    said(&program(&library, &here("misuse.c")), "");
    said(&program(&library, &here("refused.c")), "");
    let following = program(&library, &here("following.c"));
    for (mode, here) in ["", "watch"].into_iter().zip(followed()) {
        assert_eq!(said(&following, mode), here, "{mode}");
    }
    let lake = program(&library, &here("lake.c"));
    for mode in ["", "doubtful", "front"] {
        assert_eq!(said(&lake, mode), in_lake(mode), "{mode}");
    }
    let asleep = program(&library, &here("asleep.c"));
    for mode in ["true", "doubtful", "blurred"] {
        assert_eq!(said(&asleep, mode), awake_in(mode), "{mode}");
    }
}

/// The header alone, in the oldest dialects that it is for.
#[test]
fn the_header_compiles_as_c99_and_as_cpp11() {
    for (compiler, standard, language) in [("cc", "c99", "c"), ("c++", "c++11", "c++")] {
        if !has_tool(compiler) {
            skip("the C header", &format!("there is no compiler `{compiler}`"));
            continue;
        }
        let mut compiler = Command::new(compiler);
        compiler
            .arg(format!("-std={standard}"))
            .args(["-pedantic", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-x", language])
            .arg(folder().join("include/planner.h"));
        printed(&mut compiler);
    }
}

/// Calls, and the stack that docs/c.md says they take on a Cortex-M4F at most, bytes.
const STACKS: [(&str, &[&str], u32); 10] = [
    ("`planner_begin`", &["begin", "check"], 18_000),
    ("`planner_plan`", &["plan"], 15_000),
    (
        "`planner_observe` and others",
        &["observe", "observe_within", "observe_believed", "observe_on_the_way"],
        5_500,
    ),
    ("`planner_estimate` and others", &["estimate", "bits", "chance"], 3_500),
    ("`planner_save`, `planner_restore`", &["save", "restore"], 11_000),
    ("`planner_follow`", &["follow", "follower_check"], 26_000),
    ("`planner_follower_plan`", &["follower_plan"], 9_500),
    (
        "`planner_follower_observe` and others",
        &["follower_observe", "follower_observe_within", "follower_observe_on_the_way"],
        3_000,
    ),
    ("`planner_front` and others", &["front", "front_beside", "follower_chance"], 1_500),
    ("`planner_follower_save`, `_restore`", &["follower_save", "follower_restore"], 35_000),
];

/// Bounds from the machine code of all functions, linked for a chip.
#[test]
fn calls_take_the_stack_that_the_page_says() {
    let Some(library) = program::folder("planner-c", program::CHIP, "") else { return };
    let calls = STACKS.iter().flat_map(|(_, calls, _)| *calls);
    let vectors: Vec<String> = calls.map(|call| format!("LONG(planner_{call})")).collect();
    let vectors = vectors.join(" ");
    let script = format!(
        "SECTIONS {{ .vector_table 0 : {{ LONG(0) {vectors} }} .text : {{ *(.text*) }} .rodata : {{ *(.rodata*) }} \
         /DISCARD/ : {{ *(.ARM.ex*) }} }} abort = planner_has_ended;"
    );
    let [place, elf] = ["c.x", "c.elf"].map(|it| scratch().join(it));
    fs::write(&place, script).expect("writes the script");
    let mut linker = Command::new(linker());
    linker
        .args(["-flavor", "gnu", "--gc-sections", "--undefined=planner_has_ended", "-T"])
        .arg(&place)
        .arg(library.join("libplanner_c.a"))
        .arg("-o")
        .arg(&elf);
    printed(&mut linker);
    let image = Image::read(&fs::read(elf).expect("an ELF"));
    let graph = Graph::of(&image, &[]).expect("calls that are known");
    let page = fs::read_to_string(folder().join("../../docs/c.md")).expect("the page");
    for (name, calls, most) in STACKS {
        let row = format!("| {name} | {most} |");
        assert!(page.contains(&row), "docs/c.md needs {row}");
        let bounds = calls.iter().map(|call| {
            let [function] = graph.named(|it| it == format!("planner_{call}"))[..] else {
                panic!("no {call}");
            };
            graph.deepest(function, &[]).expect("no recursion").stack
        });
        let bound = bounds.max().expect("a call");
        assert!(bound <= most && bound > most / 5 * 4, "{name}: {bound} of {most}");
    }
}

/// The linker that comes with the compiler.
fn linker() -> PathBuf {
    let sysroot = printed(Command::new("rustc").args(["--print", "sysroot"]));
    Path::new(sysroot.trim()).join("lib/rustlib").join(host()).join("bin/rust-lld")
}

/// A program of the tests' own: some call wrongly and check what they are told, others sleep.
fn here(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("c").join(name)
}

/// The target that these tests run on.
fn host() -> &'static str {
    let version = printed(Command::new("rustc").arg("-vV"));
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("a host");
    Box::leak(host.to_owned().into_boxed_str())
}
