//! What is wrong with the arguments, in one line, as of a key: what was found, and what was expected.

use std::env;
use std::error::Error as _;

use anyhow::{Error, anyhow};
use clap::CommandFactory as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use crate::cli::arguments::Cli;
use crate::mission::wording::expected;
use crate::output::plain;

/// The message of an error of clap's.
pub fn in_one_line(error: &clap::Error) -> Error {
    anyhow!(plain::name(&message(error).to_string()))
}

fn message(error: &clap::Error) -> Error {
    let words = |kind| match error.get(kind) {
        Some(ContextValue::String(word)) => vec![word.clone()],
        Some(ContextValue::Strings(words)) => words.clone(),
        Some(ContextValue::StyledStr(text)) => vec![text.to_string()],
        Some(ContextValue::StyledStrs(texts)) => texts.iter().map(ToString::to_string).collect(),
        Some(ContextValue::Number(number)) => vec![number.to_string()],
        _ => Vec::new(),
    };
    let first = |kind| words(kind).into_iter().next().unwrap_or_default();
    let argument = first(ContextKind::InvalidArg);
    let flag = argument.trim_start_matches('[').split([' ', '[', ']']).next().unwrap_or_default();
    let usage = first(ContextKind::Usage);
    let usage = usage.trim_start_matches("Usage:").split_whitespace().collect::<Vec<_>>().join(" ");
    let is_name = |word: &&str| !word.starts_with(['[', '<', '-']);
    let command = usage.split(' ').take_while(is_name).collect::<Vec<_>>().join(" ");
    match error.kind() {
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => {
            let value = first(ContextKind::InvalidValue);
            let found = if value.is_empty() { "no value" } else { &value };
            let said = error.source().map(ToString::to_string).unwrap_or_default();
            let valid = words(ContextKind::ValidValue);
            // Our own parsers say what they expect, and some what they found, or for which flag.
            if let Some(said) = said.strip_prefix(flag).filter(|_| !flag.is_empty()) {
                return anyhow!("{flag}{said}");
            }
            if said.starts_with("found ") {
                return anyhow!("{flag}: {said}");
            }
            let expected = match (said.strip_prefix("expected "), valid.is_empty()) {
                (Some(expected), _) => expected.to_owned(),
                (None, false) => format!("one of {}", valid.join(", ")),
                (None, true) => expected(flag).map_or_else(|| of_value(&argument), Into::into),
            };
            anyhow!("{flag}: found {found}, expected {expected}")
        }
        ErrorKind::UnknownArgument if argument.starts_with('-') => {
            let similar = first(ContextKind::SuggestedArg);
            if similar.is_empty() {
                anyhow!("{flag}: found an unknown flag, expected one that `{command} --help` lists")
            } else {
                anyhow!(
                    "{flag}: found an unknown flag, expected {similar}, or another that `{command} --help` lists"
                )
            }
        }
        ErrorKind::UnknownArgument => {
            let glued = glued().map(|it| format!("{it}, or ")).unwrap_or_default();
            anyhow!("{argument}: found an argument too many, expected {glued}{usage}")
        }
        ErrorKind::InvalidSubcommand => {
            let name = first(ContextKind::InvalidSubcommand);
            anyhow!("{name}: found no such command, expected one that `{command} --help` lists")
        }
        ErrorKind::MissingRequiredArgument => {
            let missing = words(ContextKind::InvalidArg).join(" and no ");
            anyhow!("{command}: found no {missing}, expected {usage}")
        }
        ErrorKind::ArgumentConflict => {
            let prior = words(ContextKind::PriorArg).join(", ");
            if prior == argument {
                anyhow!("{flag}: found twice, expected once")
            } else {
                anyhow!("{flag}: found with {prior}, expected one of them")
            }
        }
        ErrorKind::TooFewValues | ErrorKind::TooManyValues | ErrorKind::WrongNumberOfValues => {
            anyhow!("{flag}: found too few values or too many, expected {usage}")
        }
        _ => {
            let said = error.to_string();
            let said = said.trim_start_matches("error: ").lines().next().unwrap_or_default();
            anyhow!("{said}, expected what `{command} --help` shows")
        }
    }
}

/// A flag and the word behind it, if all they lack to be understood is an equals sign between them.
fn glued() -> Option<String> {
    let all: Vec<_> = env::args_os().collect();
    (2..all.len()).find_map(|k| {
        let mut words = all.clone();
        let value = words.remove(k);
        let flag = &mut words[k - 1];
        flag.push("=");
        flag.push(value);
        let glued = flag.to_string_lossy().into_owned();
        let is_flag = glued.starts_with("--");
        (is_flag && Cli::command().try_get_matches_from(words).is_ok()).then_some(glued)
    })
}

/// What a flag expects, by the name of its value.
fn of_value(argument: &str) -> String {
    let name = argument.split_once('<').map_or("", |(_, name)| name.trim_end_matches('>'));
    match name {
        "METRES" | "RADIANS" | "SECONDS" | "BITS" => format!("{}, as 0.5", name.to_lowercase()),
        name if name.contains("FILE") || name.contains("csv") => format!("a file, {name}"),
        _ => "a number, as 0.5".to_owned(),
    }
}
