//! What a command has done.

/// What was done.
#[derive(Debug)]
pub struct Done {
    /// What to print.
    pub text: String,
    /// Why it was done in part only, and the exit status that tells so.
    pub failure: Option<(anyhow::Error, u8)>,
}
