//! The firmware under emulation: QEMU's STM32F405, its first UART over TCP.

use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use anyhow::{Context as _, Result, bail};

/// Emulated nanoseconds that an instruction takes (`-icount shift=6`), so that the emulated clock counts
/// them.
pub const NS_PER_INSTRUCTION: f64 = 64.0;

const QEMU: &str = "qemu-system-arm";

/// How long QEMU may take to come up.
const PATIENCE: Duration = Duration::from_secs(20);

/// A running emulator; it ends with this value.
#[derive(Debug)]
pub struct Emulator {
    qemu: Child,
}

impl Emulator {
    /// Starts a firmware, with further arguments for QEMU; the other end of its link. Its log, as defmt
    /// encodes it, goes to `log`.
    ///
    /// # Errors
    /// When there is no such ELF or no QEMU, or it does not come up.
    pub fn start(elf: &Path, log: Option<&Path>, more: &[&str]) -> Result<(Self, TcpStream)> {
        if !fs::read(elf).is_ok_and(|content| content.starts_with(b"\x7fELF")) {
            bail!("{}: expected the firmware's ELF; `cargo firmware` builds it", elf.display());
        }
        let listener = TcpListener::bind("127.0.0.1:0").context("no port for the link")?;
        let port = listener.local_addr()?.port();
        let log = log.map_or_else(|| "null".into(), |path| format!("file:{}", path.display()));
        let qemu = Command::new(QEMU)
            .args(["-M", "netduinoplus2", "-nographic", "-monitor", "none"])
            .args(["-icount", "shift=6"])
            .args(["-serial", &format!("tcp:127.0.0.1:{port},nodelay=on")])
            .args(["-serial", &log])
            .args(more)
            .arg("-kernel")
            .arg(elf)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| format!("{QEMU}: expected on PATH"))?;
        let mut emulator = Self { qemu };
        let link = emulator.accept(&listener)?;
        link.set_nodelay(true)?;
        Ok((emulator, link))
    }

    fn accept(&mut self, listener: &TcpListener) -> Result<TcpStream> {
        listener.set_nonblocking(true)?;
        let until = Instant::now() + PATIENCE;
        while Instant::now() < until {
            if let Ok((link, _)) = listener.accept() {
                link.set_nonblocking(false)?;
                return Ok(link);
            }
            if let Some(status) = self.qemu.try_wait()? {
                let mut message = String::new();
                if let Some(mut stderr) = self.qemu.stderr.take() {
                    std::io::Read::read_to_string(&mut stderr, &mut message)?;
                }
                bail!("{QEMU} ended with {status}: {}", message.trim());
            }
            thread::sleep(Duration::from_millis(5));
        }
        bail!("{QEMU} did not come up within {} s", PATIENCE.as_secs())
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.qemu.kill();
        let _ = self.qemu.wait();
    }
}
