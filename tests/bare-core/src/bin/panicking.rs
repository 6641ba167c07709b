#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! A program that can panic, as no other here can: what looks for panics has to find this one's.

#[cfg(target_os = "none")]
#[bare_core::entry]
fn main() -> ! {
    bare_core::panicking()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
