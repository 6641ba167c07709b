#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 with 16 samples.

#[cfg(target_os = "none")]
#[bench::entry]
fn main() -> ! {
    bench::cfc::<16>()
}

/// On a host there is nothing to run.
#[cfg(not(target_os = "none"))]
fn main() {}
