//! Messages beside the results, on standard error: warnings, progress, and which files were written. The user chooses
//! how much is printed.

use std::fmt::Display;
use std::sync::atomic::{AtomicU8, Ordering};

use anstyle::{AnsiColor, Style};
use anyhow::Result;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::output::plain::message;

/// How much is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Loudness {
    /// Errors alone.
    Quiet,
    /// Warnings, and progress on a terminal.
    Usual,
    /// What is written and built, too.
    Verbose,
}

/// Set once, before anything is told.
static LOUDNESS: AtomicU8 = AtomicU8::new(Loudness::Usual as u8);

/// From here on so much is told.
pub fn set(loudness: Loudness) {
    LOUDNESS.store(loudness as u8, Ordering::Relaxed);
}

fn is_told(from: Loudness) -> bool {
    LOUDNESS.load(Ordering::Relaxed) >= from as u8
}

/// Says what may surprise.
pub fn warn(subject: impl Display, warning: impl Display) {
    if is_told(Loudness::Usual) {
        let style = Style::new().bold().fg_color(Some(AnsiColor::Yellow.into()));
        let [subject, warning] = [subject.to_string(), warning.to_string()].map(|it| message(&it));
        anstream::eprintln!("{subject}: {style}warning{style:#}: {warning}");
    }
}

/// Says what takes a while.
pub fn announce(what: impl Display) {
    if is_told(Loudness::Usual) {
        anstream::eprintln!("{}", message(&what.to_string()));
    }
}

/// Says what only some want to know.
pub fn mention(what: impl Display) {
    if is_told(Loudness::Verbose) {
        anstream::eprintln!("{}", message(&what.to_string()));
    }
}

/// Says what the program ends with.
pub fn error(error: &anyhow::Error) {
    let style = Style::new().bold().fg_color(Some(AnsiColor::Red.into()));
    // Where nobody hears it the status has to do.
    let _ = std::io::Write::write_fmt(
        &mut anstream::stderr(),
        format_args!("{style}error{style:#}: {}\n", message(&format!("{error:#}"))),
    );
}

/// A bar for so many of something, with rate and time left; it shows on a terminal alone.
///
/// # Errors
/// Never: the template is sound.
pub fn progress(count: u64, of: &str) -> Result<ProgressBar> {
    let style = format!("{{msg}}  {{bar:40}} {{pos}}/{{len}} {of}  {{per_sec}}  {{eta}} left");
    styled(ProgressBar::new(count), &style)
}

/// A count of something of which nobody knows how many there will be.
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
