//! Text that comes from outside cannot steer a terminal, and is not repeated at length.
#![cfg(unix)]

use std::fs;

use crate::{GOOD, folder, host_sim, text};

/// Clears the screen, rings, goes back to the start of the line; and the same by a single code.
const NAMES: [&str; 4] = ["a\x1b[2Jb.toml", "a\x07b.toml", "a\rb.toml", "a\u{9b}2Jb.toml"];

fn is_tame(said: &str) -> bool {
    said.chars().all(|it| it == '\n' || !it.is_control())
}

#[test]
fn names_of_files_do_not_steer_a_terminal() {
    let folder = folder();
    for name in NAMES {
        let escaped: String = name.chars().flat_map(char::escape_debug).collect();
        fs::write(folder.path().join(name), GOOD).expect("a file");
        for args in [
            &["run", name][..],
            &["run", name, "--verbose", "--trace", name.strip_suffix(".toml").unwrap()],
            &["run", &format!("none {name}")],
            &["init", name],
            &["init", name, "--force"],
            &["replay", name],
            &["campaign", "merge", name],
        ] {
            let output = host_sim(folder.path(), args);
            let said = text(&output.stdout) + &text(&output.stderr);
            assert!(is_tame(&said), "{args:?}: {said:?}");
            let shown = escaped.trim_end_matches(".toml");
            assert!(said.contains(shown), "{args:?}: expected {shown} in {said}");
        }
        // clap leaves such codes out.
        let output = host_sim(folder.path(), &["run", "--algorithm", name]);
        assert!(is_tame(&text(&output.stderr)), "{}", text(&output.stderr));
        let samples = format!("{name}.csv");
        fs::write(folder.path().join(&samples), "x,z,label\n0,0,1\n0,9,-1\n9,0,1\n")
            .expect("a file");
        for args in [
            &["replay", &samples, "--figure", "g.svg"][..],
            &["reference", name, "--horizon", "1", "--turn-step", "0.25"],
        ] {
            let output = host_sim(folder.path(), args);
            let said = text(&output.stdout) + &text(&output.stderr);
            assert!(output.status.success() && is_tame(&said), "{args:?}: {said:?}");
        }
        // What is drawn is still well-formed.
        host_sim(folder.path(), &["run", name, "--figure", "f.svg", "--report", "r.html"]);
        for drawn in ["f.svg", "r.html", "g.svg"] {
            let drawn = fs::read_to_string(folder.path().join(drawn)).expect("it is drawn");
            let found = drawn.chars().find(|it| it.is_control() && *it != '\n' && *it != '\t');
            assert_eq!(found, None, "{name:?}");
        }
    }
}

#[test]
fn titles_of_columns_do_not_steer_a_terminal() {
    let folder = folder();
    fs::write(folder.path().join("s.csv"), "x,z,\x1b[2Jlabel\x07\n1,2,1\n3,4,-1\n")
        .expect("a file");
    let output = host_sim(folder.path(), &["replay", "s.csv"]);
    let said = text(&output.stderr);
    assert!(is_tame(&said) && said.contains("\\u{1b}[2Jlabel\\u{7}"), "{said:?}");
}

#[test]
fn input_is_not_repeated_at_length() {
    let long = "x".repeat(1_000_000);
    let folder = folder();
    let write =
        |name: &str, text: String| fs::write(folder.path().join(name), text).expect("a file");
    write("word.toml", GOOD.replace("\"cfc\"", &format!("\"{long}\"")));
    write("key.toml", format!("{long} = 1\n{GOOD}"));
    write("line.toml", format!("{long}\n{GOOD}"));
    write("title.csv", format!("x,z,{long}\n1,2,1\n"));
    write("cell.csv", format!("x,z,label\n{long},2,1\n"));
    write("label.csv", format!("x,z,label\n1,2,{long}\n"));
    write("s.csv.json", format!("{{\"{long}\":1}}"));
    write("s.csv", format!("field,{long}\n"));
    for (args, part) in [
        (&["run", "word.toml"][..], "word.toml"),
        (&["run", "key.toml"], "key.toml"),
        (&["run", "line.toml"], "line.toml"),
        (&["replay", "title.csv"], "title.csv"),
        (&["replay", "cell.csv"], "cell.csv:2"),
        (&["replay", "label.csv"], "label.csv:2"),
        (&["campaign", "merge", "s.csv"], "s.csv.json"),
    ] {
        let output = host_sim(folder.path(), args);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said:.1000}");
        assert!(said.contains(part), "{args:?}: {said:.1000}");
        assert!(said.len() < 1_500, "{args:?}: {} bytes: {said:.1000}", said.len());
        let longest = said.split(|it| it != 'x').map(str::len).max();
        assert!(longest <= Some(60), "{args:?}: {longest:?}");
    }
    let argument = "x".repeat(100_000);
    let output = host_sim(folder.path(), &["run", "--steps", &argument]);
    assert!(output.stderr.len() < 1_500, "{}", output.stderr.len());
}
