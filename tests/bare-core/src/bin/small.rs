#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 and look-ahead with 16 samples, for labels that are true.

bare_core::flies!(TrueLabels<16, SlopeWithin>, Unicycle, Area);
