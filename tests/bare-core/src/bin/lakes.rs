#![cfg_attr(target_os = "none", no_std, no_main)]
#![forbid(unsafe_code)]
//! All algorithms, the follower of fronts and all vehicles on charts of up to 128 x 128 cells, with 32 labels beside 4 given
//! samples.

bare_core::flies!(Tracks<AllLabels<36, 36, 529, AnySight>>, AnyVehicle, Charts<512>);
