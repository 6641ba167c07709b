//! What is said of a mission, and which of its parts is refused.

use core::ffi::{CStr, c_char};

use crate::status::Status;

/// What is said of a mission before it begins, and which part of it that is about.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// What it says.
    pub status: Status,
    /// The number of the sample or of the keep-out that is refused, from 0; -1 if it is none of these.
    pub number: i32,
    /// What is refused: a field of the mission, of its area or of the front settings, `"given"` for the samples, `""` for
    /// nothing. Never null.
    pub what: *const c_char,
}

/// A refusal, and what it is about.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Refusal {
    status: Status,
    what: &'static CStr,
    number: i32,
}

impl Refusal {
    pub(crate) const fn of(status: Status, what: &'static CStr) -> Self {
        Self { status, what, number: -1 }
    }

    /// The same, of the part with a number.
    pub(crate) const fn about(self, number: usize) -> Self {
        Self { number: number as i32, ..self }
    }
}

impl From<Refusal> for Status {
    fn from(refusal: Refusal) -> Self {
        refusal.status
    }
}

impl From<Result<(), Refusal>> for Verdict {
    fn from(result: Result<(), Refusal>) -> Self {
        let Err(Refusal { status, what, number }) = result else {
            return Self { status: Status::Ok, number: -1, what: c"".as_ptr() };
        };
        Self { status, number, what: what.as_ptr() }
    }
}
