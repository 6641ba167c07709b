#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! Both algorithms with 32 labels beside 4 given samples.

bare_core::flies!(AllLabels<36, 36, 529>, Unicycle, Area);
