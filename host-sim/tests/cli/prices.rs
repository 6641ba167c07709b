//! Labels with a price, and a limit of their number: `price`, `labels` and `ask` of scenarios and their flags.

use std::fs;

use serde_json::Value;

use crate::{folder, prints, refuses};

/// A lake of 800 m x 500 m, and a robot whose motions are 5 m long, with these settings.
fn lake(algorithm: &str, settings: &str) -> String {
    format!(
        r#"algorithm = "{algorithm}"
steps = 300
area = {{ x = [0.0, 800.0], z = [0.0, 500.0] }}
vehicle = {{ kind = "unicycle", reach = 5.0 }}
truth = {{ slope = 0.31, intercept = 120.0 }}
oracle = [
  {{ x = 300.0, z = 150.0, label = -1 }},
  {{ x = 300.0, z = 330.0, label = 1 }},
  {{ x = 500.0, z = 400.0, label = 1 }},
  {{ x = 520.0, z = 180.0, label = -1 }},
]
{settings}
"#
    )
}

/// Without a price there is the usual one in so large an area. Results and trace say it, and why the mission ended.
#[test]
fn a_large_area_gives_labels_a_price() {
    let folder = folder();
    for (settings, price) in [("labels = 12", 81.25), ("labels = 12\nprice = 20.0", 20.0)] {
        fs::write(folder.path().join("m.toml"), lake("lookahead", settings)).expect("a file");
        let told = prints(folder.path(), &["run", "m.toml", "--trace", "t.jsonl"]);
        for said in [
            format!("A label costs as much as {price} m of driving."),
            "Ended: all labels are read. 12 samples in ".to_owned(),
        ] {
            assert!(told.contains(&said), "{said}: {told}");
        }
        let trace = fs::read_to_string(folder.path().join("t.jsonl")).expect("a trace");
        let record = |line: Option<&str>| -> Value {
            serde_json::from_str(line.expect("a record")).expect("JSON")
        };
        let (start, end) = (record(trace.lines().next()), record(trace.lines().last()));
        assert_eq!((&start["price"], &start["labels"]), (&price.into(), &12.into()));
        assert_eq!(end["reason"], "labels");
    }
}

/// So it did before there were prices, and boards without far sight still do.
#[test]
fn without_a_price_it_looks_one_motion_far() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), lake("lookahead", "labels = 12\nprice = \"none\""))
        .expect("a file");
    let told = prints(folder.path(), &["run", "m.toml"]);
    assert!(told.contains("12 samples in 12 steps") && !told.contains("costs"), "{told}");
    let lakes = ["--area", "800,500", "--reach", "5", "--labels", "4", "--fields", "2"];
    let flags = ["campaign", "--algorithm", "lookahead", "--price", "none"];
    let told = prints(folder.path(), &[&flags[..], &lakes].concat());
    assert!(told.contains("Ended by: labels 2") && told.contains("in 8 steps"), "{told}");
}

/// Where no label carries what is asked, results and trace say so, and what to change.
#[test]
fn a_mission_ends_where_no_label_is_worth_it() {
    let folder = folder();
    let settings = "labels = 40\nask = { worth = 0.53 }\nnoise = { p = 0.9 }";
    fs::write(folder.path().join("m.toml"), lake("lookahead", settings)).expect("a file");
    let told = prints(folder.path(), &["run", "m.toml", "--trace", "t.jsonl"]);
    for said in [
        "A label is read where it is expected to carry 0.53 bits or more.",
        "Ended: no label in sight was expected to carry the bits asked for.",
        "To go on, ask for fewer bits a label: ask.worth (or --worth).",
    ] {
        assert!(told.contains(said), "{said}: {told}");
    }
    let trace = fs::read_to_string(folder.path().join("t.jsonl")).expect("a trace");
    assert!(trace.contains("\"worth\":0.53") && trace.contains("\"reason\":\"worth\""), "{trace}");
}

#[test]
fn bad_prices_are_refused() {
    let folder = folder();
    let noise = "noise = { p = 0.9 }";
    for (algorithm, settings, parts) in [
        ("lookahead", "price = -1.0", &["m.toml: price:", "found -1", "0 to 16384"][..]),
        ("lookahead", "price = 20000.0", &["m.toml: price:", "0 to 16384"]),
        ("lookahead", "price = \"low\"", &["m.toml:12:", "metres driven"]),
        ("cfc", "price = 5.0", &["m.toml: price:", "with algorithm cfc", "lookahead"]),
        ("lookahead", "labels = 0", &["m.toml: labels:", "found 0", "1 to 10000"]),
        ("lookahead", &format!("labels = 65\n{noise}"), &["m.toml: labels:", "1 to 64"]),
        ("cfc", "ask = { seek = \"bits\" }", &["m.toml: ask.seek:", "lookahead"]),
        ("lookahead", "ask = { seek = \"gold\" }", &["m.toml:12:", "accuracy"]),
        ("cfc", "ask = { worth = 0.1 }", &["m.toml: ask.worth:", "lookahead"]),
        ("lookahead", "ask = { worth = 1.1 }", &["m.toml: ask.worth:", "found 1.1", "0 to 1.000"]),
        ("lookahead", &format!("ask.worth = 0.6\n{noise}"), &["m.toml: ask.worth:", "0 to 0.531"]),
        ("lookahead", "ask = { sek = \"bits\" }", &["m.toml:12:", "sek"]),
    ] {
        fs::write(folder.path().join("m.toml"), lake(algorithm, settings)).expect("a file");
        refuses(folder.path(), &["run", "m.toml"], parts);
    }
    let seek =
        lake("lookahead", "ask = { seek = \"bits\" }").replace("reach = 5.0", "reach = 90.0");
    fs::write(folder.path().join("m.toml"), seek).expect("a file");
    refuses(folder.path(), &["run", "m.toml"], &["m.toml: ask.seek:", "with a price"]);
    for (flags, parts) in [
        (&["--price", "5"][..], &["--price:", "with algorithm cfc"][..]),
        (&["--algorithm", "lookahead", "--price", "low"], &["--price", "metres driven, or none"]),
        (&["--area", "5"], &["--area:", "two sides"]),
        (&["--area", "0,9"], &["--area:", "from 1 to 8000"]),
        (&["--algorithm", "lookahead", "--p", "0.9", "--worth", "0.6"], &["--worth:", "0.531"]),
        (&["--algorithm", "lookahead", "--labels", "0"], &["--labels:", "1 to"]),
    ] {
        refuses(folder.path(), &[&["campaign", "--fields", "1"], flags].concat(), parts);
    }
}

/// In a build of the whole workspace `serde_json` keeps all digits, which untagged enums cannot read.
#[test]
fn the_record_of_a_shard_has_its_price() {
    let folder = folder();
    for price in ["4", "none"] {
        for shard in ["1/2", "2/2"] {
            let csv = format!("{}.csv", &shard[..1]);
            let args = "campaign --fields 2 --steps 3 --algorithm lookahead --quiet --price";
            let args: Vec<_> =
                args.split(' ').chain([price, "--shard", shard, "--csv", &csv]).collect();
            prints(folder.path(), &args);
        }
        prints(folder.path(), &["campaign", "merge", "1.csv", "2.csv", "--quiet"]);
    }
}
