//! `planner-core` as it is published: whole by itself.

use std::fs;
use std::path::Path;

use tests::build;

#[test]
fn the_package_has_all_that_it_needs() {
    let root = build::root();
    let list = ["package", "--list", "--allow-dirty", "--offline", "-p", "planner-core"];
    let listed = build::printed(build::cargo().args(list));
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
