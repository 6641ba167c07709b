//! Missions that end when enough is known, their promises, and the defaults that a file has.

use std::fs;

use serde_json::Value;

use crate::recordings::number;
use crate::{GOOD, folder, host_sim, prints, refuses, text};

const NOISY: &str = include_str!("../../scenarios/paper-noisy.toml");

/// A scenario flown by look-ahead with this `stop`, in up to 60 steps.
fn stopping(scenario: &str, stop: &str) -> String {
    let scenario = scenario.replace("\"cfc\"", "\"lookahead\"").replace("\"scc\"", "\"lookahead\"");
    let steps = format!("steps = 60\nstop = {stop}");
    scenario.replace("varrho = 0.1\n", "").replace("steps = 10", &steps).replace("0.7", "0.9")
}

/// What it prints, and the records of its trace.
fn flown(scenario: &str) -> (String, Vec<Value>) {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), scenario).expect("a file");
    let trace = prints(folder.path(), &["run", "m.toml", "--format", "json"]);
    let records = trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    (prints(folder.path(), &["run", "m.toml"]), records)
}

#[test]
fn a_mission_ends_when_enough_is_known_and_says_what_it_promises() {
    let width = |step: &Value| {
        let arcs = step["slope_arcs"].as_array().expect("arcs");
        arcs.iter().map(|arc| arc[1].as_f64().unwrap() - arc[0].as_f64().unwrap()).sum::<f64>()
    };
    let (story, records) = flown(&stopping(GOOD, "{ slope_arc_deg = 0.5, audit = false }"));
    assert!(
        story.contains("Known: any two of the lines left differ by 0.5 deg at most."),
        "{story}"
    );
    let [.., before, last, end] = &records[..] else { panic!("two steps") };
    assert_eq!(end["reason"], "known");
    assert_eq!(end["goal"], serde_json::json!({ "slope_arc_deg": 0.5, "is_met": true }));
    assert!(width(last) <= 0.5 && width(before) > 0.5, "no sooner and no later");
    // The same mission with its audit is the same so far.
    let (story, audited) = flown(&stopping(GOOD, "{ slope_arc_deg = 0.5 }"));
    let (asked, audit) = audited.split_at(records.len() - 1);
    assert_eq!(asked, &records[..records.len() - 1]);
    let [audit @ .., end] = audit else { panic!("an end") };
    assert!(audit.iter().all(|step| step["problem"] == "audit"));
    assert_eq!(audit.iter().filter(|step| step["label"].is_i64()).count(), 6);
    assert_eq!((&end["reason"], &end["goal"]["audit"]["agreed"]), (&"known".into(), &6.into()));
    assert_eq!(end["goal"]["audit"]["motions"], audit.len());
    assert!(story.contains("Audited: 6 labels on certain ground agree ("), "{story}");

    let (story, records) = flown(&stopping(GOOD, "{ misclassified = 0.001, audit = false }"));
    let promise = "Known: any two of the lines left disagree on no more than 0.1 % of the area.";
    assert!(story.contains(promise), "{story}");
    let end = &records[records.len() - 1];
    assert_eq!(end["reason"], "known");
    assert_eq!(end["goal"], serde_json::json!({ "misclassified": 0.001, "is_met": true }));
}

/// A boundary that bends ends no mission as known.
#[test]
fn a_mission_that_no_line_explains_says_so() {
    let circle = "truth = { circle = [6.0, 22.0, 16.0] }";
    let scenario = stopping(GOOD, "{ slope_arc_deg = 0.5 }");
    let scenario = scenario.lines().map(|it| if it.starts_with("truth") { circle } else { it });
    let scenario = scenario.collect::<Vec<_>>().join("\n");
    let (story, records) = flown(&scenario);
    let end = &records[records.len() - 1];
    assert_eq!((&end["reason"], &end["goal"]["is_met"]), (&"no line".into(), &false.into()));
    assert_eq!(end["goal"]["audit"]["refuted"], records.len() - 2);
    assert!(end["alarm"]["evidence"].as_f64() > Some(100.0), "{end}");
    for part in [
        "no straight, still line explains the labels",
        "Not known: ",
        "Refuted: ",
        "Alarm: ",
        "\nSeen: step ",
        "\nBest line: z = ",
        "\nExplanation: ",
        "\nTo do: ",
    ] {
        assert!(story.contains(part), "{part} in {story}");
    }
    // The label that refutes is that of the last step, and the line is one that disagrees with so many labels.
    let (diagnosis, last) = (&end["diagnosis"], &records[records.len() - 2]);
    let refuting = &diagnosis["refuting"];
    assert_eq!((&refuting["step"], &refuting["label"]), (&last["step"], &last["label"]));
    assert_eq!((&refuting["x"], &refuting["z"]), (&last["pose"]["x"], &last["pose"]["z"]));
    assert_eq!(refuting["expected"].as_i64(), refuting["label"].as_i64().map(|label| -label));
    let number = |value: &Value| value.as_f64().expect("a number");
    let [slope, intercept] = ["slope", "intercept"].map(|key| number(&diagnosis["line"][key]));
    let above = |x: &Value, z: &Value| number(z) > slope * number(x) + intercept;
    let given = records[0]["oracle"].as_array().expect("samples").iter();
    let given = given.map(|it| (above(&it["x"], &it["z"]), &it["label"]));
    let read = records[1..records.len() - 1].iter().filter(|step| step["label"].is_i64());
    let read = read.map(|it| (above(&it["pose"]["x"], &it["pose"]["z"]), &it["label"]));
    let labels: Vec<_> = given.chain(read).collect();
    // Of which side is +1 the slope says nothing.
    let wrong = labels.iter().filter(|(above, label)| *above != (**label == 1)).count();
    let wrong = wrong.min(labels.len() - wrong);
    assert_eq!(diagnosis["disagreeing"], wrong);
    assert_eq!(diagnosis["labels"], labels.len());
    let share = wrong as f64 / labels.len() as f64;
    assert!((number(&diagnosis["share"]) - share).abs() < 1e-12 && wrong > 0);
    let shares = diagnosis["shares"].as_object().expect("shares").values().map(number);
    assert!((shares.sum::<f64>() - 1.0).abs() < 0.005, "{diagnosis}");
    let folder = folder();
    fs::write(folder.path().join("m.toml"), scenario).expect("a file");
    prints(folder.path(), &["run", "m.toml", "--figure", "m.svg", "--report", "m.html"]);
    let figure = fs::read_to_string(folder.path().join("m.svg")).expect("a figure");
    assert!(figure.contains("double ring: no line left has this label here"));
    assert!(figure.contains("line that the fewest labels disagree with"));
    let page = fs::read_to_string(folder.path().join("m.html")).expect("a page");
    assert!(["Seen", "Best line", "Explanation", "To do"].iter().all(|it| page.contains(it)));
}

/// The tolerance that a result advises is one with which the mission ends otherwise.
#[test]
fn the_advice_of_a_mission_without_a_line_can_be_followed() {
    let sine = "truth = { sine = [1.0, 20.0, 0.0], slope = 0.41, intercept = 3.5 }";
    let scenario = stopping(GOOD, "{ slope_arc_deg = 0.5 }");
    let scenario = scenario.lines().map(|it| if it.starts_with("truth") { sine } else { it });
    let scenario = scenario.collect::<Vec<_>>().join("\n");
    let (story, records) = flown(&scenario);
    let diagnosis = &records[records.len() - 1]["diagnosis"];
    let metres = diagnosis["tolerance"].as_f64().expect("a tolerance");
    assert!((0.1..5.0).contains(&metres), "{diagnosis}");
    assert!(story.contains(&format!("a tolerance of {metres} m")), "{story}");
    let (story, records) = flown(&format!("tolerance = {metres}\n{scenario}"));
    let end = &records[records.len() - 1];
    assert!(end["reason"] != "no line" && end.get("diagnosis").is_none(), "{story}");
}

#[test]
fn in_noise_a_promise_has_a_level() {
    let steps = |stop: &str, level: f64| {
        let stop = stop.replace(" }", ", audit = false }");
        let (story, records) = flown(&stopping(NOISY, &stop));
        let promise = format!(
            "Known with probability {level} at least: the line is one of a set of which any two \
             differ by 2 deg at most."
        );
        assert!(story.contains(&promise), "{story}");
        let end = &records[records.len() - 1];
        assert_eq!(end["reason"], "known");
        let goal = serde_json::json!({ "slope_arc_deg": 2.0, "level": level, "is_met": true });
        assert_eq!(end["goal"], goal);
        records.len()
    };
    let usual = steps("{ slope_arc_deg = 2.0 }", 0.9);
    assert!(steps("{ slope_arc_deg = 2.0, level = 0.5 }", 0.5) < usual);
    assert!(steps("{ slope_arc_deg = 2.0, level = 0.999 }", 0.999) > usual);
    // The audit of such a promise counts the labels that disagree, as some do.
    let scenario = stopping(NOISY, "{ slope_arc_deg = 2.0 }").replace("steps = 60", "steps = 300");
    let (story, records) = flown(&scenario);
    let end = &records[records.len() - 1];
    let (goal, audit) = (&end["goal"], &end["goal"]["audit"]);
    assert_eq!((&end["reason"], &goal["is_met"]), (&"known".into(), &true.into()));
    assert!(number(&audit["agreed"]) >= 6.0 && number(&audit["disagreed"]) < 3.0, "{audit}");
    assert!(story.contains("labels beside the estimate agree"), "{story}");
}

#[test]
fn a_promise_that_is_not_kept_is_not_made() {
    let scenario = stopping(GOOD, "{ slope_arc_deg = 0.5 }").replace("steps = 60", "steps = 5");
    let (story, records) = flown(&scenario);
    assert!(story.contains("Not known yet: any two of the lines left differ by 0.5 deg at most."));
    let end = &records[6];
    assert_eq!((&end["reason"], &end["goal"]["is_met"]), (&"steps".into(), &false.into()));
    // Of missions without a goal nothing is said.
    let (story, records) = flown(GOOD);
    assert!(!story.contains("nown:") && records[11].get("goal").is_none());
}

#[test]
fn a_stop_that_means_nothing_is_refused() {
    let folder = folder();
    let cases: [(&str, &str, &[&str]); 13] = [
        (GOOD, "{ slope_arc_deg = 0.0 }", &["stop.slope_arc_deg", "found 0", "below 90"]),
        (GOOD, "{ slope_arc_deg = 90.0 }", &["stop.slope_arc_deg", "found 90", "below 90"]),
        (GOOD, "{ slope_arc_deg = nan }", &["stop.slope_arc_deg", "found NaN"]),
        (GOOD, "{ misclassified = 0.0 }", &["stop.misclassified", "found 0", "a share"]),
        (GOOD, "{ misclassified = 1.0 }", &["stop.misclassified", "found 1", "below 1"]),
        (GOOD, "{ slope_arc_deg = 1.0, misclassified = 0.1 }", &["stop: found both", "one of"]),
        (GOOD, "{ }", &["stop: found neither", "slope_arc_deg or misclassified"]),
        (GOOD, "{ slope_arc_deg = 1.0, level = 0.9 }", &["stop.level", "found 0.9", "noise"]),
        (GOOD, "{ slope = 1.0 }", &["bad.toml:5", "slope", "`slope_arc_deg`"]),
        (GOOD, "[0.5]", &["bad.toml:5", "expected a table"]),
        (NOISY, "{ slope_arc_deg = 1.0, level = 1.0 }", &["stop.level", "found 1", "0.9999"]),
        (NOISY, "{ slope_arc_deg = 1.0, level = 0.0 }", &["stop.level", "found 0", "above 0"]),
        (NOISY, "{ level = 0.9 }", &["stop: found neither"]),
    ];
    for (scenario, stop, parts) in cases {
        fs::write(folder.path().join("bad.toml"), stopping(scenario, stop)).expect("a file");
        refuses(folder.path(), &["run", "bad.toml"], &[&["bad.toml"], parts].concat());
    }
    fs::write(folder.path().join("m.toml"), stopping(GOOD, "{ slope_arc_deg = 1.0 }"))
        .expect("a file");
    for other in ["cfc", "scc", "margin", "random", "lawnmower"] {
        let found =
            format!("stop: found with algorithm {other}, expected with algorithm lookahead");
        refuses(folder.path(), &["run", "m.toml", "--algorithm", other], &["m.toml", &found]);
    }
    prints(folder.path(), &["run", "m.toml"]);
}

/// Fan and weight of the control are the planner's unless the file says.
#[test]
fn a_planner_has_its_own_defaults() {
    let bare = GOOD.replace("varrho = 0.1\n", "");
    let flies = |algorithm: &str, more: &str| {
        let bare = bare.replace("\"cfc\"", &format!("\"{algorithm}\""));
        flown(&format!("{more}{bare}")).1
    };
    for (algorithm, varrho, fan) in [
        ("cfc", 0.1, "paper"),
        ("scc", 0.1, "paper"),
        ("margin", 0.1, "paper"),
        ("random", 0.1, "paper"),
        ("lookahead", 0.002, "fine"),
    ] {
        let records = flies(algorithm, "");
        assert_eq!(records[0]["varrho"], varrho, "{algorithm}");
        assert_eq!(records, flies(algorithm, &format!("varrho = {varrho}\nfan = \"{fan}\"\n")));
    }
    let other = flies("lookahead", "fan = \"paper\"\nvarrho = 0.3\n");
    assert_eq!(other[0]["varrho"], 0.3);
    assert!(other[1..11].iter().all(|it| it["action"]["index"].as_u64() < Some(6_657)));
    let folder = folder();
    let fine = format!("fan = \"fine\"\n{GOOD}");
    fs::write(folder.path().join("m.toml"), fine).expect("a file");
    let args = ["run", "m.toml", "--algorithm", "margin"];
    let parts = ["m.toml", "fan: found \"fine\" with algorithm margin", "expected \"paper\""];
    refuses(folder.path(), &args, &parts);
    assert!(text(&host_sim(folder.path(), &["run", "m.toml"]).stderr).is_empty());
}
