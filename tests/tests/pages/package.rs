//! `planner-core` as it is published: whole by itself.

use std::path::Path;
use std::process::Command;
use std::{env, fs};

#[test]
fn the_package_has_all_that_it_needs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let listed = Command::new(cargo)
        .current_dir(&root)
        .args(["package", "--list", "--allow-dirty", "--offline", "-p", "planner-core"])
        .output()
        .expect("cargo starts");
    assert!(listed.status.success(), "{}", String::from_utf8_lossy(&listed.stderr));
    let listed = String::from_utf8(listed.stdout).expect("paths");
    let has = |path: &str| listed.lines().any(|line| line == path);
    for path in
        ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "src/lib.rs", "examples/own_robot.rs"]
    {
        assert!(has(path), "{path} is not in the package:\n{listed}");
    }
    // The C interface is a package of its own.
    assert!(!listed.contains("c/src"), "{listed}");
    for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
        let text = |folder: &Path| fs::read_to_string(folder.join(licence)).expect("a licence");
        assert_eq!(text(&root), text(&root.join("planner-core")), "{licence}");
    }
}
