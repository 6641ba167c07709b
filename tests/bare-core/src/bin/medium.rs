#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Algorithm 1 and look-ahead with 64 labels beside 4 given samples, for labels that are true.

bare_core::flies!(TrueLabels<68, SlopeWithin>, Unicycle, Area);
