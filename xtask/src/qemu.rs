//! Firmware in an emulated Cortex-M4F: QEMU's `mps2-an386`, its UART0 in our hands.
//!
//! ```ignore
//! let elf = project::firmware("vehicle")?;
//! let mut machine = Machine::boot(&elf, Duration::from_secs(60))?;
//! machine.send(b"%270/8\n")?;
//! while let Some(bytes) = machine.receive() { /* what the firmware sent */ }
//! let log = machine.finish()?;
//! ```

use std::{
    io::{self, Read, Write},
    path::Path,
    process::{self, ChildStdin, Command, Stdio},
    sync::{
        Arc, LazyLock,
        atomic::{AtomicUsize, Ordering},
        mpsc::{self, Receiver, RecvTimeoutError, Sender},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

use anyhow::{Context, Result, bail};
use shared_child::SharedChild;

/// The emulator of the board, with semihosting, without a screen and without a monitor.
pub fn command() -> Command {
    let mut qemu = Command::new("qemu-system-arm");
    qemu.args(["-machine", "mps2-an386", "-cpu", "cortex-m4"]);
    qemu.args(["-display", "none", "-monitor", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native"]);
    qemu
}

/// The same command on one core of this computer, each on the next one, where there is a `taskset`. The emulator's threads wake
/// each other for every byte of a UART, which takes twice the time between two cores.
fn on_one_core(command: Command) -> Command {
    static NEXT: AtomicUsize = AtomicUsize::new(0);
    static CORES: LazyLock<Vec<u32>> = LazyLock::new(|| cores().unwrap_or_default());
    if CORES.is_empty() {
        return command;
    }
    let core = CORES[NEXT.fetch_add(1, Ordering::Relaxed) % CORES.len()];
    let mut pinned = Command::new("taskset");
    pinned.args(["--cpu-list", &core.to_string()]);
    pinned.arg(command.get_program()).args(command.get_args());
    pinned
}

/// The cores on which this program may run.
fn cores() -> Option<Vec<u32>> {
    let mut taskset = Command::new("taskset");
    taskset.args(["--cpu-list", "--pid", &process::id().to_string()]);
    listed(&String::from_utf8(taskset.output().ok()?.stdout).ok()?)
}

/// Cores as `taskset` lists them: `pid 7's current affinity list: 0,2-4`.
fn listed(said: &str) -> Option<Vec<u32>> {
    let (_, list) = said.trim().rsplit_once(' ')?;
    let ranges = list.split(',').map(|range| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        Some(first.parse::<u32>().ok()?..=last.parse().ok()?)
    });
    let ranges = ranges.collect::<Option<Vec<_>>>()?;
    Some(ranges.into_iter().flatten().collect())
}

/// A running board. It is switched off when dropped, and at the latest when its time is up.
pub struct Machine {
    child: Arc<SharedChild>,
    uart_input: ChildStdin,
    uart_output: Receiver<Vec<u8>>,
    log: Option<JoinHandle<io::Result<Vec<u8>>>>,
    // Dropping it tells the watchdog that the machine has ended.
    watchdog: Option<(Sender<()>, JoinHandle<bool>)>,
}

impl Machine {
    /// Boots the firmware in `elf`. The machine is off after `limit` at the latest.
    pub fn boot(elf: &Path, limit: Duration) -> Result<Self> {
        Self::boot_with(elf, limit, &[])
    }

    /// The same with more arguments for QEMU.
    pub fn boot_with(elf: &Path, limit: Duration, arguments: &[&str]) -> Result<Self> {
        let mut command = command();
        command
            .args(["-serial", "stdio"])
            .args(arguments)
            .arg("-kernel")
            .arg(elf);
        Self::start(command, limit)
    }

    /// A machine by its command, whose standard input and output are a UART.
    pub fn start(command: Command, limit: Duration) -> Result<Self> {
        let mut command = on_one_core(command);
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let child = SharedChild::spawn(&mut command)
            .context("cannot start qemu-system-arm: run `cargo xtask setup`")?;
        let child = Arc::new(child);
        let uart_input = child.take_stdin().expect("stdin is piped");
        let mut stdout = child.take_stdout().expect("stdout is piped");
        let mut stderr = child.take_stderr().expect("stderr is piped");

        // Both outputs are read as they come: a full pipe would stop the machine.
        let (sender, uart_output) = mpsc::channel();
        thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(length @ 1..) = stdout.read(&mut buffer) {
                if sender.send(buffer[..length].to_vec()).is_err() {
                    break;
                }
            }
        });
        let log = thread::spawn(move || {
            let mut log = Vec::new();
            stderr.read_to_end(&mut log).map(|_| log)
        });

        let (ended, end) = mpsc::channel::<()>();
        let watched = Arc::clone(&child);
        let watchdog = thread::spawn(move || {
            let expired = end.recv_timeout(limit) == Err(RecvTimeoutError::Timeout);
            expired && watched.kill().is_ok()
        });
        let watchdog = Some((ended, watchdog));
        Ok(Self {
            child,
            uart_input,
            uart_output,
            log: Some(log),
            watchdog,
        })
    }

    /// Sends `bytes` to UART0, waiting while the firmware is slow to read them.
    pub fn send(&mut self, bytes: &[u8]) -> Result<()> {
        self.uart_input
            .write_all(bytes)
            .and_then(|()| self.uart_input.flush())
            .context("the firmware has stopped reading its UART")
    }

    /// The next bytes that the firmware sent by UART0, waiting for them; `None` when it has ended.
    pub fn receive(&mut self) -> Option<Vec<u8>> {
        self.uart_output.recv().ok()
    }

    /// The bytes that the firmware has sent by UART0 since the last call, without waiting.
    pub fn received(&mut self) -> Vec<u8> {
        self.uart_output.try_iter().flatten().collect()
    }

    /// Waits until the firmware ends by itself, and returns what it wrote by semihosting: text, or frames of
    /// defmt. Fails, showing that, unless it ends in time and with success.
    pub fn finish(mut self) -> Result<Vec<u8>> {
        // Nobody waits for these bytes any more, but the firmware may wait to be rid of them.
        while self.receive().is_some() {}
        let status = self.child.wait()?;
        let log = self
            .log
            .take()
            .map(|log| log.join().expect("reading does not panic"));
        let log = log.transpose()?.unwrap_or_default();
        let late = self.stop_watchdog();
        if late || !status.success() {
            let how = if late {
                "did not end in time".into()
            } else {
                format!("failed: {status}")
            };
            bail!(
                "the firmware {how}; it wrote:\n{}",
                String::from_utf8_lossy(&log)
            );
        }
        Ok(log)
    }

    /// Ends the watchdog; true if it had to switch the machine off.
    fn stop_watchdog(&mut self) -> bool {
        self.watchdog.take().is_some_and(|(ended, watchdog)| {
            drop(ended);
            watchdog.join().unwrap_or(false)
        })
    }
}

impl Drop for Machine {
    fn drop(&mut self) {
        // Nothing is left to be done about a machine that does not stop.
        let _ = self.child.kill();
        let _ = self.child.wait();
        self.stop_watchdog();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cores_are_listed_by_numbers_and_ranges() {
        let of = |list| listed(&format!("pid 7's current affinity list: {list}\n"));
        assert_eq!(of("0,2-4"), Some(vec![0, 2, 3, 4]));
        assert_eq!(of("1"), Some(vec![1]));
        assert_eq!(of("none"), None);
        assert_eq!(listed(""), None);
    }
}
