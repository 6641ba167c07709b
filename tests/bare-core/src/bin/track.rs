#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! The follower of fronts.

bare_core::flies!(Tracks, Unicycle, Area);
