//! Text from outside, made safe for a terminal. Control characters are escaped, and very long words and lines are
//! shortened.

use std::fmt::Write as _;

/// Characters of a word without spaces, and of a line, that are shown whole. Paths are shorter.
const LONGEST_WORD: usize = 300;
const LONGEST_LINE: usize = 1_000;

/// Characters that are shown of a word that is longer, and of a line.
const OF_WORD: usize = 60;
const OF_LINE: usize = 500;

/// A name in one line. Control characters are escaped as in Rust.
pub fn name(text: &str) -> String {
    escaped(text, |_| false)
}

/// A message, in lines of its own. Control characters are escaped, and of very long words and lines the middle is left
/// out.
pub fn message(text: &str) -> String {
    let tame = escaped(text, |it| it == '\n');
    let lines = tame.split('\n').map(|line| {
        let words = line.split(' ').map(|word| shortened(word, LONGEST_WORD, OF_WORD));
        shortened(&words.collect::<Vec<_>>().join(" "), LONGEST_LINE, OF_LINE)
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn escaped(text: &str, is_kept: impl Fn(char) -> bool) -> String {
    let mut tame = String::with_capacity(text.len());
    for it in text.chars() {
        if (it.is_control() || turns_around(it)) && !is_kept(it) {
            tame.extend(it.escape_debug());
        } else {
            tame.push(it);
        }
    }
    tame
}

/// Whether a character changes the direction in which others are shown.
fn turns_around(it: char) -> bool {
    matches!(it, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The beginning and the end of a text that is longer than this.
fn shortened(text: &str, longest: usize, shown: usize) -> String {
    let count = text.chars().count();
    if count <= longest {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(shown / 2).collect();
    // Writing to a string cannot fail.
    let _ = write!(short, "[... {} characters ...]", count - shown);
    short.extend(text.chars().skip(count - shown / 2));
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_escaped() {
        assert_eq!(name("a\x1b[2J\r\n\u{9b}\u{202e}ü b"), "a\\u{1b}[2J\\r\\n\\u{9b}\\u{202e}ü b");
        assert_eq!(message("one\ntwo\x07"), "one\ntwo\\u{7}");
    }

    #[test]
    fn what_is_long_is_cut_in_its_middle() {
        let path = "/a".repeat(150);
        assert_eq!(message(&path), path);
        let word = "ä".repeat(1_000);
        let cut = message(&format!("m.toml: found {word}, expected 1"));
        let thirty = "ä".repeat(30);
        assert!(
            cut.starts_with(&format!("m.toml: found {thirty}[... 941 characters ...]")),
            "{cut}"
        );
        assert!(cut.ends_with("ä, expected 1"), "{cut}");
        let line = message(&format!("{}expected 1", "a b ".repeat(100_000)));
        assert!(line.len() < 600 && line.ends_with("expected 1"), "{line}");
    }
}
