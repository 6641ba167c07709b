//! Flags and places that are refused.

use std::fmt::Write as _;
use std::fs;

use crate::{GOOD, folder, prints, refuses};

#[test]
fn bad_flags_and_places_are_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    fs::create_dir(folder.path().join("d")).expect("a folder");
    let cases: [(&[&str], &[&str]); 13] = [
        (&["run", "none.toml"], &["none.toml", "readable"]),
        (&["run", "m.toml", "--steps", "10001"], &["--steps", "found 10001", "1 to 10000"]),
        (&["run", "m.toml", "--steps", "many"], &["--steps", "many"]),
        (&["run", "m.toml", "--algorithm", "abc"], &["--algorithm", "abc", "cfc"]),
        (&["run", "m.toml", "--trace", "no/t.jsonl"], &["no/t.jsonl", "expected a place"]),
        (&["run", "m.toml", "--trace", "t.jsonl", "--figure", "d"], &["d", "directory"]),
        (&["campaign", "--fields", "0"], &["--fields", "0"]),
        (&["campaign", "--steps", "0"], &["--steps", "found 0", "1 to 10000"]),
        (&["campaign", "--p", "1.5"], &["--p", "found 1.5", "[0, 1]"]),
        (&["campaign", "--p", "0.7"], &["--p", "found 0.7", "expected 1", "cfc"]),
        (
            &["campaign", "--algorithm", "scc", "--trusted-radius=-1"],
            &["--trusted-radius", "found -1"],
        ),
        (&["run", "m.toml", "--candidates", "c.svg"], &["--candidates", "without noise"]),
        (&["campaign", "--csv", "no/c.csv"], &["no/c.csv", "expected a place"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), args, parts);
    }
}

#[test]
fn a_chip_that_cannot_be_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let many = (0..17).fold(String::new(), |mut text, i| {
        let _ = writeln!(text, "  {{ x = {i}.0, z = 0.0, label = -1 }},");
        text
    });
    let many = GOOD.replace("oracle = [\n", &format!("oracle = [\n{many}"));
    fs::write(folder.path().join("many.toml"), many).expect("a file");
    let other = env!("CARGO_BIN_EXE_host-sim");
    let other = format!("--emulator={other}");
    let cases: [(&[&str], &[&str]); 19] = [
        (&["m.toml"], &["--port", "--emulator"]),
        (&["m.toml", "--emulator", "--resume"], &["--trace"]),
        (&["m.toml", &other], &["host-sim", "firmware's ELF"]),
        (&["m.toml", "--port", "x", "--emulator"], &["--port", "--emulator"]),
        (&["m.toml", "--port", "no-such-device"], &["no-such-device", "expected a serial port"]),
        (&["m.toml", "--emulator"], &["chip/firmware", "in the repository", "--emulator=ELF"]),
        (&["m.toml", "--emulator=m.toml"], &["m.toml", "ELF", "cargo firmware"]),
        (
            &["m.toml", "--emulator", "--machine", "microbit"],
            &["release/microbit", "--emulator=ELF"],
        ),
        (&["m.toml", "--emulator", "--machine", "raspi0"], &["--machine raspi0", "--emulator=ELF"]),
        (&["m.toml", "--emulator", "--machine", "virt,x=1"], &["virt,x=1", "name of a machine"]),
        (&["m.toml", "--emulator", "--machine", ""], &["--machine", "name of a machine"]),
        (&["m.toml", "--port", "x", "--machine", "microbit"], &["--machine", "--port"]),
        (&["m.toml", "--port", "x", "--log", "l"], &["--log", "--port"]),
        (&["m.toml", "--emulator", "--baud", "9600"], &["--baud", "--emulator"]),
        (&["m.toml", "--emulator", "--fault", "drop=2"], &["drop", "found 2", "[0, 1]"]),
        (&["m.toml", "--emulator", "--fault", "delay=1s"], &["delay", "found 1s", "20ms"]),
        (
            &["m.toml", "--emulator", "--algorithm", "random"],
            &["m.toml", "random", "lookahead or track"],
        ),
        (
            &["m.toml", "--emulator", "--algorithm", "margin"],
            &["m.toml", "margin", "lookahead or track"],
        ),
        (&["many.toml", "--emulator"], &["many.toml", "found 21 points", "at most 16"]),
    ];
    for (args, parts) in cases {
        refuses(folder.path(), &[&["hil"], args].concat(), parts);
    }
}

#[test]
fn a_repeated_fault_is_refused() {
    let folder = folder();
    fs::write(folder.path().join("m.toml"), GOOD).expect("a file");
    let args = ["hil", "m.toml", "--emulator", "--fault", "drop=0.1,cut=0.1,drop=0.2"];
    refuses(folder.path(), &args, &["--fault", "drop: found twice, expected once"]);
}

#[test]
fn a_flag_that_an_algorithm_ignores_is_refused() {
    let folder = folder();
    let radius = ["--trusted-radius", "0.5"];
    let cases: [(&[&str], &[&str], &str); 17] = [
        (&[], &["--policy", "joint"], "--algorithm scc"),
        (&[], &["--prior", "area"], "--algorithm scc"),
        (&[], &radius, "labels that can be wrong"),
        (&["--algorithm", "scc", "--p", "1"], &radius, "--p below 1"),
        (&["--algorithm", "random"], &radius, "--p below 1"),
        (&["--algorithm", "margin"], &["--crossing", "anyhow"], "--algorithm cfc or scc"),
        (&["--algorithm", "margin", "--p", "0.7"], &["--policy", "joint"], "--algorithm scc"),
        (&["--algorithm", "margin"], &["--prior", "area"], "margin with --p below 1"),
        (&["--algorithm", "margin"], &["--fan", "fine"], "expected paper, as it tries every"),
        (&["--algorithm", "lookahead"], &["--prior", "area"], "lookahead or margin with --p below"),
        (&["--algorithm", "lookahead"], &["--crossing", "anyhow"], "--algorithm cfc or scc"),
        (&["--algorithm", "lookahead"], &["--following", "anyhow"], "--algorithm cfc or scc"),
        (&["--algorithm", "lookahead", "--p", "0.7"], &["--policy", "joint"], "--algorithm scc"),
        (&["--algorithm", "random"], &["--crossing", "anyhow"], "--algorithm cfc or scc"),
        (&["--algorithm", "random"], &["--following", "anyhow"], "--algorithm cfc or scc"),
        (&["--algorithm", "random", "--p", "0.7"], &["--policy", "joint"], "--algorithm scc"),
        (&["--algorithm", "random", "--p", "0.7"], &["--prior", "area"], "--algorithm scc"),
    ];
    for (who, flag, meant) in cases {
        let args = [&["campaign", "--fields", "2", "--csv", "c.csv"], who, flag].concat();
        refuses(folder.path(), &args, &[flag[0], "found ", "with --algorithm", meant]);
    }
    // Where they have a meaning they are taken.
    let quick = ["campaign", "--fields", "2", "--steps", "3"];
    let cases: [&[&str]; 11] = [
        &["--algorithm", "margin", "--p", "0.7", "--prior", "sequences", radius[0], radius[1]],
        &["--compare", "scc,margin", "--prior", "sequences", radius[0], radius[1]],
        &["--algorithm", "lookahead", "--p", "0.7", "--prior", "area", radius[0], radius[1]],
        &["--algorithm", "lookahead", "--fan", "paper"],
        &["--fan", "paper"],
        &["--fan", "fine", "--algorithm", "scc"],
        &["--fan", "fine", "--algorithm", "random"],
        &["--crossing", "along-oracle", "--following", "anyhow", "--p", "1"],
        &["--algorithm", "scc", "--crossing", "along-oracle", "--following", "anyhow"],
        &["--algorithm", "scc", "--policy", "joint", "--prior", "sequences", radius[0], radius[1]],
        &["--algorithm", "random", "--p", "0.7", radius[0], radius[1]],
    ];
    for flags in cases {
        prints(folder.path(), &[&quick[..], flags].concat());
    }
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let folder = folder();
    let cases: [(&[&str], &[&str]); 13] = [
        (&["cfc,margin", "--p", "0.7"], &["--p: found 0.7, expected 1", "--compare cfc"]),
        (&["margin,scc,cfc"], &["--p: found 0.7, the default with scc", "--compare cfc"]),
        (
            &["cfc,margin", "--following", "anyhow"],
            &["--following", "--compare margin", "cfc or scc"],
        ),
        (
            &["scc,random", "--crossing", "anyhow"],
            &["--crossing", "--compare random", "cfc or scc"],
        ),
        (&["scc,margin", "--policy", "joint"], &["--policy", "--compare margin", "scc"]),
        (&["scc,random", "--prior", "area"], &["--prior", "--compare random", "scc"]),
        (
            &["cfc,random", "--trusted-radius", "1"],
            &["--trusted-radius", "--compare cfc", "--p below 1"],
        ),
        (
            &["lookahead,margin", "--fan", "fine"],
            &["--fan: found fine with --compare margin, expected paper"],
        ),
        (
            &["lookahead,random", "--p", "0.7", "--prior", "area"],
            &["--prior", "--compare random", "lookahead or margin"],
        ),
        (&["cfc,random,cfc"], &["--compare", "found cfc twice", "once"]),
        (&["cfc,walk"], &["--compare", "walk", "margin"]),
        (&[""], &["--compare"]),
        (&["cfc,random", "--algorithm", "cfc"], &["--compare", "--algorithm"]),
    ];
    for (args, parts) in cases {
        let args = [&["campaign", "--fields", "2", "--csv", "c.csv", "--compare"], args].concat();
        refuses(folder.path(), &args, parts);
    }
}
