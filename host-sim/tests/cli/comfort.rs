//! Conveniences of the tool: a scenario to begin with, completions, help with examples, more or less to read.

use std::fs;
use std::process::Command;

use clap::CommandFactory as _;
use host_sim::cli::arguments::Cli;

use crate::{GOOD, folder, host_sim, prints, refuses, text};

#[test]
fn what_init_writes_flies_and_is_not_replaced_unasked() {
    for kind in ["true", "noisy", "car"] {
        let folder = folder();
        let folder = folder.path();
        let said = prints(folder, &["init", "m.toml", "--kind", kind]);
        assert!(said.contains("host-sim run m.toml"), "{said}");
        let words = prints(folder, &["run", "m.toml", "--figure", "m.svg"]);
        assert!(words.contains("centre") || words.contains("mean"), "{kind}: {words}");
        fs::write(folder.join("m.toml"), "mine").expect("a file");
        refuses(folder, &["init", "m.toml"], &["m.toml", "found a file", "--force"]);
        assert_eq!(fs::read_to_string(folder.join("m.toml")).expect("a file"), "mine");
        prints(folder, &["init", "m.toml", "--kind", kind, "--force"]);
        assert_ne!(fs::read_to_string(folder.join("m.toml")).expect("a file"), "mine");
    }
    // What it says to do next, here and in the file, is about the file that it wrote.
    let folder = folder();
    let said = prints(folder.path(), &["init", "harbour.toml"]);
    let file = fs::read_to_string(folder.path().join("harbour.toml")).expect("a file");
    for text in [&said, &file] {
        let next = "host-sim run harbour.toml --figure harbour.svg";
        assert!(text.contains(next) && !text.contains("mission."), "{text}");
    }
    prints(folder.path(), &["init", "my harbour.toml"]);
    let file = fs::read_to_string(folder.path().join("my harbour.toml")).expect("a file");
    assert!(file.contains("host-sim run 'my harbour.toml' --figure 'my harbour.svg'"), "{file}");
    refuses(folder.path(), &["init", "nowhere/m.toml"], &["nowhere/m.toml", "place to write"]);
    refuses(folder.path(), &["init", "--kind", "boat"], &["boat", "--kind", "true, noisy, car"]);
    prints(folder.path(), &["init"]);
    assert!(folder.path().join("mission.toml").exists());
}

#[test]
fn each_line_that_init_comments_out_may_be_taken_in() {
    let folder = folder();
    for kind in ["true", "noisy", "car"] {
        prints(folder.path(), &["init", "m.toml", "--kind", kind, "--force"]);
        let file = fs::read_to_string(folder.path().join("m.toml")).expect("a file");
        let is_key = |line: &str| {
            let key = line.strip_prefix("# ").and_then(|line| line.split_once(" = "));
            key.is_some_and(|(key, _)| !key.contains(' '))
        };
        let keys: Vec<_> = file.lines().filter(|line| is_key(line)).collect();
        assert!(!keys.is_empty(), "{kind}");
        for key in keys {
            let changed = file.replace(key, key.trim_start_matches("# "));
            fs::write(folder.path().join("changed.toml"), changed).expect("a file");
            prints(folder.path(), &["run", "changed.toml"]);
        }
    }
}

#[test]
fn each_shell_gets_completions_of_every_command() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = prints(folder.path(), &["completions", shell]);
        for command in Cli::command().get_subcommands() {
            assert!(script.contains(command.get_name()), "{shell}: {}", command.get_name());
        }
        assert!(script.contains("position-error"), "{shell}");
    }
    refuses(folder.path(), &["completions", "csh"], &["csh", "bash", "zsh"]);
    refuses(folder.path(), &["completions"], &["SHELL"]);
}

#[test]
fn the_bash_completions_are_bash() {
    let folder = folder();
    let script = prints(folder.path(), &["completions", "bash"]);
    fs::write(folder.path().join("c.sh"), script).expect("a file");
    let Ok(checked) = Command::new("bash").args(["-n", "c.sh"]).current_dir(&folder).output()
    else {
        return eprintln!("SKIPPED bash's own check of its completions: there is no bash");
    };
    assert!(checked.status.success(), "{}", text(&checked.stderr));
}

/// Every example in help is a command line that is understood, and every command has one.
#[test]
fn help_has_examples_that_are_understood() {
    let cli = Cli::command();
    let commands = cli.get_subcommands().filter(|it| it.get_name() != "help");
    let mut examples = 0;
    for command in commands.chain([&cli]) {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        assert!(help.starts_with("Examples:"), "{}: {help:?}", command.get_name());
        for line in help.lines().filter_map(|line| line.strip_prefix("  host-sim")) {
            // What comes after a wide gap explains it; what comes after > is the shell's.
            let words = line.split("  ").next().unwrap_or_default();
            let words = words.split(" > ").next().unwrap_or_default().split_whitespace();
            let words = std::iter::once("host-sim").chain(words);
            let parsed = cli.clone().try_get_matches_from(words);
            assert!(parsed.is_ok(), "host-sim{line}: {}", parsed.unwrap_err());
            examples += 1;
        }
    }
    assert!(examples >= 15, "{examples}");
}

#[test]
fn quiet_keeps_warnings_back_and_verbose_says_what_is_written() {
    let folder = folder();
    let doubtful = format!("errors = {{ position = 0.05 }}\ntolerance = 0.1\n{GOOD}");
    fs::write(folder.path().join("m.toml"), doubtful).expect("a file");
    let told = |flags: &[&str]| {
        let args = [&["run", "m.toml", "--seed", "3", "--trace", "t.jsonl"], flags].concat();
        let output = host_sim(folder.path(), &args);
        (output.status.code(), text(&output.stderr))
    };
    let (status, usual) = told(&[]);
    assert!(usual.contains("m.toml: warning: tolerance"), "{usual}");
    let (quiet_status, quiet) = told(&["-q"]);
    assert_eq!((quiet_status, &*quiet), (status, ""));
    let (_, verbose) = told(&["--verbose"]);
    assert!(verbose.contains("t.jsonl: written, "), "{verbose}");
    // Errors are told all the same.
    refuses(folder.path(), &["--quiet", "run", "none.toml"], &["none.toml"]);
    refuses(folder.path(), &["run", "m.toml", "-q", "-v"], &["--quiet", "--verbose"]);
}

#[test]
fn what_is_not_a_terminal_gets_no_colours() {
    let folder = folder();
    for args in [&["--help"][..], &["run", "none.toml"], &["campaign", "--fields", "0"]] {
        let output = host_sim(folder.path(), args);
        let told = [output.stdout, output.stderr].concat();
        assert!(!told.contains(&b'\x1b'), "{args:?}");
    }
}
