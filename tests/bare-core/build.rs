//! Links the programs: for Arm by the workspace's `memory.x`, for RISC-V by the map of QEMU's `virt`; does nothing in a
//! build for a host.

use std::path::PathBuf;
use std::{env, fs, io};

const MEMORY_X: &str = "../../memory.x";
const VIRT_X: &str = "virt.x";

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={MEMORY_X}");
    println!("cargo::rerun-if-changed={VIRT_X}");
    if env::var_os("CARGO_CFG_TARGET_OS").is_none_or(|os| os != "none") {
        return Ok(());
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    for map in [MEMORY_X, VIRT_X] {
        fs::copy(map, out.join(map.trim_start_matches("../")))?;
    }
    println!("cargo::rustc-link-search={}", out.display());
    let riscv = env::var_os("CARGO_CFG_TARGET_ARCH").is_some_and(|arch| arch == "riscv32");
    let map: &[&str] = if riscv { &["-Tvirt.x"] } else { &[] };
    for arg in map.iter().chain(&["--nmagic", "-Tlink.x"]) {
        println!("cargo::rustc-link-arg-bins={arg}");
    }
    Ok(())
}
