#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 alone, with 16 samples.

bare_core::flies!(CfcAlone<16>, Unicycle, Area);
