//! The examples of `planner-core`: `cargo test` runs all of them, and the pages show them as they are.

/// None that is added is left out.
#[test]
fn each_is_run() {
    let manifest = include_str!("../../../planner-core/Cargo.toml");
    let folder = tests::build::root().join("planner-core/examples");
    let all = std::fs::read_dir(folder).expect("examples").map(|it| it.expect("a file").path());
    let missing: Vec<_> = all
        .filter(|path| path.extension().is_some_and(|it| it == "rs"))
        .filter(|path| {
            let name = path.file_stem().expect("a name").to_string_lossy();
            !manifest.contains(&format!("name = \"{name}\"\ntest = true\nharness = false\n"))
        })
        .collect();
    assert!(missing.is_empty(), "not run: {missing:?}");
}

/// The program that a page shows first.
fn first_program(page: &str) -> &str {
    page.split("```rust\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a program")
}

/// The program of the crate's README is the front page's, which is run as a doctest.
#[test]
fn the_crates_readme_shows_the_program_of_the_front_page() {
    let page = include_str!("../../../planner-core/src/lib.rs");
    let block = page.split("//! ```\n").nth(1).expect("a program");
    let shown = block.lines().filter(|line| !line.starts_with("//! #"));
    let shown: Vec<_> = shown.map(|line| line.strip_prefix("//! ").unwrap_or("")).collect();
    assert!(shown.len() <= 15, "{} lines", shown.len());
    let readme = include_str!("../../../planner-core/README.md");
    assert_eq!(first_program(readme).lines().collect::<Vec<_>>(), shown);
}

/// That of the README is an example, which is run.
#[test]
fn the_readme_shows_an_example() {
    let readme = include_str!("../../../README.md");
    let (_, program) =
        include_str!("../../../planner-core/examples/first.rs").split_once("\n\n").expect("a head");
    assert_eq!(first_program(readme), program);
}

#[test]
fn the_readme_is_short() {
    let readme = include_str!("../../../README.md");
    let lines = readme.lines().count();
    assert!(lines <= 150 && readme.len() <= 8 * 1024, "{lines} lines, {} bytes", readme.len());
}

/// The page tells how long each is.
#[test]
fn the_page_tells_their_lines() {
    let docs = tests::build::root().join("docs");
    let rows = include_str!("../../../docs/your-robot.md").lines().filter_map(|line| {
        let (path, rest) = line.split_once("](../planner-core/")?.1.split_once(") | ")?;
        let told = rest.strip_suffix(" |")?.rsplit(" | ").next()?.parse::<usize>().ok()?;
        let text = std::fs::read_to_string(docs.join("../planner-core").join(path)).expect(path);
        assert_eq!(told, text.lines().count(), "{path}");
        Some(())
    });
    assert!(rows.count() > 8);
}
