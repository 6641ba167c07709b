//! Links the programs by the workspace's `memory.x`; does nothing in a build for a host.

use std::path::PathBuf;
use std::{env, fs, io};

const MEMORY_X: &str = "../../memory.x";

/// How a RISC-V core uses the same regions.
const REGIONS: &str = r#"
REGION_ALIAS("REGION_TEXT", FLASH);
REGION_ALIAS("REGION_RODATA", FLASH);
REGION_ALIAS("REGION_DATA", RAM);
REGION_ALIAS("REGION_BSS", RAM);
REGION_ALIAS("REGION_HEAP", RAM);
REGION_ALIAS("REGION_STACK", RAM);
"#;

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed={MEMORY_X}");
    if env::var_os("CARGO_CFG_TARGET_OS").is_none_or(|os| os != "none") {
        return Ok(());
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?);
    fs::copy(MEMORY_X, out.join("memory.x"))?;
    fs::write(out.join("regions.x"), REGIONS)?;
    println!("cargo::rustc-link-search={}", out.display());
    let riscv = env::var_os("CARGO_CFG_TARGET_ARCH").is_some_and(|arch| arch == "riscv32");
    let regions: &[&str] = if riscv { &["-Tmemory.x", "-Tregions.x"] } else { &[] };
    for arg in regions.iter().chain(&["--nmagic", "-Tlink.x"]) {
        println!("cargo::rustc-link-arg-bins={arg}");
    }
    Ok(())
}
