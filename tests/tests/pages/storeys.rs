//! The storeys, which ARCHITECTURE.md shows: a module reads only from its own folder and from folders below it, and
//! modules never read each other in a circle. This is checked on the sources of `planner-core`, its interface
//! for C, and `host-sim` with the crate below it. Test code is included. Made-up sources show that the check can fail.
//!
//! And each word has one meaning: `planner-core` defines no type name twice.
//!
//! Paths are found as text. A comment ends the line, and names from the first inline module on are that module's.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The folders of a crate, lowest first. Folders of one storey do not read each other; the crate's root is
/// above all of them.
type Storeys<'a> = &'a [&'a [&'a str]];

const PLANNER_CORE: Storeys = &[
    &["draws"],
    &["geometry"],
    &["belief", "motion"],
    &["search"],
    &["planner"],
    &["robot"],
    &["dynamics", "error", "lattice", "link", "parts", "watch"],
];

/// Its modules are files, and each is a storey of its own.
const PLANNER_C: Storeys = &[
    &["status"],
    &["types", "verdict"],
    &["area"],
    &["mission"],
    &["parts", "snapshot"],
    &["held"],
    &["finder", "follower"],
    &["sizes"],
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

/// The modules of a crate: the path of each from the root, as `crate::folder::file`, and its source.
type Modules = BTreeMap<String, String>;

/// Which modules each module reads. That a folder's front page declares its modules is no reading.
type Reads<'a> = BTreeMap<&'a str, BTreeSet<String>>;

#[test]
fn modules_read_downwards() {
    let root = tests::build::root();
    let page = fs::read_to_string(root.join("ARCHITECTURE.md")).expect("the page");
    for (folders, storeys, least) in [
        (&["planner-core/src"][..], PLANNER_CORE, 300),
        (&["planner-core/c/src"], PLANNER_C, 40),
        (&["host-sim/missions/src", "host-sim/src"], HOST_SIM, 500),
    ] {
        let mut modules = Modules::new();
        for folder in folders {
            read_folder(&root.join(folder), "crate", &mut modules);
        }
        for name in storeys.iter().copied().flatten() {
            assert!(modules.contains_key(&format!("crate::{name}")), "{folders:?} have no {name}");
            let is_folder = folders.iter().any(|it| root.join(it).join(name).is_dir());
            assert!(
                !is_folder || page.contains(&format!(" {name}/ ")),
                "no {name} in ARCHITECTURE.md"
            );
        }
        let reads = reads(&modules);
        let found: usize = reads.values().map(BTreeSet::len).sum();
        assert!(found > least, "{folders:?}: {found} readings are too few");
        let faults = faults(&reads, storeys);
        assert!(faults.is_empty(), "{folders:?}:\n{}", faults.join("\n"));
    }
}

/// The sources of a folder and of those in it. `main.rs` is left out: it is a crate of its own, so nothing
/// can read it.
fn read_folder(folder: &Path, path: &str, modules: &mut Modules) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let file = entry.expect("an entry").path();
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let below = format!("{path}::{name}");
        if file.is_dir() {
            read_folder(&file, &below, modules);
        } else if file.extension().is_some_and(|it| it == "rs") && name != "main" {
            let front_page = matches!(name.as_str(), "lib" | "mod");
            let path = if front_page { path.to_owned() } else { below };
            modules.insert(path, fs::read_to_string(&file).expect("a source"));
        }
    }
}

/// Which modules each module reads.
fn reads(modules: &Modules) -> Reads<'_> {
    let of = |(module, source): (&'_ String, &String)| {
        let mut read: BTreeSet<_> =
            paths(module, source).iter().filter_map(|path| resolve(path, modules)).collect();
        read.remove(module);
        read
    };
    modules.iter().map(|entry| (entry.0.as_str(), of(entry))).collect()
}

/// The paths in a source that may lead to a module of the crate, from the crate's root.
fn paths(module: &str, source: &str) -> Vec<String> {
    let parent = module.rsplit_once("::").map_or(module, |(parent, _)| parent);
    let mut above = parent;
    let mut found = Vec::new();
    let code = source.lines().map(|line| line.split("//").next().unwrap_or_default());
    let code: String = code.flat_map(|line| [line.trim(), " "]).collect();
    let is_part = |it: char| it == '_' || it == ':' || it.is_alphanumeric();
    let mut rest = code.as_str();
    while let Some(start) = rest.find(is_part) {
        let end = rest[start..].find(|it| !is_part(it)).map_or(rest.len(), |it| start + it);
        let (path, after) = (&rest[start..end], &rest[end..]);
        if path == "mod"
            && after.split([';', '{']).next().is_some_and(|it| after[it.len()..].starts_with('{'))
        {
            above = module;
        }
        let members = path.ends_with("::").then(|| after.strip_prefix('{')?.split('}').next());
        for member in members.flatten().unwrap_or_default().split(',') {
            let path = format!("{path}{}", member.trim());
            let Some((first, below)) = path.split_once("::") else { continue };
            found.push(match first {
                "crate" => path,
                "super" => format!("{above}::{below}"),
                "self" => format!("{module}::{below}"),
                _ => format!("{module}::{path}"),
            });
        }
        rest = after;
    }
    found
}

/// The module that a path leads to: the longest part of it that is a module's file, as what follows is an item of it.
/// `None` for what is not of this crate.
fn resolve(path: &str, modules: &Modules) -> Option<String> {
    let mut path = path;
    while !modules.contains_key(path) {
        path = path.rsplit_once("::")?.0;
    }
    Some(path.to_owned())
}

/// What is wrong with a crate, a line each: readings from above, and modules that read each other in a circle.
fn faults(reads: &Reads, storeys: Storeys) -> Vec<String> {
    // The folder that a module lies in, under the root.
    let folder = |module: &str| module.split("::").nth(1).map(str::to_owned);
    let storey = |module: &str| match folder(module) {
        Some(folder) => storeys.iter().position(|it| it.contains(&folder.as_str())),
        None => Some(storeys.len()),
    };
    let (mut faults, mut left) = (Vec::new(), reads.clone());
    for (reader, read) in &mut left {
        let Some(own) = storey(reader) else {
            faults.push(format!("{reader} is in no storey: the table at the head of this test"));
            continue;
        };
        read.retain(|it| {
            let is_right = folder(it) == folder(reader) || storey(it).is_none_or(|its| its < own);
            if !is_right {
                faults.push(format!("{reader} reads {it}, which is not below it"));
            }
            is_right
        });
    }
    // Modules that read none of those left, or that none of these reads, are taken away: circles are left.
    let is_end = |left: &Reads, name: &str| {
        let reads = left[name].iter().any(|it| left.contains_key(it.as_str()));
        !reads || !left.values().any(|read| read.contains(name))
    };
    while let Some(end) = left.keys().copied().find(|name| is_end(&left, name)) {
        left.remove(end);
    }
    if !left.is_empty() {
        faults.push(format!("a circle among {:?}", left.into_keys().collect::<Vec<_>>()));
    }
    faults
}

#[test]
fn a_reading_upwards_or_in_a_circle_is_named() {
    let storeys: Storeys = &[&["ground"], &["left", "right"], &["roof"]];
    let right = [
        ("crate", "pub mod ground; pub mod roof; pub use crate::roof::tile::Tile;"),
        ("crate::ground", "pub mod stone; pub use stone::Stone; // crate::roof"),
        ("crate::ground::stone", "/// Beside [`crate::roof::beam`]\npub struct Stone;"),
        ("crate::left", "use std::fmt;"),
        ("crate::right", ""),
        ("crate::roof", "pub mod beam; pub mod tile;"),
        ("crate::roof::beam", "use crate::ground::{Stone, stone}; use core::fmt;"),
        ("crate::roof::tile", "use super::beam::Beam; mod tests { use super::Tile; }"),
    ];
    // A module that is added or changed, and what is said of it; nothing if it is right.
    for (module, source, fault) in [
        ("left", "use crate::ground::stone::Stone;", ""),
        ("roof", "pub use tile::Tile;", ""),
        (
            "ground::stone",
            "use crate::{roof::{self}};",
            "stone reads crate::roof, which is not below it",
        ),
        (
            "ground::stone",
            "fn f(it: &crate::roof::tile::Tile) {}",
            "stone reads crate::roof::tile,",
        ),
        ("ground::stone", "mod tests {\nuse crate::roof::Roof; }", "stone reads crate::roof,"),
        ("left", "use crate::right::Side;", "crate::left reads crate::right, which is not"),
        ("left", "use super::right::Side;", "crate::left reads crate::right, which is not"),
        ("right", "fn f() { let _ = crate::Everything; }", "crate::right reads crate, which"),
        ("cellar", "", "crate::cellar is in no storey: the table at the head of this test"),
        ("roof::beam", "use super::tile::Tile;", "[\"crate::roof::beam\", \"crate::roof::tile\"]"),
        (
            "ground::stone",
            "use crate::ground::Wall;",
            "[\"crate::ground\", \"crate::ground::stone\"]",
        ),
    ] {
        let owned = |(module, source): (&str, &str)| (module.to_owned(), source.to_owned());
        let mut modules: Modules = right.into_iter().map(owned).collect();
        modules.insert(format!("crate::{module}"), source.to_owned());
        let faults = faults(&reads(&modules), storeys).join("\n");
        let is_right = faults.contains(fault) && faults.is_empty() == fault.is_empty();
        assert!(is_right && !faults.contains('\n'), "{module}: {source}: {faults:?}");
    }
}

#[test]
fn each_type_name_of_the_core_is_defined_once() {
    let mut modules = Modules::new();
    let root = tests::build::root().join("planner-core/src");
    read_folder(&root, "crate", &mut modules);
    let found: usize = modules.values().map(|source| type_names(source).count()).sum();
    assert!(found > 300, "{found} type names are too few");
    assert_eq!(defined_twice(&modules), Vec::<String>::new());
    for (source, is_right) in [
        ("struct Stone;", false),
        ("mod tests {\n    pub(crate) enum Stone<'a> {", false),
        ("pub trait Stone: Copy {", false),
        ("type Stone = u8;", false),
        ("impl Rock for Wall {\n    type Stone = u8;", true),
        ("// struct Stone;\nlet struct_Stone = Stone;", true),
    ] {
        let of = [("crate::ground", "pub struct Stone;"), ("crate::left", source)];
        let modules = of.map(|(module, source)| (module.to_owned(), source.to_owned())).into();
        assert_eq!(defined_twice(&modules).is_empty(), is_right, "{source}");
    }
}

/// The types and traits that a source defines. Associated types, which are indented, are none.
fn type_names(source: &str) -> impl Iterator<Item = &str> {
    source.lines().filter_map(|line| {
        let mut words = line.split(|it: char| it != '_' && !it.is_alphanumeric());
        let visibility = ["", "pub", "crate", "super", "in"];
        let kind = words.find(|it| !visibility.contains(it))?;
        let defines = ["struct", "enum", "union", "trait"].contains(&kind)
            || kind == "type" && !line.starts_with(' ');
        words.next().filter(|_| defines && !line.trim_start().starts_with("//"))
    })
}

/// The type names that more than one module defines, or one module twice: a line each.
fn defined_twice(modules: &Modules) -> Vec<String> {
    let mut defined = BTreeMap::<_, Vec<_>>::new();
    for (module, source) in modules {
        type_names(source).for_each(|name| defined.entry(name).or_default().push(module.as_str()));
    }
    defined.retain(|_, by| by.len() > 1);
    defined.into_iter().map(|(name, by)| format!("{name}: {}", by.join(", "))).collect()
}
