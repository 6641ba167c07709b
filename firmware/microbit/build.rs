//! Links the firmware by the `memory.x` of its folder.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=memory.x");
    for arg in ["--nmagic", "-Tlink.x"] {
        println!("cargo::rustc-link-arg-bins={arg}");
    }
}
