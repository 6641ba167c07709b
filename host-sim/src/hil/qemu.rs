//! A firmware under emulation: QEMU's machine for its board, the first UART over TCP.

use std::io::Read as _;
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};
use std::{fs, thread};

use anyhow::{Context as _, Result, anyhow, bail};

use crate::hil::firmware::STM32F405;
use crate::output::interruption::unfinished;
use crate::output::kind;

/// Emulated nanoseconds that an instruction takes (`-icount shift=6`), so that the emulated clock counts
/// them.
pub const NS_PER_INSTRUCTION: f64 = 64.0;

/// A kind of core that a firmware is built for.
#[derive(Debug)]
struct Core {
    /// The ELF's class (32 bits or 64) and machine.
    named: [u8; 2],
    qemu: &'static str,
    /// The machine of QEMU's if none is asked for.
    machine: &'static str,
    arguments: &'static [&'static str],
}

const CORES: [Core; 3] = [
    Core { named: [1, 40], qemu: "qemu-system-arm", machine: STM32F405.machine, arguments: &[] },
    Core {
        named: [1, 243],
        qemu: "qemu-system-riscv32",
        machine: "virt",
        arguments: &["-bios", "none"],
    },
    Core {
        named: [2, 243],
        qemu: "qemu-system-riscv64",
        machine: "virt",
        arguments: &["-bios", "none"],
    },
];

impl Core {
    /// That of a firmware.
    fn of(elf: &Path) -> Result<&'static Self> {
        let content = fs::read(elf);
        let unread = content.as_ref().err().map(|error| format!("found {}, ", kind::unread(error)));
        let content = content.unwrap_or_default();
        let named = match content.get(..20) {
            Some([b'\x7f', b'E', b'L', b'F', class, .., machine, 0]) => Some([*class, *machine]),
            _ => None,
        };
        CORES.iter().find(|it| Some(it.named) == named).with_context(|| {
            let other = if named.is_some() { "the ELF of another core" } else { "another file" };
            let found = unread.unwrap_or_else(|| format!("found {other}, "));
            format!(
                "{}: {found}expected a firmware's ELF, for Arm or RISC-V; `cargo firmware` builds one",
                elf.display()
            )
        })
    }
}

/// The machine of QEMU's that runs a firmware, if none is asked for.
pub fn usual_machine(elf: &Path) -> &'static str {
    Core::of(elf).map_or(STM32F405.machine, |it| it.machine)
}

/// How long QEMU may take to come up.
const PATIENCE: Duration = Duration::from_secs(20);

/// How long QEMU may take to end once its ports are closed.
const DYING: Duration = Duration::from_millis(200);

/// A running emulator; it ends with this value, and if the program is interrupted.
#[derive(Debug)]
pub struct Emulator {
    /// The id of its process, which the registry of [`interruption`](crate::output::interruption) lists.
    id: u32,
    qemu: &'static str,
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
        let &Core { qemu, arguments, .. } = Core::of(elf)?;
        let listener = TcpListener::bind("127.0.0.1:0").context("no port for the link")?;
        let port = listener.local_addr()?.port();
        let log = log.map_or_else(|| "null".into(), |path| format!("file:{}", path.display()));
        let mut command = Command::new(qemu);
        command
            .args(["-M", machine, "-nographic", "-monitor", "none"])
            .args(["-icount", "shift=6"])
            .args(["-serial", &format!("tcp:127.0.0.1:{port},nodelay=on")])
            .args(["-serial", &log])
            .args(arguments)
            .args(more)
            .arg("-kernel")
            .arg(elf)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let mut emulator = Self::spawn(qemu, &mut command)?;
        let link = emulator.accept(&listener)?;
        link.set_nodelay(true)?;
        Ok((emulator, link))
    }

    fn spawn(qemu: &'static str, command: &mut Command) -> Result<Self> {
        let mut unfinished = unfinished();
        let mut child = command.spawn().with_context(|| format!("{qemu}: expected on PATH"))?;
        let (id, complaints) = (child.id(), child.stderr.take());
        unfinished.children.insert(id, child);
        Ok(Self { id, qemu, complaints })
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
        bail!("{} did not come up within {} s", self.qemu, PATIENCE.as_secs())
    }

    /// What QEMU says if it has ended by itself.
    fn failure(&mut self) -> Option<anyhow::Error> {
        let status = unfinished().children.get_mut(&self.id)?.try_wait().ok()??;
        let mut message = String::new();
        if let Some(mut complaints) = self.complaints.take() {
            // If that cannot be read, the status is reported alone.
            let _ = complaints.read_to_string(&mut message);
        }
        Some(anyhow!("{} ended with {status}: {}", self.qemu, message.trim()))
    }

    /// The error that broke a mission off: the emulator's, if the emulator has ended.
    pub fn blame(&mut self, error: anyhow::Error) -> anyhow::Error {
        thread::sleep(DYING);
        self.failure().unwrap_or(error)
    }
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
