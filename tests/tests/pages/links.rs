//! Links between the pages of the repository: each leads to a file that is there, and to a heading of it.

use std::fs;
use std::path::{Path, PathBuf};

/// Folders of pages that are not of this repository, or are built.
const OTHERS: [&str; 4] = ["target", "node_modules", "out", ".git"];

/// All pages in a folder and below it.
fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let is_other = OTHERS.iter().any(|it| path.ends_with(it));
        if path.is_dir() && !path.is_symlink() && !is_other {
            pages(&path, found);
        } else if path.extension().is_some_and(|it| it == "md") {
            found.push(path);
        }
    }
}

/// The lines of a page that are no code.
fn prose(page: &str) -> impl Iterator<Item = &str> {
    page.split("```").step_by(2).flat_map(str::lines)
}

/// The places of a page that a link can name: its headings, as GitHub makes names of them.
fn headings(page: &str) -> Vec<String> {
    let name = |line: &str| {
        let heading = line.trim_start_matches('#').trim().to_lowercase();
        let kept = heading.chars().filter(|it| it.is_alphanumeric() || "-_ ".contains(*it));
        kept.map(|it| if it == ' ' { '-' } else { it }).collect()
    };
    prose(page).filter(|line| line.starts_with('#')).map(name).collect()
}

/// What is wrong with a page's links, a line each.
fn faults(path: &Path, page: &str) -> Vec<String> {
    let text: String = prose(page).flat_map(|line| [line, "\n"]).collect();
    let links = text.split("](").skip(1).filter_map(|it| Some(it.split_once(')')?.0.to_owned()));
    let is_here = |it: &String| !it.contains("://") && !it.contains([' ', '`', '\n']);
    let fault = |link: String| {
        let (file, heading) = link.split_once('#').unwrap_or((&link, ""));
        let target = path.with_file_name(file);
        let has = |page: &str| headings(page).iter().any(|it| it == heading);
        let is_there = match (file, heading) {
            ("", _) => has(page),
            (_, "") => target.exists(),
            _ => fs::read_to_string(&target).is_ok_and(|page| has(&page)),
        };
        (!is_there).then(|| format!("{}: {link} leads nowhere", path.display()))
    };
    links.filter(is_here).filter_map(fault).collect()
}

#[test]
fn each_leads_somewhere() {
    let mut found = Vec::new();
    pages(&tests::build::root(), &mut found);
    assert!(found.len() > 50, "{} pages are too few", found.len());
    let read = |path: &PathBuf| fs::read_to_string(path).expect("a page");
    let faults: Vec<_> = found.iter().flat_map(|path| faults(path, &read(path))).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn one_that_leads_nowhere_is_named() {
    let path = tests::build::root().join("README.md");
    let page = "# A page, of `two`\n[a](LICENSE-MIT) [b](#a-page-of-two) [c](LICENSE-GPL)\n```\n[d](none)\n```\n[e](#none)";
    let found = faults(&path, page);
    assert!(found.len() == 2 && found[0].contains("LICENSE-GPL"), "{found:?}");
}
