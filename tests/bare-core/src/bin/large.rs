#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Both algorithms with 64 labels beside 4 given samples.

bare_core::flies!(AllLabels<68, 68, 2081>, Unicycle, Area);
