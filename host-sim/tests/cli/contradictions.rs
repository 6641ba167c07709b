//! A label that contradicts what is known ends a mission: what was flown until then is written all the same.

use std::fs;
use std::path::Path;

use crate::{GOOD, folder, host_sim, text};

/// Positions err by six times the tolerance, so that a label soon contradicts the others.
fn doubtful() -> tempfile::TempDir {
    let folder = folder();
    let scenario = format!("errors = {{ position = 0.3 }}\ntolerance = 0.05\n{GOOD}")
        .replace("steps = 10", "steps = 40");
    fs::write(folder.path().join("m.toml"), scenario).expect("a file");
    folder
}

/// What the command printed, after it said on standard error what contradicts what.
fn contradicted(folder: &Path, args: &[&str]) -> String {
    let output = host_sim(folder, args);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    for part in ["error: ", "m.toml", ": step ", "contradicts the region of certainty", "tolerance"]
    {
        assert!(message.contains(part), "{args:?}: expected {part:?} in {message}");
    }
    assert_eq!(message.matches("error: ").count(), 1, "{message}");
    text(&output.stdout)
}

#[test]
fn a_contradiction_leaves_what_was_flown() {
    let folder = doubtful();
    let flags = ["run", "m.toml", "-q", "--trace", "t.jsonl", "--figure", "f.svg"];
    let flags = [&flags[..], &["--report", "r.html", "--mcap", "l.mcap"]].concat();
    let said = contradicted(folder.path(), &flags);
    assert!(said.contains("Ended: broken off"), "{said}");
    let read = |name: &str| fs::read(folder.path().join(name)).expect(name);
    let trace = text(&read("t.jsonl"));
    let lines: Vec<_> = trace.lines().collect();
    assert!(lines[0].contains("\"record\":\"start\"") && lines.len() > 5, "{trace}");
    let end = lines[lines.len() - 1];
    assert!(end.contains("\"record\":\"end\",\"reason\":\"broken off\""), "{end}");
    assert!(text(&read("f.svg")).ends_with("</svg>\n") || text(&read("f.svg")).ends_with("</svg>"));
    assert!(text(&read("r.html")).contains("Broken off"));
    assert!(read("l.mcap").len() > 1_000);
    // Standard output has the same, whatever the format.
    let json = contradicted(folder.path(), &["run", "m.toml", "-q", "--format", "json"]);
    assert_eq!(json, trace);
    let flat = contradicted(folder.path(), &["run", "m.toml", "-q", "--format", "flat"]);
    assert_eq!(flat.lines().count(), lines.len() - 2, "{flat}");
}

#[test]
fn a_comparison_shows_what_was_flown_until_a_contradiction() {
    let folder = doubtful();
    let args = ["run", "m.toml", "-q", "--compare", "cfc,lookahead", "--report", "r.html"];
    let said = contradicted(folder.path(), &args);
    let output = host_sim(folder.path(), &args);
    let message = text(&output.stderr);
    assert!(
        message.contains("--compare cfc: step ")
            && message.contains("; --compare lookahead: step "),
        "{message}"
    );
    assert!(said.contains("Algorithm 1") && said.contains("look-ahead"), "{said}");
    let page = fs::read_to_string(folder.path().join("r.html")).expect("a page");
    assert!(page.contains("Broken off") && page.ends_with("</html>\n"));
}
