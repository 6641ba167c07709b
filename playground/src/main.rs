//! Builds the playground, one page without remote content, and serves it on this computer or writes it to a file.

mod page;

use std::ffi::OsString;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Command, ExitCode};
use std::time::Duration;
use std::{env, fs, thread};

const HELP: &str = "\
Builds the playground and serves it on this computer.

Usage: cargo run -p playground [-- --output FILE]

  --output FILE   writes the page there instead: it opens from disk, or from any server
";

/// Where the page is served, unless something else is there.
const PORT: u16 = 8053;

/// How long a reader may take to ask.
const PATIENCE: Duration = Duration::from_secs(10);

fn main() -> ExitCode {
    let words: Vec<_> = env::args_os().skip(1).collect();
    match asked(&words) {
        Ok(Asked::Help) => print!("{HELP}"),
        Ok(asked) => {
            if let Err(why) = perform(&asked) {
                eprintln!("error: {why}");
                return ExitCode::FAILURE;
            }
        }
        Err(why) => {
            eprintln!("error: {why}");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

enum Asked {
    Help,
    Write(PathBuf),
    Serve,
}

fn asked(words: &[OsString]) -> Result<Asked, String> {
    match words {
        [] => Ok(Asked::Serve),
        [help] if help == "--help" || help == "-h" => Ok(Asked::Help),
        [output, file] if output == "--output" => writable(file.into()).map(Asked::Write),
        [word, ..] => {
            Err(format!("found {}, expected --output FILE or nothing", word.to_string_lossy()))
        }
    }
}

/// A place where a file can be. It is looked at before the module is built, which takes minutes.
fn writable(file: PathBuf) -> Result<PathBuf, String> {
    let folder = file.parent().filter(|it| !it.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => {
            Err(format!("--output: found no folder {}, expected one", folder.display()))
        }
        _ if file.is_dir() => {
            Err(format!("--output: found the folder {}, expected a file", file.display()))
        }
        _ => Ok(file),
    }
}

fn perform(asked: &Asked) -> Result<(), String> {
    let page = page::of(&module()?);
    if let Asked::Write(file) = asked {
        return fs::write(file, page).map_err(|why| format!("{}: {why}", file.display()));
    }
    let listener = TcpListener::bind(("127.0.0.1", PORT))
        .or_else(|_| TcpListener::bind(("127.0.0.1", 0)))
        .map_err(|why| format!("no port is free: {why}"))?;
    let address = listener.local_addr().map_err(|why| why.to_string())?;
    println!("The playground is at http://{address}/ until Ctrl-C.");
    thread::scope(|scope| {
        for stream in listener.incoming().flatten() {
            // A reader that goes away is no error.
            scope.spawn(|| answer(stream, &page));
        }
    });
    Ok(())
}

/// Answers a request: there is one page.
fn answer(mut stream: TcpStream, page: &str) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut request = String::new();
    BufReader::new(io::Read::take(&stream, 8192)).read_line(&mut request)?;
    let is_there = request.starts_with("GET / ");
    let (status, text) = if is_there { ("200 OK", page) } else { ("404 Not Found", "") };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        text.len()
    )?;
    stream.write_all(text.as_bytes())
}

/// Builds the module, and reads it.
fn module() -> Result<Vec<u8>, String> {
    const TARGET: &str = "wasm32-unknown-unknown";
    let has = Command::new("rustc").args(["--print", "target-libdir", "--target", TARGET]).output();
    let has = has.map_err(|why| format!("rustc does not start: {why}"))?;
    let libraries = PathBuf::from(String::from_utf8_lossy(&has.stdout).trim());
    if !libraries.is_dir() {
        return Err(format!("found no target {TARGET}, expected it: rustup target add {TARGET}"));
    }
    eprintln!("Building the simulator for a browser: a few minutes the first time.");
    let built = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["build", "--quiet", "--locked", "--lib", "--profile", "page", "--target", TARGET])
        .args(["--message-format", "json-render-diagnostics"])
        .stderr(std::process::Stdio::inherit())
        .output()
        .map_err(|why| format!("cargo does not start: {why}"))?;
    if !built.status.success() {
        return Err("cargo build failed".into());
    }
    let said = String::from_utf8_lossy(&built.stdout);
    let file = said.split('"').rfind(|it| it.ends_with("simulator.wasm"));
    let file = file.ok_or("cargo named no simulator.wasm")?;
    fs::read(file).map_err(|why| format!("{file}: {why}"))
}
