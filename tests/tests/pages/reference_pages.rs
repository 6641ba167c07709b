//! The pages of `docs/reference`: what a program can tell of itself is made from it.
//!
//! A block between `<!-- flags: run -->`, or one of the following, and `<!-- end -->` is generated:
//! `UPDATE_EXPECT=1 cargo test -p tests reference_pages::` writes all of them anew.
//!
//! - `flags: COMMAND`: the flags, from the command line. Those of `run` are told once.
//! - `keys: FILE STRUCT PREFIX`: the fields of a struct of `host-missions`, from their comments; after `fields:`, with a `?`
//!   behind those that may be absent from a record.
//! - `prints: COMMAND`: what it prints.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Arg, Command, CommandFactory as _};
use expect_test::expect_file;
use host_sim::cli::arguments::Cli;
use host_sim::mission::scenario::{self, Overrides};
use tests::build::root;
use tests::command;

/// The most bytes of a page.
const MOST: usize = 10 * 1024;

/// The pages, each with its path.
fn pages() -> Vec<(PathBuf, String)> {
    let folder = fs::read_dir(root().join("docs/reference")).expect("the pages");
    let paths = folder.map(|entry| entry.expect("an entry").path());
    paths.map(|path| (path.clone(), fs::read_to_string(path).expect("a page"))).collect()
}

/// A page with its blocks made anew.
fn generated(page: &str) -> String {
    let mut parts = page.split("<!-- ");
    let mut made = parts.next().expect("a page").to_owned();
    for part in parts {
        let (marker, old) = part.split_once(" -->\n").expect("a marker ends its line");
        let (kind, what) = marker.split_once(": ").unwrap_or((marker, ""));
        let mut words = what.split(' ');
        let mut word = || words.next().unwrap_or("");
        let block = match kind {
            "flags" => flags(what).unwrap_or_else(|| old.to_owned()),
            "keys" | "fields" => keys(&source(word()), word(), word(), kind == "fields"),
            "prints" => {
                // Tests run in the folder of their package.
                let line = format!("host-sim {what}").replace(" host-sim/", " ../host-sim/");
                format!("```text\n{}```\n", command::told(&line))
            }
            "end" => old.to_owned(),
            _ => panic!("<!-- {marker} --> is no block"),
        };
        let _ = write!(made, "<!-- {marker} -->\n{block}");
    }
    made
}

/// The flags of a command, a line each. `None` if this program is built without them.
fn flags(name: &str) -> Option<String> {
    let mut cli = Cli::command();
    cli.build();
    let find = |name: &str| {
        let names = name.split(' ');
        names.fold(&cli, |it, name| it.find_subcommand(name).expect("a command")).clone()
    };
    let is_own = |it: &&Arg| !it.is_global_set() && !it.is_hide_set() && it.get_id() != "help";
    let ids = |it: &Command| it.get_arguments().map(|it| it.get_id().clone()).collect();
    let told: BTreeSet<_> = if name == "run" { BTreeSet::new() } else { ids(&find("run")) };
    let is_of_run = matches!(name, "hil" | "fly");
    let command = find(name);
    let own = command.get_arguments().filter(is_own);
    let lines: String =
        own.filter(|it| !is_of_run || !told.contains(it.get_id())).map(flag).collect();
    (!lines.is_empty()).then_some(lines)
}

fn flag(arg: &Arg) -> String {
    let choices = arg.get_possible_values();
    let choices: Vec<_> = choices.iter().map(PossibleValue::get_name).collect();
    let value = match arg.get_value_names() {
        _ if !arg.get_action().takes_values() => String::new(),
        Some([name]) if choices.is_empty() || name.contains("...") => name.to_string(),
        _ => choices.join("|"),
    };
    let (least, most) = arg.get_num_args().map_or((1, 1), |it| (it.min_values(), it.max_values()));
    let value = match () {
        () if arg.is_positional() && most > 1 => format!("{value}..."),
        () if arg.is_positional() || value.is_empty() => value,
        () if least == 0 => format!("[={value}]"),
        () => format!(" {value}"),
    };
    let long = arg.get_long().map_or(String::new(), |it| format!("--{it}"));
    let help = arg.get_help().expect("each flag has a help").to_string();
    let usual: Vec<_> = arg.get_default_values().iter().map(|it| it.to_string_lossy()).collect();
    let is_told = usual.is_empty() || help.contains("[default") || value.is_empty();
    let usual = if is_told { String::new() } else { format!(" [default: {}]", usual.join(",")) };
    format!("- `{long}{value}`: {help}{usual}\n")
}

fn source(file: &str) -> String {
    let path = root().join("host-sim/missions/src").join(file);
    fs::read_to_string(&path).unwrap_or_else(|why| panic!("{file}: {why}"))
}

/// What stands before a struct, with its attributes, and the lines between its braces.
fn parts<'a>(source: &'a str, name: &str) -> [&'a str; 2] {
    let is_end = |it: char| !it.is_alphanumeric();
    let mut all = source.match_indices("struct ").map(|(at, it)| source.split_at(at + it.len()));
    let found = all.find(|it| it.1.strip_prefix(name).is_some_and(|it| it.starts_with(is_end)));
    let (before, rest) = found.unwrap_or_else(|| panic!("no struct {name}"));
    let fields = rest.split_once("{\n").and_then(|it| it.1.split_once("\n}")).expect("fields").0;
    [before.rsplit("\n\n").next().unwrap_or_default(), fields]
}

/// The fields of a struct, a line each.
fn keys(source: &str, name: &str, prefix: &str, marks: bool) -> String {
    let (mut lines, mut comment, mut attributes) = (String::new(), String::new(), String::new());
    let [head, body] = parts(source, name);
    let skips_none = head.contains("skip_serializing_none");
    for line in body.lines().map(str::trim) {
        if let Some(text) = line.strip_prefix("///") {
            comment += text;
        } else if line.starts_with("#[") {
            attributes += line;
        } else {
            let key = line.split_once(": ").expect(line).0;
            let key = key.rsplit(' ').next().unwrap_or_default();
            if !attributes.contains("serde(skip)") && !attributes.contains("serde(flatten)") {
                assert!(!comment.is_empty(), "{name}: {key} has no comment");
                let means = comment.trim().trim_end_matches('.').replace("`None`", "null");
                let is_skipped = skips_none
                    && line.contains(": Option<")
                    && !attributes.contains("serialize_always");
                let is_optional = is_skipped || attributes.contains("skip_serializing_if");
                let mark = if marks && is_optional { "?" } else { "" };
                let _ = writeln!(lines, "- `{prefix}{key}`{mark}: {means}");
            }
            (comment, attributes) = (String::new(), String::new());
        }
    }
    lines
}

#[test]
fn what_a_program_tells_of_itself_is_on_the_pages() {
    for (path, page) in pages() {
        expect_file![path].assert_eq(&generated(&page));
    }
}

#[test]
fn pages_are_short() {
    for (path, page) in pages() {
        assert!(page.len() <= MOST, "{}: {} bytes", path.display(), page.len());
    }
}

#[test]
fn no_command_and_no_table_of_a_scenario_is_left_out() {
    let text: String = pages().into_iter().map(|(_, page)| page).collect();
    for command in Cli::command().get_subcommands() {
        let marker = format!("<!-- flags: {} -->", command.get_name());
        assert!(text.contains(&marker), "{marker}");
    }
    let tables = source("mission/scenario.rs");
    let [_, keys] = parts(&tables, "File");
    let tables = keys.split("Table<").skip(1).filter_map(|it| it.split('>').next());
    for table in tables {
        assert!(text.contains(&format!(" {table} ")), "no keys of {table}");
    }
}

/// The first example of the scenario's page has the defaults, and each is a good file.
#[test]
fn the_examples_of_a_scenario_are_good() {
    let page = include_str!("../../../docs/reference/scenario.md");
    let examples = page.split("```toml\n").skip(1).filter_map(|it| it.split("```").next());
    let read =
        |text: &str| scenario::parse("example", text, Overrides::default()).expect("a mission");
    let examples: Vec<_> = examples.map(|it| (it, format!("{:?}", read(it)))).collect();
    let is_required = |it: &&str| !it.contains(" = ") || it.starts_with([' ', 't', 'o']);
    let (whole, mission) = &examples[0];
    let least: String = whole.lines().filter(is_required).flat_map(|it| [it, "\n"]).collect();
    assert!(least.len() < whole.len() / 2, "{least}");
    assert_eq!(format!("{:?}", read(&least)), *mission, "a default differs");
}

#[test]
fn a_field_is_told_by_its_comment() {
    let source = "struct Other { }\npub struct It<L = f64> {\n    /// One.\n    pub a: u8,\n    #[serde(skip)]\n    b: u8,\n    \
                  /// `None`\n    /// or two\n    #[serde(skip_serializing_if = \"x\")]\n    c: Option<[u8; 2]>,\n}\n";
    assert_eq!(keys(source, "It", "it.", true), "- `it.a`: One\n- `it.c`?: null or two\n");
    assert_eq!(keys(source, "It", "", false), "- `a`: One\n- `c`: null or two\n");
    let source = "#[skip_serializing_none]\nstruct It {\n/// One\na: Option<u8>,\n/// Two\n#[serialize_always]\nb: Option<u8>,\n}\n";
    assert_eq!(keys(source, "It", "", true), "- `a`?: One\n- `b`: Two\n");
}
