//! Interruption by a signal: cleans up before the program ends.
//!
//! A temporary file and a running emulator would outlive the program, so a registry lists them. Code that makes one
//! holds the registry's lock while it makes and enters it, and while the file becomes permanent. The thread that waits
//! for signals takes the lock and never gives it back. So nothing is left out between making and entering. On systems
//! without signals, nothing is cleaned up from here.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::process::Child;
use std::sync::atomic::{AtomicI32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the signal handler cleans up. An entry whose file or process has gone already does no harm.
#[derive(Debug)]
pub struct Unfinished {
    /// Temporary files, to be removed.
    pub files: BTreeSet<PathBuf>,
    /// Child processes by their ids, to be ended.
    pub children: BTreeMap<u32, Child>,
    /// A last message to the user: where to find what is kept.
    pub farewell: Option<String>,
    /// Whether the command ends the program itself, because it must stop a vehicle first.
    pub is_deferred: bool,
}

static UNFINISHED: Mutex<Unfinished> = Mutex::new(Unfinished {
    files: BTreeSet::new(),
    children: BTreeMap::new(),
    farewell: None,
    is_deferred: false,
});

/// The signal that was deferred; 0 if there was none.
static DEFERRED: AtomicI32 = AtomicI32::new(0);

/// From now on a signal does not end the program. [`deferred`] returns it.
pub fn defer() {
    unfinished().is_deferred = true;
}

/// The signal that arrived since then, if one did.
pub fn deferred() -> Option<i32> {
    let signal = DEFERRED.load(Ordering::Relaxed);
    (signal != 0).then_some(signal)
}

/// The registry, locked.
pub fn unfinished() -> MutexGuard<'static, Unfinished> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(unix)]
pub use by_signal::watch;

/// Where there are no signals there is nothing to watch.
///
/// # Errors
/// Never.
#[cfg(not(unix))]
pub fn watch() -> std::io::Result<()> {
    Ok(())
}

#[cfg(unix)]
mod by_signal {
    use std::io::{IsTerminal as _, Write as _};
    use std::{fs, io, process, thread};

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    use super::{DEFERRED, Ordering, Unfinished, unfinished};

    /// From here on, an interruption, a request to end, and the loss of the terminal remove unfinished files and
    /// processes. They end the program with 128 plus the signal's number, as shells do.
    ///
    /// # Errors
    /// When signals cannot be watched.
    pub fn watch() -> io::Result<()> {
        let heeded = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !is_ignored(*signal));
        let mut signals = Signals::new(heeded)?;
        thread::spawn(move || {
            for signal in signals.forever() {
                let mut unfinished = unfinished();
                if unfinished.is_deferred {
                    DEFERRED.store(signal, Ordering::Relaxed);
                    continue;
                }
                undo(&mut unfinished);
                process::exit(128 + signal);
            }
        });
        Ok(())
    }

    fn undo(unfinished: &mut Unfinished) {
        // Errors are ignored: a file or process may have gone already.
        for file in &unfinished.files {
            let _ = fs::remove_file(file);
        }
        for child in unfinished.children.values_mut() {
            let _ = child.kill();
            let _ = child.wait();
        }
        if let Some(farewell) = &unfinished.farewell {
            // A progress bar leaves the cursor in its line.
            let begin = if io::stderr().is_terminal() { "\n" } else { "" };
            let _ = writeln!(io::stderr(), "{begin}{farewell}");
        }
    }

    /// Whether the signal was ignored when the program started, as under `nohup`. Then it stays ignored. Only Linux
    /// reports this.
    fn is_ignored(signal: i32) -> bool {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        ignored.is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
    }
}
