//! Files and streams that are written: what stays as it was, and what is refused.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::Read as _;
use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
use std::path::Path;
use std::process::Command;
use std::thread;

use tempfile::TempDir;

use crate::{GOOD, folder, host_sim, prints, refuses, text};

fn with_mission() -> TempDir {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    folder
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink())
}

fn make_pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().expect("mkfifo").success());
}

#[test]
fn a_pipe_is_written_through() {
    let folder = with_mission();
    let pipe = folder.path().join("pipe");
    make_pipe(&pipe);
    let reader = thread::spawn({
        let pipe = pipe.clone();
        move || {
            let mut told = String::new();
            File::open(pipe).expect("a pipe").read_to_string(&mut told).expect("text");
            told
        }
    });
    prints(folder.path(), &["run", "m.toml", "--trace", "pipe"]);
    assert!(fs::metadata(&pipe).expect("it stays").file_type().is_fifo(), "the pipe was replaced");
    let told = reader.join().expect("it reads");
    assert_eq!(told, prints(folder.path(), &["run", "m.toml", "--format", "json"]));
}

#[test]
fn a_reader_may_leave_a_pipe_early() {
    let folder = with_mission();
    let pipe = folder.path().join("pipe");
    make_pipe(&pipe);
    let reader = thread::spawn({
        let pipe = pipe.clone();
        move || drop(File::open(pipe))
    });
    prints(folder.path(), &["run", "m.toml", "--trace", "pipe"]);
    assert!(fs::metadata(&pipe).expect("it stays").file_type().is_fifo(), "the pipe was replaced");
    reader.join().expect("it has left");
}

#[test]
fn a_device_is_written_through() {
    let folder = with_mission();
    // By a link of its own: the device itself is not a test's to lose.
    let link = folder.path().join("nowhere");
    symlink("/dev/null", &link).expect("a link");
    prints(folder.path(), &["run", "m.toml", "--trace", "nowhere"]);
    assert!(is_link(&link));
    assert!(fs::metadata(&link).expect("a device").file_type().is_char_device());
}

#[test]
fn a_trace_goes_to_standard_output_wherever_that_leads() {
    let folder = with_mission();
    symlink("/dev/stdout", folder.path().join("link")).expect("a link");
    let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
    let story = prints(folder.path(), &["run", "m.toml"]);
    let args = ["run", "m.toml", "--trace", "link"];
    assert_eq!(prints(folder.path(), &args), trace.clone() + &story);
    // Into a file, where a second opening would begin anew.
    let path = folder.path().join("redirected");
    let redirected = File::create(&path).expect("a file");
    let status = Command::new(env!("CARGO_BIN_EXE_host-sim"))
        .args(args)
        .current_dir(folder.path())
        .stdout(redirected)
        .status();
    assert!(status.expect("it starts").success());
    assert_eq!(read(&path), trace + &story);
    assert!(is_link(&folder.path().join("link")));
}

#[test]
fn a_symbolic_link_stays_and_its_target_changes() {
    let folder = with_mission();
    let place = |name: &str| folder.path().join(name);
    fs::create_dir(place("d")).expect("a folder");
    fs::write(place("d/old"), "old").expect("a file");
    symlink("d/old", place("link")).expect("a link");
    symlink("new", place("d/second")).expect("a link");
    symlink("d/second", place("dangling")).expect("a link");
    prints(folder.path(), &["run", "m.toml", "--trace", "link", "--figure", "dangling"]);
    for link in ["link", "dangling", "d/second"] {
        assert!(is_link(&place(link)), "{link} was replaced");
    }
    assert!(read(&place("d/old")).starts_with(r#"{"record":"start""#));
    assert!(read(&place("d/new")).starts_with("<svg"));
}

#[test]
fn an_output_that_is_an_input_is_refused() {
    let folder = with_mission();
    let place = |name: &str| folder.path().join(name);
    let rows = "x,z,label\n2,1,-1\n2,8,1\n18,16,1\n18,5,-1\n";
    fs::write(place("s.csv"), rows).expect("a file");
    symlink("m.toml", place("link")).expect("a link");
    fs::hard_link(place("m.toml"), place("hard")).expect("a link");
    fs::hard_link(place("s.csv"), place("t.csv")).expect("a link");
    let firmware = "--emulator=firmware";
    fs::write(place("firmware"), "no ELF").expect("a file");
    let cases: [(&[&str], &[&str]); 8] = [
        (&["run", "m.toml", "--trace", "m.toml"], &["m.toml", "--trace", "the scenario"]),
        (&["run", "m.toml", "--figure", "./m.toml"], &["./m.toml", "--figure", "the scenario"]),
        (&["run", "m.toml", "--trace", "link"], &["link", "--trace", "the scenario"]),
        (&["run", "link", "--trace", "m.toml"], &["m.toml", "--trace", "the scenario"]),
        (&["run", "m.toml", "--trace", "hard"], &["hard", "--trace", "the scenario"]),
        (&["replay", "s.csv", "--figure", "s.csv"], &["s.csv", "--figure", "the samples"]),
        (&["replay", "s.csv", "--figure", "t.csv"], &["t.csv", "--figure", "the samples"]),
        (&["hil", "m.toml", firmware, "--log", "firmware"], &["--log", "the firmware"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), args, parts);
        assert_eq!((read(&place("m.toml")), read(&place("s.csv"))), (GOOD.into(), rows.into()));
    }
}

#[test]
fn an_output_that_is_another_is_refused() {
    let folder = with_mission();
    let place = |name: &str| folder.path().join(name);
    fs::write(place("a"), "old").expect("a file");
    fs::hard_link(place("a"), place("hard")).expect("a link");
    symlink("b", place("dangling")).expect("a link");
    make_pipe(&place("pipe"));
    for [one, other] in [
        ["a", "a"],
        ["b", "./b"],
        ["a", "hard"],
        ["b", "dangling"],
        ["dangling", "b"],
        ["pipe", "pipe"],
    ] {
        let args = ["run", "m.toml", "--trace", one, "--figure", other];
        refuses(folder.path(), &args, &[other, "--trace", "--figure"]);
        let args = ["hil", "m.toml", "--emulator=m.toml", "--timing", one, "--log", other];
        refuses(folder.path(), &args, &[other, "--timing", "--log"]);
        assert_eq!(read(&place("a")), "old");
    }
}

#[test]
fn the_figures_of_the_bare_command_are_files_like_others() {
    let folder = folder();
    let place = |name: &str| folder.path().join(name);
    fs::create_dir(place("out")).expect("a folder");
    symlink("../kept.svg", place("out/paper-noiseless.svg")).expect("a link");
    prints(folder.path(), &[]);
    assert!(is_link(&place("out/paper-noiseless.svg")));
    assert!(read(&place("kept.svg")).starts_with("<svg"));
    fs::remove_file(place("out/paper-noisy.svg")).expect("a figure");
    symlink("paper-noiseless.svg", place("out/paper-noisy.svg")).expect("a link");
    refuses(folder.path(), &[], &["out/paper-noisy.svg", "paper-noiseless.svg"]);
}

#[test]
fn permissions_are_the_user_s() {
    let folder = with_mission();
    let mode = |name: &str| {
        let found = fs::metadata(folder.path().join(name)).expect("a file");
        format!("{:o}", found.permissions().mode() & 0o7777)
    };
    fs::write(folder.path().join("old"), "").expect("a file");
    let own = fs::Permissions::from_mode(0o604);
    fs::set_permissions(folder.path().join("old"), own).expect("a mode");
    for (umask, expected) in [("027", "640"), ("002", "664"), ("077", "600")] {
        let program = env!("CARGO_BIN_EXE_host-sim");
        let script = format!(
            "rm -f new; umask {umask}; {program} run m.toml --trace new --figure old >printed"
        );
        let shell = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output();
        let shell = shell.expect("a shell");
        assert!(shell.status.success(), "{}", text(&shell.stderr));
        assert_eq!((mode("new"), mode("old")), (expected.into(), "604".into()), "umask {umask}");
    }
}

#[test]
fn what_is_no_place_for_a_file_is_refused() {
    let folder = with_mission();
    symlink("round", folder.path().join("round")).expect("a link");
    symlink("no/where", folder.path().join("astray")).expect("a link");
    for place in ["round", "astray", "new/", ".."] {
        refuses(folder.path(), &["run", "m.toml", "--trace", place], &[place, "expected a"]);
        let args = ["hil", "m.toml", "--emulator=m.toml", "--log", place];
        refuses(folder.path(), &args, &[place, "expected a"]);
    }
}

#[test]
fn a_full_or_closed_standard_error_is_no_panic() {
    let folder = folder();
    for redirection in ["2>/dev/full", "2>&-"] {
        for args in ["run none.toml", "run", "campaign --fields 0", "campaign --steps 0"] {
            let program = env!("CARGO_BIN_EXE_host-sim");
            let script = format!("{program} {args} {redirection}");
            let shell =
                Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output();
            let output = shell.expect("a shell");
            assert_eq!(output.status.code(), Some(2), "{script}");
            assert_eq!(text(&output.stdout), "", "{script}");
        }
    }
}

#[test]
fn a_full_standard_output_is_told_and_a_closed_pipe_is_not() {
    let folder = with_mission();
    for args in [&["run", "m.toml"][..], &["--help"], &["--version"]] {
        let full = File::options().write(true).open("/dev/full").expect("a device");
        let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .args(args)
            .current_dir(folder.path())
            .stdout(full)
            .output()
            .expect("it starts");
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert!(text(&output.stderr).starts_with("error: standard output"), "{args:?}");
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let output = Command::new(env!("CARGO_BIN_EXE_host-sim"))
            .args(args)
            .current_dir(folder.path())
            .stdout(writer)
            .output()
            .expect("it starts");
        assert_eq!(
            (output.status.code(), text(&output.stderr)),
            (Some(0), String::new()),
            "{args:?}"
        );
    }
    assert!(host_sim(folder.path(), &["--help"]).status.success());
}
