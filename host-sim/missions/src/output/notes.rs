//! Messages beside the results, on standard error: warnings, progress, and which files were written. The user chooses
//! how much is printed.

use std::fmt::Display;
use std::sync::atomic::{AtomicU8, Ordering};

use anstyle::{AnsiColor, Style};

use crate::output::plain::message;

/// How much is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Loudness {
    /// Only errors.
    Quiet,
    /// Warnings, and progress on a terminal.
    Usual,
    /// What is written and built, too.
    Verbose,
}

/// Set once, before anything is printed.
static LOUDNESS: AtomicU8 = AtomicU8::new(Loudness::Usual as u8);

/// Sets how much is printed from now on.
pub fn set(loudness: Loudness) {
    LOUDNESS.store(loudness as u8, Ordering::Relaxed);
}

fn is_told(from: Loudness) -> bool {
    LOUDNESS.load(Ordering::Relaxed) >= from as u8
}

/// Prints a warning.
pub fn warn(subject: impl Display, warning: impl Display) {
    if is_told(Loudness::Usual) {
        let style = Style::new().bold().fg_color(Some(AnsiColor::Yellow.into()));
        let [subject, warning] = [subject.to_string(), warning.to_string()].map(|it| message(&it));
        anstream::eprintln!("{subject}: {style}warning{style:#}: {warning}");
    }
}

/// Announces work that takes a while.
pub fn announce(what: impl Display) {
    if is_told(Loudness::Usual) {
        anstream::eprintln!("{}", message(&what.to_string()));
    }
}

/// Prints a detail for users who asked for details.
pub fn mention(what: impl Display) {
    if is_told(Loudness::Verbose) {
        anstream::eprintln!("{}", message(&what.to_string()));
    }
}

/// Prints the error with which the program ends.
pub fn error(error: &anyhow::Error) {
    let style = Style::new().bold().fg_color(Some(AnsiColor::Red.into()));
    // If standard error is closed, the exit status alone must report the failure.
    let _ = std::io::Write::write_fmt(
        &mut anstream::stderr(),
        format_args!("{style}error{style:#}: {}\n", message(&format!("{error:#}"))),
    );
}

pub use bars::*;

#[cfg(not(target_family = "wasm"))]
mod bars {
    use anyhow::Result;
    pub use indicatif::ProgressBar;
    use indicatif::{ProgressDrawTarget, ProgressStyle};

    use super::{Loudness, is_told};

    /// A progress bar for `count` items, called `of`, with rate and time left. It shows on a terminal alone.
    ///
    /// # Errors
    /// Never: the template is sound.
    pub fn progress(count: u64, of: &str) -> Result<ProgressBar> {
        let style = format!("{{msg}}  {{bar:40}} {{pos}}/{{len}} {of}  {{per_sec}}  {{eta}} left");
        styled(ProgressBar::new(count), &style)
    }

    /// A counter of items whose total is not known.
    ///
    /// # Errors
    /// Never: the template is sound.
    pub fn count(of: &str) -> Result<ProgressBar> {
        styled(ProgressBar::new_spinner(), &format!("{{spinner}} {{pos}} {of}, {{elapsed}}"))
    }

    fn styled(bar: ProgressBar, style: &str) -> Result<ProgressBar> {
        if !is_told(Loudness::Usual) {
            bar.set_draw_target(ProgressDrawTarget::hidden());
        }
        Ok(bar.with_style(ProgressStyle::with_template(style)?))
    }
}

/// A browser has no terminal for bars.
#[cfg(target_family = "wasm")]
mod bars {
    #![allow(missing_docs, reason = "as where there is one")]

    #[derive(Debug)]
    pub struct ProgressBar;

    /// # Errors
    /// Never.
    pub fn progress(_: u64, _: &str) -> anyhow::Result<ProgressBar> {
        Ok(ProgressBar)
    }

    impl ProgressBar {
        #[must_use]
        pub fn with_message(self, _: &str) -> Self {
            self
        }

        pub fn inc(&self, _: u64) {}

        pub fn finish_and_clear(&self) {}
    }
}
