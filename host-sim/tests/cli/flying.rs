//! `fly`: what it refuses, a dry run, and how it says that it is not built in.

use std::fs;

use crate::{GOOD, folder, prints, refuses};

#[cfg(not(feature = "mavlink"))]
#[test]
fn without_mavlink_it_says_how_to_build_it() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let how = "cargo build --release -p host-sim --features mavlink";
    for args in [&["fly"][..], &["fly", "m.toml", "--mavlink", "udp:127.0.0.1:14550"]] {
        refuses(folder.path(), args, &["built without MAVLink", how]);
    }
    assert!(prints(folder.path(), &["fly", "--help"]).contains(how));
}

#[cfg(feature = "mavlink")]
mod built_in {
    use super::*;

    fn tolerant() -> String {
        format!("tolerance = 0.05\n{GOOD}")
    }

    const TRUTH: &str = "truth = { slope = 0.41, intercept = 3.5 }";

    #[test]
    fn bad_flags_are_refused() {
        let folder = folder();
        fs::write(folder.path().join("m.toml"), tolerant()).expect("a file");
        let keep_out = "keep_out = [{ x = 10.0, z = 2.0, radius = 0.5 }]\n";
        fs::write(folder.path().join("k.toml"), format!("{keep_out}{}", tolerant()))
            .expect("a file");
        let cases: [(&[&str], &[&str]); 22] = [
            (&["m.toml", "--label", "WET"], &["--mavlink", "--dry-run"]),
            (&["m.toml", "--dry-run"], &["--label"]),
            (&["m.toml", "--dry-run", "--mavlink", "udp:h:1", "--label", "W"], &["--dry-run"]),
            (&["m.toml", "--dry-run", "--label", "W", "--trace", "t"], &["--dry-run", "--trace"]),
            (&["m.toml", "--dry-run", "--label", "ELEVEN_CHAR"], &["--label", "1 to 10"]),
            (&["m.toml", "--dry-run", "--label", ""], &["--label"]),
            (&["m.toml", "--dry-run", "--label", "channel:0"], &["--label", "1 to 18"]),
            (&["m.toml", "--dry-run", "--label", "channel:19"], &["--label", "1 to 18"]),
            (&["m.toml", "--dry-run", "--label", "channel:x"], &["--label", "1 to 18"]),
            (&["m.toml", "--dry-run", "--label", "W", "--threshold", "nan"], &["--threshold"]),
            (&["m.toml", "--dry-run", "--label", "W", "--system", "0"], &["--system"]),
            (&["m.toml", "--dry-run", "--label", "W", "--system", "256"], &["--system"]),
            (&["m.toml", "--dry-run", "--label", "W", "--wait", "0"], &["--wait", "0.1 to 86400"]),
            (&["m.toml", "--dry-run", "--label", "W", "--motion-time", "x"], &["--motion-time"]),
            (&["m.toml", "--dry-run", "--label", "W", "--label-time", "nan"], &["--label-time"]),
            (&["m.toml", "--dry-run", "--label", "W", "--acceptance", "0"], &["--acceptance"]),
            (
                &["m.toml", "--dry-run", "--label", "W", "--acceptance", "0.1"],
                &["--acceptance", "found 0.1 m", "below 0.1 m", "shortest motion"],
            ),
            (
                &["k.toml", "--dry-run", "--label", "W", "--acceptance", "0.06"],
                &["--acceptance", "found 0.06 m", "0.050 m", "keep-outs"],
            ),
            (&["m.toml", "--mavlink", "here", "--label", "W"], &["--mavlink", "found \"here\""]),
            (&["m.toml", "--mavlink", "udp:here", "--label", "W"], &["--mavlink", "udp:HOST:PORT"]),
            (&["m.toml", "--mavlink", "udp:h:x:1", "--label", "W"], &["--mavlink", "udp:h:x:1"]),
            (&["m.toml", "--mavlink", "file:a:b", "--label", "W"], &["--mavlink", "file:a:b"]),
        ];
        for (args, parts) in cases {
            refuses(folder.path(), &[&["fly"], args].concat(), parts);
        }
    }

    #[test]
    fn scenarios_that_cannot_be_flown_are_refused() {
        let folder = folder();
        let car = "vehicle = { kind = \"car\", radius = 1.0 }\n";
        let cases: [(String, &[&str]); 2] = [
            (GOOD.to_owned(), &["bad.toml", "tolerance", "found 0 m", "above 0"]),
            (format!("{car}{}", tolerant()), &["bad.toml", "vehicle", "found car", "arc"]),
        ];
        for (scenario, parts) in cases {
            fs::write(folder.path().join("bad.toml"), scenario).expect("a file");
            refuses(folder.path(), &["fly", "bad.toml", "--dry-run", "--label", "W"], parts);
        }
    }

    #[test]
    fn a_dry_run_prints_what_it_would_send() {
        let folder = folder();
        fs::write(folder.path().join("m.toml"), tolerant()).expect("a file");
        for label in ["WET", "channel:18"] {
            let args = ["fly", "m.toml", "--dry-run", "-q", "--steps", "2", "--label", label];
            let table = prints(folder.path(), &args);
            for part in ["HEARTBEAT", "message 32 interval 100000 us", "mask 0x9F8", "mask 0x5C7"] {
                assert!(table.contains(part), "{part}: {table}");
            }
            assert_eq!(table.contains("message 65"), label == "channel:18", "{table}");
            for part in ["ARM", "SET_MODE", "DO_SET_MODE"] {
                assert!(!table.contains(part), "{part}: {table}");
            }
        }
    }

    /// A scenario of a real vehicle tells no truth, so that the ideal one senses a line that the oracle leaves.
    #[test]
    fn a_dry_run_needs_no_truth_and_is_short() {
        let folder = folder();
        let untold = tolerant().replace(TRUTH, "");
        fs::write(folder.path().join("m.toml"), untold).expect("a file");
        let args = ["fly", "m.toml", "--dry-run", "-q", "--steps", "5", "--label", "WET"];
        let table = prints(folder.path(), &args);
        assert_eq!(table.matches("mask 0x9F8").count(), 5, "{table}");
        assert!(table.lines().count() < 15, "{table}");
    }

    /// Nobody is there: the status is that of a flight that failed, and nothing is written.
    #[test]
    fn a_vehicle_that_does_not_come_ends_it() {
        let folder = folder();
        fs::write(folder.path().join("m.toml"), tolerant().replace(TRUTH, "")).expect("a file");
        let args = ["fly", "m.toml", "--mavlink", "udp:127.0.0.1:0", "--label", "W"];
        let more = ["--wait", "0.2", "--trace", "t.jsonl", "-q"];
        let output = crate::host_sim(folder.path(), &[&args[..], &more].concat());
        let message = crate::text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(
            message.contains("not ready within 0.2 s (--wait): expected a heartbeat"),
            "{message}"
        );
        assert!(!folder.path().join("t.jsonl").exists());
    }
}
