//! Figures: the legend names all that is drawn and nothing else, nothing lies outside, and no two numbers overlap.

use std::collections::BTreeSet;
use std::fs;

use roxmltree::{Document, Node};

use crate::{GOOD, folder, prints};

const NOISY: &str = include_str!("../../scenarios/paper-noisy.toml");
const CAR: &str = include_str!("../../scenarios/car-among-keep-outs.toml");

/// What stands beside the marks, or within them: axes, words, what a line of words explains. White is what is left,
/// and as such not drawn.
const UNNAMED: [&str; 6] = ["figure", "words", "border", "spread", "legend", "ground-blank"];

fn number(node: Node, name: &str) -> Option<f64> {
    node.attribute(name).map(|it| it.parse().expect("a number"))
}

/// Checks a figure. Returns the numbers of the steps that it has, and the classes in its legend.
fn check(name: &str, svg: &str) -> (BTreeSet<usize>, BTreeSet<String>) {
    let document = Document::parse(svg).expect("XML");
    let is_legend = |it: &Node| it.attribute("class") == Some("legend");
    let (named, drawn): (Vec<_>, Vec<_>) =
        document.descendants().partition(|it| it.ancestors().any(|it| is_legend(&it)));
    let classes = |nodes: &[Node]| -> BTreeSet<String> {
        let found = nodes.iter().filter_map(|it| it.attribute("class"));
        found.filter(|it| !UNNAMED.contains(it)).map(str::to_owned).collect()
    };
    let legend = classes(&named);
    assert!(!legend.is_empty(), "{name}");
    assert_eq!(classes(&drawn), legend, "{name}: drawn, and named");

    let [wide, high] =
        ["width", "height"].map(|it| number(document.root_element(), it).expect("a size"));
    let inside = |x: f64, y: f64| {
        assert!((0.0..=wide).contains(&x) && (0.0..=high).contains(&y), "{name}: ({x}, {y})");
    };
    let is_in_pattern = |it: &Node| it.ancestors().any(|it| it.has_tag_name("defs"));
    for node in document.descendants().filter(|it| !is_in_pattern(it)) {
        for [x, y] in [["x", "y"], ["cx", "cy"]] {
            if let (Some(x), Some(y)) = (number(node, x), number(node, y)) {
                inside(x, y);
            }
        }
        let path = node.attribute("d").unwrap_or_default();
        let path: Vec<f64> = path
            .split(|it: char| it.is_ascii_uppercase() || it == ',' || it == ' ')
            .filter_map(|it| it.parse().ok())
            .collect();
        path.chunks(2).for_each(|at| inside(at[0], at[1]));
    }

    let is_number =
        |it: &&Node| it.parent().is_some_and(|it| it.attribute("class") == Some("number"));
    let labels = drawn.iter().filter(|it| it.has_tag_name("text")).filter(is_number).map(|it| {
        let [x, y] = ["x", "y"].map(|name| number(*it, name).expect("a place"));
        (x, y, it.text().expect("a number").trim())
    });
    let labels: Vec<_> = labels.collect();
    for (k, (x, y, word)) in labels.iter().enumerate() {
        for (other_x, other_y, other) in &labels[..k] {
            let wide = 0.56 * 11.0 * (word.len() + other.len()) as f64 / 2.0;
            let apart = (x - other_x).abs() >= wide || (y - other_y).abs() >= 9.0;
            assert!(apart, "{name}: {word} at ({x}, {y}), {other} at ({other_x}, {other_y})");
        }
    }
    (labels.iter().map(|(.., word)| word.parse().expect("a number")).collect(), legend)
}

#[test]
fn all_that_is_drawn_is_named_and_the_reverse() {
    let folder = folder();
    for (name, scenario, steps, planner) in [
        ("few", GOOD, "3", "cfc"),
        ("one", GOOD, "1", "cfc"),
        ("many", GOOD, "60", "lookahead"),
        ("walk", GOOD, "60", "random"),
        ("noisy", NOISY, "10", "scc"),
        ("long", NOISY, "60", "scc"),
        ("car", CAR, "20", "lookahead"),
    ] {
        fs::write(folder.path().join("m.toml"), scenario.replace("varrho = 0.1\n", ""))
            .expect("a file");
        let args = ["run", "m.toml", "--steps", steps, "--algorithm", planner, "--figure", "f.svg"];
        let flown = prints(folder.path(), &[&args[..], &["--format", "flat"]].concat());
        let steps = flown.lines().count();
        let svg = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
        let (shown, _) = check(name, &svg);
        let mut kept = (1..=steps).filter(|it| *it == 1 || *it == steps || it.is_multiple_of(5));
        assert!(kept.all(|it| shown.contains(&it)), "{name}: {shown:?} of {steps}");
        let missing = steps - shown.len();
        assert_eq!(svg.contains("left out"), missing > 0, "{name}");
        let said = format!("left out where too tight: {missing}");
        assert!(missing == 0 || svg.contains(&said), "{name}: {said}");
    }
}

#[test]
fn figures_of_the_paper_and_of_campaigns_are_named_too() {
    let folder = folder();
    for name in prints(folder.path(), &["figure", "all"]).lines() {
        check(name, &fs::read_to_string(folder.path().join(name)).expect("a figure"));
    }
    for (planners, curves) in [("cfc", 1), ("cfc,margin,random", 3), ("scc,lookahead", 2)] {
        let args = [
            "campaign",
            "--fields",
            "6",
            "--steps",
            "8",
            "--figure",
            "f.svg",
            "--compare",
            planners,
        ];
        prints(folder.path(), &args);
        let svg = fs::read_to_string(folder.path().join("f.svg")).expect("a figure");
        let (_, legend) = check(planners, &svg);
        assert_eq!(
            legend.iter().filter(|it| it.starts_with("curve")).count(),
            curves,
            "{planners}"
        );
    }
}
