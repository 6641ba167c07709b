//! Every example in help is a command line that is understood, and every command has one.

use clap::CommandFactory as _;
use host_sim::cli::arguments::Cli;

#[test]
fn help_has_examples_that_are_understood() {
    let cli = Cli::command();
    let commands = cli.get_subcommands().filter(|it| it.get_name() != "help");
    let mut examples = 0;
    for command in commands.chain([&cli]) {
        let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
        assert!(help.starts_with("Examples:"), "{}: {help:?}", command.get_name());
        for line in help.lines().filter_map(|line| line.strip_prefix("  host-sim")) {
            // What comes after a wide gap explains it; what comes after > or < is the shell's.
            let words = line.split("  ").next().unwrap_or_default();
            let words = words.split(['>', '<']).next().unwrap_or_default().split_whitespace();
            let words = std::iter::once("host-sim").chain(words);
            let parsed = cli.clone().try_get_matches_from(words);
            assert!(parsed.is_ok(), "host-sim{line}: {}", parsed.unwrap_err());
            examples += 1;
        }
    }
    assert!(examples >= 15, "{examples}");
}
