//! A reliability that nobody knows, and one that differs from what planners are told.

use std::fs;

use serde_json::Value;

use crate::{folder, host_sim, prints, refuses, text};

const NOISY: &str = include_str!("../../scenarios/paper-noisy.toml");

/// The noise of the paper's example.
const GOOD: &str = "p = 0.7, trusted_radius = 0.5";

fn scenario(noise: &str) -> String {
    NOISY.replace(GOOD, noise)
}

#[test]
fn bad_priors_are_refused() {
    let folder = folder();
    let cases: [(&str, &[&str]); 9] = [
        ("p = [2.0, 8.0]", &["noise.p", "found [2, 8]", "a > b"]),
        ("p = [5.0, 5.0]", &["noise.p", "found [5, 5]", "a > b"]),
        ("p = [0.2, 0.1]", &["noise.p", "found [0.2, 0.1]", "from 0.5 to 1000"]),
        ("p = [nan, 0.1]", &["noise.p", "found [NaN, 0.1]", "from 0.5 to 1000"]),
        ("p = [8.0]", &["bad.toml:10", "a probability, or the [a, b] of a Beta prior"]),
        ("p = \"often\"", &["bad.toml:10", "a probability, or the [a, b] of a Beta prior"]),
        ("p = 0.8, true_p = 1.5", &["noise.true_p", "found 1.5", "[0, 1]"]),
        (
            "p = [8.0, 2.0] }\nerrors = { position = 0.02",
            &["noise.p", "a prior, and a tolerance of 0.060 m", "a number where positions err"],
        ),
        ("true_p = 0.8", &["bad.toml:10", "missing field `p`"]),
    ];
    for (bad, parts) in cases {
        fs::write(folder.path().join("bad.toml"), scenario(bad)).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    fs::write(folder.path().join("bad.toml"), scenario("p = [8.0, 2.0]")).expect("a file");
    let as_cfc = ["run", "bad.toml", "--algorithm", "cfc"];
    refuses(folder.path(), &as_cfc, &["noise.p", "algorithm cfc", "scc or lookahead"]);
    let on_a_board = ["hil", "bad.toml", "--port", "/dev/null"];
    refuses(folder.path(), &on_a_board, &["noise.p", "a prior", "a number with hil"]);
}

#[test]
fn a_mission_says_what_labels_have_shown() {
    let folder = folder();
    let noise = "p = [8.0, 2.0], true_p = 0.95, trusted_radius = 0.5";
    fs::write(folder.path().join("m.toml"), scenario(noise)).expect("a file");
    for algorithm in ["scc", "lookahead", "margin", "random", "lawnmower"] {
        let run =
            ["run", "m.toml", "--steps", "40", "--algorithm", algorithm, "--trace", "m.jsonl"];
        let output = host_sim(folder.path(), &run);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let told = text(&output.stdout);
        assert!(told.contains("its prior is Beta(8, 2), with the mean 0.800."), "{told}");
        assert!(told.contains("Labels are true with a probability of 0."), "{told}");
        let trace = fs::read_to_string(folder.path().join("m.jsonl")).expect("a trace");
        let record = |name: &str| {
            let records = trace.lines().map(|it| serde_json::from_str::<Value>(it).expect("JSON"));
            records.into_iter().find(|it| it["record"] == name).expect("a record")
        };
        let (start, end) = (record("start"), record("end"));
        assert_eq!((&start["p"], &start["p_told"]), (&0.95.into(), &serde_json::json!([8.0, 2.0])));
        let number = |key: &str| end["reliability"][key].as_f64().expect("a number");
        // 40 labels of which 95 % are true say more than the prior.
        assert!((0.75..1.0).contains(&number("mean")), "{algorithm}: {}", number("mean"));
        assert!((0.01..0.12).contains(&number("deviation")), "{}", number("deviation"));
    }
    assert!(
        prints(folder.path(), &["run", "m.toml", "--report", "m.html"])
            .contains("its prior is Beta(8, 2)")
    );
    let page = fs::read_to_string(folder.path().join("m.html")).expect("a page");
    assert!(page.contains("as they show themselves"));
}

/// A number for `p` is as before, with or without an equal `true_p`.
#[test]
fn a_number_is_told_as_before() {
    let folder = folder();
    let run = |noise: &str| {
        fs::write(folder.path().join("m.toml"), scenario(noise)).expect("a file");
        let output = host_sim(folder.path(), &["run", "m.toml", "--format", "json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let plain = run("p = 0.75");
    assert_eq!(run("p = 0.75, true_p = 0.75"), plain);
    assert!(!plain.contains("reliability") && !plain.contains("p_told"));
    // The sensor is another one than the planner is told.
    let other = run("p = 0.75, true_p = 0.55");
    assert!(other.contains("\"p\":0.55,\"p_told\":0.75"), "{other}");
    assert_ne!(other.replace("\"p\":0.55,\"p_told\":0.75", "\"p\":0.75"), plain);
}

#[test]
fn a_campaign_draws_what_nobody_knows() {
    let folder = folder();
    let common = ["campaign", "--algorithm", "lookahead", "--fields", "6", "--steps", "12"];
    let with = |more: &[&'static str]| [&common[..], more].concat();
    assert!(
        prints(folder.path(), &with(&["--p-prior", "8,2"]))
            .contains("p drawn from Beta(8, 2), told so")
    );
    let fixed = with(&["--p-prior", "8,2", "--true-p", "0.6"]);
    assert!(prints(folder.path(), &fixed).contains("p = 0.6, told Beta(8, 2)"));
    assert!(
        prints(folder.path(), &with(&["--p", "0.8", "--true-p", "0.6"]))
            .contains("p = 0.6, told 0.8")
    );
    let compared = ["campaign", "--compare", "scc,lookahead", "--fields", "3", "--p-prior", "8,2"];
    assert!(prints(folder.path(), &compared).contains("p drawn from Beta(8, 2), told so"));
    let cases: [(&[&str], &[&str]); 7] = [
        (&["--p-prior", "8"], &["--p-prior", "found 8", "such as 8,2"]),
        (&["--p-prior", "8,2,1"], &["--p-prior", "found 8,2,1", "such as 8,2"]),
        (&["--p-prior", "a,b"], &["--p-prior", "found a,b", "such as 8,2"]),
        (&["--p-prior", "2,8"], &["--p-prior", "found [2, 8]", "a > b"]),
        (&["--p-prior", "8,2", "--p", "0.8"], &["--p-prior", "cannot be used with", "--p"]),
        (&["--true-p", "0.8"], &["--true-p", "found 0.8", "--p-prior"]),
        (&["--p-prior", "8,2", "--tolerance", "0.1"], &["--p-prior", "tolerance of 0.100 m"]),
    ];
    for (flags, parts) in cases {
        let args: Vec<_> = common.iter().chain(flags).copied().collect();
        refuses(folder.path(), &args, parts);
    }
    let as_cfc = ["campaign", "--algorithm", "cfc", "--p-prior", "8,2"];
    refuses(folder.path(), &as_cfc, &["cfc", "which takes labels to be true"]);
}
