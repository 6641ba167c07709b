//! The planner behind its C interface. The header matches the sources, and a C program flies the same missions as this
//! crate.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use planner_core::belief::goal::Accuracy;
use planner_core::belief::tolerance::Tolerance;
use planner_core::nalgebra::Point2;
use planner_core::{
    Area, Belief as _, Config, Crossing, Forecast, Goal, Heading, Label, Line, Lookahead, Noise,
    Plan, Planner, Pose, Prior, Reliability, Sample, Site, StopReason, Unicycle, VersionSpace, cfc,
    lookahead,
};
use tests::program::build::{build, has_tool, skip};

const SCRATCH: &str = env!("CARGO_TARGET_TMPDIR");

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../planner-core/c")
}

#[test]
fn the_header_is_that_of_the_sources() {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).expect("a config");
    let sources = folder().join("src/lib.rs");
    let made = cbindgen::Builder::new().with_config(config).with_src(sources);
    let mut header = Vec::new();
    made.generate().expect("bindings").write(&mut header);
    let header = String::from_utf8(header).expect("text");
    expect_test::expect_file![folder().join("include/planner.h")].assert_eq(&header);
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

fn flown_here(is_doubtful: bool) -> String {
    let at = |x, z| Site::try_from(Point2::<f64>::new(x, z)).expect("near");
    let given = [
        Sample { site: at(2.0, 1.0), label: Label::Negative },
        Sample { site: at(2.0, 8.0), label: Label::Positive },
        Sample { site: at(18.0, 16.0), label: Label::Positive },
        Sample { site: at(18.0, 5.0), label: Label::Negative },
    ];
    let config = Config {
        area: Area::new(at(0.0, 0.0), at(20.0, 20.0)).expect("an area"),
        varrho: lookahead::VARRHO,
        crossing: Crossing::default(),
        following: cfc::FOLLOWING,
        tolerance: Tolerance::NONE,
    };
    let unicycle = Unicycle::new(10_000, 1.57, 21, 50).expect("a grid");
    let slopes = Heading::from_radians(if is_doubtful { 0.21 } else { 0.0035 }).expect("an angle");
    let goal = Some(Goal { accuracy: Accuracy::SlopeArc(slopes), level: 900_000 });
    let start = Pose { site: given[0].site, heading: Heading(0) };
    if is_doubtful {
        let reliability = Reliability::new(0.85).expect("a probability");
        let noise = Noise { reliability, ..Noise::NONE };
        let forecast = Forecast::<36, 529>::new(&given, Prior::Area, noise).expect("four points");
        flown(
            Lookahead::new(config, unicycle, forecast).expect("settings that agree").until(goal),
            start,
            true,
        )
    } else {
        let space = VersionSpace::<68>::new(&given).expect("four points");
        flown(
            Lookahead::new(config, unicycle, space).expect("settings that agree").until(goal),
            start,
            false,
        )
    }
}

#[test]
fn a_c_program_flies_the_same_missions() {
    if !has_tool("cc") {
        skip(SCRATCH, "the C program", "there is no C compiler `cc`");
        return;
    }
    let library = build(SCRATCH, "planner-c", host()).unwrap_or_else(|errors| panic!("{errors}"));
    for (source, arguments) in [("example.c", ["", "doubtful"]), ("misuse.c", [""; 2])] {
        let program = Path::new(SCRATCH).join(source).with_extension("program");
        let built = Command::new("cc")
            .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-I"])
            .arg(folder().join("include"))
            .arg(if source == "example.c" { folder().join(source) } else { misuse() })
            .arg(library.join("libplanner_c.a"))
            .args(["-lm", "-lpthread", "-ldl", "-o"])
            .arg(&program)
            .output()
            .expect("cc starts");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        for (argument, is_doubtful) in arguments.into_iter().zip([false, true]) {
            let run = Command::new(&program).arg(argument).output().expect("it starts");
            let (said, errors) = (run.stdout, String::from_utf8_lossy(&run.stderr).into_owned());
            assert!(run.status.success(), "{source} {argument}: {errors}");
            let said = String::from_utf8(said).expect("text");
            if source == "example.c" {
                let (flight, bytes) = said.trim_end().rsplit_once(", ").expect("bytes at the end");
                assert_eq!(flight, flown_here(is_doubtful), "{argument}");
                println!("{argument}: {} lines, {bytes}", flight.lines().count());
            }
        }
    }
}

/// A program that calls wrongly and checks what it is told.
fn misuse() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("misuse.c")
}

/// The target that these tests run on.
fn host() -> &'static str {
    let version = Command::new("rustc").arg("-vV").output().expect("rustc starts");
    let version = String::from_utf8(version.stdout).expect("text");
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("a host");
    Box::leak(host.to_owned().into_boxed_str())
}
