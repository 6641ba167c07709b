//! The ending of an output's name must match the output's format, or promise no format.
#![cfg(unix)]

use std::fs;

use crate::{GOOD, folder, prints, refuses};

#[test]
fn a_name_that_promises_another_format_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    for (flag, ending, remedy) in [
        ("--figure", "png", ".svg"),
        ("--figure", "PNG", ".svg"),
        ("--figure", "jpg", ".svg"),
        ("--figure", "jpeg", ".svg"),
        ("--figure", "gif", ".svg"),
        ("--figure", "webp", ".svg"),
        ("--figure", "pdf", ".svg"),
        ("--figure", "html", ".svg"),
        ("--report", "svg", ".html"),
        ("--report", "pdf", ".html"),
        ("--trace", "csv", ".jsonl"),
        ("--mcap", "bag", ".mcap"),
        ("--mcap", "jsonl", ".mcap"),
    ] {
        let name = format!("a.{ending}");
        let args = ["run", "m.toml", flag, &name];
        refuses(folder.path(), &args, &[&name, flag, remedy]);
    }
    let other = ["campaign", "--fields", "2", "--figure", "a.png"];
    refuses(folder.path(), &other, &["a.png", "--figure", ".svg"]);
    let other = ["campaign", "--fields", "2", "--csv", "a.xlsx"];
    refuses(folder.path(), &other, &["a.xlsx", "--csv", ".csv"]);
}

#[test]
fn a_name_that_promises_nothing_is_taken() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    for (flag, names) in [
        ("--figure", ["a", "a.svg", "a.SVG", "a.svg.new", "/dev/null"]),
        ("--report", ["b", "b.html", "b.htm", "b.old", "/dev/stdout"]),
        ("--trace", ["c", "c.jsonl", "c.json", "c.txt", "c.2026-11-23"]),
    ] {
        for name in names {
            prints(folder.path(), &["run", "m.toml", flag, name]);
        }
    }
}
