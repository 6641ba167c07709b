//! The storeys of ARCHITECTURE.md: a module reads only from its own folder and from folders below it, and
//! modules never read each other in a circle. Checked on the sources of `planner-core` and `host-sim` (with the crate
//! below it), test code included; then on made-up sources, so that the check is known to fail when it should.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The folders of a crate, lowest first. Folders of one storey do not read each other; the crate's root is
/// above all of them.
type Storeys<'a> = &'a [&'a [&'a str]];

const PLANNER_CORE: Storeys = &[
    &["geometry"],
    &["belief", "motion"],
    &["search"],
    &["planner"],
    &["robot"],
    &["dynamics", "error", "link", "watch"],
];

const HOST_SIM: Storeys = &[
    &["output", "world"],
    &["fitting"],
    &["mission"],
    &["campaign", "reference", "size"],
    &["report"],
    &["replay"],
    &["hil", "fly"],
    &["cli"],
];

/// What the crate's root is called in messages.
const ROOT: &str = "crate";

/// The modules of a crate: the path of each from the root, and its source.
type Modules = BTreeMap<Vec<String>, String>;

/// Which modules each module reads, by name. That a folder's front page declares its modules is no reading.
type Reads = BTreeMap<String, BTreeSet<String>>;

#[test]
fn planner_core_reads_downwards() {
    check("planner-core", &["planner-core/src"], PLANNER_CORE);
}

#[test]
fn host_sim_reads_downwards() {
    check("host-sim", &["host-sim/missions/src", "host-sim/src"], HOST_SIM);
}

/// Fails with a line for each import from above and for each circle.
fn check(package: &str, folders: &[&str], storeys: Storeys) {
    let mut modules = Modules::new();
    for folder in folders {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
        read_folder(&folder, &[], &mut modules);
    }
    for name in storeys.iter().copied().flatten() {
        assert!(modules.contains_key([(*name).to_owned()].as_slice()), "{package} has no {name}");
    }
    let faults = faults(&modules, storeys);
    assert!(faults.is_empty(), "{package}:\n{}", faults.join("\n"));
}

/// The sources of a folder and of those in it. `main.rs` is left out: it is a crate of its own, so nothing
/// can read it.
fn read_folder(folder: &Path, path: &[String], modules: &mut Modules) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let file = entry.expect("an entry").path();
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let below = || path.iter().cloned().chain([name.clone()]).collect::<Vec<_>>();
        if file.is_dir() {
            read_folder(&file, &below(), modules);
        } else if file.extension().is_some_and(|it| it == "rs") && name != "main" {
            let front_page = matches!(name.as_str(), "lib" | "mod");
            let path = if front_page { path.to_vec() } else { below() };
            modules.insert(path, fs::read_to_string(&file).expect("a source"));
        }
    }
}

/// What is wrong with a crate, a line each. A circle across folders is told by its reading upwards alone.
fn faults(modules: &Modules, storeys: Storeys) -> Vec<String> {
    let mut reads = reads(modules);
    let mut faults = Vec::new();
    for (reader, read) in &mut reads {
        let Some(own) = storey(reader, storeys) else {
            faults.push(format!("{reader} is in no storey: the table at the head of this test"));
            continue;
        };
        read.retain(|it| {
            let is_right =
                folder(it) == folder(reader) || storey(it, storeys).is_none_or(|its| its < own);
            if !is_right {
                faults.push(format!("{reader} reads {it}, which is not below it"));
            }
            is_right
        });
    }
    let circles = circles(reads);
    faults.extend(circles.iter().map(|it| format!("a circle: {} -> {}", it.join(" -> "), it[0])));
    faults
}

/// The storey of a module; `None` if the table does not name its folder.
fn storey(module: &str, storeys: Storeys) -> Option<usize> {
    let found = storeys.iter().position(|it| it.contains(&folder(module)));
    found.or_else(|| (module == ROOT).then_some(storeys.len()))
}

/// The folder that a module lies in, under the root.
fn folder(module: &str) -> &str {
    module.split_once("::").map_or(module, |(folder, _)| folder)
}

/// Circles, until none would be left if the last reading of each were taken out.
fn circles(mut reads: Reads) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    while let Some(circle) = circle(&reads) {
        let (first, last) = (&circle[0], &circle[circle.len() - 1]);
        reads.get_mut(last).expect("a module").remove(first);
        found.push(circle);
    }
    found
}

/// A circle, by taking away modules that read no other module that is left.
fn circle(reads: &Reads) -> Option<Vec<String>> {
    let mut left = reads.clone();
    loop {
        let (kept, leaves): (Reads, Reads) = left
            .clone()
            .into_iter()
            .partition(|(_, read)| read.iter().any(|it| left.contains_key(it)));
        left = kept;
        if leaves.is_empty() {
            break;
        }
    }
    // Each that is left reads another that is left: follow these until one comes again.
    let mut way = vec![left.keys().next()?.clone()];
    loop {
        let next = left[&way[way.len() - 1]].iter().find(|it| left.contains_key(*it));
        let next = next.expect("leaves were taken away").clone();
        if let Some(start) = way.iter().position(|it| *it == next) {
            return Some(way.split_off(start));
        }
        way.push(next);
    }
}

/// Which modules each module reads.
fn reads(modules: &Modules) -> Reads {
    let name = |path: &[String]| {
        if path.is_empty() { ROOT.to_owned() } else { path.join("::") }
    };
    let mut reads = Reads::new();
    for (module, source) in modules {
        let words = words(source);
        let mentions = Mentions::of(&words);
        let found = mentions.iter().filter_map(|it| resolve(it, module, modules));
        let others = found.filter(|it| it != module).map(|it| name(&it));
        reads.insert(name(module), others.collect());
    }
    reads
}

/// The module that a path leads to: the longest part of it that is a module's file, as what follows is an
/// item of that module. `None` for what is not of this crate.
fn resolve(mention: &Mention, module: &[String], modules: &Modules) -> Option<Vec<String>> {
    let supers = mention.path.iter().take_while(|it| **it == "super").count();
    let first = *mention.path.first()?;
    let (mut found, skip, depth_left) = match first {
        "crate" => (Vec::new(), 1, 0),
        "self" => (module.to_vec(), 1, mention.depth),
        "super" => {
            let up = supers.saturating_sub(mention.depth);
            let above = module[..module.len().checked_sub(up)?].to_vec();
            (above, supers, mention.depth.saturating_sub(supers))
        }
        _ => (module.to_vec(), 0, mention.depth),
    };
    let start = found.len();
    // Within an inline module names are its own, and the file is what it is part of.
    for name in mention.path.iter().skip(skip).take_while(|_| depth_left == 0) {
        found.push((*name).to_owned());
        if !modules.contains_key(&found) {
            found.pop();
            break;
        }
    }
    // A path without one of the keywords is of this crate only if it begins with a module of this folder.
    (skip > 0 || found.len() > start).then_some(found)
}

/// A path in code, and in how many inline modules it stands.
#[derive(Debug, PartialEq)]
struct Mention<'a> {
    path: Vec<&'a str>,
    depth: usize,
}

/// Collects the paths of a source.
struct Mentions<'a> {
    words: &'a [&'a str],
    at: usize,
    depth: usize,
    found: Vec<Mention<'a>>,
}

impl<'a> Mentions<'a> {
    /// All paths of more than one name, in the order of the source; a group of imports gives one for each
    /// of its members.
    fn of(words: &'a [&'a str]) -> Vec<Mention<'a>> {
        let mut this = Self { words, at: 0, depth: 0, found: Vec::new() };
        let mut braces = Vec::new();
        while this.at < words.len() {
            let before = this.at.checked_sub(1).map(|it| words[it]);
            match (this.word(0), this.word(1), this.word(2)) {
                ("mod", _, "{") => {
                    braces.push(1);
                    this.depth += 1;
                    this.at += 3;
                }
                ("{", ..) => {
                    braces.push(0);
                    this.at += 1;
                }
                ("}", ..) => {
                    this.depth -= braces.pop().unwrap_or(0);
                    this.at += 1;
                }
                (name, "::", _) if is_name(name) && before != Some("::") => this.tree(&[]),
                _ => this.at += 1,
            }
        }
        this.found
    }

    /// The word so many further on; nothing at the end.
    fn word(&self, ahead: usize) -> &'a str {
        self.words.get(self.at + ahead).copied().unwrap_or("")
    }

    /// A path from here on, with the groups in it.
    fn tree(&mut self, before: &[&'a str]) {
        let mut path = before.to_vec();
        while is_name(self.word(0)) {
            path.push(self.word(0));
            self.at += 1;
            if self.word(0) != "::" {
                break;
            }
            self.at += 1;
        }
        if self.word(0) != "{" || self.words[self.at - 1] != "::" {
            self.found.push(Mention { path, depth: self.depth });
            return;
        }
        self.at += 1;
        while !matches!(self.word(0), "}" | "") {
            self.tree(&path);
            // A star, or another name after `as`.
            while !matches!(self.word(0), "," | "}" | "") {
                self.at += 1;
            }
            self.at += usize::from(self.word(0) == ",");
        }
        self.at += 1;
    }
}

fn is_name(word: &str) -> bool {
    word.starts_with(|it: char| it == '_' || it.is_alphabetic())
}

/// The code of a source: names, `::` and single signs. Comments, numbers, strings and characters are left out.
fn words(source: &str) -> Vec<&str> {
    let mut words = Vec::new();
    let mut rest = source;
    while let Some(first) = rest.chars().next() {
        let is_part = |it: char| it == '_' || it.is_alphanumeric();
        let (length, is_code) = if let Some(length) = comment(rest).or_else(|| literal(rest)) {
            (length, false)
        } else if is_part(first) {
            (rest.find(|it| !is_part(it)).unwrap_or(rest.len()), !first.is_numeric())
        } else if rest.starts_with("::") {
            (2, true)
        } else {
            (first.len_utf8(), !first.is_whitespace())
        };
        let (word, after) = rest.split_at(length);
        words.extend(is_code.then_some(word));
        rest = after;
    }
    words
}

/// How long the comment is that begins here, if one does.
fn comment(rest: &str) -> Option<usize> {
    if rest.starts_with("//") {
        return Some(rest.find('\n').unwrap_or(rest.len()));
    }
    let mut length = rest.starts_with("/*").then_some(2)?;
    let mut depth = 1;
    while depth > 0 && length < rest.len() {
        let here = &rest.as_bytes()[length..];
        let step = match here {
            [b'/', b'*', ..] => 1,
            [b'*', b'/', ..] => -1,
            _ => 0,
        };
        depth += step;
        length += if step == 0 { 1 } else { 2 };
    }
    Some(length)
}

/// How long the string or character is that begins here, if one does.
fn literal(rest: &str) -> Option<usize> {
    if let Some(inside) = rest.strip_prefix('\'') {
        // An escape, or one character; else it is a lifetime.
        let first = inside.chars().next()?.len_utf8();
        let skip = if inside.starts_with('\\') { 2 } else { first };
        let end = inside.get(skip..)?.find('\'')?;
        return (end == 0 || inside.starts_with('\\')).then_some(1 + skip + end + 1);
    }
    let kind = ["br", "cr", "r", "b", "c", ""].into_iter().find(|it| {
        let quoted = rest.strip_prefix(it);
        let hashes = if it.ends_with('r') { "#" } else { "" };
        quoted.is_some_and(|it| it.trim_start_matches(|c| hashes.contains(c)).starts_with('"'))
    })?;
    let open = rest.find('"')? + 1;
    if kind.ends_with('r') {
        let end = format!("\"{}", "#".repeat(open - kind.len() - 1));
        return Some(rest[open..].find(&end).map_or(rest.len(), |it| open + it + end.len()));
    }
    let mut escaped = false;
    let end = rest[open..].find(|it| {
        let ends = it == '"' && !escaped;
        escaped = it == '\\' && !escaped;
        ends
    });
    Some(end.map_or(rest.len(), |it| open + it + 1))
}

// The check itself, on sources that are made up.

const MADE_UP: Storeys = &[&["ground"], &["left", "right"], &["roof"]];

fn made_up(sources: &[(&str, &str)]) -> Modules {
    let path = |name: &str| name.split("::").filter(|it| *it != ROOT).map(str::to_owned).collect();
    sources.iter().map(|&(name, source)| (path(name), source.to_owned())).collect()
}

#[test]
fn readings_downwards_and_within_a_folder_are_right() {
    let modules = made_up(&[
        (ROOT, "pub mod ground; pub mod roof; pub use crate::roof::tile::Tile;"),
        ("ground", "pub mod stone; pub use stone::Stone;"),
        ("ground::stone", "pub struct Stone;"),
        ("roof", "pub mod beam; pub mod tile;"),
        ("roof::beam", "use crate::ground::Stone; use core::fmt;"),
        ("roof::tile", "use super::beam::Beam; mod tests { use super::*; use super::Tile; }"),
    ]);
    assert_eq!(faults(&modules, MADE_UP), Vec::<String>::new());
    let reads = reads(&modules);
    assert!(reads["roof::tile"].contains("roof::beam"), "{reads:?}");
    assert!(reads["roof::beam"].contains("ground"), "{reads:?}");
    assert!(reads["ground"].contains("ground::stone"), "{reads:?}");
}

#[test]
fn a_reading_upwards_is_named() {
    let modules = made_up(&[
        ("ground", "pub mod stone;"),
        ("ground::stone", "use core::{cell::Cell, fmt}; use crate::{roof::{tile::Tile as T, x}};"),
        ("roof", "pub mod tile;"),
        ("roof::tile", ""),
    ]);
    assert_eq!(
        faults(&modules, MADE_UP),
        [
            "ground::stone reads roof, which is not below it",
            "ground::stone reads roof::tile, which is not below it",
        ]
    );
}

#[test]
fn a_reading_across_or_of_the_root_is_named() {
    let modules = made_up(&[
        (ROOT, "pub mod left; pub mod right;"),
        ("left", "fn f(it: &crate::right::Side) -> bool { it.at() }"),
        ("right", "fn f() { let _ = crate::Everything; }"),
    ]);
    let expected =
        ["left reads right, which is not below it", "right reads crate, which is not below it"];
    assert_eq!(faults(&modules, MADE_UP), expected);
}

#[test]
fn a_reading_by_test_code_is_named() {
    let modules = made_up(&[
        ("ground", "#[cfg(test)] mod tests { use super::*; use super::super::roof::Tile; }"),
        ("roof", ""),
    ]);
    assert_eq!(faults(&modules, MADE_UP), ["ground reads roof, which is not below it"]);
}

#[test]
fn a_folder_without_a_storey_is_named() {
    let modules = made_up(&[("cellar", "")]);
    let fault = "cellar is in no storey: the table at the head of this test";
    assert_eq!(faults(&modules, MADE_UP), [fault]);
}

#[test]
fn circles_are_named() {
    let modules = made_up(&[
        ("roof", "pub mod a; pub mod b; pub mod c; pub mod d; pub mod e;"),
        ("roof::a", "use crate::roof::b::B; use crate::ground::Stone;"),
        ("roof::b", "use super::c::C;"),
        ("roof::c", "fn f() -> Vec<crate::roof::a::A> { vec![] }"),
        ("roof::d", "use crate::roof::a::A; use crate::roof::e::E;"),
        ("roof::e", "use crate::roof::d::D;"),
        ("ground", ""),
    ]);
    let expected = [
        "a circle: roof::a -> roof::b -> roof::c -> roof::a",
        "a circle: roof::d -> roof::e -> roof::d",
    ];
    assert_eq!(faults(&modules, MADE_UP), expected);
}

#[test]
fn a_front_page_that_reads_its_reader_is_a_circle() {
    let modules = made_up(&[
        ("roof", "pub mod tile; pub use tile::Tile; pub trait Cover {}"),
        ("roof::tile", "use crate::roof::Cover;"),
    ]);
    assert_eq!(faults(&modules, MADE_UP), ["a circle: roof -> roof::tile -> roof"]);
}

#[test]
fn what_is_not_code_does_not_count() {
    let source = r##"
        //! use crate::roof::a;
        /// [`crate::roof::b`]
        /* use crate::roof::c; /* nested */ use crate::roof::d; */
        const S: &str = "use crate::roof::e \" crate::roof::f";
        const R: &str = r#"" crate::roof::g"#;
        const B: &[u8] = b"crate::roof::h\\";
        const C: [char; 3] = ['"', '\'', '\u{22}'];
        fn f<'a>(it: &'a str) -> &'a str { it }
        pub(crate) struct Used(crate::ground::Stone);
    "##;
    let words = words(source);
    let found: Vec<_> = Mentions::of(&words).into_iter().map(|it| it.path.join("::")).collect();
    assert_eq!(found, ["crate::ground::Stone"]);
}
