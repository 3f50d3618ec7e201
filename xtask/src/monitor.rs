//! QEMU's monitor: what a hand does to a board. The protocol is QMP.

use std::{
    io::{BufRead, BufReader, ErrorKind, Write},
    net::{TcpListener, TcpStream},
    thread,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use serde_json::Value;

/// Waits for a machine that is told to report here.
pub struct Listener(TcpListener);

impl Listener {
    /// At a port that is free.
    pub fn new() -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0")?;
        listener.set_nonblocking(true)?;
        Ok(Self(listener))
    }

    /// What to tell the machine by `-qmp`.
    pub fn address(&self) -> Result<String> {
        Ok(format!("tcp:{}", self.0.local_addr()?))
    }

    /// The machine's monitor, once it reports.
    pub fn accept(self) -> Result<Monitor> {
        const LIMIT: Duration = Duration::from_secs(20);
        let start = Instant::now();
        let stream = loop {
            match self.0.accept() {
                Ok((stream, _)) => break stream,
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                Err(error) => return Err(error.into()),
            }
            if start.elapsed() > LIMIT {
                bail!("the emulator does not report to its monitor");
            }
            thread::sleep(Duration::from_millis(10));
        };
        stream.set_nonblocking(false)?;
        stream.set_read_timeout(Some(LIMIT))?;
        let mut monitor = Monitor(BufReader::new(stream));
        monitor.wait_for("QMP")?;
        monitor.say("qmp_capabilities")?;
        monitor.wait_for("return")?;
        Ok(monitor)
    }
}

/// The monitor of a running machine.
pub struct Monitor(BufReader<TcpStream>);

impl Monitor {
    /// Presses the reset button; what is in the RAM stays there.
    pub fn reset(&mut self) -> Result<()> {
        self.say("system_reset")?;
        loop {
            if self.wait_for("event")? == "RESET" {
                return Ok(());
            }
        }
    }

    fn say(&mut self, command: &str) -> Result<()> {
        let line = format!("{{\"execute\": \"{command}\"}}\n");
        Ok(self.0.get_mut().write_all(line.as_bytes())?)
    }

    /// What the next message with this key says of it.
    fn wait_for(&mut self, key: &str) -> Result<Value> {
        loop {
            let mut line = String::new();
            let length = self.0.read_line(&mut line)?;
            if length == 0 {
                bail!("the emulator has closed its monitor");
            }
            let mut message: Value = serde_json::from_str(&line).context("no message of QMP")?;
            if let Some(error) = message.get("error") {
                bail!("the emulator refuses: {error}");
            }
            if let Some(value) = message.get_mut(key) {
                return Ok(value.take());
            }
        }
    }
}
