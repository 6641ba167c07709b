//! Figures: everything drawn is named in the legend and everything named is drawn, nothing lies outside, and no two
//! numbers overlap.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::{GOOD, folder, prints, refuses};

const NOISY: &str = include_str!("../../scenarios/paper-noisy.toml");
const CAR: &str = include_str!("../../scenarios/car-among-keep-outs.toml");

/// What stands beside the marks, or within them: axes, words, what a line of words explains.
const UNNAMED: [&str; 5] = ["figure", "words", "border", "spread", "legend"];

/// The figure and its legend.
fn parts(svg: &str) -> [&str; 2] {
    let (_, drawn) = svg.split_once("class=\"figure\"").expect("a figure");
    let (drawn, legend) = drawn.split_once("class=\"legend\"").expect("a legend");
    [drawn, legend]
}

fn attributes<'a>(part: &'a str, name: &str) -> impl Iterator<Item = &'a str> {
    let begin = format!(" {name}=\"");
    part.split(&begin).skip(1).collect::<Vec<_>>().into_iter().filter_map(|it| it.split('"').next())
}

fn numbers(text: &str) -> Vec<f64> {
    let is_mark = |c: char| !(c.is_ascii_digit() || c == '.' || c == '-' || c == 'e');
    text.split(is_mark).filter_map(|word| word.parse().ok()).collect()
}

/// What every figure holds to; the numbers of steps that it has.
fn check(name: &str, svg: &str) -> BTreeSet<u32> {
    let marks = |part| {
        let found: BTreeSet<_> = attributes(part, "class").collect();
        found.into_iter().filter(|it| !UNNAMED.contains(it)).collect::<BTreeSet<_>>()
    };
    let [drawn, legend] = parts(svg);
    let mut named = marks(legend);
    // White is what is left, and as such not drawn.
    named.remove("ground-blank");
    assert!(!named.is_empty(), "{name}");
    assert_eq!(marks(drawn), named, "{name}: drawn, and named");
    let size = numbers(attributes(svg, "viewBox").next().expect("a size"));
    let (wide, high) = (size[2], size[3]);
    let inside = |x: f64, y: f64| {
        assert!((0.0..=wide).contains(&x) && (0.0..=high).contains(&y), "{name}: ({x}, {y})");
    };
    for part in [drawn, legend] {
        for path in attributes(part, "d") {
            numbers(path).chunks(2).for_each(|at| inside(at[0], at[1]));
        }
        for [x, y] in [["cx", "cy"], ["x", "y"]] {
            for (x, y) in attributes(part, x).zip(attributes(part, y)) {
                inside(x.parse().expect("a number"), y.parse().expect("a number"));
            }
        }
    }
    let labels: Vec<_> = drawn.split("class=\"number\"").skip(1).filter_map(step_number).collect();
    for (k, (x, y, word)) in labels.iter().enumerate() {
        for (other_x, other_y, other) in &labels[..k] {
            let wide = 0.56 * 11.0 * (word.len() + other.len()) as f64 / 2.0;
            let apart = (x - other_x).abs() >= wide || (y - other_y).abs() >= 9.0;
            assert!(apart, "{name}: {word} at ({x}, {y}), {other} at ({other_x}, {other_y})");
        }
    }
    labels.iter().map(|(_, _, word)| word.parse().expect("a number")).collect()
}

/// Where the number stands that a group begins with, and the number.
fn step_number(group: &str) -> Option<(f64, f64, &str)> {
    let (group, _) = group.split_once("</g>")?;
    let (_, text) = group.split_once("<text")?;
    let of = |name| attributes(text, name).next()?.parse().ok();
    let (_, word) = text.split_once('>')?;
    Some((of("x")?, of("y")?, word.split('<').next()?.trim()))
}

#[test]
fn all_that_is_drawn_is_named_and_the_reverse() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    for (name, scenario, steps, planner) in [
        ("few", GOOD, "3", "cfc"),
        ("one", GOOD, "1", "cfc"),
        ("many", GOOD, "60", "lookahead"),
        ("walk", GOOD, "64", "random"),
        ("noisy", NOISY, "10", "scc"),
        ("long", NOISY, "60", "scc"),
        ("car", CAR, "20", "lookahead"),
    ] {
        let scenario = scenario.replace("varrho = 0.1\n", "");
        fs::write(path("m.toml"), scenario).expect("a file");
        let args = ["run", "m.toml", "--steps", steps, "--algorithm", planner, "--figure", "f.svg"];
        prints(folder.path(), &args);
        let svg = fs::read_to_string(path("f.svg")).expect("a figure");
        let shown = check(name, &svg);
        let ended = prints(folder.path(), &[&args[..6], &["--format", "json"]].concat());
        let steps = ended.matches("\"record\":\"step\"").count() as u32;
        let kept = |step: &u32| *step == 1 || *step == steps || step.is_multiple_of(5);
        assert!(
            (1..=steps).filter(kept).all(|step| shown.contains(&step)),
            "{name}: {shown:?} of {steps}"
        );
        let missing = steps as usize - shown.len();
        let said = format!("left out where too tight: {missing}");
        assert_eq!(svg.contains("left out"), missing > 0, "{name}");
        assert!(missing == 0 || svg.contains(&said), "{name}: {said}");
    }
}

#[test]
fn the_paper_s_figures() {
    let folder = folder();
    let names: Vec<_> = (1..=8).map(|n| format!("new/out/paper-figure-{n}.svg")).collect();
    let told = prints(folder.path(), &["figure", "all", "--out", "new/out"]);
    assert_eq!(told.lines().collect::<Vec<_>>(), names);
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).expect("a figure");
    for (name, number) in names.iter().zip(1..) {
        let svg = read(name);
        check(name, &svg);
        assert!(
            svg.contains(&format!("After Figure {number} of Raghavan and Johansson")),
            "{name}"
        );
        // In out/ unless one says, and the same again.
        let told = prints(folder.path(), &["figure", &number.to_string()]);
        assert_eq!(told, format!("out/paper-figure-{number}.svg\n"));
        assert_eq!(read(told.trim_end()), svg, "{name}");
    }
    // What the text says of them: six labels, three of each; 27, of which seven are wrong; four lines.
    let count = |name: &str, class: &str| {
        parts(&read(name))[0].matches(&format!("class=\"{class}\"")).count()
    };
    for label in ["read-positive", "read-negative"] {
        assert_eq!(count(&names[0], label), 3, "{label}");
    }
    for name in [&names[1], &names[4]] {
        assert_eq!(count(name, "read-positive") + count(name, "read-negative"), 27, "{name}");
        assert_eq!(count(name, "wrong"), 7, "{name}");
    }
    for name in [&names[2], &names[3]] {
        assert_eq!(count(name, "bound"), 4, "{name}");
        assert_eq!(count(name, "given-positive") + count(name, "given-negative"), 4, "{name}");
    }
}

#[test]
fn curves_of_campaigns() {
    let folder = folder();
    for (name, args, planners) in [
        ("one", &["--steps", "5"][..], 1),
        ("several", &["--steps", "8", "--compare", "cfc,margin,random"], 3),
        ("doubtful", &["--steps", "6", "--compare", "scc,lookahead"], 2),
    ] {
        let args = [&["campaign", "--fields", "6", "--figure", "f.svg"], args].concat();
        prints(folder.path(), &args);
        let svg = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
        check(name, &svg);
        let [_, legend] = parts(&svg);
        let curves: BTreeSet<_> =
            attributes(legend, "class").filter(|it| it.starts_with("curve")).collect();
        assert_eq!(curves.len(), planners, "{name}");
    }
}

#[test]
fn wrong_figures_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("file"), "").expect("a file");
    for (args, parts) in [
        (&["figure", "9"][..], &["'9'", "expected 1 to 8, or all"][..]),
        (&["figure", "0"], &["'0'", "expected 1 to 8, or all"]),
        (&["figure", "x"], &["'x'", "expected 1 to 8, or all"]),
        (&["figure", "-1"], &["-1"]),
        (&["figure"], &["N|all"]),
        (&["figure", "1", "--out", "file"], &["--out: file", "folder"]),
        (&["figure", "all", "--out", "file/below"], &["--out: file/below", "folder"]),
        (&["campaign", "--figure", "nowhere/f.svg"], &["nowhere/f.svg"]),
        (&["campaign", "--figure", "f.svg", "--csv", "f.svg"], &["f.svg", "--csv"]),
        (&["campaign", "--figure", "."], &["directory"]),
    ] {
        refuses(folder.path(), args, parts);
    }
    // A place that is taken by a folder is found before anything is written.
    fs::create_dir_all(folder.path().join("out/paper-figure-3.svg")).expect("a folder");
    refuses(folder.path(), &["figure", "all"], &["paper-figure-3.svg", "directory"]);
    let left: Vec<_> =
        fs::read_dir(Path::new(&folder.path().join("out"))).expect("a folder").collect();
    assert_eq!(left.len(), 1);
}
