//! The programs of `docs/reference/next.md`, each in a language of its own, find the same line.

use std::env;
use std::path::Path;
use std::process::Command;

use crate::text;

#[test]
fn programs_find_a_line() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    for (language, needs, file) in
        [("python3", "python3", "next.py"), ("node", "node", "next.mjs"), ("sh", "jq", "next.sh")]
    {
        if Command::new(needs).arg("--version").output().is_err() {
            assert!(env::var_os("CI").is_none(), "docs/{file}: {needs} is not on PATH");
            eprintln!("SKIPPED docs/{file}: {needs} is not on PATH");
            continue;
        }
        let mut program = Command::new(language);
        program.arg(docs.join(file)).arg(env!("CARGO_BIN_EXE_host-sim"));
        let done = program.output().expect(language);
        let [said, complaint] = [&done.stdout, &done.stderr].map(|it| text(it));
        let is_found = said.starts_with("known: z = 0.41") && done.status.success();
        assert!(is_found, "{file}: {said}{complaint}");
    }
}
