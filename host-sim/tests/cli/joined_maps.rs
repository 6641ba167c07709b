//! `join`: the maps of several robots on one front.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::recordings::{degrees, number};
use crate::{folder, host_sim, prints, refuses, text};

const TITLES: &str = "step,x,z,heading,curvature,half_width,turn_deviation,piece";

const CLOSED: &str = include_str!("../../scenarios/closed-front.toml");

/// Two maps of the closed front: of robots that start back to back, with labels that are sometimes wrong.
fn fly(folder: &Path) {
    for (name, heading, seed) in [("a", "0.0", "1"), ("b", "3.14159", "2")] {
        let start = format!("x = 30.0, z = 8.0, heading = {heading} }}");
        let scenario = CLOSED.replace("x = 30.0, z = 8.0 }", &start);
        let scenario = scenario.replace("steps", "noise = { p = 0.9 }\nsteps");
        fs::write(folder.join("m.toml"), scenario).expect("a file");
        prints(folder, &["run", "m.toml", "--seed", seed, "--map", &format!("{name}.csv")]);
    }
}

fn record(folder: &Path, args: &[&str]) -> Value {
    let args = [&["join"], args, &["--format", "json"]].concat();
    serde_json::from_str(&prints(folder, &args)).expect("a record")
}

#[test]
fn two_robots_make_one_closed_map() {
    let folder = folder();
    let folder = folder.path();
    fly(folder);
    let found = record(folder, &["a.csv", "b.csv", "--map", "j.csv", "--figure", "j.svg"]);
    let map = &found["map"];
    assert_eq!((&map["state"], &map["pieces"]), (&"closed".into(), &1.into()), "{map}");
    assert!((number(&map["metres"]) - 125.7).abs() < 4.0, "{map}");
    assert!((30..=50).contains(&map["met"].as_u64().expect("a step")), "{map}");
    // Each vertex is one of its robot's, and no two are the same.
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("a file");
    let (joined, maps) = (read("j.csv"), [read("a.csv"), read("b.csv")]);
    let vertices = found["vertices"].as_array().expect("a list");
    assert_eq!(joined.lines().count(), vertices.len() + 1);
    let mut seen = Vec::new();
    for (line, it) in joined.lines().skip(1).zip(vertices) {
        let (row, robot) = line.rsplit_once(',').expect("columns");
        let robot: usize = robot.parse().expect("a robot");
        // Its piece is one of the joined map.
        let but_piece = |row: &str| row.rsplit_once(',').map(|(it, _)| it.to_owned());
        let has = maps[robot - 1].lines().any(|it| but_piece(it) == but_piece(row));
        assert!(has, "{row} of robot {robot}");
        assert!(!seen.contains(&line), "{line} twice");
        seen.push(line);
        let key = [&it["robot"], &it["number"]].map(|it| it.as_u64().expect("a number"));
        assert!(line.starts_with(&format!("{},", key[1])) && key[0] == robot as u64, "{it}");
    }
    for (robot, all) in found["robots"].as_array().expect("a list").iter().zip(&maps) {
        assert_eq!(robot["vertices"].as_u64(), Some(all.lines().count() as u64 - 1));
    }
    let words = prints(folder, &["join", "a.csv", "b.csv"]);
    let says =
        format!("The front is closed: the maps together go all round it, from step {}", map["met"]);
    assert!(words.contains(&says), "{words}");
    assert!(read("j.svg").contains("the front as it is mapped"));
    // Joined again it is the same front, and has no step at which it was closed. Its vertices lie closer together, so some
    // that were left out are places of their own.
    let again = record(folder, &["j.csv", "a.csv"]);
    let [map, again] = [map, &again["map"]];
    assert_eq!((&again["state"], &again["pieces"]), (&map["state"], &map["pieces"]), "{again}");
    let more = number(&again["vertices"]) - number(&map["vertices"]);
    assert!((-2.0..=0.05 * number(&map["vertices"])).contains(&more), "{again}");
    assert!((number(&again["metres"]) - number(&map["metres"])).abs() < 1.0, "{again}");
    assert!(again["met"].is_null(), "{again}");
}

/// Maps of which each has an origin of its own become one, by the coordinates of their files.
#[test]
fn maps_on_the_globe_are_joined_about_one_origin() {
    const ORIGIN: [f64; 2] = [53.5334, 9.9424];
    let folder = folder();
    let folder = folder.path();
    fly(folder);
    let plain = record(folder, &["a.csv", "b.csv"]);
    for (name, shift) in [("a", 0.0), ("b", 500.0)] {
        let map = fs::read_to_string(folder.join(format!("{name}.csv"))).expect("a map");
        let row = |(k, line): (usize, &str)| {
            if k == 0 {
                return format!("{line},lat,lon\n").replace("step,", "row,");
            }
            let mut cells: Vec<_> = line.split(',').map(str::to_owned).collect();
            let [x, z] = [1, 2].map(|k| cells[k].parse::<f64>().expect("metres"));
            let [lat, lon] = degrees(ORIGIN, [x, z]);
            cells[1] = (x + shift).to_string();
            format!("{},{lat},{lon}\n", cells.join(","))
        };
        let globe: String = map.lines().enumerate().map(row).collect();
        fs::write(folder.join(format!("{name}-globe.csv")), globe).expect("a file");
    }
    let files = ["a-globe.csv", "b-globe.csv", "--geojson", "j.geojson", "--map", "j.csv"];
    let found = record(folder, &files);
    assert_eq!(found["map"]["state"], "closed");
    assert!(found["map"]["met"].is_null() && found["origin"].is_array(), "{found}");
    assert!((number(&found["map"]["metres"]) - number(&plain["map"]["metres"])).abs() < 1.0);
    let map = fs::read_to_string(folder.join("j.csv")).expect("a map");
    assert!(map.starts_with("row,x,z,") && map.contains(",piece,lat,lon,robot\n"), "{map}");
    let drawn = fs::read_to_string(folder.join("j.geojson")).expect("a file");
    let drawn: Value = serde_json::from_str(&drawn).expect("JSON");
    let features = drawn["features"].as_array().expect("features");
    let of =
        |kind: &'static str| features.iter().filter(move |it| it["properties"]["kind"] == kind);
    let line = of("front").next().expect("a line")["geometry"]["coordinates"].clone();
    let line = line.as_array().expect("places");
    assert_eq!(line.first(), line.last(), "a closed front ends where it begins");
    let vertices = found["vertices"].as_array().expect("a list");
    assert_eq!((line.len(), of("vertex").count()), (vertices.len() + 1, vertices.len()));
    for (point, it) in of("vertex").zip(vertices) {
        assert_eq!(point["geometry"]["coordinates"][1], it["in_file"][0]);
        assert_eq!(point["properties"]["robot"], it["robot"]);
    }
}

#[test]
fn maps_that_do_not_meet_stay_apart() {
    let folder = folder();
    let folder = folder.path();
    fly(folder);
    let map = fs::read_to_string(folder.join("a.csv")).expect("a map");
    let part = |name: &str, rows: [usize; 2]| {
        let header = map.lines().take(1);
        let rows = map.lines().skip(rows[0]).take(rows[1]);
        let part: Vec<_> = header.chain(rows).collect();
        fs::write(folder.join(name), part.join("\n") + "\n").expect("a file");
    };
    part("p.csv", [1, 15]);
    part("q.csv", [30, 12]);
    let output = host_sim(folder, &["join", "p.csv", "q.csv"]);
    let [words, message] = [&output.stdout, &output.stderr].map(|it| text(it));
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(words.contains("It has 2 pieces:") && !words.contains("closed"), "{words}");
    assert!(message.contains("the joined map has 2 pieces"), "{message}");
}

#[test]
fn what_cannot_be_joined_is_refused() {
    let folder = folder();
    let write = |name: &str, content: &str| {
        fs::write(folder.path().join(name), content).expect("a file");
    };
    let map = |row: &str| format!("{TITLES}\n{row}\n");
    write("a.csv", &map("1,0.0,2.0,-0.5,0.0,0.75,0.25,1"));
    write("b.csv", &map("1,0.0,2.0,-0.5,0.0,0.75,0.25,1"));
    write("none.csv", &format!("{TITLES}\n"));
    write("samples.csv", "x,z,label\n1,1,1\n");
    write("empty.csv", "");
    write("word.csv", &map("1,0.0,wide,-0.5,0.0,0.75,0.25,1"));
    write("far.csv", &map("1,0.0,9e9,-0.5,0.0,0.75,0.25,1"));
    write("nan.csv", &map("1,0.0,2.0,nan,0.0,0.75,0.25,1"));
    write("narrow.csv", &map("1,0.0,2.0,-0.5,0.0,-0.75,0.25,1"));
    write("half.csv", &map("1.5,0.0,2.0,-0.5,0.0,0.75,0.25,1"));
    write("short.csv", &map("1,0.0,2.0"));
    let globe =
        |lat: &str| format!("{TITLES},lat,lon\n1,0.0,2.0,-0.5,0.0,0.75,0.25,1,{lat},10.0\n");
    write("globe.csv", &globe("50.0"));
    write("earth.csv", &globe("50.0"));
    write("pole.csv", &globe("95.0"));
    let many = "1,0.0,2.0,0.0,0.0,0.75,0.25,1\n".repeat(20_001);
    write("many.csv", &format!("{TITLES}\n{many}"));
    let cases: [(&[&str], &[&str]); 20] = [
        (&["a.csv", "b.csv", "./a.csv"], &["./a.csv", "twice", "another robot"]),
        (&["a.csv"], &["MAP.csv", "2 values"]),
        (&["a.csv", "gone.csv"], &["gone.csv", "readable"]),
        (&["a.csv", "none.csv"], &["none.csv", "without vertices"]),
        (&["a.csv", "samples.csv"], &["samples.csv", "no column heading", "--map"]),
        (&["a.csv", "empty.csv"], &["empty.csv", "no column x"]),
        (&["a.csv", "word.csv"], &["word.csv:2", "z: found \"wide\"", "a number"]),
        (&["a.csv", "far.csv"], &["far.csv:2", "9000000000"]),
        (&["a.csv", "nan.csv"], &["nan.csv:2", "heading: found NaN", "finite"]),
        (&["a.csv", "narrow.csv"], &["narrow.csv:2", "half_width: found -0.75"]),
        (&["a.csv", "half.csv"], &["half.csv:2", "step: found \"1.5\"", "whole number"]),
        (&["a.csv", "short.csv"], &["short.csv:2", "expected a row of a map"]),
        (&["a.csv", "globe.csv"], &["globe.csv: found latitude and longitude", "metres", "a.csv"]),
        (&["globe.csv", "pole.csv"], &["pole.csv:2", "lat: found 95"]),
        (&["a.csv", "many.csv"], &["found 20002 vertices", "20000 at most"]),
        (&["a.csv", "b.csv", "--map", "a.csv"], &["a.csv", "a map", "--map"]),
        (&["a.csv", "b.csv", "--map", "m.svg"], &["m.svg", ".csv", "--map"]),
        (&["a.csv", "b.csv", "--geojson", "m.geojson"], &["--geojson", "metres in a.csv", "--crs"]),
        (&["globe.csv", "earth.csv", "--crs", "EPSG:25832"], &["--crs", "latitude", "globe.csv"]),
        (&["a.csv", "b.csv", "--figure", "no/m.svg"], &["no/m.svg", "expected a place"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), &[&["join"], args].concat(), parts);
    }
}
