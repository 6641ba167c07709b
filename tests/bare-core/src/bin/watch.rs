#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! The guard of a stretch of a front.

bare_core::flies!(Guards, Unicycle, Area);
