#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! All algorithms, all vehicles and prices of labels, with 32 labels beside 4 given samples.

bare_core::flies!(AllLabels<36, 36, 529, AnySight>, AnyVehicle, MissionArea);
