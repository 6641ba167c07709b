//! The firmware under emulation: the chip's mission is the host's, bit for bit.
//!
//! Builds the firmware with its feature `semihosting`, runs it in QEMU's STM32F405, decodes its log,
//! and compares that with the same mission made here: every action, pose and reading, and every
//! coefficient of the estimates. Both sides take their world from one file, so what differs is the
//! machine alone.
//!
//! Without QEMU or the target's standard library the test says so and passes; with `CI` set it fails.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

use defmt_decoder::{DecodeError, Table};
use planner_core::agent::{Event, Step};
use planner_core::estimate::Estimates;
use planner_core::line::Line;
use planner_core::sample::Reading;
use world::World;

#[path = "../../firmware/src/world.rs"]
#[expect(dead_code, reason = "the firmware logs why there is no mission; here it is only printed")]
mod world;

const TARGET: &str = "thumbv7em-none-eabihf";

/// The run takes a tenth of a second.
const TIMEOUT_S: &str = "60";

#[test]
fn the_chip_and_the_host_make_the_same_mission() {
    if let Some(reason) = obstacle() {
        assert!(env::var_os("CI").is_none(), "cannot run the firmware under QEMU: {reason}");
        skip(reason);
        return;
    }
    let chip = mission_under_qemu(&build());
    let host = mission_on_host();
    for (n, (chip, host)) in chip.iter().zip(&host).enumerate() {
        assert_eq!(chip, host, "line {} of the log: the chip's (left), the host's (right)", n + 1);
    }
    assert_eq!(
        chip.len(),
        host.len(),
        "lines of the log: the chip's {chip:#?}, the host's {host:#?}"
    );
}

/// Why the firmware cannot be built or run here.
fn obstacle() -> Option<&'static str> {
    let libraries =
        Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
    if !libraries.is_ok_and(|it| Path::new(String::from_utf8_lossy(&it.stdout).trim()).is_dir()) {
        return Some("the target thumbv7em-none-eabihf is not installed");
    }
    let absent = |tool| Command::new(tool).arg("--version").output().is_err();
    if absent("qemu-system-arm") {
        return Some("qemu-system-arm is not on PATH");
    }
    absent("timeout").then_some("timeout (GNU coreutils) is not on PATH")
}

/// Straight to the handle: what the print macros write, libtest swallows when a test passes.
fn skip(reason: &str) {
    let line = format!("SKIPPED firmware under QEMU: {reason}\n");
    let _ = io::stderr().write_all(line.as_bytes());
}

/// Builds the firmware, into a target directory of its own, and returns the ELF's path.
fn build() -> PathBuf {
    let target_dir = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("firmware-test");
    let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .args(["build", "--quiet", "--package", "firmware", "--release", "--target", TARGET])
        .args(["--features", "semihosting", "--target-dir"])
        .arg(&target_dir)
        .env("DEFMT_LOG", "info");
    // Flags and wrappers of the host's build (coverage, for one) are not the chip's.
    for host in ["RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER"]
    {
        cargo.env_remove(host);
    }
    let built = cargo.output().expect("cargo starts");
    assert!(built.status.success(), "the firmware fails to build:\n{}", text(&built.stderr));
    target_dir.join(TARGET).join("release/firmware")
}

/// The messages that the firmware logs, one a line.
fn mission_under_qemu(elf: &Path) -> Vec<String> {
    let run = Command::new("timeout")
        .args(["--signal=KILL", TIMEOUT_S, "qemu-system-arm", "-M", "netduinoplus2"])
        .args(["-nographic", "-serial", "none", "-monitor", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(elf)
        .stdin(Stdio::null())
        .output()
        .expect("timeout starts");
    let log = decode(&fs::read(elf).expect("cargo left an ELF"), &run.stdout);
    let (status, errors) = (run.status, text(&run.stderr));
    assert!(
        status.success(),
        "QEMU ended with {status} (limit {TIMEOUT_S} s):\n{errors}\n{log:#?}"
    );
    log
}

fn decode(elf: &[u8], frames: &[u8]) -> Vec<String> {
    let table = Table::parse(elf).expect("the ELF is sound").expect("the ELF has a .defmt section");
    let mut decoder = table.new_stream_decoder();
    decoder.received(frames);
    let mut log = Vec::new();
    loop {
        match decoder.decode() {
            Ok(frame) => log.push(frame.display_message().to_string()),
            Err(DecodeError::UnexpectedEof) => return log,
            Err(DecodeError::Malformed) => panic!("a malformed defmt frame after {log:#?}"),
        }
    }
}

/// The messages that the firmware would log for the mission as this machine makes it.
fn mission_on_host() -> Vec<String> {
    let world = World::new().expect("the world is sound");
    let mut agent = world.agent().expect("the mission is sound");
    let mut log = Vec::new();
    let mut stopped = None;
    for number in 1..=world::STEPS {
        match agent.step().expect("labels are true") {
            Event::Step(step) => log.push(step_message(number, &step)),
            Event::Stopped(reason) => {
                stopped = Some(format!("end: {reason:?} after {} steps", number - 1));
                break;
            }
        }
    }
    let Estimates { bisector, centre, maximum_margin } = Estimates::of(agent.planner.space());
    log.push(line_message("bisector", bisector));
    log.push(line_message("centre", centre));
    log.push(line_message("maximum margin", maximum_margin));
    log.push(stopped.unwrap_or_else(|| format!("end: all {} steps made", world::STEPS)));
    log
}

fn step_message(number: u32, Step { motion, pose, reading }: &Step) -> String {
    let (action, x, z, heading) = (motion.action.0, pose.site.x(), pose.site.z(), pose.heading.0);
    let sign = reading.map(Reading::sign);
    format!(
        "step {number}: action {action}, x {x}, z {z}, heading {heading:#010x}, reading {sign:?}"
    )
}

fn line_message(name: &str, line: Option<Line>) -> String {
    let Some(line) = line else {
        return format!("{name}: none");
    };
    let [slope, intercept] = [line.slope(), line.intercept()].map(|it| it.unwrap_or(f64::NAN));
    let [a, b, c] = line.coefficients().map(f64::to_bits);
    format!(
        "{name}: slope {slope:?}, intercept {intercept:?}; a {a:#018x}, b {b:#018x}, c {c:#018x}"
    )
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
