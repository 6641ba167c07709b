//! Runs the cases in `cases/`: each is a page that shows commands and what they print. `cases/README.md` describes
//! the pages. The pages for readers, README.md and those in `docs/`, are cases as well.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _};
use std::os::unix::fs::symlink;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

use host_sim::mission::scenario::{self, Overrides};
use libtest_mimic::{Arguments, Failed, Trial};
use snapbox::Data;
use snapbox::assert::{Assert, DEFAULT_ACTION_ENV};
use snapbox::filter::NormalizeToExpected;

const HOST_SIM: &str = env!("CARGO_BIN_EXE_host-sim");
const PACKAGE: &str = env!("CARGO_MANIFEST_DIR");
/// A command that takes longer hangs. All take seconds, but a machine may be busy.
const PATIENCE: Duration = Duration::from_mins(10);

fn main() -> io::Result<ExitCode> {
    let arguments = Arguments::from_args();
    let all = Path::new(PACKAGE).join("tests/cases");
    let mut trials = Vec::new();
    for topic in entries(&all)?.into_iter().filter(|it| it.is_dir()) {
        let pages = entries(&topic)?.into_iter();
        for page in pages.filter(|it| it.extension().is_some_and(|it| it == "md")) {
            let name = page.strip_prefix(&all).expect("it is below").with_extension("");
            let page_text = fs::read_to_string(&page)?;
            let is_wanted = is_wanted(&page_text);
            let trial =
                Trial::test(name.to_string_lossy(), move || check(&page).map_err(Failed::from));
            trials.push(trial.with_ignored_flag(!is_wanted));
        }
    }
    let root = Path::new(PACKAGE).join("..");
    let readers = ["README.md", "CONTRIBUTING.md", "planner-core/README.md", "docs"];
    for page in readers.iter().flat_map(|it| markdown(&root.join(it))) {
        let name = page.strip_prefix(&root).expect("it is below").with_extension("");
        let is_wanted = is_wanted(&fs::read_to_string(&page)?);
        let check = move || check_for_readers(&page).map_err(Failed::from);
        trials.push(Trial::test(name.to_string_lossy(), check).with_ignored_flag(!is_wanted));
    }
    Ok(libtest_mimic::run(&arguments, trials).exit_code())
}

/// The pages at a path or below it.
fn markdown(path: &Path) -> Vec<PathBuf> {
    if path.is_dir() {
        entries(path).expect("a folder").iter().flat_map(|it| markdown(it)).collect()
    } else {
        path.extension().is_some_and(|it| it == "md").then(|| path.to_owned()).into_iter().collect()
    }
}

fn entries(folder: &Path) -> io::Result<BTreeSet<PathBuf>> {
    fs::read_dir(folder)?.map(|it| it.map(|it| it.path())).collect()
}

/// Whether all is there that a page says it needs; a page for readers says so where they do not see it.
fn is_wanted(page: &str) -> bool {
    page.lines().filter_map(needed).all(has)
}

fn needed(line: &str) -> Option<&str> {
    let hidden = line.strip_prefix("<!-- needs: ").and_then(|it| it.strip_suffix(" -->"));
    line.strip_prefix("Needs: ").or(hidden)
}

/// What a page may need: a feature of the build, its absence, or an environment variable.
fn has(need: &str) -> bool {
    match need {
        "mavlink" => cfg!(feature = "mavlink"),
        "no mavlink" => !cfg!(feature = "mavlink"),
        variable => std::env::var_os(variable).is_some(),
    }
}

/// Compares the page with the same page that has the outputs of now, or writes the latter.
fn check(page: &Path) -> Result<(), String> {
    let folder = Folder::new(page.parent().expect("a topic")).map_err(|it| it.to_string())?;
    let text = fs::read_to_string(page).map_err(|it| it.to_string())?;
    compare(page, page_of_now(&text, &folder)?)
}

/// Reads the TOML of a page, runs its commands in their order, and compares what it says that they print.
fn check_for_readers(page: &Path) -> Result<(), String> {
    let text = fs::read_to_string(page).map_err(|it| it.to_string())?;
    let folder = Folder::for_readers().map_err(|it| it.to_string())?;
    let (mut now, mut before) = (String::new(), "");
    let mut lines = text.split_inclusive('\n');
    while let Some(line) = lines.next() {
        now += line;
        if let Some(kind) = line.strip_prefix("```").map(str::trim_end) {
            let block: Vec<_> = lines.by_ref().take_while(|it| *it != "```\n").collect();
            let block = block.concat();
            let why = |it: String| format!("{it}\n```{kind}\n{block}```");
            now += &match kind {
                "sh" if before.starts_with("<!-- not run: ") => {
                    let told = folder.run(&flags_of(&block)).map_err(|it| it.to_string())?;
                    if told.is_empty() { Ok(block.clone()) } else { Err(why(told)) }?
                }
                "console" => {
                    let fenced = page_of_now(&format!("{line}{block}```\n"), &folder)?;
                    fenced[line.len()..fenced.len() - 4].to_owned()
                }
                "toml" => folder.take(&block).map_err(why).map(|()| block.clone())?,
                "sh" => {
                    let script = format!("set -e\n{block}");
                    let told = folder.run(&script).map_err(|it| it.to_string())?;
                    let has_failed = told.lines().last().is_some_and(|it| it.starts_with("? "));
                    if has_failed { Err(why(told)) } else { Ok(block.clone()) }?
                }
                _ => block.clone(),
            };
            now += "```\n";
        }
        before = line;
    }
    // Commands within sentences and tables.
    let prose: Vec<_> = text.split("```").step_by(2).collect();
    let spans = prose.iter().flat_map(|it| it.split('`').skip(1).step_by(2));
    let named: String = spans.map(|it| it.replace('\n', " ") + "\n").collect();
    let told = folder.run(&flags_of(&named)).map_err(|it| it.to_string())?;
    if !told.is_empty() {
        return Err(told);
    }
    compare(page, now)?;
    for figure in text.split("host-sim/figures/").skip(1) {
        let name = figure.split(')').next().expect("one at least");
        let drawn = fs::read_to_string(folder.place.path().join(name));
        let drawn = drawn.map_err(|it| format!("{name}: {it}"))?;
        compare(&Path::new(PACKAGE).join("figures").join(name), drawn)?;
    }
    Ok(())
}

/// Compares a file with what it would be now, or writes it.
fn compare(file: &Path, now: String) -> Result<(), String> {
    Assert::new()
        .action_env(DEFAULT_ACTION_ENV)
        .try_eq(Some(&"now"), Data::text(now).raw(), Data::read_from(file, None).raw())
        .map_err(|it| it.to_string())
}

/// A script that reads the flags of the commands of this program in a block that cannot be run.
fn flags_of(block: &str) -> String {
    let joined = block.replace("\\\n", " ");
    let begins = ["host-sim ", "cargo ", "LONG=1 cargo ", "UPDATE_EXPECT=1 cargo "];
    let is_ours = |it: &&str| begins.iter().any(|its| it.starts_with(its)) && !it.contains("...");
    let lines = joined.lines().filter(is_ours).flat_map(|it| [it, "\n"]);
    ["set -e; export ONLY_FLAGS=1\n"].into_iter().chain(lines).collect()
}

/// The page with the outputs of now. An output that fits the page's elisions keeps them.
fn page_of_now(text: &str, folder: &Folder) -> Result<String, String> {
    let mut now = String::new();
    let mut lines = text.split_inclusive('\n').peekable();
    let mut is_console = false;
    while let Some(line) = lines.next() {
        now += line;
        if let Some(kind) = line.strip_prefix("```") {
            is_console = !is_console && kind.trim_end() == "console";
        } else if is_console {
            let command = line.strip_prefix("$ ").ok_or_else(|| format!("no command: {line}"))?;
            let mut command = command.to_owned();
            while let Some(more) = lines.next_if(|it| it.starts_with("> ") || *it == ">\n") {
                now += more;
                command += more[1..].strip_prefix(' ').unwrap_or(&more[1..]);
            }
            let mut expected = String::new();
            while let Some(line) = lines.next_if(|it| !it.starts_with("$ ") && *it != "```\n") {
                expected += line;
            }
            let actual = folder.run(&command).map_err(|it| format!("{it}: {command}"))?;
            let filter = NormalizeToExpected::new().redact();
            now += &filter.normalize(Data::text(actual), &Data::text(expected)).to_string();
        }
    }
    Ok(now)
}

/// The folder of a page's commands.
struct Folder {
    place: tempfile::TempDir,
    path: OsString,
}

impl Folder {
    /// A folder that has `m.toml`, a mission that can be flown, and the topic's files.
    fn new(topic: &Path) -> io::Result<Self> {
        let place = tempfile::tempdir()?;
        fs::copy(format!("{PACKAGE}/scenarios/paper-noiseless.toml"), place.path().join("m.toml"))?;
        let shared = topic.join("in");
        for file in if shared.is_dir() { entries(&shared)? } else { BTreeSet::new() } {
            fs::copy(&file, place.path().join(file.file_name().expect("a name")))?;
        }
        let helpers = PathBuf::from(format!("{PACKAGE}/tests/cases/bin"));
        let program = Path::new(HOST_SIM).parent().expect("a folder").to_owned();
        let usual = std::env::var_os("PATH").unwrap_or_default();
        let path = [program, helpers].into_iter().chain(std::env::split_paths(&usual));
        let path = std::env::join_paths(path).map_err(io::Error::other)?;
        Ok(Self { place, path })
    }

    /// A folder that looks like the root of the repository, after `cargo build --release`.
    fn for_readers() -> io::Result<Self> {
        let mut it = Self::new(Path::new("none"))?;
        let programs = PathBuf::from(format!("{PACKAGE}/tests/cases/bin/pages"));
        let release = it.place.path().join("target/release");
        fs::create_dir_all(&release)?;
        symlink(programs.join("host-sim"), release.join("host-sim"))?;
        symlink(PACKAGE, it.place.path().join("host-sim"))?;
        let path = [programs].into_iter().chain(std::env::split_paths(&it.path));
        it.path = std::env::join_paths(path).map_err(io::Error::other)?;
        Ok(it)
    }

    /// Reads a block of TOML. One whose first line is a comment that names a file becomes this file. One that is no whole
    /// mission is read with the keys that it lacks from one of the simulator's.
    fn take(&self, block: &str) -> Result<(), String> {
        let of = |text: &str| text.parse::<toml::Table>().map_err(|it| it.to_string());
        let keys = of(block)?;
        if keys.contains_key("package") || keys.contains_key("dependencies") {
            return Ok(());
        }
        let file = block.strip_prefix("# ").and_then(|it| it.split_once(".toml")).map(|it| it.0);
        if let Some(file) = file.filter(|it| !it.contains(' ')) {
            let path = self.place.path().join(file).with_extension("toml");
            fs::write(path, block).map_err(|it| it.to_string())?;
        }
        let is_whole = ["truth", "oracle"].iter().all(|it| keys.contains_key(*it));
        let is_front = keys.contains_key("front") || keys.contains_key("seek");
        let other = if is_front {
            include_str!("../scenarios/coast.toml")
        } else {
            include_str!("../scenarios/begin-line.toml")
        };
        let mut mission = if is_whole { toml::Table::new() } else { of(other)? };
        mission.extend(keys);
        let beside = Path::new(PACKAGE).join("scenarios");
        let text = mission.to_string();
        let read = scenario::parse_in("TOML", &text, &beside, Overrides::default());
        read.map(drop).map_err(|it| format!("{it:#}"))
    }

    /// What the command prints: standard output, then standard error, then `? N` if its status N is not 0.
    fn run(&self, command: &str) -> io::Result<String> {
        let before = entries(self.place.path())?;
        let (mut output, mut errors) = (tempfile::tempfile()?, tempfile::tempfile()?);
        let child = Command::new("sh")
            .args(["-c", command])
            .current_dir(self.place.path())
            .env("PATH", &self.path)
            .env("HOST_SIM", HOST_SIM)
            .env("ROOT", format!("{PACKAGE}/.."))
            .env("SCENARIOS", format!("{PACKAGE}/scenarios"))
            .env("RECORDINGS", format!("{PACKAGE}/recordings"))
            .envs([("NO_COLOR", "1"), ("TERM", "dumb"), ("COLUMNS", "100"), ("LC_ALL", "C")])
            .env_remove("RUST_BACKTRACE")
            .stdin(File::open("/dev/null")?)
            .stdout(output.try_clone()?)
            .stderr(errors.try_clone()?)
            .process_group(0)
            .spawn()?;
        let status = await_end(child)?;
        let [printed, said] = [&mut output, &mut errors].map(written);
        let (printed, said) = (printed?, said?);
        if status.code() == Some(2) {
            // A command that refuses does nothing else.
            if !printed.is_empty() {
                return Err(io::Error::other(format!("status 2, but it prints {printed:?}")));
            }
            if entries(self.place.path())? != before {
                return Err(io::Error::other(
                    "status 2, but the folder has other files than before",
                ));
            }
        }
        let status = match status.code() {
            Some(0) => String::new(),
            Some(code) => format!("? {code}\n"),
            None => format!("? {status}\n"),
        };
        let place = self.place.path().to_string_lossy();
        Ok((printed + &said + &status).replace(&*place, "$PWD").replace(PACKAGE, "$PACKAGE"))
    }
}

fn written(file: &mut File) -> io::Result<String> {
    file.rewind()?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    let mut text = String::from_utf8_lossy(&bytes).into_owned();
    if !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
    Ok(text)
}

fn await_end(mut child: Child) -> io::Result<ExitStatus> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if start.elapsed() > PATIENCE {
            Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status()?;
            child.wait()?;
            return Err(io::Error::other(format!("no end within {PATIENCE:?}")));
        }
        thread::sleep(Duration::from_millis(2));
    }
}
