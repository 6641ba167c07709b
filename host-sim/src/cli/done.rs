//! What a command has done.

/// The exit status of bad input, and of a mission that contradicts itself.
pub const REFUSED: u8 = 2;

/// What was done.
#[derive(Debug)]
pub struct Done {
    /// What to print.
    pub text: String,
    /// Why it was done in part only, and the exit status that tells so.
    pub failure: Option<(anyhow::Error, u8)>,
}

impl From<String> for Done {
    /// All was done, and this is to be printed.
    fn from(text: String) -> Self {
        Self { text, failure: None }
    }
}
