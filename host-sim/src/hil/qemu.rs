//! A firmware under emulation: QEMU's machine for its board, the first UART over TCP.

use std::io::Read as _;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use anyhow::{Context as _, Result, anyhow, bail};

use crate::output::interruption::unfinished;

/// Emulated nanoseconds that an instruction takes (`-icount shift=6`), so that the emulated clock counts
/// them.
pub const NS_PER_INSTRUCTION: f64 = 64.0;

const QEMU: &str = "qemu-system-arm";

/// How long QEMU may take to come up.
const PATIENCE: Duration = Duration::from_secs(20);

/// How long QEMU may take to end once its ports are closed.
const DYING: Duration = Duration::from_millis(200);

/// A running emulator; it ends with this value, and if the program is interrupted.
#[derive(Debug)]
pub struct Emulator {
    /// The id of its process, which the registry of [`interruption`](crate::output::interruption) lists.
    id: u32,
    complaints: Option<ChildStderr>,
}

impl Emulator {
    /// Starts a firmware on a machine of QEMU's, with further arguments for QEMU. Returns it with the other end of its
    /// link. Its second UART, the log as defmt encodes it, goes to `log`.
    ///
    /// # Errors
    /// When there is no such ELF, machine or QEMU, or it does not come up.
    pub fn start(
        elf: &Path,
        machine: &str,
        log: Option<&Path>,
        more: &[&str],
    ) -> Result<(Self, TcpStream)> {
        if !fs::read(elf).is_ok_and(|content| is_arm_elf(&content)) {
            bail!("{}: expected the firmware's ELF; `cargo firmware` builds it", elf.display());
        }
        let listener = TcpListener::bind("127.0.0.1:0").context("no port for the link")?;
        let port = listener.local_addr()?.port();
        let log = log.map_or_else(|| "null".into(), |path| format!("file:{}", path.display()));
        let mut command = Command::new(QEMU);
        command
            .args(["-M", machine, "-nographic", "-monitor", "none"])
            .args(["-icount", "shift=6"])
            .args(["-serial", &format!("tcp:127.0.0.1:{port},nodelay=on")])
            .args(["-serial", &log])
            .args(more)
            .arg("-kernel")
            .arg(elf)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut emulator = Self::spawn(&mut command)?;
        let link = emulator.accept(&listener)?;
        link.set_nodelay(true)?;
        Ok((emulator, link))
    }

    fn spawn(command: &mut Command) -> Result<Self> {
        let mut unfinished = unfinished();
        let mut qemu = command.spawn().with_context(|| format!("{QEMU}: expected on PATH"))?;
        let (id, complaints) = (qemu.id(), qemu.stderr.take());
        unfinished.children.insert(id, qemu);
        Ok(Self { id, complaints })
    }

    fn accept(&mut self, listener: &TcpListener) -> Result<TcpStream> {
        listener.set_nonblocking(true)?;
        let until = Instant::now() + PATIENCE;
        while Instant::now() < until {
            if let Ok((link, _)) = listener.accept() {
                link.set_nonblocking(false)?;
                return Ok(link);
            }
            if let Some(failure) = self.failure() {
                return Err(failure);
            }
            thread::sleep(Duration::from_millis(5));
        }
        bail!("{QEMU} did not come up within {} s", PATIENCE.as_secs())
    }

    /// What QEMU says if it has ended by itself.
    fn failure(&mut self) -> Option<anyhow::Error> {
        let status = unfinished().children.get_mut(&self.id)?.try_wait().ok()??;
        let mut message = String::new();
        if let Some(mut complaints) = self.complaints.take() {
            // If that cannot be read, the status is reported alone.
            let _ = complaints.read_to_string(&mut message);
        }
        Some(anyhow!("{QEMU} ended with {status}: {}", message.trim()))
    }

    /// The error that broke a mission off: the emulator's, if the emulator has ended.
    pub fn blame(&mut self, error: anyhow::Error) -> anyhow::Error {
        thread::sleep(DYING);
        self.failure().unwrap_or(error)
    }
}

fn is_arm_elf(content: &[u8]) -> bool {
    const ARM: [u8; 2] = [40, 0];
    content.starts_with(b"\x7fELF") && content.get(18..20) == Some(&ARM)
}

impl Drop for Emulator {
    fn drop(&mut self) {
        let mut unfinished = unfinished();
        if let Some(mut qemu) = unfinished.children.remove(&self.id) {
            // It may have ended by itself.
            let _ = qemu.kill();
            let _ = qemu.wait();
        }
    }
}
